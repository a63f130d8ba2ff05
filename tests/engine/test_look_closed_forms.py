"""Looks into motions with closed forms: energies over kinks, states put back where they belong."""

from __future__ import annotations

import numpy as np
import pytest
from engine.by_engine import EngineLook, EngineModel, EngineRun
from engine.looked_at import (
    model_of,
)

import hybond as hb
from hybond.engine.compiled.points import Points, Steps
from hybond.engine.tables import tables_of


def source_into(law: str) -> hb.Model:
    """Return a model of a flow of ``kink - time`` through a resistor."""
    m = hb.Model("kink", domain="electrical", parameters={"kink": "0.5 s"})
    m.add(
        s=hb.Sf("(kink - time)*1 [A/s]"),
        i=hb.One(),
        r=hb.R({"e": law}),
        c=hb.C(1),
        z=hb.Zero(),
        d=hb.R(1),
    )
    m.bond("s -> i -> r", "c -> z -> d")
    return m


STEP = Steps([[0.0, 1.0, 1.0]], np.zeros((1, 3, 1)), np.zeros((1, 4, 1)))


@pytest.mark.parametrize("kink", [0.5, 1.0 / 3.0, 0.3, 0.013, 0.9, 0.0, 1.0, 1.0 - 1e-12])
def test_a_kink_of_a_law_does_not_fool_energies(kink: float) -> None:
    """A resistor that takes force one way only: the energy is the integral of (kink - t)^2."""
    graph = source_into("max(f, 0 [A])*1 [ohm]").flatten(parameters={"kink": kink})
    look = EngineLook(EngineModel(tables_of(graph, until=1.0)))
    look.into(0.0, [])
    ((supplied, dissipated, wrong),) = look.energies(STEP)
    assert dissipated == pytest.approx(kink**3 / 3.0, rel=1e-9, abs=1e-12)
    assert supplied == pytest.approx(dissipated, rel=1e-12)
    assert wrong <= 1e-9 * kink**3 + 1e-12


@pytest.mark.parametrize("kink", [0.5, 1.0 / 3.0, 0.013, 0.9])
def test_nor_does_a_jump(kink: float) -> None:
    """A resistor that turns into its opposite: the energy is the integral of (kink - t)^2."""
    graph = source_into("sign(f + 0.25 [A])*f*1 [ohm]").flatten(parameters={"kink": kink})
    look = EngineLook(EngineModel(tables_of(graph, until=1.0)))
    look.into(0.0, [])
    ((_, dissipated, wrong),) = look.energies(STEP)
    there = min(kink + 0.25, 1.0)
    meant = (kink**3 - 2.0 * (kink - there) ** 3 + (kink - 1.0) ** 3) / 3.0
    assert dissipated == pytest.approx(meant, abs=1e-9)
    assert wrong <= 1e-9


def test_a_law_that_has_many_kinks_ends_with_what_it_may_be_wrong_by() -> None:
    graph = source_into("f*abs(sin(4000 [1/A]*f))*1 [ohm]").flatten()
    look = EngineLook(EngineModel(tables_of(graph, until=1.0)))
    look.into(0.0, [])
    ((_, dissipated, wrong),) = look.energies(STEP)
    # the mean of abs(sin) is 2/pi; the integral of f^2 is 1/12
    assert dissipated == pytest.approx(2.0 / np.pi / 12.0, rel=0.05)
    assert wrong > 1e-6


@pytest.mark.parametrize("large", ["1e9", "1e10"])
@pytest.mark.parametrize("kink", [0.0, 0.3, 0.77])
def test_nor_do_powers_that_are_known_to_few_places(kink: float, large: str) -> None:
    """A root of what cancels but for a part of 1e-7: the pieces near it are cut, not the first."""
    law = f"sign(f)*sqrt(abs((f + {large} [A]) - {large} [A]))*1 [ohm*A^0.5]"
    graph = source_into(law).flatten(parameters={"kink": kink})
    look = EngineLook(EngineModel(tables_of(graph, until=1.0)))
    look.into(0.0, [])
    ((_, dissipated, wrong),) = look.energies(STEP)
    # the integral of abs(kink - t)^1.5
    assert dissipated == pytest.approx((kink**2.5 + (1.0 - kink) ** 2.5) / 2.5, abs=2e-8)
    assert wrong <= 1e-7


def test_energies_of_a_capacitor_that_empties() -> None:
    """From 2 V by 1 ohm: dissipated is 2 (1 - exp(-2 t)) J, in all and in parts of steps."""
    m = hb.Model("rc", domain="electrical")
    m.add(c=hb.C("1 F", e="2 V"), r=hb.R("1 ohm"), node=hb.Zero())
    m.bond("node -> c", "node -> r")
    model = EngineModel(tables_of(m.flatten(), until="1 s", rtol=1e-11, atol=1e-14))
    (rows,) = EngineRun(model).slices(steps=-1)
    look = EngineLook(model)
    look.into(0.0, [], energy=2.0)
    steps = Steps.of(rows)
    whole = look.energies(steps)
    assert whole[:, 1].sum() == pytest.approx(2.0 * (1.0 - np.exp(-2.0)), rel=1e-10)
    assert not whole[:, 0].any()
    a, b = steps.time[:, 0], steps.time[:, 2]
    middle = 0.5 * (a + b)
    half = look.energies(steps, middle, b)
    assert half[:, 1] == pytest.approx(2.0 * (np.exp(-2.0 * middle) - np.exp(-2.0 * b)), rel=1e-8)
    assert not look.energies(steps, b, b).any()


def test_a_state_beside_its_constraint_is_put_back_unless_it_was_accepted() -> None:
    """Two capacitors side by side share what they hold; nothing of it is lost."""
    m = hb.Model("shared", domain="electrical")
    m.add(a=hb.C(1), b=hb.C(3), z=hb.Zero(), r=hb.R(1))
    m.bond("z -> a", "z -> b", "z -> r")
    tables = tables_of(m.flatten(), until=1.0)
    look = EngineLook(EngineModel(tables))
    look.into(0.0, [], energy=2.0)
    slots = [tables.slots.index[n] for n in ("x:0", "x:1", "e:0", "e:1")]
    points = Points([0.0, 0.0], [[1.2, 2.8]] * 2, accepted=[False, True])
    there, accepted = look.values(points, slots)
    assert there == pytest.approx([1.0, 3.0, 1.0, 1.0], rel=1e-14)
    assert accepted[:2].tolist() == [1.2, 2.8]


def test_a_state_beside_the_surfaces_is_put_back_on_them() -> None:
    model = model_of("relays")
    look = EngineLook(model)
    look.into(3.0, [0, 0], surfaces=[0, 1], energy=1.0)
    x = [model.tables.slots.index[n] for n in ("x:0", "x:1")]
    points = Points([3.5, 3.5], [[1e-6, -1e-6]] * 2, accepted=[False, True])
    assert look.values(points, x) == pytest.approx(np.array([[0, 0], [1e-6, -1e-6]]), abs=1e-20)
