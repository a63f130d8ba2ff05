"""The options of ``hybond measure``."""

from __future__ import annotations

from argparse import ArgumentParser
from typing import Any

from hybond.cli.shared_words import Verb, input_word, json_word


def measure_words(verb: Verb, verbs: Any) -> ArgumentParser:
    """Add ``hybond measure``."""
    parser = verb(
        verbs,
        "measure",
        "hybond measure buck.toml 'mean(L.f)' 'rms(C.e, period=20 us, periods=5)'",
        "hybond measure buck.toml 'thd(source.f, 50 Hz)' --json",
        "hybond measure buck.toml --losses --period '20 us' --power",
        "hybond measure buck.toml --losses --sankey losses.svg",
    )
    input_word(parser)
    parser.add_argument(
        "measures",
        metavar="MEASURE",
        nargs="*",
        help="a function of a signal (default: [experiment] measure)",
    )
    parser.add_argument(
        "--losses", action="store_true", help="where the energy came from and where it went"
    )
    parser.add_argument("--power", action="store_true", help="of --losses: the mean power, in W")
    parser.add_argument(
        "--depth", metavar="N", type=int, help="of --losses: add up parts below N levels"
    )
    parser.add_argument("--start", metavar="T", help="of --losses: where its window begins")
    parser.add_argument("--end", metavar="T", help="of --losses: where its window ends")
    parser.add_argument(
        "--period", metavar="T", help="of --losses: its window is the last period ('20 us')"
    )
    parser.add_argument("--periods", metavar="N", type=int, help="of --losses: or so many of them")
    parser.add_argument("--plot", metavar="FILE", help="of --losses: plot them over time")
    parser.add_argument("--sankey", metavar="FILE", help="of --losses: draw who gave and who took")
    parser.add_argument("--list", action="store_true", help="list the functions")
    json_word(parser)
    return parser
