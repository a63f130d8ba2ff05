"""Random machines that fill, empty and join capacitors, against exact arithmetic.

A storage that was emptied at once, and filled again the same way, was taken for a contact that is
struck and then pressed; it stayed empty for good, with status ok. Where time cannot advance, or
instants crowd, there is nothing to compare: about half of all.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Literal

import pytest
from machines_by_fractions import NoRun, Run, drawn, model_of

import hybond as hb

END = Fraction(6)


def disagrees(seed: int, solver: Literal["auto", "radau", "rk45", "exact"]) -> str:
    """Say how a run is another than the exact one; empty if it is not, or there is none."""
    net = drawn(seed)
    try:
        pieces = Run(net).pieces(END)
    except NoRun:
        return ""
    try:
        run = hb.simulate(model_of(net, seed), float(END), solver=solver)
    except hb.NumericsError as error:
        # what happens at the very end is of no piece
        return "" if error.partial and error.partial.t_end == float(END) else str(error)
    for piece in pieces:
        half = (piece.end - piece.begin) / 2
        if half < Fraction(1, 10**6):
            continue
        for k, (q, v) in enumerate(zip(piece.charge, piece.rate, strict=True)):
            found = run[f"c{k}.q"].at(float(piece.begin + half))
            if found != pytest.approx(float(q + v * half), abs=1e-8):
                return f"c{k}.q = {found} at {float(piece.begin + half)} s: {float(q + v * half)}"
    return ""


@pytest.mark.parametrize(("solver", "many"), [("auto", 200), ("radau", 60)])
def test_charges_are_those_of_exact_arithmetic(solver: Literal["auto", "radau"], many: int) -> None:
    wrong = {seed: disagrees(seed, solver) for seed in range(many)}
    assert not {seed: said for seed, said in wrong.items() if said}


def test_enough_of_them_have_a_run() -> None:
    ran = 0
    for seed in range(200):
        try:
            ran += len(Run(drawn(seed)).pieces(END)) > 2
        except NoRun:
            continue
    assert ran > 15


@pytest.mark.slow
@pytest.mark.parametrize("first", range(1000, 9000, 1000))
@pytest.mark.parametrize("solver", ["auto", "radau", "rk45", "exact"])
def test_so_are_those_of_many(
    solver: Literal["auto", "radau", "rk45", "exact"], first: int
) -> None:
    wrong = {seed: disagrees(seed, solver) for seed in range(first, first + 250)}
    assert not {seed: said for seed, said in wrong.items() if said}
