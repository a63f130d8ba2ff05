"""Contacts, friction and ropes between bodies, against closed forms."""

import math

import numpy as np
import pytest
from library.trials import after_impact, instants, kelvin_voigt, lost, trials

import hybond as hb

FRAME = hb.Submodel("translational.frame")


def mass(m: float = 1.0, **start: object) -> hb.Submodel:
    return hb.Submodel("translational.mass", m=m, **start)


def push(newtons: str) -> hb.Submodel:
    return hb.Submodel("translational.force", inputs={"force": newtons})


BODIES = [(1.0, 3.0, 2.0, -1.0), (5.0, 2.0, 0.5, 0.5), (0.3, 0.0, 1.0, -2.0)]


@pytest.mark.parametrize("eps", [0.0, 0.4, 1.0])
@pytest.mark.parametrize(("m1", "v1", "m2", "v2"), BODIES)
def test_a_collision_keeps_momentum_and_loses_one_minus_eps_squared(
    m1: float, v1: float, m2: float, v2: float, eps: float
) -> None:
    parts = {
        "a": mass(m1, v=v1),
        "c": hb.Submodel("translational.elastic_collision", eps=eps, distance="2 m"),
        "b": mass(m2, v=v2),
    }
    w, reduced = v1 - v2, m1 * m2 / (m1 + m2)
    after = after_impact(m1, v1, m2, v2, eps)
    for run in trials("a.flange - c.left, c.right - b.flange", 3, **parts):
        assert instants(run)[0] == pytest.approx(2 / w, rel=1e-10)
        assert run["a.speed"].at(3) == pytest.approx(after[0], abs=1e-10)
        assert run["b.speed"].at(3) == pytest.approx(after[1], abs=1e-10)
        assert lost(run) == pytest.approx((1 - eps**2) * reduced * w**2 / 2, abs=1e-9)
        assert run["c.gap"].at(3) == pytest.approx(eps * w * (3 - 2 / w), abs=1e-9)
        assert run["c.force"].at(1.0, side="left") == 0


def test_bodies_that_are_pressed_together_stay_in_contact_until_they_are_pulled() -> None:
    parts = {
        "a": mass(1.0),
        "c": hb.Submodel("translational.elastic_collision", eps=0.5, distance=0),
        "b": mass(3.0),
        "f": push("8 [N]*(1 - time/(1 [s]))"),
    }
    for run in trials("a.flange - c.left, c.right - b.flange, a.flange -> f.flange", 2, **parts):
        assert run["c.force"].at(0.5) == pytest.approx(3.0)
        assert run["c.touches"].at(0.5) == 1
        assert instants(run) == [pytest.approx(1.0, rel=1e-9)]
        assert run["b.speed"].at(2) == pytest.approx(1.0)
        assert run["a.speed"].at(2) == pytest.approx(1.0 - 4.0)


@pytest.mark.parametrize(("m1", "v1", "m2", "v2"), BODIES)
def test_bodies_that_collide_plastically_go_on_as_one(
    m1: float, v1: float, m2: float, v2: float
) -> None:
    parts = {
        "a": mass(m1, v=v1),
        "c": hb.Submodel("translational.plastic_collision", distance="2 m"),
        "b": mass(m2, v=v2),
        "f": push("if time < 2 then 0 else -4"),
    }
    w, reduced = v1 - v2, m1 * m2 / (m1 + m2)
    together = after_impact(m1, v1, m2, v2, 0)[0]
    for run in trials("a.flange - c.left, c.right - b.flange, a.flange -> f.flange", 3, **parts):
        assert instants(run)[0] == pytest.approx(2 / w, rel=1e-10)
        assert lost(run) == pytest.approx(reduced * w**2 / 2, rel=1e-9)
        for name in "ab":
            assert run[f"{name}.speed"].at(2) == pytest.approx(together)
            assert run[f"{name}.speed"].at(3) == pytest.approx(together - 4 / (m1 + m2))
        assert run["c.force"].at(2.5) == pytest.approx(-4 * m2 / (m1 + m2))
        assert run["c.holds"].at(2.5) == 1


