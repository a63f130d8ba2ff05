"""Implicit steps of so many states that slopes are found together and factors are sparse."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

MANY = 60


def rod(start: list[float], *, radiates: bool = False, back: bool = False) -> hb.Model:
    """Return a rod of parts with insulated ends, which may radiate to 300 K."""
    m, parts = hb.Model("rod"), len(start)
    for i, level in enumerate(start):
        m.add({f"c{i}": hb.C(1.0 / parts, e=level), f"n{i}": hb.Zero()})
        m.bond(f"n{i} -> c{i}")
        if radiates:
            m.add({f"a{i}": hb.R({"f": f"5.67e-8/{parts}*(e^4 - 300^4)"})})
            m.bond(f"n{i} -> a{i}")
    for i in range(1, parts):
        m.add({f"j{i}": hb.One(), f"r{i}": hb.R(1.0 / parts)})
        m.bond(f"n{i - 1} -> j{i} -> n{i}", f"r{i} -> j{i}" if back else f"j{i} -> r{i}")
    return m


@pytest.mark.parametrize("back", [False, True])
def test_a_mode_of_a_rod_decays(back: bool) -> None:
    """As ``exp(-4 n^2 sin(pi k/(2 n))^2 t)``, a cosine of k half waves; what there is stays."""
    waves = 3
    shape = [math.cos(math.pi * waves * (i + 0.5) / MANY) for i in range(MANY)]
    run = hb.simulate(rod([2.0 + a for a in shape], back=back), until=0.03, solver="radau")
    left = math.exp(-4.0 * MANY**2 * math.sin(math.pi * waves / (2.0 * MANY)) ** 2 * 0.03)
    found = np.array([run[f"c{i}.e"].at(0.03) for i in range(MANY)])
    assert found - 2.0 == pytest.approx(left * np.array(shape), abs=1e-7)
    assert found.mean() == pytest.approx(2.0, rel=1e-12)


def test_more_parts_than_modes_are_propagated_for() -> None:
    """Explicit steps would be 7,000: ``auto`` sees that, however many states there are."""
    parts = 440
    shape = [math.cos(math.pi * (i + 0.5) / parts) for i in range(parts)]
    run = hb.simulate(rod([2.0 + a for a in shape]), until=0.03)
    left = math.exp(-4.0 * parts**2 * math.sin(math.pi / (2.0 * parts)) ** 2 * 0.03)
    found = np.array([run[f"c{i}.e"].at(0.03) for i in range(parts)])
    assert found - 2.0 == pytest.approx(left * np.array(shape), abs=1e-6)
    assert run.stats["steps"] < 1000
    assert "stiff: radau from" in run.method


@pytest.mark.sampled(1)
@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.slow
def test_a_rod_that_radiates(solver: str) -> None:
    """Beside another tool, which has the equations of the rod as finite volumes."""
    start = [300.0 + 600.0 * (i < MANY // 4) for i in range(MANY)]

    def rates(_: float, t: np.ndarray) -> np.ndarray:
        flows = np.concatenate(([0.0], MANY * (t[:-1] - t[1:]), [0.0]))
        return MANY * (flows[:-1] - flows[1:]) - 5.67e-8 * (t**4 - 300.0**4)

    known = solve_ivp(rates, (0.0, 0.5), start, method="LSODA", rtol=1e-10, atol=1e-8).y[:, -1]
    run = hb.simulate(rod(start, radiates=True), until=0.5, solver=solver)
    found = np.array([run[f"c{i}.e"].at(0.5) for i in range(MANY)])
    assert found == pytest.approx(known, rel=1e-7)
    assert run.stats["evaluations"] < 30_000
