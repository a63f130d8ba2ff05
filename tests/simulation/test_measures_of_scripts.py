"""What is measured of a script: each step with the parameters that it had.

Oracles: SciPy on the same equations, what a coordinate has moved, and the balance of energy with
what it takes to change a loaded spring or a moving mass.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

STEPS = ((0.0, 0.5, 1.0, 1.0, 0.3), (0.5, 1.0, 0.1, 1.0, 2.0), (1.0, 2.0, 1.0, 3.0, 2.0))
"""Begin, end, compliance, mass, damping of each step."""


def rig() -> hb.Model:
    m = hb.Model(
        "rig",
        domain="translational",
        parameters={"c": "1 m/N", "mass": "1 kg", "b": "0.3 N*s/m"},
    )
    m.add(k=hb.C("c", q="1 m"), m=hb.I("mass"), r=hb.R("b"), v=hb.One())
    m.bond("k -> v", "v -> m", "v -> r")
    return m


@pytest.fixture(scope="module")
def run() -> hb.Result:
    steps = [
        hb.Step(until=end, set={"c": f"{c} m/N", "mass": f"{m} kg", "b": f"{b} N*s/m"})
        for _, end, c, m, b in STEPS
    ]
    return hb.run_script(rig(), steps, limit="3 s")


def by_hand() -> tuple[list[np.ndarray], float]:
    """Return coordinate and momentum at the ends of steps, and the energy of the damper."""
    y = np.array([1.0, 0.0, 0.0])
    found = [y]
    for begin, end, c, m, b in STEPS:

        def rates(_: float, y: np.ndarray, c: float = c, m: float = m, b: float = b) -> list[float]:
            v = y[1] / m
            return [-v, y[0] / c - b * v, b * v * v]

        y = solve_ivp(rates, (begin, end), y, rtol=1e-11, atol=1e-12).y[:, -1]
        found.append(y)
    return found, float(y[2])


def test_means_and_integrals_are_those_of_each_step(run: hb.Result) -> None:
    states, heat = by_hand()
    way = -(states[-1][0] - states[0][0])
    assert float(run["m.f"].integral()) == pytest.approx(way, rel=1e-8)
    assert float(run["m.f"].mean()) == pytest.approx(way / 2, rel=1e-8)
    assert float(run["b*m.f^2"].integral()) == pytest.approx(heat, rel=1e-8)
    assert run.measure("integral(b*m.f^2)") == pytest.approx(heat, rel=1e-8)
    momentum = states[-1][1]
    assert float(run["m.e"].integral()) == pytest.approx(momentum, rel=1e-8)
    top = run["m.p/mass"].max(start=0.2, end=0.9)
    sampled = run["m.f"].at(np.linspace(0.2, 0.9, 7001))
    assert float(top) == pytest.approx(sampled.max(), rel=1e-6) and float(top) >= sampled.max()


def test_what_is_set_is_a_row_and_all_adds_up(run: hb.Result) -> None:
    states, heat = by_hand()
    given = 0.0
    for (q, p, _), before, after in zip(states[1:], STEPS, STEPS[1:], strict=False):
        given += 0.5 * q * q * (1 / after[2] - 1 / before[2])
        given += 0.5 * p * p * (1 / after[3] - 1 / before[3])
    found = run.losses()
    assert found["(set)"].supplied == pytest.approx(given, rel=1e-7)
    assert found["r"].dissipated == pytest.approx(heat, rel=1e-8)
    q, p, _ = states[-1]
    assert found["k"].stored == pytest.approx(0.5 * q * q / STEPS[-1][2] - 0.5, rel=1e-7)
    assert found["m"].stored == pytest.approx(0.5 * p * p / STEPS[-1][3], rel=1e-7)
    assert found.holds()


def test_windows_of_a_script_add_up(run: hb.Result) -> None:
    whole = run.losses()
    edges = (0.0, 0.3, 0.5, 1.0, 1.7, 2.0)
    parts = [run.losses(start=a, end=b) for a, b in pairwise(edges)]
    assert all(part.holds() for part in parts)
    for column in ("supplied", "dissipated", "lost", "stored"):
        total = sum(getattr(part, column) for part in parts)
        assert total == pytest.approx(getattr(whole, column), rel=1e-9, abs=1e-12)


def test_a_step_that_sets_nothing_gives_nothing() -> None:
    run = hb.run_script(rig(), [hb.Step(until="1 s"), hb.Step(until="2 s")], limit="2 s")
    whole = hb.simulate(rig(), "2 s").losses()
    found = run.losses()
    assert "(set)" not in [row.name for row in found]
    assert found["r"].dissipated == pytest.approx(whole["r"].dissipated, rel=1e-9)


def test_an_impulse_is_measured_with_the_parameter_of_its_step() -> None:
    m = hb.Model("hits", domain="translational", parameters={"scale": 1.0, "u": "1 m/s"})
    m.add(s=hb.Sf("u"), m=hb.I("2 kg"), v=hb.One())
    m.bond("s -> v -> m")
    script = [hb.Step(until="1 s"), hb.Step(until="2 s", set={"scale": 5.0, "u": "4 m/s"})]
    run = hb.run_script(m, script, limit="2 s")
    # at 0 s 2 N*s, at 1 s 6 N*s
    assert float(run["scale*s.e"].integral()) == pytest.approx(1.0 * 2.0 + 5.0 * 6.0, rel=1e-9)
