"""Switched bonds, switched power junctions and time-dependent junctions."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import hybond as hb

sw = hb.switching
TIGHT = {"rtol": 1e-11}


def drawn(a: str, b: str, forward: bool) -> str:
    return f"{a} -> {b}" if forward else f"{b} -> {a}"


# -- switched bond: against the graph with and without the bond, run piece by piece


def side(m: hb.Model, name: str, kind: str, value: float) -> str:
    """Add a small system that lives on its own; return the node that a bond may end at."""
    if kind == "0":
        m.add(**{name: hb.Zero(), f"{name}c": hb.C(0.5, e=value), f"{name}r": hb.R(2.0)})
        m.bond(f"{name} -> {name}c", f"{name} -> {name}r")
    elif kind == "1":
        m.add(**{name: hb.One(), f"{name}l": hb.I(0.3, f=value), f"{name}r": hb.R(0.7)})
        m.bond(f"{name} -> {name}l", f"{name} -> {name}r")
    elif kind == "C":
        m.add(**{name: hb.C(0.8, e=value)})
    else:
        m.add(**{name: hb.I(0.6, f=value)})
    return name


STATES = {"0": "c.e", "1": "l.f", "C": ".e", "I": ".f"}


@pytest.mark.sampled(3)
@pytest.mark.parametrize("forward", [True, False])
@pytest.mark.parametrize(
    ("a", "b"), [p for p in itertools.product("01CI", repeat=2) if set(p) & {"0", "1"}]
)
def test_a_switched_bond_is_a_bond_that_comes_and_goes(a: str, b: str, forward: bool) -> None:
    def whole(starts: dict[str, float], present: bool | None) -> hb.Model:
        m = hb.Model("switched")
        left, right = side(m, "a", a, starts["a"]), side(m, "b", b, starts["b"])
        if present is None:
            m.machine(
                "S",
                states={"no": [], "yes": []},
                start="no",
                rules=["no -> yes when time >= 0.5 and time < 1", "yes -> no when time >= 1"],
            )
            sw.switched_bond(m, "x", bonds=drawn(left, right, forward), machine="S", on="yes")
        elif present:
            m.bond(drawn(left, right, forward))
        else:  # a junction may stand alone, an element needs some bond
            for k, (name, kind) in enumerate((("a", a), ("b", b))):
                if kind in "CI":
                    m.add(**{f"rest{k}": hb.Sf(0.0) if kind == "C" else hb.Se(0.0)})
                    m.bond(f"rest{k} -> {name}")
        return m

    run = hb.simulate(whole({"a": 2.0, "b": 1.0}, None), until=1.5, **TIGHT)
    # an element's start value is its own, a bond's flow goes along the arrow
    values = {"a": 2.0, "b": 1.0}
    for t, present in ((0.5, False), (1.0, True), (1.5, False)):
        piece = hb.simulate(whole(values, present), until=0.5, **TIGHT)
        for name, kind in (("a", a), ("b", b)):
            stored = f"{name}{STATES[kind].partition('.')[0]}.{'q' if kind in '0C' else 'p'}"
            got = run[stored].at(t, side="left")
            want = piece[stored].at(0.5, side="left")
            assert got == pytest.approx(want, rel=1e-9, abs=1e-9), (t, stored)
            size = {"0": 0.5, "1": 0.3, "C": 0.8, "I": 0.6}[kind]
            values[name] = want / size


def test_between_unlike_junctions_one_controlled_junction_would_hold_both() -> None:
    """A controlled 1-junction alone stops the mass; the bond's absence does not."""
    m = hb.Model("unlike")
    side(m, "a", "0", 2.0)
    side(m, "b", "1", 1.0)
    m.machine("S", states={"no": [], "yes": []}, start="no")
    sw.switched_bond(m, "x", bonds="a -> b", machine="S", on="yes")
    run = hb.simulate(m, until=1, **TIGHT)
    assert run["bl.f"].at(1.0) == pytest.approx(math.exp(-0.7 / 0.3), rel=1e-9)
    assert run["ac.e"].at(1.0) == pytest.approx(2.0 * math.exp(-1.0), rel=1e-9)
    assert (m.elements["x_f"].kind, m.elements["x_e"].kind) == ("1", "0")
    held = hb.Model("held")
    side(held, "a", "0", 2.0)
    side(held, "b", "1", 1.0)
    held.machine("S", states={"no": [], "yes": []}, start="no")
    sw.switched_bond(held, "x", bonds="a -> b", machine="S", on="yes", absent="no flow")
    assert hb.simulate(held, until=1)["bl.f"].at(0.5) == 0.0


