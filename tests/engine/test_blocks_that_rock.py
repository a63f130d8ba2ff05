"""A block that rocks from corner to corner; the floor rubs at both, of which one is in the air.

There friction has nothing to give, and forces are rounding. Newton's steps went to and fro in that
rounding until laws were said to have no common solution; and friction in the air held the block as
soon as it was shared with the friction that the other corner has.
"""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

G = 9.81
WIDE, HIGH, TILT = 0.3, 0.9, 0.2
CORNERS = {"right": WIDE, "left": -WIDE}


def rocking(mass: float, turned: bool = False, eps: float = 0.0) -> hb.Model:
    """Return a block at rest on its right corner; turned, it is seen from behind."""
    side = -1.0 if turned else 1.0
    c, s = math.cos(TILT), math.sin(TILT)
    m = hb.Model("block", domain="translational", parameters={"m": mass})
    inertia = mass * (WIDE**2 + HIGH**2) / 3.0
    start = {"x0": -side * (WIDE * c - HIGH * s), "y0": WIDE * s + HIGH * c, "angle0": -side * TILT}
    m.add(block=hb.Submodel("planar.rigid_body", m=mass, J=inertia, **start))
    for name, along in CORNERS.items():
        own = {"angle": "block.angle", "body_x": "block.x", "body_y": "block.y"}
        m.add({name: hb.Submodel("planar.point_on_body", a=side * along, b=-HIGH, inputs=own)})
        at = {"height": f"{name}.y"}
        m.add({f"under_{name}": hb.Submodel("planar.floor", mu=2.0, eps=eps, inputs=at)})
        m.bond(f"block.vx -> {name}.vx", f"block.vy -> {name}.vy", f"block.turn -> {name}.turn")
        m.bond(f"{name}.px -> under_{name}.vx", f"{name}.py -> under_{name}.vy")
    return m


def landing() -> tuple[float, float]:
    """Return when the block lands, and its rate then: by SciPy, about its corner."""
    radius, slim = math.hypot(WIDE, HIGH), math.atan2(WIDE, HIGH)

    def upright(t: float, y: np.ndarray) -> float:
        return float(y[0])

    upright.terminal = True  # type: ignore[attr-defined]
    run = solve_ivp(
        lambda t, y: [y[1], -0.75 * G / radius * math.sin(slim - y[0])],
        (0.0, 10.0),
        [TILT, 0.0],
        method="DOP853",
        rtol=1e-12,
        atol=1e-14,
        events=upright,
    )
    return float(run.t[-1]), -float(run.y[1, -1])


@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    ("mass", "until", "solver", "turned"),
    [
        (1e-6, 0.6, "auto", False),
        (1e-6, 0.6, "auto", True),
        (1e-6, 0.59, "radau", False),
        (1.0, 0.6782857142857143, "auto", False),
        (1e6, 0.6782857142857143, "auto", False),
    ],
)
def test_a_block_goes_on_over_its_other_corner(
    mass: float, until: float, solver: str, turned: bool
) -> None:
    """Housner (1963) keeps 1 - 1.5 sin(alpha)^2 of its rate; its laws hold wherever one looks."""
    run = hb.simulate(rocking(mass, turned), until=until, solver=solver)
    lands, rate = landing()
    first = run.events[1].t
    assert first == pytest.approx(lands, rel=1e-8)
    kept = 1.0 - 1.5 * math.sin(math.atan2(WIDE, HIGH)) ** 2
    assert abs(run["block.turn.f"].at(first)) == pytest.approx(kept * rate, rel=1e-7)
    assert run.mode["under_right.contact"] == "open"
    assert run.mode["under_left.faces"] == "sticks"
    assert run.audit().holds()
