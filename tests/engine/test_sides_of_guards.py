"""Comparisons that are no more than their digits are what they were when they were clear last.

Time, a sample or another comparison may ask for what has come to rest long since. Against closed
forms: what charges to 1 V is below it at any time, and what a sampled controller leads to its
reference by halves is never there.
"""

from __future__ import annotations

import math

import pytest

import hybond as hb

METHODS = ["exact", "rk45", "radau", "qss"]


def watched(m: hb.Model, guard: str) -> hb.Model:
    """Add a machine that fires once, where its guard holds."""
    m.machine("w", states={"no": [], "yes": []}, start="no", rules=[f"no -> yes when {guard}"])
    return m


def line(guard: str, start: str = "0 V", source: str = "1 V") -> hb.Model:
    """Return a capacitor that charges through a resistor, with a time constant of 1 s."""
    m = hb.Model("rc", domain="electrical")
    m.add(S=hb.Se(source), R=hb.R("1 ohm"), C=hb.C("1 F", e=start), i=hb.One())
    m.bond("S -> i -> R", "i -> C")
    m.signal(x=hb.Integral("1 [1/s]"), k=hb.Sampled("1 - k", every="7 s"))
    return watched(m, guard)


def turned(guard: str) -> hb.Model:
    """Return it with its bonds the other way round, and declared from the other end."""
    m = hb.Model("rc", domain="electrical")
    m.add(i=hb.One(), C=hb.C("1 F"), R=hb.R("1 ohm"), S=hb.Se("-1 V"))
    m.bond("i -> C", "i -> R", "i -> S")
    return watched(m, guard)


def coil(guard: str) -> hb.Model:
    """Return a coil behind a resistor: to 5/3 A in thirds of a millisecond."""
    m = hb.Model("rl", domain="electrical")
    m.add(S=hb.Se("5 V"), R=hb.R("3 ohm"), L=hb.I("1 mH"), i=hb.One())
    m.bond("S -> i -> R", "i -> L")
    return watched(m, guard)


def falling(guard: str) -> hb.Model:
    """Return a mass with quadratic drag: to 2 m/s, as ``2 tanh(2 t)``."""
    m = hb.Model("drag", domain="translational")
    m.add(m=hb.I("2 kg"), F=hb.Se("8 N"), B=hb.R({"e": "2 [N*s^2/m^2]*f*abs(f)"}), v=hb.One())
    m.bond("F -> v -> m", "v -> B")
    return watched(m, guard)


def shared(guard: str) -> hb.Model:
    """Return two capacitors that level out: both to 1/3 V."""
    m = hb.Model("share", domain="electrical")
    m.add(R=hb.R("1 ohm"), A=hb.C("1 F", e="1 V"), B=hb.C("2 F"))
    m.add(i=hb.One(), a=hb.Zero(), b=hb.Zero())
    m.bond("a -> A", "a -> i -> b -> B", "i -> R")
    return watched(m, guard)


def controlled(guard: str, k: float) -> hb.Model:
    """Return what is led to 1 by a sampled controller, which leaves ``1 - k`` of the way a second.

    Its error is seen a sample later.
    """
    m = hb.Model("controlled")
    m.signal(
        x=hb.Integral("u*1 [1/s]"),
        u=hb.Sampled(f"{k}*(1 - x)", every="1 s"),
        error=hb.Sampled("1 - x", every="1 s"),
    )
    return watched(m, guard)


def regulated(guard: str) -> hb.Model:
    """Return a plant of first order with a sampled controller: to 2/3, by ``0.714^n``."""
    m = hb.Model("regulated")
    u = hb.Sampled("2*(1 - x)", every="0.1 s")
    m.signal(x=hb.Integral("(u - x)*1 [1/s]"), u=u)
    return watched(m, guard)


def counter(guard: str) -> hb.Model:
    """Return a counter of tenths of a second."""
    m = hb.Model("counter")
    m.signal(n=hb.Sampled("n + 1", every="0.1 s"), left=hb.Sampled("0.3 - 0.1*n", every="0.1 s"))
    return watched(m, guard)


