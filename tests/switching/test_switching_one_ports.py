"""Switches with one bond against the controlled junctions they stand for, and closed forms."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mode_strokes import mode_dependent

import hybond as hb
from hybond.model.parts import MachinePart

sw = hb.switching
TIGHT = {"rtol": 1e-11}
DIRECTIONS = ["to", "from"]


def bond(host: str, name: str, direction: str) -> str:
    return f"{host} -> {name}" if direction == "to" else f"{name} -> {host}"


def same_runs(a: hb.Result, b: hb.Result, names: list[str]) -> None:
    """Same events at the same times, with the same jumps, and the same motion."""
    assert len(a.events) == len(b.events) > 1
    for x, y in zip(a.events, b.events, strict=True):
        assert x.t == pytest.approx(y.t, rel=1e-9, abs=1e-12)
        assert x.cause == y.cause
        assert [s.kind for s in x.steps] == [s.kind for s in y.steps]
        assert x.after == pytest.approx(y.after, rel=1e-9, abs=1e-9)
        for s, r in zip(x.steps, y.steps, strict=True):
            assert (s.energy is None) == (r.energy is None)
            if s.energy is not None:
                assert s.energy.lost == pytest.approx(r.energy.lost, rel=1e-9, abs=1e-9)
            for name in names:
                assert s.impulses.get(name, 0.0) == pytest.approx(
                    r.impulses.get(name, 0.0), rel=1e-9, abs=1e-9
                )
    breaks = [0.0, *(e.t for e in a.events), a.t_end]
    for low, high in itertools.pairwise(breaks):
        if high - low > 1e-6:
            t = np.linspace(low, high, 9)[1:-1]
            for name in names:
                assert a[name].at(t) == pytest.approx(b[name].at(t), rel=1e-9, abs=1e-9), name


# -- switched source


def ringing(series: bool) -> hb.Model:
    """A source, a coil, a capacitor and a resistor that ring; the switch is still missing."""
    m = hb.Model("ringing", domain="electrical")
    m.add(V=hb.Se("6 V"), R=hb.R("0.3 ohm"), L=hb.I("0.5 H"), C=hb.C("0.2 F", e="1 V"))
    m.add(i=hb.One(), n=hb.Zero(), load=hb.R("4 ohm"))
    m.bond("V -> i -> L", "i -> R", "i -> n -> C", "n -> load")
    closing = "time >= 1.5" if series else "n.e > 4 and time < 1"
    m.machine(
        "S",
        states={"on": [], "off": []},
        start="on" if series else "off",
        rules=[
            "on -> off when time >= 0.3 and time < 1" if series else "on -> off when time >= 2",
            f"off -> on when {closing}",
        ],
    )
    return m


@pytest.mark.parametrize("direction", DIRECTIONS)
def test_a_switched_source_in_series_is_a_controlled_1_junction(direction: str) -> None:
    """The coil's current is cut at 0.3 s: a jump with an impulse, then a restart at 1.5 s."""
    m = ringing(series=True)
    sw.switched_source(m, "sw", bonds=bond("i", "sw", direction), machine="S", on="on")
    plain = ringing(series=True)
    plain.machines["S"] = MachinePart({"on": ["i"], "off": []}, "on", plain.machines["S"].rules)
    run, want = (hb.simulate(k, until=3, **TIGHT) for k in (m, plain))
    assert run.events[1].steps[0].energy.lost > 0.1
    same_runs(run, want, ["L.f", "L.e", "C.e", "C.f", "R.f", "V.f", "n.e"])
    assert run["sw.e"].at(1.0) == pytest.approx(want["i.e"].at(1.0), rel=1e-9)
    assert run.events[1].steps[0].impulses["sw.e"] == pytest.approx(
        want.events[1].steps[0].impulses["i.e"], rel=1e-9
    )


@pytest.mark.parametrize("direction", DIRECTIONS)
def test_a_switched_source_in_parallel_is_a_0_junction_that_is_off(direction: str) -> None:
    """Shorting the capacitor: null effort where the controlled 0-junction is OFF."""
    m = ringing(series=False)
    sw.switched_source(m, "sw", bonds=bond("n", "sw", direction), machine="S", on="on")
    plain = ringing(series=False)
    plain.machines["S"] = MachinePart({"on": [], "off": ["n"]}, "off", plain.machines["S"].rules)
    run, want = (hb.simulate(k, until=3, **TIGHT) for k in (m, plain))
    same_runs(run, want, ["L.f", "C.e", "C.f", "V.f", "load.f"])
    sign = 1.0 if direction == "to" else -1.0
    at = 0.5 * (run.events[1].t + run.events[2].t)
    assert run["sw.f"].at(at) == pytest.approx(sign * want["n.f"].at(at), rel=1e-9)


