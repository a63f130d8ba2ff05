"""The session of the studio: what a page asks is done to the file, and never lost."""

from __future__ import annotations

import base64
import tomllib
from pathlib import Path
from typing import Any

import pytest
from studio.asking import asked, edit

import hybond as hb
from hybond.causality.dynamics import causality_of
from hybond.causality.reference import reference_mode
from hybond.studio.document import Document
from hybond.studio.recovery import Recovery
from hybond.studio.session import Session

EXAMPLES = Path(__file__).parents[2] / "examples"
MODELS = sorted(p for p in EXAMPLES.glob("*.toml") if not p.name.startswith("_"))
WIDE = (
    "diode_bridge",
    "parallel_resonant_converter",
    "rectifier_dc_machine",
    "six_pulse_rectifier",
    "woodpecker",
)
"""Examples whose places take seconds to find: `tests/draw` looks at these, too."""


def drawn(session: Session) -> None:
    """Draw the circuit of Mosterman and Biswas: source, switch, coil, diode."""
    for name, element, at in (
        ("V", {"Se": "10 V"}, [0, 0]),
        ("switch", {"junction": 1}, [1, 0]),
        ("R", {"R": "10 ohm"}, [1, 1]),
        ("node", {"junction": 0}, [2, 0]),
        ("L", {"I": "0.1 H"}, [2, -1]),
        ("diode", {"junction": 1}, [3, 0]),
        ("drop", {"Se": "0.7 V"}, [4, 0]),
    ):
        edit(session, do="add", name=name, element=element, at=at)
    for tail, head in (
        ("V", "switch"),
        ("switch", "node"),
        ("node", "L"),
        ("switch", "R"),
        ("diode", "node"),
        ("diode", "drop"),
    ):
        edit(session, do="bond", tail=tail, head=head)
    for name, machine in (
        (
            "Sw",
            {
                "states": {"closed": ["switch"], "open": []},
                "start": "closed",
                "rules": ["closed -> open when time >= 0.05"],
            },
        ),
        (
            "D",
            {
                "states": {"blocks": [], "conducts": ["diode"]},
                "start": "blocks",
                "rules": [
                    "blocks -> conducts when diode.e > 0",
                    "conducts -> blocks when diode.f < 0",
                ],
            },
        ),
    ):
        edit(session, do="set", path=["machines", name], value=machine)
    edit(session, do="set", path=["experiment"], value={"until": "0.1 s", "plot": ["L.f"]})


def test_a_circuit_drawn_edit_by_edit_is_the_circuit(tmp_path: Path) -> None:
    session = Session(tmp_path / "diode.toml", journal=False)
    drawn(session)
    model = hb.load(tmp_path / "diode.toml")
    run = hb.simulate(model)
    # closed form: the current rises to 1 A with L/R = 10 ms, then sinks by 0.7 V / 0.1 H
    top = 1 - 2.718281828459045**-5
    assert run["L.f"].at(0.05) == pytest.approx(top, rel=1e-9)
    assert run["L.f"].at(0.1) == pytest.approx(top - 0.35, rel=1e-9)
    steps = [s.kind for e in run.events if e.t == pytest.approx(0.05) for s in e.steps]
    assert steps == ["mythical", "continuous"]


def test_strokes_come_with_each_edit_before_the_model_means_anything() -> None:
    session = Session(None)
    edit(session, do="add", name="V", element={"Se": "10 V"})
    edit(session, do="add", name="j", element={"junction": 1})
    edit(session, do="add", name="loose", element={"R": "x + y"})
    look = edit(session, do="bond", tail="V", head="j")
    assert not look["whole"]
    assert look["problems"][0]["code"] == "HB-M130"
    assert look["problems"][0]["select"] == {"nodes": ["loose"]}
    assert look["strokes"]["bonds"]["V -> j"]["strokes"] == [1]
    # an inertia on a 1-junction takes the effort: integral causality
    edit(session, do="add", name="m", element={"I": 1})
    look = edit(session, do="bond", tail="j", head="m")
    assert look["strokes"]["bonds"]["j -> m"] == {"strokes": [1], "integral": True}