@pytest.mark.parametrize("hold", [0.0, 1.5])
def test_a_pull_above_its_hold_parts_a_coupling(hold: float) -> None:
    parts = {
        "a": mass(1.0, v="1 m/s"),
        "c": hb.Submodel("translational.plastic_collision", distance="1 m", hold=hold),
        "b": mass(3.0),
        "f": push("if time < 2 then 0 else 2*(time/(1 [s]) - 2)"),
    }
    # together from 1 s; the coupling bears a quarter of what pulls at b
    part = 2 + 4 * hold / 2
    for run in trials("a.flange - c.left, c.right - b.flange, b.flange -> f.flange", 6, **parts):
        times = instants(run)
        assert times[0] == pytest.approx(1.0)
        assert times[-1] == pytest.approx(part, rel=1e-9)
        speed = 0.25 + (part - 2) ** 2 / 4
        assert run["a.speed"].at(6) == pytest.approx(speed)
        assert run["b.speed"].at(6) == pytest.approx(speed + (16 - (part - 2) ** 2) / 3)


@pytest.mark.parametrize("eps", [1.0, 0.5])
@pytest.mark.parametrize("wall", ["case", "flange"])
def test_a_mass_flies_to_and_fro_between_end_stops(eps: float, wall: str) -> None:
    parts = {
        "m": mass(2.0, v="3 m/s"),
        "s": hb.Submodel("translational.end_stop", low="-0.2 m", high="0.4 m", eps=eps),
        "wall": FRAME,
    }
    free, first = ("flange", 0.4) if wall == "case" else ("case", 0.2)
    times, speed, t = [], 3.0, first / 3.0
    while t < 1.2:
        times.append(t)
        speed *= eps
        t += 0.6 / speed
    for run in trials(f"m.flange - s.{free}, s.{wall} - wall.flange", 1.2, **parts):
        assert instants(run) == pytest.approx(times, rel=1e-9)
        assert abs(run["m.speed"].at(1.2)) == pytest.approx(speed)
        inside = run["s.position"].at(np.linspace(0, 1.2, 50))
        assert inside.min() > -0.2 - 1e-9 and inside.max() < 0.4 + 1e-9


def test_a_mass_that_is_pressed_against_an_end_stop_rests_there() -> None:
    parts = {
        "m": mass(2.0),
        "s": hb.Submodel("translational.end_stop", eps=0, high="0.09 m"),
        "f": push("5 [N]*cos(1 [1/s]*time)"),
        "wall": FRAME,
    }
    hit = math.acos(1 - 0.09 * 2 / 5)
    for run in trials(
        "m.flange - s.flange, s.case - wall.flange, f.flange -> m.flange", 2, **parts
    ):
        assert instants(run) == [pytest.approx(hit), pytest.approx(math.pi / 2)]
        assert run["s.force"].at(1) == pytest.approx(5 * math.cos(1))
        assert run["wall.force"].at(1) == pytest.approx(-5 * math.cos(1))
        assert run["m.speed"].at(2) == pytest.approx(2.5 * (math.sin(2) - 1))


PADS = [(2.0, 200.0, 0.0), (2.0, 200.0, 8.0), (0.5, 1e4, 20.0)]


@pytest.mark.sampled(3)
@pytest.mark.parametrize(("m", "k", "d"), PADS)
@pytest.mark.parametrize("way", [1, -1])
def test_an_elastic_end_stop_gives_back_what_its_damper_leaves(
    m: float, k: float, d: float, way: int
) -> None:
    parts = {
        "m": mass(m, v=3.0 * way),
        "s": hb.Submodel("translational.elastic_end_stop", low=-0.3, high=0.3, k=k, d=d),
        "wall": FRAME,
    }
    eps, time = kelvin_voigt(m, k, d)
    for run in trials("m.flange - s.flange, s.case - wall.flange", 0.5, **parts):
        assert instants(run)[:2] == pytest.approx([0.1, 0.1 + time], rel=1e-9)
        assert run["m.speed"].at(0.1 + time) == pytest.approx(-3 * way * eps, rel=1e-8)
        push = way * run["s.force"].at(np.linspace(0, 0.1 + 1.1 * time, 60))
        assert push.min() >= 0 and push.max() > 3 * math.sqrt(k * m) * eps * 0.99


