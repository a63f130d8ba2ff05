"""Guards whose thresholds are where the motion comes to rest: rounding fires none, and hides none.

Against closed forms: what charges or speeds up towards its end is never there; what crosses or
touches its threshold in finite time is.
"""

from __future__ import annotations

import math

import pytest

import hybond as hb

METHODS = ["exact", "rk45", "radau", "qss"]
CLOCK = {"k": hb.Sampled("1 - k", every="7 s")}


def watched(m: hb.Model, guard: str) -> hb.Model:
    """Add a machine that fires once, where its guard holds."""
    m.machine("w", states={"no": [], "yes": []}, start="no", rules=[f"no -> yes when {guard}"])
    return m


def line(guard: str, start: str = "0 V", source: str = "1 V") -> hb.Model:
    """Return a capacitor that charges through a resistor, with a time constant of 1 s."""
    m = hb.Model("rc", domain="electrical")
    m.add(S=hb.Se(source), R=hb.R("1 ohm"), C=hb.C("1 F", e=start), i=hb.One())
    m.bond("S -> i -> R", "i -> C")
    m.signal(x=hb.Integral("1 [1/s]"))
    return watched(m, guard)


def turned(guard: str) -> hb.Model:
    """Return the same with the bonds of the capacitor and of the source the other way round."""
    m = hb.Model("rc", domain="electrical")
    m.add(S=hb.Se("-1 V"), R=hb.R("1 ohm"), C=hb.C("1 F"), i=hb.One())
    m.bond("i -> S", "i -> R", "i -> C")
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
    m.signal(x=hb.Integral("v.f"))
    return watched(m, guard)


def chain(guard: str) -> hb.Model:
    """Return two capacitors, the second of which charges a hundred times as slowly."""
    m = hb.Model("two", domain="electrical")
    m.add(S=hb.Se("1 V"), R1=hb.R("1 ohm"), C1=hb.C("1 F"), R2=hb.R("100 ohm"), C2=hb.C("1 F"))
    m.add(i=hb.One(), a=hb.Zero(), j=hb.One())
    m.bond("S -> i -> R1", "i -> a -> C1", "a -> j -> R2", "j -> C2")
    return watched(m, guard)


def shared(guard: str) -> hb.Model:
    """Return two capacitors that level out, and keep their charge: both to 1/3 V."""
    m = hb.Model("share", domain="electrical")
    m.add(R1=hb.R("1 ohm"), C1=hb.C("1 F", e="1 V"), C2=hb.C("2 F"))
    m.add(i=hb.One(), a=hb.Zero(), b=hb.Zero())
    m.bond("a -> C1", "a -> i -> b -> C2", "i -> R1")
    return watched(m, guard)


def ring(guard: str, r: str) -> hb.Model:
    """Return a series circuit: it rings at 0.2 ohm, and does not at 2 ohm."""
    m = hb.Model("rlc", domain="electrical")
    m.add(S=hb.Se("1 V"), R=hb.R(r), L=hb.I("1 H"), C=hb.C("1 F"), i=hb.One())
    m.bond("S -> i -> R", "i -> L", "i -> C")
    return watched(m, guard)


def dying(large: str) -> hb.Model:
    """Return two capacitors that empty by themselves: `large` in 1 s, below 1 V in 2 s."""
    m = hb.Model("dying", domain="electrical")
    m.add(A=hb.C("1 F", e=large), R=hb.R("1 ohm"), a=hb.Zero())
    m.add(B=hb.C("1 F", e="1 V"), S=hb.R("2 ohm"), b=hb.Zero())
    m.bond("a -> A", "a -> R", "b -> B", "b -> S")
    return watched(m, "A.e <= B.e")


def coupled(guard: str, starts: tuple[float, float]) -> hb.Model:
    """Return two signals that die out and turn each other; their eigenvalues are real."""
    m = hb.Model("coupled")
    m.signal(
        x=hb.Integral("(-8.6*x + y)*1 [1/s]", start=starts[0]),
        y=hb.Integral("(-x - 2.6*y)*1 [1/s]", start=starts[1]),
    )
    return watched(m, guard)


