"""The studio in a real browser, as a new user goes: draw, watch strokes, run, open an instant."""

from __future__ import annotations

import itertools
import json
import math
import re
import subprocess
import sys
import threading
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from studio.chromium import browser, missing, with_axe
from studio.hand import Page

import hybond as hb
from hybond.studio.server import listening, server
from hybond.studio.session import Session

pytestmark = pytest.mark.skipif(bool(missing()), reason=missing() or "there is a browser")

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture
def command(tmp_path: Path, state: Path) -> Iterator[Callable[[str], str]]:
    """Return `hybond studio` as a user gives it: a program of its own."""
    started = []

    def begin(file: str) -> str:
        command = [sys.executable, "-m", "hybond", "studio", file, "--no-browser"]
        process = subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, text=True)
        started.append(process)
        assert process.stdout is not None
        found = re.search(r"http://\S+", process.stdout.readline())
        assert found is not None
        return found[0]

    yield begin
    for process in started:
        process.kill()
        process.wait()


@pytest.fixture
def serve(tmp_path: Path, state: Path) -> Iterator[Callable[[str], str]]:
    """Return the same without the program, which takes a second to begin."""
    started = []

    def begin(file: str) -> str:
        session, socket = Session(tmp_path / file), listening(0)
        serving = server(session, socket, "token")
        thread = threading.Thread(target=serving.run, args=([socket],), daemon=True)
        thread.start()
        started.append((session, serving, thread))
        return f"http://127.0.0.1:{socket.getsockname()[1]}/?token=token"

    yield begin
    for session, serving, thread in started:
        serving.should_exit = serving.force_exit = True
        thread.join(10.0)
        session.close()
        assert not thread.is_alive()


