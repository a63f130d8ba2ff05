"""The options of the verbs that look at a model without running it."""

from __future__ import annotations

from argparse import ArgumentParser
from typing import Any

from hybond.cli.shared_words import Verb, file_word, json_word


def equations_words(verb: Verb, verbs: Any) -> ArgumentParser:
    """Add ``hybond equations``."""
    parser = verb(
        verbs,
        "equations",
        "hybond equations ball.toml",
        "hybond equations ball.toml --mode floor=touching --matrices",
        "hybond equations circuit.toml --outputs C1.e --transfer",
        "hybond equations rectifier.toml --complementarity",
    )
    file_word(parser)
    parser.add_argument(
        "--mode", metavar="MACHINE=STATE,...", help="one mode (default: all, with Booleans)"
    )
    parser.add_argument("--outputs", metavar="SIGNAL,...", help="signals to add as outputs y")
    parser.add_argument(
        "--complementarity",
        action="store_true",
        help="the linear complementarity system of the junctions with a law, machines staying in "
        "--mode (default: the start mode)",
    )
    form = parser.add_mutually_exclusive_group()
    form.add_argument("--latex", action="store_true", help="write LaTeX")
    form.add_argument("--markdown", action="store_true", help="write Markdown")
    json_word(form)
    parser.add_argument("--matrices", action="store_true", help="also E, A, B, C, D")
    parser.add_argument(
        "--junctions", action="store_true", help="also the junction structure matrix"
    )
    parser.add_argument(
        "--transfer",
        action="store_true",
        help="also transfer functions and poles of the mode (default: the start mode)",
    )
    parser.add_argument(
        "--numbers", action="store_true", help="coefficients as numbers, not in parameters"
    )
    return parser


def analyse_words(verb: Verb, verbs: Any) -> ArgumentParser:
    """Add ``hybond analyse``."""
    parser = verb(
        verbs,
        "analyse",
        "hybond analyse clutch.toml --outputs load.f",
        "hybond analyse ball.toml --restitution contact --dt 1e-3 --write newton.toml",
        "hybond analyse circuit.toml --residuals --sensors Df,De1,De2",
        "hybond analyse ball.toml --coverage ball.p=-3..1 --at height=0",
    )
    file_word(parser)
    parser.add_argument(
        "--mode",
        metavar="MACHINE=STATE,...",
        action="append",
        default=[],
        help="analyse this mode (default: those that the machines can reach)",
    )
    parser.add_argument("--inputs", metavar="SOURCE,...", help="sources that can be steered")
    parser.add_argument("--outputs", metavar="SIGNAL,...", help="signals that are measured")
    parser.add_argument("--draw", metavar="FILE", help="draw the first mode with what was found")
    what = parser.add_mutually_exclusive_group()
    what.add_argument(
        "--restitution",
        metavar="JUNCTION",
        help="the coefficient of restitution of the contact at this controlled junction",
    )
    what.add_argument(
        "--residuals", action="store_true", help="residuals for diagnosis, valid in all modes"
    )
    what.add_argument(
        "--coverage",
        metavar="QUANTITY=LOW..HIGH",
        help="for which values of a stored quantity some mode holds, and why none does",
    )
    parser.add_argument(
        "--at",
        metavar="NAME=VALUE,...",
        action="append",
        help="what else is stored, for --coverage (default: the start)",
    )
    parser.add_argument("--dt", metavar="T", help="the step of Margetts and Ngwompo's formula")
    parser.add_argument("--speed", metavar="V", help="impact speed, for a contact under load")
    parser.add_argument(
        "--write", metavar="FILE", help="write the model with Newton's law of restitution"
    )
    parser.add_argument(
        "--eps",
        metavar="E",
        help="restitution for --write (default: the formula's if --dt is given, else the one "
        "from integrating the contact phase)",
    )
    parser.add_argument("--force", action="store_true", help="let --write replace a file")
    parser.add_argument("--sensors", metavar="SIGNAL,...", help="what is measured, for --residuals")
    form = parser.add_mutually_exclusive_group()
    form.add_argument("--markdown", action="store_true", help="write Markdown")
    json_word(form)
    return parser