def test_strokes_follow_the_mode_that_is_shown() -> None:
    session = Session(None)
    asked(session, "open", example="diode_inductor")
    closed = asked(session, "look", mode={"Sw": "closed", "D": "blocks"})
    neither = asked(session, "look", mode={"Sw": "open", "D": "blocks"})
    assert not closed["strokes"]["nodes"]["L"].get("derivative")
    assert neither["strokes"]["nodes"]["L"]["derivative"]
    assert neither["strokes"]["nodes"]["switch"]["off"]
    assert [m["state"] for m in neither["machines"]] == ["open", "blocks"]


@pytest.mark.sampled(4)
@pytest.mark.parametrize(
    "file",
    [pytest.param(p, marks=[pytest.mark.slow] * (p.stem in WIDE)) for p in MODELS],
    ids=lambda p: p.stem,
)
def test_every_example_opens_with_the_strokes_that_are_printed(file: Path) -> None:
    session = Session(None)
    look = asked(session, "open", example=file.stem)
    graph = hb.load(file).flatten()
    assert look["whole"], look["problems"]
    found = causality_of(graph, graph.start_mode, reference=reference_mode(graph))
    by_name = {b.name: found.strokes[b.index] for b in graph.bonds}
    seen = {b["text"]: look["strokes"]["bonds"][b["key"]]["strokes"] for b in look["view"]["bonds"]}
    assert seen
    assert all(ends == [by_name[text]] for text, ends in seen.items())


def test_comments_order_and_spelling_survive(tmp_path: Path) -> None:
    file = tmp_path / "ball.toml"
    file.write_text((EXAMPLES / "bouncing_ball.toml").read_text())
    before = file.read_text().splitlines()
    session = Session(file, journal=False)
    edit(session, do="set", path=["parameters", "m"], value="2 kg")
    edit(session, do="move", at={"ball": [1.25, -1]})
    after = file.read_text().splitlines()
    differing = [(a, b) for a, b in zip(before, after) if a != b]
    assert differing == [
        ('m = "1 kg"', 'm = "2 kg"'),
        ("ball    = [1, -1]", "ball    = [1.25, -1]"),
    ]
    assert len(before) == len(after)


def test_undo_gives_back_the_file_bit_for_bit(tmp_path: Path) -> None:
    file = tmp_path / "ball.toml"
    file.write_text((EXAMPLES / "bouncing_ball.toml").read_text())
    texts = [file.read_text()]
    session = Session(file, journal=False)
    for change in (
        {"do": "remove", "names": ["damper", "contact"]},
        {"do": "rename", "old": "v", "new": "speed"},
        {"do": "add", "stem": "R", "element": {"R": 1}, "at": [5, 5]},
        {"do": "reverse", "bonds": ["0.0"]},
    ):
        edit(session, **change)
        texts.append(file.read_text())
    for text in reversed(texts[:-1]):
        asked(session, "undo")
        assert file.read_text() == text
    for text in texts[1:]:
        asked(session, "redo")
        assert file.read_text() == text


def test_renaming_goes_through_bonds_guards_and_signals(tmp_path: Path) -> None:
    session = Session(None, text=(EXAMPLES / "bouncing_ball.toml").read_text())
    before = hb.simulate(hb.loads(session.document.text), until="1 s")
    edit(session, do="rename", old="v", new="speed")
    edit(session, do="rename", old="height", new="h")
    edit(session, do="rename", old="g", new="gravity")
    after = hb.simulate(hb.loads(session.document.text), until="1 s")
    assert after["h"].at(1.0) == before["height"].at(1.0)
    assert len(after.events) == len(before.events)