@pytest.fixture
def state(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("HYBOND_STATE", str(tmp_path / "state"))
    return tmp_path / "state"


@pytest.fixture(scope="module")
def desk() -> Iterator[Any]:
    driver = browser()
    yield driver
    driver.quit()


def test_a_new_user_draws_the_circuit_runs_it_and_sees_the_mythical_mode(
    desk: Any, command: Callable[[str], str], serve: Callable[[str], str], tmp_path: Path
) -> None:
    from selenium.webdriver.common.keys import Keys

    page = Page(desk, command("circuit.toml"))
    # elements from the palette, by clicks: each is beside the one before
    for kind, name, value in (
        ("Se", "Se", "10 V"),
        ("1", "loop", ""),
        ("0", "node", ""),
        ("1", "loop1", ""),
        ("Se", "Se1", "0.7 V"),
        ("I", "I", "0.1 H"),
        ("R", "R", "10 ohm"),
    ):
        page.click(f'[data-kind="{kind}"]')
        page.until(lambda n=name: page.one(f'[data-node="{n}"].selected'), name)
        if value:
            page.write('.side input[aria-label="Value"]', value)
    # bonds by dragging from the handle
    for tail, head in (
        ("Se", "loop"),
        ("loop", "node"),
        ("loop1", "node"),
        ("loop1", "Se1"),
        ("node", "I"),
        ("loop", "R"),
    ):
        page.node(tail).click()
        page.until(lambda t=tail: page.one(f'[data-node="{t}"].selected'), tail)
        page.drag(page.one(f'[data-handle="{tail}"] circle:not(.hit)'), page.node(head))
        page.until(lambda t=tail, h=head: page.one(f'[data-text="{t} -> {h}"]'), f"{tail} {head}")
    page.until(lambda: page.strokes("node -> I") == ["1"], "the coil in integral causality")
    # its machines
    for junction, machine, on, off in (
        ("loop", "S1", "closed", "open"),
        ("loop1", "S2", "conducts", "blocks"),
    ):
        page.node(junction).click()
        buttons = page.until(
            lambda: [b for b in page.all(".side button") if "state machine" in b.text], "the button"
        )
        buttons[0].click()
        old = f"{junction}_switch"
        page.write(f'input[aria-label="Name of machine {old}"]', machine)
        page.write(f'input[aria-label="State on of {machine}"]', on)
        page.until(lambda m=machine, o=on: page.one(f'input[aria-label="State {o} of {m}"]'), on)
        page.write(f'input[aria-label="State off of {machine}"]', off)
        page.until(lambda m=machine, o=off: page.one(f'input[aria-label="State {o} of {m}"]'), off)
    page.click('input[aria-label="S2 starts in blocks"]')
    guards = {
        "S1": ["time >= 0.05"],
        "S2": ["loop1.f < 0", "loop1.e > 0"],  # the first rule leaves `conducts`
    }
    for machine, texts in guards.items():
        for k, guard in enumerate(texts, 1):
            add = page.all(f'[data-machine="{machine}"] button')
            next(b for b in add if b.text == "Add rule").click()
            page.write(f'input[aria-label="Guard {k} of {machine}"]', guard)
    # names are completed at the caret, and what is wrong is told before it is written
    guard = page.one('input[aria-label="Guard 2 of S2"]')
    guard.click()
    guard.send_keys(" and loop1.g")
    page.until(lambda: "loop1.g" in page.one(".expression .wrong").text, "told as one types")
    guard.send_keys(Keys.BACKSPACE, "f", Keys.BACKSPACE)
    page.until(lambda: page.all(".expression [role=option]"), "names are offered")
    guard.send_keys(Keys.ARROW_DOWN, Keys.ENTER)
    assert guard.get_attribute("value") in ("loop1.e > 0 and loop1.e", "loop1.e > 0 and loop1.f")
    guard.send_keys(Keys.ESCAPE)
    page.until(lambda: not page.all(".expression .wrong"), "Escape brings back what was written")
    # strokes follow the mode that is drawn: both off, the coil has no cause but itself
    page.until(lambda: page.one('.modes select[aria-label^="State of S1"]'), "the modes")
    for machine, state in (("S1", "open"), ("S2", "blocks")):
        page.one(f'select[aria-label="State of {machine} that is drawn"]').send_keys(state)
    page.until(lambda: page.strokes("node -> I")[:1] == ["0 derivative"], "derivative causality")
    # run it
    page.click("#tab-model")
    page.write('.side input[aria-label="Until"]', "0.25 s")
    page.click("button.run")
    events = page.until(lambda: page.all("[data-event]"), "events")
    assert "mythical" in events[1].text
    events[1].click()
    page.until(lambda: page.one('[data-step="0"][aria-pressed="true"]'), "the instant")
    page.until(lambda: len(page.all(".node.off")) == 2, "both junctions are off")
    page.click('[data-step="1"]')
    page.until(lambda: len(page.all(".node.off")) == 1, "the diode conducts")
    # change a parameter, undo
    page.node("R").click()
    page.write('.side input[aria-label="Value"]', "20 ohm")
    file = tmp_path / "circuit.toml"
    page.until(lambda: "20 ohm" in file.read_text(), "the file has it")
    page.one('button[aria-label="Undo"]').click()
    page.until(lambda: "10 ohm" in file.read_text(), "undone")
    # what is saved is the circuit, by its closed form
    run = hb.simulate(hb.load(file))
    assert run["I.f"].at(0.05) == pytest.approx(1 - 2.718281828459045**-5, rel=1e-9)
    # reopen
    again = Page(desk, serve("circuit.toml"))
    assert len(again.all("[data-node]")) == 7
    assert not again.complaints()


def test_by_keyboard_alone(desk: Any, serve: Callable[[str], str], tmp_path: Path) -> None:
    from selenium.webdriver.common.keys import Keys

    page = Page(desk, serve("keys.toml"))
    for words in ("Se 10", "1 j", "I coil 0.5", "R r 2"):
        page.keys("a")
        page.until(lambda: page.one(".quick input"), "the box")
        page.keys(words, Keys.ENTER)
        page.until(lambda: not page.all(".quick"), words)
    for bond in ("Se -> j", "j -> coil", "j -> r"):
        page.keys("a")
        page.until(lambda: page.one(".quick input"), "the box")
        page.keys(bond, Keys.ENTER)
        page.until(lambda b=bond: page.one(f'[data-text="{b}"]'), bond)
        page.until(lambda: not page.all(".quick"), bond)
    page.until(lambda: page.strokes("j -> coil") == ["1"], "strokes")
    # along bonds with arrows; b bonds, Escape leaves it
    page.keys(Keys.ESCAPE, Keys.ARROW_RIGHT)
    chosen = page.until(lambda: page.one("[data-node].selected"), "a node is selected")
    before = chosen.get_attribute("transform")
    page.chord(Keys.ALT, Keys.ARROW_DOWN)
    page.until(
        lambda: page.one("[data-node].selected").get_attribute("transform") != before, "moved"
    )
    page.chord(Keys.CONTROL, "z")
    page.until(
        lambda: page.one("[data-node].selected").get_attribute("transform") == before, "undone"
    )
    page.keys("]", Keys.DELETE)
    page.until(lambda: len(page.all("[data-bond]")) < 3, "a bond is deleted")
    page.chord(Keys.CONTROL, "z")
    page.until(lambda: len(page.all("[data-bond]")) == 3, "and back")
    page.chord(Keys.CONTROL, Keys.ENTER)
    page.until(lambda: page.all(".events .status.ok"), "it ran")
    data = tomllib.loads((tmp_path / "keys.toml").read_text())
    assert data["elements"]["coil"] == {"I": "0.5"}
    # one-ports hang above and below the junction, not in one row that bonds would run through
    assert data["layout"] == {"Se": [0, 0], "j": [1, 0], "coil": [1, -1], "r": [1, 1]}


def test_a_part_is_found_by_its_name_on_the_shelf_in_use_and_given_one(
    desk: Any, serve: Callable[[str], str], tmp_path: Path
) -> None:
    from selenium.webdriver.common.keys import Keys

    page = Page(desk, serve("parts.toml"))
    for words in ("inertia flywheel", "damper", "frame"):
        page.keys("a")
        page.until(lambda: page.one(".quick input"), "the box")
        page.keys(words)
        page.until(lambda: page.all(".quick li"), "what is offered")
        page.keys(Keys.ENTER)
        page.until(lambda: not page.all(".quick"), words)
    data = tomllib.loads((tmp_path / "parts.toml").read_text())
    assert data["elements"] == {
        "flywheel": {"submodel": "rotational.inertia"},
        "damper": {"submodel": "rotational.damper"},
        "frame": {"submodel": "rotational.frame"},
    }
    boxes = [frame.rect for frame in page.all("[data-node] rect.frame")]
    edges = sorted((box["x"], box["x"] + box["width"]) for box in boxes)
    assert len(edges) == 3
    assert all(one[1] < other[0] for one, other in itertools.pairwise(edges)), "no part on another"


def test_what_is_laid_out_anew_is_shown_as_a_whole(
    desk: Any, serve: Callable[[str], str], tmp_path: Path
) -> None:
    text = "hybond = 1\n[elements]\nS = { Se = 1 }\nj = { junction = 1 }\nm = { I = 1 }\n"
    text += '[graph]\nbonds = ["S -> j -> m"]\n[layout]\nS = [0, 0]\nj = [20, 0]\nm = [40, 0]\n'
    (tmp_path / "wide.toml").write_text(text)
    page = Page(desk, serve("wide.toml"))
    page.until(lambda: page.one('[data-text="j -> m"]'), "it is open")
    boxes = "[data-node] .letters"
    before = [b.rect["height"] for b in page.all(boxes)]
    next(b for b in page.all("button") if b.text == "Arrange").click()
    page.until(lambda: page.all(boxes)[0].rect["height"] > 2 * before[0], "it fills the canvas")
    edge = page.one("svg.canvas, .canvas svg").rect
    for box in (b.rect for b in page.all(boxes)):
        assert edge["x"] < box["x"] < edge["x"] + edge["width"] - box["width"]


@pytest.mark.slow
def test_by_touch_on_a_telephone(serve: Callable[[str], str], tmp_path: Path) -> None:
    driver = browser(390, 800, touch=True)
    try:
        page = Page(driver, serve("touch.toml"))

        def tap(element: Any) -> None:
            driver.execute_script("arguments[0].scrollIntoView({block: 'nearest'})", element)
            box = driver.execute_script(
                "const r = arguments[0].getBoundingClientRect();"
                "return [r.x + r.width / 2, r.y + r.height / 2]",
                element,
            )
            point = {"x": box[0], "y": box[1]}
            send = driver.execute_cdp_cmd
            send("Input.dispatchTouchEvent", {"type": "touchStart", "touchPoints": [point]})
            send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})

        for kind, name in (("Se", "Se"), ("1", "loop"), ("I", "I")):
            tap(page.one('button[aria-label="Palette"]'))
            page.until(lambda: page.one(".palette.open"), "the palette")
            tap(page.one(f'[data-kind="{kind}"]'))
            page.until(lambda n=name: page.one(f'[data-node="{n}"].selected'), name)
        for tail, head in (("Se", "loop"), ("loop", "I")):
            tap(page.node(tail))
            page.until(lambda t=tail: page.one(f'[data-node="{t}"].selected'), tail)
            tap(page.one(f'[data-handle="{tail}"] circle:not(.hit)'))
            page.until(lambda: page.one(".wiretext"), "a bond is begun")
            tap(page.node(head))
            page.until(lambda t=tail, h=head: page.one(f'[data-text="{t} -> {h}"]'), head)
        page.until(lambda: page.strokes("loop -> I") == ["1"], "strokes")
        width = driver.execute_script("return document.documentElement.scrollWidth")
        assert width <= 390, "nothing is wider than the telephone"
    finally:
        driver.quit()


