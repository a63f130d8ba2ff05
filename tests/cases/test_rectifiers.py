"""Rectifiers of ideal diodes and thyristors against closed forms."""

import math

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq

import hybond as hb

FREQ = 50.0
W = 2.0 * math.pi * FREQ
PERIOD = 1.0 / FREQ


class TestHalfWave:
    """10 V, 100 uF, 1 kohm, no resistance in the source."""

    V, RC = 10.0, 0.1
    ENDS = (math.pi - math.atan(W * 0.1)) / W  # where the capacitor would be slower than the sine

    def exact(self, t: float) -> float:
        cycle, since = divmod(t - self.ENDS, PERIOD)
        decay = self.V * math.sin(W * self.ENDS) * math.exp(-since / self.RC)
        sine = self.V * math.sin(W * t)
        if cycle < 0:
            return sine
        return max(decay, sine) if since > 0.5 * PERIOD else decay

    def test_follows_the_source_or_decays(self, simulate, solver):
        run = simulate("half_wave_rectifier", solver=solver)
        t = np.linspace(0.0, 0.1, 301)
        want = [self.exact(a) for a in t]
        assert run["out.e"].at(t.tolist()) == pytest.approx(want, abs=1e-5)

    def test_switches_where_current_or_voltage_is_zero(self, simulate):
        run = simulate("half_wave_rectifier")
        begins = brentq(
            lambda t: (
                self.V * math.sin(W * t)
                - self.V * math.sin(W * self.ENDS) * math.exp(-(t - self.ENDS) / self.RC)
            ),
            PERIOD,
            1.25 * PERIOD,
        )
        want = [self.ENDS + k * PERIOD for k in range(5)]
        want += [begins + k * PERIOD for k in range(4)]
        assert [e.t for e in run.events[1:]] == pytest.approx(sorted(want), rel=1e-6)

    def test_never_overshoots(self, simulate):
        run = simulate("half_wave_rectifier", parameters={"freq": 50}, until="60 ms", rtol=1e-4)
        found = run.sample(np.linspace(0.0, 0.06, 2001).tolist(), ["out.e", "d.e", "d.f"])
        assert found["out.e"].max() <= self.V
        assert found["d.e"].max() <= 1e-3  # what rtol allows the decay to lag
        assert found["d.f"].min() >= -1e-12


@pytest.mark.parametrize("start", [4.0, 9.999, 10.0, 12.0])
def test_capacitor_that_starts_below_its_source_is_charged_at_once(start):
    m = hb.Model("charge", domain="electrical")
    m.add(V=hb.Se("10 V"), d=hb.One(law="diode"), C=hb.C("1 uF", e=start))
    m.bond("V -> d -> C")
    run = hb.simulate(m, until="1 ms")
    assert run["C.e"].at(0.0) == pytest.approx(max(start, 10.0), rel=1e-14)
    assert run.final["C.e"] == pytest.approx(max(start, 10.0), rel=1e-14)
    written = [s.energy for s in run.events[0].steps if s.kind != "mythical"]
    lack = max(10.0 - start, 0.0)
    assert sum(e.lost for e in written) == pytest.approx(0.5e-6 * lack**2, abs=1e-18)
    assert sum(e.source for e in written) == pytest.approx(10e-6 * lack, abs=1e-18)


def test_capacitor_on_a_sine_keeps_its_peak(solver):
    m = hb.Model("peak", domain="electrical")
    m.add(V=hb.Se(f"10*sin({W}*time)"), d=hb.One(law="diode"), C=hb.C("1 uF", e="-3 V"))
    m.bond("V -> d -> C")
    run = hb.simulate(m, until="0.1 s", solver=solver)
    e = run["C.e"].at(np.linspace(0.0, 0.1, 1001).tolist())
    assert e[0] == 0.0  # three volts in an instant
    assert e.max() <= 10.0
    assert (np.diff(e) >= 0.0).all()
    assert run.final["C.e"] == pytest.approx(10.0, rel=1e-12)