@pytest.mark.parametrize("forward", [True, False])
@pytest.mark.parametrize("kind", ["Se", "Sf"])
def test_a_source_whose_bond_is_cut_leaves_the_rest_alone(kind: str, forward: bool) -> None:
    """Se on a 1-junction with a coil, Sf on a 0-junction with a capacitor: driven, then left."""
    m = hb.Model("driven")
    side(m, "b", "1" if kind == "Se" else "0", 0.0)
    m.add(s=hb.Se(3.0) if kind == "Se" else hb.Sf(3.0))
    m.machine("S", states={"y": [], "n": []}, start="y", rules=["y -> n when time >= 0.4"])
    sw.switched_bond(m, "x", bonds=drawn("s", "b", forward), machine="S", on="y")
    run = hb.simulate(m, until=1, **TIGHT)
    name, rate, gain = ("bl.f", 0.7 / 0.3, 1 / 0.7) if kind == "Se" else ("bc.e", 1.0, 2.0)
    # an effort (a flow) that leaves along the arrow of a junction's bond counts against it
    top = (1.0 if forward else -1.0) * 3.0 * gain * (1.0 - math.exp(-0.4 * rate))
    assert run[name].at(0.4) == pytest.approx(top, rel=1e-9)
    assert run[name].at(1.0) == pytest.approx(top * math.exp(-0.6 * rate), rel=1e-9)
    assert run["s.e"].at(0.7) * run["s.f"].at(0.7) == 0.0


@pytest.mark.parametrize("absent", ["no flow", "no effort"])
def test_what_absence_means_can_be_said(absent: str) -> None:
    m = hb.Model("said")
    m.add(a=hb.R(1.0), tf=hb.TF(2.0), n=hb.Zero(), c=hb.C(1.0, e=1.0))
    m.bond("tf -> n -> c")
    m.machine("S", states={"no": [], "yes": []}, start="no")
    with pytest.raises(hb.ModelError, match="HB-M191"):
        sw.switched_bond(m, "x", bonds="a -> tf", machine="S", on="yes")
    sw.switched_bond(m, "x", bonds="a -> tf", machine="S", on="yes", absent=absent)
    assert m.elements["x"].kind == ("1" if absent == "no flow" else "0")
    run = hb.simulate(m, until=1)
    # no flow: the capacitor keeps its charge; no effort: it is shorted through the transformer
    assert run["c.e"].at(1.0) == (1.0 if absent == "no flow" else 0.0)


def test_a_switched_bond_keeps_its_label_and_finds_ports() -> None:
    inner = hb.Model("tank")
    inner.add(level=hb.Zero(), c=hb.C(1.0, e=4.0))
    inner.bond("level -> c")
    inner.port(out="level")
    m = hb.Model("outer")
    m.models["tank"] = inner
    m.add(left=hb.Submodel(inner), right=hb.Submodel("tank"))
    m.machine("S", states={"no": [], "yes": []}, start="yes")
    sw.switched_bond(m, "x", bonds="pipe: left.out -> right.level", machine="S", on="yes")
    assert m.elements["x"].kind == "1"
    assert m.bonds == ["pipe: left.out -> x", "x -> right.level"]
    assert m.flatten().nodes


# -- switched power junction


