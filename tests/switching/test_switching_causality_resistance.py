"""Causality resistance: what it keeps still, how it converges, and how stiff it makes the model."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mode_strokes import mode_dependent

import hybond as hb
from hybond.causality.assign import assign
from hybond.causality.time_constants import time_constants

sw = hb.switching
TIGHT = {"rtol": 1e-11}


def branches(arrow: bool = True) -> hb.Model:
    """A switched source on two coils: open, one coil's current is the other's."""
    m = hb.Model("branches", domain="electrical")
    m.add(V=hb.Se("1 V"), sw=hb.One(), n=hb.Zero())
    m.add(
        a=hb.One(), La=hb.I("1 H"), Ra=hb.R("1 ohm"), b=hb.One(), Lb=hb.I("2 H"), Rb=hb.R("1 ohm")
    )
    m.bond("V -> sw -> n" if arrow else "n -> sw -> V")
    m.bond("n -> a -> La", "a -> Ra", "n -> b -> Lb", "b -> Rb")
    m.machine(
        "S",
        states={"closed": ["sw"], "open": []},
        start="closed",
        rules=["closed -> open when time >= 1"],
    )
    return m


def twins(arrow: bool = True) -> hb.Model:
    """The dual: a switched flow source on two capacitors in series with leaks."""
    m = hb.Model("twins")
    m.add(J=hb.Sf(1.0), sw=hb.Zero(), n=hb.One())
    m.add(a=hb.Zero(), Ca=hb.C(1.0), Ra=hb.R(1.0), b=hb.Zero(), Cb=hb.C(2.0), Rb=hb.R(1.0))
    m.bond("J -> sw -> n" if arrow else "n -> sw -> J")
    m.bond("n -> a -> Ca", "a -> Ra", "n -> b -> Cb", "b -> Rb")
    m.machine(
        "S",
        states={"closed": ["sw"], "open": []},
        start="closed",
        rules=["closed -> open when time >= 1"],
    )
    return m


@pytest.mark.parametrize("arrow", [True, False])
@pytest.mark.parametrize("make", [branches, twins])
def test_strokes_turn_only_between_the_switch_and_the_resistance(make, arrow: bool) -> None:
    modes = [(0,), (1,)]
    plain = make(arrow).flatten()
    turned = {plain.bonds[k].name for k in mode_dependent(plain, modes)}
    assert turned - {"sw -> n", "n -> sw"}, "there must be something to keep still"
    assert any(assign(plain, mode).derivative for mode in modes)
    other, report = sw.add_causality_resistance(make(arrow), "n", value=10.0)
    graph = other.flatten()
    turned = {graph.bonds[k].name for k in mode_dependent(graph, modes)}
    assert turned <= {"sw -> n", "n -> sw", "n -> n_r"}
    for mode in modes:
        causality = assign(graph, mode)
        assert not causality.derivative
        assert not causality.conflicts
    assert report.element == "n_r" and report.value == 10.0


@pytest.mark.parametrize("make", [branches, twins])
def test_the_trajectory_converges_to_the_ideal_one_at_first_order(make) -> None:
    names = ["La.f", "Lb.f"] if make is branches else ["Ca.e", "Cb.e"]
    ideal = hb.simulate(make(), until=2, **TIGHT)
    # closed and open in closed form: one current through both coils
    tau_a, tau_b = 1.0, 2.0
    before = [1.0 - math.exp(-1.0 / tau_a), 1.0 - math.exp(-1.0 / tau_b)]
    together = (1.0 * before[0] - 2.0 * before[1]) / 3.0
    assert ideal[names[0]].at(1.0) == pytest.approx(together, rel=1e-9)
    assert ideal[names[0]].at(2.0) == pytest.approx(together * math.exp(-2.0 / 3.0), rel=1e-9)
    errors = []
    for k in (1e2, 1e3, 1e4):
        value = k if make is branches else 1.0 / k
        other, _ = sw.add_causality_resistance(make(), "n", value=value)
        run = hb.simulate(other, until=2, solver="radau", rtol=1e-9)
        errors.append(max(abs(run[n].at(2.0) - ideal[n].at(2.0)) for n in names))
    orders = [math.log10(a / b) for a, b in itertools.pairwise(errors)]
    assert orders == pytest.approx([1.0, 1.0], abs=0.03)


@pytest.mark.parametrize("make", [branches, twins])
def test_the_warning_tells_the_time_constant_that_the_resistance_makes(make) -> None:
    """Open: with G the leak's conductance, det(diag(s L + R) + 1/G ones) = 0."""
    r = 1e4
    _, report = sw.add_causality_resistance(make(), "n", value=r if make is branches else 1 / r)
    # (1 + s)(1 + 2 s) + r (2 + 3 s) = 0, by the quadratic formula
    roots = np.roots([2.0, 3.0 + 3.0 * r, 1.0 + 2.0 * r])
    fastest = 1.0 / np.abs(roots).max()
    by_mode = {row.mode: row for row in report.modes}
    assert by_mode["open"].fastest == pytest.approx(fastest, rel=1e-9)
    assert by_mode["open"].without == pytest.approx(1.5, rel=1e-9)
    assert by_mode["closed"].fastest == pytest.approx(1.0, rel=1e-9)
    assert by_mode["closed"].ratio == pytest.approx(1.0, rel=1e-9)
    assert report.reference == pytest.approx(1.0, rel=1e-9)
    assert report.fastest == by_mode["open"].fastest
    assert "mode (open)" in report.warning
    assert f"{1.0 / fastest:.3g} times stiffer" in report.warning


def test_a_strong_resistance_makes_no_warning() -> None:
    _, report = sw.add_causality_resistance(branches(), "n", value="2 ohm")
    assert report.warning == ""


