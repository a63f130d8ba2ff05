"""Buck converter at 600 kHz with its compensator, against a second derivation of its equations."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

VI, VREF, L, C, LOAD = 3.0, 1.8, 10e-6, 22e-6, 10.0
R11, R12, R21, C11, C21 = 15.58e3, 227.8e3, 5.613e6, 20e-12, 1.9e-12
T, RISE, FALL = 1.0 / 600e3, 1.655e-6, 10e-9
GAIN, WIDTH, DEAD, DROP = 1e4, 30e6, 0.06, 0.8


def ramp(t):
    since = np.mod(t, T)
    return 0.75 * VI * (np.minimum(since, RISE) / RISE - np.clip(since - RISE, 0.0, FALL) / FALL)


def by_nodes(leg: str, conducts: bool):
    """Currents and voltages by Kirchhoff, x = (i of L, out, v of C11, v of C21, u)."""

    def rates(t, x):
        i, out, v11, v21, u = x
        # the node `minus` takes what comes from the output and gives it to R21 and C21:
        # (out - m)/R12 + (out - m - v11)/R11 = (m - u - v21)/R21
        m = (out / R12 + (out - v11) / R11 + (u + v21) / R21) / (1 / R12 + 1 / R11 + 1 / R21)
        forward, backward = (out - m - v11) / R11, (m - u - v21) / R21
        drawn = (out - m) / R12 + forward
        if leg == "off" and not conducts:
            di = 0.0
        else:
            at = {"high": VI, "low": 0.0, "off": -DROP}[leg]
            di = (at - out) / L
        reference = VREF * min(t / 1e-4, 1.0)
        du = 2 * np.pi * WIDTH * (reference - m - u / GAIN)
        return [di, (i - out / LOAD - drawn) / C, forward / C11, backward / C21, du]

    return rates


def reference(until: float):
    """Times at which the leg switches, and the state at the end, with tight tolerances."""
    t, x, leg, conducts, switched = 0.0, np.zeros(5), "off", False, []
    while t < until:
        corner = min(
            k * T + part
            for k in range(int(t / T), int(t / T) + 2)
            for part in (0.0, RISE)
            if k * T + part > t * (1 + 1e-12) + 1e-18
        )
        falls = {"high": [DEAD / 2], "low": [], "off": [-DEAD / 2]}[leg]
        rises = {"high": [], "low": [-DEAD / 2], "off": [DEAD / 2]}[leg]
        events = []
        for level, way in [(a, -1.0) for a in falls] + [(a, 1.0) for a in rises]:

            def crosses(t, x, level=level):
                return x[4] - ramp(t) - level

            crosses.terminal, crosses.direction = True, way
            events.append(crosses)
        if leg == "off" and conducts:

            def empty(t, x):
                return x[0]

            empty.terminal, empty.direction = True, -1.0
            events.append(empty)
        end = min(corner, until)
        run = solve_ivp(
            by_nodes(leg, conducts),
            (t, end),
            x,
            method="LSODA",
            rtol=1e-10,
            atol=1e-13,
            events=events,
            max_step=T / 50,
        )
        t, x = float(run.t[-1]), run.y[:, -1]
        if run.status != 1:
            continue
        which = next(k for k, found in enumerate(run.t_events) if len(found))
        if leg == "off" and conducts and which == len(events) - 1:
            conducts, x[0] = False, 0.0
            continue
        s = x[4] - ramp(t)
        leg = "off" if leg != "off" else ("high" if s > 0.0 else "low")
        conducts = leg == "off" and x[0] > 1e-12
        switched.append((t, leg))
    return switched, x


def test_first_periods(simulate):
    until = 16 * T
    run = simulate("buck", until=until, rtol=1e-9)
    switched, x = reference(until)
    legs = [(0.0, "off")]
    for event in run.events:
        leg = run.graph.mode_names(event.steps[-1].mode)["leg"]
        if leg != legs[-1][1]:  # else the body diode alone
            legs.append((event.t, leg))
    assert [leg for _, leg in legs[1:]] == [leg for _, leg in switched]
    assert [t for t, _ in legs[1:]] == pytest.approx([t for t, _ in switched], rel=1e-5)
    assert len(switched) == 9
    state = [run[s].at(until) for s in ("L.f", "out.e", "C11.e", "C21.e", "u")]
    assert state == pytest.approx(x, rel=1e-4, abs=1e-6)


def test_body_diode_carries_the_current_in_the_dead_time(simulate):
    run = simulate("buck")
    found = run.sample(np.linspace(0.0, 1e-5, 4001).tolist(), ["body.f", "body.e", "L.f"])
    assert found["body.f"].min() >= -1e-9
    assert found["body.e"].max() <= 1e-9
    on = found["body.f"] > 0.0
    assert on.any()
    assert found["body.f"][on] == pytest.approx(found["L.f"][on], rel=1e-9)
