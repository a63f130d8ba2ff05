"""Clutches, brakes, stops and friction of shafts, against closed forms."""

import math

import numpy as np
import pytest
from library.trials import after_impact, instants, kelvin_voigt, lost, trials

import hybond as hb

FRAME = hb.Submodel("rotational.frame")


def inertia(J: float = 1.0, **start: object) -> hb.Submodel:
    return hb.Submodel("rotational.inertia", J=J, **start)


def torque(newton_metres: str) -> hb.Submodel:
    return hb.Submodel("rotational.torque", inputs={"torque": newton_metres})


@pytest.mark.parametrize(("J1", "J2", "w"), [(1.0, 3.0, 10.0), (2.0, 0.5, -6.0)])
def test_a_clutch_locks_when_the_slip_ends_and_heats_by_the_relative_energy(
    J1: float, J2: float, w: float
) -> None:
    parts = {
        "a": inertia(J1, w=w),
        "c": hb.Submodel("rotational.clutch", inputs={"capacity": "if time < 1 then 0 else 5"}),
        "b": inertia(J2),
    }
    reduced = J1 * J2 / (J1 + J2)
    lock = 1 + abs(w) * reduced / 5
    for run in trials("a.shaft - c.left, c.right - b.shaft", lock + 1, **parts):
        assert run["a.speed"].at(1.0) == pytest.approx(w)
        assert run["c.torque"].at(1.1) == pytest.approx(math.copysign(5, w))
        assert instants(run)[-1] == pytest.approx(lock)
        assert run["c.heat"].at(lock + 1) == pytest.approx(reduced * w**2 / 2)
        for name in "ab":
            assert run[f"{name}.speed"].at(lock + 1) == pytest.approx(J1 * w / (J1 + J2))
        assert (run["c.locked"].at(1.1), run["c.locked"].at(lock + 0.5)) == (0, 1)
        assert run["c.slip"].at(1.0) == pytest.approx(w)
        assert lost(run) == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize("rest", [1.0, 1.5])
def test_a_locked_clutch_slips_above_what_it_holds(rest: float) -> None:
    parts = {
        "t": torque("4 [N*m/s]*time"),
        "a": inertia(1.0),
        "c": hb.Submodel("rotational.clutch", rest=rest, inputs={"capacity": "3 [N*m]"}),
        "b": inertia(3.0),
    }
    slips = rest * 3 / (4 * 0.75)
    for run in trials("t.shaft -> a.shaft, a.shaft - c.left, c.right - b.shaft", 2, **parts):
        assert instants(run) == [pytest.approx(slips)]
        assert run["c.torque"].at(slips / 2) == pytest.approx(rest * 1.5)
        speed = 4 * slips**2 / 2 / 4
        assert run["b.speed"].at(2) == pytest.approx(speed + (2 - slips))
        assert run["a.speed"].at(2) == pytest.approx(speed + 2 * (4 - slips**2) - 3 * (2 - slips))


def test_a_clutch_without_capacity_is_open() -> None:
    clutch = hb.Submodel("rotational.clutch", inputs={"capacity": 0})
    parts = {"a": inertia(1.0, w=4.0), "c": clutch, "b": inertia(1.0), "t": torque("-3")}
    for run in trials("a.shaft - c.left, c.right - b.shaft, t.shaft -> a.shaft", 2, **parts):
        assert run["a.speed"].at(2) == pytest.approx(-2)
        assert run["b.speed"].at(2) == 0