@pytest.mark.sampled(1)
def test_capacitor_behind_a_resistor_lags_and_never_overshoots(solver):
    m = hb.Model("lag", domain="electrical")
    m.add(V=hb.Se(f"10*sin({W}*time)"), d=hb.One(law="diode"), C=hb.C("20 uF"))
    m.add(R=hb.R("100 ohm"))
    m.bond("V -> d -> C", "d -> R")
    run = hb.simulate(m, until="50 ms", solver=solver)
    reference = solve_ivp(
        lambda t, e: np.maximum(10.0 * math.sin(W * t) - e, 0.0) / 2e-3,
        (0.0, 0.05),
        [0.0],
        max_step=2e-5,
        rtol=1e-9,
        atol=1e-10,
        dense_output=True,
    )
    t = np.linspace(0.0, 0.05, 501)
    e = run["C.e"].at(t.tolist())
    assert e == pytest.approx(reference.sol(t)[0], abs=1e-5)
    assert e.max() < 10.0
    assert np.diff(e).min() >= -1e-12


class TestThyristors:
    """100 V into 10 ohm and 100 mH: the phase of the load is 72.3 degrees."""

    V, R, L = 100.0, 10.0, 0.1
    Z = math.hypot(R, W * L)
    PHI = math.atan2(W * L, R)

    @pytest.mark.sampled(1)
    @pytest.mark.parametrize("alpha", [math.radians(20), math.radians(60), math.radians(70)])
    def test_mean_voltage_in_continuous_conduction(self, alpha, simulate):
        run = simulate("thyristor_rectifier", parameters={"alpha": alpha})
        fired = alpha / W
        total = run["voltage"].at([fired + k * PERIOD / 2 for k in range(9)])
        mean = np.diff(total) / (PERIOD / 2)
        assert mean == pytest.approx(2.0 * self.V / math.pi * math.cos(alpha), rel=1e-6)

    @pytest.mark.sampled(1)
    @pytest.mark.parametrize("alpha", [math.radians(100), math.radians(150)])
    def test_pulses_of_current_in_discontinuous_conduction(self, alpha, simulate, solver):
        run = simulate("thyristor_rectifier", parameters={"alpha": alpha}, solver=solver)

        def current(angle):
            decay = math.exp(-(angle - alpha) / math.tan(self.PHI))
            ahead = math.sin(alpha - self.PHI) * decay
            return self.V / self.Z * (math.sin(angle - self.PHI) - ahead)

        end = brentq(current, alpha + 0.05, alpha + math.pi)
        assert end < alpha + math.pi
        for half in range(9):
            for angle in np.linspace(alpha + 1e-9, alpha + math.pi - 1e-9, 23):
                want = current(angle) if angle < end else 0.0
                t = (angle + half * math.pi) / W
                assert run["L.f"].at(t) == pytest.approx(want, rel=1e-5, abs=1e-6)
        want = quad(lambda a: self.V * math.sin(a), alpha, end)[0] / math.pi
        total = run["voltage"].at([alpha / W, alpha / W + 4 * PERIOD])
        assert (total[1] - total[0]) / (4 * PERIOD) == pytest.approx(want, rel=1e-6)

    @pytest.mark.parametrize("alpha", [math.radians(30), math.radians(60)])
    def test_a_short_pulse_at_the_gate_is_enough(self, alpha):
        m = hb.Model("half_controlled", domain="electrical")
        m.add(
            V=hb.Se(f"100*sin({W}*time)"),
            t=hb.One(law="thyristor", gate="g > 0.5"),
            n=hb.Zero(),
            free=hb.One(law="diode"),
            load=hb.One(),
            L=hb.I(self.L),
            R=hb.R(self.R),
        )
        m.input(g=hb.Input(pwm={"period": PERIOD, "duty": 0.01, "phase": alpha / W}))
        m.bond("V -> t -> n", "free -> n", "n -> load -> L", "load -> R")
        m.signal(voltage=hb.Integral("n.e"))
        run = hb.simulate(m, until="0.1 s")
        # the coil frees itself through the diode, so that the thyristor ends with the half wave
        ends = [e.t for e in run.events if run.graph.mode_names(e.steps[-1].mode)["t"] == "blocks"]
        total = run["voltage"].at([k * PERIOD for k in range(6)])
        mean = 100.0 * (1.0 + math.cos(alpha)) / (2.0 * math.pi)
        assert np.diff(total) / PERIOD == pytest.approx(mean, rel=1e-6)
        assert any(t == pytest.approx(PERIOD / 2, rel=1e-9) for t in ends)

    def test_without_a_gate_nothing_flows(self):
        m = hb.Model("never", domain="electrical")
        m.add(V=hb.Se(f"100*sin({W}*time)"), t=hb.One(law="thyristor", gate="time > 1"))
        m.add(R=hb.R("10 ohm"), L=hb.I("1 mH"))
        m.bond("V -> t -> R", "t -> L")
        run = hb.simulate(m, until="0.05 s")
        assert run["t.f"].y.max() == run["t.f"].y.min() == 0.0
        assert run["t.e"].at(0.005) == pytest.approx(100.0)