def three_levels(kind: str, flipped: tuple[bool, ...], *, sugar: bool) -> hb.Model:
    """A load of one storage and one resistor on three sources, of which one decides."""
    m = hb.Model("levels")
    gate = hb.One() if kind == "0" else hb.Zero()
    source = hb.Se if kind == "0" else hb.Sf
    m.add(s1=source(5.0), s2=source(-3.0), s3=source(0.0))
    m.add(load=hb.One() if kind == "0" else hb.Zero(), r=hb.R(2.0))
    m.add(x=hb.I(0.5) if kind == "0" else hb.C(0.5))
    m.bond("load -> x", "load -> r")
    rules = [
        "up -> down when time >= 0.4 and time < 0.8",
        "down -> zero when time >= 0.8",
    ]
    arrows = [drawn(f"s{k}", "j", f) for k, f in enumerate(flipped, 1)]
    if sugar:
        m.machine("S", states={"up": [], "down": [], "zero": []}, start="up", rules=rules)
        sw.switched_power_junction(
            m,
            "j",
            kind=kind,
            machine="S",
            active=dict(zip(arrows, ("up", ["down"], "zero"), strict=True)),
            bonds="j -> load",
        )
        return m
    states = {"up": ["g1"], "down": ["g2"], "zero": ["g3"]}
    m.machine("S", states=states, start="up", rules=rules)
    m.add(j=hb.Zero() if kind == "0" else hb.One(), g1=gate, g2=gate, g3=gate)
    m.bond("j -> load")
    for k, f in enumerate(flipped, 1):
        m.bond(f"s{k} -> g{k} -> j" if f else f"j -> g{k} -> s{k}")
    return m


@pytest.mark.sampled(3)
@pytest.mark.parametrize("kind", ["0", "1"])
@pytest.mark.parametrize("flipped", list(itertools.product([True, False], repeat=3)))
def test_a_switched_power_junction_is_controlled_junctions_and_has_its_closed_form(
    kind: str, flipped: tuple[bool, ...]
) -> None:
    run, want = (
        hb.simulate(three_levels(kind, flipped, sugar=k), until=1.2, **TIGHT) for k in (True, False)
    )
    assert [e.t for e in run.events] == [e.t for e in want.events] == [0.0, 0.4, 0.8]
    t = np.linspace(0.01, 1.19, 25)
    names = [f"{k}.{v}" for k in ("x", "r", "s1", "s2", "s3") for v in "ef"]
    for name in [*names, "j.e" if kind == "0" else "j.f"]:
        assert run[name].at(t) == pytest.approx(want[name].at(t), rel=1e-9, abs=1e-9)
    # I: 0.5 x' = level - 2 x;  C: 0.5 x' = level - x / 2
    rate, gain = (4.0, 0.5) if kind == "0" else (1.0, 2.0)
    x = 0.0
    for level in (5.0, -3.0, 0.0):
        # the common variable is that of each bond along its own arrow: directions do not matter
        x = gain * level + (x - gain * level) * math.exp(-rate * 0.4)
    assert run["x.f" if kind == "0" else "x.e"].at(1.2) == pytest.approx(x, rel=1e-9)
    # what is not active carries no power
    for k, at in ((1, 0.6), (2, 0.2), (3, 0.6)):
        assert run[f"s{k}.e"].at(at) * run[f"s{k}.f"].at(at) == 0.0


@pytest.mark.parametrize(
    ("active", "says"),
    [
        ({"a -> j": "up"}, "'down' of 'S' makes no bond decide"),
        ({"a -> j": ["up", "down"], "b -> j": "down"}, "makes 'a -> j' and 'b -> j' decide"),
        ({}, "no bond can decide"),
    ],
)
def test_gap_and_overlap_are_refused(active, says) -> None:
    m = hb.Model("gap")
    m.add(a=hb.Se(1), b=hb.Se(2), r=hb.R(1))
    m.machine("S", states={"up": [], "down": []}, start="up")
    with pytest.raises(hb.ModelError) as refusal:
        sw.switched_power_junction(m, "j", kind="0", machine="S", active=active, bonds="j -> r")
    assert refusal.value.code == "HB-M192"
    assert says in refusal.value.why
    assert "j" not in m.elements and not m.bonds


def test_labels_stay_at_the_sources() -> None:
    m = hb.Model("labels")
    m.add(a=hb.Se(1), b=hb.Se(2), r=hb.R(1))
    m.machine("S", states={"up": [], "down": []}, start="up")
    active = {"first: a -> j": "up", "second: j -> b": "down"}
    sw.switched_power_junction(m, "j", kind="0", machine="S", active=active, bonds="out: j -> r")
    assert m.bonds == ["first: a -> j_1", "j_1 -> j", "j -> j_2", "second: j_2 -> b", "out: j -> r"]
    assert hb.simulate(m, until=1)['"first".f'].at(0.5) == 1.0


