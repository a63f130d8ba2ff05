"""Hints: each at its line, gone when its remedy is followed, and none on the examples."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path
from typing import Any

import pytest
from listed import listed

import hybond as hb
from hybond.cli.main import main

ROOT = Path(__file__).parents[2]
PAGES = ROOT / "docs" / "errors"
TOML = re.compile(r"^```toml\n(.*?)^```$", re.M | re.S)
SAID = re.compile(r"^```text\n(.*?)^```$", re.M | re.S)

# code: what follows its remedy
MENDED = {
    "HB-H101": ('"C -> n"', '"n -> C"'),
    "HB-H102": ('20 A"]', '20 A", "hot -> on when R.f < 1 A"]'),
    "HB-H103": ("m = { junction = 0 }\n", ""),
    "HB-H104": ('C = "1 mF"', 'C = "1 mF", e = "1 V"'),
    "HB-H105": ('"r -> R"', '"r -> R", "g.pin -> a"'),
    "HB-H106": ('"2 ohm"', '"R1"'),
    "HB-H107": ("V -> n", "V -> sw -> n"),
    "HB-H108": ('Se = "10 V"', 'Se = "u"'),
    "HB-H110": ('right -> m.flange"', 'right -> m.flange", "pad.left -> wall.flange"'),
    "HB-H109": ('start = "on"', 'start = "on"\nrules = ["on -> off when time > 1"]'),
    "HB-H111": ("abs(n.f) < 0 A", "abs(n.f) < 1 mA"),
    "HB-H112": ('"-2 N*s/m"', '"2 N*s/m"'),
}


def example(code: str) -> str:
    found = TOML.search((PAGES / f"{code}.md").read_text("utf-8"))
    assert found is not None
    return found[1]


@listed("code", sorted(MENDED))
def test_a_hint_says_what_its_page_says(code: str) -> None:
    checked = hb.loads(example(code), where="circuit.toml").check()
    assert checked.ok
    (hint,) = checked
    assert hint.code == code
    page = SAID.search((PAGES / f"{code}.md").read_text("utf-8"))
    assert page is not None
    lines = [line for line in str(hint).splitlines() if " | " not in line]
    assert lines == page[1].splitlines()
    assert hint.written == example(code).splitlines()[(hint.line or 0) - 1]


@listed("code", sorted(MENDED))
def test_a_remedy_takes_the_hint_away(code: str) -> None:
    old, new = MENDED[code]
    text = example(code).replace(old, new)
    assert text != example(code)
    if "wall.flange" in new:
        frame = 'wall = { submodel = "translational.frame" }'
        text = text.replace("[elements]\n", f"[elements]\n{frame}\n")
    if "g.pin" in new:
        text = text.replace("[elements]\n", '[elements]\ng = { submodel = "electrical.ground" }\n')
    checked = hb.loads(text).check()
    assert checked.ok and [h.code for h in checked] == []


def test_every_hint_has_been_looked_at() -> None:
    assert sorted(MENDED) == sorted(p.stem for p in PAGES.glob("HB-H*.md"))


@listed("path", sorted((ROOT / "examples").glob("*.toml")))
def test_examples_have_no_hints(path: Path) -> None:
    checked = hb.load(path).check()
    assert checked.ok and not len(checked), repr(checked)


def test_what_is_meant_is_no_hint() -> None:
    # a switch thrown once, gears that follow each other, and two models side by side
    for rules in (["on -> off when time >= 1 s"], ["on -> off when R.f > 20 A"]):
        text = example("HB-H109").replace('start = "on"', f'start = "on"\nrules = {rules}')
        assert not len(hb.loads(text.replace("'", '"')).check())
    m = hb.Model("pair")
    m.add(a=hb.C(1, q=1), b=hb.R(1), n=hb.Zero(), c=hb.C(1, q=2), d=hb.R(1), k=hb.Zero())
    m.bond("n -> a", "n -> b", "k -> c", "k -> d")
    assert not len(m.check())


def test_a_model_without_meaning_is_told_and_not_raised() -> None:
    m = hb.Model("half")
    m.add(r=hb.R(1))
    checked = m.check()
    assert not checked and checked.error is not None and checked.error.code == "HB-M130"
    assert "HB-M130" in repr(checked) and "HB-M130" in checked._repr_html_()


def test_the_command_line_tells_hints_with_places(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "c.toml"
    path.write_text(example("HB-H106"))
    assert main(["check", str(path)]) == 0
    said = capsys.readouterr().out
    assert f"hint HB-H106 at {path}:4: parameters.R1" in said and said.endswith(
        "fine, with 1 hint\n"
    )
    assert main(["check", str(path), "--json"]) == 0
    data: dict[str, Any] = json.loads(capsys.readouterr().out)
    assert data["ok"] and [(h["code"], h["line"]) for h in data["hints"]] == [("HB-H106", 4)]
    path.write_text(example("HB-H106").replace('"2 ohm"', '"2 kg"'))
    assert main(["check", str(path), "--json"]) == 2
    data = json.loads(capsys.readouterr().out)
    assert not data["ok"] and data["error"]["line"] == 7 and data["error"]["file"] == str(path)


@pytest.mark.parametrize(
    ("value", "given"),
    [
        ([[1, 5], [-5, 1]], False),  # what goes in at one port comes out at the other
        ([[0, 3], [-3, 0]], False),
        ([[2, 1], [1, 0.5]], False),  # singular: it takes nothing of one direction
        ([[1, 2], [2, 1]], True),
        ([[1, 0], [0, -1e-3]], True),
    ],
)
def test_a_field_gives_energy_if_some_flow_gets_it(value: list[list[float]], given: bool) -> None:
    """The least of f'*M*f over flows of size one, asked at many directions."""
    flows = [(math.cos(k / 100), math.sin(k / 100)) for k in range(629)]
    least = min(
        sum(a * value[i][k] * b for i, a in enumerate(f) for k, b in enumerate(f)) for f in flows
    )
    assert (least < -1e-4) == given
    m = hb.Model("field")
    m.add(V=hb.Se(1), W=hb.Se(2), r=hb.R(value), a=hb.One(), b=hb.One())
    m.bond("V -> a -> r.1", "W -> b -> r.2")
    assert [h.code for h in m.check()] == (["HB-H112"] if given else [])
