"""Slopes that are found of many states at once are those of each state alone."""

from __future__ import annotations

from contextlib import suppress

import numpy as np
import pytest

import hybond as hb
from hybond.engine.methods.implicit import radau_slopes
from hybond.testing import random_recipe

MANY = 14


def row(law: dict[str, str] | str, back: bool = False) -> hb.Model:
    """Return storages in a row, joined by resistors, of which the last one leaks."""
    m = hb.Model("row")
    for i in range(MANY):
        m.add({f"c{i}": hb.C(1.0 + 0.1 * i, e=float(i % 5)), f"n{i}": hb.Zero()})
        m.bond(f"n{i} -> c{i}")
    for i in range(1, MANY):
        m.add({f"j{i}": hb.One(), f"r{i}": hb.R(law)})
        m.bond(f"n{i - 1} -> j{i} -> n{i}", f"r{i} -> j{i}" if back else f"j{i} -> r{i}")
    return m


def with_gyrators() -> hb.Model:
    """Return capacitors that exchange by gyrators and resistors, beside what those drive."""
    m = row("2")
    for i in range(1, MANY, 3):
        m.add({f"g{i}": hb.GY(2.0), f"l{i}": hb.I(0.3 * i), f"s{i}": hb.One(), f"d{i}": hb.R(1.0)})
        m.add({f"t{i}": hb.Zero(), f"h{i}": hb.R(3.0)})
        m.bond(f"n{i} -> s{i} -> g{i} -> t{i} -> l{i}", f"s{i} -> d{i}", f"t{i} -> h{i}")
    return m


def with_a_mean() -> hb.Model:
    """Return a row whose source reads some of it, beside an integral of one level."""
    m = row({"f": "0.5*(e + e^3)"})
    m.add(q=hb.Sf("2 - (c0.e + c7.e*c12.e)/20 + 0.1*w"))
    m.bond("q -> n3")
    m.signal(w=hb.Integral("c7.e - 1", start=0.0))
    return m


def modulated() -> hb.Model:
    """Return a row with resistors that read what is far away."""
    m = row({"f": "tanh(e)"})
    m.add(r=hb.R("1 + c12.e^2"), s=hb.R("2 + r.f^2"))
    m.bond("n2 -> s", "n4 -> r")
    return m


def bent() -> hb.Model:
    """Return a row of storages whose laws bend."""
    m = row({"e": "f^3 + f"}, back=True)
    for i in range(0, MANY, 4):
        m.add({f"x{i}": hb.C({"e": "q + q^3"}, q=0.3), f"y{i}": hb.R(0.7), f"z{i}": hb.One()})
        m.bond(f"n{i} -> z{i} -> x{i}", f"z{i} -> y{i}")
    return m


def switched() -> hb.Model:
    """Return a row with a junction that is switched ON."""
    m = row({"f": "e + abs(e)*e"})
    m.add(s=hb.One(), v=hb.Se(3.0), u=hb.R(0.1))
    m.bond("v -> s -> n5", "s -> u")
    m.machine("S", states={"off": [], "on": ["s"]}, start="on", rules=["on -> off when time > 9"])
    return m


MODELS = {
    "a row": lambda: row({"f": "e + e^3"}),
    "a row by flows, bonds turned": lambda: row({"e": "f + f^3"}, back=True),
    "gyrators": with_gyrators,
    "a mean, and an integral": with_a_mean,
    "modulated": modulated,
    "bent storages": bent,
    "switched": switched,
}


def held(monkeypatch: pytest.MonkeyPatch, found: list[int]) -> None:
    """Hold each Jacobian of slopes found together against that of states shifted one by one."""
    together = radau_slopes.take_together

    def checked(e, r, t, base, at, rates, closely, one_side):
        together(e, r, t, base, at, rates, closely, one_side)
        if not any(r.together[j] for j in range(r.n)) or len(found) >= 3:
            return
        n = r.n
        at_once = np.array(r.jacobian[: n * n]).reshape(n, n)
        for j in range(n):
            radau_slopes.take_alone(e, r, j, one_side, closely)
        alone = np.array(r.jacobian[: n * n]).reshape(n, n)
        found.append(e.mode.acting.groups)
        size = np.abs(alone).max()
        assert np.abs(at_once - alone).max() <= 1e-3 * size
        np.testing.assert_array_equal(at_once[alone == 0.0], 0.0)

    monkeypatch.setattr(radau_slopes, "take_together", checked)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", list(MODELS))
def test_a_model_of_many_states(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    found: list[int] = []
    held(monkeypatch, found)
    hb.simulate(MODELS[name](), until=1e-3, solver="radau", engine="python")
    assert found
    assert all(2 * groups <= MANY + 6 for groups in found)


@pytest.mark.sampled(8)
@pytest.mark.parametrize("seed", range(40))
def test_random_models(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """However few states they have."""
    found: list[int] = []
    held(monkeypatch, found)
    monkeypatch.setattr("hybond.engine.mode.rows.acting.FEWEST", 2)
    monkeypatch.setattr("hybond.engine.mode.rows.acting.WORTH", 1)
    recipe = random_recipe(7_000_000 + seed)
    with suppress(hb.HybondError):
        hb.simulate(recipe.model(), 0.05 * recipe.until, solver="radau", engine="python")
