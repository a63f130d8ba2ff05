"""The job in SciPy: `solve_ivp` up to the next event, then again, as its users write it."""

from __future__ import annotations

import time
from collections.abc import Callable, Hashable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from measuring.problem import Outcome

Vector = NDArray[np.float64]
Field = Callable[[float, Vector], Any]
Guard = Callable[[float, Vector], float]
Rule = tuple[Guard, Callable[[float, Vector], tuple[Hashable, Vector]]]
"""A guard that falls through zero, and the mode and state after it."""
Mode = tuple[Field, Sequence[Rule]]


def terminal(guard: Guard) -> Guard:
    """Return a guard as an event that ends the piece."""

    def event(t: float, y: Vector) -> float:
        return guard(t, y)

    event.terminal = True  # type: ignore[attr-defined]
    event.direction = -1.0  # type: ignore[attr-defined]
    return event


def in_scipy(
    mode_of: Callable[[Hashable], Mode],
    mode: Hashable,
    y0: Sequence[float],
    until: float,
    count: int,
    read: Callable[[float, Vector, list[float]], tuple[float, ...]],
    *,
    rtol: float = 1e-8,
    atol: float = 1e-10,
    method: str = "RK45",
    max_step: float = np.inf,
    edges: Callable[[int], tuple[float, Callable[[Vector], Hashable]]] | None = None,
) -> Outcome:
    """Follow the modes up to the end.

    Parameters
    ----------
    mode_of : callable
        The field of a mode and its rules.
    mode, y0
        At the start.
    until, count
        End, and number of output points.
    read : callable
        ``read(t, y, times)`` with the end state and the times of events; not timed.
    edges : callable
        Number and so time of a timed event, and the mode it leads to.
    """
    from scipy.integrate import solve_ivp

    at = np.linspace(0.0, until, count)
    kept: list[Vector] = []
    events: list[tuple[float, Hashable, Vector]] = []
    start = time.perf_counter()
    t, y, edge = 0.0, np.array(y0, dtype=float), 0
    while t < until:
        rhs, rules = mode_of(mode)
        stop, then = edges(edge) if edges else (until, None)
        stop = min(stop, until)
        wanted = at[np.searchsorted(at, t) : np.searchsorted(at, stop, side="right")]
        piece = solve_ivp(
            rhs,
            (t, stop),
            y,
            method=method,
            max_step=max_step,
            rtol=rtol,
            atol=atol,
            events=[terminal(guard) for guard, _ in rules],
            t_eval=np.append(wanted[wanted < stop], stop),
        )
        hit = [k for k, times in enumerate(piece.t_events or ()) if len(times)]
        kept.append(piece.y)
        if hit:
            t = float(piece.t_events[hit[0]][0])
            mode, y = rules[hit[0]][1](t, piece.y_events[hit[0]][0])
            events.append((t, mode, y))
        else:
            t, y = stop, piece.y[:, -1]
            if then is not None and t < until:
                mode, edge = then(y), edge + 1
                events.append((t, mode, y))
    seconds = time.perf_counter() - start
    return Outcome(seconds, read(t, y, [e[0] for e in events]), len(events))
