"""Advice is followed: the changed model is written, its causality and its speed looked at."""

import math
import random
from pathlib import Path

import numpy as np
import pytest

import hybond as hb
from hybond.causality.advice import Advice, advise
from hybond.causality.assign import assign
from hybond.causality.dynamics import dynamics
from hybond.causality.loop_gain import loop_gain
from hybond.causality.reference import reference_mode
from hybond.causality.time_constants import coefficients, time_constants


def circuit(elements: dict, bonds: list[str], machines: dict[str, list[str]]) -> hb.Model:
    """Return a model; each machine switches what it lists ON together, and starts so."""
    m = hb.Model("circuit")
    m.add(**elements)
    m.bond(*bonds)
    for name, on in machines.items():
        m.machine(name, states={"on": on, "off": []}, start="on", rules=["on -> off when time > 1"])
    return m


def opened_coil() -> hb.Model:
    parts = {"V": hb.Se(10), "sw": hb.One(), "r": hb.R(1), "l": hb.I(0.1), "i": hb.One()}
    return circuit(parts, ["V -> sw", "sw -> i", "i -> l", "i -> r"], {"S": ["sw"]})


def two_capacitors() -> hb.Model:
    parts = {"c": hb.C(2e-3), "a": hb.Zero(), "sw": hb.One(), "b": hb.Zero(), "d": hb.C(3e-3)}
    parts |= {"r": hb.R(5), "g": hb.R(7)}
    bonds = ["a -> c", "a -> sw", "sw -> b", "b -> d", "a -> r", "b -> g"]
    return circuit(parts, bonds, {"S": ["sw"]})


def rigid_clutch() -> hb.Model:
    parts = {"p": hb.I(10), "v": hb.One(), "grip": hb.Zero(), "w": hb.One(), "q": hb.I(1)}
    parts |= {"b": hb.R(0.1), "fan": hb.R(5)}
    bonds = ["v -> p", "v -> b", "v -> grip", "grip -> w", "w -> q", "w -> fan"]
    return circuit(parts, bonds, {"S": ["grip"]})


def geared_clutch() -> hb.Model:
    """The load turns four times faster, so its inertia counts sixteenfold."""
    m = rigid_clutch()
    m.add(gear=hb.TF(4), u=hb.One())
    m.bonds.remove("grip -> w")
    m.bond("grip -> u", "u -> gear", "gear -> w")
    return m


def half_bridge() -> hb.Model:
    m = hb.Model("bridge")
    m.add(plus=hb.Se(24), minus=hb.Se(0), upper=hb.One(), lower=hb.One(), out=hb.Zero())
    m.add(i=hb.One(), L=hb.I(1e-3), R=hb.R(2))
    m.bond("plus -> upper", "minus -> lower", "upper -> out", "lower -> out", "out -> i")
    m.bond("i -> L", "i -> R")
    rules = ["high -> low when time > 1", "low -> high when time > 2"]
    m.machine("leg", states={"high": ["upper"], "low": ["lower"]}, start="high", rules=rules)
    return m


def followed(model: hb.Model, advice: Advice) -> hb.Model:
    """Return the model with the resistors of an advice written into it, by its own bonds."""
    for r in advice.resistors:
        value = r.value if r.value is not None else 1e-3
        model.add(**{r.name: hb.R(value)})
        if r.splits:
            model.add(**{r.junction: hb.Zero() if r.kind == "0" else hb.One()})
            model.bonds.remove(r.splits)
        model.bond(*r.bonds())
    for bond, at in advice.pins.items():
        model.pin(bond, at=at)
    return model


@pytest.mark.parametrize(
    "make", [opened_coil, two_capacitors, rigid_clutch, geared_clutch, half_bridge]
)
def test_following_the_advice_makes_causality_static(make) -> None:
    before = make().flatten()
    (advice,) = advise(before)
    assert advice.resistors
    assert len(dynamics(before).dynamic) > 0
    changed = followed(make(), advice)
    after = changed.flatten()
    new = {r.name for r in advice.resistors} | {r.junction for r in advice.resistors if r.splits}
    switches = set(advice.switches)
    found = dynamics(after, reference_mode(after, pins=after.pins))
    for bond in found.dynamic:
        ends = {after.nodes[k].path for k in (after.bonds[bond].tail, after.bonds[bond].head)}
        assert ends & new and ends <= new | switches, after.bonds[bond].name
    assert found.storages == ()


