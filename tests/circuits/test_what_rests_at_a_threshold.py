"""Comparisons and switches of a netlist whose signals rest at what they are compared with.

A logic level of 0 V is compared with 0, a difference of two truths is 0 or 1: on a threshold time
passes. Each comparison had one rule for what is above and one for what is below, so that it stayed
what it was there, for good and without a word.
"""

from dataclasses import replace

import numpy as np
import pytest

import hybond as hb

GATE = "Vg g 0 PULSE(0 5 0.1m 1u 1u 0.3m 1m)"
SINE = "Vs s 0 SIN(0 1 1k)"
LOAD = ("R1 x y 1k", "C1 y 0 1u")


@pytest.fixture
def read(tmp_path):
    def one(*rows):
        deck = tmp_path / "test.cir"
        deck.write_text("\n".join(["Rests", *rows, ".end", ""]))
        return hb.read_circuit(deck)

    return one


def at(conversion, signal, times):
    run = hb.simulate(conversion.model)
    assert run.status == "ok"
    return np.asarray(run[conversion.signal(signal)].at(list(times))).tolist()


@pytest.mark.parametrize(
    ("law", "high", "low"),
    [
        ("V(g) > 0 ? 5 : 0", 5, 0),
        ("V(g) <= 0 ? 1 : 0", 0, 1),
        ("V(g) >= 5 ? 1 : 0", 1, 0),
        ("V(g) < 5 ? 1 : 0", 0, 1),
        ("V(g) == 5 ? 2 : 1", 2, 1),
        ("V(g) != 0 ? 2 : 1", 2, 1),
        ("V(g) ? 1 : 3", 1, 3),
        ("u(V(g))", 1, 0),
    ],
)
def test_a_level_that_is_the_threshold_is_on_the_side_that_is_written(read, law, high, low):
    conversion = read(GATE, f"B1 x 0 V = {law}", *LOAD, ".tran 1u 3m uic")
    times = (0.25e-3, 0.75e-3, 1.25e-3, 1.75e-3, 2.25e-3, 2.75e-3)
    assert at(conversion, "v(x)", times) == [high, low] * 3


@pytest.mark.parametrize(("law", "same", "apart"), [("==", 1, 0), ("!=", 0, 1)])
def test_two_truths_are_compared_whenever_one_of_them_changes(read, law, same, apart):
    """The gate is up from 0.1 to 0.4 ms, the sine from 0 to 0.5 ms of each period."""
    conversion = read(
        GATE, SINE, f"B1 x 0 V = (V(g) > 2) {law} (V(s) > 0) ? 1 : 0", *LOAD, ".tran 1u 2m uic"
    )
    times = (0.05e-3, 0.2e-3, 0.45e-3, 0.7e-3, 1.05e-3, 1.2e-3, 1.45e-3, 1.7e-3)
    assert at(conversion, "v(x)", times) == [apart, same, apart, same] * 2


def test_what_a_limit_holds_at_the_threshold_is_not_above_it(read):
    """Half of a sine that is cut off at zero is zero; it was above zero from the first half on."""
    conversion = read(SINE, "B1 x 0 V = max(V(s),0) > 0 ? 1 : 0", *LOAD, ".tran 1u 2m uic")
    assert at(conversion, "v(x)", (0.25e-3, 0.75e-3, 1.25e-3, 1.75e-3)) == [1, 0, 1, 0]


@pytest.mark.parametrize(
    ("gate", "model", "closed"),
    [
        ("g 0", "SW(RON=1 ROFF=1g)", [1, 0, 1, 0]),  # VT is zero unless it is given
        ("g 0", "SW(VT=0 VH=0 RON=1 ROFF=1g)", [1, 0, 1, 0]),
        ("g 0", "SW(VT=5 RON=1 ROFF=1g)", [1, 0, 1, 0]),  # as high as the gate ever is
        ("0 g", "SW(RON=1 ROFF=1g)", [0, 1, 0, 1]),
        ("g 0", "SW(RON=1g ROFF=1)", [0, 1, 0, 1]),
        ("g 0", "SW(VT=2.5 VH=2.5 RON=1 ROFF=1g)", [0, 0, 0, 0]),  # two thresholds: never past one
    ],
)
def test_a_switch_at_its_only_threshold_has_changed_sides(read, gate, model, closed):
    """What ngspice has, too: a switch opens where its gate comes back to its threshold."""
    conversion = read(
        GATE,
        f"S1 a x {gate} one",
        "V1 a 0 1",
        "R1 x 0 999",
        f".model one {model}",
        ".tran 1u 2m uic",
    )
    found = at(conversion, "v(x)", (0.25e-3, 0.75e-3, 1.25e-3, 1.75e-3))
    assert found == pytest.approx([0.999 * c for c in closed])
    told = [str(w) for w in conversion.warnings if "rests at its threshold" in str(w)]
    assert len(told) == ("VH=2.5" not in model)


def test_a_comparator_behind_an_integrator_is_no_divergence_of_time(read):
    """Rounding led out of a mode where the integrator is zero, and back: HB-N401.

    What the resistors bring to the integrator is what it holds in the end.
    """
    conversion = read(
        "Vin in 0 SIN(0 0.5 1k)", "R1 in m 10k", "Rf dac m 10k", "C1 m i 1n IC=0",
        "E1 i 0 0 m 1e5", "Bc cmp 0 V = V(i) > 0 ? -1 : 1",
        "Vck ck 0 PULSE(0 1 0 10n 10n 0.5u 2u)", "Vnck nck 0 PULSE(1 0 0 10n 10n 0.5u 2u)",
        "S1 cmp h1 nck 0 ss", "Ch1 h1 0 10p", "E2 hb 0 h1 0 1", "S2 hb h2 ck 0 ss", "Ch2 h2 0 10p",
        "Bd dac 0 V = V(h2) > 0 ? -1 : 1", ".model ss SW(VT=0.5 RON=100 ROFF=1e12)",
        ".tran 1u 40u 0 0.05u uic",
    )  # fmt: skip
    machine = conversion.model.machines["Bc_comparison"]
    rules = ("no -> yes when E1.e/1 [V] > 0", "yes -> no when E1.e/1 [V] <= 0")
    conversion.model.machines["Bc_comparison"] = replace(machine, rules=rules)
    run = hb.simulate(conversion.model)
    assert run.status == "ok"
    brought = run.measure("integral(Rf.f)") + run.measure("integral(R1.f)")
    assert brought == pytest.approx(-float(run["C1.q"].at(40e-6)), rel=1e-6)
