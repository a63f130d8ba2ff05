"""Switches that are controlled by what is across them: synchronous rectifiers.

At VT = 0 such a switch is an ideal diode with RON. As a machine each is open at the start, and
nothing says what the nodes between four of them are at.
"""

import math

import numpy as np
import pytest

import hybond as hb

OWN = ".model SW SW(VT=0 RON=0.1 ROFF=1e8)"
TIMES = [1.3e-3, 5e-3, 9.1e-3, 12e-3, 15e-3, 18.7e-3]


@pytest.fixture
def read(tmp_path):
    def one(*rows):
        deck = tmp_path / "test.cir"
        deck.write_text("\n".join(["Own voltage", *rows, ".end", ""]))
        return hb.read_circuit(deck)

    return one


def at(conversion, signal):
    run = hb.simulate(conversion.model)
    assert run.status == "ok"
    assert run.audit().holds()
    return np.asarray(run[conversion.signal(signal)].at(TIMES))


def sine(peak):
    return peak * np.sin(2.0 * math.pi * 50.0 * np.asarray(TIMES))


@pytest.mark.parametrize("turned", [False, True])
def test_a_bridge_of_four_rectifies(read, turned):
    """10 ohm behind two of them and 0.8 ohm; a switch that reads its voltage the other way round
    between nodes the other way round is the same one."""
    one = "S1 p a a p SW" if turned else "S1 a p a p SW"
    bridge = ("V1 c b SIN(0 22 50)", "Rs c a 0.8", one, "S2 b p b p SW", "S3 0 a 0 a SW")
    conversion = read(*bridge, "S4 0 b 0 b SW", "R1 p 0 10", OWN, ".tran 10u 20m uic")
    assert at(conversion, "v(p)") == pytest.approx(abs(sine(20.0)), rel=1e-9)
    way = -1.0 if turned else 1.0
    assert at(conversion, "i(S1)") == pytest.approx(way * np.maximum(sine(2.0), 0.0), abs=1e-9)
    told = [str(w) for w in conversion.warnings if "ideal diode" in str(w)]
    assert told


def test_what_it_leaks_is_beside_it(read):
    leaky = ".model SW SW(VT=0 RON=1 ROFF=9)"
    conversion = read(
        "V1 a 0 SIN(0 10 50)", "S1 a b a b SW", "R1 b 0 1", leaky, ".tran 10u 20m uic"
    )
    there = sine(10.0)
    assert at(conversion, "v(b)") == pytest.approx(np.where(there > 0, there / 2, there / 10))


def test_a_threshold_above_zero_is_told_to_open_again(read):
    rows = ("V1 a 0 SIN(0 10 50)", "S1 a b a b SW", "R1 b 0 1")
    conversion = read(*rows, ".model SW SW(VT=0.2 RON=0.1)", ".tran 10u 20m uic")
    (told,) = (str(w) for w in conversion.warnings if "its own voltage" in str(w))
    assert "opens again at once below 2 A" in told
    assert "VT=0" in told
