"""Plane mechanics: bodies, joints, floor and wheel, against closed forms and what is conserved."""

import math

import numpy as np
import pytest
from library.bench import every_way
from library.trials import instants, lost, trials
from scipy.integrate import quad
from scipy.special import ellipk

import hybond as hb

G = 9.81


def rod(**start: object) -> hb.Submodel:
    return hb.Submodel("planar.rod", **start)


def floor(height: str, **values: object) -> hb.Submodel:
    return hb.Submodel("planar.floor", inputs={"height": height}, **values)


@pytest.mark.slow
@pytest.mark.parametrize(("l", "start"), [(1.0, 60.0), (0.4, 120.0)])
def test_a_rod_on_a_pin_is_a_pendulum(l: float, start: float) -> None:
    # hanging is -90 deg; J about the end is m l^2/3
    angle = math.radians(start - 90)
    parts = {
        "r": rod(
            l=l,
            m=2.0,
            angle0=angle,
            x0=l / 2 * math.cos(angle),
            y0=l / 2 * math.sin(angle),
        ),
        "f": hb.Submodel("planar.frame"),
    }
    quarter = math.sqrt(2 * l / 3 / G) * ellipk(math.sin(math.radians(start) / 2) ** 2)
    for run in trials("r.ax - f.vx, r.ay - f.vy", quarter, rtol=1e-8, **parts):
        assert run["r.angle"].at(quarter) == pytest.approx(-math.pi / 2, abs=1e-6)
        # a rod at its lowest point: the pin carries its weight and the centripetal force
        speed2 = 3 * G / l * (1 - math.cos(math.radians(start)))
        assert run["f.force_y"].at(quarter) == pytest.approx(2 * (G + speed2 * l / 2), rel=1e-5)
        assert run["f.force_x"].at(quarter) == pytest.approx(0, abs=1e-4)
        assert run["r.x_a"].at(quarter) == pytest.approx(0, abs=1e-7)
        assert run["r.y_a"].at(quarter) == pytest.approx(0, abs=1e-7)
        energy = run["r.energy"].at(np.linspace(0, quarter, 7))
        assert energy == pytest.approx(2 * G * l / 2 * math.sin(angle), abs=1e-6)


@pytest.mark.sampled(1)
@pytest.mark.parametrize(("a", "b"), [(0.0, 0.5), (-0.3, 0.4)])
def test_a_body_on_a_pin_through_a_point_has_steiners_inertia(a: float, b: float) -> None:
    parts = {
        "body": hb.Submodel("planar.rigid_body", m=2.0, J=0.1, x0=-a, y0=-b),
        "p": hb.Submodel(
            "planar.point_on_body",
            a=a,
            b=b,
            inputs={"angle": "body.angle", "body_x": "body.x", "body_y": "body.y"},
        ),
        "f": hb.Submodel("planar.frame"),
    }
    joints = "body.vx - p.vx, body.vy - p.vy, body.turn - p.turn, p.px - f.vx, p.py - f.vy"
    # the centre hangs the distance 1/2 below the point, aside by -a
    hang = math.atan2(-a, b)
    quarter = math.sqrt((0.1 + 2.0 * 0.25) / (2.0 * G * 0.5)) * ellipk(math.sin(hang / 2) ** 2)
    for run in trials(joints, 0.5, rtol=1e-7, **parts):
        if hang:
            assert run["body.angle"].at(quarter) == pytest.approx(-hang, abs=1e-5)
        else:
            assert run["body.angle"].at(0.5) == 0
            assert run["f.force_y"].at(0.3) == pytest.approx(2 * G)
        assert run["p.x"].at(0.5) == pytest.approx(0, abs=1e-6)
        assert run["p.y"].at(0.5) == pytest.approx(0, abs=1e-6)


