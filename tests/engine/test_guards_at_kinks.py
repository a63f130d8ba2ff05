"""A guard that fires where a law jumps, and a motion that begins there: each by its own side."""

from __future__ import annotations

import math

import numpy as np
import pytest

import hybond as hb

SOLVERS = ["auto", "rk45", "radau", "exact"]
PUSHES = {
    "if": "if x > 0 then -2 else 3",
    "as it is not": "if x <= 0 then 3 else -2",
    "sign": "0.5 - 2.5*sign(x)",
    "with a sum": "if x + 1 > 1 then -2 else 3",
}


def to_and_fro(push: str, start: float = 1.0, speed: float = 0.0, turned: bool = False) -> hb.Model:
    """Return a mass that is pushed to zero from either side; a machine counts that it passes."""
    m = hb.Model("to and fro")
    m.add(m=hb.I(1.0, f=speed), v=hb.One(), F=hb.Se(f"-({push})" if turned else push))
    m.bond("v -> F" if turned else "F -> v", "v -> m")
    m.signal(x=hb.Integral("v.f", start=start))
    m.machine(
        "side",
        states={"above": [], "below": []},
        start="above" if start > 0.0 else "below",
        rules=["above -> below when x <= 0 and v.f < 0", "below -> above when x >= 0 and v.f > 0"],
    )
    return m


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("push", PUSHES)
def test_a_push_that_jumps_where_a_guard_fires(push: str, turned: bool, solver: str) -> None:
    """Parabolas: a second down, 4/3 s below, 2 s above; steps of any length follow them."""
    run = hb.simulate(to_and_fro(PUSHES[push], turned=turned), until=8.5, solver=solver)
    at = np.cumsum([1.0, 4.0 / 3.0, 2.0, 4.0 / 3.0, 2.0])
    assert np.array(run.events.t[1:]) == pytest.approx(at, rel=1e-10)
    assert run["v.f"].at(at[-1], side="left") == pytest.approx(-2.0, rel=2e-9)
    assert run.audit().holds()


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_spring_that_jumps_where_a_guard_fires(solver: str) -> None:
    """The same of a storage: its energy is that of a step in the way it is stretched."""
    m = hb.Model("step in a spring")
    m.add(m=hb.I(1.0, f=-1.0), v=hb.One(), k=hb.C({"e": "if q > 0 then 2 else -3"}, q=0.75))
    m.bond("v -> m", "v -> k")
    m.machine("passed", states={"no": [], "yes": []}, start="no", rules=["no -> yes when k.q < 0"])
    run = hb.simulate(m, until=2.0, solver=solver)
    # 0.75 - t - t^2 = 0 at 0.5 s, with -2 m/s
    assert run.events.t[1] == pytest.approx(0.5, rel=1e-11)
    assert run["v.f"].at(1.0) == pytest.approx(-2.0 + 3.0 * 0.5, rel=1e-9)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("turned", [False, True])
def test_a_brake_whose_limit_jumps_where_it_holds(turned: bool, solver: str) -> None:
    """A band brake: T*r*(1 - exp(-mu*a)) one way, T*r*(exp(mu*a) - 1) the other."""
    limit = "if w.f < 0 then 40 else 140" if turned else "if w.f > 0 then 40 else 140"
    m = hb.Model("band brake", domain="rotational")
    m.add(J=hb.I(0.5, f=-30.0 if turned else 30.0), w=hb.One())
    m.add(b=hb.One(law="coulomb", limit=limit))
    m.bond("w -> J", "b -> w" if turned else "w -> b")
    run = hb.simulate(m, until=1.0, solver=solver)
    assert run.events.t[1] == pytest.approx(30.0 * 0.5 / 40.0, rel=1e-9)


@pytest.mark.parametrize("solver", [*SOLVERS, "rk4"])
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("push", ["if x >= 0 then -2 else 3", "0.5 - 2.5*sign(x)"])
def test_a_motion_that_begins_on_a_jump(push: str, turned: bool, solver: str) -> None:
    """To the left: 3 N from the first moment on, whatever the source is at zero itself."""
    step = {"step": 0.1} if solver == "rk4" else {}
    run = hb.simulate(
        to_and_fro(push, start=0.0, speed=-1.5, turned=turned), until=0.9, solver=solver, **step
    )
    for t in (0.05, 0.3, 0.9):
        assert run["x"].at(t) == pytest.approx(-1.5 * t + 1.5 * t * t, rel=1e-10)
    assert run.audit().holds()


def test_a_signal_that_begins_on_a_jump() -> None:
    m = to_and_fro("-1", start=0.0, speed=-1.5)
    m.signal(a=hb.Integral("if x >= 0 then 100 else 1"))
    for solver in SOLVERS:
        run = hb.simulate(m, until=1.0, solver=solver)
        assert run["a"].at(1.0) == pytest.approx(1.0, rel=1e-9)


def test_a_jump_that_nobody_gets_off() -> None:
    """A sign that would hold at rest what it gives in motion is refused, as ever."""
    m = hb.Model("held by a sign")
    m.add(m=hb.I(1.0), v=hb.One(), F=hb.Se("0.5 - sign(v.f)"))
    m.bond("F -> v -> m")
    with pytest.raises(hb.errors.HybondError) as caught:
        hb.simulate(m, until=1.0, solver="rk45")
    assert caught.value.code == "HB-N410"


BUFFERS = {
    "by its speed": "if v.f > 0 then k*x else k*x/3",
    "by its momentum": "if m.p > 0 then k*x else k*x/3",
    "by a sign": "k*x*(2 + sign(v.f))/3",
}