@pytest.mark.slow
def test_the_rod_falls_through_its_two_mythical_modes(
    desk: Any, serve: Callable[[str], str], tmp_path: Path
) -> None:
    from selenium.webdriver.common.keys import Keys

    (tmp_path / "rod.toml").write_text((EXAMPLES / "falling_rod.toml").read_text())
    page = Page(desk, serve("rod.toml"))
    page.click("button.run")
    page.until(lambda: page.all("[data-event]"), "events")
    run = hb.simulate(hb.load(EXAMPLES / "falling_rod.toml"))
    kinds = [[s.kind for s in e.steps] for e in run.events]
    event = max(range(len(kinds)), key=lambda k: kinds[k].count("mythical"))
    page.click(f'[data-event="{event}"]')
    seen = []
    for k in range(len(kinds[event])):
        page.click(f'[data-step="{k}"]')
        page.until(lambda n=k: page.one(f'[data-step="{n}"][aria-pressed="true"]'), f"step {k}")
        seen.append(page.one(".instant b").text)
    assert seen == kinds[event]
    # who gives power and who takes it there; equations as formulas
    page.click("#tab-power")
    page.until(lambda: page.one(".power-panel h2"), "power at the instant")
    next(b for b in page.all(".power-panel button") if b.text == "Energy up to it").click()
    page.until(lambda: "weight" in page.one(".power-panel .sankey").text, "energy from the start")
    page.click("#tab-equations")
    page.until(lambda: page.one(".formula math mtr"), "equations are set as formulas")
    # one signal over another
    next(e for e in page.all(".plotbar label") if "phase" in e.text).click()
    page.until(lambda: page.one(".phase .way"), "the phase plane")
    # friction over a range: below some value the rod slides, beyond it sticks
    page.click("#tab-model")
    page.click('button[aria-label="Sweep mu"]')
    for label, value in (("from", "0.2"), ("to", "0.3"), ("runs", "7")):
        field = page.one(f'input[aria-label="Sweep mu {label}"]')
        field.clear()
        field.send_keys(value)
    page.click(".sweepfields button")
    page.until(lambda: "7 runs" in page.one(".sweep [role=status]").text, "the sweep ends")
    modes = [w.text.strip() for w in page.all(".modemap figcaption span")]
    assert sorted(modes) == ["free", "left", "right", "stuck"]
    assert len(page.all(".modemap g")) == 7
    page.all(".modemap g")[3].click()
    page.until(lambda: page.one(".family .way.chosen"), "one member is chosen")
    # friction and inertia together: each pixel of the map says on which side of the boundary it is
    page.click("#tab-plan")
    page.write('input[aria-label="Values of factor 1"]', "0.2:0.4:0.02")
    next(b for b in page.all(".plan button") if b.text == "Add a factor").click()
    page.write('input[aria-label="Factor 2"]', "J")
    page.write('input[aria-label="Values of factor 2"]', "0.61:1.81:0.1")
    page.write('input[aria-label="Until of the sweep"]', "0.45 s")
    page.write('input[aria-label="Collect"]', "sequence, fnal(w.f)")
    page.until(lambda: "did you mean 'final'" in page.one(".plan .wrong").text, "told at its place")
    page.write('input[aria-label="Collect"]', "sequence, final(w.f)")
    page.until(lambda: page.one(".plan button.run").text == "▶ Run 143 members", "the plan")
    command = page.until(lambda: page.one(".plan .command code").text, "nothing is wrong")
    assert "--vary J=0.61:1.81:0.1 --until '0.45 s'" in command
    page.click(".plan button.run")
    page.until(lambda: "143 runs" in page.one(".planned [role=status]").text, "the sweep ends")
    keys = page.until(
        lambda: len(page.all(".outcomes .key")) == 2 and page.all(".outcomes .key"), "both regions"
    )
    inks = {k.text.strip(): k.find_element("css selector", "i") for k in keys}
    colours = {n: i.value_of_css_property("background-color") for n, i in inks.items()}
    assert sorted(colours) == ["free > left", "free > stuck"]
    places = page.until(
        lambda: all(ink != "0, 0, 0" for _, ink in drawn(page)) and drawn(page),
        "every cell is there",
    )
    checked = 0
    for (mu, inertia), ink in places:
        boundary = math.sin(0.85) * math.cos(0.85) / mu - math.sin(0.85) ** 2
        if abs(inertia - boundary) < 0.15:  # within a cell and its neighbour
            continue
        side = "free > stuck" if inertia > boundary else "free > left"
        assert colours[side].startswith(f"rgba({ink}") or colours[side] == f"rgb({ink})"
        checked += 1
    assert checked > 300
    # a click on the map opens the run behind it
    page.click(".outcomes canvas")
    page.until(lambda: "mu = 0.3, J = 1.21" in page.one(".plots .own").text, "the member's run")
    page.until(lambda: page.all("[data-event]"), "and its events")
    page.click(".plots .plotbar button")
    page.until(lambda: page.one(".outcomes circle.chosen"), "back at the map")
    # by keyboard: to the cell on the right, whose run Enter opens
    desk.execute_script("document.querySelector('.outcomes .area').focus()")
    page.keys(Keys.ARROW_RIGHT)
    page.until(lambda: "mu = 0.32, J = 1.21" in page.one(".outcomes output").text, "its neighbour")
    page.keys(Keys.ENTER)
    page.until(lambda: "mu = 0.32, J = 1.21" in page.one(".plots .own").text, "its run")
    # back, and what it was run with becomes the model's
    page.until(lambda: page.all(".trace"), "plots")
    page.click(".plots .plotbar button")
    take = page.until(
        lambda: [b for b in page.all(".planned .one button") if b.text == "Take these values"], "it"
    )
    take[0].click()
    page.until(
        lambda: (
            {"mu": 0.32, "J": "1.21 kg*m^2"}.items()
            <= tomllib.loads((tmp_path / "rod.toml").read_text())["parameters"].items()
        ),
        "the file has them",
    )
    assert not page.complaints()


