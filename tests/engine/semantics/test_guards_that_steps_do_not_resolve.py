"""Guards on signals that no state drives: the step size knows nothing of them."""

import math

import pytest

import hybond as hb


def test_every_crossing_of_a_fast_signal_without_storage_is_found() -> None:
    """i = 2 sin(2 pi 50 t) passes 1.99 and -1.99 once a period: 50 periods, 100 events."""
    m = hb.Model()
    m.add(V=hb.Se("10*sin(2*pi*50*time)"), R=hb.R(5), i=hb.One())
    m.bond("V -> i -> R")
    rules = ["a -> b when i.f > 1.99", "b -> a when i.f < -1.99"]
    m.machine("A", states={"a": [], "b": []}, start="a", rules=rules)
    run = hb.simulate(m, 1.0)
    first = math.asin(0.995) / (2 * math.pi * 50)
    expected = [k * 0.02 + first + half for k in range(50) for half in (0.0, 0.01)]
    assert [e.t for e in run.events[1:]] == pytest.approx(expected, rel=1e-9)


def test_a_fast_signal_beside_a_slow_state() -> None:
    m = hb.Model()
    m.add(V=hb.Se(1), L=hb.I(1), s=hb.One())
    m.bond("V -> s -> L")
    m.signal(x="sin(2*pi*50*time)")
    rules = ["a -> b when x > 0.9", "b -> a when x < -0.9"]
    m.machine("A", states={"a": [], "b": []}, start="a", rules=rules)
    assert len(hb.simulate(m, 2.0).events) == 1 + 200


@pytest.mark.parametrize("phase", [k / 17 for k in range(17)])
def test_a_shallow_dip_is_found_wherever_it_lies_in_a_step(phase: float) -> None:
    """L.f = sin(t + phase) falls below -0.9999999 for 0.9 ms around its minimum."""
    m = hb.Model()
    m.add(V=hb.Se(f"cos(1*time + {phase})"), L=hb.I(1.0, f=math.sin(phase)), s=hb.One())
    m.bond("V -> s -> L")
    m.machine("A", states={"a": [], "b": []}, start="a", rules=["a -> b when L.f < -0.9999999"])
    run = hb.simulate(m, 6.0, rtol=1e-10)
    bottom = 1.5 * math.pi - phase
    assert run.events[1].t == pytest.approx(bottom - math.acos(0.9999999), abs=1e-6)


def test_a_jumping_signal_is_closed_in_on() -> None:
    m = hb.Model()
    m.add(V=hb.Se(1), L=hb.I(1), s=hb.One())
    m.bond("V -> s -> L")
    rules = ["low -> high when mod(L.f, 1) > 0.5", "high -> low when mod(L.f, 1) < 0.5"]
    m.machine("A", states={"low": [], "high": []}, start="low", rules=rules)
    run = hb.simulate(m, 3.2)
    assert [e.t for e in run.events[1:]] == pytest.approx([0.5, 1.0, 1.5, 2.0, 2.5, 3.0], rel=1e-9)


DYING = {
    "capacitor": (1e-6, 1e-6, None),
    "capacitor, faster": (1e-9, 3e-3, None),
    "onto another one": (1e-6, 1e-3, 1.0),
    "onto another one, faster": (1e-9, 1e-5, 1.0),
}


@pytest.mark.parametrize("name", DYING)
def test_what_dies_away_from_below_never_comes_above(name: str) -> None:
    """f = -1 kV / R exp(-t / RC), RC 1 ps or 1 fs: what a guard asks for is 1e-12 to 1e-18 of it.

    Of what is left at the end of a step nobody knows more than the exponential itself.
    """
    resistance, above, other = DYING[name]
    m = hb.Model("dies away")
    m.add(x=hb.C(1e-6, q=-1e-3), R=hb.R(resistance), j=hb.One())
    m.bond("x -> j -> R")
    if other:
        m.add(y=hb.C(other))
        m.bond("y -> j")
    m.machine(
        "G", states={"off": [], "on": []}, start="off", rules=[f"off -> on when R.f > {above}"]
    )
    run = hb.simulate(m, 1.0)
    assert len(run.events) == 1
    shared = 1e-3 * 1e-6 / (1e-6 + other) if other else 0.0  # of the charge, as much as fits
    assert float(run["x.q"].at(1.0)) == pytest.approx(-shared, abs=1e-11)


def test_what_dies_away_is_still_found_where_it_passes() -> None:
    """-exp(-t / RC) + 1e-9 passes zero after 20.7 RC, RC 1 ps: the source of 1 uV beside 1 kV."""
    m = hb.Model("passes")
    m.add(x=hb.C(1e-6, q=-1e-3), R=hb.R(1e-6), V=hb.Se(1e-6), j=hb.One())
    m.bond("V -> j -> R", "j -> x")
    m.machine("G", states={"off": [], "on": []}, start="off", rules=["off -> on when x.q > 0"])
    run = hb.simulate(m, 1.0)
    assert run.events[1].t == pytest.approx(1e-12 * math.log(1.0 + 1e9), rel=1e-6)


@pytest.mark.parametrize("solver", ["auto", "rk45", "radau"])
@pytest.mark.parametrize("kind", ["capacitor", "mass", "behind a gyrator", "faster"])
def test_what_decays_within_an_instant_is_followed_to_where_a_guard_ends_it(kind, solver):
    """A switch opens at half of what was stored, ln 2 of a time constant of 0.3 ps or 10 fs.

    In a run of a second an instant lasts a picosecond: no step that satisfies the tolerance
    reaches its end, and one that does not has any value where the guard holds.
    """
    tau = 1e-14 if kind == "faster" else 3e-13
    m = hb.Model("opens")
    if kind == "mass":
        m.add(x=hb.I(1e-6, p=-1e-3), R=hb.R(1e-6 / tau), j=hb.Zero())
        m.bond("x -> j -> R")
    elif kind == "behind a gyrator":
        m.add(x=hb.I(1e-6, p=-1e-3), R=hb.R(tau / 1e-6), j=hb.One(), g=hb.GY(1.0))
        m.bond("x -> g -> j -> R")
    else:
        m.add(x=hb.C(1e-6, q=-1e-3), R=hb.R(tau / 1e-6), j=hb.One())
        m.bond("x -> j -> R")
    name = "x.p" if kind in ("mass", "behind a gyrator") else "x.q"
    rules = [f"closed -> open when {name} > -0.5e-3"]
    m.machine("G", states={"closed": ["j"], "open": []}, start="closed", rules=rules)
    run = hb.simulate(m, 1.0, solver=solver)
    assert len(run.events) == 2
    assert run.events[1].t == pytest.approx(tau * math.log(2.0), rel=1e-6)
    if kind == "behind a gyrator":
        assert float(run[name].at(run.events[1].t)) == pytest.approx(-0.5e-3, rel=1e-8)
    else:
        assert float(run[name].at(1.0)) == pytest.approx(-0.5e-3, rel=1e-8)
    assert run.audit().holds()
