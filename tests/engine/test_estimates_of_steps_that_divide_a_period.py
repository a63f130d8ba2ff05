"""Steps of which a period is a multiple: each event of a source falls to the same place in one.

A run with twice the step then had its events at the same instants for half of all lengths, and the
estimate of the error was a hundredth of it. The current of a phase-controlled switch with a coil
has a closed form.
"""

import numpy as np
import pytest

import hybond as hb

W, PEAK, R, LAG, ANGLE = 100 * np.pi, 100.0, 1.0, 0.587, 2.0
L = R * np.tan(LAG) / W
PERIOD = 2 * np.pi / W
TIMES = np.linspace(0.0, 4.9 * PERIOD, 400)


def switch():
    m = hb.Model("phase control", domain="electrical")
    m.add(V=hb.Se(f"{PEAK}*sin({W}*time)"), L=hb.I(L), R=hb.R(R))
    angle = f"mod({W}*time, {2 * np.pi})"
    m.add(i=hb.One(law="thyristor", gate=f"{angle} > {ANGLE} and {angle} < {ANGLE + 0.5}"))
    m.bond("V -> i -> L", "i -> R")
    return m


def currents():
    """The current of each half wave, until it is zero."""

    def one(angle):
        size = PEAK / np.hypot(R, W * L)
        free = np.exp(-(angle - ANGLE) / np.tan(LAG)) * np.sin(ANGLE - LAG)
        return np.where(angle > ANGLE, size * np.maximum(np.sin(angle - LAG) - free, 0.0), 0.0)

    angles = np.mod(W * TIMES, 2 * np.pi)
    return np.where(angles < ANGLE + 2.5, one(angles), 0.0)


@pytest.mark.parametrize("steps", [600, 800, 1000, 1200, 1500, 1600, 2000, 2001])
def test_the_estimate_is_of_the_size_of_the_error(steps):
    run = hb.simulate(switch(), until=5 * PERIOD, solver="moreau-jean", step=PERIOD / steps)
    exact = currents()
    error = np.abs(run["L.f"].at(TIMES) - exact).mean() / exact.max()
    assert 0.25 * error < run.stats["step_error"] < max(10 * error, 4 / steps)
    assert run.audit().holds()


def test_located_events_have_the_closed_form():
    run = hb.simulate(switch(), until=5 * PERIOD)
    assert run["L.f"].at(TIMES) == pytest.approx(currents(), abs=1e-5)


SEPIC = """
hybond = 1
domain = "electrical"
[elements]
V = {{ Se = "20 V" }}
i1 = {{ junction = 1 }}
L1 = {{ I = "20 uH" }}
a = {{ junction = 0 }}
s = {{ junction = 1 }}
rs = {{ R = "20 mohm" }}
i2 = {{ junction = 1 }}
C1 = {{ C = "10 uF" }}
b = {{ junction = 0 }}
L2 = {{ I = "20 uH" }}
d = {{ junction = 1, law = "diode" }}
rd = {{ R = "30 mohm" }}
o = {{ junction = 0 }}
C2 = {{ C = "50 uF" }}
R = {{ R = "50 ohm" }}
beside = {{ junction = 1 }}
leak = {{ {large} }}
[graph]
bonds = [
    "V -> i1 -> L1", "i1 -> a -> s -> rs", "a -> i2 -> C1", "i2 -> b", "b -> L2",
    "b -> d -> o -> C2", "d -> rd", "o -> R", "b -> beside -> o", "beside -> leak",
]
[inputs]
g = {{ pwm = {{ period = "20 us", duty = 0.3 }} }}
[machines.sw]
states = {{ off = [], on = ["s"] }}
start = "off"
rules = ["off -> on when g > 0.5", "on -> off when g < 0.5"]
"""


@pytest.mark.parametrize(
    "large", ['R = "1 kohm"', 'R = "100 kohm"', 'R = "10 Mohm"', 'G = "100 nS"']
)
def test_what_is_across_a_large_resistor_is_rounding_of_two_currents(large):
    """A converter whose diode blocks: beside it two coil currents cancel, but for rounding."""
    m = hb.loads(SEPIC.format(large=large))
    run = hb.simulate(m, until="400 us", solver="moreau-jean", step="50 ns")
    located = hb.simulate(m, until="400 us")
    found = run.audit()
    assert found.holds(), found
    out = [r["C2.e"].at(4e-4) for r in (run, located)]
    assert out[0] == pytest.approx(out[1], rel=2e-2)


def test_a_large_resistor_and_a_large_current_elsewhere_hide_no_imbalance():
    """An effort that is off by 1e-7 is found, whatever flows in a loop that nothing joins to it."""
    m = hb.Model("rectifier", domain="electrical")
    m.add(V=hb.Se("10*sin(50*time)"), i=hb.One(law="diode"), n=hb.Zero(), c=hb.C(1e-3))
    m.add(load=hb.R(100.0), leak=hb.R(1e4), B=hb.Se(1e-3), j=hb.One(), r=hb.R(1e-6), l=hb.I(1e-8))
    m.bond("V -> i -> n", "n -> c", "n -> load", "n -> leak", "B -> j -> r", "j -> l")
    run = hb.simulate(m, until=0.5, solver="moreau-jean", step=1e-4)
    assert run["r.f"].at(0.5) == pytest.approx(1e3, rel=1e-6)
    assert run.audit().holds()
    (load,) = [node.ends[0].bond for node in run.graph.nodes if node.path == "load"]
    for segment in run.trace.segments:
        segment.bonds[:, load] *= 1 + 1e-7
    assert not run.audit().holds()
