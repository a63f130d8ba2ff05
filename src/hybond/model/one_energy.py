"""Fields of bent laws that store energy: whether there is one energy that all are slopes of.

Forces of a C, flows of an I, are the slopes of what is stored. So the slope of one port's law along
another port's quantity is that of the other's along the first, everywhere (Maxwell's reciprocity;
D. C. Karnopp, D. L. Margolis, R. C. Rosenberg, *System Dynamics*, on fields). A field of which that
is not so makes energy in every cycle around. It is looked at where the field starts and around, at
a handful of places that are always the same: a field that is wrong at all of these is refused.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import Final

from hybond.errors import ExpressionError, HybondError, ModelError
from hybond.model.expressions import compile_expression, differentiate
from hybond.model.expressions.slots import plain
from hybond.model.graph import FlatGraph, Node
from hybond.model.kinds import STORAGES
from hybond.model.laws import Law

NEAR: Final = ((1.0, 0.83, 1.29, 0.71, 1.13), (1.0, 1.17, 0.79, 1.31, 0.91))
"""Parts of the start at which the quantities of odd and of even ports are tried, in turn."""
FROM_ZERO: Final = (1.0, -1e-3, 1e-6, -1e-9, 1e-2)
"""Where they are tried, in SI, if they start from zero."""
APART: Final = 1e-6
"""Part of both slopes by which they must differ to be two: what rounding leaves is less."""
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
    slot = {f"law:{node.about.energy}{k + 1}": k for k in range(len(starts))}
    named = list(slot)
    for i, j in itertools.combinations(range(len(starts)), 2):
        try:
            slopes = [
                compile_expression(differentiate(law.expressions[a], named[b]), slot, pre_offset=0)
                for a, b in ((i, j), (j, i), (i, i), (j, j))
            ]
        except ExpressionError:
            continue  # it reads more than what is stored: only a run knows its slopes
        found = []
        for place in places:
            try:
                a, b, *own = (float(slope(place)) for slope in slopes)
            except (HybondError, ArithmeticError, ValueError):
                continue
            if math.isfinite(a) and math.isfinite(b) and (a != 0.0 or b != 0.0):
                found.append((place, a, b, ROUNDING * math.sqrt(abs(own[0] * own[1]))))
        if found and all(
            abs(a - b) > max(APART * (abs(a) + abs(b)), rounding) for _, a, b, rounding in found
        ):
            _refuse(node, i, j, *found[0][:3])


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