def test_renaming_a_state_goes_through_laws_and_guards_that_ask_for_it() -> None:
    session = Session(None, text=(EXAMPLES / "falling_rod.toml").read_text())
    before = hb.simulate(hb.loads(session.document.text))
    edit(session, do="rename state", machine="tip", old="left", new="slips_left")
    text = session.document.text
    assert 'tip.state == "left"' not in text and 'tip.state == "slips_left"' in text
    after = hb.simulate(hb.loads(text))
    assert after.final == before.final
    assert len(after.events) == len(before.events) == 3
    for wrong in ("right", "no name", ""):
        answer = session.handle(
            {"id": 1, "ask": "edit"}
            | {"edit": {"do": "rename state", "machine": "tip", "old": "slips_left", "new": wrong}}
        )
        assert answer["error"]["code"] == "HB-W101", wrong
    assert session.document.text == text


def test_a_copy_pasted_is_a_second_circuit_with_names_of_its_own() -> None:
    session = Session(None)
    asked(session, "open", example="diode_inductor")
    names = [n["name"] for n in asked(session, "look")["view"]["nodes"]]
    text = asked(session, "copy", names=names)["text"]
    look = asked(session, "paste", text=text, by=[0, 4])
    assert len(look["view"]["nodes"]) == 2 * len(names)
    assert len(look["pasted"]) == len(names)
    assert len(look["panels"]["machines"]) == 4
    model = hb.loads(session.document.text)
    run = hb.simulate(model)
    assert run["L1.f"].at(0.1) == run["L.f"].at(0.1)