def drawn(page: Page) -> list[tuple[tuple[float, float], str]]:
    """Return places on a map of outcomes, in the units of its axes, and the colours there."""
    found = page.driver.execute_script(
        "const c = document.querySelector('.outcomes canvas'), g = c.getContext('2d');"
        "const found = [], [a, b, d, e] = JSON.parse(c.dataset.span);"
        "for (let i = 0.5; i < 24; i++) for (let j = 0.5; j < 24; j++) {"
        "  const p = g.getImageData(c.width * i / 24, c.height * j / 24, 1, 1).data;"
        "  found.push([[a + (b - a) * i / 24, e - (e - d) * j / 24], `${p[0]}, ${p[1]}, ${p[2]}`]);"
        "}"
        "return found;"
    )
    return [((x, y), ink) for (x, y), ink in found]


@pytest.mark.slow
def test_the_schematic_stands_beside_the_bond_graph_with_one_selection(
    desk: Any, serve: Callable[[str], str], tmp_path: Path
) -> None:
    (tmp_path / "boost.toml").write_text((EXAMPLES / "boost.toml").read_text())
    page = Page(desk, serve("boost.toml"))
    next(b for b in page.all("header button") if b.text == "Schematic").click()
    page.until(lambda: page.one('[data-schematic="coil"] path.symbol'), "the schematic")
    # what is OFF is grey there as well, in the mode that is drawn
    page.until(lambda: page.one('[data-schematic="second"].off'), "the second load is off")
    page.one('select[aria-label="State of second.contact that is drawn"]').send_keys("closed")
    page.until(lambda: not page.all('[data-schematic="second"].off'), "it is on")
    page.click('[data-schematic="coil"] text')
    page.until(lambda: page.one('[data-node="coil"].selected'), "selected in the bond graph")
    page.node("node").click()
    page.until(lambda: page.one('[data-schematic="node"].selected'), "selected in the schematic")
    wire = page.all("[data-schematic] .wire")[0]
    key = desk.execute_script(
        "arguments[0].parentNode.dispatchEvent(new MouseEvent('click', {bubbles: true}));"
        "return arguments[0].parentNode.dataset.schematic",
        wire,
    )
    page.until(lambda: page.one(f'[data-text="{key}"].selected'), "its bond is selected")
    # a part that is moved is moved there as well
    before = page.one('[data-schematic="coil"] path.symbol').get_attribute("d")
    page.click('[data-schematic="coil"] text')
    page.until(lambda: page.one('[data-node="coil"].selected'), "the coil")
    desk.execute_script("document.querySelector('.canvas svg').focus()")
    from selenium.webdriver.common.keys import Keys

    page.chord(Keys.ALT, Keys.ARROW_UP)
    page.until(
        lambda: page.one('[data-schematic="coil"] path.symbol').get_attribute("d") != before,
        "the schematic follows",
    )
    assert not page.complaints()


