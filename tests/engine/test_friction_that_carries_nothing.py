"""What rolls freely in fixed steps: all that its friction carries is rounding."""

from __future__ import annotations

import pytest

import hybond as hb

RADIUS = 0.108
GEARS = {
    "a ball": "1/0.108",
    "a gear that turns by next to nothing": "1/0.108 + 1e-12*x",
    "another one": "-1/0.108 - 1e-12*time*x",
    "a gear that turns a little": "1/0.108 + 1e-9*x",
}


@pytest.mark.sampled(3)
@pytest.mark.parametrize("parts", [(1.0,), (0.3, 0.7)])
@pytest.mark.parametrize("speed", [8.0, -5.0])
@pytest.mark.parametrize("gear", GEARS.values(), ids=GEARS)
def test_what_rolls_freely_rolls_on_in_fixed_steps(
    gear: str, speed: float, parts: tuple[float, ...]
) -> None:
    """A ball slides, then rolls with 5/7 of its speed; its friction then carries nothing."""
    m = hb.Model("rolls")
    m.add(v=hb.One(), w=hb.One(), foot=hb.Zero(), rub=hb.One(law="coulomb", limit=7.0))
    for k, part in enumerate(parts):
        mass, spin = hb.I(6.0 * part, f=speed), hb.I(0.4 * 6.0 * RADIUS**2 * part)
        m.add(**{f"m{k}": mass, f"j{k}": spin})
        m.bond(f"v -> m{k}", f"w -> j{k}")
    m.add(slope=hb.Se("if x > 100 then 1.0 else 0.0"), radius=hb.TF(gear))
    m.bond("slope -> v", "v -> foot -> radius -> w", "foot -> rub")
    m.signal(x=hb.Integral("v.f"))
    run = hb.simulate(m, 2.5, solver="moreau-jean", step=2e-3)
    assert run["v.f"].at(2.5) == pytest.approx(5.0 / 7.0 * speed, rel=1e-8)
    assert run["rub.e"].at(2.5) == pytest.approx(0.0, abs=1e-7)
    assert run.mode == {"rub": "sticks"}


@pytest.mark.parametrize("theta", [0.5, 1.0])
@pytest.mark.parametrize("beside", ["a time", "a law that bends"])
@pytest.mark.parametrize("turned", [False, True])
def test_blocks_that_rub_at_each_other_and_at_the_ground_come_to_rest_in_steps(
    theta: float, beside: str, turned: bool
) -> None:
    """Three frictions hold two blocks by nothing: what each gives is rounding of what it may hold.

    Held against what there was, which was rounding as well, no step ended.
    """
    m = hb.Model("rub")
    for k, (limit, mass, speed) in enumerate([(2.0, 1.0, 0.0), (0.5, 0.3, -1.0)]):
        sign = -1.0 if turned else 1.0
        m.add(**{f"v{k}": hb.One(law="coulomb", limit=limit)})
        m.add(**{f"m{k}": hb.I(mass, p=sign * mass * speed)})
        m.bond(f"m{k} -> v{k}" if turned else f"v{k} -> m{k}")
    m.add(n=hb.Zero(), s=hb.One(law="coulomb", limit=3.0), wall=hb.Zero(law="unilateral", gap="x0"))
    m.bond("v0 -> n -> v1", "n -> s", "wall -> v0")
    m.signal(x0=hb.Integral("v0.f"), x1=hb.Integral("v1.f"))
    if beside == "a time":
        m.add(F=hb.Se("if time < 0.5 then 8 else 0"), u=hb.One(), M=hb.I(0.7))
        m.bond("F -> u -> M")
    else:
        m.add(d=hb.R({"e": "f*abs(f)"}), u=hb.One(), M=hb.I(0.7, f=1.0))
        m.bond("u -> d", "u -> M")
    run = hb.simulate(m, 0.6, solver="moreau-jean", step=1e-3, theta=theta)
    # the wall holds the first block; the second is held by 3.5 N
    assert run.status == "ok" and run.audit().holds()
    assert run["x1"].at(0.6) == pytest.approx(-0.5 * 0.3 / 3.5, abs=2e-3)
    assert run["x0"].at(0.6) == pytest.approx(0.0, abs=2e-3)
    assert run["v1.f"].at(0.6) == pytest.approx(0.0, abs=1e-12)
    moved = 8.0 * 0.5 / 0.7 if beside == "a time" else 1.0 / (1.0 + 0.6 / 0.7)
    assert run["u.f"].at(0.6) == pytest.approx(moved, rel=2e-3)
