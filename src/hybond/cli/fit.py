"""``hybond fit``: values of a model with which its runs are nearest to data."""

from __future__ import annotations

import sys
from argparse import Namespace
from collections.abc import Sequence
from typing import Any

from hybond.cli.lists import split
from hybond.cli.netlists import read_model
from hybond.cli.outputs import PICTURES
from hybond.cli.record import VERSION, to_json
from hybond.cli.running import tell_no_script
from hybond.cli.settings import changed_with
from hybond.cli.streams import complain, say
from hybond.cli.targets import check_target
from hybond.errors import NumericsError, UsageError
from hybond.fitting.fit import fit as fitted


def fit(given: Namespace) -> int:
    """Fit; print the values, or one JSON object; draw the plot that is asked for."""
    plot = check_target(given.plot, PICTURES, "--plot")
    if given.seed is not None and given.starts == 1:
        raise UsageError(
            "one search begins with the model's values, and nothing is drawn",
            code="HB-X101",
            where="--seed",
            hint="--starts 20 --seed 1, or leave --seed out",
        )
    model, parameters = changed_with(read_model(given.file)[0], given.settings)
    tell_no_script(model, "the model is run")
    found = fitted(
        model,
        list(given.data),
        split(given.free),
        bounds=bounds_of(given.bounds),
        log=split(given.log or []),
        loss=given.loss,
        parameters=parameters,
        rtol=given.rtol,
        starts=given.starts,
        seed=given.seed or 0,
    )
    if plot is not None:
        found.plot(plot)
    if given.json:
        record: dict[str, Any] = {"hybond": VERSION, "model": model.name, "file": given.file}
        text = to_json({**record, "data": list(given.data), **found.to_dict()})
        given.json = False  # what fails from here on must not put a second object there
        sys.stdout.write(text)
    else:
        say(str(found))
        if plot is not None:
            say(f"plot: {plot}")
    if not found.converged:
        complain("the search did not converge")
        return NumericsError.exit_code
    return 0


def bounds_of(texts: Sequence[str]) -> dict[str, tuple[str | None, str | None]]:
    """Return bounds by path.

    Raises
    ------
    UsageError
        HB-X101 for what is not ``PATH=LOW..HIGH``.

    Examples
    --------
    >>> bounds_of(["m=0.5..2 kg", "pad.C=..1 mm/N"])
    {'m': ('0.5 kg', '2 kg'), 'pad.C': (None, '1 mm/N')}
    """
    found: dict[str, tuple[str | None, str | None]] = {}
    for text in texts:
        path, equals, span = (word.strip() for word in text.partition("="))
        low, dots, high = (word.strip() for word in span.partition(".."))
        if not equals or not dots or not path or not (low or high):
            raise UsageError(
                f"{text!r} are no bounds",
                code="HB-X101",
                where="--bounds",
                hint="--bounds 'm=0.5..2 kg'",
            )
        unit = high.partition(" ")[2]
        if unit and low and " " not in low:
            low = f"{low} {unit}"  # one unit for both
        found[path] = (low or None, high or None)
    return found
