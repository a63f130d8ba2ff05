"""``hybond export``: a model as a program of its own, or in the format of another tool."""

from __future__ import annotations

import sys
from argparse import Namespace
from pathlib import Path

from hybond.cli.netlists import read_model
from hybond.cli.running import tell_no_script
from hybond.cli.settings import model_with
from hybond.cli.shared_words import options_given
from hybond.cli.streams import complain, say
from hybond.cli.targets import check_new, check_target
from hybond.errors import UsageError
from hybond.export.targets import TARGETS, default_name, export
from hybond.names import did_you_mean

PRINTED = "-"
"""The name of the file that is not written but printed."""
RUN = ("c", "fmu", "java", "modelica", "python")
"""Targets that run the model, or let it be run."""


def export_model(given: Namespace) -> int:
    """Write a model in another language; print where it is.

    Raises
    ------
    UsageError
        HB-E602 for an unknown target, HB-X102 or HB-X104 for a file that cannot be written.
    """
    target = TARGETS.get(given.to)
    if target is None:
        raise UsageError(
            f"there is no export to {given.to!r}",
            code="HB-E602",
            where="--to",
            hint=did_you_mean(given.to, TARGETS) or ", ".join(TARGETS),
        )
    name = given.out or default_name(given.to, Path(given.file).stem)
    path = None if name == PRINTED else check_target(name, (target.suffix,), "--out")
    if path is not None:
        check_new(path, force=given.force)
    options = options_given(given, "until", "points", "fmi")
    model = model_with(read_model(given.file)[0], given.settings)
    if given.to in RUN:
        tell_no_script(model, "what is exported runs")
    if given.to == "fmu" and sys.stderr.isatty():
        complain("making the program and compiling it, some seconds ...")
    found = export(model, to=given.to, path=path, **options)
    if path is not None:
        say(name)
    elif isinstance(found, str):
        sys.stdout.write(found)
    elif sys.stdout.isatty():
        raise UsageError(
            "this is no text for a terminal",
            code="HB-X102",
            where="--out",
            hint=f"name a file, such as {default_name(given.to, Path(given.file).stem)}",
        )
    else:
        sys.stdout.buffer.write(found)
    return 0
