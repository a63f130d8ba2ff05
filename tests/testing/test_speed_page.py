"""The page of speeds: a new table takes the place of the old one, and of nothing else."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))

from measuring.problem import C, Problem
from measuring.report import renewed
from measuring.slopes import Cost

TABLE = "| problem | tool |\n| --- | --- |\n| P1 | C |\n\n- a note\n\n"
OLD = "# Speed\n\n{}" + TABLE + "![bars](x.svg)\n\nend\n"


def test_a_new_table_takes_the_place_of_the_old_one_and_of_nothing_else() -> None:
    problem = Problem("P7", "ball", "bounce", (1.0, 2.0), (1.0, 2.0), {}, note="of this one")
    cost = Cost(problem, C, slopes=[1e-6], fixed=[0.0], ratio=1.0)
    page = renewed(OLD.format("A line of 1 | 2.\n\n"), [[cost]])
    assert page.startswith("# Speed\n\nA line of 1 | 2.\n\n| problem | tool | each |")
    assert page.endswith("- P7: of this one\n\n![bars](x.svg)\n\nend\n")
    assert "| P7 ball, per bounce | C | 1 µs | 1.00 |" in page
    assert "P1" not in page
    assert "a note" not in page


def test_the_page_has_one_table_before_its_picture() -> None:
    text = (Path(__file__).parents[2] / "docs" / "speed.md").read_text(encoding="utf-8")
    assert text.count("| problem |") == 1
    assert text.index("| problem |") < text.index("![")
