"""An integrated signal is as right as ``rtol`` says, however small, sudden or slow to begin it is.

It was measured by what its rate would add in a millionth of the run, and against an absolute size:
a pulse at the start, or a signal of 1e-16, was silently wrong. Oracles are closed forms.
"""

from __future__ import annotations

import math
from math import cos, exp, pi, sin, sqrt

import pytest

import hybond as hb

SOLVERS = ("auto", "rk45", "radau", "exact")
TOLERANCES = (1e-6, 1e-8, 1e-10)
ALLOWED = 30.0
"""Errors of steps add up: so many times the tolerance is what all of them may make."""


def charged(**integrals: str) -> hb.Model:
    """Return 1 V that charges 1 F over 1 ohm from nothing, and what is integrated beside."""
    m = hb.Model("charged")
    m.add(V=hb.Se(1.0), j=hb.One(), R=hb.R(1.0), C=hb.C(1.0))
    m.bond("V -> j", "j -> R", "j -> C")
    m.signal(**{name: hb.Integral(rate) for name, rate in integrals.items()})
    return m


def swings(**integrals: str) -> hb.Model:
    """Return a mass of 1 kg that swings at 5 rad/s from 1 m/s, and what is integrated beside."""
    m = hb.Model("swings")
    m.add(j=hb.One(), M=hb.I(1.0, p=1.0), K=hb.C(0.04))
    m.bond("j -> M", "j -> K")
    m.signal(**{name: hb.Integral(rate) for name, rate in integrals.items()})
    return m


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("width", [1e-3, 1e-6, 1e-9, 1e-11, 1e-13])
def test_a_pulse_at_the_start_has_all_of_its_area(width: float, solver: str) -> None:
    model = charged(q=f"exp(-time/{width!r})/{width!r}")
    run = hb.simulate(model, 1.0, solver=solver, rtol=1e-8)
    assert run["q"].at(1.0) == pytest.approx(1.0, rel=2e-8)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("size", [1e-10, 1e-16, 1e-30, 1e-60, 1e20])
def test_a_signal_of_any_size_has_its_digits(size: float, solver: str) -> None:
    model = charged(a=f"{size!r}*sin(50*time/(1 s))^2", b=f"{size!r}*(1 - C.e)^2")
    run = hb.simulate(model, 1.0, solver=solver, rtol=1e-8)
    assert run["a"].at(1.0) / size == pytest.approx(0.5 - sin(100.0) / 200.0, rel=1e-7)
    assert run["b"].at(1.0) / size == pytest.approx(0.5 * (1.0 - exp(-2.0)), rel=1e-7)


INTEGRALS = {
    "heat": ("R.e*R.f", 3.0, 0.5 * (1.0 - exp(-6.0))),
    "energy of the source": ("V.e*V.f", 3.0, 1.0 - exp(-3.0)),
    "squares of the error": ("(1 - C.e)^2", 5.0, 0.5 * (1.0 - exp(-10.0))),
    "errors by time": ("time*abs(1 - C.e)", 3.0, 1.0 - 4.0 * exp(-3.0)),
    "a pulse in the middle": ("exp(-((time - 0.5)/1e-5)^2)/1e-5", 1.0, sqrt(pi)),
    "a pulse of some ns": ("exp(-((time - 0.5)/1e-8)^2)/1e-8", 1.0, sqrt(pi)),
    "a power that begins": ("sin(time)^8", pi, 35.0 * pi / 128.0),
    "from an edge": ("sqrt(time)", 1.0, 2.0 / 3.0),
    "nine decades": ("1/(1e-9 + time)", 1.0, math.log1p(1e9)),
    "what died out": ("1e-25*exp(-time/1e-4)", 1.0, 1e-29),
    "small differences": ("1e-20*(1 - cos(time))", 1.0, 1e-20 * (1.0 - sin(1.0))),
    "rounded": ("cosh(time) - 1", 1e-3, 1e-9 / 6.0 + 1e-15 / 120.0),
    "a power of one": ("(exp(time) - 1)^3", 1.0, exp(3) / 3 - 1.5 * exp(2) + 3 * exp(1) - 17 / 6),
}


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", ["auto", "rk45", "radau"])
@pytest.mark.parametrize("name", INTEGRALS)
def test_integrals_that_users_write(name: str, solver: str) -> None:
    rate, until, true = INTEGRALS[name]
    for rtol in TOLERANCES:
        if solver == "radau" and rtol < 1e-8:
            continue  # some thousand steps each
        run = hb.simulate(
            charged(q=rate.replace("time", "(time/(1 s))")), until, solver=solver, rtol=rtol
        )
        assert run["q"].at(until) == pytest.approx(true, rel=ALLOWED * rtol), rtol


