"""The report on random switched graphs against the pencil of all efforts and flows."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

sys.path.insert(0, str(Path(__file__).parent))

from whole_pencil import Net, random_net, whole

from hybond.analysis.structure.controllability import controllability, observability
from hybond.analysis.structure.rows import ModeStructure
from hybond.analysis.structure.structure import structure
from hybond.equations.pencil import analyse

MANY = settings(max_examples=50, deadline=None, derandomize=True)


def modes_of(net: Net, output: str) -> list[tuple[Net, ModeStructure]]:
    """Return the net in each of its modes with its row of the report."""
    modes = [(k,) for k in range(2)] if net.controlled else "start"
    report = structure(net.model(), modes=modes, outputs=[output])
    nets = [net, replace(net, on=set(net.controlled))] if net.controlled else [net]
    return list(zip(nets, report.rows, strict=True))


def same(mine: np.ndarray, theirs: np.ndarray) -> bool:
    """Compare poles by their polynomials: where poles coincide, only these are well-posed."""
    a, b = np.atleast_1d(np.poly(mine)), np.atleast_1d(np.poly(theirs))
    return a.shape == b.shape and np.allclose(a, b, rtol=0, atol=1e-7 * np.abs(b).max())


@pytest.mark.slow
@MANY
@given(st.integers(0, 100_000), st.integers(1, 7), st.integers(0, 2), st.integers(0, 100))
def test_each_row_agrees_with_the_pencil_of_everything(
    seed: int, size: int, rings: int, pick: int
) -> None:
    net = random_net(seed, size, rings=rings, controlled=0.4, sources=1.0, resistors=0.7)
    elements = net.of("C", "I", "R", "G", "Se", "Sf")
    if not elements:
        return
    output = f"{elements[pick % len(elements)]}.{'ef'[pick % 2]}"
    for there, row in modes_of(net, output):
        pencil = analyse(whole(there, output))
        # a bond variable that nothing determines makes the whole pencil singular, though what is
        # stored may still move as it must
        if not pencil.regular:
            continue
        assert row.solvable and row.order == pencil.order
        assert same(row.poles, pencil.poles)
        assert row.impulse_free
        for has, test in ((row.controllable, controllability), (row.observable, observability)):
            if has is not None:
                reach = test(pencil)
                assert (has.finite, has.rank) == (reach.finite, reach.rank)
                assert has.sure
                assert same(has.modes, reach.modes)
