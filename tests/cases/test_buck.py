"""Buck converter at 600 kHz with its compensator: all 180 periods of the published profile.

The reference is derived a second time, by Kirchhoff's laws: between switchings the circuit is
linear and driven by ramps, so that a matrix exponential takes it exactly, and bisection finds the
instants. It shares nothing with the tool. It is well conditioned: an error of the start grows by
no more than a thousand, so that all switchings can be compared one by one.
"""

from itertools import pairwise

import numpy as np
import pytest
from scipy.linalg import expm

VI, VREF, L, C, LOAD = 3.0, 1.8, 10e-6, 22e-6, 10.0
R11, R12, R21, C11, C21 = 15.58e3, 227.8e3, 5.613e6, 20e-12, 1.9e-12
T, RISE, FALL = 1.0 / 600e3, 1.655e-6, 10e-9
GAIN, WIDTH, DEAD, DROP, START = 1e4, 30e6, 0.06, 0.8, 1e-4
PERIODS = 180
RAMP = ((RISE, 0.75 * VI / RISE, 128), (FALL, -0.75 * VI / FALL, 8), (T - RISE - FALL, 0.0, 2))
"""Parts of a period: how long, how fast the ramp goes, how many steps."""
RTOLS = (1e-6, 1e-8)
DIODES = ("body.f", "upper.f")
I, OUT, V11, V21, U, SAW, REF, ONE = range(8)


def generator(at, slope, climb):
    """Return A of z' = A z, with `at` volts at the switch end of the coil; None if it is open."""
    unit = np.eye(8)
    # the node `minus` takes what comes from the output and gives it to R21 and C21:
    # (out - m)/R12 + (out - m - v11)/R11 = (m - u - v21)/R21
    m = unit[OUT] / R12 + (unit[OUT] - unit[V11]) / R11 + (unit[U] + unit[V21]) / R21
    m /= 1 / R12 + 1 / R11 + 1 / R21
    forward, backward = (unit[OUT] - m - unit[V11]) / R11, (m - unit[U] - unit[V21]) / R21
    drawn = (unit[OUT] - m) / R12 + forward
    a = np.zeros((8, 8))
    if at is not None:
        a[I] = (at * unit[ONE] - unit[OUT]) / L
    a[OUT] = (unit[I] - unit[OUT] / LOAD - drawn) / C
    a[V11], a[V21] = forward / C11, backward / C21
    a[U] = 2 * np.pi * WIDTH * (unit[REF] - m - unit[U] / GAIN)
    a[SAW, ONE], a[REF, ONE] = slope, climb
    return a


def volts(leg, flows):
    """Return the voltage at the switch: with both switches off, the body diode that conducts."""
    if leg == "off":
        return {1: -DROP, 0: None, -1: VI + DROP}[flows]
    return {"high": VI, "low": 0.0}[leg]


def exits(leg, flows):
    """Return ``(f, next)``: the leg goes to `next`, or the diode blocks (None), once f(z) > 0."""
    found = {
        "high": [(lambda z: DEAD / 2 - (z[U] - z[SAW]), "off")],
        "low": [(lambda z: z[U] - z[SAW] + DEAD / 2, "off")],
        "off": [
            (lambda z: z[U] - z[SAW] - DEAD / 2, "high"),
            (lambda z: -DEAD / 2 - (z[U] - z[SAW]), "low"),
        ],
    }[leg]
    return [*found, (lambda z: -flows * z[I], None)] if leg == "off" and flows else found