def clocked(guard: str) -> hb.Model:
    """Return the line beside a clock, whose instants ask all guards."""
    m = line(guard)
    m.signal(**CLOCK)
    rules = ["a -> b when k > 0.5", "b -> a when k < 0.5"]
    m.machine("clock", states={"a": [], "b": []}, start="a", rules=rules)
    return m


def sampled(guard: str, source: str = "1 V", start: str = "0 V") -> hb.Model:
    """Return the line beside a signal that is sampled: 1 or 0, seven seconds each."""
    m = line(guard, start=start, source=source)
    m.signal(**CLOCK)
    return m


def after(guard: str) -> hb.Model:
    """Return the line where something else happens at 0.3 s."""
    m = line(guard)
    rules = ["a -> b when x > 0.3"]
    m.machine("other", states={"a": [], "b": []}, start="a", rules=rules)
    return m


NEVER = {
    "charged": (line("C.e > 1 [V]"), 100),
    "charged or at its end": (line("C.e >= 1 [V]"), 100),
    "the other way round": (turned("C.e >= 1 [V]"), 100),
    "from above": (line("C.e <= 1 [V]", start="3 V"), 100),
    "to nothing": (line("C.e <= 0 [V]", start="3 V", source="0 V"), 1000),
    "below nothing": (line("C.e < 0 [V]", start="3 V", source="0 V"), 1000),
    "its current": (line("R.f <= 0 [A]"), 100),
    "behind a source that comes to rest": (
        line("C.e >= 1 [V]", source="1 V*(1 - exp(-time/(2 [s])))"),
        200,
    ),
    "time alone": (line("1 - exp(-time/(1 [s])) >= 1"), 100),
    "and more": (line("C.e >= 1 [V] and x >= 60"), 100),
    "beyond by less than the run tells": (line("C.e > (1 + 1e-12)*1 [V]"), 100),
    "coil": (coil("L.f > 5/3*1 [A]"), 1),
    "terminal speed": (falling("v.f >= 2 [m/s]"), 100),
    "beyond terminal speed": (falling("v.f > 2 [m/s]"), 100),
    "fast of two": (chain("C1.e >= 1 [V]"), 5000),
    "slow of two": (chain("C2.e > 1 [V]"), 5000),
    "both of two": (chain("C1.e <= C2.e and time > 1 [s]"), 5000),
    "levelled": (shared("C1.e <= C2.e"), 1000),
    "levelled, charge kept": (shared("C2.e > 1/3*1 [V]"), 1000),
    # both of one sign all the way: the slow direction is near to (1, 6), and it starts beside that
    "die out together": (coupled("x + y >= 0", (-0.35, -1.06)), 100),
    "one of two that die out": (coupled("y >= 0", (-0.35, -1.06)), 100),
    "while a sampled signal is off": (sampled("C.e >= 1 [V] and k < 0.5"), 100),
    "while it is off, from above": (sampled("C.e <= 1 [V] and k < 0.5", start="3 V"), 100),
    "a sampled threshold": (sampled("C.e >= (1 + k)*1 [V]"), 100),
    "rings out": (ring("C.e > 1 [V] and time > 400 [s]", "0.2 ohm"), 1000),
    "does not ring": (ring("C.e > 1 [V]", "2 ohm"), 1000),
}
RINGS = math.sqrt(1 - 0.1**2)
FIRES = {
    "half": (line("C.e >= 0.5 [V]"), 10, math.log(2)),
    "nearly all": (line("C.e > 0.999999 [V]"), 100, 6 * math.log(10)),
    "equal from the start": (line("C.e >= 1 [V]", start="1 V"), 10, 0.0),
    "driven on": (line("C.e > 1 [V]", source="if time < 50 [s] then 1 V else 2 V"), 100, 50.0),
    "driven on, while a sampled signal is off": (
        sampled("C.e >= 1 [V] and k < 0.5", source="if time < 50 [s] then 1 V else 2 V"),
        100,
        50.0,
    ),
    "or more": (line("C.e >= 1 [V] or x >= 60"), 100, 60.0),
    "touch": (line("cos(time/(1 [s])) <= -1"), 10, math.pi),
    "way": (falling("x >= 100 [m]"), 100, math.acosh(math.exp(100)) / 2),
    "cut off at its bound": (line("min(x, 1) >= 1"), 10, 1.0),
    "jumps upwards": (after("floor(x) >= 1"), 10, 1.0),
    "jumps behind a whole number": (after("ceil(x) >= 2"), 10, 1.0),
    "rings": (ring("C.e > 1 [V]", "0.2 ohm"), 100, (math.pi - math.acos(0.1)) / RINGS),
}


