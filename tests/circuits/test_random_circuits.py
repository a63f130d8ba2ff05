"""Circuits that nobody drew, against ngspice; `benchmarks/random_circuits.py` runs any number."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))

from random_circuits import CARDS, judge, judged

pytestmark = pytest.mark.ngspice

GATES = "Vg g 0 PULSE(0 5 0 10n 10n {on} {period})\nEh h x g 0 -1\nVx x 0 5\n"
END = CARDS + ".tran 2u 4m\n.end\n"

PARALLEL = """\
* a diode of milliohms beside a switch of milliohms, at potentials of tens of volts
V1 s1 0 PULSE(-24 24 0 1u 1u 0.0008 0.002)
Rs1 s1 n3 18.51
V2 s2 0 SIN(0 48 2500)
Rs2 s2 n1 23.08
R1 n1 0 346.8
R2 n2 0 7.379e+04
R3 n3 0 3601
R4 n4 0 123.9
D1 n3 n1 dd
S1 n4 0 g 0 sw
R5 n3 n4 815.9
D2 n2 n3 dd
S2 n3 n1 h 0 sw
R6 n2 0 867
R7 n3 n4 34.64
L1 0 i1 0.02482
R8 i1 n3 13.17
"""
IN_A_ROW = """\
* one diode before two, switched
V1 s1 0 PULSE(-48 48 0 1u 1u 0.0004 0.001)
Rs1 s1 n2 16.84
R1 n1 0 1855
R2 n2 0 5906
S1 n2 0 g 0 sw
D1 n1 0 dd
D2 n2 n1 dd
D3 n1 0 dd
"""


@pytest.mark.parametrize(
    "deck",
    [
        PARALLEL + GATES.format(on="119.58u", period="200u"),
        IN_A_ROW + GATES.format(on="90u", period="200u"),
        IN_A_ROW + GATES.format(on="37u", period="100u"),
    ],
)
def test_digits_that_elimination_lost_decide_nothing(deck: str) -> None:
    verdict = judged(deck + END)
    assert verdict.kind == "agrees", verdict


@pytest.mark.sampled(3)
@pytest.mark.parametrize("seed", range(64))
def test_a_random_circuit_agrees_with_ngspice(seed: int) -> None:
    verdict = judge(seed)
    assert verdict.kind == "agrees", verdict
