"""The options of ``hybond periodic``."""

from __future__ import annotations

from argparse import ArgumentParser
from typing import Any

from hybond.cli.shared_words import Verb, input_word, json_word, picture_word


def periodic_words(verb: Verb, verbs: Any) -> ArgumentParser:
    """Add ``hybond periodic``."""
    parser = verb(
        verbs,
        "periodic",
        "hybond periodic buck.toml --plot steady.png",
        "hybond periodic stick_slip.toml --settle '10 s'",
        "hybond periodic boost.toml --along 'D=0.3..0.7' --doublings 1 --plot branch.png",
    )
    input_word(parser)
    parser.add_argument(
        "--period",
        metavar="T",
        help="after which it repeats (default: what sources and inputs repeat with); where nothing "
        "drives the model a first guess",
    )
    parser.add_argument(
        "--multiple", metavar="N", type=int, default=1, help="how many of these periods it needs"
    )
    parser.add_argument(
        "--settle", metavar="T", help="how long it runs before the first step of Newton's method"
    )
    parser.add_argument(
        "--wrt", metavar="PATH,...", action="append", help="derivatives of the beginning by these"
    )
    parser.add_argument(
        "--along",
        metavar="PATH=FROM..TO",
        help="follow the orbit along a parameter, and name what it passes",
    )
    parser.add_argument(
        "--doublings",
        metavar="N",
        type=int,
        help="of --along: how many times branches of twice the period are followed",
    )
    parser.add_argument("--points", metavar="N", type=int, help="of --along: orbits at the least")
    parser.add_argument("--signals", metavar="NAME,...", action="append", help="what --plot shows")
    parser.add_argument("--solver", metavar="NAME", help="as for hybond run")
    parser.add_argument("--rtol", metavar="R", type=float, help="of the runs (default: 1e-10)")
    parser.add_argument("--max-step", metavar="H", help="longest step")
    picture_word(parser)
    json_word(parser)
    return parser
