"""``hybond bifurcation``: what a model comes to, value after value of a parameter."""

from __future__ import annotations

import sys
from argparse import Namespace
from typing import Any

from hybond.cli.flags import flags_of, said
from hybond.cli.lists import split
from hybond.cli.netlists import read_model
from hybond.cli.outputs import PICTURES
from hybond.cli.plans import factors_of
from hybond.cli.record import VERSION, to_json
from hybond.cli.running import tell_no_script
from hybond.cli.settings import changed_with
from hybond.cli.shared_words import options_given
from hybond.cli.streams import complain, say
from hybond.cli.targets import check_target
from hybond.errors import UsageError
from hybond.files.whole import write_whole
from hybond.progress import MembersDone
from hybond.sweep.bifurcation.call import bifurcation as diagram_of
from hybond.sweep.factors import factor_of

TABLES = (".csv", ".json")
TOLD = 3
"""Refusals of values that are told in full."""


def bifurcation(given: Namespace) -> int:
    """Run all values; print the windows, or one JSON object; write what is asked for."""
    plot = check_target(given.plot, PICTURES, "--plot")
    out = check_target(given.out, TABLES, "--out")
    model, parameters = changed_with(read_model(given.file)[0], given.settings)
    tell_no_script(model, "the model is run")
    varied = factors_of(given.vary)
    if len(given.vary) != 1:
        raise UsageError(
            f"{len(given.vary)} parameters vary",
            code="HB-P131",
            where="--vary",
            hint="one --vary; what else is different: --set PATH=VALUE",
        )
    ((path, values),) = varied.items()
    many = factor_of(path, values).many * (1 + (given.direction == "both"))
    with MembersDone(max(many, 1)) as bar:
        found = diagram_of(
            model,
            varied,
            of=split(given.of),
            period=given.period,
            at=given.at,
            before=given.before,
            settle=given.settle,
            keep=given.keep,
            direction=given.direction,
            limit=given.limit,
            parameters=parameters,
            workers=given.workers,
            progress=bar,
            **options_given(given),
        )
    windows = found.windows(given.windows)
    data: dict[str, Any] = {"hybond": VERSION, "model": model.name, "file": given.file}
    data |= {**found.to_dict(), "windows": [w.to_dict() for w in windows]}
    if out is not None and out.suffix.lower() == ".csv":
        found.to_csv(out)
    elif out is not None:
        write_whole(out, to_json(data))
    if plot is not None:
        found.plot(path=plot)
    if given.json:
        given.json = False  # what fails from here on must not put a second object there
        sys.stdout.write(to_json(data))
    else:
        say(found.title)
        say(f"{', '.join(found.of)}, {found.section}")
        say()
        say(repr(windows))
        say()
        say(f"{found.how}, {found.seconds:.3g} s")
        for name, file in (("plot", plot), ("table", out)):
            if file is not None:
                say(f"{name}: {file}")
    if plot is not None and len(found.of) > 1:
        complain(f"the plot shows {found.of[0]}, the first of {len(found.of)} signals")
    for note in found.notes:
        complain(said(note, flags_of("bifurcation")))
    errors = list(found.errors.items())
    for (way, k), error in errors[:TOLD]:
        complain(f"{way}, {found.parameter} = {found.values[k]:.9g}: {error}")
    if len(errors) > TOLD:
        complain(f"... and {len(errors) - TOLD} more values with errors")
    if found.interrupted:
        complain("interrupted")
        return 130
    return max((e.exit_code for _, e in errors), default=0)