@pytest.mark.parametrize(
    ("make", "on", "expected"),
    [
        (opened_coil, (1,), 0.1),  # L/R of the coil on its parallel resistor, switch open
        (two_capacitors, (0,), 1 / (1 / 2e-3 + 1 / 3e-3)),  # R times the series capacitance
        (rigid_clutch, (0,), 1 / (1 / 10 + 1 / 1)),  # reduced inertia over R
        (geared_clutch, (0,), 1 / (1 / 10 + 1 / 16)),
    ],
)
def test_the_price_is_the_time_constant_that_comes(make, on, expected) -> None:
    (advice,) = advise(make().flatten())
    (r,) = advice.resistors
    assert r.gain is not None and r.value is not None and r.time_constant is not None
    assert 1 / r.gain == pytest.approx(expected)
    assert r.time_constant == pytest.approx(advice.fastest / 100)
    assert r.stiffness(r.value) == pytest.approx(r.time_constant)
    graph = make().flatten()
    known = [*time_constants(graph, (0,)), *time_constants(graph, (1,))]
    assert advice.fastest == pytest.approx(min(known))
    assert advice.slowest == pytest.approx(max(known))
    new = time_constants(followed(make(), advice).flatten(), on)
    # A hundred times faster than the rest: the loop alone, but for a part in a hundred.
    assert new[0] == pytest.approx(r.time_constant, rel=0.03)


def test_a_switch_with_a_resistance_of_its_own_needs_none() -> None:
    parts = {"V": hb.Se(10), "sw": hb.One(), "r": hb.R(1), "n": hb.Zero(), "c": hb.C(1)}
    m = circuit(parts, ["V -> sw", "sw -> n", "sw -> r", "n -> c"], {"S": ["sw"]})
    assert advise(m.flatten()) == ()


def test_a_law_that_is_not_linear_gives_no_number() -> None:
    m = two_capacitors()
    m.elements["c"] = hb.C({"e": "500*q + q^3"})
    (advice,) = advise(m.flatten())
    assert advice.fastest is None
    assert [r.gain for r in advice.resistors] == [None]
    assert "not linear" in advice.text
    m = geared_clutch()
    m.signal(turn=hb.Integral("w.f"))
    m.elements["gear"] = hb.TF("4 + sin(turn)")
    (advice,) = advise(m.flatten())
    assert [r.gain for r in advice.resistors] == [None]


def test_time_constants_of_the_diagnosis_circuit_are_the_published_eigenvalues() -> None:
    # Yu, Wang & Luo 2014, circuit data; eigenvalues in 1/s recomputed from its residuals.
    C1, C2, R1, R2, R3, R4, R5 = 1e-3, 4.7e-3, 670.0, 215.6, 67.5, 215.4, 509.0
    path = Path(__file__).parents[2] / "examples" / "diagnosis_circuit.toml"
    graph = hb.load(path).flatten()
    published = {
        ("off", "off"): (19.214595, 0.244846),
        ("on", "off"): (23.267101, 0.830558),
        ("off", "on"): (19.260205, 0.492949),
        ("on", "on"): (23.297852, 1.093520),
    }
    for (a1, a2), rates in published.items():
        found = time_constants(graph, graph.mode_of({"S1": a1, "S2": a2}))
        assert [1 / tau for tau in found] == pytest.approx(rates, abs=1e-6)
        A = np.array([[-1 / R1 - (a1 == "on") / R2 - 1 / R3, 1 / R3], [1 / R3, -1 / R3]])
        A[1, 1] -= (a2 == "on") / (R4 + R5)
        A /= np.array([[C1], [C2]])
        assert found == pytest.approx(sorted(1 / abs(np.linalg.eigvals(A))))


def test_derivative_storage_takes_no_time_constant_of_its_own() -> None:
    m = rigid_clutch()
    closed, opened = (time_constants(m.flatten(), mode) for mode in ((0,), (1,)))
    assert closed == pytest.approx([11 / 5.1])
    assert opened == pytest.approx([1 / 5, 10 / 0.1])


