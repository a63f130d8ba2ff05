"""The options that several verbs have, each said once."""

from __future__ import annotations

from argparse import ArgumentParser
from collections.abc import Callable
from typing import Any

Verb = Callable[..., ArgumentParser]
"""Adds a verb: to what, its name, examples."""


def file_word(parser: ArgumentParser) -> None:
    """Add which model."""
    parser.add_argument("file", metavar="FILE", help="a model file")


def input_word(parser: ArgumentParser) -> None:
    """Add which model, or netlist."""
    parser.add_argument("file", metavar="FILE", help="a model file, or a netlist")


def json_word(parser: Any) -> None:
    """Add that what is found is printed as JSON, to a parser or a group of it."""
    parser.add_argument(
        "--json", action="store_true", help="print one JSON object and nothing else"
    )


def picture_word(parser: ArgumentParser, what: str = "plot") -> None:
    """Add where a plot goes."""
    parser.add_argument("--plot", metavar="FILE", help=f"{what} as .png, .svg or .pdf")


def workers_word(parser: ArgumentParser) -> None:
    """Add how many threads there are."""
    parser.add_argument(
        "--workers", metavar="N", type=int, help="threads (default: one for each core)"
    )


def diode_word(parser: ArgumentParser) -> None:
    """Add how diodes of a netlist are read."""
    parser.add_argument(
        "--diode-current",
        metavar="I",
        help="of netlists: where diodes become straight lines: 1 A unless given, auto, or "
        "'D1=10 A,D2=50 mA'",
    )
