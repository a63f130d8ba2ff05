"""Filters of switched capacitors and amplifiers of finite gain, from rest, phase by phase.

Amplifiers have no time and capacitors no resistance, so every clock edge is a jump whose sources
read what jumps. The expected values are those of charges: at each edge a node that is neither earth
nor driven has the charge that its capacitors brought; an amplifier is ``gain*(plus - minus)``.
"""

from __future__ import annotations

import math
import random
from dataclasses import dataclass

import numpy as np
import pytest

import hybond as hb

EARTH = "gnd"
INPUT = "inp"


@dataclass(frozen=True)
class Filter:
    """Fixed capacitors, switched ones (ends while the clock is high, while it is low), outputs."""

    fixed: dict[str, tuple[str, str]]
    switched: dict[str, tuple[tuple[str, str], tuple[str, str]]]
    amplifiers: dict[str, tuple[str, str]]
    """The inverting input and the output of each; the other input is earth."""


INTEGRATOR = Filter(
    {"C1": ("n1", "o1")},
    {"SR": ((EARTH, EARTH), (INPUT, "n1"))},
    {"A1": ("n1", "o1")},
)
FIRST_ORDER = Filter(
    {"C1": ("n1", "o1")},
    {"SR": ((INPUT, EARTH), (EARTH, "n1")), "SF": ((EARTH, EARTH), ("n1", "o1"))},
    {"A1": ("n1", "o1")},
)
# the second stage is touched by nothing until the clock has been high twice
BIQUAD = Filter(
    {"C1": ("n1", "o1"), "C2": ("n2", "o2")},
    {
        "R1": ((EARTH, EARTH), (INPUT, "n1")),
        "F1": ((EARTH, EARTH), ("n1", "o1")),
        "R2": (("o1", EARTH), (EARTH, "n2")),
        "F2": ((EARTH, EARTH), ("n2", "o2")),
        "L": ((EARTH, EARTH), ("o2", "n1")),
    },
    {"A1": ("n1", "o1"), "A2": ("n2", "o2")},
)
# three stages, of which two are still at rest at the first edge
LADDER = Filter(
    {"C1": ("n1", "o1"), "C2": ("n2", "o2"), "C3": ("n3", "o3")},
    {
        "R1": ((INPUT, EARTH), (EARTH, "n1")),
        "F1": ((EARTH, EARTH), ("n1", "o1")),
        "R2": (("o1", EARTH), (EARTH, "n2")),
        "L": (("o2", EARTH), ("n1", EARTH)),
        "R3": (("o2", EARTH), (EARTH, "n3")),
        "F3": ((EARTH, EARTH), ("n3", "o3")),
        "M": (("o3", EARTH), ("n2", EARTH)),
    },
    {"A1": ("n1", "o1"), "A2": ("n2", "o2"), "A3": ("n3", "o3")},
)
PHASE = 0.05


def capacity(name: str, unit: float, seed: int) -> float:
    """One of a fixed capacitor, a tenth of a switched one, in units; uneven but for seed 0."""
    uneven = math.exp(random.Random(f"{seed} {name}").uniform(-0.7, 0.7)) if seed else 1.0
    return unit * uneven * (1.0 if name.startswith("C") else 0.1)


def capacitor(name: str, unit: float, seed: int) -> str:
    """The line of a capacitor."""
    c = capacity(name, unit, seed)
    return f'{name} = {{ submodel = "electrical.capacitor", parameters.C = {c} }}'


def written(circuit: Filter, gain: float, unit: float, seed: int = 0) -> str:
    """The model file of a filter; its lines are shuffled but for seed 0."""
    nodes = {EARTH, INPUT}
    lines, bonds = [], []
    for name, ends in circuit.fixed.items():
        nodes.update(ends)
        lines.append(capacitor(name, unit, seed))
        bonds += [f"{ends[0]} -> {name}.plus", f"{name}.minus -> {ends[1]}"]
    for name, (high, low) in circuit.switched.items():
        nodes.update(high + low)
        lines.append(capacitor(name, unit, seed))
        for k, (side, pin) in enumerate((("a", "plus"), ("b", "minus"))):
            lines.append(f"{name}{side} = {{ junction = 0 }}")
            plate = f"{name}{side}"
            switch = 'submodel = "electrical.changeover_switch", inputs.gate = "clk.out"'
            lines.append(f"W{plate} = {{ {switch} }}")
            bonds.append(f"{plate} -> {name}.{pin}" if k == 0 else f"{name}.{pin} -> {plate}")
            bonds += [
                f"{plate} -> W{plate}.common",
                f"W{plate}.work -> {high[k]}",
                f"W{plate}.rest -> {low[k]}",
            ]
    for name, (minus, out) in circuit.amplifiers.items():
        nodes.update((minus, out))
        lines.append(
            f'{name} = {{ submodel = "electrical.op_amp_ideal", parameters.gain = {gain} }}'
        )
        bonds += [
            f"{EARTH} -> {name}.plus",
            f"{minus} -> {name}.minus",
            f"{name}.out -> {out}",
            f"{name}.ground -> {EARTH}",
        ]
    lines += [f"{node} = {{ junction = 0 }}" for node in sorted(nodes)]
    if seed:
        random.Random(seed).shuffle(lines)
        random.Random(seed).shuffle(bonds)
    listed = "".join(f'  "{bond}",\n' for bond in bonds)
    return f"""
hybond = 1
domain = "electrical"
[elements]
earth = {{ submodel = "electrical.ground" }}
clk = {{ submodel = "control.pulse", parameters = {{ period = {2 * PHASE}, duty = 0.5 }} }}
src = {{ submodel = "electrical.voltage_source", parameters.U = 1 }}
{chr(10).join(lines)}
[graph]
bonds = [
  "earth.pin -> {EARTH}", "{INPUT} -> src.plus", "src.minus -> {EARTH}",
{listed}]
"""


