"""Integrated signals that go on at a rest: whether a guard waits for them, and what is said."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from hybond.analysis.linear.point import Point
from hybond.equations.element_parts import settings
from hybond.equations.slopes import Slopes
from hybond.model.expressions import (
    And,
    Binary,
    Compare,
    Expr,
    Not,
    Number,
    Or,
    differentiate,
    names,
    simplify,
    turning,
)
from hybond.model.graph import FlatGraph, Machine, Rule


@dataclass(frozen=True, slots=True)
class Reading:
    """A rule whose guard reads a signal that goes on.

    Parameters
    ----------
    comes : bool
        Whether it leaves the mode, and may come to hold while all goes on as it does.
    """

    machine: Machine
    rule: Rule
    leaves: bool
    comes: bool


def readings(
    graph: FlatGraph, point: Point, rates: Mapping[str, float], name: str
) -> list[Reading]:
    """Return the rules that read a signal, those that may come to hold first.

    Parameters
    ----------
    rates : mapping
        By canonical name: what goes on, and how fast.
    """
    watched = {f"at:{w.index}": point.values[f"at:{w.index}"] for w in graph.watches}
    slopes = Slopes(graph, point.values, settings(graph, point.mode, watched))
    waits = _Waits(slopes, {**rates, "time": 1.0})
    found = []
    for machine, state in zip(graph.machines, point.mode, strict=True):
        for rule in machine.rules:
            if name in names(rule.guard):
                leaves = rule.source == state
                comes = leaves and waits.comes(rule.guard, True)
                found.append(Reading(machine, rule, leaves, comes))
    return sorted(found, key=lambda r: (not r.comes, not r.leaves))


def said_of(found: list[Reading]) -> str:
    """Return in words what reads a signal that goes on at a rest."""
    if not found:
        return "nothing reads it"
    if not found[0].leaves:
        return "no law and no rule that leaves this mode reads it"
    first = found[0]
    return (
        f"no law reads it, and {first.machine.path} waits for what it does not lead to: "
        f"{first.rule.said}"
    )


@dataclass(frozen=True, slots=True)
class _Waits:
    """Tells what guards come to while signals go on and all else rests.

    Parameters
    ----------
    rates : mapping
        By name: of what goes on. What is told of the time (``at:``) does so too, in jumps.
    """

    slopes: Slopes
    rates: Mapping[str, float]

    def comes(self, e: Expr, holds: bool) -> bool:
        """Return whether a condition may come to hold, or not to hold."""
        if not self._goes_on(e):
            value = self.slopes.value(e)
            return math.isnan(value) or bool(value) == holds
        match e:
            case Not(arg):
                return self.comes(arg, not holds)
            case And(args) | Or(args):
                each = [self.comes(a, holds) for a in args]
                return all(each) if isinstance(e, And) == holds else any(each)
            case Compare(op, left, right):
                return self._reaches(op, Binary("-", left, right), holds)
        return True

    def _reaches(self, op: str, gap: Expr, holds: bool) -> bool:
        """Return whether a difference is on its way to where a comparison holds, or there.

        What is not straight in what goes on may turn back: then it may come.
        """
        if any(self._goes_on(t) for t in turning(gap)) or any(map(_is_timed, names(gap))):
            return True
        rate = 0.0
        for name in names(gap) & set(self.rates):
            slope = simplify(differentiate(gap, name))
            if not isinstance(slope, Number) and self._goes_on(slope):
                return True
            rate += self.slopes.value(slope) * self.rates[name]
        now = self.slopes.value(gap)
        if op in ("==", "!="):
            return now * rate <= 0.0 if (op == "==") == holds else True
        sign = 1.0 if (op in (">", ">=")) == holds else -1.0
        return not (sign * rate <= 0.0 and sign * now < 0.0)

    def _goes_on(self, e: Expr) -> bool:
        return any(name in self.rates or _is_timed(name) for name in names(e))


def _is_timed(name: str) -> bool:
    return name.startswith("at:")
