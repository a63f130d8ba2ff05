"""Junctions with a law: what they are opened into, what is refused, and how files keep them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import hybond as hb
from hybond.files import dumps, load, loads, save, to_data
from hybond.model.expressions import Name, Neg, Number
from hybond.model.graph import FlatGraph
from hybond.model.parts import MachinePart, Part

STATES = {
    "diode": ("blocks", "conducts"),
    "thyristor": ("blocks", "conducts"),
    "unilateral": ("open", "closed"),
    "coulomb": ("sticks", "forward", "backward"),
    "relay": ("sticks", "forward", "backward"),
}
NEEDS = {"thyristor": {"gate": "time > 1 s"}, "coulomb": {"limit": 2.0}, "relay": {"limit": 2.0}}


def series(**options: Any) -> hb.Model:
    m = hb.Model("series")
    m.add(u=hb.Se("sin(time/(1 s))"), j=hb.One(**options), r=hb.R(1))
    m.bond("u -> j -> r")
    return m


def parallel(**options: Any) -> hb.Model:
    m = hb.Model("parallel")
    m.add(u=hb.Sf("sin(time/(1 s))"), j=hb.Zero(**options), r=hb.R(1))
    m.bond("u -> j -> r")
    return m


def at(run: hb.Result, name: str, t: Any) -> Any:
    """Return a signal at some times; at an event its value after it."""
    assert run.status == "ok", run.error
    return np.array(run[name].at(t))


def refused(m: hb.Model) -> str:
    with pytest.raises(hb.HybondError) as caught:
        m.flatten()
    return caught.value.code


def machine_of(graph: FlatGraph, path: str = "j") -> Any:
    return next(m for m in graph.machines if m.path == path)


# -- every law on both kinds of junction


@pytest.mark.parametrize("kind", STATES)
@pytest.mark.parametrize("make", [series, parallel])
def test_a_law_is_a_machine_with_a_pair(kind: str, make: Any) -> None:
    if kind == "thyristor" and make is parallel:
        assert refused(make(law=kind, **NEEDS[kind])) == "HB-M200"
        return
    graph = make(law=kind, **NEEDS.get(kind, {})).flatten()
    machine = machine_of(graph)
    assert machine.states == STATES[kind] and machine.start == 0
    junction = graph.nodes[graph.by_path["j"]]
    assert junction.controlled and machine.law.node == junction.index
    assert machine.on[0] == frozenset() and machine.on[1] == {junction.index}
    common, net = ("f", "e") if junction.kind == "1" else ("e", "f")
    assert machine.law.common == Name(f"{common}:0")
    # what comes in over the source's bond goes out over the resistor's
    assert str(machine.law.net) == f"{net}:0 - {net}:1"
    two_sided = kind in ("coulomb", "relay")
    assert machine.law.two_sided == two_sided
    source = [n for n in graph.nodes if n.implied]
    assert [n.path for n in source] == (["j.friction"] if two_sided else [])
    assert (machine.law.source == source[0].index) if source else machine.law.source is None


@pytest.mark.parametrize("make", [series, parallel])
def test_restitution_makes_a_branch_and_a_source(make: Any) -> None:
    graph = make(law="unilateral", restitution=0.5).flatten()
    machine = machine_of(graph)
    assert machine.states == ("open", "closed", "impact")
    assert machine.fieldless == (False, False, True)
    source = graph.nodes[machine.law.source]
    assert source.path == "j.rebound" and source.implied
    assert source.kind == ("Se" if make is series else "Sf")
    assert machine.law.restitution == Number(0.5)


@pytest.mark.parametrize(("make", "pair"), [(series, ("j.f", "j.e")), (parallel, ("j.e", "j.f"))])
def test_signals_of_the_pair_leave_out_the_source_of_the_law(make: Any, pair: Any) -> None:
    m = make(law="coulomb", limit=0.25)
    m.signal(common=pair[0], net=pair[1])
    law = machine_of(graph := m.flatten()).law
    assert graph.signals["net"] == law.net
    assert graph.signals["common"] == law.common
    own = graph.nodes[law.source].ends[0].bond
    assert not any(name.endswith(f":{own}") for name in map(str, [law.net]))
    # closed form: what slides is u - 0.25 sgn, the net variable is the friction force itself
    run = hb.simulate(m, until=6)
    t = np.linspace(0.05, 5.95, 60)
    u = np.sin(t)
    want = np.where(np.abs(u) > 0.25, u - 0.25 * np.sign(u), 0.0)
    np.testing.assert_allclose(at(run, "common", t), want, atol=1e-9)
    np.testing.assert_allclose(at(run, "net", t), u - want, atol=1e-9)


@pytest.mark.parametrize("make", [series, parallel])
@pytest.mark.parametrize("law", ["diode", "unilateral"])
def test_one_sided_laws_cut_a_sine(make: Any, law: str) -> None:
    m = make(law=law)
    variable = "f" if make is series else "e"
    m.signal(common=f"j.{variable}")
    run = hb.simulate(m, until=7)
    t = np.linspace(0.1, 6.9, 50)
    np.testing.assert_allclose(at(run, "common", t), np.maximum(np.sin(t), 0.0), atol=1e-9)


def test_a_thyristor_begins_with_its_gate_and_ends_with_its_current() -> None:
    m = series(law="thyristor", gate="time > 1 s")
    m.signal(current="j.f")
    run = hb.simulate(m, until=9)
    t = np.array([0.5, 0.99, 1.01, 3.0, 3.2, 6.0, 6.5, 9.0])
    want = np.where(t > 1.0, np.maximum(np.sin(t), 0.0), 0.0)
    np.testing.assert_allclose(at(run, "current", t), want, atol=1e-9)


# -- units


def block(**options: Any) -> hb.Model:
    m = hb.Model("block", domain="translational", parameters={"mu": 0.5, "N": "10 N"})
    m.add(m=hb.I("2 kg", f="3 m/s"), v=hb.One(**options))
    m.bond("v -> m")
    m.signal(height=hb.Integral("v.f", start="1 m"))
    return m


@pytest.mark.parametrize(
    "options",
    [
        {"law": "coulomb", "limit": "3 [m/s]"},
        {"law": "coulomb", "limit": "3 m"},
        {"law": "relay", "limit": "mu*m.f"},
    ],
)
def test_a_limit_in_the_wrong_unit_is_refused(options: Any) -> None:
    assert refused(block(**options)) == "HB-U103"


@pytest.mark.parametrize(
    ("options", "where"),
    [({"limit": "6 kg"}, "limit"), ({"limit": "6 N", "breakaway": "6 kg"}, "breakaway")],
)
@pytest.mark.parametrize("pair", [False, True])
def test_a_wrong_unit_is_shown_where_it_was_written(options: Any, where: str, pair: bool) -> None:
    m = block(law="coulomb", **options)
    if pair:
        m.add(w=hb.One(law="coulomb", pair="v"), n=hb.I("2 kg"))
        m.bond("w -> n")
    with pytest.raises(hb.HybondError) as caught:
        m.flatten()
    assert caught.value.code == "HB-U103" and caught.value.where == f"elements.v.{where}"
    assert caught.value.why == f"'6 kg' is in kg; {where} is in N"


def test_a_sum_of_unlike_units_is_shown_where_it_was_written() -> None:
    with pytest.raises(hb.UnitError) as caught:
        block(law="coulomb", limit="1[N] + 6[kg]").flatten()
    assert caught.value.where == "elements.v.limit"


def test_a_gap_is_a_distance() -> None:
    def contact(gap: str) -> hb.Model:
        m = block()
        m.add(c=hb.Zero(law="unilateral", gap=gap))
        m.bond("c -> v")
        return m

    assert refused(contact("v.f")) == "HB-U103"
    assert machine_of(contact("height").flatten(), "c").law.gap == Name("s:0")
    assert refused(contact("2 N")) == "HB-U103"


def test_a_limit_may_be_a_formula_of_parameters() -> None:
    law = machine_of(block(law="coulomb", limit="mu*N", breakaway="1.2*mu*N").flatten(), "v").law
    assert law.limit == Number(5.0) and law.breakaway == Number(6.0)
    graph = block(law="coulomb", limit="mu*N").flatten(parameters={"mu": 0.1})
    assert machine_of(graph, "v").law.limit == Number(1.0)


@pytest.mark.parametrize(
    ("given", "want"),
    [("10 mN", 0.01), ("2 N", 2.0), ("2.5e-1 kg*m/s^2", 0.25), ("3 [N]", 3.0), ("2", 2.0)],
)
def test_a_quantity_is_read_as_one(given: str, want: float) -> None:
    # m is an element and N a parameter of this model: neither is meant by a unit
    graph = block(law="coulomb", limit=given, breakaway=given).flatten()
    law = machine_of(graph, "v").law
    assert law.limit == Number(want) and law.breakaway == Number(want)
    # closed form: 3 m/s and 2 kg slow down by limit/2 kg
    m = block(law="coulomb", limit=given, breakaway=given)
    m.signal(speed="v.f")
    np.testing.assert_allclose(at(hb.simulate(m, until=0.5), "speed", 0.5), 3 - want / 4, rtol=1e-9)


def test_a_product_of_units_is_read_as_one() -> None:
    m = hb.Model("shaft", domain="rotational")
    m.add(j=hb.I("2 kg*m^2", f="3 rad/s"), w=hb.One(law="coulomb", limit="2 N*m"))
    m.bond("w -> j")
    m.signal(speed="w.f")
    np.testing.assert_allclose(at(hb.simulate(m, until=1), "speed", 1.0), 2.0, rtol=1e-9)


def test_a_gap_may_be_a_quantity() -> None:
    m = block()
    m.add(c=hb.Zero(law="unilateral", gap="10 mm"))
    m.bond("c -> v")
    assert machine_of(m.flatten(), "c").law.gap == Number(0.01)


# -- refusals


@pytest.mark.parametrize(
    "options", [{"law": "diode"}, {"restitution": 0.5}, {"gap": "time"}, {"limit": 1}]
)
def test_only_junctions_have_laws(options: Any) -> None:
    m = series()
    with pytest.raises(hb.HybondError) as caught:
        m.add(x=hb.R("1 ohm", **options))
    assert caught.value.code == "HB-M201"
    assert 'hb.R({"e": "..."}); only junctions have laws' in caught.value.hint
    m.add(x=Part("R", "1 ohm", options))
    m.bond("j -> x")
    with pytest.raises(hb.HybondError) as caught:
        m.flatten()
    assert caught.value.code == "HB-M201"
    assert '{ R = { e = "..." } }; only junctions have laws' in caught.value.hint


@pytest.mark.parametrize("gate", ["time", "2", 1.0])
def test_a_gate_is_a_condition(gate: Any) -> None:
    with pytest.raises(hb.HybondError) as caught:
        series(law="thyristor", gate=gate).flatten()
    assert caught.value.code == "HB-M146" and caught.value.where == "elements.j.gate"


def test_a_gate_may_be_always_open() -> None:
    m = series(law="thyristor", gate=True)
    m.signal(current="j.f")
    t = np.linspace(0.1, 6.9, 20)
    want = np.maximum(np.sin(t), 0.0)
    np.testing.assert_allclose(at(hb.simulate(m, until=7), "current", t), want, atol=1e-9)


def test_each_wrong_number_has_its_own_hint() -> None:
    hints = set()
    for options in (
        {"law": "unilateral", "restitution": -0.1},
        {"law": "coulomb", "limit": -1},
        {"law": "unilateral", "restitution": 0.5, "stiffness": -1},
        {"law": "coulomb", "limit": 2, "breakaway": 1},
    ):
        with pytest.raises(hb.ModelError) as caught:
            series(**options).flatten()
        hints.add(caught.value.hint)
    assert len(hints) == 4


@pytest.mark.parametrize(("eps", "count"), [(1.0, 0), (1.8, 1)])
def test_a_restitution_above_one_warns(eps: float, count: int) -> None:
    graph = series(law="unilateral", restitution=eps).flatten()
    assert sum("creates energy at each impact" in w for w in graph.warnings) == count


# -- refusals of one option


@pytest.mark.parametrize(
    ("options", "code"),
    [
        ({"law": "dioode"}, "HB-M200"),
        ({"law": 3}, "HB-M200"),
        ({"limit": 2}, "HB-M201"),
        ({"law": "diode", "gap": "time"}, "HB-M201"),
        ({"law": "diode", "gate": "time > 1"}, "HB-M201"),
        ({"law": "thyristor"}, "HB-M201"),
        ({"law": "coulomb"}, "HB-M201"),
        ({"law": "relay"}, "HB-M201"),
        ({"law": "coulomb", "limit": -1}, "HB-M203"),
        ({"law": "coulomb", "limit": 2, "breakaway": 1}, "HB-M203"),
        ({"law": "unilateral", "restitution": -0.1}, "HB-M203"),
        ({"law": "unilateral", "restitution": 0.5, "stiffness": -1}, "HB-M203"),
    ],
)
def test_what_has_no_meaning_is_refused(options: Any, code: str) -> None:
    assert refused(series(**options)) == code


def test_a_machine_may_not_switch_a_junction_with_a_law() -> None:
    m = series(law="diode")
    m.machine("S", states={"off": [], "on": ["j"]}, start="off")
    assert refused(m) == "HB-M142"


def test_a_machine_of_the_same_name_is_refused() -> None:
    m = series(law="diode")
    m.add(k=hb.One())
    with pytest.raises(hb.ModelError) as caught:
        m.machine("j", states={"off": [], "on": ["k"]}, start="off")
    assert caught.value.code == "HB-M104"


@pytest.mark.parametrize("taken", ["j", "j.friction"])
def test_the_names_of_what_a_law_makes_are_taken(taken: str) -> None:
    # the builder refuses names used twice; a model that a program has edited may have them
    m = series(law="coulomb", limit=1)
    m.add(k=hb.One())
    if taken == "j":
        m.machines["j"] = MachinePart({"off": (), "on": ("k",)}, "off", ())
    else:
        m.elements["j.friction"] = hb.R(1)
    with pytest.raises(hb.ModelError) as caught:
        m.flatten()
    assert caught.value.code == "HB-M202" and caught.value.where == "j"


@pytest.mark.parametrize(
    "value",
    ['if j.state == "conducts" then 1 else 2', "if j.on then 1 else 2", "if busy then 1 else 2"],
)
def test_a_law_may_not_read_the_branch_that_follows_from_it(value: str) -> None:
    m = series(law="diode")
    m.add(s=hb.R(value))
    m.bond("j -> s")
    m.signal(busy='j.state == "conducts"')
    assert refused(m) == "HB-M204"


@pytest.mark.parametrize("option", ["limit", "breakaway"])
def test_an_option_may_not_read_the_branch_of_another_law(option: str) -> None:
    m = series(law="diode")
    options = {"limit": 1, option: 'if j.state == "conducts" then 2 else 1'}
    m.add(k=hb.One(law="coulomb", **options), s=hb.R(1))
    m.bond("j -> k -> s")
    assert refused(m) == "HB-M204"


def test_signals_and_guards_may_read_the_branch() -> None:
    m = hb.Model("switched")
    m.add(u=hb.Se("sin(time/(1 s))"), j=hb.One(law="diode"), n=hb.Zero(), r=hb.R(1))
    m.add(k=hb.One(), s=hb.R(1))
    m.bond("u -> j -> n -> r", "n -> k -> s")
    m.machine(
        "S",
        states={"off": [], "on": ["k"]},
        start="off",
        rules=['off -> on when time >= 1 and j.state == "blocks"'],
    )
    m.signal(
        busy='j.state == "conducts"', used=hb.Integral('if j.state == "conducts" then 1 else 0')
    )
    run = hb.simulate(m, until=7)
    assert [bool(b) for b in at(run, "busy", np.array([1.0, 4.0, 6.5]))] == [True, False, True]
    # it conducts for half a period, then from 2 pi on
    np.testing.assert_allclose(
        at(run, "used", np.array([7.0])), [np.pi + 7.0 - 2 * np.pi], rtol=1e-6
    )
    m.signal(on="k.on")
    run = hb.simulate(m, until=7)
    near = np.array([np.pi - 1e-6, np.pi + 1e-6])
    assert [bool(b) for b in at(run, "on", near)] == [False, True]


# -- submodels: names of a law are those of its own model


def test_a_law_inside_a_submodel_reads_the_names_of_its_submodel() -> None:
    slider = hb.Model("slider", parameters={"mu": 0.5, "N": "10 N"}, domain="translational")
    slider.add(v=hb.One(law="coulomb", limit="mu*N"), m=hb.I("1 kg"))
    slider.bond("v -> m")
    slider.port(p="v")
    m = hb.Model("two", domain="translational", parameters={"mu": 0.9})
    m.add(a=hb.Submodel(slider), b=hb.Submodel(slider, mu="mu"), F=hb.Se("20 N"), G=hb.Se("20 N"))
    m.bond("F -> a.p", "G -> b.p")
    graph = m.flatten()
    assert {x.path for x in graph.machines} == {"a.v", "b.v"}
    assert machine_of(graph, "a.v").law.limit == Number(5.0)
    assert machine_of(graph, "b.v").law.limit == Number(9.0)
    assert {n.path for n in graph.nodes if n.implied} == {"a.v.friction", "b.v.friction"}
    m.signal(va="a.v.f", vb="b.v.f", moving='a.v.state == "forward"')
    run = hb.simulate(m, until=1)
    np.testing.assert_allclose([at(run, "va", 1.0), at(run, "vb", 1.0)], [15.0, 11.0], rtol=1e-9)
    assert bool(at(run, "moving", 1.0))


def test_gap_and_restitution_inside_a_submodel() -> None:
    ball = hb.Model("ball", parameters={"eps": 0.5}, domain="translational")
    ball.add(v=hb.One(), m=hb.I("1 kg"), w=hb.Se("-10 N"))
    ball.add(contact=hb.Zero(law="unilateral", gap="h", restitution="eps"))
    ball.bond("w -> v -> m", "contact -> v")
    ball.signal(h=hb.Integral("v.f", start="5 m"))
    m = hb.Model("court")
    m.add(one=hb.Submodel(ball))
    m.signal(h="one.h")
    run = hb.simulate(m, until=1.2)
    # down in 1 s with 10 m/s, up with 5 m/s: 5*0.2 - 5*0.04
    np.testing.assert_allclose(at(run, "h", 1.2), 0.8, atol=1e-7)


# -- files

TEXT = """hybond = 1
title  = "laws"

