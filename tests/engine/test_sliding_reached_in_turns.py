"""Relays that are crossed in turn, ever faster, slide where their surfaces meet.

Filippov's spiral: the rates are constant between crossings, so that these are told by hand.
"""

from __future__ import annotations

import math

import pytest

import hybond as hb

RELAY = {"p": [], "n": []}


def switched(m: hb.Model, of: str, seen: str, start: float) -> str:
    """Add a relay that looks at what begins there; return its sign in words."""
    begins = "p" if start > 0.0 else "n"
    rules = [f"p -> n when {seen} < 0", f"n -> p when {seen} > 0"]
    m.machine(of, states=RELAY, start=begins, rules=rules)
    return f"(if {of}.state == 'p' then 1 else -1)"


def signals(x: float, y: float, drift: str, *, turned: bool) -> hb.Model:
    """Return ``x' = 2 sign(y) - sign(x) + drift, y' = -2 sign(x) - sign(y)``; turned, y first."""
    m = hb.Model("spiral")
    a, b = switched(m, "a", "x", x), switched(m, "b", "y", y)
    rates = {"x": (f"2*{b} - {a} + {drift}", x), "y": (f"-2*{a} - {b}", y)}
    for name in reversed(rates) if turned else rates:
        m.signal(**{name: hb.Integral(rates[name][0], start=rates[name][1])})
    return m


def condensers(x: float, y: float, drift: str, *, turned: bool) -> hb.Model:
    """Return the same of voltages of two capacitors, fed by switched currents."""
    m = hb.Model("spiral", domain="electrical")
    sign = -1 if turned else 1
    m.add(cx=hb.C(1.0, e=x), cy=hb.C(1.0, e=y), x=hb.Zero(), y=hb.Zero())
    a, b = switched(m, "a", "x.e", x), switched(m, "b", "y.e", y)
    m.add(feeds_x=hb.Sf(f"{sign}*(2*{b} - {a} + {drift})"), feeds_y=hb.Sf(f"-2*{a} - {b}"))
    m.bond("x -> feeds_x" if turned else "feeds_x -> x", "x -> cx", "feeds_y -> y -> cy")
    return m


def ends_at(x: float, y: float, drift: float) -> float:
    """Return when the spiral has come to its middle, by its crossings."""
    a, b = math.copysign(1.0, x), math.copysign(1.0, y)
    t = 0.0
    while abs(x) + abs(y) > 1e-14:
        vx, vy = 2.0 * b - a + drift, -2.0 * a - b
        waits = [-z / v if z * v < 0.0 else math.inf for z, v in ((x, vx), (y, vy))]
        h = min(waits)
        t, x, y = t + h, x + h * vx, y + h * vy
        if waits[0] == h:
            x, a = 0.0, -a
        else:
            y, b = 0.0, -b
    return t


@pytest.mark.parametrize("solver", ["auto", "radau", "rk45"])
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("made", [signals, condensers])
@pytest.mark.parametrize("begins", [(1.0, -1.0), (-0.3, 0.9), (2e-3, 1e-3)])
def test_two_relays_wind_down_to_where_both_slide(begins, made, turned: bool, solver: str) -> None:
    x, y = begins
    run = hb.simulate(made(x, y, "0", turned=turned), until=5.0, solver=solver)
    assert run.status == "ok"
    (slid,) = run.sliding
    assert set(slid.machines) == {"a", "b"}
    assert slid.t0 == pytest.approx(ends_at(x, y, 0.0), abs=2e-9)
    assert slid.t1 == 5.0
    assert run.events[-1].cause == "accumulation"
    assert [run.weight(k, "p", 4.0) for k in "ab"] == pytest.approx([0.5, 0.5])
    assert run.audit().holds()


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("made", [signals, condensers])
def test_they_leave_it_when_what_drives_them_is_too_much(made, turned: bool) -> None:
    """Signs of -2 t/20 for y keep both still up to 10 s; then x alone is, up to 12 s."""
    run = hb.simulate(made(1.0, -1.0, "0.25*time/(1 [s])", turned=turned), until=15.0)
    both, one = run.sliding
    assert set(both.machines) == {"a", "b"}
    assert (both.t1, one.machines, one.t1) == (pytest.approx(10.0), ("a",), pytest.approx(12.0))
    names = ("cx.e", "cy.e") if made is condensers else ("x", "y")
    assert [float(run[name].at(15.0)) for name in names] == pytest.approx([1.125, -4.0], rel=1e-8)


def test_a_steady_drift_moves_the_end_of_the_spiral() -> None:
    run = hb.simulate(signals(1.0, -1.0, "0.1", turned=False), until=5.0)
    assert run.sliding[0].t0 == pytest.approx(ends_at(1.0, -1.0, 0.1), rel=1e-9)


def test_what_winds_down_in_its_second_rate_still_stops() -> None:
    """A twisting controller: no weight of two relays that act on one rate says how it goes on."""
    m = hb.Model("twisting")
    a, b = switched(m, "a", "x", 1.0), switched(m, "b", "v", 1.0)
    m.signal(x=hb.Integral("v", start=1.0), v=hb.Integral(f"-10*{a} - 3*{b}", start=1.0))
    run = hb.simulate(m, until=5.0)
    assert run.status == "accumulation"
    # up for 1/13 s, down; then each half of a swing has sqrt(7/13) of the speed of the last
    speed, kept = math.sqrt(14.0 * (1.0 + 1.0 / 26.0)), math.sqrt(7.0 / 13.0)
    ends = 1.0 / 13.0 + speed / 7.0 + speed * (1.0 / 13.0 + 1.0 / math.sqrt(91.0)) / (1.0 - kept)
    assert run.t_end == pytest.approx(ends, rel=1e-9)
