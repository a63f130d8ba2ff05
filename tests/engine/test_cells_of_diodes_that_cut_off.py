"""Cells of diodes around one switch, and bridges beside faint leaks: they have a solution."""

import math

import numpy as np
import pytest

import hybond as hb

CELL = """Cell
{source}
D1 b p DX
D2 n b DX
D3 c p DX
D4 n c DX
S1 p n g 0 SX
Vg g 0 {gate}
R1 c d 10
L2 d 0 10m
{beside}
.model SX SW(VT=0.5 RON=20m ROFF=1e9)
.model DX D(IS=1e-14 N=0.01 RS=10m)
.tran 10u {until} uic
.end
"""


def run_of(tmp_path, text):
    path = tmp_path / "cell.cir"
    path.write_text(text)
    deck = hb.read_circuit(path)
    return deck, hb.simulate(deck.model)


@pytest.mark.parametrize("source", ["V1 s 0 SIN(0 10 50)\nRs s b 1", "V1 b 0 SIN(0 10 50)"])
def test_a_cell_that_is_open_carries_nothing_to_a_coil(tmp_path, source):
    text = CELL.format(source=source, gate="0", beside="", until="30m")
    deck, run = run_of(tmp_path, text)
    assert run.status == "ok"
    assert np.abs(run[deck.signal("i(L2)")].at(np.linspace(0.0, 30e-3, 50))).max() < 1e-9


def test_a_cell_that_is_closed_is_two_drops_and_three_resistances(tmp_path):
    text = CELL.format(source="V1 b 0 10", gate="1", beside="", until="30m")
    deck, run = run_of(tmp_path, text)
    vt = 1.380649e-23 * 300.15 / 1.602176634e-19
    r = 0.01 + 0.01 * vt
    drop = 0.01 * vt * (math.log(1 + 1e14) - 1)
    i = (10 - 2 * drop) / (10 + 2 * r + 0.02)
    tau = 10e-3 / (10 + 2 * r + 0.02)
    for t in (1e-3, 3e-3, 20e-3):
        found = run[deck.signal("i(L2)")].at(t)
        assert found == pytest.approx(i * (1 - math.exp(-t / tau)), rel=1e-5)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("beside", ["", "Rz b z 50\nCz z 0 100n\nRp p 0 1meg"])
@pytest.mark.slow
def test_an_alternating_chopper_loses_what_its_resistors_take(tmp_path, beside):
    source = "V1 a 0 SIN(0 100 50)\nL1 a b 1m"
    free = "S2 c 0 h 0 SX\nVh h 0 PULSE(1 0 0 0.1u 0.1u 60u 100u)\n"
    gate = "PULSE(0 1 0 0.1u 0.1u 60u 100u)"
    text = CELL.format(source=source, gate=gate, beside=free + beside, until="20m")
    _, run = run_of(tmp_path, text)
    assert run.status == "ok"
    assert len(run.events) > 300
    assert run.audit().holds()


def test_a_leak_of_a_megohm_between_two_bridges(tmp_path):
    """What flows through their load does not depend on the leak, which only holds one of them."""
    rows = ["Twelve pulses", "Rnn nn 0 {leak}", "Li1 p1 q 20m", "Li2 q p2 20m", "Lo q r 10m"]
    for k, node in enumerate("abc"):
        rows += [f"V{node} {node} 0 SIN(0 100 50 0 0 {-120 * k})", f"L{node} {node} {node}1 .5m"]
        rows += [f"D{k} {node}1 p1 DI", f"D{k + 3} m {node}1 DI"]
        other = "bca"[k]
        rows += [f"E{k} e{k} nn {node} {other} 0.57735", f"Lf{k} e{k} f{k} .5m"]
        rows += [f"D{k + 6} f{k} p2 DI", f"D{k + 9} m f{k} DI"]
    rows += ["Ro r m 10", ".model DI D(IS=1e-14 N=0.01 RS=0.01)", ".tran 20u 2m 0 uic", ".end"]
    found = []
    for leak in ("1meg", "10k"):
        deck, run = run_of(tmp_path, "\n".join(rows).format(leak=leak))
        assert run.status == "ok"
        found.append(run[deck.signal("i(Lo)")].at(2e-3))
    assert found[0] == pytest.approx(found[1], rel=1e-4)


@pytest.mark.parametrize("leak", ["10k", "300k", "1meg"])
def test_a_leak_that_carries_a_coil_hands_it_over_without_an_impulse(tmp_path, leak):
    """The leak stops the coil in a nanosecond, which is no impulse; then both coils are in series.

    Of a sine behind a resistance and an inductance from rest, less two drops.
    """
    rows = ["Handed over", "V1 a 0 SIN(0 100 50)", "L1 a b 1m", "D1 b p DX", "D2 p b DX"]
    rows += ["D4 p c DX", "R1 c d 10", "L2 d 0 10m", f"Rp p 0 {leak}"]
    rows += [".model DX D(IS=1e-14 N=0.01 RS=10m)", ".tran 10u 8m uic", ".end"]
    deck, run = run_of(tmp_path, "\n".join(rows))
    assert run.status == "ok" and len(run.events) == 3
    vt = 1.380649e-23 * 300.15 / 1.602176634e-19
    r, drop = 10 + 2 * (0.01 + 0.01 * vt), 2 * 0.01 * vt * (math.log(1 + 1e14) - 1)
    w, x = 2 * math.pi * 50, 2 * math.pi * 50 * 11e-3
    begin = math.asin(drop / 100) / w

    def lasting(t):
        return 100 * (r * math.sin(w * t) - x * math.cos(w * t)) / (r * r + x * x) - drop / r

    for t in (1e-4, 1e-3, 8e-3):
        wanted = lasting(t) - lasting(begin) * math.exp(-(t - begin) * r / 11e-3)
        # beside ten ohm and the second coil ten kilohm take a thousandth of the current
        assert run[deck.signal("i(L2)")].at(t) == pytest.approx(
            wanted, rel=2e-3 if leak == "10k" else 1e-4
        )
