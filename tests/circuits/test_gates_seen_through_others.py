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
@pytest.mark.sampled(3)
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


BUCK = (
    "V1 in 0 12", "Vt tri 0 PULSE(0 1 0 9.9u .1u 10n 10u)", "Ve en 0 PWL(0 1 50u 1 51u 0)",
    "B2 s 0 V = V(en)*(0.45 > V(tri) ? 5 : 0)", "D1 0 sw d", "L1 sw x 47u", "R1 x 0 3",
    ".model d D(IS=1e-14 N=0.01 RS=0.02)", ".model one SW(RON=50m ROFF=1g)",
)  # fmt: skip


def test_a_gate_that_rests_behind_a_divider_slides_nowhere(tmp_path):
    """Enabled for five periods; at each edge after that both sides were said to push into 0 V."""
    through = (*BUCK, "Rg s g 10", "Rb g 0 10k", "S1 in sw g 0 one")
    runs = [
        hb.simulate(read(tmp_path, rows)[1].model, "200 us")
        for rows in (through, (*BUCK, "S1 in sw s 0 one"))
    ]
    assert [(r.status, r.warnings, len(r.sliding)) for r in runs] == [("ok", (), 0)] * 2
    assert [e.t for e in runs[0].events] == pytest.approx([e.t for e in runs[1].events], rel=1e-12)
    times = np.linspace(1e-6, 199e-6, 67).tolist()
    found, wanted = (np.asarray(r["L1.f"].at(times)) for r in runs)
    assert found == pytest.approx(wanted, rel=1e-9, abs=1e-12)


def test_a_rectified_sine_behind_a_divider_has_one_way_on(tmp_path):
    """The two sides of its threshold at the start were said to be two motions."""
    rows = ("V1 s 0 SIN(0 1 1k)", "B1 a 0 V = abs(V(s))", "V2 in 0 10", "C1 x 0 1u", "R1 x 0 100")
    rows += ("Ra a g 1k", "Rb g 0 1k", "S1 in x g 0 one", ".model one SW(RON=50m ROFF=1g)")
    conversion = read(tmp_path, rows)[1]
    (notice,) = (str(w) for w in conversion.warnings if "threshold" in str(w))
    for state in ("at_threshold_from_above", "at_threshold_from_below"):
        assert state in conversion.model.machines["S1_state"].states
        assert state in notice
    run = hb.simulate(conversion.model, "2 ms")
    assert (run.status, run.warnings) == ("ok", ())
    times = np.linspace(1e-7, 1.9e-3, 20)
    on = 10 * 100 / 100.05  # charged through 50 mohm beside 100 ohm, at once after the start
    charged = on * -np.expm1(-times / (1e-6 / (1 / 0.05 + 1 / 100)))
    assert np.asarray(run["x.e"].at(times.tolist())) == pytest.approx(charged, rel=1e-6)


def test_a_comparison_of_a_source_beside_a_load_switches_when_it_says(tmp_path):
    """|325 sin| = 5 at asin(5/325) beside each zero; one of them was slid on, by rounding."""
    rows = ("V1 a 0 SIN(0 325 50)", "Bz z 0 V = abs(V(a)) < 5 ? 5 : 0", "Rz z zc 10k")
    rows += ("Cz zc 0 10n", "B1 t 0 V = V(zc) > 2.5 ? 1 : 0", "S1 a k t 0 one", "R1 k m 50")
    rows += ("L1 m 0 50m", ".model one SW(VT=0.5 RON=10m ROFF=1g)")
    rows += ("S2 a p t 0 one", "R2 p 0 1k")
    run = hb.simulate(read(tmp_path, rows)[1].model, "100 ms")
    assert (run.status, run.warnings, len(run.sliding)) == ("ok", (), 0)
    beside = np.arcsin(5 / 325) / (100 * np.pi)
    wanted = sorted(t for k in range(11) for t in (k / 100 - beside, k / 100 + beside))[1:-1]
    fired = [(e.t, f.machine) for e in run.events for step in e.steps for f in step.fired]
    found = [t for t, machine in fired if machine == "Bz_comparison"]
    assert [t for t in found if t > 0] == pytest.approx(wanted, abs=1e-14)


def test_what_is_said_of_many_elements_is_said_once(tmp_path):
    rows = [f"R{k} n{k} n{k + 1} 10" for k in range(6)]
    rows += [f"G{k} n{k} 0 VALUE={{1e-3*V(n{k})**3}}" for k in range(1, 7)]
    warnings = read(tmp_path, ("V1 n0 0 1", *rows))[1].warnings
    (told,) = (str(w) for w in warnings if "power 3" in str(w))
    assert ":9: " in told
    assert told.endswith("(G1, G2, G3 and 3 more)")
