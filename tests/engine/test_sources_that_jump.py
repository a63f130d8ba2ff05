"""A source that jumps onto what is stored is an instant, also where no rule and no input says so.

Oracles: what is stored follows the source, the impulse is what is stored more, a source gives its
impulse times its own value behind the jump, and what is not stored of that is lost.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest

import hybond as hb
from hybond.engine.engine import Engine
from hybond.engine.inputs import interval

MASS = 2.0
METHODS = ("auto", "rk45", "radau", "exact", "qss2", "rk4")
SHAPES: dict[str, tuple[str, Callable[[float], float], list[float]]] = {
    "floor": ("floor(time/(1 s) + 0.5)", lambda t: math.floor(t + 0.5), [0.5, 1.5]),
    "ceil": ("ceil(time/(1 s))", lambda t: math.ceil(t), [0.0, 1.0, 2.0]),
    "mod": ("mod(time, 1 s)/(1 s)", lambda t: t % 1.0, [1.0, 2.0]),
    "sign": (
        "sign(sin(7*time/(1 s)))",
        lambda t: math.copysign(1.0, math.sin(7 * t)),
        [k * math.pi / 7 for k in range(5)],
    ),
    "if": (
        "if sin(7*time/(1 s)) >= 0 then 1 else 0",
        lambda t: float(math.sin(7 * t) >= 0),
        [k * math.pi / 7 for k in range(5)],
    ),
}


def driven(shape: str, kind: str, turned: bool) -> hb.Model:
    """A mass on a source of speed, or a capacitor on one of voltage."""
    mechanical = kind == "Sf"
    m = hb.Model("driven", domain="translational" if mechanical else "electrical")
    if mechanical:
        m.add(s=hb.Sf(f"({shape})*1 [m/s]"), store=hb.I(f"{MASS} kg"), node=hb.One())
    else:
        m.add(s=hb.Se(f"({shape})*1 [V]"), store=hb.C(f"{MASS} F"), node=hb.Zero())
    m.bond("s -> node", "store -> node" if turned else "node -> store")
    return m


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("kind", ["Sf", "Se"])
@pytest.mark.parametrize("shape", SHAPES)
def test_what_a_source_jumps_onto_takes_an_impulse_and_is_recorded(
    shape: str, kind: str, turned: bool
) -> None:
    text, value, times = SHAPES[shape]
    run = hb.simulate(driven(text, kind, turned), "2.2 s")
    assert run.status == "ok" and run.audit().holds()
    stored = "store.p" if kind == "Sf" else "store.q"
    of_bond = "s.e" if kind == "Sf" else "s.f"
    sign = -1.0 if turned and kind == "Sf" else 1.0  # power into it: e and -f
    events = [e for e in run.events if e.steps[-1].impulses or e.t > 0.0]
    assert [e.t for e in events] == pytest.approx(times, abs=1e-12)
    for event in events:
        before = value(event.t - 1e-9) if event.t > 1e-9 else 0.0
        after = value(event.t + 1e-9)
        step = event.steps[-1]
        assert step.energy is not None
        assert step.impulses[of_bond] == pytest.approx(MASS * (after - before), rel=1e-8)
        assert step.energy.source == pytest.approx(
            MASS * (after - before) * after, rel=1e-8, abs=1e-8
        )
        assert step.energy.lost == pytest.approx(0.5 * MASS * (after - before) ** 2, rel=1e-8)
    for t in (0.3, 0.7, 1.2, 1.7, 2.2):
        assert sign * float(run[stored].at(t)) == pytest.approx(MASS * value(t), abs=1e-9)


@pytest.mark.parametrize("method", METHODS)
def test_each_method_meets_the_jump(method: str) -> None:
    text, value, times = SHAPES["floor"]
    step = "10 ms" if method == "rk4" else None
    run = hb.simulate(driven(text, "Sf", False), "2.2 s", solver=method, step=step)
    assert run.status == "ok" and run.audit().holds()
    assert [e.t for e in run.events[1:]] == pytest.approx(times, abs=1e-9)
    assert float(run["store.p"].at(2.0)) == pytest.approx(MASS * value(2.0), abs=1e-9)


def test_a_source_that_follows_another_motion_jumps_where_that_crosses() -> None:
    m = hb.Model("follows", domain="translational")
    m.add(
        push=hb.Se("1 N"),
        slow=hb.I("1 kg"),
        v=hb.One(),
        s=hb.Sf("if v.f > 0.5 [m/s] then 1 [m/s] else 0 [m/s]"),
        mass=hb.I(f"{MASS} kg"),
        w=hb.One(),
    )
    m.bond("push -> v -> slow", "s -> w -> mass")
    run = hb.simulate(m, "1 s")
    assert run.audit().holds()
    (event,) = run.events[1:]
    assert (event.cause, event.t) == ("law", pytest.approx(0.5, abs=1e-9))
    assert float(run["slow.p"].at(1.0)) == pytest.approx(1.0, abs=1e-9)
    assert float(run["mass.p"].at(1.0)) == pytest.approx(MASS, abs=1e-9)


def test_a_kink_without_a_jump_is_no_event() -> None:
    m = driven("abs(time/(1 s) - 0.5) + max(time/(1 s), 1)", "Sf", False)
    run = hb.simulate(m, "2 s")
    assert len(run.events) == 1 and run.audit().holds()
    assert float(run["store.p"].at(1.5)) == pytest.approx(MASS * 2.5, abs=1e-9)


def test_a_jump_onto_a_resistor_alone_is_no_event() -> None:
    m = hb.Model("lamp", domain="electrical")
    m.add(s=hb.Se("floor(time/(1 s) + 0.5)*1 [V]"), r=hb.R("1 ohm"), l=hb.I("1 H"), i=hb.One())
    m.bond("s -> i -> r", "i -> l")
    run = hb.simulate(m, "1 s")
    assert len(run.events) == 1 and run.audit().holds()
    assert float(run["l.f"].at(1.0)) == pytest.approx(1.0 - math.exp(-0.5), rel=1e-8)


def test_a_timed_event_at_the_very_jump_is_one_instant_with_it() -> None:
    m = driven("floor(time/(1 s))", "Sf", False)
    m.add(lamp=hb.R("1 N*s/m"), load=hb.Sf("u"), w=hb.One())
    m.bond("load -> w -> lamp")
    m.input(u=hb.Input(pwm={"period": "1 s", "duty": 0.5, "high": "1 m/s", "low": 0}))
    run = hb.simulate(m, "2.5 s")
    assert run.status == "ok" and run.audit().holds()
    jumps = [e for e in run.events if e.t in (1.0, 2.0)]
    assert [e.steps[-1].impulses["s.e"] for e in jumps] == pytest.approx([MASS, MASS])
    assert float(run["store.p"].at(1.0, side="left")) == pytest.approx(0.0, abs=1e-12)


def test_an_unconnected_part_beside_the_jump_is_not_touched() -> None:
    m = driven(SHAPES["floor"][0], "Sf", False)
    m.add(swing=hb.I("1 kg", f="1 m/s"), spring=hb.C("1 m/N"), w=hb.One())
    m.bond("w -> swing", "w -> spring")
    run = hb.simulate(m, "2 s")
    assert [e.t for e in run.events[1:]] == pytest.approx([0.5, 1.5], abs=1e-12)
    assert float(run["swing.f"].at(2.0)) == pytest.approx(math.cos(2.0), abs=1e-9)


def test_a_source_behind_an_open_junction_jumps_onto_nothing_until_that_closes() -> None:
    m = hb.Model("gate", domain="translational")
    m.add(s=hb.Sf("floor(time/(1 s) + 0.5)*1 [m/s]"), gate=hb.Zero(), v=hb.One())
    m.add(mass=hb.I(f"{MASS} kg"))
    m.bond("s -> gate -> v -> mass")
    m.machine(
        "M", states={"off": [], "on": ["gate"]}, start="off", rules=["off -> on when time>=1"]
    )
    run = hb.simulate(m, "2 s")
    assert run.audit().holds()
    assert [(e.cause, e.t) for e in run.events[1:]] == [
        ("time", pytest.approx(1.0)),
        ("law", pytest.approx(1.5)),
    ]
    assert run["mass.p"].at([0.7, 1.2, 1.7]) == pytest.approx([0.0, MASS, 2.0 * MASS])


@pytest.mark.sampled(3)
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("shape", ["sign", "ceil", "floor"])
def test_a_timed_rule_at_a_jump_of_a_source_is_one_instant_with_it(shape: str, method: str) -> None:
    text, level = {
        "sign": ("sign(time/(1 s) - 1)", lambda t: math.copysign(1.0, t - 1.0)),
        "ceil": ("ceil(time/(1 s))", math.ceil),
        "floor": ("floor(time/(1 s))", math.floor),
    }[shape]
    m = driven(text, "Sf", False)
    m.add(force=hb.Se(f"({text})*1 [N]"), big=hb.I("1 kg"), w=hb.One())
    m.add(load=hb.Sf("1 m/s"), gate=hb.Zero(), lamp=hb.R("1 N*s/m"), u=hb.One())
    m.bond("force -> w -> big", "load -> gate -> u -> lamp")
    rules = ["off -> on when time >= 1"]
    m.machine("M", states={"off": [], "on": ["gate"]}, start="off", rules=rules)
    step = "10 ms" if method == "rk4" else None
    run = hb.simulate(m, "1.5 s", solver=method, step=step)
    assert run.audit().holds()
    first, event = run.events
    assert (first.t, event.t, event.cause) == (0.0, 1.0, "time")
    before, after = level(0.5), level(1.25)
    assert event.steps[-1].impulses["s.e"] == pytest.approx(MASS * (after - before), rel=1e-12)
    for source in ("s.f", "force.e"):
        assert float(run[source].at(1.0, side="left")) == before
        assert float(run[source].at(1.0)) == after
    assert float(run["big.p"].at(1.5)) == pytest.approx(before + 0.5 * after, abs=1e-9)


def test_an_input_that_bends_where_a_source_jumps_by_it_is_one_instant() -> None:
    m = driven("sign(u)", "Sf", False)
    m.input(u=hb.Input(table=[(0, -1), (1, 0), (2, 3)], linear=True))
    run = hb.simulate(m, "2 s")
    assert run.audit().holds()
    assert [e.t for e in run.events] == [0.0, 1.0]
    assert run.events[1].steps[-1].impulses["s.e"] == pytest.approx(2.0 * MASS)
    assert run["store.p"].at([0.5, 1.5]) == pytest.approx([-MASS, MASS])


def test_what_a_source_was_before_its_jump_is_what_rules_read_of_before() -> None:
    m = driven("sign(time/(1 s) - 1)", "Sf", False)
    m.add(load=hb.Sf("1 m/s"), gate=hb.Zero(), lamp=hb.R("1 N*s/m"), u=hb.One())
    m.bond("load -> gate -> u -> lamp")
    rules = ["off -> on when s.f - pre(s.f) > 1.9"]
    m.machine("M", states={"off": [], "on": ["gate"]}, start="off", rules=rules)
    run = hb.simulate(m, "2 s")
    (event,) = run.events[1:]
    assert event.t == pytest.approx(1.0, abs=1e-11)
    assert float(run["lamp.f"].at(1.5)) == 1.0 and float(run["lamp.f"].at(0.5)) == 0.0


@pytest.mark.parametrize("theta", [0.5, 1.0])
@pytest.mark.parametrize("kind", ["Sf", "Se"])
@pytest.mark.parametrize("shape", ["floor", "sign", "if"])
def test_time_stepping_pays_for_what_a_source_jumps_by(shape: str, kind: str, theta: float) -> None:
    text, value, times = SHAPES[shape]
    model = driven(text, kind, False)
    run = hb.simulate(model, "2.2 s", solver="moreau-jean", step="10 ms", theta=theta)
    audit = run.audit()
    assert audit.holds() and audit.created <= 1e-14 and audit.energy <= 1e-14
    jumps = [(value(t - 1e-9) if t > 1e-9 else 0.0, value(t + 1e-9)) for t in times]
    jumps = jumps[1:] if shape == "if" else jumps  # a jump at the start is no step's
    given = sum(MASS * (after - before) * after for before, after in jumps)
    assert run.segments[-1].y[-1][-2] == pytest.approx(given, rel=1e-9)


LET_GO = {
    "sign": ("2*sign(1.8 - (time - t0)/(1 s))", 1.8),
    "mod": ("if mod(time - t0, 1.3 s) < 0.5 [s] then 2 else -2", 0.5),
    "floor": ("2 - 4*floor((time - t0)/(1.8 s))", 1.8),
}


@pytest.mark.parametrize(("begins", "solver"), [(0.0, "radau"), (1e4, "auto")])
@pytest.mark.parametrize("kind", ["Se", "Sf", "turned", "machine"])
@pytest.mark.parametrize("shape", LET_GO)
def test_laws_hold_before_a_jump_by_which_a_source_lets_go_what_it_drives(
    shape: str, kind: str, begins: float, solver: str
) -> None:
    """A diode, a freewheel or a rule opens as the source falls: what is stored dies out."""
    law, falls = LET_GO[shape]
    m = hb.Model("let go", parameters={"t0": f"{begins} s"})
    if kind == "Sf":
        m.add(s=hb.Sf(law), d=hb.Zero(law="diode"), n=hb.One(), store=hb.I(0.5), loss=hb.R(1.0))
    else:
        d = hb.One() if kind == "machine" else hb.One(law="diode")
        m.add(s=hb.Se(law), d=d, n=hb.Zero(), store=hb.C(0.5), loss=hb.G(1.0))
    m.bond("s -> d -> n", "store -> n" if kind == "turned" else "n -> store", "n -> loss")
    if kind == "machine":
        m.machine(
            "M",
            states={"joined": ["d"], "free": []},
            start="joined",
            rules=["joined -> free when d.f < 0", "free -> joined when d.e > 0"],
        )
    run = hb.simulate(m, begins + falls + 0.1, solver=solver, start={"time": begins})
    assert run.audit().holds() and run.events.t[1:] == pytest.approx([begins + falls], abs=1e-9)
    found = run["n.f" if kind == "Sf" else "n.e"].at([begins + falls / 2, begins + falls + 0.1])
    assert found == pytest.approx([2.0, 2.0 * math.exp(-0.2)], rel=1e-8)


@pytest.mark.parametrize("turned", [False, True])
def test_jumps_of_time_are_looked_for_once_at_each_end_of_an_interval(
    turned: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = []
    look = interval.jumps_beside

    def noted(e: Engine, t: float, way: float, many: int) -> bool:
        asked.append((t, way, many))
        return look(e, t, way, many)

    monkeypatch.setattr(interval, "jumps_beside", noted)
    m = hb.Model("chopper", domain="electrical")
    m.input(gate=hb.Input(pwm={"period": "1 ms", "duty": 0.4}))
    m.add(V=hb.Se("10 V"), s=hb.One(), r=hb.R("1 kohm"), n=hb.Zero())
    m.add(C=hb.C("1 uF"), load=hb.R("1 kohm"))
    m.bond("V -> s", "n -> s" if turned else "s -> n", "s -> r", "n -> C", "n -> load")
    rules = ["off -> on when gate > 0.5", "on -> off when gate < 0.5"]
    m.machine("S", states={"off": [], "on": ["s"]}, start="off", rules=rules)
    run = hb.simulate(m, until="5.5 ms", engine="python")
    assert len(run.events) == 12
    # but for the first interval, which is entered twice, and for the end of the run
    assert len(asked) <= len(set(asked)) + 3
    # towards half of the source through both resistors, and to nothing through one
    volt = 0.0
    for pause in (0.6, 0.6, 0.6, 0.6, 0.6, 0.1):
        volt = 5.0 + (volt - 5.0) * math.exp(-0.8)
        volt *= math.exp(-pause)
    way = -1.0 if turned else 1.0
    assert run.final["C.e"] == pytest.approx(way * volt, rel=1e-8)


@pytest.mark.parametrize(("before", "after", "own"), [(-1, 1, 0), (-1, 1, 0.5), (0.5, 1, 0.8)])
@pytest.mark.parametrize("kind", ["0", "1"])
@pytest.mark.parametrize("turned", [False, True])
def test_a_piston_that_jumps_onto_what_it_has_left_does_not_draw_it_in(
    before: float, after: float, own: float, kind: str, turned: bool
) -> None:
    """Before it jumps it goes away from the body: there is no approach to be reversed.

    As by a ramp that is ever steeper the body is taken along. It was thrown at the piston by the
    speed at which they had parted, and from there rebounded.
    """

    def pushed(speed: str) -> hb.Result:
        m = hb.Model("piston")
        speed = f"-({speed})" if turned else speed
        junction, source = (hb.Zero, hb.Sf) if kind == "0" else (hb.One, hb.Se)
        m.add(c=junction(law="unilateral", restitution=0.5), s=source(speed))
        m.add(body=hb.I(1.0, p=own) if kind == "0" else hb.C(1.0, q=own))
        m.bond("c -> s" if turned else "s -> c", "c -> body")
        return hb.simulate(m, until=2.0)

    name = "body.p" if kind == "0" else "body.q"
    jump = pushed(f"if time >= 1 then {after} else {before}")
    ramp = pushed(f"{before} + ({after} - ({before}))*min(1, max(0, (time - 1)*1e4))")
    assert ramp[name].at(1.5) == pytest.approx(after, rel=1e-6)
    assert jump[name].at(1.5) == pytest.approx(after, rel=1e-9)
    lost = sum(step.energy.lost for step in jump.events[-1].steps)
    assert lost == pytest.approx(0.5 * (after - own) ** 2, rel=1e-9)