# -- time-dependent junction


def branches(kind: str, flipped: tuple[bool, ...], starts: tuple[float, float]) -> hb.Model:
    """A source with a resistor, a coil with one and a capacitor with one: at one junction j."""
    m = hb.Model("branches")
    m.add(s=hb.Se(4.0), rs=hb.R(1.0), js=hb.One())
    m.bond("s -> js", "js -> rs")
    m.add(L=hb.I(0.5, f=starts[0]), rl=hb.R(0.3), jl=hb.Zero())
    m.bond("jl -> L", "jl -> rl")
    m.add(C=hb.C(0.8, e=starts[1]), rc=hb.R(0.6), jc=hb.One())
    m.bond("jc -> C", "jc -> rc")
    chains = [drawn(h, "j", f) for h, f in zip(("js", "jl", "jc"), flipped, strict=True)]
    if kind in ("0", "1"):
        m.add(j=hb.Zero() if kind == "0" else hb.One())
        m.bond(*chains)
    else:
        plan = [(0, "1"), ("0.4 s", "0"), ("t2", "1")]
        m.parameter(t2=0.9)
        sw.time_dependent_junction(m, "j", bonds=chains, schedule=plan)
    return m


@settings(max_examples=12, deadline=None)
@given(st.tuples(st.booleans(), st.booleans(), st.booleans()))
def test_a_junction_that_changes_its_type_is_one_graph_after_the_other(flipped) -> None:
    run = hb.simulate(branches("", flipped, (1.0, -2.0)), until=1.5, **TIGHT)
    assert [e.t for e in run.events] == [0.0, 0.4, 0.9]
    assert not run.warnings
    starts, last = (1.0, -2.0), 0.0
    for t, kind in ((0.4, "1"), (0.9, "0"), (1.5, "1")):
        piece = hb.simulate(branches(kind, flipped, starts), until=t - last, **TIGHT)
        for name in ("L.f", "C.e", "s.f", "rc.f", "rl.e"):
            got = run[name].at(t, side="left")
            assert got == pytest.approx(piece[name].at(t - last), rel=1e-9, abs=1e-9), (t, name)
        middle = 0.5 * (t + last)
        assert run["s.f"].at(middle) == pytest.approx(piece["s.f"].at(middle - last), rel=1e-9)
        starts = (piece["L.f"].at(t - last), piece["C.e"].at(t - last))
        last = t


@pytest.mark.parametrize("kind", ["0", "1"])
def test_a_junction_that_is_only_switched_off_is_one_controlled_junction(kind: str) -> None:
    m = hb.Model("window")
    m.add(s=hb.Se(3.0) if kind == "1" else hb.Sf(3.0), r=hb.R(2.0))
    m.add(x=hb.I(1.0) if kind == "1" else hb.C(1.0))
    chains = ["s -> j -> x", "j -> r"]
    sw.time_dependent_junction(m, "j", bonds=chains, schedule=[(0, "off"), (1, kind), (2.5, "off")])
    assert list(m.elements) == ["s", "r", "x", "j"]
    run = hb.simulate(m, until=3, **TIGHT)
    rate, final = (2.0, 1.5) if kind == "1" else (0.5, 6.0)
    name = "x.f" if kind == "1" else "x.e"
    assert run[name].at(2.0) == pytest.approx(final * (1 - math.exp(-rate)), rel=1e-9)
    assert run[name].at(0.5) == run[name].at(2.8) == 0.0
    assert run.events[2].steps[0].energy.lost > 0.1


@pytest.mark.parametrize("schedule", [[(0, "1"), (1, "0"), (2, "off")], [(0, "off")], [(0, "2")]])
def test_a_schedule_without_one_meaning_is_refused(schedule) -> None:
    m = hb.Model("bad")
    m.add(a=hb.R(1), b=hb.R(1))
    with pytest.raises(hb.ModelError, match="HB-M191"):
        sw.time_dependent_junction(m, "j", bonds="a -> j -> b", schedule=schedule)
    assert list(m.elements) == ["a", "b"] and not m.machines