def exact(periods, off_by=0.0):
    """Return ``(t, leg)`` of the switchings, and the state at the end of each period."""
    z = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
    z[[OUT, U]] = off_by
    leg, flows, steps, switched, states = "off", 0, {}, [], []

    def after(h, *key):
        if (h, key) not in steps:
            steps[h, key] = expm(generator(*key) * h)
        return steps[h, key]

    for n in range(periods):
        climb = VREF / START * (n < 60) - VREF / START * (n >= 120)
        begin, z[SAW] = n * T, 0.0
        for length, slope, many in RAMP:
            h, since = length / many, 0.0
            while since < length * (1 - 1e-12):
                key = volts(leg, flows), slope, climb
                dt = h * (np.floor(since / h + 1e-9) + 1) - since
                there = (after(h, *key) if dt > h * (1 - 1e-9) else expm(generator(*key) * dt)) @ z
                hits = [
                    (moment(f, z, generator(*key), dt), to)
                    for f, to in exits(leg, flows)
                    if f(there) > 0.0
                ]
                if not hits:
                    z, since = there, since + dt
                    continue
                dt, to = min(hits, key=lambda hit: hit[0])
                z, since = expm(generator(*key) * dt) @ z, since + dt
                if to is None:
                    z[I], flows = 0.0, 0
                    continue
                leg = to
                flows = int(np.sign(z[I])) if leg == "off" and abs(z[I]) > 1e-9 else 0
                switched.append((begin + since, leg))
            begin += length
        states.append(z[:5].copy())
    return switched, np.array(states)


def moment(f, z, a, h):
    """Return the first instant after which ``f > 0``, by bisection."""
    low, high = 0.0, h
    for _ in range(45):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if f(expm(a * middle) @ z) > 0.0 else (middle, high)
    return high


@pytest.fixture(scope="module")
def reference():
    return exact(PERIODS)


@pytest.fixture(scope="module")
def run(simulate):
    return simulate("buck", until=PERIODS * T, rtol=1e-8)


def legs(run):
    found = [(0.0, "off")]
    for event in run.events:
        leg = run.graph.mode_names(event.steps[-1].mode)["leg"]
        if leg != found[-1][1]:  # else a body diode alone
            found.append((event.t, leg))
    return found[1:]


def latest(found, switched):
    """Largest difference of the instants, in periods, after the same sequence."""
    assert [leg for _, leg in found] == [leg for _, leg in switched]
    return max(abs(a - b) for (a, _), (b, _) in zip(found, switched, strict=True)) / T


@pytest.mark.slow
def test_reference_is_well_conditioned(reference):
    assert latest(exact(PERIODS, off_by=1e-10)[0], reference[0]) < 1e-6


@pytest.mark.slow
def test_every_switching(run, reference):
    switched, states = reference
    assert len(switched) == 467
    assert latest(legs(run), switched) < 1e-6
    names = ("L.f", "out.e", "C11.e", "C21.e", "u")
    sizes = np.abs(states).max(axis=0)
    t = [(n + 1) * T for n in range(PERIODS - 1)]
    found = np.column_stack([run[s].at(t) for s in names])
    assert (np.abs(found - states[:-1]) / sizes).max() < 1e-6


@pytest.mark.slow
def test_switchings_converge_with_the_tolerance(reference, simulate):
    """A hundredth of the tolerance: at most a thirtieth of the error."""
    until = 40 * T
    switched = [s for s in reference[0] if s[0] < until]
    coarse, fine = (latest(legs(simulate("buck", until=until, rtol=r)), switched) for r in RTOLS)
    assert fine < coarse / 30.0 < 1e-5


def test_it_regulates(run):
    """The output follows the reference: with it up, at rest, and on its way down."""
    for n, least in ((50, 1.45), (90, 1.75), (119, 1.79)):
        assert least < float(run["out.e"].at(n * T)) < 1.85


@pytest.mark.slow
def test_body_diodes_carry_the_current_in_the_dead_time(run):
    """Each takes its own direction, and no current is ever cut: no energy is lost at an event."""
    found = legs(run)
    dead = [0.5 * (a + b) for (a, leg), (b, _) in pairwise(found) if leg == "off"]
    i, body, upper = (np.asarray(run[s].at(dead)) for s in ("L.f", *DIODES))
    assert body == pytest.approx(np.maximum(i, 0.0), rel=1e-9, abs=1e-12)
    assert upper == pytest.approx(np.maximum(-i, 0.0), rel=1e-9, abs=1e-12)
    assert (i > 1e-3).sum() > 50
    assert (i < -1e-3).sum() > 50
    lost = sum(s.energy.lost for e in run.events for s in e.steps if s.energy is not None)
    assert abs(lost) < 1e-9 * 0.5 * L * np.abs(i).max() ** 2
