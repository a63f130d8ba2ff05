"""A count of random models: a line for each seed, gone on with where it was ended."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))

from counting import Line, count, read, told, ways_of

from hybond.testing import WAYS, Finding


def test_a_count_goes_on_behind_what_is_there_and_behind_a_line_cut_off(tmp_path: Path) -> None:
    path = tmp_path / "count.jsonl"
    before = Line(1, "hang", 300.0)
    path.write_text(before.text + Line(2, "ok").text[:-9])
    count(range(1, 4), path, ways=1)
    lines = read(path)
    assert [line.seed for line in lines] == [1, 2, 3]
    assert lines[0] == before and lines[1].seconds > 0.0
    size = path.stat().st_size
    count(range(1, 4), path, ways=1)
    assert path.stat().st_size == size


def test_lines_are_read_as_they_were_written_and_told_by_outcome(tmp_path: Path) -> None:
    path = tmp_path / "count.jsonl"
    lines = [Line(7, "ok", 0.5, (Finding("order", "c.q = 1 or 2", 0.5),)), Line(8, "HB-C101", 0.1)]
    path.write_text("".join(line.text for line in lines))
    assert read(path) == lines
    text = told(lines)
    assert "1  HB-C101  8" in text and "7 (ok): c.q = 1 or 2" in text
    assert "2 seeds, 0.3 s each" in text


def test_ways_take_turns() -> None:
    assert [ways_of(seed, 1)[0] for seed in range(6)] == list(WAYS)
    assert sorted(ways_of(3, 6)) == sorted(WAYS)
