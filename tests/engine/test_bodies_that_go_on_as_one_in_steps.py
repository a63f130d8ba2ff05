"""Bodies that have met strike as one in fixed steps, wherever the step of the impact left them."""

from __future__ import annotations

import math

import pytest

import hybond as hb

STEPS = (1e-3, 7e-4, 5e-4, 3.3e-4)


def carts(masses: tuple[float, ...], pull: float, ratio: float) -> hb.Model:
    """A row of carts, the last of which runs into the others; a wall before the first one."""
    m = hb.Model("carts")
    last = len(masses) - 1
    m.add(wall=hb.Sf(0.0), buffer=hb.Zero(law="unilateral", gap="1 - x0", restitution=0.6))
    m.bond("v0 -> buffer -> wall")
    for k, mass in enumerate(masses):
        m.add(**{f"v{k}": hb.One(), f"g{k}": hb.Se(pull * mass)})
        # behind a lever the same cart is another mass that moves faster
        m.add(**{f"l{k}": hb.TF(ratio), f"u{k}": hb.One()})
        m.add(**{f"m{k}": hb.I(mass / ratio**2, f=ratio if k == last else 0.0)})
        m.bond(f"g{k} -> v{k} -> l{k} -> u{k} -> m{k}")
        m.signal(**{f"x{k}": hb.Integral(f"v{k}.f", start=-0.2 * k)})
        if k:
            m.add(**{f"c{k}": hb.Zero(law="unilateral", gap=f"x{k - 1} - x{k} - 0.1")})
            m.bond(f"v{k} -> c{k}", f"c{k} -> v{k - 1}")
    return m


def met(masses: tuple[float, ...], pull: float, after: float) -> tuple[float, float]:
    """Return a time after the wall is struck, and where the first cart is then.

    What meets goes on together, the wall gives back 0.6.
    """
    total = masses[-1]
    x, v, t = -0.2 * (len(masses) - 1), 1.0, 0.0
    for k in range(len(masses) - 2, -1, -1):
        # both are pulled alike, so that the distance closes at the relative speed alone
        other = pull * t
        wait = 0.1 / (v - other)
        x += v * wait + pull * wait**2 / 2.0
        v += pull * wait
        other += pull * wait
        t += wait
        v = (total * v + masses[k] * other) / (total + masses[k])
        total += masses[k]
        x += 0.1
    gap = 1.0 - x
    wait = gap / v if pull == 0.0 else (math.sqrt(v**2 + 2.0 * pull * gap) - v) / pull
    v = -0.6 * (v + pull * wait)
    return t + wait + after, 1.0 + v * after + pull * after**2 / 2.0


@pytest.mark.sampled(3)
@pytest.mark.parametrize("theta", [0.5, 1.0])
@pytest.mark.parametrize("pull", [0.0, 9.81])
@pytest.mark.parametrize(
    ("masses", "ratio"),
    [((1.0, 1.5), 1.0), ((3.0, 0.7), 1.0), ((0.5, 1.0, 2.0), 1.0), ((1.0, 1.5), 0.3)],
    ids=["two", "a light one behind", "three", "behind levers"],
)
def test_bodies_that_have_met_strike_as_one(
    masses: tuple[float, ...], ratio: float, pull: float, theta: float
) -> None:
    model = carts(masses, pull, ratio)
    until, right = met(masses, pull, after=0.3)
    assert hb.simulate(model, until).final["x0"] == pytest.approx(right, abs=1e-7)
    for step in STEPS:
        run = hb.simulate(model, until, solver="moreau-jean", step=step, theta=theta)
        assert run.final["x0"] == pytest.approx(right, abs=8.0 * step)


@pytest.mark.parametrize("theta", [0.5, 1.0])
@pytest.mark.parametrize("masses", [(0.25, 0.29, 2.6), (1.0, 3.0)])
@pytest.mark.parametrize("turned", [False, True])
def test_blocks_that_lie_on_each_other_are_struck_by_nothing(
    masses: tuple[float, ...], turned: bool, theta: float
) -> None:
    """The speeds that rounding leaves of theirs were approaches: an impact at every step."""
    m = hb.Model("stack")
    m.add(bed=hb.C(1e-4))
    m.bond("bed -> v0" if turned else "v0 -> bed")
    for k, mass in enumerate(masses):
        gap = f"x{k} - x{k - 1}" if k else "x0"
        m.add(**{f"v{k}": hb.One(), f"m{k}": hb.I(mass)})
        m.add(**{f"g{k}": hb.Se(9.81 * mass if turned else -9.81 * mass)})
        m.add(**{f"c{k}": hb.Zero(law="unilateral", gap=gap, restitution=0.8)})
        m.bond(f"v{k} -> g{k}" if turned else f"g{k} -> v{k}", f"v{k} -> m{k}")
        m.bond(f"v{k - 1} -> c{k} -> v{k}" if k else "c0 -> v0")
        m.signal(**{f"x{k}": hb.Integral(f"v{k}.f")})
    run = hb.simulate(m, 0.1, solver="moreau-jean", step=1 / 300, theta=theta)
    assert [e.cause for e in run.events] == ["start"]
    assert run["c1.e"].at(0.05) == pytest.approx(9.81 * sum(masses[1:]), rel=1e-9)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("step", [1e-3, 2e-4])
@pytest.mark.parametrize("place", [0.1, 0.2, 1.0 / 3.0, 0.7])
@pytest.mark.parametrize("turned", [False, True])
def test_blocks_that_friction_presses_together_are_never_let_go_of_by_rounding(
    place: float, turned: bool, step: float
) -> None:
    """Both slow down as one; without friction they would part, and 3e-17 m let them for a step."""
    m = hb.Model("pressed")
    masses, limits, drag = (1.48, 2.63), (5.0, 2.0), 0.63
    for k in range(2):
        m.add(**{f"v{k}": hb.One(law="coulomb", limit=limits[k])})
        m.add(**{f"m{k}": hb.I(masses[k], p=masses[k] if turned else -masses[k])})
        m.bond(f"m{k} -> v{k}" if turned else f"v{k} -> m{k}")
        m.signal(**{f"x{k}": hb.Integral(f"v{k}.f", start=place + 0.2 * k)})
    m.add(c=hb.Zero(law="unilateral", gap="x1 - x0 - 0.2"), d=hb.R(drag))
    m.bond("v0 -> c -> v1", "d -> v1" if turned else "v1 -> d")
    run = hb.simulate(m, 0.3, solver="moreau-jean", step=step)
    assert len(run.events) == 1 and run.audit().holds()
    for t in (0.1, 0.2, 0.3):
        # m v' = -(7 N + 0.63 v)
        speed = (1.0 + 7.0 / drag) * math.exp(-drag * t / sum(masses)) - 7.0 / drag
        slows = (7.0 + drag * speed) / sum(masses)
        assert run["v0.f"].at(t) == pytest.approx(-speed, rel=1e-5)
        force = masses[1] * slows - limits[1] - drag * speed
        assert run["c.e"].at(t) == pytest.approx(force, rel=2e-4)
