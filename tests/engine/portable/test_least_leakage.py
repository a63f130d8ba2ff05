"""Least leakage in the rows of a mode: closed forms, and what taking it off each time gives."""

from __future__ import annotations

import numpy as np
import pytest
from portable_runs import portable

import hybond as hb
from hybond.engine.algebra.blocks import row_times
from hybond.engine.mode.left_free.leakage import project
from hybond.engine.words import some


def efforts(model, monkeypatch) -> dict[str, float]:
    """Run a model in the portable runtime; return the efforts at its end, by bond."""
    graph = model.flatten()
    e = portable(model, monkeypatch, until=1.0).engine
    return {b.name: e.v[e.model.bond_slot + k] for k, b in enumerate(graph.bonds)}


@pytest.mark.parametrize("many", [2, 3, 7])
def test_blocked_diodes_in_a_row_share_the_voltage(many, monkeypatch):
    m = hb.Model("row", domain="electrical")
    m.add(V=hb.Se(-12), ground=hb.Se(0), C=hb.C(1), top=hb.Zero(), n0=hb.Zero())
    m.bond("V -> n0", "n0 -> d1")
    for k in range(1, many + 1):
        m.add(**{f"d{k}": hb.One(law="diode"), f"n{k}": hb.Zero()})
        m.bond(f"d{k} -> n{k}")
        if k < many:
            m.bond(f"n{k} -> d{k + 1}")
    m.bond(f"ground -> n{many}")
    m.bond("top -> C")
    found = efforts(m, monkeypatch)
    for k in range(1, many):
        # the sum of squares of blocked voltages of a given sum is least where they are equal
        assert found[f"n{k} -> d{k + 1}"] == pytest.approx(-12.0 * (many - k) / many, rel=1e-12)


def test_a_node_between_unequal_leaks_divides_by_them(monkeypatch):
    m = hb.Model("node", domain="electrical")
    m.add(V=hb.Se(-12), source=hb.Zero(), node=hb.Zero(), C=hb.C(1), top=hb.Zero())
    m.add(ground=hb.Se(0), low=hb.Zero())
    m.bond("V -> source", "ground -> low", "top -> C")
    for name, ends in {"a": "source node", "b": "node low", "c": "node low"}.items():
        m.add(**{name: hb.One(law="diode")})
        left, right = ends.split()
        m.bond(f"{left} -> {name} -> {right}")
    # (12 - x)^2 + 2 x^2 is least at x = 4
    assert efforts(m, monkeypatch)["a -> node"] == pytest.approx(-4.0, rel=1e-12)


@pytest.mark.parametrize(
    ("name", "until"),
    [("diode_bridge", 1e-4), ("cockcroft_walton", 0.02), ("six_pulse_rectifier", 2e-3)],
)
def test_rows_give_what_the_projection_gives(name, until, monkeypatch):
    model = hb.load(f"examples/{name}.toml")
    e = portable(model, monkeypatch, until=until).engine
    n = 2 * e.model.bonds
    rng = np.random.default_rng(1)
    modes = [some(e.modes[k]) for k in range(e.modes_made)]
    modes += [some(p) for p in e.open_modes if p is not None]
    folded = [mode for mode in modes if mode.leakage.stages > 0 and mode.dynamics == 0]
    for mode in folded:
        xi = list(rng.normal(size=mode.knowns))
        w = [row_times(mode.finite, mode.same[k], xi) for k in range(n)]
        project(mode.leakage, n, w)
        size = max(map(abs, w))
        found = [row_times(mode.direct, mode.same[k], xi) for k in range(n)]
        assert found == pytest.approx(w, abs=1e-12 * size)
    assert folded or name != "diode_bridge"
