"""The options of ``hybond sweep``, and which of them make a plan of it."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from typing import Any

from hybond.cli.run_words import settings_words, solver_words
from hybond.cli.shared_words import Verb, file_word, json_word, workers_word

SWITCHES = ("collect", "sample", "estimate", "cluster", "runs")
NUMBERS = ("seed", "part")
"""Any of them makes a sweep one whose rows are collected in a folder."""


def sweep_words(verb: Verb, verbs: Any) -> None:
    """Add the verb."""
    sweep = verb(
        verbs,
        "sweep",
        "hybond sweep ball.toml --vary m=1..2kg:11 --out masses.csv",
        "hybond sweep ball.toml --vary m=1kg,2kg --vary h0=1..3:5 --signals height",
        "hybond sweep ball.toml --vary 'm=normal(1 kg, 50 g)' --sample lhs:1000 --seed 7 "
        "--collect 'final(ball.p), count(events)' --out masses",
    )
    file_word(sweep)
    sweep.add_argument(
        "--vary",
        metavar="PATH=VALUES",
        action="append",
        default=[],
        help="PATH and values: LOW..HIGH:NUMBER, LOW:HIGH:STEP, log(LOW,HIGH,NUMBER), V,W,... "
        "or with --sample a distribution; several options: all combinations",
    )
    sweep.add_argument(
        "--together", action="store_true", help="the first values of all, the second, ...: no grid"
    )
    plan_words(sweep)
    settings_words(sweep)
    solver_words(sweep)
    sweep.add_argument(
        "--signals", metavar="NAME,...", action="append", help="what is read at the end"
    )
    workers_word(sweep)
    sweep.add_argument(
        "--out",
        metavar="FILE",
        help="write the table as .csv, .npz or .json; of --collect: a folder",
    )
    json_word(sweep)


def plan_words(parser: ArgumentParser) -> None:
    """Add those of a plan."""
    parser.add_argument(
        "--collect",
        metavar="WHAT,...",
        action="append",
        default=[],
        help="what is collected of each run: 'final(x), max(x), count(events), first(M.s)'; "
        "--out is a folder then, and the same command goes on where it was",
    )
    parser.add_argument(
        "--sample",
        metavar="WAY:N",
        help="draw N members: random, lhs, sobol, saltelli; or ends, for a tornado",
    )
    parser.add_argument("--seed", metavar="N", type=int, help="of --sample (default: 0)")
    parser.add_argument(
        "--runs", metavar="FORM", help="of --collect: keep full runs too, as netcdf or zarr"
    )
    parser.add_argument(
        "--cluster", metavar="ADDRESS", help="of --collect: a scheduler of Dask, tcp://HOST:PORT"
    )
    parser.add_argument(
        "--part",
        metavar="N",
        type=int,
        help="of --collect: members written at once (default: as many as run in two seconds)",
    )
    parser.add_argument(
        "--estimate", action="store_true", help="of --collect: say what it takes, and run nothing"
    )


def is_plan(given: Namespace) -> bool:
    """Whether the options of a sweep make a plan of it."""
    numbers = any(getattr(given, name) is not None for name in NUMBERS)
    return numbers or any(getattr(given, name) for name in SWITCHES)
