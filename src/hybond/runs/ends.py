"""When a run ends: at a time, or where a condition holds first."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from hybond.errors import HybondError, UsageError
from hybond.model.expressions import And, Bool, Or
from hybond.model.graph import FlatGraph, Machine, Rule, Watch
from hybond.records import dataclass
from hybond.runs.times import is_condition, time_in

NAME = "until"
"""Of the machine that ends a run: nobody sees it but in the event that it makes."""
RUNS, ENDS = "runs", "ends"

Until = float | str | Sequence[float | str] | None


@dataclass(frozen=True, slots=True)
class Ends:
    """When a run ends: the latest, and what ends it before.

    Parameters
    ----------
    time : float or str or None
        As it was given.
    conditions : tuple of str
    """

    time: float | str | None
    conditions: tuple[str, ...] = ()


def ends_of(until: Until, experiment: Mapping[str, Any]) -> Ends:
    """Return when a run ends: what is asked for, or what the experiment says.

    Who asks for conditions alone has the time of the experiment beside them.

    Raises
    ------
    UsageError
        HB-S132 for conditions without a time, HB-S106 for what is neither.

    Examples
    --------
    >>> ends_of("v.f < 0", {"until": "10 s"})
    Ends(time='10 s', conditions=('v.f < 0',))
    >>> ends_of(None, {"until": ["v.f < 0", "2 s"]})
    Ends(time='2 s', conditions=('v.f < 0',))
    """
    given = experiment.get("until") if until is None else until
    listed: list[Any] = list(given) if isinstance(given, list | tuple) else [given]
    conditions = tuple(dict.fromkeys(u for u in listed if is_condition(u)))
    times = [u for u in listed if u is not None and not is_condition(u)]
    if len(times) > 1 or (isinstance(given, list | tuple) and not listed):
        raise UsageError(
            f"until = {listed!r} has {len(times)} times",
            code="HB-S106",
            where="until",
            hint='one time, and conditions beside it: until=["v.f < 0", "10 s"]',
        )
    if times or not conditions:
        return Ends(times[0] if times else None, conditions)
    latest = time_in(experiment.get("until")) if until is not None else None
    if latest is None:
        raise UsageError(
            f"the run ends where {conditions[0]!r} holds, and may not end at all",
            code="HB-S132",
            where="until",
            hint=f'give a time beside it: until=["{conditions[0]}", "10 s"]',
        )
    return Ends(latest, conditions)


def ended(graph: FlatGraph, conditions: Sequence[str]) -> FlatGraph:
    """Return a graph with a machine that fires where one of the conditions holds first.

    It switches nothing and is the last one, `FlatGraph.ends`; a run ends when it fires.

    Raises
    ------
    UsageError
        HB-S136 for what is no condition on the names of the model.
    """
    if not conditions:
        return graph
    key = (NAME, *conditions)
    found: FlatGraph | None = graph.kept.get(key)
    if found is None:
        found = _ended(graph, conditions)
        graph.kept.keep(key, found)
    return found


def _ended(graph: FlatGraph, conditions: Sequence[str]) -> FlatGraph:
    rules: list[Rule] = []
    watches: tuple[Watch, ...] = graph.watches
    assert graph.condition is not None
    for k, text in enumerate(conditions):
        try:
            rule, watches = graph.condition(text)
        except HybondError as error:
            raise UsageError(
                f"until = {text!r} is no condition: {error.why}",
                code="HB-S136",
                where="until",
                hint=error.hint or 'a comparison, such as until="v.f < 0", or a time',
            ) from None
        if isinstance(rule.guard, Bool) or _is_constant(rule):
            raise UsageError(
                f"until = {text!r} never changes",
                code="HB-S136",
                where="until",
                hint="compare something that the run computes",
            )
        rules.append(replace(rule, target=k + 1))
    many = len(graph.machines)
    one = len(conditions) == 1
    states = (RUNS, *(ENDS if one else f"{ENDS}_{k + 1}" for k in range(len(conditions))))
    machine = Machine(
        many,
        NAME,
        states,
        (frozenset[int](),) * len(states),
        0,
        tuple(rules),
        (False,) * len(states),
    )
    written = graph.written
    if written is not None:
        written = replace(written, graph=ended(written.graph, conditions))
    return replace(
        graph, machines=(*graph.machines, machine), watches=watches, ends=many, written=written
    )


def _is_constant(rule: Rule) -> bool:
    return not rule.reads and not isinstance(rule.guard, And | Or)
