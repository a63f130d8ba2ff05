"""A pressure that runs through vessels at one pressure, which orifices join."""

from __future__ import annotations

import functools

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

AS_ROOT = ("f", "0.3*sign(e)*sqrt(abs(e))")
LAWS = [AS_ROOT, ("e", "f*abs(f)/0.09"), ("f", "if e > 0 then 0.3*sqrt(e) else -0.3*sqrt(-e)")]
UNTIL = 5.0


def row(many: int, law: tuple[str, str], *, turned: bool = False, power: float = 1.4) -> hb.Model:
    """Return vessels of pressure ``q^power``, of which the first holds twice what the others do."""
    m = hb.Model("row")
    for k in range(many):
        held = 2.0 if k == 0 else 1.0
        m.add(**{f"c{k}": hb.C({"e": f"q^{power}"}, q=held), f"z{k}": hb.Zero()})
        m.bond(f"z{k} -> c{k}")
    for k in range(1, many):
        m.add(**{f"u{k}": hb.One(), f"r{k}": hb.R({law[0]: law[1]})})
        back = turned and k % 2 == 0
        m.bond(f"z{k} -> u{k} -> z{k - 1}" if back else f"z{k - 1} -> u{k} -> z{k}")
        m.bond(f"u{k} -> r{k}")
    return m


@functools.cache
def by_scipy(many: int, power: float) -> np.ndarray:
    """Return what the vessels hold in the end."""

    def rate(_: float, q: np.ndarray) -> np.ndarray:
        away = -np.diff(np.abs(q) ** power)
        flow = 0.3 * np.sign(away) * np.sqrt(np.abs(away))
        return np.append(0.0, flow) - np.append(flow, 0.0)

    begin = np.append(2.0, np.ones(many - 1))
    found = solve_ivp(rate, (0.0, UNTIL), begin, "Radau", rtol=1e-9, atol=1e-11)
    return np.asarray(found.y[:, -1])


@pytest.mark.sampled(3)
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("many", [14, 6])
def test_a_pressure_runs_through_vessels_that_are_level(
    many: int, law: tuple[str, str], turned: bool
) -> None:
    """Far ahead of it no step can tell which way next to nothing flows."""
    run = hb.simulate(row(many, law, turned=turned), UNTIL, max_steps=400)
    held = np.array([run.final[f"c{k}.q"] for k in range(many)])
    assert held == pytest.approx(by_scipy(many, 1.4), abs=2e-7)
    assert held.sum() == pytest.approx(many + 1.0, rel=1e-12)
    assert run.audit().holds()


@pytest.mark.parametrize("solver", ["auto", "radau", "rk45"])
@pytest.mark.parametrize("power", [1.0, 1.7])
def test_it_does_so_in_vessels_of_other_laws(power: float, solver: str) -> None:
    run = hb.simulate(row(10, AS_ROOT, power=power), UNTIL, solver=solver, max_steps=400)
    held = np.array([run.final[f"c{k}.q"] for k in range(10)])
    assert held == pytest.approx(by_scipy(10, power), abs=1e-6)