AFTER_REST = {
    "at its end, and a time": (line("C.e >= 1 [V] and time > 50 [s]"), 100, None),
    "time first": (line("time > 50 [s] and C.e >= 1 [V]"), 100, None),
    "not below": (line("not (C.e < 1 [V]) and time > 50 [s]"), 100, None),
    "the other way round": (turned("time >= 60 [s] and C.e >= 1 [V]"), 100, None),
    "from above": (line("C.e <= 1 [V] and time > 50 [s]", start="3 V"), 100, None),
    "a coil": (coil("L.f >= 5/3*1 [A] and time > 20 [ms]"), 1, None),
    "terminal speed": (falling("v.f >= 2 [m/s] and time > 30 [s]"), 100, None),
    "levelled": (shared("A.e <= B.e and time > 60 [s]"), 1000, None),
    "a sample": (line("C.e >= 1 [V] and k > 0.5"), 100, None),
    "still below": (line("C.e < 1 [V] and time > 50 [s]"), 100, 50.0),
    "still above": (line("C.e > 1 [V] and time > 50 [s]", start="3 V"), 100, 50.0),
    "still below at a sample": (line("C.e < 1 [V] and k > 0.5 and time > 40 [s]"), 100, 42.0),
    "still below at a way": (line("C.e < 1 [V] and x >= 60"), 100, 60.0),
    "not above": (line("C.e <= 1 [V] and x >= 60"), 100, 60.0),
    "or a time": (line("C.e >= 1 [V] or time > 60 [s]"), 100, 60.0),
    "equal from the start": (line("C.e >= 1 [V] and time > 3 [s]", start="1 V"), 10, 3.0),
    "driven on before": (
        line("C.e > 1 [V] and time > 60 [s]", source="if time < 50 [s] then 1 V else 2 V"),
        100,
        60.0,
    ),
    "driven on later": (
        line("C.e > 1 [V] and time > 45 [s]", source="if time < 50 [s] then 1 V else 1.001 V"),
        100,
        50.0,
    ),
}
SAMPLED = {
    "halves": (controlled("x >= 1", 0.5), 200, None),
    "halves of an error": (controlled("error <= 0", 0.5), 200, None),
    "tenths": (controlled("error <= 0", 0.9), 200, None),
    "tenths of what it gives": (controlled("u <= 0", 0.9), 200, None),
    "small parts": (controlled("1 - x <= 0", 0.1), 1000, None),
    "a plant": (regulated("x >= 2/3"), 100, None),
    "near enough": (controlled("error < 1e-6", 0.5), 100, 20.0),
    "at once": (controlled("x >= 1", 1.0), 10, 1.0),
    "an error that is gone": (controlled("error <= 0", 1.0), 10, 1.0),
    "a count": (counter("n >= 7"), 5, 0.6),
    "more than a count": (counter("n > 7"), 5, 0.7),
    "a count down": (counter("left <= 0"), 5, 0.3),
}
JUMPS = {
    "a sign": (line("sign(C.e - 1 [V]) >= 0"), 100, None),
    "a sign, turned": (line("0 >= sign(1 [V] - C.e)"), 100, None),
    "the next whole number": (line("ceil(C.e/(1 [V])) >= 2"), 100, None),
    "no more than a whole number": (line("floor(C.e/(1 [V])) < 1", start="3 V"), 100, None),
    "the greater": (line("max(C.e, 1 [V]) > 1 [V]"), 100, None),
    "the lesser": (line("min(C.e, 1 [V]) < 1 [V]", start="3 V"), 100, None),
    "a sign that changes": (line("sign(C.e - 0.5 [V]) > 0"), 10, math.log(2)),
    "a whole number": (line("floor(C.e/(0.3 [V])) >= 2"), 10, -math.log(0.4)),
    "no sign at the start": (line("sign(C.e - 1 [V]) >= 0", start="1 V"), 10, 0.0),
}


def fired(run: hb.Result) -> list[float]:
    """Return when the machine fired."""
    fires = [(event.t, f.machine) for event in run.events for s in event.steps for f in s.fired]
    return [float(t) for t, machine in fires if machine == "w"]


def check(model: hb.Model, until: float, t: float | None, method: str) -> None:
    at = fired(hb.simulate(model, until=until, method=method))
    assert at == ([] if t is None else [pytest.approx(t, rel=1e-5, abs=1e-12)])


@pytest.mark.sampled(3)
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", AFTER_REST)
def test_time_that_asks_what_is_at_rest(name: str, method: str) -> None:
    check(*AFTER_REST[name], method)


@pytest.mark.parametrize("method", ["exact", "radau"])
@pytest.mark.parametrize("name", SAMPLED)
def test_sampled_controller_at_its_reference(name: str, method: str) -> None:
    check(*SAMPLED[name], method)


@pytest.mark.parametrize("method", ["exact", "rk45"])
@pytest.mark.parametrize("name", JUMPS)
def test_functions_that_jump_where_the_motion_rests(name: str, method: str) -> None:
    check(*JUMPS[name], method)


@pytest.mark.parametrize("end", [45, 52.5])
def test_sides_go_on_with_a_run(end: float) -> None:
    model = line("C.e >= 1 [V] and time > 50 [s]")
    model.experiment["until"] = "100 s"
    first = hb.simulate(model, until=end)
    assert fired(hb.simulate(model, until=100, start=first)) == []
