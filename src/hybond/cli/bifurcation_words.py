"""The options of ``hybond bifurcation``."""

from __future__ import annotations

from argparse import ArgumentParser
from typing import Any

from hybond.cli.shared_words import Verb, input_word, json_word, workers_word


def bifurcation_words(verb: Verb, verbs: Any) -> ArgumentParser:
    """Add ``hybond bifurcation``."""
    parser = verb(
        verbs,
        "bifurcation",
        "hybond bifurcation buck.toml --vary Iref=0.5..1.9:500 --period T --of L.f --plot buck.png",
        "hybond bifurcation stop.toml --vary w=2.4..3.6:300 --period '2*pi/w' --of v.f "
        "--direction both",
        "hybond bifurcation stop.toml --vary w=2.4..3.6:300 --at stop.impact --before --of v.f",
    )
    input_word(parser)
    parser.add_argument(
        "--vary",
        metavar="PATH=VALUES",
        action="append",
        required=True,
        help="what varies, and its values: LOW..HIGH:NUMBER, LOW:HIGH:STEP, V,W,...",
    )
    parser.add_argument(
        "--of",
        metavar="NAME,...",
        action="append",
        required=True,
        help="signals that are looked at",
    )
    parser.add_argument(
        "--period", metavar="T", help="look once in this time: '20 us', T, '2*pi/w'"
    )
    parser.add_argument(
        "--at", metavar="M.s", help="instead: look each time machine M enters its state s"
    )
    parser.add_argument(
        "--before", action="store_true", help="look before what happens there, not after it"
    )
    parser.add_argument(
        "--settle", metavar="N", type=int, default=300, help="periods passed over (default: 300)"
    )
    parser.add_argument(
        "--keep", metavar="N", type=int, default=64, help="samples of each value (default: 64)"
    )
    parser.add_argument(
        "--direction",
        metavar="WAY",
        default="fresh",
        help="where each value begins: fresh (as the model does), or where the one before has "
        "come: up, down, both",
    )
    parser.add_argument(
        "--windows", metavar="X", help="follow each orbit to where it ends, to within X"
    )
    parser.add_argument("--limit", metavar="T", help="of --at: how long a value may take")
    workers_word(parser)
    parser.add_argument("--plot", metavar="FILE", help="draw the diagram")
    parser.add_argument("--out", metavar="FILE", help="write all samples as .csv or .json")
    json_word(parser)
    return parser
