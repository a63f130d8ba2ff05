"""The ports of a graph linearised at its start state."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.equations.ports import PortEquations
from hybond.equations.slots import Slots
from hybond.errors import NumericsError
from hybond.model.expressions import compile_expression
from hybond.model.graph import FlatGraph, Mode

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
STEP = 1e-5
"""Part of a stored quantity that it is moved by; central differences are then exact to 1e-10."""


@dataclass(frozen=True, slots=True)
class Linearised:
    """``x' = A x + E l + a``, ``w = C x + D l + c`` near a point.

    Parameters
    ----------
    A, E, C, D : array
    a, c : array
        What is left at ``x = 0, l = 0``: sources, and what the tangent has there.
    """

    A: Matrix
    E: Matrix
    C: Matrix
    D: Matrix
    a: Vector
    c: Vector


def start_values(
    graph: FlatGraph, mode: Mode, slots: Slots
) -> tuple[list[float], Vector, Mapping[str, float]]:
    """Return the values at the start, the stored quantities, and what selects a configuration.

    Bond variables are zero. A start given by a co-energy variable is solved for, from zero.
    """
    v = [0.0] * (2 * slots.size)
    for i in graph.inputs:
        piece = i.waveform.piece(0.0)
        v[slots.index[f"u:{i.index}"]] = i.waveform.value(0.0, piece)
        v[slots.index[f"du:{i.index}"]] = i.waveform.rate(0.0, piece)
    for s in graph.integrals:
        v[slots.index[f"s:{s.index}"]] = s.start
    on = graph.on_nodes(mode)
    for n in graph.nodes:
        if n.controlled:
            v[slots.index[f"on:{n.index}"]] = float(n.index in on)
    for m, k in zip(graph.machines, mode, strict=True):
        v[slots.index[f"in:{m.index}:{k}"]] = 1.0
    for w in graph.watches:
        truth = compile_expression(w.compare, slots.index, pre_offset=slots.size)
        v[slots.index[f"at:{w.index}"]] = float(bool(truth(v)))
    x = _stored(graph, slots)
    v[slots.x] = x.tolist()
    discrete = {
        name: v[slots.index[name]]
        for name in slots.index
        if name.startswith("at:") or name.startswith("u:")
    }
    return v, x, discrete


def _stored(graph: FlatGraph, slots: Slots) -> Vector:
    """Return what is stored at the start, by Newton's method where its co-energy is given."""
    from hybond.equations.storage import StorageLaws

    laws = StorageLaws.of(graph, slots)
    x = np.array([s.start if s.start_is == "stored" else 0.0 for s in graph.storages])
    wanted = [s.index for s in graph.storages if s.start_is == "co-energy"]
    if not wanted:
        return x
    goal = np.array([graph.storages[k].start for k in wanted])
    for _ in range(50):
        rest = goal - laws.co_energy(x)[wanted]
        slope = laws.stiffness(x, wanted)
        move = np.linalg.lstsq(slope, rest, rcond=None)[0]
        x[wanted] += move
        if np.abs(move).max() <= 1e-14 * np.abs(x).max():
            break
    return x


def linearised(ports: PortEquations, v: list[float], x: Vector) -> Linearised:
    """Return the tangent of a graph at the values `v` and the stored quantities `x`."""
    e = ports.equations
    response = ports.response(v, x)
    n, count = len(x), len(ports.ports)
    A, C = np.zeros((n, n)), np.zeros((count, n))
    size = max(float(np.abs(x).max(initial=0.0)), 1.0)
    nothing = np.zeros(count)
    for k in range(n):
        h = STEP * max(abs(float(x[k])), size if n == 1 else 1e-3 * size)
        sides = []
        for way in (h, -h):
            moved = x.copy()
            moved[k] += way
            v[e.slots.x] = moved.tolist()
            sides.append(ports.solve(v, moved, nothing))
        slope = (sides[0] - sides[1]) / (2.0 * h)
        A[:, k] = e.storage.rates_of(slope)
        C[:, k] = ports.partner @ slope
    v[e.slots.x] = x.tolist()
    if not all(np.isfinite(m).all() for m in (A, C, response.D, response.E)):
        raise NumericsError(
            "a law has no slope at the start state",
            code="HB-Q107",
            where=e.graph.name,
            hint="start beside this point",
        )
    a = e.storage.rates_of(response.bonds) - A @ x
    c = response.y - C @ x
    return Linearised(_clean(A), _clean(response.E), _clean(C), _clean(response.D), a, c)


def _clean(m: Matrix) -> Matrix:
    """Return a matrix without what is rounding beside its largest entry."""
    return np.where(np.abs(m) <= 1e-9 * np.abs(m).max(initial=0.0), 0.0, m)
