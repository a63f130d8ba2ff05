"""Fields of bent laws that store energy: whether there is one energy that all are slopes of.

Forces of a C, flows of an I, are the slopes of what is stored. So the slope of one port's law along
another port's quantity is that of the other's along the first, everywhere (Maxwell's reciprocity;
D. C. Karnopp, D. L. Margolis, R. C. Rosenberg, *System Dynamics*, on fields). A field of which that
is not so makes energy in every cycle around. It is looked at where the field starts and around, at
a handful of places that are always the same: a field that is wrong at all of these is refused.

Where parameters are followed it is asked of other values as well. If it is so whatever they are, as
of slopes of one formula, nothing depends on their values; if not, they are these numbers.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from typing import Final

from hybond.errors import ExpressionError, HybondError, ModelError
from hybond.model.expressions import Expr, compile_expression, differentiate
from hybond.model.expressions.algebra import Closure
from hybond.model.expressions.slots import PREFIX, plain, slot_of
from hybond.model.expressions.tree import names, transform, walk
from hybond.model.graph import FlatGraph, Node
from hybond.model.kinds import STORAGES
from hybond.model.laws import Law

NEAR: Final = ((1.0, 0.83, 1.29, 0.71, 1.13), (1.0, 1.17, 0.79, 1.31, 0.91))
"""Parts of the start at which the quantities of odd and of even ports are tried, in turn."""
FROM_ZERO: Final = (1.0, -1e-3, 1e-6, -1e-9, 1e-2)
"""Where they are tried, in SI, if they start from zero."""
APART: Final = 1e-6
"""Part of both slopes by which they must differ to be two: what rounding leaves is less."""
ONLY_HERE: Final = "laws that are slopes of one energy at these values only"
ROUNDING: Final = 1e-9
"""Part of the mean of the ports' own slopes that is rounding: slopes that cancel leave it."""


def check_energies(graph: FlatGraph) -> None:
    """Refuse bent fields that store energy of which the laws are slopes of no one energy.

    Raises
    ------
    ModelError
        HB-M163 for a pair of laws that differ at every place looked at.
    """
    for node in graph.nodes:
        law = node.law
        if node.kind not in STORAGES or law is None or law.matrix is not None:
            continue
        if len(law.expressions) > 1:
            own = (s for s in graph.storages if s.node == node.index)
            starts = [plain(s.start) if s.start_is == "stored" else 0.0 for s in own]
            _check_field(node, law, starts)


def _check_field(node: Node, law: Law, starts: Sequence[float]) -> None:
    places = _places(starts)
    named = [f"law:{node.about.energy}{k + 1}" for k in range(len(starts))]
    laws, values = _opened(law.expressions)
    for i, j in itertools.combinations(range(len(starts)), 2):
        slot = {name: k for k, name in enumerate((*named, *values))}
        try:
            slopes = [
                compile_expression(differentiate(laws[a], named[b]), slot, pre_offset=0)
                for a, b in ((i, j), (j, i), (i, i), (j, j))
            ]
        except ExpressionError:
            continue  # it reads more than what is stored: only a run knows its slopes
        if two := _two_slopes(slopes, places, [*values.values()]):
            _refuse(node, i, j, *two)
        others = [_another(v, k) for k, v in enumerate(values.values())]
        if values and _two_slopes(slopes, places, others):
            for number in map(slot_of, _numbers(law.expressions[i], law.expressions[j])):
                if number is not None:
                    number.settle(ONLY_HERE)


def _two_slopes(
    slopes: Sequence[Closure], places: Sequence[Sequence[float]], values: Sequence[float]
) -> tuple[Sequence[float], float, float] | None:
    """Return the first place and both slopes there if they differ at every place."""
    found = []
    for place in places:
        try:
            a, b, *own = (float(slope((*place, *values))) for slope in slopes)
        except (HybondError, ArithmeticError, ValueError):
            continue
        if math.isfinite(a) and math.isfinite(b) and (a != 0.0 or b != 0.0):
            found.append((place, a, b, ROUNDING * math.sqrt(abs(own[0] * own[1]))))
    if found and all(
        abs(a - b) > max(APART * (abs(a) + abs(b)), rounding) for _, a, b, rounding in found
    ):
        return found[0][:3]
    return None


def _opened(laws: Sequence[Expr]) -> tuple[list[Expr], dict[str, float]]:
    """Return laws with the parameters that are followed as names, and the values of these."""
    values: dict[str, float] = {}

    def opened(e: Expr) -> Expr:
        slot = slot_of(e)
        if slot is None:
            return e
        for name in names(slot.tree):
            values[name] = slot.slots.parameters[name.removeprefix(PREFIX)].start
        return slot.tree

    return [transform(e, opened) for e in laws], values


def _numbers(*laws: Expr) -> Iterator[object]:
    return (node for e in laws for node, _ in walk(e))


def _another(value: float, k: int) -> float:
    """Return another value of the parameter of that number, for each by another part."""
    return value * (1.0 + 0.07 * (k + 1)) if value != 0.0 else 1e-3 * (k + 1)


def _places(starts: Sequence[float]) -> list[list[float]]:
    found = []
    for turn in range(len(FROM_ZERO)):
        found.append(
            [
                a * NEAR[k % 2][turn] if a != 0.0 else FROM_ZERO[(turn + k) % len(FROM_ZERO)]
                for k, a in enumerate(starts)
            ]
        )
    return found


def _refuse(node: Node, i: int, j: int, place: Sequence[float], a: float, b: float) -> None:
    x, z = node.about.energy, node.about.imposes
    at = ", ".join(f"{x}{k + 1} = {value:.6g}" for k, value in enumerate(place))
    raise ModelError(
        f"the laws of {node.path!r} are slopes of no one energy: at {at} {z}{i + 1} changes by "
        f"{a:.6g} per {x}{j + 1}, and {z}{j + 1} by {b:.6g} per {x}{i + 1}",
        code="HB-M163",
        where=f"elements.{node.path}.{node.kind}",
        hint=f"take each as the derivative of one energy by its own {x}; split the rest off as an "
        "R field",
    )