def six_pulses(*, line: str | None, load: dict[str, object]) -> hb.Model:
    """Three phases of 100 V, six diodes, and the given elements in series as load."""
    m = hb.Model("six", domain="electrical")
    m.add(plus=hb.Zero(), minus=hb.Zero(), load=hb.One(), **load)
    m.bond("plus -> load -> minus", *[f"load -> {name}" for name in load])
    for k, (phase, start) in enumerate(zip("abc", (10.0, -10.0, 0.0), strict=True)):
        u, i, n = f"u{phase}", f"i{phase}", f"{phase}"
        m.add(**{u: hb.Se(f"100*cos({W}*time - {k}*2*pi/3)"), n: hb.Zero()})
        m.add(**{f"up_{n}": hb.One(law="diode"), f"low_{n}": hb.One(law="diode")})
        if line is None:
            m.bond(f"{u} -> {n}")
        else:
            m.add(**{i: hb.One(), f"L{phase}": hb.I(line, f=start)})
            m.bond(f"{u} -> {i} -> {n}", f"{i} -> L{phase}")
        m.bond(f"{n} -> up_{n} -> plus", f"minus -> low_{n} -> {n}")
    m.signal(voltage=hb.Integral('"plus -> load".e - "load -> minus".e'))
    return m


class TestSixPulses:
    """Three phases of 100 V peak."""

    @pytest.mark.slow
    def test_commutation_takes_the_overlap_angle(self):
        """With a constant current each commutation begins at a multiple of 60 degrees."""
        line, current = 1e-3, 10.0
        m = six_pulses(line="1 mH", load={"I": hb.Sf(f"{current} A")})
        run = hb.simulate(m, until=2 * PERIOD)
        overlap = math.acos(1.0 - 2.0 * W * line * current / (math.sqrt(3.0) * 100.0))
        want = [k * math.pi / 3 + part for k in range(13) for part in (0.0, overlap)][1:]
        want = [angle / W for angle in want if angle < 4 * math.pi - 1e-6]
        # the first commutation and the last begin where the run begins and ends
        times = [e.t for e in run.events if 1e-12 < e.t < 2 * PERIOD * (1 - 1e-9)]
        assert times == pytest.approx(want, rel=1e-6)
        mean = (run["voltage"].at(2 * PERIOD) - run["voltage"].at(PERIOD)) / PERIOD
        drop = 3.0 * W * line * current / math.pi
        assert mean == pytest.approx(3.0 * math.sqrt(3.0) * 100.0 / math.pi - drop, rel=1e-6)

    @pytest.mark.sampled(1)
    def test_without_line_inductance_commutation_is_instant(self, solver):
        R, L = 10.0, 20e-3
        m = six_pulses(line=None, load={"R": hb.R(R), "L": hb.I(L)})
        run = hb.simulate(m, until=2 * PERIOD, solver=solver)
        assert [e.t for e in run.events[1:12]] == pytest.approx(
            [k * PERIOD / 6 for k in range(1, 12)], rel=1e-9
        )
        peak, z, phi = math.sqrt(3.0) * 100.0, math.hypot(R, W * L), math.atan2(W * L, R)
        current = 0.0
        for k in range(12):
            forced = lambda a: peak / z * math.cos(a - math.pi / 6 - phi)  # noqa: E731
            for part in (0.0, 0.3, 0.7, 1.0):
                angle = part * math.pi / 3
                decay = math.exp(-angle / W * R / L)
                want = forced(angle) + (current - forced(0.0)) * decay
                t = (k + part) * PERIOD / 6
                assert run["L.f"].at(t) == pytest.approx(want, rel=1e-6, abs=1e-8)
            current = want

    @pytest.mark.slow
    def test_example_keeps_its_laws(self, simulate):
        run = simulate("six_pulse_rectifier")
        t = np.linspace(0.0, 0.04, 801).tolist()
        for k in range(1, 7):
            found = run.sample(t, [f"d{k}.f", f"d{k}.e"])
            assert found[f"d{k}.f"].min() >= -1e-9
            assert found[f"d{k}.e"].max() <= 1e-6
            assert np.abs(found[f"d{k}.f"] * found[f"d{k}.e"]).max() <= 1e-9
            assert found[f"d{k}.f"].max() > 10.0
        phases = run.sample(t, ["ia.f", "ib.f", "ic.f"])
        assert np.abs(sum(phases.values())).max() <= 1e-12 * 20


