"""Two junctions that share one friction: what they become, and what does not fit together."""

from __future__ import annotations

from typing import Any

import pytest

import hybond as hb


def block(first: dict[str, Any], second: dict[str, Any], **more: Any) -> hb.Model:
    m = hb.Model("block", domain="translational")
    m.add(x=hb.One(**first), y=hb.One(**second), m_x=hb.I(1), m_y=hb.I(2), **more)
    m.bond("x -> m_x", "y -> m_y")
    return m


FIRST = dict(law="coulomb", limit="3 N", breakaway="4 N")
SECOND = dict(law="coulomb", pair="x")


def test_a_pair_is_one_machine_with_two_sources() -> None:
    graph = block(FIRST, SECOND).flatten()
    (machine,) = graph.machines
    assert machine.path == "x"
    assert machine.states == ("sticks", "slips")
    both = {graph.by_path["x"], graph.by_path["y"]}
    assert machine.on == (frozenset(), frozenset(both))
    assert [n.path for n in graph.nodes if n.implied] == ["x.friction", "y.friction"]
    assert [i.path for i in graph.integrals] == ["x.heading", "x.slow"]
    assert machine.law is not None and machine.law.second is not None
    assert machine.law.second.limit == machine.law.limit
    assert machine.law.second.node == graph.by_path["y"]


def test_the_order_of_the_two_does_not_matter() -> None:
    m = hb.Model("block", domain="translational")
    m.add(y=hb.One(**SECOND), x=hb.One(**FIRST), m_x=hb.I(1), m_y=hb.I(2))
    m.bond("x -> m_x", "y -> m_y")
    assert [a.path for a in m.flatten().machines] == ["x"]


def test_a_pair_in_a_submodel() -> None:
    top = hb.Model("two", domain="translational")
    top.add(a=hb.Submodel(block(FIRST, SECOND)), b=hb.Submodel(block(FIRST, SECOND)))
    graph = top.flatten()
    assert [m.path for m in graph.machines] == ["a.x", "b.x"]
    assert hb.simulate(graph, until=1).status == "ok"


@pytest.mark.slow
def test_a_limit_in_units_and_in_numbers() -> None:
    for limit in (3.5, "3.5", "3.5 N", "3500 mN", "7*0.5"):
        m = hb.Model("block", domain="translational")
        m.add(x=hb.One(law="coulomb", limit=limit), y=hb.One(**SECOND))
        m.add(m_x=hb.I(1, f=3), m_y=hb.I(1, f=4))
        m.bond("x -> m_x", "y -> m_y")
        assert hb.simulate(m, until=2).events[-1].t == pytest.approx(5.0 / 3.5, rel=1e-12)


@pytest.mark.parametrize(
    ("first", "second"),
    [
        (FIRST, {"law": "coulomb", "pair": "z"}),
        (FIRST, {"law": "coulomb", "pair": "y"}),
        (FIRST, {"law": "coulomb", "pair": "x", "limit": 3}),
        (FIRST, {"law": "relay", "pair": "x"}),
        (FIRST, {"law": "diode", "pair": "x"}),
        (FIRST, {"pair": "x"}),
        ({**FIRST, "impulsive": True}, SECOND),
        ({"law": "coulomb", "pair": "y"}, SECOND),
    ],
)
def test_a_pair_that_does_not_fit(first: dict[str, Any], second: dict[str, Any]) -> None:
    with pytest.raises(hb.HybondError) as caught:
        block(first, second).flatten()
    assert caught.value.code == "HB-M206"


def test_a_third_direction() -> None:
    m = block(FIRST, SECOND, z=hb.One(law="coulomb", pair="x"), m_z=hb.I(1))
    m.bond("z -> m_z")
    with pytest.raises(hb.HybondError) as caught:
        m.flatten()
    assert caught.value.code == "HB-M206"


def test_in_a_file() -> None:
    text = """
hybond = 1
domain = "translational"
[elements]
x = { junction = 1, law = "coulomb", limit = "3 N" }
y = { junction = 1, law = "coulomb", pair = "x" }
m_x = { I = "1 kg", f = "3 m/s" }
m_y = { I = "1 kg", f = "4 m/s" }
[graph]
bonds = ["x -> m_x", "y -> m_y"]
"""
    model = hb.loads(text)
    assert hb.loads(hb.dumps(model)).elements == model.elements
    run = hb.simulate(model, until=2)
    assert run.events[-1].t == pytest.approx(5.0 / 3.0, rel=1e-12)