def test_an_oscillator_and_a_free_mass() -> None:
    m = hb.Model("oscillator")
    m.add(m=hb.I(2), k=hb.C(1 / 8), v=hb.One(), free=hb.I(3), w=hb.One())
    m.bond("v -> m", "v -> k", "w -> free")
    assert time_constants(m.flatten(), ()) == pytest.approx([1 / 2, 1 / 2])  # sqrt(I C)


def random_drive(seed: int) -> hb.Model:
    """Capacitors behind transformers and gyrated inertias, all on one series resistor."""
    draw = random.Random(seed)
    m = hb.Model("drive")
    m.add(j=hb.One(), r=hb.R(draw.uniform(0.5, 2)))
    m.bond("j -> r")
    for k in range(draw.randint(1, 4)):
        into = draw.random() < 0.5
        kind = draw.choice(["C", "TF", "GY"])
        storage = hb.I if kind == "GY" else hb.C
        m.add(**{f"s{k}": storage(draw.uniform(0.1, 3))})
        if kind == "C":
            m.bond(f"j -> s{k}" if into else f"s{k} -> j")
            continue
        part = hb.TF if kind == "TF" else hb.GY
        m.add(**{f"t{k}": part(draw.uniform(0.3, 3) * draw.choice([1, -1]))})
        m.bond(f"j -> t{k}.{1 if into else 2}", f"t{k}.{2 if into else 1} -> s{k}")
    return m


@pytest.mark.parametrize("seed", range(30))
def test_loop_gain_is_the_eigenvalue_of_the_loop(seed: int) -> None:
    graph = random_drive(seed).flatten()
    (bond,) = (b.index for b in graph.bonds if b.name == "j -> r")
    gain = loop_gain(graph, assign(graph, ()).strokes, frozenset(), bond, coefficients(graph))
    R = graph.nodes[graph.by_path["r"]].law.matrix[0][0]
    # One resistor: one rate; all other combinations of the stored quantities stay.
    (tau,) = time_constants(graph, ())
    assert tau == pytest.approx(R / gain)
    assert math.isfinite(tau)


def random_model(seed: int) -> hb.Model:
    """Return a tree of junctions and two-ports with leaves; each switch has its own machine."""
    draw = random.Random(seed)
    count = draw.randint(1, 4)
    parts: dict[str, object] = {f"n{k}": draw.choice([hb.Zero, hb.One])() for k in range(count)}
    junctions, bonds = list(parts), []
    for k in range(1, count):
        other, link = draw.randrange(k), draw.choice([None, None, hb.TF, hb.GY])
        if link is None:
            bonds.append(f"n{other} -> n{k}")
        else:
            parts[f"t{k}"] = link(round(draw.uniform(0.5, 2), 2))
            bonds += [f"n{other} -> t{k}", f"t{k} -> n{k}"]
    for k in range(count):
        for j in range(draw.randint(1, 2)):
            kind = draw.choice([hb.C, hb.I, hb.R, hb.G, hb.Se, hb.Sf])
            parts[f"x{k}_{j}"] = kind(round(draw.uniform(0.5, 2), 2))
            bonds.append(f"n{k} -> x{k}_{j}")
    switches = draw.sample(junctions, draw.randint(1, min(2, count)))
    return circuit(parts, bonds, {f"m_{name}": [name] for name in switches})


@pytest.mark.slow
def test_following_advice_on_random_models_leaves_no_dynamic_stroke_outside() -> None:
    followed_count = 0
    for seed in range(400):
        before = random_model(seed).flatten()
        found = dynamics(before)
        for advice in advise(before, found):
            if not advice.resistors and not advice.pins:
                continue
            followed_count += 1
            after = followed(random_model(seed), advice).flatten()
            new = {r.name for r in advice.resistors}
            new |= {r.junction for r in advice.resistors if r.splits}
            switches = set(advice.switches)
            again = dynamics(after, reference_mode(after, mode=found.reference.mode))
            for bond, by in again.through.items():
                record = after.bonds[bond]
                ends = {after.nodes[k].path for k in (record.tail, record.head)}
                own = after.nodes[record.head].kind in ("R", "G") and ends & switches
                if {after.nodes[k].path for k in by} <= switches:
                    assert ends & new or own, (seed, record.name)
    assert followed_count > 60