@pytest.mark.parametrize("w", [5.0, -5.0])
def test_a_brake_stops_holds_and_lets_go(w: float) -> None:
    # 0.4*0.1 m*50 N = 2 N*m; at rest 3 N*m
    parts = {
        "J": inertia(0.2, w=w),
        "b": hb.Submodel(
            "rotational.brake", mu_rest=0.6, inputs={"force": "if time < 2 then 50 else 0"}
        ),
        "wall": FRAME,
        "t": torque("if time < 1 then 0 else 2.9"),
    }
    stop = 0.2 * 5 / 2
    for run in trials("J.shaft - b.shaft, b.case - wall.shaft, t.shaft -> J.shaft", 3, **parts):
        assert instants(run)[0] == pytest.approx(stop)
        assert run["b.torque"].at(stop / 2) == pytest.approx(math.copysign(2, w))
        assert run["b.torque"].at(1.5) == pytest.approx(2.9)
        assert (run["b.locked"].at(1.5), run["b.speed"].at(1.99)) == (1, 0)
        assert run["J.speed"].at(3) == pytest.approx(2.9 / 0.2)
        assert run["b.heat"].at(3) == pytest.approx(0.1 * 25)


@pytest.mark.parametrize(("J1", "J2"), [(1.0, 3.0), (2.0, 0.1)])
def test_a_one_way_clutch_drives_and_never_brakes(J1: float, J2: float) -> None:
    parts = {
        "t": torque("6 [N*m]*cos(2 [1/s]*time)"),
        "a": inertia(J1),
        "c": hb.Submodel("rotational.one_way_clutch"),
        "b": inertia(J2),
    }
    lets_go = math.pi / 4
    for run in trials("t.shaft -> a.shaft, a.shaft - c.driver, c.driven - b.shaft", 1.5, **parts):
        assert instants(run) == [pytest.approx(lets_go)]
        assert run["c.torque"].at(0.3) == pytest.approx(J2 * 6 * math.cos(0.6) / (J1 + J2))
        assert run["b.speed"].at(1.5) == pytest.approx(3 / (J1 + J2))
        own = 3 / (J1 + J2) + 3 * (math.sin(3) - 1) / J1
        assert run["a.speed"].at(1.5) == pytest.approx(own)
        assert run["c.overrun"].at(1.5) == pytest.approx(3 / (J1 + J2) - own)
        assert (run["c.locked"].at(0.3), run["c.locked"].at(1.2)) == (1, 0)
    parts |= {"a": inertia(J1, w="8 rad/s"), "t": torque("0")}
    for run in trials("t.shaft -> a.shaft, a.shaft - c.driver, c.driven - b.shaft", 1, **parts):
        assert run["b.speed"].at(1) == pytest.approx(8 * J1 / (J1 + J2))
        assert lost(run) == pytest.approx(J1 * J2 / (J1 + J2) * 32)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("eps", [0.0, 0.3])
@pytest.mark.parametrize("teeth", [24, 90])
def test_a_ratchet_catches_at_the_last_tooth_passed(teeth: int, eps: float) -> None:
    pitch = 2 * math.pi / teeth
    ratchet = hb.Submodel("rotational.ratchet", pitch=pitch, eps=eps, k=1e-9)
    parts = {"J": inertia(0.5, w="1 rad/s"), "r": ratchet, "wall": FRAME, "t": torque("-1")}
    # up to 1/4 rad, then back to the last tooth below
    kept = math.floor(0.25 / pitch) * pitch
    caught = 0.5 + math.sqrt(0.25 - kept)
    for run in trials("J.shaft - r.wheel, r.case - wall.shaft, t.shaft -> J.shaft", 2, **parts):
        assert run["r.angle"].at(0.5) == pytest.approx(0.25)
        assert run["r.lift"].at(0.5) == pytest.approx(0.25 - kept)
        assert min(e.t for e in run.events if e.t > 0.5) == pytest.approx(caught)
        assert run["J.speed"].at(caught + 1e-9) == pytest.approx(2 * eps * (caught - 0.5), abs=1e-7)
        assert run["r.angle"].at(2) == pytest.approx(kept, abs=1e-8)
        assert run["r.torque"].at(2) == pytest.approx(1.0)
        assert run["r.holds"].at(2) == 1