def test_an_elastic_end_stop_may_begin_pressed() -> None:
    parts = {
        "m": mass(1.0, x="0.2 m"),
        "s": hb.Submodel("translational.elastic_end_stop", start="0.2 m", k="100 N/m"),
        "wall": FRAME,
    }
    for run in trials("m.flange - s.flange, s.case - wall.flange", 0.3, **parts):
        assert run["s.force"].at(0) == pytest.approx(10.0)
        assert instants(run) == [pytest.approx(math.pi / 20)]
        assert run["m.speed"].at(0.3) == pytest.approx(-1.0)


@pytest.mark.parametrize(("m1", "m2", "eps"), [(1.0, 1.0, 1.0), (3.0, 1.0, 0.5), (1.0, 2.0, 0.0)])
def test_backlash_lets_a_drive_go_free_and_then_strikes(m1: float, m2: float, eps: float) -> None:
    parts = {
        "a": mass(m1, v="2 m/s"),
        "p": hb.Submodel("translational.backlash", play="0.2 m", start="0.1 m", eps=eps),
        "b": mass(m2),
    }
    after = after_impact(m1, 2.0, m2, 0.0, eps)
    for run in trials("a.flange - p.left, p.right - b.flange", 0.15, **parts):
        assert instants(run) == [pytest.approx(0.1)]
        speeds = run["a.speed"].at(0.15), run["b.speed"].at(0.15)
        assert speeds == pytest.approx(after, abs=1e-10)
        assert lost(run) == pytest.approx((1 - eps**2) * m1 * m2 / (m1 + m2) * 2, abs=1e-10)
        assert run["p.offset"].at(0.15) == pytest.approx(-0.1 + 2 * eps * 0.05, abs=1e-10)


def test_backlash_delays_a_reversal() -> None:
    parts = {
        "u": hb.Submodel("translational.speed", inputs={"speed": "if time < 1 then 2 else -1"}),
        "p": hb.Submodel("translational.backlash", play="0.5 m"),
        "b": mass(3.0),
        "f": push("-2"),
    }
    # at rest against the lower flank from 0.14 s on; from 1 s the load follows freely
    for run in trials("u.flange - p.left, p.right - b.flange, b.flange -> f.flange", 1.2, **parts):
        assert run["p.force"].at(0.9) == pytest.approx(2.0)
        assert run["p.driven"].at(0.9) == 1
        assert run["p.offset"].at(0.9) == pytest.approx(-0.25)
        # from 1 s the load goes on at 2 m/s and the drive comes back at -1 m/s
        crossed = 1 + (3 - math.sqrt(9 - 2 * 2 / 3 * 0.5)) / (2 / 3)
        assert instants(run)[-1] == pytest.approx(crossed)
        assert run["p.driven"].at(1.1) == 0
        # stopped to the drive's speed there, it is pulled away from the flank at once
        assert run["b.speed"].at(1.2) == pytest.approx(-1.0 - (1.2 - crossed) * 2 / 3)


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("m1", "m2", "k", "d"), [(1, 1, 1e3, 0), (2, 0.5, 1e4, 15), (1, 4, 5e3, 0)]
)
@pytest.mark.parametrize("way", [1, -1])
def test_elastic_backlash_is_a_soft_collision(
    m1: float, m2: float, k: float, d: float, way: int
) -> None:
    parts = {
        "a": mass(m1, v=2.0 * way),
        "p": hb.Submodel("translational.elastic_backlash", play="0.4 m", k=k, d=d),
        "b": mass(m2),
    }
    eps, time = kelvin_voigt(m1 * m2 / (m1 + m2), k, d)
    after = after_impact(m1, 2.0 * way, m2, 0.0, eps)
    for run in trials("a.flange - p.left, p.right - b.flange", 0.1 + 1.05 * time, **parts):
        assert instants(run) == pytest.approx([0.1, 0.1 + time])
        end = 0.1 + 1.05 * time
        assert [run[f"{n}.speed"].at(end) for n in "ab"] == pytest.approx(after, abs=1e-8)
        assert way * run["p.force"].at(0.1 + time / 2) > 0


