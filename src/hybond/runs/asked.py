"""What a call and an experiment ask of a run: each option once, and what fits together."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, TypedDict

from hybond.errors import UsageError
from hybond.options import CALLED, MADE, OPTIONS, STEPPING, STEPPING_IMPACT, Choice
from hybond.runs.policies import (
    Hysteresis,
    Journal,
    Limits,
    Method,
    is_many,
    nothing_kept,
)

if TYPE_CHECKING:
    from pathlib import Path


class MethodOptions(TypedDict, total=False):
    """How motion is computed, as arguments of a call; see `hybond.simulate`."""

    method: Method | str | None
    solver: str | None
    rtol: float | None
    atol: float | None
    step: float | str | None
    max_step: float | str | None
    theta: float | None


class RunOptions(MethodOptions, total=False):
    """What a run may be asked for, as arguments of a call; see `hybond.simulate`."""

    impact: str | None
    sliding: Hysteresis | Choice | None
    hysteresis: float | str | None
    limits: Limits | None
    max_events: int | None
    max_steps: int | None


_SAID = {
    "method": [o for o in MADE if o != "impact"],
    "sliding": ["hysteresis"],
    "limits": ["max_events", "max_steps"],
}
"""What records say, which then nothing else does."""
ASKED = ("method", *CALLED, "limits")
"""All names of `RunOptions`."""


def opened(asked: Mapping[str, Any]) -> dict[str, Any]:
    """Return what a call asks for, by options: its records opened, without what it leaves open.

    Raises
    ------
    UsageError
        HB-S122 for an option beside a record that says it, or what is no record.

    Examples
    --------
    >>> from hybond.runs.policies import Radau
    >>> opened({"method": Radau(rtol=1e-6), "sliding": "refuse", "step": None})
    {'sliding': 'refuse', 'solver': 'radau', 'rtol': 1e-06}
    """
    given = {k: v for k, v in asked.items() if v is not None}
    for name, kind in (("method", Method), ("sliding", Hysteresis), ("limits", Limits)):
        policy = given.get(name)
        if policy is None or (name == "sliding" and isinstance(policy, str)):
            continue
        if name == "method" and isinstance(policy, str):
            said, covered = {"solver": policy}, ["solver"]
        elif isinstance(policy, kind):
            said, covered = policy.options, _SAID[name]
        else:
            raise _no_record(name, policy)
        for other in covered:
            if other in given:
                raise UsageError(
                    f"{other} is given beside {name} = {policy!r}",
                    code="HB-S122",
                    where=other,
                    hint=f"say it in {name}, or leave {name} out",
                )
        del given[name]
        given |= said
    return given


def _no_record(name: str, value: object) -> UsageError:
    examples = {
        "method": 'method=hb.Radau(rtol=1e-6) or method="radau"',
        "sliding": 'sliding=hb.Hysteresis("1 mm"), "filippov" or "refuse"',
        "limits": "limits=hb.Limits(events=1000)",
    }
    said = f"{value.__name__} without parentheses" if isinstance(value, type) else repr(value)
    return UsageError(
        f"{name} = {said} says nothing", code="HB-S122", where=name, hint=examples[name]
    )


def kept(
    keep: Journal | int | None, journal: str | Path | None, solver: str
) -> tuple[int | None, str | None]:
    """Return how many segments and events a result keeps at the least, and the file of a journal.

    Raises
    ------
    UsageError
        HB-S113 for what is neither, or a solver that keeps all; HB-S122 for two journals.
    """
    if isinstance(keep, Journal):
        if journal is not None:
            raise UsageError(
                f"journal is given beside keep = {keep!r}",
                code="HB-S122",
                where="journal",
                hint="one of them",
            )
        journal, keep = keep.path, keep.last
    if keep is not None and not is_many(keep):
        raise nothing_kept(keep)
    if solver in STEPPING and (keep is not None or journal is not None):
        one, said = ("keep", "keeps all") if journal is None else ("journal", "has no journal")
        raise UsageError(
            f"{one} is given, but solver {solver!r} {said}",
            code="HB-S113",
            where=one,
            hint="take a solver that locates events",
        )
    return keep, None if journal is None else os.fspath(Journal(journal).path)


def chosen(asked: Mapping[str, Any], experiment: Mapping[str, Any]) -> dict[str, Any]:
    """Return the value of each option: as asked for, else as the experiment says, else its default.

    Parameters
    ----------
    asked : mapping
        Options of a call, `RunOptions`.
    experiment : mapping

    Returns
    -------
    dict
        By names of `OPTIONS`, in SI; None for what a run does without.

    Raises
    ------
    UsageError
        For a value that is none, or does not fit the solver; HB-S122 as `opened`.

    Examples
    --------
    >>> found = chosen({"step": "1 ms"}, {"solver": "rk4", "rtol": 1e-6})
    >>> found["step"], found["rtol"], found["max_events"]
    (0.001, 1e-06, 1000000)
    """
    given = opened(asked)
    found: dict[str, Any] = {}
    for name, option in OPTIONS.items():
        value = given.get(name)
        if value is None:
            value = experiment.get(name)
        found[name] = option.default if value is None else option.read(value)
    solver = found["solver"]
    for name, option in OPTIONS.items():
        if option.only and solver not in option.only:
            if name in given:
                code, hint = option.elsewhere
                why = f"{name} is given, but solver {solver!r} has none"
                raise UsageError(why, code=code, where=name, hint=hint)
            # one that the experiment has for another solver may stand there unused
            found[name] = None
        elif option.only and found[name] is None:
            raise UsageError(
                f"solver {solver!r} has a fixed {name} and none is given",
                code=option.code,
                where=name,
                hint=f'{option.hint}, or choose an adaptive solver, such as "auto"',
            )
    _band(found, given)
    return found


def _band(found: dict[str, Any], given: Mapping[str, Any]) -> None:
    """Refuse a band where nothing has one, and hysteresis without a band."""
    if found["sliding"] != "hysteresis":
        if "hysteresis" in given:
            raise UsageError(
                f'hysteresis is given, but sliding = "{found["sliding"]}"',
                code="HB-S111",
                where="hysteresis",
                hint='sliding = "hysteresis"',
            )
        found["hysteresis"] = None
    elif found["hysteresis"] is None:
        raise UsageError(
            "the switching with hysteresis has no band",
            code="HB-S111",
            where="hysteresis",
            hint=OPTIONS["hysteresis"].hint,
        )


def solver_of(asked: Mapping[str, Any], experiment: Mapping[str, Any]) -> str:
    """Return the solver of a run, as asked for or as the experiment says, by its own name.

    Raises
    ------
    UsageError
        HB-S101 if there is none of that name.

    Examples
    --------
    >>> solver_of({}, {"solver": "qss"})
    'qss3'
    """
    option = OPTIONS["solver"]
    name = opened(asked).get("solver") or experiment.get("solver") or option.default
    return str(option.read(name))


def ignored_impact(impact: str | None, experiment: Mapping[str, Any]) -> str | None:
    """Return what time-stepping has to say on a law of impacts that is not its own."""
    name = impact if impact is not None else experiment.get("impact")
    if name in (None, STEPPING_IMPACT):
        return None
    return (
        f"impact = {str(name)!r} has no effect with solver 'moreau-jean': its steps are Newton's "
        f"law for all contacts at once ({STEPPING_IMPACT!r}), and where several contacts meet at "
        "once the result may differ; take a solver that locates events, or leave impact out"
    )