def test_each_click_of_a_ratchet_costs_the_energy_of_its_spring() -> None:
    k, pitch = 0.5, math.radians(20)
    click = k * pitch**2 / 2
    ratchet = hb.Submodel("rotational.ratchet", pitch=pitch, k=k)
    parts = {"J": inertia(1.0, w=math.sqrt(2 * 3.5 * click)), "r": ratchet, "wall": FRAME}
    # the energy of three clicks and a half: over three teeth, half up the fourth, back to the third
    for run in trials("J.shaft - r.wheel, r.case - wall.shaft", 8, **parts):
        clicks = [e for e in run.events if any(s.kind == "pinnacle" for s in e.steps)]
        assert [e.steps[0].energy.lost for e in clicks[:3]] == pytest.approx([click] * 3)
        t = clicks[2].t
        assert run["J.speed"].at(t) == pytest.approx(math.sqrt(click))
        top = t + math.pi / 2 / math.sqrt(k)
        assert run["r.angle"].at(top) == pytest.approx(pitch * (3 + math.sqrt(0.5)))
        assert run["r.angle"].at(8) == pytest.approx(3 * pitch)
        assert lost(run) == pytest.approx(3.5 * click)


@pytest.mark.parametrize(("J1", "J2", "eps"), [(1.0, 1.0, 1.0), (3.0, 1.0, 0.5), (1.0, 2.0, 0.0)])
@pytest.mark.parametrize("way", [1, -1])
def test_backlash_of_shafts_is_a_collision_of_flanks(
    J1: float, J2: float, eps: float, way: int
) -> None:
    parts = {
        "a": inertia(J1, w=2.0 * way),
        "p": hb.Submodel("rotational.backlash", play="0.4 rad", eps=eps),
        "b": inertia(J2),
    }
    after = after_impact(J1, 2.0 * way, J2, 0.0, eps)
    for run in trials("a.shaft - p.left, p.right - b.shaft", 0.15, **parts):
        assert instants(run) == [pytest.approx(0.1)]
        assert [run[f"{k}.speed"].at(0.15) for k in "ab"] == pytest.approx(after, abs=1e-10)
        assert lost(run) == pytest.approx((1 - eps**2) * J1 * J2 / (J1 + J2) * 2, abs=1e-10)
        assert run["p.offset"].at(0.05) == pytest.approx(-0.1 * way)
        assert run["p.torque"].at(0.05) == 0 and run["p.driven"].at(0.05) == 0


@pytest.mark.parametrize(("J1", "J2", "k", "d"), [(1, 1, 1e3, 0), (2, 0.5, 1e4, 15)])
@pytest.mark.parametrize("way", [1, -1])
def test_elastic_backlash_of_shafts_is_a_soft_collision(
    J1: float, J2: float, k: float, d: float, way: int
) -> None:
    parts = {
        "a": inertia(J1, w=2.0 * way),
        "p": hb.Submodel("rotational.elastic_backlash", play="0.4 rad", k=k, d=d),
        "b": inertia(J2),
    }
    eps, time = kelvin_voigt(J1 * J2 / (J1 + J2), k, d)
    after, end = after_impact(J1, 2.0 * way, J2, 0.0, eps), 0.1 + 1.05 * time
    for run in trials("a.shaft - p.left, p.right - b.shaft", end, **parts):
        assert instants(run) == pytest.approx([0.1, 0.1 + time])
        assert [run[f"{k}.speed"].at(end) for k in "ab"] == pytest.approx(after, abs=1e-8)
        assert way * run["p.torque"].at(0.1 + time / 2) > 0


@pytest.mark.parametrize("eps", [1.0, 0.6])
def test_a_shaft_swings_between_end_stops(eps: float) -> None:
    parts = {
        "J": inertia(2.0, w="-3 rad/s"),
        "s": hb.Submodel("rotational.end_stop", low="-10 deg", high="20 deg", eps=eps),
        "wall": FRAME,
    }
    way = math.radians(30)
    first = way / 9
    for run in trials("J.shaft - s.shaft, s.case - wall.shaft", 0.55, **parts):
        assert instants(run)[:2] == pytest.approx([first, first + way / (3 * eps)])
        assert run["J.speed"].at(0.3 if eps < 1 else 0.2) == pytest.approx(3 * eps)
        assert run["s.angle"].at(first) == pytest.approx(math.radians(-10))
        assert run["s.torque"].at(0.05) == 0