FLOATING = """
hybond = 1
domain = "electrical"

[elements]
grid = { Se = "325*cos(2*pi*50*time)" }
line = { junction = 1 }
rs = { R = "0.5 ohm" }
ls = { I = "100 uH" }
a = { junction = 0 }
b = { junction = 0 }
plus = { junction = 0 }
minus = { junction = 0 }
dc = { junction = 1 }
out = { junction = 0 }
c = { C = "470 uF" }
load = { R = "100 ohm" }
gnd = { Se = 0 }
DIODES

[graph]
bonds = ["grid -> line -> rs", "line -> ls", "line -> a", "b -> line", "a -> d1 -> plus",
  "b -> d2 -> plus", "minus -> d3 -> a", "minus -> d4 -> b", "plus -> dc -> out", "dc -> minus",
  "out -> c", "out -> load", "gnd -> minus"]
"""


@pytest.mark.sampled(1)
@pytest.mark.parametrize("order", ["1234", "4321", "2413", "3142"])
def test_a_bridge_that_floats_between_pulses_shares_the_voltage_and_says_so(order: str) -> None:
    # between pulses all four block; the source floats, and the shares of d1 and d4 are no one's
    # business: no diode may be called conducting because it was written first
    diodes = "\n".join(f'd{k} = {{ junction = 1, law = "diode" }}' for k in order)
    run = hb.simulate(hb.loads(FLOATING.replace("DIODES", diodes)), until="30 ms")
    assert [any(e.steps[-1].mode) for e in run.events] == [True, False] * 3 + [True]
    assert any("least leakage decides" in w for w in run.warnings)
    for t in (0.003, 0.005, 0.008, 0.015, 0.022):
        u, grid = run["c.e"].at(t), 325.0 * np.cos(2.0 * np.pi * 50.0 * t)
        shares = [run[f"d{k}.e"].at(t) for k in (1, 2, 3, 4)]
        near, far = 0.5 * (grid - u), 0.5 * (-grid - u)
        assert shares == pytest.approx([near, far, far, near], rel=1e-9)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("rate", [300, 310, 320])