# -- resistor behind a Boolean transformer


@pytest.mark.parametrize("direction", DIRECTIONS)
@pytest.mark.parametrize("off", ["open", "short"])
def test_a_resistor_behind_a_boolean_mtf_is_one_behind_a_controlled_junction(
    direction: str, off: str
) -> None:
    host = "n" if off == "open" else "i"
    m, plain = ringing(series=False), ringing(series=False)
    chain = bond(host, "sw", direction)
    sw.boolean_mtf_resistor(m, "sw", bonds=chain, machine="S", on="on", resistance="2 ohm", off=off)
    plain.add(gate=hb.One() if off == "open" else hb.Zero(), sw=hb.R("2 ohm"))
    plain.bond(f"{host} -> gate -> sw" if direction == "to" else f"sw -> gate -> {host}")
    plain.machines["S"] = MachinePart({"on": ["gate"], "off": []}, "off", plain.machines["S"].rules)
    run, want = (hb.simulate(k, until=3, **TIGHT) for k in (m, plain))
    same_runs(run, want, ["L.f", "C.e", "V.f", "load.f"])
    assert run["sw_r.f"].at(0.5) == pytest.approx(
        (1.0 if direction == "to" else -1.0) * want["sw.f"].at(0.5), abs=1e-9
    )


def ladder(count: int, *, mtf: bool) -> hb.Model:
    m = hb.Model("ladder", domain="electrical")
    for k in range(count):
        m.add(**{f"c{k}": hb.C(1.0 + k, e=float(count - k)), f"n{k}": hb.Zero()})
        m.bond(f"n{k} -> c{k}")
    for k in range(count - 1):
        m.add(**{f"i{k}": hb.One()})
        m.machine(f"S{k}", states={"on": [], "off": []}, start="on")
        m.bond(f"n{k} -> i{k} -> n{k + 1}")
        if not mtf:
            m.add(**{f"r{k}": hb.R(0.5)})
            m.bond(f"i{k} -> r{k}")
            m.machines[f"S{k}"] = MachinePart({"on": [f"i{k}"], "off": []}, "on")
        else:
            sw.boolean_mtf_resistor(
                m, f"sw{k}", bonds=f"i{k} -> sw{k}", machine=f"S{k}", on="on", resistance=0.5
            )
    return m


def test_its_causality_is_static_where_that_of_a_controlled_junction_is_not() -> None:
    modes = [(a, b, c) for a in (0, 1) for b in (0, 1) for c in (0, 1)]
    assert mode_dependent(ladder(4, mtf=True).flatten(), modes) == {}
    assert mode_dependent(ladder(4, mtf=False).flatten(), modes) != {}


@pytest.mark.slow
@settings(max_examples=15, deadline=None)
@given(
    st.lists(st.floats(0.2, 3.0), min_size=3, max_size=4),
    st.lists(st.tuples(st.floats(0.1, 0.9), st.booleans()), min_size=2, max_size=3),
    st.lists(st.booleans(), min_size=3, max_size=3),
)
def test_random_networks_of_switched_resistors(caps, schedule, flipped) -> None:
    """Against matrix exponentials of the network's own equations, piece by piece."""
    from scipy.linalg import expm

    n = len(caps)
    start = np.arange(1.0, n + 1.0)
    m = hb.Model("network")
    for k in range(n):
        m.add(**{f"c{k}": hb.C(caps[k], e=start[k]), f"n{k}": hb.Zero()})
        m.bond(f"n{k} -> c{k}")
    times = [sum(d for d, _ in schedule[: j + 1]) for j in range(len(schedule))]
    for k in range(n - 1):
        first = k % 2 == 0
        states = {f"s{j}": [] for j in range(len(schedule) + 1)}
        rules = [f"s{j} -> s{j + 1} when time >= {t!r}" for j, t in enumerate(times)]
        m.machine(f"S{k}", states=states, start="s0", rules=rules)
        closed = [first] + [b == first for _, b in schedule]
        on = [f"s{j}" for j, c in enumerate(closed) if c]
        m.add(**{f"i{k}": hb.One()})
        m.bond(f"n{k} -> i{k} -> n{k + 1}")
        if not on:
            on = ["s0"]  # a switch needs one state in which it is closed
        name = f"sw{k}"
        sw.boolean_mtf_resistor(
            m,
            name,
            bonds=bond(f"i{k}", name, "from" if flipped[k] else "to"),
            machine=f"S{k}",
            on=on,
            resistance=1.0 + k,
        )
    run = hb.simulate(m, until=times[-1] + 0.5, **TIGHT)
    e = start.copy()
    last = 0.0
    for j, t in enumerate([*times, times[-1] + 0.5]):
        a = np.zeros((n, n))
        for k in range(n - 1):
            closed = [k % 2 == 0] + [b == (k % 2 == 0) for _, b in schedule]
            if closed[j] or (not any(closed) and j == 0):
                g = 1.0 / (1.0 + k)
                for i, other in ((k, k + 1), (k + 1, k)):
                    a[i, i] -= g / caps[i]
                    a[i, other] += g / caps[i]
        e = expm(a * (t - last)) @ e
        last = t
    for k in range(n):
        assert run[f"c{k}.e"].at(run.t_end) == pytest.approx(e[k], rel=1e-9, abs=1e-9)


