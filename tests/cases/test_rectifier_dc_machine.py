"""Six-pulse rectifier and DC machine: the ideal mean voltage, and the motion by quadrature."""

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

V_LL, R, L, K, J, FAN, T = 40.0, 0.5, 2e-3, 0.3, 0.02, 0.005, 0.02


def rectified(t):
    """The largest of the six voltages between two phases."""
    phases = 2 * np.pi * t / T - np.pi / 3 * np.arange(3)[:, None]
    return V_LL * math.sqrt(2) * np.abs(np.cos(phases)).max(axis=0)


@pytest.fixture(scope="module")
def run(simulate):
    return simulate("rectifier_dc_machine", rtol=1e-9)


def test_the_current_goes_over_six_times_in_a_period(run):
    found = [e.t for e in run.events if e.t > 0]
    assert found == pytest.approx(T / 12 + T / 6 * np.arange(60), rel=1e-9)


def test_the_mean_voltage_is_that_of_an_ideal_bridge(run):
    t = np.linspace(0.1, 0.1 + T, 6 * 200 + 1)
    v = run["voltage"].at(t)
    assert v == pytest.approx(rectified(t), rel=1e-9)
    mean = np.trapezoid(v, t) / T
    assert mean == pytest.approx(3 * math.sqrt(2) / math.pi * V_LL, rel=1e-5)


def test_the_machine_speeds_up_as_its_two_equations_say(run):
    def field(t, z):
        i, w = z
        v = float(rectified(np.array([t]))[0])
        return [(v - R * i - K * w) / L, (K * i - FAN * w) / J]

    ends = [0.0, *(T / 12 + T / 6 * np.arange(30))]
    z = [0.0, 0.0]
    for a, b in pairwise(ends):
        z = solve_ivp(field, (a, b), z, method="DOP853", rtol=1e-11, atol=1e-11).y[:, -1]
    assert run["i.f"].at(ends[-1]) == pytest.approx(z[0], rel=1e-7)
    assert run["w.f"].at(ends[-1]) == pytest.approx(z[1], rel=1e-7)


def test_a_loaded_machine_turns_at_the_speed_of_its_torques(simulate):
    """After many time constants: mean voltage = R*i + k*w with k*i = fan*w."""
    run = simulate("rectifier_dc_machine", parameters={"J": 2e-4}, until=0.16)
    t = np.linspace(0.14, 0.16, 6 * 200 + 1)
    w = np.trapezoid(run["w.f"].at(t), t) / T
    mean = 3 * math.sqrt(2) / math.pi * V_LL
    assert w == pytest.approx(mean / (K + R * FAN / K), rel=1e-4)