@pytest.mark.parametrize(("k", "d"), [(200.0, 0.0), (200.0, 8.0)])
@pytest.mark.parametrize("way", [1, -1])
def test_elastic_end_stops_of_a_shaft(k: float, d: float, way: int) -> None:
    parts = {
        "J": inertia(2.0, w=3.0 * way),
        "s": hb.Submodel("rotational.elastic_end_stop", low=-0.3, high=0.3, k=k, d=d),
        "wall": FRAME,
    }
    eps, time = kelvin_voigt(2.0, k, d)
    for run in trials("J.shaft - s.shaft, s.case - wall.shaft", 0.5, **parts):
        assert instants(run)[:2] == pytest.approx([0.1, 0.1 + time])
        assert run["J.speed"].at(0.1 + time) == pytest.approx(-3 * way * eps)
        assert way * run["s.torque"].at(0.1 + time / 2) > 0


@pytest.mark.parametrize("w", [4.0, -4.0])
def test_dry_friction_stops_a_shaft_and_holds_it(w: float) -> None:
    parts = {
        "J": inertia(0.5, w=w),
        "c": hb.Submodel("rotational.coulomb_friction", rest=1.5, inputs={"limit": "2 [N*m]"}),
        "wall": FRAME,
        "t": torque(f"if time < 1 then 0 else {math.copysign(2, w)}*time/(1 [s])"),
    }
    for run in trials("J.shaft - c.shaft, c.case - wall.shaft, t.shaft -> J.shaft", 2, **parts):
        # stops at 1 s, just when a torque begins that is as large as sliding friction
        assert instants(run)[-1] == pytest.approx(1.5)
        assert run["c.torque"].at(0.5) == pytest.approx(math.copysign(2, w))
        assert run["c.power"].at(0.5) == pytest.approx(2 * 2.0)
        assert run["c.torque"].at(1.3) == pytest.approx(math.copysign(2.6, w))
        assert (run["c.sticks"].at(1.3), run["c.slip"].at(1.3)) == (1, 0)
        assert abs(run["J.speed"].at(2)) == pytest.approx(((4 - 2.25) - 2 * 0.5) / 0.5)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("d", [0.0, 2.0])
def test_a_bearing_with_stribeck_friction(d: float) -> None:
    bearing = hb.Submodel("rotational.stribeck_friction", M=1, M_rest=2.5, w_s=0.1, d=d)
    parts = {"c": bearing, "wall": FRAME}
    u = hb.Submodel("rotational.speed", inputs={"speed": "-1 + 2*time/(1 [s])"})
    t = np.array([0.1, 0.47, 0.49, 0.51, 0.6, 0.9])
    w = 2 * t - 1
    taken = np.sign(w) * (1 + 1.5 * np.exp(-((w / 0.1) ** 2))) + d * w
    for run in trials("u.shaft - c.shaft, c.case - wall.shaft", 1, u=u, **parts):
        assert run["c.torque"].at(t) == pytest.approx(taken, rel=1e-9)
        assert run["c.power"].at(0.9) == pytest.approx(taken[-1] * w[-1])
    parts |= {"J": inertia(0.5), "t": torque("1 [N*m/s]*time")}
    for run in trials("J.shaft - c.shaft, c.case - wall.shaft, t.shaft -> J.shaft", 2.55, **parts):
        assert instants(run) == [pytest.approx(2.5)]
        assert (run["c.sticks"].at(2.4), run["c.slip"].at(2.4)) == (1, 0)
        assert run["c.slip"].at(2.55) > 0