@pytest.mark.parametrize(
    ("force", "turned"),
    [("by its speed", False), ("by its momentum", True), ("by a sign", False), ("by a sign", True)],
)
def test_a_buffer_that_pushes_back_less_is_no_root_at_rest(force: str, turned: bool) -> None:
    """A wagon of 80 t runs onto a buffer; stages that swing about where it turns are no rest."""
    mass, k, speed = 80e3, 4e6, 2.0
    m = hb.Model("buffer", parameters={"k": k})
    text = f"if x > 0 then {BUFFERS[force]} else 0"
    m.add(m=hb.I(mass, f=speed), v=hb.One(), F=hb.Se(text if turned else f"-({text})"))
    m.bond("v -> F" if turned else "F -> v", "v -> m")
    m.signal(x=hb.Integral("v.f", start=-1.0))
    run = hb.simulate(m, until=1.0, solver="radau")
    assert not run.warnings
    rate = math.sqrt(k / mass)
    turns = 0.5 + 0.5 * math.pi / rate
    for t in (turns + 0.01, 0.8, 1.0):
        back = speed / rate * math.cos(rate / math.sqrt(3.0) * (t - turns))
        assert run["x"].at(t) == pytest.approx(back, rel=1e-7)


def drawn_from(part: str, period: float) -> hb.Model:
    """Two stores of 1e-3 at 290 and 300, joined one way by 0.1; of the fuller one 2 is drawn."""
    flows = part == "coils"
    m = hb.Model("drawn", domain="generic")
    store, one, zero = (hb.I, hb.Zero, hb.One) if flows else (hb.C, hb.One, hb.Zero)
    start = "f" if flows else "e"
    m.add(low=store(1e-3, **{start: 290}), high=store(1e-3, **{start: 300}), a=zero(), b=zero())
    draws = f"if mod(time, {period}) < 0.018 then {2 if part == 'turned' else -2} else 0"
    m.add(draw=hb.Se(draws) if flows else hb.Sf(draws), way=hb.R(0.1) if flows else hb.G(0.1))
    if part == "machine":
        m.add(d=hb.One())
        rules = ["blocks -> conducts when d.e > 0", "conducts -> blocks when d.f < 0"]
        m.machine("M", states={"blocks": [], "conducts": ["d"]}, start="blocks", rules=rules)
    else:
        m.add(d=one(law="diode"))
    m.bond("b -> draw" if part == "turned" else "draw -> b", "a -> low", "b -> high")
    m.bond("a -> d -> b", "d -> way")
    return m


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("period", [0.14, 0.16, 0.2])
@pytest.mark.parametrize("part", ["capacitors", "turned", "machine", "coils"])
def test_a_clock_that_draws_anew_from_what_has_come_to_rest(
    part: str, period: float, solver: str
) -> None:
    """Steps see the jump of the clock in a current of next to nothing: HB-N410, before."""
    run = hb.simulate(drawn_from(part, period), until=period + 0.01, solver=solver)
    # the difference settles in 5 ms, from when it is zero, at 5 ms
    apart = 10.0 * (1.0 - math.exp(-13.0 / 5.0)) * math.exp(-(period - 0.018 + 0.01) / 5e-3)
    apart += 10.0 * (1.0 - math.exp(-2.0))
    both = 590.0 - 2.0 * (0.018 + 0.01) / 1e-3
    letter = "f" if part == "coils" else "e"
    low, high = (run[f"{name}.{letter}"].at(period + 0.01) for name in ("low", "high"))
    assert low == pytest.approx(0.5 * (both + apart), rel=1e-8)
    assert high == pytest.approx(0.5 * (both - apart), rel=1e-8)
    assert run.audit().holds()


def on_belt(limit: str, turned: bool = False) -> hb.Model:
    """Let a belt drag a mass on a spring, by a friction that falls with the slip."""
    m = hb.Model("belt")
    m.add(belt=hb.Sf("-0.1" if turned else "0.1"), u=hb.One(), v=hb.One(), n=hb.Zero())
    m.add(s=hb.One(law="coulomb", limit=limit), M=hb.I(1.0), K=hb.C(0.01), D=hb.R(0.2))
    m.bond("v -> n -> u" if turned else "u -> n -> v", "n -> s", "belt -> u", "v -> M")
    m.bond("K -> v" if turned else "v -> K", "v -> D")
    return m


@pytest.mark.parametrize("solver", ["auto", "rk45"])
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("limit", ["3 + 2*exp(-abs(s.f)/0.05)", "5 - 2*min(1, 9*abs(s.f))"])
def test_friction_that_bends_where_it_comes_to_rest_does_not_slide_back(
    limit: str, turned: bool, solver: str
) -> None:
    """It sticks until the spring has 5 N less those of the damper, as often as that comes round.

    The step to the instant was made anew, went 1e-8 m/s past it, and that was a slip backward.
    """
    run = hb.simulate(on_belt(limit, turned), until=4.0, solver=solver)
    rests, slips = "sticks", "forward"
    fired = [(e.t, e.steps[-1].fired[0].target) for e in run.events[1:]]
    assert [to for _, to in fired] == [rests, slips] * (len(fired) // 2) + [rests] * (
        len(fired) % 2
    )
    for t in (t for t, to in fired if to == slips):
        assert abs(run["K.e"].at(t)) == pytest.approx(5.0 - 0.2 * 0.1, rel=1e-8)
    assert len(fired) > 8 and run.audit().holds()
