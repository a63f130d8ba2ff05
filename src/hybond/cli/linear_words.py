"""The options of ``hybond linearise``."""

from __future__ import annotations

from argparse import ArgumentParser
from typing import Any

from hybond.cli.shared_words import Verb, input_word, json_word, picture_word

PLOTS = ("bode", "nyquist", "step", "poles")


def linearise_words(verb: Verb, verbs: Any) -> ArgumentParser:
    """Add ``hybond linearise``."""
    parser = verb(
        verbs,
        "linearise",
        "hybond linearise motor.toml --input supply --output w.f --at equilibrium",
        "hybond linearise buck.toml --at '2 ms' --plot bode.png",
        "hybond linearise buck.toml --inject --input d --output out.e --frequencies 100..20kHz:9",
    )
    input_word(parser)
    parser.add_argument(
        "--input",
        metavar="NAME,...",
        action="append",
        help="sources, inputs, parameters (default: all inputs and sources with a value)",
    )
    parser.add_argument(
        "--output",
        metavar="SIGNAL,...",
        action="append",
        help="signals (default: what the experiment plots, else the states)",
    )
    parser.add_argument(
        "--at",
        metavar="WHERE",
        help="start (the default), equilibrium, times of a run as '2 ms, 5 ms', or states as "
        "c.q=1,ball.p='2 N*s'",
    )
    parser.add_argument(
        "--mode", metavar="MACHINE=STATE,...", help="the mode (default: the one that holds there)"
    )
    picture_word(parser)
    parser.add_argument(
        "--kind",
        metavar="WHAT",
        help="of --plot: bode (the default) or step, of all pairs; nyquist or poles, of the first",
    )
    parser.add_argument(
        "--frequencies",
        metavar="F,...",
        help="Hz: F,G,... or LOW..HIGH:NUMBER, evenly on a logarithmic scale",
    )
    parser.add_argument(
        "--inject",
        action="store_true",
        help="run the model with a small sine added to the input instead: for models that switch",
    )
    parser.add_argument("--amplitude", metavar="A", help="of --inject: the sine (default: 1 %%)")
    parser.add_argument("--period", metavar="T", help="of --inject: after which the model repeats")
    parser.add_argument(
        "--tolerance", metavar="R", type=float, help="of --inject: how well settled (default: 1e-3)"
    )
    parser.add_argument(
        "--windows", metavar="N", type=int, help="of --inject: after how many it gives up"
    )
    json_word(parser)
    return parser