MISSED = """
const missed = [];
const at = (x, y) => document.elementFromPoint(x, y)?.closest("[data-schematic]");
for (const g of document.querySelectorAll(".schematic g.part")) {
  const marks = [...g.querySelectorAll("path.symbol, path.filled")];
  const boxes = marks.map(e => e.getBoundingClientRect());
  const [x0, x1] = [Math.min(...boxes.map(r => r.left)), Math.max(...boxes.map(r => r.right))];
  const [y0, y1] = [Math.min(...boxes.map(r => r.top)), Math.max(...boxes.map(r => r.bottom))];
  for (const [u, v] of [[0.5, 0.5], [0.4, 0.6], [0.6, 0.4]])
    if (at(x0 + u * (x1 - x0), y0 + v * (y1 - y0)) !== g) missed.push(g.dataset.schematic);
}
return missed;
"""


def test_a_click_within_a_symbol_is_on_its_part(
    desk: Any, serve: Callable[[str], str], tmp_path: Path
) -> None:
    """Also where nothing is drawn, and in a picture that is small."""
    (tmp_path / "tanks.toml").write_text((EXAMPLES / "three_tanks.toml").read_text())
    page = Page(desk, serve("tanks.toml"))
    next(b for b in page.all("header button") if b.text == "Schematic").click()
    page.until(lambda: page.one('[data-schematic="second"] path.symbol'), "the schematic")
    assert desk.execute_script(MISSED) == []
    assert not page.complaints()


