"""The options that several verbs have, each said once."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Callable
from typing import Any

from hybond.options import CALLED, OPTIONS

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


def script_word(parser: ArgumentParser) -> None:
    """Add that the script of a file is left out."""
    parser.add_argument(
        "--no-script", action="store_true", help="one run, though the file has a script"
    )


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


def settings_words(parser: ArgumentParser) -> None:
    """Add what changes a model before it runs."""
    parser.add_argument(
        "--set",
        dest="settings",
        metavar="PATH=VALUE",
        action="append",
        default=[],
        help="change a parameter (m=2kg), an element (ball.I=2kg) or a start (ball.f='1 m/s')",
    )


def solver_words(parser: ArgumentParser) -> None:
    """Add how a run is made, and when it ends."""
    parser.add_argument(
        "--until",
        metavar="T",
        action="append",
        help="end time, as 3 or '50 ms', or a condition, as 'v.f < 0'; "
        "several times: what is first ends the run",
    )
    for name in OPTIONS:
        if OPTIONS[name].part in ("method", "impacts", "surfaces"):
            option_word(parser, name)
    parser.add_argument(
        "--fmus", action="store_true", help="run the code of the FMUs that the model names"
    )


def option_word(parser: ArgumentParser, name: str) -> None:
    """Add an option of a run, `hybond.options`, as it is said there."""
    option = OPTIONS[name]
    reads = {"number": float, "count": int}.get(option.kind, str)
    word = "--" + name.replace("_", "-")
    parser.add_argument(word, metavar=option.letter, type=reads, help=option.said)


def options_given(given: Namespace, *more: str) -> dict[str, Any]:
    """Return the options of a run that are given, and others by name."""
    found = {name: getattr(given, name, None) for name in (*CALLED, *more)}
    return {name: v for name, v in found.items() if v is not None and v is not False}


def limits_words(parser: ArgumentParser) -> None:
    """Add where a run stops, and what it keeps."""
    for name in OPTIONS:
        if OPTIONS[name].part == "limits":
            option_word(parser, name)
    parser.add_argument(
        "--keep", metavar="N", type=int, help="keep the last N segments and events only"
    )
    parser.add_argument(
        "--journal", metavar="FILE", help="write events as .csv as they happen, also with --keep"
    )
