"""A bridge of ideal diodes is, seen from its oscillator, the resistor that it feeds."""

import itertools
import math

import numpy as np
import pytest

import hybond as hb

W = 9987.49217
TIMES = [0.498e-3, 0.998e-3, 1.998e-3, 4.998e-3]
PUBLISHED = [2.391581, -5.041916, 1.487683, 0.786446]


def exact(t):
    """Voltage of 10 mH, 1 uF and 1 kohm in parallel, from 10 V."""
    t = np.asarray(t)
    return 10.0 * np.exp(-500.0 * t) * (np.cos(W * t) - 500.0 / W * np.sin(W * t))


def bridge(*, ground: bool, turned: tuple[bool, ...] = (False,) * 4) -> hb.Model:
    """Build a bridge; a diode that is `turned` is written with its bonds the other way round.

    A diode is its junction with both half arrows in the direction of its current; turning both
    means that current and blocking voltage change their sign, so that a turned diode is drawn
    between the swapped nodes and feeds through a transformer of modulus -1.
    """
    m = hb.Model("bridge", domain="electrical")
    m.add(osc=hb.Zero(), L=hb.I("10 mH"), C=hb.C("1 uF", e="10 V"), R=hb.R("1 kohm"))
    m.add(ab=hb.One(), a=hb.Zero(), b=hb.Zero(), plus=hb.Zero())
    m.bond("osc -> L", "osc -> C", "osc -> ab", "b -> ab -> a")
    if ground:
        m.bond("plus -> R")
    else:
        m.add(neg=hb.Zero(), load=hb.One())
        m.bond("plus -> load -> neg", "load -> R")
    ends = [("a", "plus"), ("b", "plus"), ("neg", "a"), ("neg", "b")]
    for k, ((tail, head), turn) in enumerate(zip(ends, turned, strict=True), start=1):
        m.add(**{f"d{k}": hb.One(law="diode")})
        for node, into in ((tail, True), (head, False)):
            if node == "neg" and ground:
                continue
            if not turn:
                m.bond(f"{node} -> d{k}" if into else f"d{k} -> {node}")
                continue
            flip = f"flip{k}{node}"
            m.add(**{flip: hb.TF(-1)})
            m.bond(f"d{k} -> {flip} -> {node}" if into else f"{node} -> {flip} -> d{k}")
    return m


@pytest.mark.sampled(1)
@pytest.mark.parametrize("ground", [True, False])
def test_is_a_plain_oscillator(ground, solver):
    run = hb.simulate(bridge(ground=ground), until="5 ms", solver=solver)
    assert run["C.e"].at(TIMES) == pytest.approx(PUBLISHED, rel=1e-5)
    t = np.linspace(0.0, 5e-3, 101)
    assert run["C.e"].at(t.tolist()) == pytest.approx(exact(t), abs=2e-6)
    assert run["R.e"].at(t.tolist()) == pytest.approx(np.abs(exact(t)), abs=2e-6)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("turned", list(itertools.product([False, True], repeat=4)))
def test_direction_of_bonds_does_not_matter(turned):
    # half of the cases with a ground node, each diode turned and not turned in both halves
    ground = sum(turned) % 2 == 0
    run = hb.simulate(bridge(ground=ground, turned=turned), until="1 ms")
    assert run["C.e"].at(TIMES[:2]) == pytest.approx(PUBLISHED[:2], rel=1e-5)
    assert len(run.events) == 4


@pytest.mark.slow
def test_pairs_change_over_where_the_voltage_is_zero(simulate, modes_of):
    run = simulate("diode_bridge")
    zero = math.atan2(W, 500.0) / W
    want = [zero + k * math.pi / W for k in range(16)]
    assert [e.t for e in run.events[1:]] == pytest.approx(want, rel=1e-6)
    for k, event in enumerate(run.events):
        outer, inner = ("conducts", "blocks") if k % 2 == 0 else ("blocks", "conducts")
        assert modes_of(run, event) == [((outer, inner, inner, outer), "continuous")]
    assert run["C.e"].at(TIMES) == pytest.approx(PUBLISHED, rel=1e-5)


@pytest.mark.slow
def test_every_diode_conducts_or_blocks(simulate):
    run = simulate("diode_bridge")
    t = np.linspace(0.0, 5e-3, 301).tolist()
    for d in ("d1", "d2", "d3", "d4"):
        found = run.sample(t, [f"{d}.f", f"{d}.e"])
        assert found[f"{d}.f"].min() >= -1e-12
        assert found[f"{d}.f"].max() > 5e-3
        assert found[f"{d}.e"].max() <= 1e-9
        assert found[f"{d}.e"].min() < -5.0
        assert np.abs(found[f"{d}.f"] * found[f"{d}.e"]).max() <= 1e-15  # of 0.1 W
