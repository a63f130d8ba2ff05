"""Guards that become true because what they read jumps, in periodic motions and derivatives.

A sawtooth begins anew, a condition of a signal changes, a count goes up: no difference of the guard
passes zero there, and the instant moves as that of what jumps. The oracles are closed forms.
"""

import math

import pytest

import hybond as hb

T, D, L, R, U = 1e-4, 0.4, 10e-3, 1.0, 10.0


def chopper(rules: list[str] | None = None) -> hb.Model:
    """A coil behind a source that is on for D of each period: by the ready part or by rules."""
    m = hb.Model("chopper", domain="electrical", parameters={"T": "0.1 ms", "D": D})
    if rules is None:
        m.add(pwm=hb.Submodel("control.pwm", period="T", inputs={"duty": "D"}))
        m.signal(u="pwm.out")
    else:
        m.machine("S", states={"low": [], "high": []}, start="low", rules=rules)
        m.signal(u='if S.state == "high" then 1 else 0')
    m.add(V=hb.Se("10 V*u"), L=hb.I("10 mH"), R=hb.R("1 ohm"), j=hb.One())
    m.bond("V -> j -> L", "j -> R")
    return m


SAWTOOTH = None
CONDITION = [
    "low -> high when (if sin(2*pi*(time - T/4)/T) > cos(pi*D) then 1 else 0) > 0.5",
    "high -> low when (if sin(2*pi*(time - T/4)/T) < cos(pi*D) then 1 else 0) > 0.5",
]


def corner(u: float, t_on: float, period: float) -> float:
    """The current where the source goes on, in the steady state: x = (x a + i (1 - a)) b."""
    a, b = math.exp(-R * t_on / L), math.exp(-R * (period - t_on) / L)
    return u / R * (1 - a) * b / (1 - a * b)


@pytest.mark.parametrize("rules", [SAWTOOTH, CONDITION])
def test_newtons_method_goes_through_guards_whose_reading_jumps(rules: list[str] | None) -> None:
    orbit = hb.periodic(chopper(rules), "T")
    assert orbit.periods <= 5
    assert orbit.values.real.tolist() == pytest.approx([math.exp(-R * T / L)], rel=1e-9)
    assert orbit["L.f"].min() == pytest.approx(corner(U, D * T, T), rel=1e-8)
    assert orbit["L.f"].mean() == pytest.approx(D * U / R, rel=1e-8)


def test_a_sawtooth_moves_with_its_period() -> None:
    def at_end(duty: float, period: float) -> float:
        """The current at 2.5 periods of 0.1 ms from rest, by the pulses until then."""
        i, t, end = 0.0, 0.0, 2.5e-4
        while t < end:
            for target, until in ((U / R, t + duty * period), (0.0, t + period)):
                until = min(until, end)
                i = target + (i - target) * math.exp(-R * max(until - t, 0.0) / L)
                t = max(t, until)
        return i

    found = hb.sensitivities(chopper(), "250 us", wrt=["D", "T"], of=["L.f"])
    assert found.run["L.f"].at(2.5e-4) == pytest.approx(at_end(D, T), rel=1e-8)
    for name, (dD, dT) in {"D": (1e-5, 0.0), "T": (0.0, 1e-9)}.items():
        step = dD or dT
        slope = (at_end(D + dD, T + dT) - at_end(D - dD, T - dT)) / (2 * step)
        assert found.final("L.f", name) == pytest.approx(slope, rel=1e-6)


@pytest.mark.parametrize("part", [0.0, 0.5, 1.0])
def test_peak_current_control_has_the_multiplier_of_its_slopes(part: float) -> None:
    """-(m2 - me)/(m1 + me): unstable above half without a ramp, and dead-beat with one of m2.

    Source: Erickson and Maksimovic, Fundamentals of Power Electronics, chapter on current
    programmed control.
    """
    supply, out, coil, period = 10.0, 6.0, 10e-6, 10e-6
    up, down = (supply - out) / coil, out / coil
    ramp = part * down
    top = 6.0 + ramp * out / supply * period
    m = hb.Model("peak", domain="electrical", parameters={"me": f"{ramp} A/s", "top": f"{top} A"})
    m.add(clock=hb.Submodel("control.pwm", period="10 us", inputs={"duty": 0.01}))
    reset = "if L.f + me*10e-6*1[s]*clock.carrier > top then 1 else 0"
    m.add(latch=hb.Submodel("control.latch", inputs={"set": "clock.out", "reset": reset}))
    m.add(V=hb.Se("10 V"), E=hb.Se("6 V"), L=hb.I("10 uH", f="3 A"), s=hb.One(), x=hb.Zero())
    m.add(d=hb.One(law="diode"), j=hb.One())
    m.bond("V -> s -> x -> j -> L", "d -> x", "j -> E")
    m.machine(
        "S",
        states={"off": [], "on": ["s"]},
        start="off",
        rules=["off -> on when latch.out > 0.5", "on -> off when latch.out < 0.5"],
    )
    orbit = hb.periodic(m, settle="0 s")
    (multiplier,) = orbit.values.real.tolist()
    assert multiplier == pytest.approx(-(down - ramp) / (up + ramp), abs=1e-9)
    assert orbit.stable == (part > 0.0)
    assert orbit["L.f"].max() == pytest.approx(6.0, rel=1e-9)


@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    "source", ["if mod(time, T) < T/2 then U else -U", "U*sign(sin(2*pi*time/T))"]
)
def test_ideal_bridges_behind_a_coil_are_followed(source: str) -> None:
    """While the current of the coil turns round all four diodes conduct, and share it equally.

    A stiff current I takes 2 L I/U of each half period from the voltage: U (1 - 4 L I/(U T)).
    """
    m = hb.Model("bridge", domain="electrical", parameters={"T": "10 us", "U": "100 V"})
    m.add(V=hb.Se(source), L=hb.I("5 uH"), s=hb.One(), a=hb.Zero(), p=hb.Zero(), n=hb.Zero())
    for k, ends in enumerate(("a -> D0 -> p", "D1 -> p", "n -> D2 -> a", "n -> D3")):
        m.add(**{f"D{k}": hb.One(law="diode")})
        m.bond(ends)
    m.add(d=hb.One(), Lo=hb.I("50 mH"), r=hb.R("10 ohm"))
    m.bond("V -> s -> a", "s -> L", "p -> d -> n", "d -> Lo", "d -> r")
    orbit = hb.periodic(m, "T")
    assert orbit.stable and orbit.periods <= 12
    current = orbit["Lo.f"].mean()
    # with 50 mH the current moves by 1e-4 of itself
    assert 10 * current == pytest.approx(100 * (1 - 4 * 5e-6 * current / (100 * 10e-6)), rel=1e-4)
    assert orbit["D0.f"].mean() == pytest.approx(current / 2, rel=1e-6)