# -- modulated resistor


def coil_with_switch(r_on: float | None, r_off: float | None, direction: str = "to") -> hb.Model:
    """10 V, 1 ohm, 1 H beside a 5 ohm path: what the ideal switch leaves alone on opening."""
    m = hb.Model("coil", domain="electrical")
    m.add(V=hb.Se("10 V"), i=hb.One(), n=hb.Zero(), R=hb.R("1 ohm"), L=hb.I("1 H"))
    m.add(out=hb.One(), path=hb.R("5 ohm"))
    m.bond("V -> i -> n -> out -> L", "out -> R", "n -> path")
    states: dict[str, list[str]] = {"closed": [], "open": []}
    if r_on is None:
        states = {"closed": ["i"], "open": []}
    m.machine("S", states=states, start="closed", rules=["closed -> open when time >= 1"])
    if r_on is not None:
        chain = bond("i", "sw", direction)
        sw.modulated_resistor(
            m, "sw", bonds=chain, machine="S", on="closed", r_on=r_on, r_off=r_off
        )
    return m


@pytest.mark.parametrize("direction", DIRECTIONS)
def test_a_modulated_resistor_is_exact_as_a_resistor(direction: str) -> None:
    """Two exponentials: the Thevenin source of V and the switch's resistance at the node."""
    r_on, r_off = 0.5, 40.0
    run = hb.simulate(coil_with_switch(r_on, r_off, direction), until=2, **TIGHT)
    current = 0.0
    for t0, r in ((0.0, r_on), (1.0, r_off)):
        v = 10.0 * 5.0 / (5.0 + r)
        total = 1.0 + 5.0 * r / (5.0 + r)
        current = v / total + (current - v / total) * math.exp(-total)
        assert run["L.f"].at(t0 + 1.0) == pytest.approx(current, rel=1e-9)


def test_a_modulated_resistor_approximates_the_ideal_switch_to_first_order() -> None:
    ideal = hb.simulate(coil_with_switch(None, None), until=2, **TIGHT)
    exact = [ideal["L.f"].at(t) for t in (1.0, 2.0)]

    def error(r_on: float, r_off: float, k: int) -> float:
        run = hb.simulate(coil_with_switch(r_on, r_off), until=2, **TIGHT)
        return abs(run["L.f"].at(1.0 + k) - exact[k])

    closed = [error(r, 1e9, 0) for r in (1e-2, 1e-3, 1e-4)]
    assert [math.log10(a / b) for a, b in itertools.pairwise(closed)] == pytest.approx(
        [1.0, 1.0], abs=0.02
    )
    opened = [error(1e-9, r, 1) for r in (1e3, 1e4, 1e5)]
    assert [math.log10(a / b) for a, b in itertools.pairwise(opened)] == pytest.approx(
        [1.0, 1.0], abs=0.02
    )


def test_its_resistances_are_parameters() -> None:
    m = coil_with_switch(1.0, 1e6)
    changed = hb.simulate(m, until=1, parameters={"sw_on": 0.5}, **TIGHT)
    given = hb.simulate(coil_with_switch(0.5, 1e6), until=1, **TIGHT)
    assert changed["L.f"].at(0.9) == given["L.f"].at(0.9)


# -- switched storage


def storage_model(kind: str, direction: str, *, sugar: bool) -> hb.Model:
    m = hb.Model("storage")
    host, junction = ("n", hb.Zero()) if kind == "C" else ("i", hb.One())
    element = hb.C(2.0, e=3.0) if kind == "C" else hb.I(2.0, f=3.0)
    source = hb.Sf(0.5) if kind == "C" else hb.Se(0.5)
    m.add(source=source, r=hb.R(4.0), **{host: junction})
    m.bond(f"source -> {host} -> r")
    m.machine(
        "S",
        states={"on": [], "off": []},
        start="on",
        rules=["on -> off when time >= 1 and time < 2", "off -> on when time >= 2"],
    )
    if sugar:
        sw.switched_storage(
            m, "x", bonds=bond(host, "x", direction), machine="S", on="on", element=element
        )
    else:
        m.add(x=element, gate=hb.Zero() if kind == "C" else hb.One())
        m.bond(f"{host} -> gate -> x" if direction == "to" else f"x -> gate -> {host}")
        m.machines["S"] = MachinePart({"on": ["gate"], "off": []}, "on", m.machines["S"].rules)
    return m