@pytest.mark.sampled(3)
@pytest.mark.parametrize(("mu", "rest"), [(0.3, 0.3), (0.2, 0.5), (0.0, 0.0)])
@pytest.mark.parametrize("way", [1, -1])
def test_a_block_slides_to_rest_and_breaks_loose(mu: float, rest: float, way: int) -> None:
    parts = {
        "m": mass(2.0, v=0.5 * way),
        "c": hb.Submodel(
            "translational.coulomb_friction", mu=mu, mu_rest=rest, inputs={"normal": "20 N"}
        ),
        "f": push(f"if time < 1 then 0 else {-8 * way}*(time/(1 [s]) - 1)"),
        "wall": FRAME,
    }
    stop = 0.5 / (mu * 10) if mu else math.inf
    for run in trials(
        "wall.flange - c.left, c.right - m.flange, m.flange -> f.flange", 3.5, **parts
    ):
        if not mu:
            assert way * run["m.speed"].at(3.5) == pytest.approx(0.5 - 8 * 2.5**2 / 2 / 2)
            continue
        assert way * run["m.speed"].at(stop / 2) == pytest.approx(0.25)
        assert way * run["c.force"].at(stop / 2) == pytest.approx(20 * mu)
        loose = 1 + 20 * rest / 8
        times = instants(run)
        assert times[0] == pytest.approx(stop) and times[-1] == pytest.approx(loose)
        assert run["c.sticks"].at(0.9) == 1 and run["c.sticks"].at(3.45) == 0
        s, s0 = 2.5, loose - 1
        speed = (8 * (s**2 - s0**2) / 2 - 20 * mu * (s - s0)) / 2
        assert -way * run["m.speed"].at(3.5) == pytest.approx(speed, rel=1e-8)


def test_friction_heats_by_what_is_lost() -> None:
    parts = {
        "a": mass(1.0, v="4 m/s"),
        "c": hb.Submodel("translational.coulomb_friction", inputs={"normal": "10 [N]"}),
        "b": mass(3.0),
    }
    for run in trials("a.flange - c.right, c.left - b.flange", 2, **parts):
        # relative deceleration 3 (1 + 1/3): together after 1 s
        assert instants(run) == [pytest.approx(1.0)]
        assert run["a.speed"].at(2) == pytest.approx(1.0)
        assert run["c.power"].at(0.5) == pytest.approx(3.0 * 2.0)
        assert run["c.slip"].at(2) == pytest.approx(0, abs=1e-12)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("d", [0.0, 2.0])
def test_stribeck_friction_at_steady_speeds_and_from_rest(d: float) -> None:
    friction = hb.Submodel("translational.stribeck_friction", F=1, F_rest=2.5, w_s=0.1, d=d)
    parts = {"c": friction, "wall": FRAME}
    u = hb.Submodel("translational.speed", inputs={"speed": "-1 + 2*time/(1 [s])"})
    t = np.array([0.1, 0.47, 0.49, 0.51, 0.6, 0.9])
    w = 2 * t - 1
    force = np.sign(w) * (1 + 1.5 * np.exp(-((w / 0.1) ** 2))) + d * w
    for run in trials("wall.flange - c.left, c.right - u.flange", 1, u=u, **parts):
        assert run["c.force"].at(t) == pytest.approx(force, rel=1e-9)
        assert run["c.power"].at(0.9) == pytest.approx(force[-1] * w[-1])
    parts |= {"m": mass(0.5), "f": push("1 [N/s]*time")}
    for run in trials(
        "wall.flange - c.left, c.right - m.flange, m.flange -> f.flange", 2.6, **parts
    ):
        assert instants(run) == [pytest.approx(2.5)]
        assert run["c.force"].at(2.4) == pytest.approx(2.4)
        assert run["c.sticks"].at(2.4) == 1
        assert run["c.slip"].at(2.6) > 0


