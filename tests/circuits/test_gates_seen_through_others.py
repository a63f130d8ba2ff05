"""Switches without hysteresis whose gates come through resistors, drivers and subcircuits.

The gate of 0 V and 5 V rests at the default threshold of 0 V, and the switch stayed closed for good
after its first pulse, without a word, unless its nodes were those of the source itself.
"""

import sys
from pathlib import Path

import numpy as np
import pytest

import hybond as hb

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))

from ngspice import run as ngspice

GATE = "Vg s 0 PULSE(0 5 0.1m 1u 1u 0.3m 1m)"
OTHER = "Vh t 0 PULSE(0 3 0.15m 1u 1u 0.5m 1m)"
THREE = (
    "Vg s 0 PWL(0 -5 .5m -5 .501m 0 1m 0 1.001m 5 1.5m 5 1.501m 0 2m 0 2.001m -5 2.5m -5 2.501m 0)"
)
LOAD = ("V1 a 0 1", "R1 x 0 999", "S1 a x g 0 one")
MODEL = ".model one SW(RON=1 ROFF=1g)"
END = (".tran 1u 3m 0 2u uic", ".end", "")
GATES = {
    "divider": (GATE, "Ra s g 10", "Rb g 0 10k", *LOAD, MODEL),
    "bleed": ("Vg g 0 PULSE(0 5 0.1m 1u 1u 0.3m 1m)", "Rb g 0 10k", *LOAD, MODEL),
    "source resistance": (GATE, "Ra s g 10", *LOAD, MODEL),
    "ammeter": (GATE, "Vm s g 0", "Rb g 0 10k", *LOAD, MODEL),
    "bridge of resistors": (
        GATE, "Ra s g 1k", "Rb s h 2k", "Rc g h 1k", "Rd g 0 1k", "Re h 0 3k", *LOAD, MODEL,
    ),
    "E": (GATE, "E1 g 0 s 0 2", "Rb g 0 1k", *LOAD, MODEL),
    "E between sources": (GATE, OTHER, "E1 g 0 s t 1", "Rb g 0 1k", *LOAD, MODEL),
    "E POLY": (GATE, OTHER, "E1 g 0 POLY(2) s 0 t 0 0 1 1", "Rb g 0 1k", *LOAD, MODEL),
    "H": (GATE, "Ra s i 10", "Vm i 0 0", "H1 g 0 Vm 10", "Rb g 0 1k", *LOAD, MODEL),
    "F": (GATE, "Ra s i 10", "Vm i 0 0", "F1 0 g Vm 1", "Rb g 0 1k", *LOAD, MODEL),
    "G": (GATE, "Ra s 0 1k", "G1 0 g s 0 1m", "Rb g 0 1k", *LOAD, MODEL),
    "B": (GATE, "B1 g 0 V = 2*V(s)", "Rb g 0 1k", *LOAD, MODEL),
    "B product": (GATE, OTHER, "B1 g 0 V = V(s)*V(t)", "Rb g 0 1k", *LOAD, MODEL),
    "B of a comparison": (
        GATE, "B1 g 0 V = V(s) > 2 ? 5 : 0", *LOAD, ".model one SW(VT=5 RON=1 ROFF=1g)",
    ),
    "current": (GATE, "Ra s i 10", "Vm i 0 0", "V1 a 0 1", "R1 x 0 999", "W1 a x Vm one",
        ".model one CSW(RON=1 ROFF=1g)"),
    "as high as it gets": (
        GATE, "E1 g 0 s 0 1", "Rb g 0 1k", *LOAD, ".model one SW(VT=5 RON=1 ROFF=1g)",
    ),
    "transistor": (
        GATE, ".subckt fet d g s", "Rg g i 4.7", "Rgs i s 10k", "S1 d s i s one", MODEL, ".ends",
        "V1 a 0 1", "X1 a g x fet", "R1 x 0 999", "E1 g x s 0 1",
    ),
    "three levels": (THREE, *(row.replace(" g 0 ", " s 0 ") for row in LOAD), MODEL),
    "three levels behind a divider": (THREE, "Ra s g 1k", "Rb g 0 1k", *LOAD, MODEL),
}  # fmt: skip
TIMES = (np.linspace(0.05e-3, 2.95e-3, 30) + 3e-6).tolist()


def read(folder, rows):
    deck = folder / "gate.cir"
    deck.write_text("\n".join(["Gate", *rows, *END]))
    return deck, hb.read_circuit(deck)


def seen(conversion, signal="v(x)", times=TIMES):
    run = hb.simulate(conversion.model)
    assert run.status == "ok"
    return np.asarray(run[conversion.signal(signal)].at(times))


@pytest.mark.ngspice
@pytest.mark.sampled(5)
@pytest.mark.parametrize("name", GATES)
def test_a_switch_is_where_ngspice_has_it(tmp_path, name):
    deck, conversion = read(tmp_path, GATES[name])
    waves = ngspice(deck, tmp_path)
    assert seen(conversion) == pytest.approx(np.interp(TIMES, waves.time, waves["x"]), abs=2e-3)


