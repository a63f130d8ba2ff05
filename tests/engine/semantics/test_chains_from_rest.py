"""Chains of masses that start at rest, behind springs with play."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

PLAY = "400*(max(q - 0.1, 0) - max(-0.1 - q, 0))"
HARD = "1e5*(max(q - 0.02, 0) - max(-0.02 - q, 0)) + 10*q"
Force = Callable[[float], float]
FORCES: dict[str, Force] = {
    PLAY: lambda q: 400.0 * (max(q - 0.1, 0.0) - max(-0.1 - q, 0.0)),
    HARD: lambda q: 1e5 * (max(q - 0.02, 0.0) - max(-0.02 - q, 0.0)) + 10.0 * q,
    "400*q^3": lambda q: 400.0 * q**3,
    "400*max(q - 0.05, 0)": lambda q: 400.0 * max(q - 0.05, 0.0),
}
FLOWS: dict[str, Force] = {
    "time": lambda t: t,
    "5*cos(6*time)": lambda t: 5.0 * np.cos(6.0 * t),
    "sin(3*time)": lambda t: np.sin(3.0 * t),
}


def chain(flow: str, laws: list[str]) -> hb.Model:
    m = hb.Model("chain")
    m.add(s=hb.Sf(flow))
    for k, law in enumerate(laws):
        m.add(
            {f"m{k}": hb.I(1.0), f"v{k}": hb.One(), f"n{k}": hb.Zero(), f"k{k}": hb.C({"e": law})}
        )
        m.bond(
            f"{'s' if k == 0 else f'v{k - 1}'} -> n{k}", f"n{k} -> v{k} -> m{k}", f"n{k} -> k{k}"
        )
    return m


def meant(flow: str, laws: list[str], until: float) -> np.ndarray:
    """Speeds by DOP853, in steps that are far shorter than what a kink does."""
    n = len(laws)
    force = [FORCES[law] for law in laws]

    def rates(t: float, y: np.ndarray) -> np.ndarray:
        v, q = y[:n], y[n:]
        f = np.array([force[k](q[k]) for k in range(n)])
        before = np.concatenate(([FLOWS[flow](t)], v[:-1]))
        return np.concatenate((f - np.append(f[1:], 0.0), before - v))

    start = np.zeros(2 * n)
    run = solve_ivp(rates, (0.0, until), start, "DOP853", rtol=1e-10, atol=1e-12, max_step=2e-3)
    return np.asarray(run.y[:n, -1], dtype=float)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", ["rk45", "radau", "auto"])
@pytest.mark.parametrize(
    ("flow", "laws"),
    [
        ("time", [PLAY, "400*max(q - 0.05, 0)"]),
        ("5*cos(6*time)", [PLAY, PLAY]),
        ("sin(3*time)", ["400*q^3", PLAY]),
        ("sin(3*time)", [HARD, "400*max(q - 0.05, 0)", HARD]),
        ("time", [PLAY, PLAY, PLAY]),
    ],
)
def test_masses_behind_play_begin_to_move(flow: str, laws: list[str], solver: str) -> None:
    run = hb.simulate(chain(flow, laws), 0.7, solver=solver, rtol=1e-8)
    speeds = [run[f"v{k}.f"].at(0.7) for k in range(len(laws))]
    np.testing.assert_allclose(speeds, meant(flow, laws, 0.7), rtol=1e-5, atol=1e-7)
    assert run.audit().holds()


@pytest.mark.sampled(2)
@pytest.mark.parametrize("solver", ["rk45", "radau", "auto"])
def test_a_chain_that_a_source_sets_off_by_a_jump_moves(solver: str) -> None:
    """All momentum is what the first spring has given, whose force jumps by 32 N at 0.1 m."""
    laws = ["400*q*(if q > 0.1 then 1 else 0.2)", HARD, "3e3*max(q - 0.1, 0)^1.5"]
    m = chain("0.5*floor(time/0.2)", laws)
    run = hb.simulate(m, 0.6, solver=solver, rtol=1e-8)
    moved = sum(run[f"m{k}.p"].at(0.6) for k in range(3))
    times = np.linspace(0.0, 0.6, 600001)
    given = np.trapezoid(run["k0.e"].at(times.tolist()), times)
    assert moved == pytest.approx(given, rel=1e-6, abs=32.0 * 1e-6)
    assert run["m0.p"].at(0.199) == 0.0