@pytest.mark.parametrize("solver", SOLVERS)
def test_ways_and_means_of_what_swings(solver: str) -> None:
    model = swings(way="abs(M.f)", square="M.f^2", half="max(0, M.f)", x="M.f", area="x")
    run = hb.simulate(model, 2.0 * pi, solver=solver, rtol=1e-8)
    assert run["way"].at(2.0 * pi) == pytest.approx(4.0, rel=1e-7)
    assert run["half"].at(2.0 * pi) == pytest.approx(2.0, rel=1e-7)
    assert run["square"].at(2.0 * pi) == pytest.approx(pi, rel=1e-7)
    assert run["x"].at(1.0) == pytest.approx(0.2 * sin(5.0), rel=1e-6)
    assert run["area"].at(1.0) == pytest.approx(0.04 * (1.0 - cos(5.0)), rel=1e-6)


@pytest.mark.parametrize("solver", ["qss2", "qss3", "liqss2"])
@pytest.mark.parametrize("size", [1e-25, 1.0])
def test_quanta_of_signals_follow_what_they_are(size: float, solver: str) -> None:
    model = swings(x="M.f", area="x")
    model.signal(q=hb.Integral(f"{size!r}*exp(-time/(0.1 s))"))
    run = hb.simulate(model, 1.0, solver=solver, rtol=1e-4)
    assert run["q"].at(1.0) / size == pytest.approx(0.1 * (1.0 - exp(-10.0)), rel=1e-3)
    assert run["area"].at(1.0) == pytest.approx(0.04 * (1.0 - cos(5.0)), rel=1e-3)


DRIVES = {
    "(time/(1 s))^4": 0.2,
    "sin(time/(1 s))^6": (60.0 - 45.0 * sin(2.0) + 9.0 * sin(4.0) - sin(6.0)) / 192.0,
    "1 - cos(time/(1 s))": 1.0 - sin(1.0),
    "sin(100*time/(1 s))^4": 0.375 - sin(200.0) / 400.0 + sin(400.0) / 3200.0,
}


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize("dual", [False, True], ids=["capacitor", "mass"])
def test_what_a_power_of_time_drives_moves(drive: str, solver: str, *, dual: bool) -> None:
    """Sums of sines that cancel at the start were followed by steps of 1e-70 s (HB-N409)."""
    m = hb.Model("begins")
    m.add(s=hb.Se(drive) if dual else hb.Sf(drive), k=hb.I(2.0) if dual else hb.C(2.0))
    m.bond("s -> k")
    run = hb.simulate(m, 1.0, solver=solver)
    assert run["k.p" if dual else "k.q"].at(1.0) == pytest.approx(DRIVES[drive], rel=3e-8)


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_loop_that_a_power_of_a_sine_drives(solver: str) -> None:
    """Over 1 ohm into 1 F: ``u' = sin(t)^2 - u`` from nothing."""
    m = hb.Model("loop")
    m.add(s=hb.Se("sin(time/(1 s))^2"), j=hb.One(), R=hb.R(1.0), C=hb.C(1.0))
    m.bond("s -> j -> C", "j -> R")
    run = hb.simulate(m, 1.0, solver=solver)
    true = 0.5 - 0.1 * (cos(2.0) + 2.0 * sin(2.0)) - 0.4 * exp(-1.0)
    assert run["C.e"].at(1.0) == pytest.approx(true, rel=3e-8)