def test_an_edit_that_was_answered_survives_a_crash_before_its_text(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HYBOND_STATE", str(tmp_path / "state"))
    file = tmp_path / "m.toml"
    file.write_text("hybond = 1\n")
    document = Document(file, journal=Recovery(file))
    document.edit({"do": "add", "name": "a", "element": {"junction": 1}})
    document.settle()
    document.edit({"do": "add", "name": "b", "element": {"junction": 0}})
    # the program is killed here: what it holds is gone, the file has only the first edit
    assert set(tomllib.loads(file.read_text())["elements"]) == {"a"}
    again = Document(file, journal=Recovery(file))
    assert set(tomllib.loads(again.text)["elements"]) == {"a", "b"}
    assert set(tomllib.loads(file.read_text())["elements"]) == {"a", "b"}
    again.undo()
    again.undo()
    assert again.text == "hybond = 1\n"


def test_a_half_written_journal_is_read_as_far_as_it_goes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HYBOND_STATE", str(tmp_path / "state"))
    file = tmp_path / "m.toml"
    journal = Recovery(file)
    journal.keep("hybond = 1\n")
    journal.close()
    with journal.path.open("a") as more:
        more.write('{"edit": {"do": "add", "ele')
    assert Recovery(file).remembered().texts == ["hybond = 1\n"]


def test_what_another_program_wrote_is_taken_and_undo_brings_ours_back(tmp_path: Path) -> None:
    file = tmp_path / "m.toml"
    file.write_text("hybond = 1\n")
    session = Session(file, journal=False)
    edit(session, do="add", name="ours", element={"junction": 1})
    file.write_text("hybond = 1\n[elements]\ntheirs = { junction = 0 }\n")
    look = asked(session, "look")
    assert [n["name"] for n in look["view"]["nodes"]] == ["theirs"]
    look = asked(session, "undo")
    assert [n["name"] for n in look["view"]["nodes"]] == ["ours"]


def test_one_writer_per_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HYBOND_STATE", str(tmp_path / "state"))
    file = tmp_path / "m.toml"
    file.write_text("hybond = 1\n")
    one, two = Session(file), Session(file)
    assert one.writable and not two.writable
    answer = two.handle({"id": 1, "ask": "edit", "edit": {"do": "add", "element": {"junction": 1}}})
    assert answer["error"]["code"] == "HB-W105"
    one.close()
    assert Session(file).writable


def test_a_disk_that_is_full_loses_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "m.toml"
    file.write_text("hybond = 1\n")
    session = Session(file, journal=False)

    def full(*_: Any) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("hybond.studio.document.write_whole", full)
    edit(session, do="add", name="a", element={"junction": 1})
    assert asked(session, "look")["unsaved"] == "No space left on device"
    assert file.read_text() == "hybond = 1\n"
    monkeypatch.undo()
    edit(session, do="add", name="b", element={"junction": 1})
    assert asked(session, "look")["unsaved"] == ""
    assert set(tomllib.loads(file.read_text())["elements"]) == {"a", "b"}


def test_a_text_that_cannot_be_read_is_kept_and_told() -> None:
    session = Session(None)
    edit(session, do="add", name="a", element={"junction": 1})
    look = asked(session, "replace", text="hybond = 1\n[elements]\na = { junction = ")
    assert look["problems"][0]["code"] == "HB-F105"
    assert look["problems"][0]["line"] == 3
    answer = session.handle({"id": 2, "ask": "edit", "edit": {"do": "remove", "names": ["a"]}})
    assert answer["error"]["code"] == "HB-W102"
    assert [n["name"] for n in asked(session, "undo")["view"]["nodes"]] == ["a"]


@pytest.mark.parametrize(
    ("message", "code"),
    [
        ({"ask": "edit", "edit": {"do": "fly"}}, "HB-W101"),
        ({"ask": "edit", "edit": 3}, "HB-W101"),
        ({"ask": "edit", "edit": {"do": "bond", "tail": "a", "head": "zz"}}, "HB-W101"),
        ({"ask": "edit", "edit": {"do": "add", "element": {"R": 1}, "at": ["x", 1]}}, "HB-W101"),
        ({"ask": "edit", "edit": {"do": "add", "element": {"R": 1}, "name": "pre"}}, "HB-W101"),
        ({"ask": "edit", "edit": {"do": "set", "path": ["hybond"], "value": 2}}, "HB-W101"),
        ({"ask": "edit", "edit": {"do": "remove"}, "level": "x"}, ""),
        ({"ask": "edit", "edit": {"do": "move", "level": "not.there"}}, "HB-W101"),
        ({"ask": "curves", "run": 99}, "HB-W103"),
        ({"ask": "run", "options": {"on_error": "raise"}}, "HB-W103"),
        ({"ask": "open", "file": "../../etc/passwd.toml"}, "HB-W104"),
        ({"ask": "open", "file": "/etc/passwd"}, "HB-W104"),
        ({"ask": "save as", "file": "../up.toml"}, "HB-W104"),
        ({"ask": "open", "example": "../pyproject"}, "HB-W104"),
        ({"ask": "exec"}, "HB-W101"),
        ({}, "HB-W101"),
    ],
)
def test_what_cannot_be_done_is_refused(message: dict[str, Any], code: str, tmp_path: Path) -> None:
    session = Session(None, text="hybond = 1\n[elements]\na = { junction = 1 }\n", root=tmp_path)
    answer = session.handle({"id": 5, **message})
    assert answer["id"] == 5
    assert answer.get("error", {}).get("code", "") == code
    assert session.document.text.startswith("hybond = 1")


@pytest.mark.slow
def test_a_part_is_opened_to_look_at_and_not_to_change() -> None:
    session = Session(None)
    asked(session, "open", example="boost")
    look = asked(session, "look", level="diode")
    assert not look["view"]["editable"]
    assert {n["name"] for n in look["view"]["nodes"]} >= {"plus", "minus", "i"}
    assert look["strokes"]["bonds"]["0.0"]["strokes"]
    answer = session.handle(
        {"id": 1, "ask": "edit", "edit": {"do": "remove", "names": ["i"], "level": "diode"}}
    )
    assert answer["error"]["code"] == "HB-W101"


def test_a_submodel_of_the_file_is_edited_where_it_is_said() -> None:
    text = (
        "hybond = 1\n[models.wheel]\n[models.wheel.elements]\nm = { I = 1 }\nv = { junction = 1 }\n"
        '[models.wheel.graph]\nbonds = ["v -> m"]\n[models.wheel.ports]\nhub = "v"\n'
        '[elements]\nF = { Se = 1 }\nleft = { submodel = "wheel" }\n'
        '[graph]\nbonds = ["F -> left.hub"]\n'
    )
    session = Session(None, text=text)
    look = edit(session, do="set", path=["elements", "m"], value={"I": 3}, level="left")
    assert tomllib.loads(session.document.text)["models"]["wheel"]["elements"]["m"] == {"I": 3}
    assert look["whole"], look["problems"]


def test_places_are_kept_in_cells_and_arranging_keeps_what_is_chosen() -> None:
    session = Session(None)
    asked(session, "open", example="diode_inductor")
    edit(session, do="move", at={"V": [7, 7]})
    look = asked(session, "arrange", keep=["V"])
    at = {n["name"]: (n["x"], n["y"]) for n in look["view"]["nodes"]}
    assert at["V"] == (7, 7)
    assert len(set(at.values())) == len(at)


def test_the_printed_picture_is_that_of_the_mode_shown() -> None:
    session = Session(None)
    asked(session, "open", example="diode_inductor")
    mode = {"Sw": "open", "D": "blocks"}
    found = asked(session, "picture", form="svg", mode=mode)
    svg = base64.b64decode(found["content"]).decode()
    graph = hb.load(EXAMPLES / "diode_inductor.toml").flatten()
    assert svg == hb.draw_mode(graph, mode).svg()


def test_what_the_file_puts_nowhere_stays_where_it_is_shown() -> None:
    session = Session(None)
    asked(session, "open", example="diode_inductor")
    edit(session, do="set", path=["layout"], value=None)

    def places() -> dict[str, tuple[float, float]]:
        return {n["name"]: (n["x"], n["y"]) for n in asked(session, "look")["view"]["nodes"]}

    first = places()
    assert "layout" not in session.document.data
    # an edit that puts nothing down moves nothing, and writes no places
    key = asked(session, "look")["view"]["bonds"][0]["key"]
    edit(session, do="reverse", bonds=[key])
    edit(session, do="remove", names=[], bonds=[key])
    assert places() == first and "layout" not in session.document.data
    # one that does writes where all the others stand, so that they stand there again
    edit(session, do="move", at={"R": [5, 5]})
    assert places() == {**first, "R": (5.0, 5.0)}
    reopened = Session(None, text=session.document.text)
    again = {n["name"]: (n["x"], n["y"]) for n in asked(reopened, "look")["view"]["nodes"]}
    assert again == {**first, "R": (5.0, 5.0)}
    asked(session, "undo")
    assert places() == first and "layout" not in session.document.data
    asked(session, "redo")
    assert places()["R"] == (5.0, 5.0)
    for _ in range(9):
        asked(session, "undo")  # beyond the first edit: nothing more happens
    assert places().keys() == first.keys()


def test_an_edit_is_tried_without_being_done() -> None:
    session = Session(None)
    asked(session, "open", example="diode_inductor")
    before = session.document.text
    rules = ["blocks -> conducts when diode.g > 0"]
    bad = {"do": "set", "path": ["machines", "D", "rules"], "value": rules}
    problem = asked(session, "attempt", edit=bad)["problem"]
    assert problem["code"].startswith("HB-M") and "D" in problem["where"]
    good = {**bad, "value": ["blocks -> conducts when diode.e > 0"]}
    assert asked(session, "attempt", edit=good)["problem"] is None
    assert session.document.text == before and not session.document.can_undo
    assert "error" in session.handle({"id": 1, "ask": "attempt", "edit": {"do": "nonsense"}})


def test_values_are_those_of_the_file_also_where_one_is_wrong() -> None:
    text = """hybond = 1
[parameters]
m = "450 kgs"
[elements]
load = { I = "m" }
drag = { R = "50 ohm" }
v = { junction = 1 }
[graph]
bonds = ["v -> load", "v -> drag"]
"""
    seen = Session(None, text=text).handle({"id": 1, "ask": "look"})
    told = {n["name"]: n["says"] for n in seen["view"]["nodes"] if n["kind"] != "1"}
    assert told == {"load": "m", "drag": "50 Ω"}
    # nothing that the page would show in their place
    assert not any("says" in about for about in seen["strokes"]["nodes"].values())
    assert seen["strokes"]["bonds"]