def by_charges(circuit: Filter, gain: float, phases: int, seed: int = 0) -> list[dict[str, float]]:
    """The voltages of the amplifiers' outputs in each phase."""
    charge = dict.fromkeys((*circuit.fixed, *circuit.switched), 0.0)
    told = []
    for phase in range(phases):
        ends = circuit.fixed | {n: e[phase % 2] for n, e in circuit.switched.items()}
        nodes = sorted({n for pair in ends.values() for n in pair} | {EARTH, INPUT})
        nodes = sorted({*nodes, *(n for pair in circuit.amplifiers.values() for n in pair)})
        at = {node: k for k, node in enumerate(nodes)}
        a = np.zeros((len(nodes), len(nodes)))
        b = np.zeros(len(nodes))
        for name, (plus, minus) in ends.items():
            for node, other, sign in ((plus, minus, 1.0), (minus, plus, -1.0)):
                a[at[node], at[node]] += capacity(name, 1.0, seed)
                a[at[node], at[other]] -= capacity(name, 1.0, seed)
                b[at[node]] += sign * charge[name]
        for node, value in ((EARTH, 0.0), (INPUT, 1.0)):
            a[at[node]], b[at[node]] = 0.0, value
            a[at[node], at[node]] = 1.0
        for minus, out in circuit.amplifiers.values():
            a[at[out]], b[at[out]] = 0.0, 0.0
            a[at[out], at[out]], a[at[out], at[minus]] = 1.0 / gain, 1.0
        v = np.linalg.solve(a, b)
        for name, (plus, minus) in ends.items():
            charge[name] = capacity(name, 1.0, seed) * (v[at[plus]] - v[at[minus]])
        told.append({out: float(v[at[out]]) for _, out in circuit.amplifiers.values()})
    return told


@pytest.mark.sampled(3)
@pytest.mark.parametrize("unit", [1.0, 1e-12])
@pytest.mark.parametrize("gain", [1e3, 1e6])
@pytest.mark.parametrize(
    "circuit",
    [INTEGRATOR, FIRST_ORDER, BIQUAD, LADDER],
    ids=["integrator", "first_order", "biquad", "ladder"],
)
def test_charges_of_switched_capacitors_go_on(circuit: Filter, gain: float, unit: float) -> None:
    phases = 9
    run = hb.simulate(hb.loads(written(circuit, gain, unit)), until=(phases - 0.5) * PHASE)
    assert run.status == "ok"
    assert run.audit().holds()
    wanted = by_charges(circuit, gain, phases)
    times = [(k + 0.5) * PHASE - 1e-3 for k in range(phases)]
    for _, out in circuit.amplifiers.values():
        got = run.sample(times, f"{out}.e")[f"{out}.e"]
        right = np.array([phase[out] for phase in wanted])
        assert got == pytest.approx(right, rel=1e-9)
        assert not np.any(got[right == 0.0])  # what the clock has not reached yet stays zero


@pytest.mark.parametrize(
    ("circuit", "seed"),
    [(BIQUAD, 5), (BIQUAD, 34), (BIQUAD, 57), (BIQUAD, 59), (LADDER, 1), (LADDER, 2)],
)
def test_stages_that_hold_the_rounding_of_others_take_part_in_jumps(
    circuit: Filter, seed: int
) -> None:
    """An amplifier passes the last digit of a volt on: what hangs on it is no smaller than that."""
    phases = 9
    model = hb.loads(written(circuit, 1e6, 1.0, seed))
    run = hb.simulate(model, until=(phases - 0.5) * PHASE)
    assert run.status == "ok"
    wanted = by_charges(circuit, 1e6, phases, seed)
    times = [(k + 0.5) * PHASE - 1e-3 for k in range(phases)]
    for _, out in circuit.amplifiers.values():
        got = run.sample(times, f"{out}.e")[f"{out}.e"]
        right = np.array([phase[out] for phase in wanted])
        assert got == pytest.approx(right, rel=1e-9, abs=1e-14)