@pytest.mark.slow
def test_a_free_body_flies_a_parabola_and_turns_evenly() -> None:
    parts = {
        "b": hb.Submodel("planar.rigid_body", vx0=2, vy0=3, w0=4, x0=1, y0=5),
        "p": hb.Submodel(
            "planar.point_on_body",
            a=0.7,
            b=0.2,
            inputs={"angle": "b.angle", "body_x": "b.x", "body_y": "b.y"},
        ),
    }
    t = np.linspace(0, 1, 7)
    c, s = np.cos(4 * t), np.sin(4 * t)
    for run in trials("b.vx - p.vx, b.vy - p.vy, b.turn - p.turn", 1, rtol=1e-8, **parts):
        assert run["b.y"].at(t) == pytest.approx(5 + 3 * t - G * t**2 / 2, abs=1e-9)
        assert run["p.x"].at(t) == pytest.approx(1 + 2 * t + 0.7 * c - 0.2 * s)
        assert run["p.px.f"].at(t) == pytest.approx(2 - 4 * (0.7 * s + 0.2 * c))
        assert run["p.py.f"].at(t) == pytest.approx(3 - G * t + 4 * (0.7 * c - 0.2 * s))
        assert run["b.speed"].at(1) == pytest.approx(math.hypot(2, 3 - G))
        assert run["b.energy"].at(t) == pytest.approx(6.5 + 8 + 5 * G)


def double_pendulum(w: float, pin: dict[str, object]) -> dict[str, object]:
    return {
        "r": rod(m=2.0, x0=0.5),
        "s": rod(m=1.0, l=0.6, x0=1.3, w0=w, vy0=0.3 * w),
        "f": hb.Submodel("planar.frame"),
        "j": hb.Submodel("planar.revolute_joint"),
        **pin,
    }


DOUBLE = "r.ax - f.vx, r.ay - f.vy, r.bx - j.ax, r.by - j.ay, r.turn - j.aw, "
DOUBLE += "s.ax - j.bx, s.ay - j.by, s.turn - j.bw"


@pytest.mark.slow
def test_a_double_pendulum_keeps_its_energy_and_holds_together() -> None:
    m = hb.Model("double pendulum", domain="translational")
    m.add(**double_pendulum(0.0, {}))
    ways = every_way(m, *DOUBLE.split(", "))
    for way in (ways[0], ways[1]):
        run = hb.simulate(way, until=1.0, rtol=1e-8, atol=1e-10)
        assert run.audit().holds()
        t = np.linspace(0, 1, 9)
        assert run["r.energy + s.energy"].at(t) == pytest.approx(0, abs=2e-6)
        assert run["r.x_b - s.x_a"].at(1) == pytest.approx(0, abs=1e-8)
        assert run["r.y_b - s.y_a"].at(1) == pytest.approx(0, abs=1e-8)
        # both angles swing by more than a quarter of a turn
        assert run["r.angle"].at(1) < -1.5 and abs(run["s.angle"].at(t)).max() > 1.5


@pytest.mark.slow
def test_a_double_pendulum_begins_with_the_accelerations_of_lagrange() -> None:
    # level and at rest: angles q1, q2, inertia matrix and torques of gravity
    l1, l2, m1, m2 = 1.0, 0.6, 2.0, 1.0
    M = np.array(
        [
            [m1 * l1**2 / 3 + m2 * l1**2, m2 * l1 * l2 / 2],
            [m2 * l1 * l2 / 2, m2 * l2**2 / 3],
        ]
    )
    a1, a2 = np.linalg.solve(M, [-(m1 * l1 / 2 + m2 * l1) * G, -m2 * l2 / 2 * G])
    m = hb.Model("double pendulum", domain="translational")
    m.add(**double_pendulum(0.0, {}))
    for way in every_way(m, *DOUBLE.split(", "))[1:3]:
        run = hb.simulate(way, until=0.001)
        assert run["r.inertia.e"].at(0) == pytest.approx(a1 / 6)
        assert run["s.inertia.e"].at(0) == pytest.approx(a2 * 0.36 / 12)
        held = m2 * (a1 * l1 + a2 * l2 / 2 + G)
        assert run["j.force_y"].at(0) == pytest.approx(-held)
        assert run["j.force_x"].at(0) == pytest.approx(0, abs=1e-9)


