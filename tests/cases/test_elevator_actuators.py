"""Elevator actuators: the computer and the cylinders a second time, sample by sample."""

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

M, K_AIR, B_AIR, A, P_S, P_MAX = 30.0, 1e5, 500.0, 8e-4, 2e7, 2.5e7
R_V, R_B, K, T, T_FAIL = 1.6e11, 3e10, 200.0, 5e-3, 0.3
WANTED = np.array([[0, 0], [0.05, 0], [0.45, 0.02], [0.6, 0.02], [0.9, -0.01], [1.0, -0.01]])


def moved(z, dt, push, resistance):
    """Return position and speed after `dt` with a force and a resistance of the oil, N*s/m."""
    a = np.array([[0, 1, 0], [-K_AIR / M, -(B_AIR + resistance) / M, push / M], [0, 0, 0]])
    return (expm(a * dt) @ [*z, 1.0])[:2]


def flown():
    """Return the state at each sample, and what happened: fault seen, relief closed, changed."""
    z, command, doubts, failed, changed = np.zeros(2), 0.0, 0, False, False
    states, found = [], {}
    for k in range(201):
        t = k * T
        states.append(z)
        spool = command if t < T_FAIL + 1e-9 else 1.0
        wanted = np.interp(t, *WANTED.T)
        # all are set at once from what was there before
        command, doubts, failed, changed = (
            float(np.clip(K * (wanted - z[0]), -1, 1)),
            doubts + 1 if abs(spool - command) > 0.2 else 0,
            doubts > 2 or failed,
            failed,
        )
        spool = command if t < T_FAIL - 1e-9 else 1.0
        valve, orifice = A**2 * R_V, A**2 * R_B
        if not failed:
            z = moved(z, T, A * P_S * spool, valve + orifice)
        elif not changed:
            # both valves of the first cylinder are closed: it stops on its relief valve
            found["closed"], found["speed"], at = t, z[1], z

            def speed(dt, z=at, orifice=orifice):
                return moved(z, dt, -A * P_MAX, orifice)[1]

            stop = brentq(speed, 0.0, 1e-3, xtol=1e-16)
            found["stopped"] = t + stop
            z = np.array([moved(at, stop, -A * P_MAX, orifice)[0], 0.0])
        else:
            found.setdefault("changed", t)
            z = moved(z, T, A * P_S * command, valve + orifice)
    return np.array(states), found


@pytest.fixture(scope="module")
def run(simulate):
    return simulate("elevator_actuators", rtol=1e-10)


@pytest.mark.slow
def test_every_sample_is_that_of_the_second_computation(run):
    states, found = flown()
    t = T * np.arange(len(states))
    # what moves quickly is compared just before the sample
    assert run["position"].at(t) == pytest.approx(states[:, 0], abs=1e-9)
    assert run["rod.f"].at(t[1:], side="left") == pytest.approx(states[1:, 1], abs=1e-7)
    assert found["closed"] == pytest.approx(0.32)
    times = [e.t for e in run.events if e.t > 0]
    assert times == pytest.approx([found["closed"], found["stopped"], found["changed"]], rel=1e-9)


def test_the_closed_mode_is_mythical_and_takes_no_momentum(run):
    """Its impulse of pressure would be what stops the rod; the relief valve opens on it."""
    _, found = flown()
    closing = next(e for e in run.events if e.t > 0)
    assert [s.kind for s in closing.steps] == ["mythical", "continuous"]
    states = [tuple(run.graph.mode_names(s.mode).values()) for s in closing.steps]
    assert states == [("closed", "shut", "passive"), ("closed", "under", "passive")]
    assert closing.steps[0].impulses["p1.e"] == pytest.approx(-M * found["speed"] / A, rel=1e-6)
    assert run["rod.f"].at(0.32) == pytest.approx(found["speed"], rel=1e-6)
    assert run["p1.e"].at(0.3201) == pytest.approx(-P_MAX)
    assert sum(s.energy.lost for s in closing.steps if s.energy and s.kind != "mythical") == 0.0


def test_the_second_cylinder_brings_the_elevator_where_it_is_wanted(run):
    """At rest the spool holds the air: K*(wanted - x)*A*p_s = k_air*x."""
    stiff = K * A * P_S
    for t, wanted in ((0.6, 0.02), (1.0, -0.01)):
        assert run["position"].at(t) == pytest.approx(wanted * stiff / (stiff + K_AIR), rel=2e-2)
    drive = run["position"].at(np.linspace(0, 1, 401))
    assert drive.max() < 0.021
