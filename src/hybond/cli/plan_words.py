"""The options of ``hybond sweep`` that make a plan of it."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace

SWITCHES = ("collect", "sample", "estimate", "cluster", "runs")
NUMBERS = ("seed", "part")
"""Any of them makes a sweep one whose rows are collected in a folder."""


def plan_words(parser: ArgumentParser) -> ArgumentParser:
    """Add them."""
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
    return parser


def is_plan(given: Namespace) -> bool:
    """Whether the options of a sweep make a plan of it."""
    numbers = any(getattr(given, name) is not None for name in NUMBERS)
    return numbers or any(getattr(given, name) for name in SWITCHES)