def fired(run: hb.Result) -> list[float]:
    """Return when the machine fired."""
    fires = [(event.t, f.machine) for event in run.events for s in event.steps for f in s.fired]
    return [float(t) for t, machine in fires if machine == "w"]


@pytest.mark.sampled(3)
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", NEVER)
def test_limit_is_never_reached(name: str, method: str) -> None:
    model, until = NEVER[name]
    run = hb.simulate(model, until=until, method=method)
    assert fired(run) == []
    assert all("HB-N413" in w for w in run.warnings)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", FIRES)
def test_what_is_reached_in_finite_time_fires(name: str, method: str) -> None:
    model, until, t = FIRES[name]
    at = fired(hb.simulate(model, until=until, method=method))
    assert len(at) == 1
    assert at[0] == pytest.approx(t, rel=1e-3 if "nearly" in name else 1e-5, abs=1e-12)


@pytest.mark.parametrize("method", ["exact", "radau"])
@pytest.mark.parametrize("large", [1e1, 1e4])
def test_what_dies_out_is_told_by_its_own_digits(large: float, method: str) -> None:
    """One falls below the other far below where it began, and both come to rest at zero."""
    at = fired(hb.simulate(dying(f"{large} V"), until=80, method=method))
    assert at == pytest.approx([2 * math.log(large)], rel=1e-5)


def test_explicit_steps_say_that_they_cannot_tell_that() -> None:
    run = hb.simulate(dying("1e4 V"), until=80, method="rk45")
    assert fired(run) == [] and "HB-N413" in run.warnings[0]
    run = hb.simulate(dying("1e4 V"), until=80, method="rk45", rtol=1e-11)
    assert fired(run) == pytest.approx([2 * math.log(1e4)], rel=1e-5) and not run.warnings


@pytest.mark.parametrize("guard", ["C.e >= 1 [V]", "C.e > 1 [V]", "R.e <= 0 [V]"])
@pytest.mark.parametrize("method", METHODS)
def test_instants_of_others_fire_no_limit(guard: str, method: str) -> None:
    run = hb.simulate(clocked(guard), until=100, method=method)
    assert fired(run) == []
    assert len(run.events) == 15  # the clock at 0, 7, ..., 98 s


def test_it_is_said_what_cannot_be_told() -> None:
    limit = hb.simulate(NEVER["charged"][0], until=100).warnings
    assert len(limit) == 1
    assert "HB-N413" in limit[0]
    assert "'C.e > 1 [V]' of w" in limit[0]
    assert "does not fire" in limit[0]
    near = hb.simulate(line("C.e > (1 - 1e-12)*1 [V]"), until=100)
    assert len(fired(near)) == 1
    assert "fires, but when is not known" in near.warnings[0]
    assert hb.simulate(NEVER["beyond by less than the run tells"][0], until=100).warnings == ()


@pytest.mark.parametrize("method", ["rk45", "radau"])
def test_runs_that_go_on_at_a_limit(method: str) -> None:
    model = line("C.e >= 1 [V]")
    model.experiment["until"] = "100 s"
    first = hb.simulate(model, until=40, method=method)
    assert fired(hb.simulate(model, until=100, start=first, method=method)) == []
