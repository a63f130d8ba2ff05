"""Laws that jump while their slope is the same everywhere: they are not linear. Closed forms."""

from __future__ import annotations

import math

import pytest

import hybond as hb


@pytest.mark.parametrize(
    ("law", "after"),
    [
        # 1 kg braked by 2 N + 3 N*s/m * v: m v' = -(2 + 3 v)
        ("2 [N]*sign(f) + 3 [N*s/m]*f", (5.0 * math.exp(-0.3) - 2.0) / 3.0),
        ("2 [N]*sign(f)", 0.8),
    ],
)
def test_a_resistor_whose_law_jumps_keeps_its_jump(law: str, after: float) -> None:
    """Its slope is the same everywhere, and does not show it."""
    m = hb.Model("brake", domain="translational")
    m.add(brake=hb.R({"e": law}), mass=hb.I("1 kg", f=1.0), v=hb.One())
    m.bond("v -> brake", "v -> mass")
    run = hb.simulate(m, until=0.1)
    assert run["v.f"].at(0.1) == pytest.approx(after, rel=1e-7)


def test_a_resistor_whose_law_jumps_is_solved_in_a_loop() -> None:
    """Two in series on an effort source: 5 = (2 sign(f) + 3 f) + 2 f, so f = 0.6."""
    m = hb.Model("loop", domain="translational")
    m.add(drive=hb.Se("5 N"), brake=hb.R({"e": "2 [N]*sign(f) + 3 [N*s/m]*f"}), v=hb.One())
    m.add(other=hb.R("2 N*s/m"))
    m.bond("drive -> v -> brake", "v -> other")
    assert hb.simulate(m, until=1.0)["v.f"].at(0.5) == pytest.approx(0.6, rel=1e-12)


def test_a_spring_whose_law_jumps_starts_with_its_preload() -> None:
    m = hb.Model("preload", domain="translational")
    m.add(spring=hb.C({"e": "2 [N]*sign(q) + 3 [N/m]*q"}, q=1.0), mass=hb.I("1 kg"), v=hb.One())
    m.bond("v -> spring", "v -> mass")
    assert hb.simulate(m, until=0.1)["spring.e"].at(0.0) == pytest.approx(5.0, rel=1e-12)
