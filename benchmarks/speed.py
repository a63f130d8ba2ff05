"""How far hybond and others are from hand-written C.

    python benchmarks/speed.py [P1 P3 ...] [--full] [--write table.md] [--plot bars.svg] [--renew]

Each problem is a model beside a C program that does the same job (`benchmarks/limit/`): the same
equations, Dormand and Prince at the same relative tolerance or a better method, the same guards on
the dense output, every event stored with its time, mode and state, 1,000 output points. Other
tools do it as their users write it; those that are not installed are left out.

A time is marginal: the slope between two lengths of run, tools taking turns, the median of the
turns. Beside it are what a run costs apart from its length (nothing where its first part is the
cheaper one, so that there is no such number), and how far the end is from a closed form, or from a
run of the C program with a far smaller tolerance (those of P5 and P11 have none: one is exact, the
other takes the same steps). Netlists (P13) are measured by what ngspice takes for the same deck.
`--renew`, on an idle machine, puts the table and its bars into docs/speed.md.
"""

from __future__ import annotations

import argparse
import os
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # the matrices are small

from measuring.report import bars, growth, markdown, plain, renewed
from measuring.slopes import TURNS, measured
from problems import ASKED, PROBLEMS

PAGE = Path(__file__).parents[1] / "docs" / "speed.md"


def main() -> None:
    """Measure, print a table, and write it where asked to."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("problems", nargs="*", metavar="P", help="such as P1; all of them if none")
    parser.add_argument("--full", action="store_true", help="the complete lengths; takes long")
    parser.add_argument("--turns", type=int, default=TURNS)
    parser.add_argument("--tools", nargs="+", help="these only; ratios need C among them")
    parser.add_argument("--write", type=Path, metavar="FILE.md", help="the table in Markdown")
    parser.add_argument("--plot", type=Path, metavar="FILE.svg", help="ratios as bars")
    parser.add_argument(
        "--renew", action="store_true", help="write the table and the bars of docs/speed.md"
    )
    options = parser.parse_args()
    if options.renew and (options.problems or options.tools):
        parser.error("--renew is of all problems and tools: the page has one table")
    known = PROBLEMS | ASKED
    if unknown := set(options.problems) - set(known):
        parser.error(f"no problem {', '.join(sorted(unknown))}; there are {', '.join(known)}")
    groups = []
    for key in options.problems or PROBLEMS:
        for problem in known[key](options.full):
            costs = measured(problem, options.full, options.turns, options.tools)
            print(plain(costs, header=not groups), flush=True)
            groups.append(costs)
    for line in growth(groups):
        print(line)
    if options.write:
        options.write.write_text(markdown(groups), encoding="utf-8")
    if options.plot:
        bars(groups, options.plot)
    if options.renew:
        PAGE.write_text(renewed(PAGE.read_text(encoding="utf-8"), groups), encoding="utf-8")
        bars(groups, PAGE.parent / "img" / "speed.svg")


if __name__ == "__main__":
    main()