@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.parametrize("cuts", [(0.5,), (0.3,), (0.1, 0.29, 0.69)])
def test_peaks_are_met_by_a_run_that_goes_on(cuts: tuple[float, ...], solver: str) -> None:
    width = 1e-6
    peaks = "+".join(f"exp(-((time/(1 s) - {at})/{width})^2)" for at in (0.3, 0.7))
    m = hb.Model("clipped", domain="electrical")
    m.add(V=hb.Se(f"100 V*({peaks})"), d=hb.One(law="diode"), r=hb.R("1 ohm"), E=hb.Se("50 V"))
    m.bond("V -> d -> E", "d -> r")
    m.signal(q=hb.Integral("d.f"), all=hb.Integral(f"({peaks})/{width}"))
    run = hb.simulate(m, cuts[0], solver=solver)
    times = [e.t for e in run.events if e.t > 0.0]
    for cut in (*cuts[1:], 1.0):
        begun = run.t_end
        run = hb.simulate(m, cut, solver=solver, start=run)
        times += [e.t for e in run.events if e.t > begun]
    x = sqrt(math.log(2.0))
    crossed = [at + side * x * width for at in (0.3, 0.7) for side in (-1.0, 1.0)]
    assert times == pytest.approx(crossed, abs=1e-12)
    charge = 2.0 * (100.0 * sqrt(pi) * math.erf(x) - 100.0 * x) * width
    assert run["q"].at(1.0) == pytest.approx(charge, rel=1e-7)
    assert run["all"].at(1.0) == pytest.approx(2.0 * sqrt(pi), rel=1e-7)


FALLS = {
    "cube": ("-x*abs(x)^2", lambda t: 1.0 / sqrt(1.0 + 2.0 * t)),
    "fifth power": ("-x*abs(x)^4", lambda t: (1.0 + 4.0 * t) ** -0.25),
}


@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("until", [1e8, 1e11, 1e12])
@pytest.mark.parametrize("law", ["cube", "fifth power"])
def test_what_falls_in_a_second_of_a_long_run_has_its_digits(
    law: str, until: float, sign: int, solver: str
) -> None:
    """Its rates of the start, kept up for a part of the run, would lead to any number."""
    rate, told = FALLS[law]
    m = hb.Model("falls")
    m.signal(x=hb.Integral(rate, start=float(sign)))
    run = hb.simulate(m, until, solver=solver)
    for t in (0.1, 1.0, 1e3, 1e-3 * until):
        assert sign * run["x"].at(t) == pytest.approx(told(t), abs=3e-8)
    assert sign * run["x"].at(until) == pytest.approx(told(until), rel=1e-6)


@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.parametrize("until", [1e3, 1e10])
def test_what_fills_from_nothing_in_a_second_of_a_long_run(until: float, solver: str) -> None:
    m = hb.Model("fills")
    m.signal(x=hb.Integral("1 - x^2"))
    run = hb.simulate(m, until, solver=solver)
    for t in (0.1, 1.0, 5.0):
        assert run["x"].at(t) == pytest.approx(math.tanh(t), rel=1e-7)


@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.parametrize("until", [4e10, 4e11])
def test_robertson_up_to_his_last_times(until: float, solver: str) -> None:
    """The example of LSODE and IDA to the five digits that these print, by Radau of SciPy."""
    m = hb.Model("kinetics")
    m.signal(
        a=hb.Integral("-0.04*a + 1e4*b*c", start=1.0),
        b=hb.Integral("0.04*a - 1e4*b*c - 3e7*b^2"),
        c=hb.Integral("3e7*b^2"),
    )
    run = hb.simulate(m, until, solver=solver)
    told = {0.4: 0.985172113861, 4e3: 0.183202257778, 4e7: 5.20307184408e-5, 4e10: 5.20834517683e-8}
    for t, a in told.items():
        assert run["a"].at(t) == pytest.approx(a, rel=2e-5)
