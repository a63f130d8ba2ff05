"""A clutch whose capacity comes to nothing by what it moves: a step had no answer (HB-J120).

Along its slope a limit `max(x, 0)` is less than nothing behind the corner, which no friction keeps.
"""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

LIMITS: dict[str, Callable[[float, float, float], float]] = {
    "max(e.f^2 - {c}^2, 0)*{k}/{c}^2": lambda w, c, k: max(w * w / c**2 - 1, 0) * k,
    "max(we.f - {c}, 0)*{k}/{c}": lambda w, c, k: max(w / c - 1, 0) * k,
    "(abs(we.f - {c}) + we.f - {c})*{k}/{c}": lambda w, c, k: 2 * max(w / c - 1, 0) * k,
    "if we.f > {c} then (we.f - {c})*{k}/{c} else 0": lambda w, c, k: max(w / c - 1, 0) * k,
}


def clutch(limit: str, turned: bool, speed: float, size: float, last_first: bool) -> hb.Model:
    m = hb.Model("m")
    sign = -1.0 if turned else 1.0
    parts = {
        "we": hb.One(),
        "wl": hb.One(),
        "n": hb.Zero(),
        "e": hb.I(size, f=2.0 * speed),
        "l": hb.I(2.0 * size, f=0.0),
        "cl": hb.One(law="coulomb", limit=limit),
        "d": hb.R(0.5 * size),
        "push": hb.Se(sign * 0.1 * size * speed),
    }
    bonds = ["we -> e", "l -> wl", "we -> n -> wl", "n -> cl", "d -> we"]
    bonds.append("wl -> push" if turned else "push -> wl")
    names = list(parts)[::-1] if last_first else list(parts)
    m.add({name: parts[name] for name in names})
    m.bond(*(bonds[::-1] if last_first else bonds))
    return m


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("limit", LIMITS)
def test_a_clutch_lets_go_within_a_step(limit: str, turned: bool, size: float) -> None:
    speed = 3.0
    k = 0.8 * size * speed
    text = limit.format(c=speed, k=k)
    m = clutch(text, turned, speed, size, size > 1.0)
    capacity = LIMITS[limit]

    def rates(t: float, w: np.ndarray) -> list[float]:
        force = capacity(w[0], speed, k) if w[0] > w[1] else -capacity(w[0], speed, k)
        return [
            (-force - 0.5 * size * w[0]) / size,
            (force + 0.1 * size * speed) / (2.0 * size),
        ]

    times = np.linspace(0.0, 4.0, 81)
    true = solve_ivp(
        rates, (0.0, 4.0), [2.0 * speed, 0.0], rtol=1e-10, atol=1e-12, max_step=0.01, t_eval=times
    ).y
    errors = []
    for step in (0.02, 0.005):
        run = hb.simulate(m, until=4.0, solver="moreau-jean", step=step)
        assert run.status == "ok"
        assert run.audit().holds()
        errors.append(
            max(
                np.max(np.abs(np.asarray(run[name].at(times.tolist())) - true[i]))
                for i, name in enumerate(["we.f", "wl.f"])
            )
        )
    assert errors[0] < 0.02 * speed
    assert errors[1] < 0.4 * errors[0]
    located = hb.simulate(m, until=4.0, solver="radau" if turned else "auto")
    for i, name in enumerate(["we.f", "wl.f"]):
        assert np.max(np.abs(located[name].at(times.tolist()) - true[i])) < 1e-6 * speed