@pytest.mark.parametrize("direction", DIRECTIONS)
@pytest.mark.parametrize("kind", ["C", "I"])
def test_a_switched_storage_is_a_controlled_junction_before_it(kind: str, direction: str) -> None:
    run, want = (
        hb.simulate(storage_model(kind, direction, sugar=k), until=3, **TIGHT)
        for k in (True, False)
    )
    same_runs(run, want, ["x.e", "x.f", "r.e", "r.f", "source.e", "source.f"])


@pytest.mark.parametrize("direction", DIRECTIONS)
@pytest.mark.parametrize("kind", ["C", "I"])
def test_a_switched_storage_loses_what_it_stores_and_says_so(kind: str, direction: str) -> None:
    """C: 2 F and 4 ohm at 0.5 A; I: 2 H and 4 ohm at 0.5 V. Forgotten at 1 s, back at 2 s."""
    run = hb.simulate(storage_model(kind, direction, sugar=True), until=3, **TIGHT)
    # the start value holds for power into the element, the bond's flow goes along its arrow
    start = 3.0 if direction == "to" or kind == "C" else -3.0
    variable, stored = ("x.e", "x.q") if kind == "C" else ("x.f", "x.p")
    tau, final = (8.0, 2.0) if kind == "C" else (0.5, 0.125)
    before = final + (start - final) * math.exp(-1.0 / tau)
    opened = run.events[1]
    assert opened.t == 1.0
    assert abs(opened.before[0]) == pytest.approx(2.0 * abs(before), rel=1e-9)
    assert opened.after[0] == 0.0
    energy = opened.steps[0].energy
    assert energy.lost == pytest.approx(before**2, rel=1e-9)
    assert energy.after == 0.0
    taken = list(opened.steps[0].exchanged.values())
    assert max(abs(a) for a in taken) == pytest.approx(2.0 * abs(before), rel=1e-9)
    assert run[stored].at(1.5) == 0.0
    again = final * (1.0 - math.exp(-1.0 / tau))
    assert run[variable].at(3.0) == pytest.approx(again, rel=1e-9)


# -- refusals, and that nothing is left half done


@pytest.mark.parametrize(
    ("code", "options"),
    [
        ("HB-M190", {"bonds": "n -> i"}),
        ("HB-M190", {"bonds": "n -> sw -> i"}),
        ("HB-M109", {"bonds": "sw"}),
        ("HB-M144", {"machine": "T"}),
        ("HB-M144", {"on": "onn"}),
        ("HB-M144", {"on": []}),
    ],
)
def test_a_part_that_does_not_fit_is_refused_and_leaves_the_model_alone(code, options) -> None:
    m = ringing(series=True)
    before = (dict(m.elements), list(m.bonds), dict(m.machines))
    with pytest.raises(hb.ModelError) as refusal:
        sw.switched_source(m, "sw", **{"bonds": "i -> sw", "machine": "S", "on": "on"} | options)
    assert refusal.value.code == code
    assert (m.elements, m.bonds, m.machines) == before


def test_a_switched_storage_must_store() -> None:
    m = ringing(series=True)
    with pytest.raises(hb.ModelError, match="HB-M191"):
        sw.switched_storage(m, "x", bonds="i -> x", machine="S", on="on", element=hb.R(1))
    with pytest.raises(hb.ModelError, match="HB-M191"):
        sw.boolean_mtf_resistor(
            m, "x", bonds="i -> x", machine="S", on="on", resistance=1, off="shut"
        )


def test_what_is_added_is_saved_in_a_file() -> None:
    m = ringing(series=True)
    sw.switched_source(m, "sw", bonds="i -> sw", machine="S", on="on")
    sw.boolean_mtf_resistor(m, "leak", bonds="n -> leak", machine="S", on="off", resistance=9)
    sw.modulated_resistor(
        m, "aux", bonds="n -> aux", machine="S", on="on", r_on="1 ohm", r_off="1 kohm"
    )
    again = hb.loads(hb.dumps(m))
    run, want = (hb.simulate(k, until=1, **TIGHT) for k in (m, again))
    assert run["L.f"].at(0.9) == want["L.f"].at(0.9)
