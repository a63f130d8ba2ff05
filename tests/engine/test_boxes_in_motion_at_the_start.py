"""Boxes with corners that rub, which move or turn where a run begins.

Laws are declared at rest. No values fit a body in motion there, and this was refused before any
law was asked (HB-N301), in the air as well as on the ground. What is a priori is of branches that
stand.
"""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import hybond as hb

G = 9.81
WIDE, HIGH, MU = 0.3, 0.2, 0.3
INERTIA = (WIDE**2 + HIGH**2) / 3.0
BELOW = ((WIDE, -HIGH), (-WIDE, -HIGH))
ALL = (*BELOW, (WIDE, HIGH), (-WIDE, HIGH))


def box(corners, height, angle, vx, w):
    m = hb.Model("box", domain="translational")
    start = {"y0": height, "angle0": angle, "vx0": vx, "w0": w}
    m.add(b=hb.Submodel("planar.rigid_body", m=1.0, J=INERTIA, **start))
    at = {"angle": "b.angle", "body_x": "b.x", "body_y": "b.y"}
    for k, (along, across) in enumerate(corners):
        m.add({f"p{k}": hb.Submodel("planar.point_on_body", a=along, b=across, inputs=at)})
        m.add({f"f{k}": hb.Submodel("planar.floor", mu=MU, inputs={"height": f"p{k}.y"})})
        m.bond(f"b.vx -> p{k}.vx", f"b.vy -> p{k}.vy", f"b.turn -> p{k}.turn")
        m.bond(f"p{k}.px -> f{k}.vx", f"p{k}.py -> f{k}.vy")
    m.signal(seen=hb.Sampled("p0.px.f", every=1.0))
    return m


def arm(angle, corner):
    """Return where a corner is, seen from the centre."""
    c, s = math.cos(angle), math.sin(angle)
    return corner[0] * c - corner[1] * s, corner[0] * s + corner[1] * c


def after_impact(v, angle, corner):
    """Return the velocities after a plastic impact at a corner: it slides on, or sticks."""
    x, y = arm(angle, corner)
    rows = np.array([[1.0, 0.0, -y], [0.0, 1.0, x]])
    slip, approach = rows @ v
    if approach >= 0.0:
        return v
    lighter = rows @ np.diag([1.0, 1.0, 1.0 / INERTIA]) @ rows.T
    held = np.linalg.solve(lighter, [-slip, -approach])
    if abs(held[0]) > MU * held[1]:
        rub = -math.copysign(MU, slip)
        held = np.array([rub, 1.0]) * -approach / (lighter[1, 1] + rub * lighter[1, 0])
        assert slip * (slip + lighter[0] @ held) > 0.0
    return v + np.array([1.0, 1.0, 1.0 / INERTIA]) * (rows.T @ held)


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("corners", "lift", "angle", "vx", "w"),
    [
        (ALL, 0.05, 0.0, 1.0, 2.0),
        (BELOW, 0.05, 0.1, -0.7, -2.0),
        (BELOW, 0.0, 0.0, 1.0, -1.0),
        (BELOW, 0.0, 0.0, -1.0, 1.0),
        (BELOW, 0.0, 0.2, 0.0, -1.0),
        (BELOW, 0.0, -0.2, 0.5, 1.0),
    ],
)
def test_a_box_turns_and_slides_where_a_run_begins(corners, lift, angle, vx, w):
    """It flies freely to its first impact; the impulses there are those of one corner."""
    low = min(range(len(corners)), key=lambda k: arm(angle, corners[k])[1])
    height = lift - arm(angle, corners[low])[1]
    flies = 0.0
    if lift > 0.0:

        def lowest(t):
            own = min(arm(angle + w * t, corner)[1] for corner in corners)
            return height - G * t * t / 2.0 + own

        flies = brentq(lowest, 0.0, 1.0, xtol=1e-15)
    turned = angle + w * flies
    before = np.array([vx, -G * flies, w])
    falls = [before[1] + w * arm(turned, corner)[0] for corner in corners]
    heights = [arm(turned, corner)[1] for corner in corners]
    down = [k for k in range(len(corners)) if heights[k] < min(heights) + 1e-9]
    hit = min(down, key=lambda k: falls[k])
    right = after_impact(before, turned, corners[hit])
    run = hb.simulate(box(corners, height, angle, vx, w), flies + 1e-3)
    found = [float(run[f"b.{name}.f"].at(flies + 1e-9)) for name in ("vx", "vy", "turn")]
    assert found == pytest.approx(right, abs=1e-6)
    assert run["seen"].at(0.0) == pytest.approx(vx - w * arm(angle, corners[0])[1], rel=1e-12)
    assert run.audit().holds()


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_ladder_slides_at_both_ends_from_the_start(side):
    """Rubbed at wall and floor; its angle obeys one equation, integrated by SciPy."""
    half, mass, mu, begin, rate = 1.0, 3.0, 0.1, math.radians(60.0), -0.5
    inertia = mass * half**2 / 3.0

    def force(angle, w):
        """Return the angular acceleration with both ends sliding down and away."""
        c, s = math.cos(angle), math.sin(angle)
        # unknown: acceleration of the angle, floor's N, wall's P
        rows = [
            [-half * s * mass, mu, -1.0],
            [half * c * mass, -1.0, -mu],
            [inertia, half * c - mu * half * s, -half * s - mu * half * c],
        ]
        right = [half * c * w * w * mass, half * s * w * w * mass - mass * G, 0.0]
        return np.linalg.solve(rows, right)[0]

    motion = solve_ivp(
        lambda t, y: [y[1], force(*y)], (0.0, 0.2), [begin, rate], rtol=1e-11, atol=1e-13
    )
    m = hb.Model("ladder", domain="translational")
    tilt = math.pi - begin if side > 0.0 else begin
    start = {"x0": side * half * math.cos(begin), "y0": half * math.sin(begin)}
    start |= {"vx0": -side * half * math.sin(begin) * rate, "vy0": half * math.cos(begin) * rate}
    m.add(rod=hb.Submodel("planar.rod", m=mass, l=2 * half, angle0=tilt, w0=-side * rate, **start))
    m.add(floor=hb.Submodel("planar.floor", mu=mu, inputs={"height": "rod.y_a"}))
    m.add(wall=hb.Zero(law="unilateral", gap="rod.x_b" if side > 0.0 else "-rod.x_b"))
    m.add(rub=hb.One(law="coulomb", limit=f"{mu}*wall.e"))
    m.bond("rod.ax -> floor.vx", "rod.ay -> floor.vy", "rod.by -> rub")
    m.bond("wall -> rod.bx" if side > 0.0 else "rod.bx -> wall")
    run = hb.simulate(m, 0.2)
    turned = float(run["rod.angle"].at(0.2))
    assert (math.pi - turned if side > 0.0 else turned) == pytest.approx(motion.y[0, -1], rel=1e-8)
    assert run.audit().holds()
