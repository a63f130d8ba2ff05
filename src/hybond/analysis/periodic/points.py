"""What is passed between two orbits of a branch: named, and located.

Along one sequence of switches the map of a period is smooth, and multipliers cross the unit circle:

    fold              the branch turns back in the parameter
    branching         a real multiplier crosses +1, and it does not turn: another branch crosses
    period doubling   one crosses -1
    Neimark-Sacker    a pair crosses elsewhere

Where the sequence changes, multipliers jump:

    grazing           a guard begins to be reached where it is touched: its instant is infinitely
                      sensitive, and so is the period beyond it
    border collision  switches share an instant and change order, or one falls on an edge of time

Source: di Bernardo, Budd, Champneys and Kowalczyk, Piecewise-smooth Dynamical Systems, 2008.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.periodic.arc import Arc, Node, OrbitPoint
from hybond.analysis.periodic.multipliers import is_stable
from hybond.analysis.periodic.shots import Shot
from hybond.analysis.sensitivity.collocation import Jump

Vector = NDArray[np.float64]

KINDS = (
    "fold", "branching", "period doubling", "Neimark-Sacker", "grazing", "border collision",
)  # fmt: skip
BISECTIONS = 40
SENSITIVE = 30.0
"""How many times the period an instant moves with a state, as parts of both, where a guard is
nearly only touched."""


@dataclass(frozen=True, slots=True, eq=False)
class SpecialPoint:
    """What is passed on a branch.

    Parameters
    ----------
    kind : str
        ``"fold"``, ``"branching"``, ``"period doubling"``, ``"Neimark-Sacker"``, ``"grazing"`` or
        ``"border collision"``.
    value : float
        Of the parameter, SI.
    text : str
        What crosses, or which switches there are before and after.
    orbit : OrbitPoint
        There; where the sequence of switches changes, just before it.
    within : float
        How well `value` is known.
    """

    kind: str
    value: float
    text: str
    orbit: OrbitPoint
    within: float


@dataclass(frozen=True, slots=True, eq=False)
class Passed:
    """A special point with its place on the curve.

    Parameters
    ----------
    point : SpecialPoint
    node : Node
    after : Node, optional
        The first point behind it, where the sequence of switches changes.
    """

    point: SpecialPoint
    node: Node
    after: Node | None = None


def passed(arc: Arc, a: Node, b: Node, tolerance: float) -> list[Passed]:
    """Return what is passed between two points of the curve, in order.

    Parameters
    ----------
    tolerance : float
        Of the parameter, as a part of what it is measured by.
    """
    if a.path == b.path:
        return _smooth(arc, a, b, tolerance)
    found: list[Passed] = []
    for _ in range(8):
        before, after = _change(arc, a, b, tolerance)
        gap = float(np.abs(after.z - before.z).max())
        what = None
        if gap > 10.0 * tolerance:
            # between them the curve bends away, as it does where a guard is touched
            before, what = at_end(arc, before, gap, tolerance)
        found += _smooth(arc, a, before, tolerance)
        found.append(_border(arc, before, after) if what is None else replace(what, after=after))
        a = after
        if a.path == b.path:
            break
    return found + (_smooth(arc, a, b, tolerance) if a.path == b.path else [])


def _change(arc: Arc, a: Node, b: Node, tolerance: float) -> tuple[Node, Node]:
    """Return two near points between which the sequence of switches changes."""
    low, high, path = a, b, a.path
    for _ in range(BISECTIONS):
        if float(np.abs(high.z - low.z).max()) <= tolerance:
            break
        middle = None
        for part in (0.5, 0.3, 0.7):
            middle = arc.between(low, high, part)
            if middle is not None:
                break
        if middle is None:
            break
        low, high = (middle, high) if middle.path == path else (low, middle)
    return low, high


def _smooth(arc: Arc, a: Node, b: Node, tolerance: float) -> list[Passed]:
    """Return what multipliers and the tangent pass along one sequence of switches."""
    if a is b:
        return []
    found = []
    if a.tangent[-1] * b.tangent[-1] < 0.0:
        found.append(_located(arc, a, b, "fold", lambda n: float(n.tangent[-1]), tolerance))
    elif _sign(a, 1.0) * _sign(b, 1.0) < 0.0:
        found.append(_located(arc, a, b, "branching", lambda n: _sign(n, 1.0), tolerance))
    if _sign(a, -1.0) * _sign(b, -1.0) < 0.0:
        found.append(_located(arc, a, b, "period doubling", lambda n: _sign(n, -1.0), tolerance))
    outside = _pairs(a) - _pairs(b)
    same = _sign(a, 1.0) * _sign(b, 1.0) > 0.0 and _sign(a, -1.0) * _sign(b, -1.0) > 0.0
    still = all(any(m.kind == "neutral" for m in n.found) for n in (a, b))
    if outside and same and not still and abs(_outside(a) - _outside(b)) >= 2:
        most = max(_pairs(a), _pairs(b))
        found.append(_located(arc, a, b, "Neimark-Sacker", lambda n: _pair(n, most), tolerance))
    return sorted(found, key=lambda p: float(np.linalg.norm(p.node.z - a.z)))


def _values(node: Node) -> NDArray[np.complex128]:
    return np.array([m.value for m in node.found if m.counts and m.kind != "zero"], dtype=complex)


def _sign(node: Node, at: float) -> float:
    """Return the product of ``1 - mu/at``: it passes zero where a multiplier passes ``at``."""
    return float(np.real(np.prod(1.0 - _values(node) / at)))


def _outside(node: Node) -> int:
    return int((np.abs(_values(node)) > 1.0).sum())


def _pairs(node: Node) -> int:
    values = _values(node)
    return int(((np.abs(values) > 1.0) & (values.imag > 0.0)).sum())


def _pair(node: Node, number: int) -> float:
    """Return by how much the pair with this number, by size, is outside the circle."""
    values = _values(node)
    sizes = np.sort(np.abs(values[values.imag > 0.0]))[::-1]
    return float(sizes[number - 1] - 1.0) if len(sizes) >= number else -1.0


def _located(
    arc: Arc, a: Node, b: Node, kind: str, g: Callable[[Node], float], tolerance: float
) -> Passed:
    """Return where a function of the curve passes zero, by secants that keep a bracket."""
    low, high = 0.0, 1.0
    left, right = g(a), g(b)
    best = a if abs(left) <= abs(right) else b
    chord = float(np.abs(b.z - a.z).max())
    side = 0
    for k in range(BISECTIONS):
        if (high - low) * chord <= tolerance:
            break
        part = low + (high - low) * left / (left - right)
        if k % 3 == 2 or not low < part < high:
            part = 0.5 * (low + high)
        node = arc.between(a, b, part)
        if node is None:
            node = arc.between(a, b, part := 0.5 * (low + high))
        if node is None:
            break
        value = g(node)
        if abs(value) <= abs(g(best)):
            best = node
        if value == 0.0 or abs(value) <= 1e-10:
            low = high = part
            break
        if value * left > 0.0:
            low, left = part, value
            right *= 0.5 if side == 1 else 1.0
            side = 1
        else:
            high, right = part, value
            left *= 0.5 if side == -1 else 1.0
            side = -1
    within = (high - low) * abs(float(b.z[-1] - a.z[-1])) * arc.span
    point = arc.point(best)
    near = _crossing(best, kind)
    return Passed(SpecialPoint(kind, point.value, near, point, within), best)


def _crossing(node: Node, kind: str) -> str:
    values = _values(node)
    if not len(values):
        return "the branch turns back"
    target = {"period doubling": -1.0}.get(kind, 1.0)
    if kind == "Neimark-Sacker":
        complex_ = values[values.imag > 0.0]
        if not len(complex_):
            return "a pair of multipliers on the unit circle"
        mu = complex_[int(np.argmin(np.abs(np.abs(complex_) - 1.0)))]
        return f"a pair of multipliers at an angle of {abs(np.angle(mu)):.6g} rad"
    mu = values[int(np.argmin(np.abs(values - target)))]
    return f"a multiplier of {mu.real:.9g}"


def _border(arc: Arc, before: Node, after: Node) -> Passed:
    """Return the point at which the sequence of switches changes, and what that is."""
    kind, said = _named(arc, before.shot, after.shot)
    stable = ["stable" if is_stable(n.found) else "not stable" for n in (before, after)]
    if stable[0] != stable[1]:
        said.append(f"{stable[0]} before, {stable[1]} after")
    value = 0.5 * float(before.z[-1] + after.z[-1]) * arc.span
    within = abs(float(after.z[-1] - before.z[-1])) * arc.span
    point = SpecialPoint(kind, value, "; ".join(said), arc.point(before), within)
    return Passed(point, before, after)


def _named(arc: Arc, before: Shot, after: Shot) -> tuple[str, list[str]]:
    """Return what makes the sequence of switches change between two near shots, and which."""
    more, less = (before, after) if len(before.path) > len(after.path) else (after, before)
    touched = _touched(arc, more)
    said = [_what_changes(before, after)]
    if "grazing" in more.why or (touched and touched[0] > 3.0 * _sensitivity(arc, less)):
        return "grazing", [f"{touched[1]} is only touched" if touched else more.why, *said]
    return "border collision", said


def _instants(shot: Shot) -> list[tuple[str, Jump]]:
    found: list[tuple[str, Jump]] = []
    if shot.chain is None:
        return found
    for instant in shot.chain.instants:
        if instant.place is not None:
            link = shot.chain.links[instant.place]
            assert isinstance(link, Jump)
            found.append((instant.text, link))
    return found


def _moves(arc: Arc, shot: Shot, jump: Jump) -> float:
    """Return how many times the period an instant moves with a state, as parts of both."""
    own = np.abs(jump.time[arc.kept]) * arc.sizes
    return float(own.max(initial=0.0)) / shot.T


def _sensitivity(arc: Arc, shot: Shot) -> float:
    return max((_moves(arc, shot, jump) for _, jump in _instants(shot)), default=0.0)


def _touched(arc: Arc, shot: Shot) -> tuple[float, str] | None:
    """Return the guard that is nearly only touched, if there is one."""
    found = [(_moves(arc, shot, jump), text) for text, jump in _instants(shot)]
    return max((row for row in found if row[0] > SENSITIVE), default=None)


def _what_changes(before: Shot, after: Shot) -> str:
    """Return which switches there are on one side only."""
    for caused in (False, True):
        names = [_switches(shot, caused=caused) for shot in (before, after)]
        said = []
        for k, word in ((0, "before"), (1, "after")):
            own, other = names[k], names[1 - k]
            more = [n for n in dict.fromkeys(own) if own.count(n) > other.count(n)]
            said += [f"{n} only {word}" for n in more]
        if said:
            return ", ".join(said[:3])
    return "switches change their order" if before.path != after.path else "two share an instant"


def _switches(shot: Shot, *, caused: bool) -> list[str]:
    """Return the switches of a period in words, with what causes them if that is asked for."""
    machines = shot.run.graph.machines
    found = []
    for cause, modes in shot.path:
        by = "" if not caused else " at an edge" if cause in ("input", "time") else " by itself"
        found += [
            f"{m.path} {m.states[old[m.index]]} -> {m.states[new[m.index]]}{by}"
            for old, new in itertools.pairwise(modes)
            for m in machines
            if old[m.index] != new[m.index]
        ]
    return found


def at_end(arc: Arc, node: Node, step: float, tolerance: float) -> tuple[Node, Passed | None]:
    """Return the last point of a branch that cannot be followed on, and what is there.

    Parameters
    ----------
    step : float
        A step along the tangent that cannot be made.
    """
    while step > tolerance:
        z = node.z + step * node.tangent
        first = arc.tried(z, node.mode)
        if first is not None and first.path == node.shot.path:
            found = arc.corrected(z, node.mode, node.tangent, node, node.tangent)
            if found is not None and found.path == node.path:
                node = found
        step *= 0.5
    for ahead in (2.0, 8.0, 32.0):
        beyond = arc.tried(node.z + ahead * tolerance * node.tangent, node.mode)
        if beyond is not None and (beyond.path != node.shot.path or beyond.M is None):
            break
    else:
        return node, None
    kind, said = _named(arc, node.shot, beyond)
    value = arc.parameter(node.z)
    within = ahead * tolerance * arc.span
    return node, Passed(SpecialPoint(kind, value, "; ".join(said), arc.point(node), within), node)


def turned(arc: Arc, node: Node) -> Node | None:
    """Return an orbit with another sequence of switches near a point at which a branch ends.

    A guard that is touched at a distance h beyond the point moves the end of a period as the root
    of h does: by y b with y^2 = h. So orbits with the new switches leave the point along

        J d + b y = 0,    h_z d = y^2, to first order 0

    with J of the old sequence, and the slope of h as that of the new instant, which is along it.
    Where switches share an instant, orbits with the new ones leave it along the curve of their own
    map, which may have a corner there, and turn back in the parameter.
    """
    beyond = None
    for ahead in (1e-6, 1e-5, 1e-4):
        beyond = arc.tried(node.z + ahead * node.tangent, node.mode)
        if beyond is not None and beyond.M is not None and beyond.path != node.shot.path:
            break
    if beyond is None or beyond.M is None or beyond.path == node.shot.path:
        return None
    off, own = arc.equations(beyond, node)
    _, J = arc.equations(node.shot, node)
    slope = _slope_of_instant(arc, beyond)
    ways = [] if slope is None else [(arc.solved(J, slope, -off, 0.0), node.mode)]
    ways.append((arc.solved(own, node.tangent, np.zeros(len(own)), 1.0), beyond.end_mode))
    for way, mode in ways:
        size = float(np.linalg.norm(way))
        if not size > 0.0:
            continue
        row = way / size
        for part in (1e-3, 3e-3, 1e-2, 3e-2, 1e-1):
            for sign in (1.0, -1.0):
                z = node.z + sign * part * row
                found = arc.corrected(z, mode, row, node, sign * row)
                if found is not None and found.path != node.path:
                    return found
    return None


def _slope_of_instant(arc: Arc, shot: Shot) -> Vector | None:
    """Return how the instant that moves most follows the unknowns, of length 1."""
    chain = shot.chain
    if chain is None:
        return None
    before = chain.forward()
    jumps = [(k, link) for k, link in enumerate(chain.links) if isinstance(link, Jump)]
    if not jumps:
        return None
    k, link = max(jumps, key=lambda row: _moves(arc, shot, row[1]))
    moved = link.moved(before[k])
    n = len(shot.x)
    own = [0.0] if arc.period.own else []
    slope = np.array([*(moved[:n][arc.kept] * arc.sizes), *own, moved[n] * arc.span])
    size = float(np.linalg.norm(slope))
    return slope / size if size > 0.0 else None