@pytest.mark.parametrize("eps", [0.0, 0.7])
@pytest.mark.parametrize(("m1", "m2"), [(1.0, 1.0), (4.0, 0.5)])
def test_a_rope_tows_once_it_is_taut(m1: float, m2: float, eps: float) -> None:
    parts = {
        "a": mass(m1),
        "r": hb.Submodel("translational.rope", reserve="0.6 m", eps=eps),
        "b": mass(m2, v="2 m/s"),
    }
    slow, fast = after_impact(m2, 2.0, m1, 0.0, eps)
    for run in trials("a.flange - r.left, r.right - b.flange", 0.5, **parts):
        assert instants(run)[0] == pytest.approx(0.3)
        assert run["b.speed"].at(0.5) == pytest.approx(slow, abs=1e-12)
        assert run["a.speed"].at(0.5) == pytest.approx(fast, abs=1e-12)
        assert run["r.slack"].at(0.5) == pytest.approx(2 * eps * 0.2, abs=1e-10)
        assert run["r.taut"].at(0.2) == 0


def test_a_rope_pulls_and_does_not_push() -> None:
    parts = {
        "a": mass(1.0),
        "r": hb.Submodel("translational.rope"),
        "b": mass(2.0),
        "f": push("3 [N]*cos(pi*time/(1 [s]))"),
    }
    for run in trials("a.flange - r.left, r.right - b.flange, b.flange -> f.flange", 1, **parts):
        assert run["r.tension"].at(0.25) == pytest.approx(math.cos(math.pi / 4))
        assert run["r.taut"].at(0.25) == 1
        assert instants(run) == [pytest.approx(0.5)]
        assert run["r.tension"].at(0.75) == 0
        assert run["a.speed"].at(1) == pytest.approx(1 / math.pi)
        assert run["b.speed"].at(1) == pytest.approx(1 / math.pi - 3 / 2 / math.pi)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("d", [0.0, 6.0])
def test_a_jumper_on_an_elastic_rope(d: float) -> None:
    parts = {
        "bridge": FRAME,
        "r": hb.Submodel("translational.elastic_rope", k="60 N/m", d=d, reserve="5 m"),
        "m": mass(10.0),
        "w": hb.Submodel("translational.weight", m=10.0, g="10 m/s^2"),
    }
    # up is positive: the rope's right end is the bridge
    deep = (100 + math.sqrt(100**2 + 2 * 60 * 500)) / 60
    for run in trials(
        "m.flange - r.left, r.right - bridge.flange, m.flange - w.flange", 8, **parts
    ):
        assert instants(run)[0] == pytest.approx(1.0)
        pull = run["r.tension"].at(np.linspace(0, 8, 200))
        assert pull.min() >= 0
        fall = -run["m.position"].at(np.linspace(1, 4, 3001)).min()
        if d == 0:
            assert fall == pytest.approx(5 + deep, rel=1e-6)
            assert run["r.tension"].at(0.5) == 0
        else:
            assert 5 + 100 / 60 < fall < 5 + deep
            assert run["r.elongation"].at(8) > 0


def test_an_elastic_rope_may_begin_stretched() -> None:
    parts = {
        "wall": FRAME,
        "r": hb.Submodel("translational.elastic_rope", k="100 N/m", reserve="-0.2 m"),
        "m": mass(1.0),
    }
    for run in trials("wall.flange - r.left, r.right - m.flange", 1, **parts):
        assert run["r.tension"].at(0) == pytest.approx(20.0)
        assert instants(run) == [pytest.approx(math.pi / 20)]
        assert run["m.speed"].at(1) == pytest.approx(-2.0)
