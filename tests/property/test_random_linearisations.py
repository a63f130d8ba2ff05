"""Random graphs, linearised where a run passes: against differences of the rates of the engine."""

import numpy as np
import pytest

import hybond as hb
from hybond.analysis.linear.point import of_run
from hybond.equations.calculus import rate_name
from hybond.equations.linear_rows import linear_rows
from hybond.equations.moving_constraints import turned
from hybond.errors import HybondError
from hybond.export.linear.proper import proper
from hybond.testing import random_recipe

SIZE = 1e-4
"""Part of the largest state that one is moved by."""


@pytest.mark.sampled(3)
@pytest.mark.parametrize("seed", range(60))
def test_the_jacobian_where_a_run_passes(seed: int) -> None:
    recipe = random_recipe(seed)
    run = hb.simulate(recipe.model(), recipe.until, on_error="return")
    if run.error is not None:
        pytest.skip("the model has no run")
    graph = run.graph
    t = 0.61 * run.t_end
    point = of_run(run, t)
    try:
        rows = linear_rows(
            graph, point.mode, point.values, inputs=(), outputs={}, landed=point.landed
        )
    except HybondError as error:
        assert error.code == "HB-A506"  # a root at its end
        return
    first = range(len(graph.storages), rows.stored)
    kept = proper(rows.E, rows.A, rows.B, rows.stored, keep=first).kept
    rows, _ = turned(rows, kept)
    found = proper(rows.E, rows.A, rows.B, rows.stored, keep=kept)
    assert found.kept == kept
    rates = [rate_name(s) for s in graph.storages] + [i.rate for i in graph.integrals]
    starts = run.trace.segments.times
    segment = run.segments[max(int(np.searchsorted(starts, t, side="right")) - 1, 0)]
    largest = max(float(np.abs(point.state).max(initial=0.0)), 1e-3)

    def slopes(h: float) -> np.ndarray:
        columns = []
        for j in range(len(kept)):
            way = found.basis[: rows.stored, j]
            step = h * largest / max(float(np.abs(way).max()), 1.0)
            both = [
                run.signals.at(segment, rates, np.array([t]), (point.state + s * way)[None])
                for s in (step, -step)
            ]
            ahead, behind = (np.array([v[0] for v in values])[list(kept)] for values in both)
            columns.append((ahead - behind) / (2 * step))
        return np.array(columns).reshape(len(kept), len(kept)).T

    # differences of second order at two steps: what is left is of the fourth
    exact = (4 * slopes(SIZE / 2) - slopes(SIZE)) / 3
    scale = float(np.abs(found.A).max(initial=0.0))
    np.testing.assert_allclose(exact, found.A, rtol=0.0, atol=1e-5 * scale + 1e-300)
