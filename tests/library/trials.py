"""Runs of a few parts that are joined at their ports, and what a run says of its events."""

import math
from collections.abc import Iterator

from library.bench import every_way

import hybond as hb

_tried: set[tuple[str, ...]] = set()


def trials(
    joints: str, until: float, *, rtol: float = 1e-10, **parts: hb.Submodel
) -> Iterator[hb.Result]:
    """Run parts with their bonds drawn in every direction; each run has to pass its audit.

    Parameters
    ----------
    joints : str
        The bonds between the parts, ``"a.flange - b.left, f.flange -> a.flange"``: those without an
        arrow are drawn both ways. Once these parts have been tried in all combinations, other
        values of their parameters are tried with all bonds forward and all backward.
    until : float
    rtol : float
        The absolute tolerance is a hundredth of it.
    **parts
        The parts by name.
    """
    bonds = joints.split(", ")
    m = hb.Model("bench", domain="translational")
    m.add(**parts)
    m.bond(*(bond for bond in bonds if "->" in bond))
    ways = every_way(m, *(bond for bond in bonds if "->" not in bond))
    kinds = (joints, *(str(part.model) for part in parts.values()))
    if kinds in _tried:
        ways = [way for way in ways if way.bonds in (ways[0].bonds, ways[-1].bonds)]
    _tried.add(kinds)
    for way in ways:
        run = hb.simulate(way, until=until, rtol=rtol, atol=rtol / 100)
        assert (run.status, run.audit().holds()) == ("ok", True), (way.name, run.audit())
        yield run


def instants(run: hb.Result) -> list[float]:
    """Return the times of events after the start."""
    return [e.t for e in run.events if e.cause != "start"]


def lost(run: hb.Result) -> float:
    """Return the energy that all jumps lost."""
    steps = (s for e in run.events for s in e.steps if s.energy and s.kind != "mythical")
    return sum(s.energy.lost for s in steps)


def after_impact(m1: float, v1: float, m2: float, v2: float, eps: float) -> tuple[float, float]:
    """Return the velocities of two bodies after Newton's impact."""
    together = (m1 * v1 + m2 * v2) / (m1 + m2)
    apart = eps * (v1 - v2) / (m1 + m2)
    return together - m2 * apart, together + m1 * apart


def kelvin_voigt(m: float, k: float, d: float) -> tuple[float, float]:
    """Return restitution and duration of an impact on spring and damper that only push.

    The force `k*x + d*x'` ends where the phase is pi less twice the angle whose sine is the
    damping ratio; there the speed is what the decay of the envelope has left of it.
    """
    w = (k / m) ** 0.5
    z = d / (2 * m * w)
    t = (math.pi - 2 * math.asin(z)) / (w * math.sqrt(1 - z**2))
    return math.exp(-z * w * t), t
