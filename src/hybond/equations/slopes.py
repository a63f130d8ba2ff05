"""Slopes of expressions at a point, and what the point does to them: kinks, no slope at all."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from hybond.equations.angles import size_by_angles
from hybond.equations.calculus import partial_time
from hybond.equations.element_parts import configure
from hybond.errors import EquationError
from hybond.model.expressions import (
    Expr,
    Name,
    Number,
    compile_expression,
    differentiate,
    names,
    simplify,
    turning,
)
from hybond.model.expressions.slots import PREFIX, is_slotted, plain, tree_of
from hybond.model.expressions.tree import transform
from hybond.model.fieldless import describe
from hybond.model.graph import FlatGraph
from hybond.model.kinds import SOURCES

ANGLE = 1e-12
"""A sine or cosine below this is zero: its angle is a quarter turn or none, but for rounding."""
KINK = 1e-9
"""What turns within this part of the sizes of what it is made of has its kink at the point."""


@dataclass(frozen=True, slots=True)
class Bend:
    """How an expression and its slopes change along a motion.

    Parameters
    ----------
    drift : float
        Its rate with bond variables held, times `factor`.
    slopes : mapping
        The rate of the slope by each name, bond variables held.
    bends : mapping
        By name and bond variable: what the rate of that adds, for each unit of it.
    factor : float
        What the slopes are to be multiplied by.
    """

    drift: float
    slopes: Mapping[str, float]
    bends: Mapping[tuple[str, str], float]
    factor: float


class Slopes:
    """Differentiates expressions at one point.

    Parameters
    ----------
    values : mapping
        Of every canonical name.
    discrete : mapping
        What is constant in the mode.

    Attributes
    ----------
    straight : bool
        Whether no slope so far depends on the point.
    kinks : list of str
    """

    def __init__(
        self, graph: FlatGraph, values: Mapping[str, float], discrete: Mapping[str, Expr]
    ) -> None:
        self.graph = graph
        self.values = {
            f"{PREFIX}{k}": plain(v) for k, v in graph.parameters.items() if not isinstance(v, str)
        }
        self.values |= values
        self.discrete = discrete
        self.straight = True
        self.kinks: list[str] = []
        self._index = {name: k for k, name in enumerate(self.values)}
        self._row = list(self.values.values())
        largest: dict[str, float] = {}
        for name, value in self.values.items():
            kind = name.partition(":")[0]
            largest[kind] = max(largest.get(kind, 0.0), abs(value))
        self._largest = largest

    def of(self, e: Expr, where: str, *, given: bool = False) -> dict[str, float]:
        """Return the slopes of an expression by name, those that are not zero.

        Parameters
        ----------
        given : bool
            Whether it is the value of a source, which may follow the time.

        Raises
        ------
        EquationError
            HB-A506 where it has none.
        """
        fixed = transform(configure(e, self.discrete), _followed)
        found = {}
        for name in sorted(names(fixed) - {"time"}):
            slope = self.at(fixed, name, where)
            if slope:
                found[name] = slope
        self._note_kinks(fixed, where)
        return found

    def at(self, e: Expr, name: str, where: str) -> float:
        """Return the slope of an expression by one name.

        Raises
        ------
        EquationError
            HB-A506 where it has none.
        """
        if name not in names(e):
            return 0.0
        slope = simplify(differentiate(e, name))
        if isinstance(slope, Number):
            return float(slope.value)
        if not all(n.startswith(PREFIX) for n in names(slope)):
            self.straight = False
        value = self.value(slope)
        if not math.isfinite(value):
            raise EquationError(
                f"{describe(self.graph, e)} has no finite slope by "
                f"{describe(self.graph, Name(name))} at this point",
                code="HB-A506",
                where=where,
                hint="a root or a quotient at its end: take a point beside it",
            )
        turned = size_by_angles(slope)
        return 0.0 if turned and abs(value) <= ANGLE * self.value(turned) else value

    def steep(self, e: Expr, where: str) -> tuple[list[str], dict[str, float]]:
        """Return by which names an expression has no finite slope, and its slopes by others."""
        fixed = transform(configure(e, self.discrete), _followed)
        without, slopes = [], {}
        for name in sorted(names(fixed) - {"time"}):
            try:
                slopes[name] = self.at(fixed, name, where)
            except EquationError:
                without.append(name)
        return without, slopes

    def turning(self, e: Expr, factor: float) -> Bend:
        """Return how the slopes of an expression change along the motion."""
        fixed = transform(configure(e, self.discrete), _followed)
        drift = self.value(partial_time(fixed, self.graph))
        slopes: dict[str, float] = {}
        bends: dict[tuple[str, str], float] = {}
        for name in sorted(names(fixed)):
            slope = simplify(differentiate(fixed, name))
            if isinstance(slope, Number):
                continue
            slopes[name] = self.value(partial_time(slope, self.graph))
            for other in sorted(n for n in names(slope) if n.startswith(("e:", "f:"))):
                second = self.value(differentiate(slope, other))
                if second:
                    bends[name, other] = second
        return Bend(factor * drift, slopes, bends, factor)

    def value(self, e: Expr) -> float:
        """Return the value of an expression, nan where it has none."""
        try:
            return float(compile_expression(e, self._index, pre_offset=0)(self._row))
        except (ArithmeticError, ValueError):
            return math.nan

    def _note_kinks(self, e: Expr, where: str) -> None:
        for turns in turning(e):
            if all(n == "time" or n.startswith((PREFIX, "at:")) for n in names(turns)):
                continue
            self.straight = False
            value = self.value(turns)
            if abs(value) <= KINK * self._size(turns):
                text = f"{where}: {describe(self.graph, turns)} = 0"
                if text not in self.kinks:
                    self.kinks.append(text)

    def _size(self, e: Expr) -> float:
        """Return how large an expression would be with all its names at their sizes."""
        total = 0.0
        for name in names(e):
            slope = self.value(differentiate(e, name))
            own = max(abs(self.values.get(name, 0.0)), self._largest[name.partition(":")[0]])
            total += abs(slope) * own if math.isfinite(slope) else 0.0
        return total


class ReadingSlopes(Slopes):
    """Slopes that are not zero wherever a state is read: a spring may happen to be slack.

    Those that are zero at the point are numbers of which no two are alike and no sums cancel: of
    two stops that face each other both act, but not at once.
    """

    def __init__(
        self, graph: FlatGraph, values: Mapping[str, float], discrete: Mapping[str, Expr]
    ) -> None:
        super().__init__(graph, values, discrete)
        self._asked = 0

    def at(self, e: Expr, name: str, where: str) -> float:
        """Return the slope of an expression by one name; a number for a state without a slope."""
        slope = super().at(e, name, where)
        if slope or not name.startswith(("x:", "s:")) or name not in names(e):
            return slope
        self._asked += 1
        return 1.0 + math.sqrt(self._asked) / 64.0


class ConstantSlopes(Slopes):
    """Differentiates expressions that are linear with constant coefficients; refuses all others."""

    def __init__(self, graph: FlatGraph, discrete: Mapping[str, Expr]) -> None:
        super().__init__(graph, {}, discrete)

    def of(self, e: Expr, where: str, *, given: bool = False) -> dict[str, float]:
        """Return the slopes of an expression by name, those that are not zero.

        Raises
        ------
        EquationError
            HB-Q103 for the law of an element that is not linear, HB-E671 for anything else.
        """
        fixed = configure(e, self.discrete)
        read = sorted(names(fixed))
        timed = {n for n in read if n == "time" or n.startswith("at:")}
        if (timed and not given) or any(names(a) - timed for a in turning(fixed)):
            raise self._bent(fixed, where)
        found = {}
        for name in read:
            slope = simplify(differentiate(fixed, name))
            if name in timed and not names(slope) - timed:
                continue  # what follows the time alone is what the source is driven by
            if not isinstance(slope, Number):
                raise self._bent(fixed, where)
            if slope.value:
                found[name] = float(slope.value)
        return found

    def _bent(self, e: Expr, where: str) -> EquationError:
        index = self.graph.by_path.get(where)
        kind = "" if index is None else self.graph.nodes[index].kind
        if kind and kind not in SOURCES:
            return EquationError(
                "the law is not linear, so the mode has no matrices",
                code="HB-Q103",
                where=where,
                hint="linearise at a point: hb.linearise",
            )
        return EquationError(
            f"{describe(self.graph, e)} is not linear with constant coefficients",
            code="HB-E671",
            where=where,
            hint="linearise at a point: hb.linearise; or make what it reads an input or a "
            "parameter, or choose another output",
        )


def _followed(e: Expr) -> Expr:
    """Return a number that follows from parameters as the expression of them that it is."""
    return tree_of(e.value) if isinstance(e, Number) and is_slotted(e) else e
