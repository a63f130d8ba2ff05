"""The options of ``hybond fit``."""

from __future__ import annotations

from argparse import ArgumentParser
from typing import Any

from hybond.cli.run_words import option_word
from hybond.cli.shared_words import Verb, input_word, json_word


def fit_words(verb: Verb, verbs: Any) -> ArgumentParser:
    """Add ``hybond fit``."""
    parser = verb(
        verbs,
        "fit",
        "hybond fit ball.toml drop.csv --free pad.C,damper.G",
        "hybond fit ball.toml one.csv two.csv --free pad.C --log pad.C --plot fit.png",
        "hybond fit ball.toml drop.csv --free m --bounds 'm=0.5..2 kg' --loss soft_l1",
        "hybond fit ball.toml drop.csv --free eps --bounds eps=0.3..0.95 --starts 20",
    )
    input_word(parser)
    parser.add_argument(
        "data",
        metavar="DATA",
        nargs="+",
        help="CSV files: a column time, and one for each signal that was measured",
    )
    parser.add_argument(
        "--free",
        metavar="PATH,...",
        action="append",
        required=True,
        help="what is looked for: parameters, values of elements, starts",
    )
    parser.add_argument(
        "--log", metavar="PATH,...", action="append", help="what is looked for by its logarithm"
    )
    parser.add_argument(
        "--bounds",
        metavar="PATH=LOW..HIGH",
        action="append",
        default=[],
        help="between which values; either may be left out",
    )
    parser.add_argument(
        "--loss",
        metavar="LOSS",
        default="linear",
        help="what a residual counts: linear (squares), soft_l1, huber, cauchy, arctan",
    )
    parser.add_argument(
        "--starts",
        metavar="N",
        type=int,
        default=1,
        help="begin N times: with the model's values, then spread within --bounds; keep the best",
    )
    parser.add_argument("--seed", metavar="N", type=int, help="of --starts (default: 0)")
    option_word(parser, "rtol")
    parser.add_argument("--plot", metavar="FILE", help="plot data and runs")
    json_word(parser)
    return parser