@pytest.mark.parametrize("make", [branches, twins])
def test_the_default_is_a_thousand_times_faster_than_the_model(make) -> None:
    model = make()
    other, report = sw.add_causality_resistance(model, "n")
    assert report.fastest == pytest.approx(1e-3, rel=0.02)
    assert "n_r" not in model.elements and "n_r" in other.elements
    assert (report.value > 100) == (make is branches)


def test_without_a_time_constant_there_is_no_default() -> None:
    m = hb.Model("resistors")
    m.add(V=hb.Se(1), n=hb.Zero(), r=hb.R(1))
    m.bond("V -> n -> r")
    with pytest.raises(hb.ModelError, match="HB-M196"):
        sw.add_causality_resistance(m, "n")
    with pytest.raises(hb.ModelError, match="HB-M101"):
        sw.add_causality_resistance(m, "r", value=1)


# -- the time constants themselves, against a second derivation


def test_time_constants_of_dependent_storage_and_two_ports() -> None:
    m = hb.Model("geared")
    m.add(T=hb.Se(1), w1=hb.One(), J1=hb.I(2.0), gear=hb.TF(3.0), w2=hb.One(), J2=hb.I(5.0))
    m.add(b=hb.R(0.7), coil=hb.GY(0.4), i=hb.One(), La=hb.I(1e-6), Ra=hb.R(1e3))
    m.bond("T -> w1 -> J1", "w1 -> gear -> w2 -> J2", "w2 -> b", "w1 -> coil -> i -> La", "i -> Ra")
    # f2 = 3 f1: J = 2 + 9*5, b = 9*0.7; electrically 1e3 ohm with 1 uH behind r = 0.4
    a = np.array([[-9 * 0.7 / 47.0, -0.4 / 1e-6], [0.4 / 47.0, -1e3 / 1e-6]])
    want = sorted(1.0 / np.abs(np.linalg.eigvals(a)))
    assert want[1] / want[0] > 1e9
    assert time_constants(m.flatten(), ()) == pytest.approx(want, rel=1e-5)


@settings(max_examples=40, deadline=None)
@given(
    st.lists(st.floats(0.1, 10.0), min_size=6, max_size=6),
    st.booleans(),
    st.lists(st.booleans(), min_size=6, max_size=6),
)
def test_time_constants_of_random_meshes(values, joined, arrows) -> None:
    """Capacitors on nodes joined by resistors, or some of them joined without: nodal analysis."""
    caps, resistances = np.array(values[:3]), np.array(values[3:])
    m = hb.Model("mesh")
    for k in range(3):
        m.add(**{f"n{k}": hb.Zero(), f"c{k}": hb.C(caps[k])})
        m.bond(f"n{k} -> c{k}" if arrows[k] else f"c{k} -> n{k}")
    m.add(i=hb.One(), r0=hb.R(resistances[0]), j=hb.One(), leak=hb.G(1 / resistances[2]))
    m.bond("n0 -> i -> n1", "n1 -> j -> n2")
    m.bond("i -> r0" if arrows[3] else "r0 -> i", "n2 -> leak" if arrows[4] else "leak -> n2")
    g = np.zeros((3, 3))
    g[0, 0] = g[1, 1] = 1 / resistances[0]
    g[0, 1] = g[1, 0] = -1 / resistances[0]
    g[2, 2] = 1 / resistances[2]
    if joined:
        onto = np.array([[1.0, 0.0], [0.0, 1.0], [0.0, 1.0]])  # one voltage at nodes 1 and 2
    else:
        m.add(r1=hb.R(resistances[1]))
        m.bond("j -> r1" if arrows[5] else "r1 -> j")
        onto = np.eye(3)
        g[1:, 1:] += np.array([[1, -1], [-1, 1]]) / resistances[1]
    c = onto.T @ np.diag(caps) @ onto
    want = sorted(1.0 / np.abs(np.linalg.eigvals(np.linalg.solve(c, onto.T @ g @ onto))))
    assert time_constants(m.flatten(), ()) == pytest.approx(want, rel=1e-7)


@pytest.mark.parametrize(
    ("mass", "area", "resistance", "compliance"),
    [(25.0, 1e-3, 1e10, 1e-12), (1e-6, 2e-6, 5e13, 3e-18), (4e4, 0.2, 3e7, 1e-9)],
)
def test_time_constants_of_hydraulics_far_apart(mass, area, resistance, compliance) -> None:
    m = hb.Model("actuator")
    m.add(p=hb.Se(2e7), i=hb.One(), valve=hb.R(resistance), n=hb.Zero(), oil=hb.C(compliance))
    m.add(piston=hb.TF(1 / area), v=hb.One(), mass=hb.I(mass))
    m.bond("p -> i -> n -> oil", "i -> valve", "n -> piston -> v -> mass")
    # q' = (p - q/C)/R - A v, m v' = A q/C
    a = np.array([[-1 / (resistance * compliance), -area / mass], [area / compliance, 0.0]])
    want = sorted(1.0 / np.abs(np.linalg.eigvals(a)))
    assert time_constants(m.flatten(), ()) == pytest.approx(want, rel=1e-9)


def test_modes_with_laws_that_are_not_linear_are_left_out() -> None:
    m = hb.Model("bent")
    m.add(n=hb.Zero(), c=hb.C({"e": "q^3"}), r=hb.R(1))
    m.bond("n -> c", "n -> r")
    assert time_constants(m.flatten(), ()) is None
    modulated = branches()
    sw.modulated_resistor(
        modulated, "x", bonds="n -> x", machine="S", on="closed", r_on=1.0, r_off=1e3
    )
    graph = modulated.flatten()
    assert len(time_constants(graph, (0,))) == len(time_constants(graph, (1,))) == 2