def test_a_bridge_with_resistance_and_inductance_goes_on(rate: int) -> None:
    """Diodes that carry nothing keep the branch they were just given."""
    m = hb.Model("bridge", domain="electrical")
    m.add(V=hb.Se(f"100 V*sin({rate}*time/(1 s))"), ab=hb.One(), a=hb.Zero(), b=hb.Zero())
    m.add(p=hb.Zero(), ls=hb.I("1 mH"), rs=hb.R("0.5 ohm"), c=hb.C("1 mF", q=0), g=hb.G("0.02 S"))
    m.bond("V -> ab", "b -> ab -> a", "ab -> rs", "ab -> ls", "p -> c", "p -> g")
    for k, path in enumerate(("a -> d1 -> p", "b -> d2 -> p", "d3 -> a", "d4 -> b"), 1):
        m.add(**{f"d{k}": hb.One(law="diode"), f"r{k}": hb.R("0.01 ohm")})
        m.bond(path, f"d{k} -> r{k}")
    run = hb.simulate(m, 0.1)
    assert run.status == "ok"
    assert run["c.e"].at(0.1) == pytest.approx(_bridge_by_phases(rate, 0.1), rel=1e-6)


def _bridge_by_phases(rate: float, until: float) -> float:
    """The capacitor's voltage, from blocking and conduction taken by turns."""

    def source(t: float) -> float:
        return 100.0 * math.sin(rate * t)

    def conducts(t: float, y: np.ndarray, way: float) -> list[float]:
        i, v = y
        return [(way * source(t) - 0.52 * i - v) / 1e-3, (i - 0.02 * v) / 1e-3]

    def ends(t: float, y: np.ndarray, way: float) -> float:
        return float(y[0])

    def exceeds(t: float, y: np.ndarray) -> float:
        return abs(source(t)) - float(y[0])

    ends.terminal, ends.direction = True, -1.0
    exceeds.terminal, exceeds.direction = True, 1.0
    options = {"rtol": 1e-10, "atol": 1e-10, "max_step": 1e-4}
    t, v = 0.0, 0.0
    while t < until:
        if t > 0.0:
            wait = solve_ivp(lambda _, y: -20.0 * y, (t, until), [v], events=exceeds, **options)
            t, v = float(wait.t[-1]), float(wait.y[0, -1])
        if t < until:
            way = math.copysign(1.0, source(t)) if t > 0.0 else 1.0
            flow = solve_ivp(conducts, (t, until), [0.0, v], args=(way,), events=ends, **options)
            t, v = float(flow.t[-1]), float(flow.y[1, -1])
    return v


@pytest.mark.parametrize("many", [1, 2, 3])
def test_a_coil_whose_thyristors_are_not_fired_loses_its_current(many):
    """With more than one beside each other it was refused (HB-J111): one has what others leave.

    The flux goes by an impulse of -L i; from 1 ms on the highest source feeds the coil.
    """
    m = hb.Model("half", domain="electrical")
    m.add(p=hb.Zero(), i=hb.One(), L=hb.I("1 mH", f="2 A"), R=hb.R("1 ohm"))
    m.bond("p -> i -> L", "i -> R")
    for k in range(many):
        m.add(**{f"V{k}": hb.Se(10.0 - 20.0 * k)})
        m.add(**{f"t{k}": hb.One(law="thyristor", gate="time > 1 [ms]")})
        m.bond(f"V{k} -> t{k} -> p")
    run = hb.simulate(m, "3 ms")
    assert run.events[0].steps[0].impulses["L.e"] == pytest.approx(-2e-3)
    assert run["L.f"].at(5e-4) == 0.0
    assert run["L.f"].at(3e-3) == pytest.approx(10.0 * (1.0 - math.exp(-2.0)), rel=1e-7)
