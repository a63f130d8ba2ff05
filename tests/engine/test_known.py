"""What an engine says apart from any motion, by closed forms: energies, knowns, modes tried."""

from __future__ import annotations

import numpy as np
import pytest
from engine.by_engine import ABSENT

import hybond as hb
from hybond.engine.outcome.apart import Apart
from hybond.engine.outcome.engines import prepared_for_library, prepared_for_python
from hybond.engine.tables import ModelTables, tables_of

BOTH = pytest.mark.parametrize(
    "prepare",
    [
        pytest.param(prepared_for_library, marks=pytest.mark.skipif(bool(ABSENT), reason=ABSENT)),
        prepared_for_python,
    ],
    ids=["library", "python"],
)


def divider(law: str | float = 2.0) -> ModelTables:
    """Two volts over a resistor and a capacitor of half a farad."""
    m = hb.Model("divider", domain="electrical")
    m.add(V=hb.Se("2*time*1 [V/s]"), i=hb.One(), r=hb.R(law), c=hb.C(0.5))
    m.bond("V -> i -> r", "i -> c")
    return tables_of(m.flatten(), until=1.0)


@BOTH
def test_the_energy_of_storage_is_its_integral(prepare) -> None:
    m = hb.Model("stores")
    m.add(a=hb.C({"e": "q^3"}), b=hb.C([[4.0, 1.0], [1.0, 2.0]]), n=hb.Zero(), v=hb.Zero())
    m.bond("n -> a", "n -> b.1", "v -> b.2")
    graph = m.flatten()
    assert [s.path for s in graph.storages] == ["a.q", "b.1.q", "b.2.q"]
    rows = np.array([[2.0, 0.0, 0.0], [-1.0, 3.0, -1.0], [0.0, 0.0, 5.0]])
    inverse = np.linalg.inv([[4.0, 1.0], [1.0, 2.0]])
    want = [0.25 * y[0] ** 4 + 0.5 * y[1:] @ inverse @ y[1:] for y in rows]
    look = prepare(tables_of(graph, until=1.0)).look()
    assert look.stored(rows) == pytest.approx(want, rel=1e-14)
    with pytest.raises(ValueError, match="states"):
        look.stored(rows[:, :2])


@BOTH
def test_knowns_make_bond_variables(prepare) -> None:
    tables = divider()
    look = prepare(tables).look()
    with pytest.raises(ValueError, match="nothing is looked into"):
        look.sources()
    look.into(0.0, [])
    sources, rated = look.sources()
    assert (len(sources), rated.tolist()) == (1, [0])
    # the current is (V - e_c)/R, for values as for derivatives of any order
    found = look.by_knowns([[1.0, 5.0, 0.0], [-3.0, 0.5, 7.0]])
    flow = found[:, len(tables.graph.bonds) :]
    assert np.abs(flow) == pytest.approx(np.array([[2.0] * 3, [1.75] * 3]), rel=1e-14)
    with pytest.raises(ValueError, match="rows of 3 knowns"):
        look.by_knowns([[1.0, 5.0]])


@BOTH
def test_the_rate_of_a_source_is_known_where_storage_follows_it(prepare) -> None:
    m = hb.Model("follows", domain="electrical")
    m.add(V=hb.Se("sin(time*1 [1/s])*1 [V]"), n=hb.Zero(), c=hb.C(0.5))
    m.bond("V -> n -> c")
    graph = m.flatten()
    look = prepare(tables_of(graph, until=1.0)).look()
    look.into(0.0, [])
    sources, rated = look.sources()
    assert (len(sources), rated.tolist()) == (1, [1])
    (row,) = look.by_knowns([[9.0, 3.0, 4.0]])
    (c,) = graph.storages
    # effort of the source, and C times its rate
    assert (row[c.bond], row[len(graph.bonds) + c.bond]) == pytest.approx((3.0, 2.0), rel=1e-14)


@BOTH
def test_a_mode_that_is_not_linear_has_no_matrix(prepare) -> None:
    look = prepare(divider({"e": "f^3*1 [ohm/A^2]"})).look()
    look.into(0.0, [])
    assert look.sources() is None
    with pytest.raises(ValueError, match="not linear"):
        look.by_knowns([[1.0, 5.0, 0.0]])


def relay(*, off: str = "c.e > 1") -> hb.Model:
    m = hb.Model("relay")
    m.add(c=hb.C(1), n=hb.Zero(), f=hb.Sf(0), s=hb.One(), r=hb.R(1))
    m.bond("f -> n -> c", "n -> s -> r")
    rules = [f"off -> on when {off}", "on -> off when c.e < 2", "on -> off when s.f < 1.7"]
    m.machine("m", states={"off": [], "on": ["s"]}, start="off", rules=rules)
    return m


@BOTH
def test_a_mode_is_tried_where_a_run_begins(prepare) -> None:
    """All rules that hold are named, also behind the first."""
    graph = relay().flatten()
    tables = tables_of(graph, until=1.0)
    tables.floats["storage_start"] = [1.5]
    model = prepare(tables)
    assert model.run(None).tried((0,)).tolist() == [1, 0, 0]
    assert model.run(None).tried((1,)).tolist() == [0, 1, 1]
    run = model.run(None)
    next(run.slices(steps=1))
    with pytest.raises(ValueError, match="has begun"):
        run.tried((0,))


def test_apart_from_runs_a_start_may_be_any() -> None:
    apart = Apart(relay(off="pre(c.e) > 1").flatten())
    assert apart.settled(np.array([3.0]), (0,)).steps[-1].mode == (1,)
    assert apart.settled(np.array([0.5]), (0,)).steps[-1].mode == (0,)
    event = apart.settled(np.array([0.5]), (1,))
    assert event.before.tolist() == [0.5] and event.steps[-1].mode == (0,)
    with pytest.raises(hb.DivergenceOfTime) as caught:
        apart.settled(np.array([1.5]), (1,))
    assert "(off) by m: c.e < 2" in caught.value.why
    assert apart.leaving(np.array([1.5]), (0,), (1,)) == {"m": ["c.e < 2", "s.f < 1.7"]}


def test_a_mode_that_cannot_be_entered_is_refused_with_its_elements() -> None:
    m = hb.Model("fight")
    m.add(V=hb.Se(1), n=hb.Zero(), s=hb.One(), W=hb.Se(2))
    m.bond("V -> n", "n -> s", "W -> s")
    m.machine("m", states={"off": [], "on": ["s"]}, start="off", rules=["on -> off when time < 0"])
    apart = Apart(m.flatten())
    assert apart.leaving(apart.start, (0,), (0,)) == {"m": []}
    with pytest.raises(hb.CausalityError):
        apart.leaving(apart.start, (0,), (1,))
