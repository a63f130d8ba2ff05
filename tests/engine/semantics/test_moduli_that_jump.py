"""A modulus that jumps with time acts in a jump as it is behind it.

Gears are shifted: what ties two bodies afterwards is the new ratio, and so the impulses between
them are those of the new ratio, too. The state goes to the nearest one, in energy, that the new
constraint allows: energy is lost, whatever the ratios. By the old ratio it could be made.
"""

from __future__ import annotations

import pytest

import hybond as hb

AFTER = 2.0
A, B = 2.0, 3.0
JUMPS = {
    "whole": "1 + floor(time/(1 s) + 0.5)",
    "rule": "if time >= 0.5 then 2 else 1",
    "sign": "1.5 + 0.5*sign(time - 0.5 [s])",
}


def geared(modulus: str, electrical: bool) -> hb.Model:
    """Two bodies, or two capacitors, behind a transformer: consistent at the start."""
    m = hb.Model("geared", domain="electrical" if electrical else "translational")
    if electrical:  # e1 = m e2
        m.add(a=hb.C(f"{A} F", e="1 V"), b=hb.C(f"{B} F", e="1 V"), v=hb.Zero(), w=hb.Zero())
    else:  # f2 = m f1
        m.add(a=hb.I(f"{A} kg", f="1 m/s"), b=hb.I(f"{B} kg", f="1 m/s"), v=hb.One(), w=hb.One())
    m.add(t=hb.TF(modulus))
    m.bond("v -> a", "v -> t.1", "t.2 -> w", "w -> b")
    return m


@pytest.mark.parametrize("electrical", [False, True])
@pytest.mark.parametrize("jump", JUMPS)
def test_what_a_gear_is_shifted_to_ties_bodies_by_its_own_ratio(
    jump: str, electrical: bool
) -> None:
    run = hb.simulate(geared(JUMPS[jump], electrical), "1 s")
    (event,) = run.events[1:]
    energy = event.steps[-1].energy
    assert energy is not None and run.audit().holds()
    assert event.t == pytest.approx(0.5, abs=1e-12)
    if electrical:
        # the charge that leaves a enters b in the ratio of flows, f1 = f2/m
        second = (A * AFTER * 1.0 + B * 1.0) / (A * AFTER**2 + B)
        values = (AFTER * second, second)
        names = ("a.e", "b.e")
    else:
        first = (A * 1.0 + AFTER * B * 1.0) / (A + AFTER**2 * B)
        values = (first, AFTER * first)
        names = ("a.f", "b.f")
    assert [float(run[n].at(1.0)) for n in names] == pytest.approx(values, rel=1e-12)
    left = 0.5 * (A * values[0] ** 2 + B * values[1] ** 2)
    assert energy.lost == pytest.approx(0.5 * (A + B) - left, rel=1e-9)
    assert energy.lost > 0.0 and energy.source == 0.0


@pytest.mark.parametrize("ratio", [0.3, 0.9, 1.1, 4.0, -1.0])
def test_no_ratio_makes_energy(ratio: float) -> None:
    run = hb.simulate(geared(f"if time >= 0.5 then {ratio} else 1", False), "1 s")
    energy = run.events[1].steps[-1].energy
    first = (A + ratio * B) / (A + ratio**2 * B)
    assert energy is not None and energy.lost >= 0.0
    assert float(run["a.f"].at(1.0)) == pytest.approx(first, rel=1e-12)


def test_a_gyrator_that_jumps_keeps_to_its_new_modulus() -> None:
    # e2 = r f1: a spring behind it is as much as a mass, q/C2 = r p/m
    m = hb.Model("gyrated", domain="electrical")
    m.add(a=hb.I("2 H", f="1 A"), g=hb.GY("(if time >= 0.5 then 2 else 1)*1 [ohm]"))
    m.add(b=hb.C("3 F", e="1 V"), v=hb.One(), w=hb.Zero())
    m.bond("v -> a", "v -> g.1", "g.2 -> w", "w -> b")
    run = hb.simulate(m, "1 s")
    # p moves by -r nu where q moves by nu
    first = (2.0 + 2.0 * 3.0) / (2.0 + 4.0 * 3.0)
    assert float(run["a.f"].at(1.0)) == pytest.approx(first, rel=1e-12)
    assert float(run["b.e"].at(1.0)) == pytest.approx(2.0 * first, rel=1e-12)
    assert run.audit().holds()
