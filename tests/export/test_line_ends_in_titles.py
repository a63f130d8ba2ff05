"""A title may hold what Unicode calls the end of a line: C and Java do not."""

from __future__ import annotations

from pathlib import Path

import pytest
from export.programs import ask, compile_quickly, needs_c

import hybond as hb

ENDS = ["\x0b", "\x0c", "\x1c", "\x1d", "\x1e", "\x85", "\u2028", "\u2029"]


def titled(mark: str) -> hb.Model:
    m = hb.Model("emptied")
    m.title = f"first{mark}second"
    m.about = f"a{mark}b"
    m.add(c=hb.C(1.0, q=1.0), r=hb.R(1.0), n=hb.Zero())
    m.bond("n -> c", "n -> r")
    m.experiment["until"] = 1.0
    return m


@needs_c
def test_a_program_in_c_says_its_title(tmp_path: Path) -> None:
    """Its title holds all marks at once."""
    text = hb.export(titled("".join(ENDS)), to="c")
    program = compile_quickly(text, tmp_path, "titled")
    assert "second" in ask(program, "--help").replace("\n", " ")


@pytest.mark.parametrize("to", ["c", "java"])
def test_no_text_is_broken(to: str) -> None:
    """A string that a mark had broken would leave an odd number of quotes on its line."""
    lines = hb.export(titled("-".join(ENDS)), to=to).split("\n")
    literal = [line for line in lines if line.lstrip().startswith('"') and "first" in line]
    assert all(line.count('"') % 2 == 0 for line in literal)
    assert any("first" in line and "second" in line for line in lines)
