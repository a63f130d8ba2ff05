"""A loop that feeds back has several solutions: a run by one of them is not called right."""

import math

import numpy as np
import pytest

import hybond as hb

TRIANGLE = (
    "Triangle generator", "{comparator}", "R1 s x 20k", "R2 o x 10k", "R3 s m 10k",
    "C1 m o 100n IC={start}", "E1 o 0 0 m 1e5", ".tran 10u 10m 0 uic", ".end",
)  # fmt: skip
"""A ramp of 12 V/ms between -6 V and 6 V, with a comparator of 12 V that has no width."""


def deck_of(tmp_path, comparator, start="-0.1"):
    path = tmp_path / "triangle.cir"
    path.write_text("\n".join(TRIANGLE).format(comparator=comparator, start=start))
    return hb.read_circuit(path)


@pytest.mark.parametrize(
    "law",
    ["12*tanh(1e3*V(x))", "7.6394*atan(1e4*V(x))", "limit(1e4*V(x), -12, 12)",
     "table(V(x), -1m, -12, 1m, 12)"],
)  # fmt: skip
def test_a_run_that_has_lost_its_branch_is_not_ok(tmp_path, law):
    deck = deck_of(tmp_path, f"B1 s 0 V = {law}")
    run = hb.simulate(deck.model, on_error="return")
    assert run.status == "unsound"
    assert "more than one solution" in str(run.error) and "B1" in str(run.error)
    assert "small C or I" in str(run.error)


def test_with_what_was_left_out_of_it_the_same_loop_oscillates(tmp_path):
    deck = deck_of(tmp_path, "B1 y 0 V = 12*tanh(1e3*V(x))\nRo y s 10\nCo s 0 1n")
    run = hb.simulate(deck.model)
    assert run.status == "ok"
    o = run[deck.signal("v(o)")].at(np.linspace(6e-3, 10e-3, 4001))
    # switched at x = 0, by 2/3 of o and a third of 12 V; the comparator takes part of a microsecond
    assert o.max() == pytest.approx(6.0, rel=5e-3)
    assert o.min() == pytest.approx(-6.0, rel=5e-3)


def test_a_loop_with_one_solution_is_as_it_was(tmp_path):
    path = tmp_path / "follower.cir"
    path.write_text(
        "Fed back against itself\nV1 i 0 SIN(0 1 1k)\nB1 o 0 V = 12*tanh(1e3*V(i,o))\n"
        "R1 o c 1k\nC1 c 0 1u IC=0\n.tran 10u 4m 0 uic\n.end\n"
    )
    deck = hb.read_circuit(path)
    run = hb.simulate(deck.model)
    assert run.status == "ok"
    # one in 12000 is missing, and a low pass of 1 ms follows
    w = 2e3 * math.pi
    size = (12000 / 12001) / math.hypot(1.0, w * 1e-3)
    late = np.linspace(3e-3, 4e-3, 1001)
    forced = size * np.sin(w * late - math.atan(w * 1e-3))
    rest = size * math.sin(math.atan(w * 1e-3)) * np.exp(-late / 1e-3)
    assert run[deck.signal("v(c)")].at(late) == pytest.approx(forced + rest, abs=1e-6)
