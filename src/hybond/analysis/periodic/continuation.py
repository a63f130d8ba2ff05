"""`continuation`: orbits along a parameter, stable or not, and what is passed between them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Unpack

import numpy as np

from hybond.analysis.periodic.arc import Arc, Node, OrbitPoint
from hybond.analysis.periodic.branch import Branch, Continuation
from hybond.analysis.periodic.multipliers import is_neutral
from hybond.analysis.periodic.newton import Found
from hybond.analysis.periodic.periodic import TOL, begin, newton_of, shots_of
from hybond.analysis.periodic.periods import Period, length_now, period_asked
from hybond.analysis.periodic.points import Passed, SpecialPoint, at_end, passed, turned
from hybond.analysis.periodic.shots import Shots, Shown, near_ends
from hybond.calls import called
from hybond.errors import NumericsError, UsageError
from hybond.model.builder import Model
from hybond.model.parts import Value
from hybond.result import Result
from hybond.runs.asked import MethodOptions
from hybond.runs.states import State
from hybond.units import is_of, try_quantity

POINTS = 60
"""Orbits that span the range at the least, if the branch is straight."""
LOCATED = 1e-7
"""Part of the range to which special points are located."""
LEAST = 1e-3
"""Part of the largest step below which no step is tried."""
CORNER = 3.0
"""Steps that the next point is away at the most, where the sequence of switches changes."""
BESIDE = 2e-2
"""Part of states by which the first orbit of twice the period is away from where it begins."""


@called('hb.continuation(model, "D", (0.3, 0.7))', options=MethodOptions)
def continuation(
    model: Model,
    parameter: str,
    values: Sequence[float | str],
    *,
    period: float | str | None = None,
    multiple: int = 1,
    doublings: int = 0,
    points: int = POINTS,
    max_points: int = 400,
    start: Result | State | Mapping[str, Any] | None = None,
    settle: float | str | None = None,
    parameters: Mapping[str, Value] | None = None,
    tol: float = TOL,
    progress: Shown | None = None,
    **options: Unpack[MethodOptions],
) -> Continuation:
    """Return the orbits of a model along a parameter, stable or not, and what they pass.

    The first is found as by `periodic`; from there it goes on by pseudo-arclength, so that the
    branch may turn back. Where a multiplier crosses the unit circle, or the sequence of switches
    changes, the point is located and named: fold, branching, period doubling, Neimark-Sacker,
    grazing, border collision.

    Parameters
    ----------
    model : Model
    parameter : str
        A parameter (``"D"``), the value of an element (``"r.R"``) or an input.
    values : sequence of two
        From where to where, SI or quantities.
    period, multiple, start, settle, parameters, tol, progress, **options
        As for `periodic`, for the first orbit.
    doublings : int
        How many times branches of twice the period are followed from period doublings.
    points : int
        Orbits on a straight branch; there are more where it bends.
    max_points : int
        Orbits after which a branch ends.

    Returns
    -------
    Continuation

    Raises
    ------
    UsageError
        HB-A543 for a range or numbers that are none; others as `periodic`.
    NumericsError
        HB-A540, HB-A542 if there is no first orbit, or it is one of a family.

    Examples
    --------
    A choke behind a chopper, at other duties; its multiplier stays what it is:

    >>> import hybond as hb
    >>> m = hb.Model("choke", domain="electrical", parameters={"D": 0.3})
    >>> m.input(u=hb.Input(pwm={"period": "0.1 ms", "duty": "D"}))
    >>> m.add(V=hb.Se("10 V*u"), L=hb.I("10 mH"), R=hb.R("1 ohm"), j=hb.One())
    >>> m.bond("V -> j -> L", "j -> R")
    >>> found = hb.continuation(m, "D", (0.3, 0.6), points=5)
    >>> branch = found.branches[0]
    >>> float(branch.values[-1]), branch.ended, found.special
    (0.6, 'the range ends', ())
    >>> round(branch.points[-1].multipliers[0].value.real, 9)
    0.990049834
    """
    first, last = _range(values)
    for name, number, least in (
        ("points", points, 2), ("max_points", max_points, 2), ("doublings", doublings, 0),
    ):  # fmt: skip
        if isinstance(number, bool) or not isinstance(number, int) or number < least:
            raise _no_range(f"{name} = {number!r}", name, f"{least} or more")
    if not isinstance(parameter, str):
        raise _no_range(f"parameter = {parameter!r} is no name", "parameter", '"D", or "r.R"')
    given = {k: v for k, v in (parameters or {}).items() if k != parameter}
    shots = shots_of(model, [parameter], given, options, progress)
    _check_units(values, shots.wanted.units[0])
    shots.at([first])
    asked = period_asked(shots, period, multiple)
    begun = begin(shots, asked, multiple, start, settle)
    found = newton_of(shots, begun, tol, 60).found(begun.x, begun.mode, begun.period.T)
    _check_one(shots, begun.period, found, parameter)
    follow = _Follow(shots, first, last, points, max_points, tol)
    branches = follow.all(begun.period, found, doublings)
    notes = [note for note in (begun.period.note, *found.notes) if note]
    title = found.shot.run.title
    unit = shots.wanted.units[0]
    return Continuation(title, parameter, unit, tuple(branches), shots.done, tuple(notes))


def _longest(node: Node, longest: float) -> float:
    """Return the longest step behind a point: longer where states have grown, not the parameter."""
    grown = max(1.0, float(np.abs(node.z[:-1]).max(initial=0.0)))
    return longest * min(grown, 1.0 / max(abs(float(node.tangent[-1])), 1e-300))


def _goes_on(node: Node, found: Node, step: float) -> bool:
    """Whether a point is the next one of the curve, which may have a corner between the two."""
    if float(found.tangent @ node.tangent) > 0.3:
        return True
    corner = found.path != node.path
    return corner and float(np.linalg.norm(found.z - node.z)) <= CORNER * step


def _range(values: Any) -> tuple[float, float]:
    ends: list[float] = []
    if not isinstance(values, Sequence) or isinstance(values, str) or len(values) != 2:
        raise _no_range(f"{values!r} is not from where to where", "values", "(0.3, 0.7)")
    for value in values:
        quantity = try_quantity(value) if isinstance(value, str) else None
        if quantity is not None:
            ends.append(quantity.value)
        elif isinstance(value, int | float) and not isinstance(value, bool):
            ends.append(float(value))
        else:
            raise _no_range(f"{value!r} is no value", "values", '(0.3, 0.7), ("1 V", "5 V")')
    if not np.isfinite(ends).all() or ends[0] == ends[1]:
        raise _no_range(f"from {ends[0]:g} to {ends[1]:g} there is no way", "values", "two values")
    return ends[0], ends[1]


def _check_one(shots: Shots, period: Period, found: Found, parameter: str) -> None:
    """Refuse an orbit of a family, of which nothing says which one belongs to another value.

    Raises
    ------
    NumericsError
        HB-A542.
    """
    if not period.own or not found.free:
        return
    free = len(found.free)
    if not is_neutral(
        shots.multipliers(found.shot, found.sizes, found.kept, own=True, conserved=free)
    ):
        return
    error = NumericsError(
        f"the first orbit is one of a family, by {found.free[0]}: at another value of {parameter} "
        "there is a family again, and nothing says which of it is the next one",
        code="HB-A542",
        where=parameter,
        hint="find one for each value from a start of its own with hb.periodic, or let something "
        "decide it: a loss and what makes up for it",
    )
    error.partial = found.shot.run
    raise error


def _check_units(values: Sequence[float | str], unit: str) -> None:
    for value in values:
        quantity = try_quantity(value) if isinstance(value, str) else None
        if quantity is not None and not is_of(quantity, unit):
            raise _no_range(f"{value!r} is no value of what is in {unit}", "values", f"in {unit}")


def _no_range(why: str, where: str, hint: str) -> UsageError:
    return UsageError(why, code="HB-A543", where=where, hint=hint)


@dataclass
class _Follow:
    """The way along a parameter.

    Parameters
    ----------
    shots : Shots
    first, last : float
        The range.
    points, most : int
    tol : float
    """

    shots: Shots
    first: float
    last: float
    points: int
    most: int
    tol: float

    @property
    def span(self) -> float:
        """What the parameter is measured by."""
        return abs(self.last - self.first)

    def all(self, period: Period, found: Found, doublings: int) -> list[Branch]:
        """Return the branch of an orbit, and those that are doubled from it."""
        shot = found.shot
        free = len(found.free)
        now = replace(period, T=shot.T) if period.own else period
        base = Arc(self.shots, now, shot.x, found.sizes, found.kept, free, self.tol, self.span)
        along = np.zeros(len(found.kept) + 1 + period.own)
        along[-1] = np.sign(self.last - self.first)
        row = np.abs(along)
        z = base.z_of(shot.x, shot.T, self.first)
        begin = base.corrected(z, shot.mode, row, None, along)
        if begin is None:
            raise NumericsError(
                f"the first orbit cannot be followed: {base.why}",
                code="HB-A542",
                where=f"{self.shots.wanted.names[0]} = {self.first:.9g}",
                hint="begin at another value of the parameter",
            )
        branches = []
        level: list[tuple[Arc, Node, int, SpecialPoint | None]]
        level = [(base, begin, period.multiple, None)]
        for round_ in range(doublings + 1):
            following: list[tuple[Arc, Node, int, SpecialPoint | None]] = []
            for arc, node, multiple, born in level:
                branch, passed_ = self._branch(arc, node, multiple)
                branches.append(replace(branch, born=born))
                if round_ == doublings:
                    continue
                for p in passed_:
                    made = self._doubled(arc, p) if p.point.kind == "period doubling" else None
                    if made is not None:
                        following.append((*made, 2 * multiple, p.point))
            level = following
        return branches

    def _doubled(self, arc: Arc, passed_: Passed) -> tuple[Arc, Node] | None:
        """Return the branch of twice the period where it begins, if that is within the range."""
        for amplitude in (BESIDE, BESIDE / 4.0, BESIDE / 16.0):
            made = arc.doubled(passed_.node, amplitude)
            if made is not None and self._out(*made) is None:
                return made
        return None

    def _branch(self, arc: Arc, begin: Node, multiple: int) -> tuple[Branch, list[Passed]]:
        nodes, arcs, found = [begin], [arc], list[Passed]()
        longest = 1.0 / self.points
        step, ended = longest, f"after {self.most} orbits"
        node = begin
        while len(nodes) < self.most:
            if near_ends(node.shot.run, node.shot.T) and (moved := arc.elsewhere(node)):
                arc, node = moved
                nodes[-1] = node
                arcs[-1] = arc
            following, step, why = self._next(arc, node, step, longest)
            if following is None:
                node, what = at_end(arc, node, step, LOCATED)
                nodes.append(node)
                arcs.append(arc)
                if what is None:
                    ended = why
                    break
                found.append(what)
                following = turned(arc, node)
                if following is None:
                    ended = f"it ends there: {what.point.kind}"
                    break
                step = longest / 10.0
                nodes.append(following)
                arcs.append(arc)
                node = following
                continue
            out = self._out(arc, following)
            if out is not None:
                exact = arc.at_parameter(node, out)
                following = exact or following
                ended = "the range ends"
            here = passed(arc, node, following, LOCATED)
            found += here
            more = [n for p in here for n in (p.node, p.after) if n is not None]
            nodes += [*more, following]
            arcs += [arc] * (len(more) + 1)
            node = following
            if out is not None:
                break
        points = tuple(a.point(n) for a, n in zip(arcs, nodes, strict=True))
        special = tuple(p.point for p in found)
        return Branch(multiple, points, special, ended), found

    def _next(
        self, arc: Arc, node: Node, step: float, longest: float
    ) -> tuple[Node | None, float, str]:
        """Return the next point of the curve, the step after it, and why there is none."""
        while step >= LEAST * longest:
            z = node.z + step * node.tangent
            found = arc.corrected(z, node.mode, node.tangent, node, node.tangent)
            if found is not None and _goes_on(node, found, step):
                grown = 1.5 * step if found.iterations <= 3 else step
                return found, min(grown, _longest(found, longest)), ""
            step *= 0.5
        at = arc.parameter(node.z)
        return None, step, f"beyond {at:.9g} it is not found any more: {arc.why}"

    def _out(self, arc: Arc, node: Node) -> float | None:
        """Return the end of the range that a point is beyond, if it is."""
        p = arc.parameter(node.z)
        low, high = sorted((self.first, self.last))
        if p >= high:
            return high
        return low if p <= low else None


__all__ = ["OrbitPoint", "continuation", "length_now"]