def test_axe_finds_nothing_serious_in_a_schematic(
    desk: Any, serve: Callable[[str], str], tmp_path: Path
) -> None:
    (tmp_path / "boost.toml").write_text((EXAMPLES / "boost.toml").read_text())
    page = Page(desk, serve("boost.toml"))
    next(b for b in page.all("header button") if b.text == "Schematic").click()
    page.until(lambda: page.one('[data-schematic="coil"] path.symbol'), "the schematic")
    assert with_axe(desk)() == []


@pytest.mark.slow
def test_axe_finds_nothing_serious_in_light_and_dark(
    desk: Any, serve: Callable[[str], str], tmp_path: Path
) -> None:
    (tmp_path / "rod.toml").write_text((EXAMPLES / "falling_rod.toml").read_text())
    page = Page(desk, serve("rod.toml"))
    found: dict[str, list[Any]] = {}
    axe = with_axe(desk)

    def look(where: str) -> None:
        found[where] = axe()

    look("drawn")
    page.click("button.run")
    page.until(lambda: page.all("[data-event]"), "events")
    page.click('[data-event="1"]')
    page.until(lambda: page.one('[data-step="0"][aria-pressed="true"]'), "the instant")
    for tab in ("machines", "problems", "table", "text", "equations", "power", "model"):
        page.click(f"#tab-{tab}")
        look(tab)
    page.click('button[aria-label="Sweep mu"]')
    page.click(".sweepfields button")
    page.until(lambda: "15 runs" in page.one(".sweep [role=status]").text, "the sweep ends")
    look("sweep")
    page.click("#tab-plan")
    page.until(lambda: page.one(".plan button.run").is_enabled(), "a plan to begin with")
    look("plan")
    page.click(".plan button.run")
    page.until(lambda: page.one(".planned [role=status]"), "it ends")
    page.until(lambda: page.one(".outcomes .key"), "its picture")
    look("scatter")
    next(b for b in page.all(".choices button") if b.text == "Table").click()
    page.until(lambda: page.one(".planned td"), "its table")
    look("table of the sweep")
    page.click('header button[aria-label="Dark or light"]')
    look("dark")
    assert not any(found.values()), found