@pytest.mark.slow
def test_a_spring_at_a_pin_turns_two_rods_against_each_other() -> None:
    pin = {"c": hb.Submodel("rotational.torsion_spring", k=3.0, twist0=0.4)}
    parts = double_pendulum(0.0, {**pin, "wall": hb.Submodel("rotational.frame")})
    del parts["f"]
    m = hb.Model("two rods in space", domain="translational")
    m.add(**{**parts, "r": rod(m=2.0, x0=0.5, g=0), "s": rod(m=1.0, l=0.6, x0=1.3, g=0)})
    m.bond("r.bx -> j.ax", "r.by -> j.ay", "r.turn -> j.aw", "s.ax -> j.bx", "s.ay -> j.by")
    m.bond("s.turn -> j.bw", "c.left -> wall.shaft")
    for way in every_way(m, "j.pin - c.right"):
        run = hb.simulate(way, until=0.5, rtol=1e-8, atol=1e-10)
        assert run.audit().holds()
        energy = run["r.energy + s.energy"].at(0.5) + 1.5 * run["c.twist"].at(0.5) ** 2
        assert energy == pytest.approx(1.5 * 0.16, rel=1e-6)
        assert run["j.torque"].at(0) == pytest.approx(1.2)
        momentum = [run[f"2*r.{v}.f + s.{v}.f"].at(0.5) for v in ("vx", "vy")]
        assert momentum == pytest.approx([0, 0], abs=1e-9)
        turning = (
            "r.turn.f/6 + s.turn.f*0.03 + 2*(r.x*r.vy.f - r.y*r.vx.f) + s.x*s.vy.f - s.y*s.vx.f"
        )
        assert run[turning].at(0.5) == pytest.approx(0, abs=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("start", [60.0, 85.0])
def test_a_rod_falls_on_a_smooth_floor(start: float) -> None:
    parts = {
        "r": rod(angle0=math.radians(start), y0=0.5 * math.sin(math.radians(start))),
        "f": floor("r.y_a", mu=0),
    }
    a0 = math.radians(start)

    def slowness(a: float) -> float:
        """Return dt/da from the energy: m y'^2/2 + J w^2/2 = m g (y0 - y)."""
        return math.sqrt((math.cos(a) ** 2 / 4 + 1 / 12) / (G * (math.sin(a0) - math.sin(a))))

    # u = sqrt(a0 - a) takes the singular begin away
    time = quad(lambda u: 2 * u * slowness(a0 - u * u), 0, math.sqrt(a0 - 0.2))[0]
    for run in trials("r.ax - f.vx, r.ay - f.vy", time, rtol=1e-8, **parts):
        assert run["r.angle"].at(time) == pytest.approx(0.2, abs=1e-6)
        assert run["r.y_a"].at(time) == pytest.approx(0, abs=1e-8)
        assert run["r.vx.f"].at(time) == pytest.approx(0, abs=1e-12)
        first = G / (1 + 3 * math.cos(a0) ** 2)
        assert run["f.normal"].at(0) == pytest.approx(first)
        assert run["f.touches"].at(time / 2) == 1


@pytest.mark.sampled(1)
@pytest.mark.parametrize("eps", [0.0, 0.5, 1.0])
def test_the_tip_of_a_rod_strikes_a_smooth_floor(eps: float) -> None:
    angle, drop = 0.5, 0.2
    parts = {
        "r": rod(angle0=angle, y0=0.5 * math.sin(angle) + drop, vx0="1 m/s"),
        "f": floor("r.y_a", mu=0, eps=eps),
    }
    hit = math.sqrt(2 * drop / G)
    speed = G * hit
    arm = 0.5 * math.cos(angle)
    impulse = (1 + eps) * speed / (1 + 12 * arm**2)
    for run in trials("r.ax - f.vx, r.ay - f.vy", hit + 0.05, rtol=1e-8, **parts):
        assert instants(run)[0] == pytest.approx(hit)
        assert run["r.vy.f"].at(hit) == pytest.approx(impulse - speed)
        assert run["r.turn.f"].at(hit) == pytest.approx(-impulse * arm * 12)
        assert run["r.ay.f"].at(hit) == pytest.approx(eps * speed, abs=1e-9)
        gone = (1 - eps**2) * speed**2 / 2 / (1 + 12 * arm**2)
        assert lost(run) == pytest.approx(gone, abs=1e-9)
        assert run["f.friction"].at(hit + 0.01) == pytest.approx(0, abs=1e-15)


@pytest.mark.sampled(1)
@pytest.mark.parametrize(("mu", "sticks"), [(0.7, True), (0.1, False)])
def test_a_tip_sticks_in_an_impact_if_friction_is_enough(mu: float, sticks: bool) -> None:
    # the ratio of tangential to normal impulse of a sticking impact, MB's formula
    angle, drop = 0.85, 0.5
    ratio = math.sin(angle) * math.cos(angle) / (1 / 3 + math.sin(angle) ** 2)
    assert (ratio < mu) == sticks
    parts = {
        "r": rod(angle0=angle, y0=0.5 * math.sin(angle) + drop),
        "f": floor("r.y_a", mu=mu),
    }
    hit = math.sqrt(2 * drop / G)
    for run in trials("r.ax - f.vx, r.ay - f.vy", hit + 0.02, rtol=1e-8, **parts):
        assert instants(run)[0] == pytest.approx(hit)
        slip = run["f.slip"].at(hit)
        assert run["r.ay.f"].at(hit) == pytest.approx(0, abs=1e-9)
        if sticks:
            assert slip == pytest.approx(0, abs=1e-9)
        else:
            assert abs(slip) > 0.1
            # tangential impulse = mu times the normal one
            given = run["r.vx.f"].at(hit), run["r.vy.f"].at(hit) + G * hit
            assert abs(given[0]) == pytest.approx(mu * given[1])


@pytest.mark.sampled(1)
@pytest.mark.parametrize("J", [0.5, 0.4, 1.0])
@pytest.mark.parametrize(("v", "w"), [(3.0, 0.0), (0.0, -10.0), (2.0, 30.0)])
def test_a_wheel_that_slips_begins_to_roll(J: float, v: float, w: float) -> None:
    m, r, mu = 2.0, 0.3, 0.2
    inertia = J * m * r**2
    parts = {
        "b": hb.Submodel("planar.rigid_body", y0=r, m=m, J=inertia, vx0=v, w0=w),
        "w": hb.Submodel("planar.wheel", mu=mu, inputs={"height": "b.y"}),
    }
    slip = v + r * w
    rolls = abs(slip) / (mu * G * (1 + 1 / J))
    # angular momentum about a point of the floor stays
    speed = (m * r * v - inertia * w) / (m * r * (1 + J))
    end = rolls + 0.1
    for run in trials("b.vx - w.vx, b.vy - w.vy, b.turn - w.turn", end, rtol=1e-8, **parts):
        assert instants(run) == [pytest.approx(rolls)]
        assert run["b.vx.f"].at(end) == pytest.approx(speed, abs=1e-9)
        assert run["b.turn.f"].at(end) == pytest.approx(-speed / r, abs=1e-8)
        assert (run["w.rolls"].at(rolls / 2), run["w.rolls"].at(end)) == (0, 1)
        assert run["w.normal"].at(rolls / 2) == pytest.approx(m * G)
        assert run["w.friction"].at(rolls / 2) == pytest.approx(-math.copysign(mu * m * G, slip))
        assert run["w.slip"].at(0) == pytest.approx(slip)


@pytest.mark.sampled(1)
@pytest.mark.parametrize(("torque", "rolling"), [(2.0, True), (9.0, False)])
def test_a_driven_wheel_rolls_up_to_the_limit_of_friction(torque: float, rolling: bool) -> None:
    m, r, mu = 2.0, 0.3, 0.5
    parts = {
        "b": hb.Submodel("planar.rigid_body", y0=r, m=m, J=m * r**2 / 2),
        "w": hb.Submodel("planar.wheel", mu=mu, inputs={"height": "b.y"}),
        "t": hb.Submodel("rotational.torque", inputs={"torque": str(-torque)}),
    }
    forward = torque / r / 1.5 if rolling else mu * m * G
    for run in trials(
        "b.vx - w.vx, b.vy - w.vy, b.turn - w.turn, b.turn - t.shaft", 1, rtol=1e-8, **parts
    ):
        assert run["b.vx.f"].at(1) == pytest.approx(forward / m)
        assert run["w.friction"].at(0.5) == pytest.approx(forward)
        assert run["w.rolls"].at(0.5) == rolling


@pytest.mark.parametrize("eps", [0.0, 0.6])
def test_a_wheel_bounces_off_the_floor(eps: float) -> None:
    parts = {
        "b": hb.Submodel("planar.rigid_body", y0=1.3, J=0.05),
        "w": hb.Submodel("planar.wheel", eps=eps, inputs={"height": "b.y"}),
    }
    hit = math.sqrt(2 / G)
    for run in trials("b.vx - w.vx, b.vy - w.vy, b.turn - w.turn", hit + 0.3, rtol=1e-8, **parts):
        assert instants(run)[0] == pytest.approx(hit)
        assert run["b.vy.f"].at(hit) == pytest.approx(eps * G * hit, abs=1e-9)
        assert run["w.touches"].at(hit + 0.1) == (eps == 0)
        assert lost(run) == pytest.approx((1 - eps**2) * G)


@pytest.mark.slow
def test_a_spring_in_the_plane_keeps_energy_and_angular_momentum() -> None:
    parts = {
        "b": hb.Submodel("planar.rigid_body", g=0, m=0.5, x0=0.6, y0=0.8, vx0=1, vy0=2),
        "s": hb.Submodel("planar.spring", k=20, rest=0.7, dx0=0.6, dy0=0.8),
        "f": hb.Submodel("planar.frame"),
    }
    t = np.linspace(0, 2, 9)
    for run in trials("f.vx - s.ax, f.vy - s.ay, s.bx - b.vx, s.by - b.vy", 2, rtol=1e-8, **parts):
        energy = run["b.energy"].at(t) + 10 * (run["s.length"].at(t) - 0.7) ** 2
        assert energy == pytest.approx(0.25 * 5 + 10 * 0.09, rel=1e-6)
        assert run["0.5*(b.x*b.vy.f - b.y*b.vx.f)"].at(t) == pytest.approx(0.5 * 0.4, rel=1e-6)
        assert run["s.force"].at(t) == pytest.approx(20 * (run["s.length"].at(t) - 0.7))
        pull = run["f.force_x"].at(t)
        assert pull == pytest.approx(-run["s.force*s.dx/s.length"].at(t), abs=1e-9)


@pytest.mark.slow
def test_a_damped_spring_in_the_plane_comes_to_rest_at_its_length() -> None:
    parts = {
        "b": hb.Submodel("planar.rigid_body", m=1.0, y0=-1.2),
        "s": hb.Submodel("planar.spring", k=50, rest=1.0, d=10, dx0=0, dy0=-1.2),
        "f": hb.Submodel("planar.frame"),
    }
    w, z = math.sqrt(50), 10 / (2 * math.sqrt(50))
    wd, t = w * math.sqrt(1 - z**2), np.linspace(0, 1, 9)
    off = 1.2 - 1 - G / 50
    swing = off * np.exp(-z * w * t) * (np.cos(wd * t) + z * w / wd * np.sin(wd * t))
    for run in trials("f.vx - s.ax, f.vy - s.ay, s.bx - b.vx, s.by - b.vy", 1, rtol=1e-8, **parts):
        assert run["s.length"].at(t) == pytest.approx(1 + G / 50 + swing, abs=1e-7)
