"""hybond draw: one mode, the overview, panels; and what does not go together."""

from __future__ import annotations

import re
from typing import Any

import pytest

CHOPPER = """\
hybond = 1
domain = "electrical"
[elements]
V = { Se = "10 V" }
sw = { junction = 1 }
node = { junction = 0 }
r = { R = "1 ohm" }
c = { C = "1 mF" }
valve = { junction = 1 }
load = { R = "5 ohm" }
[graph]
bonds = ["V -> sw -> node -> c", "sw -> r", "node -> valve -> load"]
[machines.S]
states = { closed = ["sw"], open = [] }
start = "closed"
rules = ["closed -> open when time >= 1 s"]
[machines.D]
states = { closed = ["valve"], open = [] }
start = "closed"
rules = ["closed -> open when time >= 2 s"]
"""


@pytest.fixture
def svg(shell: Any) -> Any:
    """Draw the chopper with these options and return the SVG."""
    shell.file("chopper.toml", CHOPPER)

    def make(*options: str) -> str:
        done = shell("draw", "chopper.toml", *options, "--out", "it.svg")
        assert done.code == 0, done.err
        return (shell.folder / "it.svg").read_text(encoding="utf-8")

    return make


def captions(svg: str) -> list[str]:
    return re.findall(r'<text class="caption"[^>]*>([^<]*)</text>', svg)


def test_a_model_with_machines_is_drawn_as_an_overview(svg: Any) -> None:
    plain = svg()
    assert plain == svg("--hybrid")
    assert captions(plain)[0].startswith("reference mode: ")
    assert "stroke dynamic" in plain


def test_mode_is_the_reference_of_the_overview(svg: Any) -> None:
    found = svg("--hybrid", "--mode", "S=open")
    assert captions(found) == ["reference mode: S = open, D = closed"]


def test_one_mode_is_drawn_without_dashes(svg: Any) -> None:
    found = svg("--mode", "S=open")
    assert captions(found) == ["S = open, D = closed"]
    assert 'class="stroke dynamic' not in found


def test_a_model_without_machines_is_drawn_in_its_only_mode(shell: Any) -> None:
    assert shell("draw", "spring.toml").code == 0
    found = (shell.folder / "spring.svg").read_text(encoding="utf-8")
    assert captions(found) == []
    assert found.count('class="stroke"') == 2


def test_panels_of_all_modes_or_of_those_named(svg: Any) -> None:
    assert len(captions(svg("--panels"))) == 4
    several = svg("--mode", "S=open", "--mode", "S=open,D=open")
    assert several == svg("--panels", "--mode", "S=open", "--mode", "S=open,D=open")
    named = [c.removeprefix("reference mode: ") for c in captions(several)]
    assert {"S = open, D = closed", "S = open, D = open"} <= set(named)
    one, two = svg("--panels", "--columns", "1"), svg("--panels", "--columns", "4")
    width = [float(re.findall(r'width="([\d.]+)"', s)[0]) for s in (one, two)]
    assert width[1] > 3 * width[0]


def test_legend_and_numbers(svg: Any) -> None:
    assert 'class="legend"' in svg("--legend")
    for kind in ("--hybrid", "--panels", "--mode=S=open"):
        assert 'class="legend"' not in svg(kind, "--no-legend")
        assert 'class="number' in svg(kind, "--numbers")


def test_tikz_is_written_by_its_ending(shell: Any) -> None:
    shell.file("chopper.toml", CHOPPER)
    assert shell("draw", "chopper.toml", "--panels", "--out", "it.tex").out == "it.tex\n"
    text = (shell.folder / "it.tex").read_text(encoding="utf-8")
    assert r"\begin{tikzpicture}" in text and text.endswith("\\end{tikzpicture}\n")


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--hybrid", "--panels"], "not allowed"),
        (["--hybrid", "--mode", "S=open", "--mode", "S=closed"], "one reference mode"),
        (["--columns", "2"], "only with --panels"),
        (["--panels", "--columns", "0"], "at least one column"),
        (["--panels", "--mode", "S=opn"], "'open'"),
        (["--out", "it.gif"], ".tex"),
    ],
)
def test_what_does_not_go_together_is_refused(shell: Any, options: list[str], said: str) -> None:
    shell.file("chopper.toml", CHOPPER)
    done = shell("draw", "chopper.toml", *options)
    assert done.code == 1 and said in done.err
    assert not list(shell.folder.glob("*.svg"))


DIVIDER = """\
hybond = 1
domain = "electrical"
[elements]
source = { submodel = "electrical.voltage_source", parameters = { U = "24 V" } }
load = { submodel = "electrical.resistor" }
ground = { submodel = "electrical.ground" }
[graph]
bonds = ["source.plus -> load.plus", "load.minus -> source.minus", "source.minus -> ground.pin"]
"""


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("source.plus -> load", "source.pluss -> load", "HB-M101 at parts.toml:8: graph.bonds[0]:"),
        ("24 V", "24 A", "HB-U103 at parts.toml:4: source.U: '24 A' is in A; the parameter U of"),
        ("U =", "V =", "HB-M107 at parts.toml:4: source.V:"),
        ("source.minus -> gr", "source.minus -> lo", "HB-M101 at parts.toml:8: graph.bonds[2]:"),
    ],
)
def test_no_schematic_is_drawn_of_what_means_nothing(
    shell: Any, old: str, new: str, said: str
) -> None:
    shell.file("parts.toml", DIVIDER.replace(old, new))
    done = shell("draw", "parts.toml", "--schematic")
    assert done.code == 2 and done.err.startswith(said)
    assert not list(shell.folder.glob("*.svg"))
    shell.file("parts.toml", DIVIDER)
    assert shell("draw", "parts.toml", "--schematic").out == "parts.svg\n"