@pytest.mark.slow
def test_the_geometry_of_the_page_is_that_of_printed_drawings(
    desk: Any, serve: Callable[[str], str], tmp_path: Path
) -> None:
    """Half arrow and strokes are computed twice, in Python and on the page: here they are one."""
    from hybond.draw.geometry import Box, bond_shape, stroke
    from hybond.draw.measure import width

    Page(desk, serve("empty.toml"))
    cases = [
        ((0.0, 0.0), (100.0, 0.0), 0.0),
        ((0.0, 0.0), (0.0, 84.0), 0.0),
        ((30.0, 10.0), (-60.0, 70.0), 4.5),
        ((0.0, 0.0), (-100.0, 0.0), -9.0),
        ((5.0, 5.0), (9.0, 6.0), 0.0),
    ]
    words = ["Se", "i_L = 12,3 kΩ", "MWÄß", "…→"]
    asked = json.dumps({"cases": cases, "words": words})
    found = desk.execute_script(f"return window.hybondGeometry({asked})")
    for (a, b, shift), (tail, head, barb, zero, one) in zip(cases, found["shapes"]):
        boxes = [Box(x - 8, y - 9, x + 8, y + 9) for x, y in (a, b)]
        shape = bond_shape(*boxes, a, b, shift=shift)
        flat = [shape.tail, shape.head, *shape.barb, *stroke(shape, 0), *stroke(shape, 1)]
        told = [tail, head, *barb, *zero, *one]
        assert [v for p in told for v in p] == pytest.approx([v for p in flat for v in p], abs=1e-9)
    assert found["widths"] == pytest.approx([width(w, 10.0) for w in words], abs=1e-9)
