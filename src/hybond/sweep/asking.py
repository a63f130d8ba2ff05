"""What many runs are asked for: options that they have, and what the library is told of them."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from hybond.engine.compiled.native import Unavailable, library
from hybond.engine.tables.options import Settings, settings_of
from hybond.errors import UsageError
from hybond.names import did_you_mean
from hybond.options import OPTIONS, STEPPING
from hybond.runs.asked import opened
from hybond.runs.policies import Journal

if TYPE_CHECKING:
    from hybond.sweep.member import Task

_OWN = {
    "parameters": "the parameters are in sets",
    "watch": "ensemble.run(k) runs one member again: watch it there with hybond.simulate",
    "on_error": "a member that stops with an error is kept, and stops no other",
    "journal": "ensemble.run(k) runs one member again: give it one there with hybond.simulate",
}
"""Options of `simulate` that an ensemble does not pass on, and what to do instead."""
_RUN = ("engine", "keep", "fmus")
"""Those that do not say what is computed."""


def asked_of(task: Task) -> tuple[tuple[Settings, float | None] | None, str]:
    """Return what runs of the library are asked for; None and why if it is no such runs."""
    options = {k: v for k, v in task.options.items() if k not in _RUN}
    settings, band = settings_of(task.model.experiment, task.until, **options)
    if settings.solver in STEPPING:
        return None, f"solver {settings.solver!r}"
    if task.options.get("keep") is not None:
        return None, "keep"
    if task.options.get("engine") == "python":
        return None, "the engine as Python"
    try:
        library()
    except Unavailable as error:
        return None, str(error)
    return (settings, band), ""


_FACTORS = ("vary", "values", "params", "factors", "sweep", "over")
"""What a plan is called elsewhere."""


def check_options(options: Mapping[str, Any]) -> dict[str, Any]:
    """Return options of `simulate` for many runs, records opened; HB-S115 for what they lack."""
    if options.keys() - (inspect.signature(settings_of).parameters.keys() | OPTIONS.keys()):
        from hybond.simulation import simulate

        known = inspect.signature(simulate).parameters.keys() - {
            *("model", "until", "progress", "start")
        }
        for name in options:
            if name in _OWN:
                raise _refusal(f"an ensemble has no {name!r}", name, _OWN[name])
            if name not in known:
                hint = did_you_mean(name, known - _OWN.keys())
                if name in _FACTORS:
                    hint = 'what varies comes second: hb.sweep(model, {"R": [1, 2]}, collect="x")'
                raise _refusal(f"there is no option {name!r}", name, hint)
    if isinstance(options.get("keep"), Journal):
        raise _refusal("an ensemble has no journal", "keep", _OWN["journal"])
    return opened(options)


def _refusal(why: str, where: str, hint: str) -> UsageError:
    return UsageError(why, code="HB-S115", where=where, hint=hint)