[parameters]
eps = 0.5

[elements]
u = { Se = 1 }
a = { junction = 1, law = "diode" }
b = { junction = 1, law = "thyristor", gate = "time > 1" }
c = { junction = 0, law = "unilateral", gap = "h", restitution = "eps", stiffness = 100 }
d = { junction = 1, law = "coulomb", limit = "2*eps", breakaway = 2, impulsive = true }
e = { junction = 0, law = "relay", limit = 3 }
i = { I = 1 }
r = { R = 1 }

[graph]
bonds = ["u -> a -> b -> d -> i", "c -> d", "a -> e -> r"]

[signals]
h = { integral = "i.f", start = 1 }
"""


@pytest.mark.parametrize("form", ["toml", "json"])
def test_files_keep_laws(form: str, tmp_path: Any) -> None:
    model = loads(TEXT)
    path = tmp_path / f"laws.{form}"
    save(model, path)
    again = load(path)
    assert to_data(again) == to_data(model)
    assert [m.law for m in again.flatten().machines] == [m.law for m in model.flatten().machines]
    assert {m.law.kind for m in again.flatten().machines} == set(STATES)


def test_python_and_file_say_the_same() -> None:
    m = hb.Model("laws", title="laws", parameters={"eps": 0.5})
    m.add(
        u=hb.Se(1),
        a=hb.One(law="diode"),
        b=hb.One(law="thyristor", gate="time > 1"),
        c=hb.Zero(law="unilateral", gap="h", restitution="eps", stiffness=100),
        d=hb.One(law="coulomb", limit="2*eps", breakaway=2, impulsive=True),
        e=hb.Zero(law="relay", limit=3),
        i=hb.I(1),
        r=hb.R(1),
    )
    m.bond("u -> a -> b -> d -> i", "c -> d", "a -> e -> r")
    m.signal(h=hb.Integral("i.f", start=1))
    assert [x.law for x in m.flatten().machines] == [x.law for x in loads(TEXT).flatten().machines]
    assert loads(dumps(m)).elements == m.elements


def test_the_net_variable_of_one_bond_has_its_sign() -> None:
    m = block()
    m.add(c=hb.Zero(law="unilateral"))
    m.bond("c -> v")
    law = machine_of(graph := m.flatten(), "c").law
    bond = graph.nodes[law.node].ends[0].bond
    assert law.net == Neg(Name(f"f:{bond}"))