@pytest.mark.parametrize("name", ["divider", "E", "H", "B product", "transistor"])
def test_a_switch_opens_when_its_gate_is_back_at_its_threshold(tmp_path, name):
    found = seen(read(tmp_path, GATES[name])[1], times=[0.05e-3, 0.25e-3, 0.75e-3, 1.25e-3, 2.8e-3])
    assert found == pytest.approx([0, 0.999, 0, 0.999, 0])


def test_a_gate_of_three_levels_leaves_the_side_from_which_it_comes(tmp_path):
    """It is at -5 V, 0, 5 V, 0, -5 V and 0 for half a millisecond each."""
    found = seen(
        read(tmp_path, GATES["three levels behind a divider"])[1],
        times=[0.25e-3, 0.75e-3, 1.25e-3, 1.75e-3, 2.25e-3, 2.75e-3],
    )
    assert found == pytest.approx([0, 0.999, 0.999, 0, 0, 0.999])


def test_levels_that_a_divider_moves_off_the_threshold_are_no_rest(tmp_path):
    """5 V and 10 V to 1/3 of them, 2.5 V being the threshold: nothing is warned of."""
    rows = ("Vg s 0 PULSE(5 10 0.1m 1u 1u 0.3m 1m)", "Ra s g 2k", "Rb g 0 1k", *LOAD)
    conversion = read(tmp_path, (*rows, ".model one SW(VT=2.5 RON=1 ROFF=1g)"))[1]
    assert not [w for w in conversion.warnings if "rests at" in str(w)]
    assert seen(conversion, times=[0.05e-3, 0.25e-3, 0.75e-3]) == pytest.approx([0, 0.999, 0])


def test_a_current_that_a_diode_lets_rest_at_zero_is_not_above_it(tmp_path):
    """The half wave flows from 0 until its coil has given back what it took: V drives an R and L.

    i = sin(wt - p)/z + sin(p) exp(-R t/L)/z ends where it is zero again, at 0.53 ms here.
    """
    conversion = read(
        tmp_path,
        ("V1 in 0 SIN(0 5 1k)", "D1 in b ideal", "L1 b c 0.3m", "R1 c 0 10",
         "B1 x 0 V = I(L1) > 0 ? 5 : 0", "R2 x 0 1k", ".model ideal D(RON=0 VFWD=0)"),
    )[1]  # fmt: skip
    t = np.linspace(0.05e-3, 0.95e-3, 19)
    z, p = np.hypot(10, 2 * np.pi * 0.3), np.arctan2(2 * np.pi * 0.3, 10)
    current = (np.sin(2e3 * np.pi * t - p) + np.sin(p) * np.exp(-t * 10 / 0.3e-3)) / z
    flows = np.logical_and.accumulate(current > 0)
    assert 0 < flows.sum() < 19
    assert seen(conversion, times=[*t, *(t + 1e-3)]).tolist() == [5 * f for f in flows] * 2


def test_voltages_that_are_equal_at_rest_are_not_above_each_other(tmp_path):
    rows = (GATE, "Ra s p 1k", "Rb p 0 1k", "Rc s q 2k", "Rd q 0 1k")
    conversion = read(tmp_path, (*rows, "B1 x 0 V = V(p) > V(q) ? 5 : 0", "R1 x 0 1k"))[1]
    found = seen(conversion, times=[0.05e-3, 0.25e-3, 0.75e-3, 1.25e-3, 1.75e-3])
    assert found.tolist() == [0, 5, 0, 5, 0]


def test_what_is_limited_to_its_threshold_is_not_below_it(tmp_path):
    """min(v, 5) < 5 is false above 5 V: the regulator slides along 5 V; it went on to 9.09 V."""
    rows = ("B1 a 0 V = min(V(x),5) < 5 ? 10 : 0", "R1 a x 10", "C1 x 0 1u", "R2 x 0 100")
    assert seen(read(tmp_path, rows)[1], times=[1e-3, 2.9e-3]) == pytest.approx([5, 5])


@pytest.mark.parametrize(
    "drive",
    [
        ("S1 a x a x one", ".model one SW(RON=10m ROFF=1e6)"),
        ("B1 g 0 V = V(a,x) > 0 ? 5 : 0", "S1 a x g 0 one", ".model one SW(VT=2.5 RON=10m)"),
        ("E1 g 0 a x 100", "R1 g 0 1k", "S1 a x g 0 one", ".model one SW(RON=10m ROFF=1e6)"),
    ],
)
def test_a_switch_that_looks_at_its_own_voltage_rectifies(tmp_path, drive):
    """As a diode of its resistance does; to open at equality led back to where it closed."""
    rows = ("V1 in 0 SIN(0 20 1k)", "Rs in a 0.5", "R2 x 0 10", "C1 x 0 100u")
    diode = ("D1 a x one", ".model one D(RON=10m VFWD=0)")
    found, wanted = (seen(read(tmp_path, (*rows, *way))[1]) for way in (drive, diode))
    assert found == pytest.approx(wanted, rel=1e-6)
