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
