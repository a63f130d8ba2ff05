"""Blocks in a row that rub on the ground: steps of Moreau and Jean, and a system solved apart."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pytest
from numpy.typing import NDArray

import hybond as hb
from hybond.engine.timestepping import step_laws

STIFF, DAMPED, PUSH, STEP = 100.0, 1.0, 5.0, 0.01
ONE, APART = (0.3,) * 5, (0.1, 0.0, 2.0, 0.4, 0.2)


def row(limits: Sequence[float], *, turned: bool) -> hb.Model:
    """Return blocks on a wall with springs and dampers between them, the last one driven."""
    m = hb.Model("row", domain="translational")
    m.add(drive=hb.Se(f"{PUSH}*sin(6*time)"))
    for k, limit in enumerate(limits, 1):
        m.add(**{f"v{k}": hb.One(law="coulomb", limit=limit), f"m{k}": hb.I(1.0)})
        m.add(**{f"d{k}": hb.Zero(), f"link{k}": hb.One()})
        m.add(**{f"k{k}": hb.C(1.0 / STIFF), f"b{k}": hb.R(DAMPED)})
        m.bond(f"v{k} -> m{k}", f"link{k} -> k{k}", f"link{k} -> b{k}")
        if turned:
            m.bond(f"d{k} -> v{k}", f"link{k} -> d{k}")
            m.bond(*([f"v{k - 1} -> d{k}"] if k > 1 else []))
        else:
            m.bond(f"v{k} -> d{k}", f"d{k} -> link{k}")
            m.bond(*([f"d{k} -> v{k - 1}"] if k > 1 else []))
    m.bond(f"drive -> v{len(limits)}")
    return m


def stepped(limits: Sequence[float], steps: int) -> tuple[NDArray[np.float64], ...]:
    """Return stretches and velocities after implicit steps, friction found by trying all ways."""
    n = len(limits)
    apart = np.eye(n) - np.eye(n, k=-1)  # velocities of the links
    tie = STEP * DAMPED + STEP**2 * STIFF
    whole = np.eye(n) + tie * apart.T @ apart
    most = STEP * np.array(limits)
    q, v, way = np.zeros(n), np.zeros(n), np.zeros(n)
    for step in range(1, steps + 1):
        given = v - STEP * STIFF * apart.T @ q
        given[-1] += STEP * PUSH * math.sin(6.0 * step * STEP)
        for _ in range(50):
            loose = way != 0.0
            v = np.zeros(n)
            v[loose] = np.linalg.solve(whole[np.ix_(loose, loose)], (given - most * way)[loose])
            held = given - whole @ v
            wrong = np.where(loose, way * v < 0.0, np.abs(held) > most)
            if not wrong.any():
                break
            way = np.where(wrong, np.where(loose, 0.0, np.sign(held)), way)
        q = q + STEP * apart @ v
    return q, v


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("limits", [ONE, APART])
def test_blocks_in_a_row_step_as_a_system_that_is_solved_apart(
    limits: Sequence[float], turned: bool
) -> None:
    many = range(1, len(limits) + 1)
    run = hb.simulate(
        row(limits, turned=turned), until=200 * STEP, solver="moreau-jean", step=STEP, theta=1.0
    )
    q, v = stepped(limits, 200)
    assert np.count_nonzero(q) > 1
    assert [run.final[f"k{k}.q"] for k in many] == pytest.approx(q, rel=1e-10, abs=1e-13)
    assert [run.final[f"m{k}.p"] for k in many] == pytest.approx(v, rel=1e-10, abs=1e-13)


def test_what_friction_may_hold_is_asked_once_a_law_and_not_for_each_pair_of_laws(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked = []
    told = step_laws.limit_of
    monkeypatch.setattr(step_laws, "limit_of", lambda s, p, k: asked.append(k) or told(s, p, k))
    run = hb.simulate(
        row(ONE, turned=False),
        until=10 * STEP,
        solver="moreau-jean",
        step=STEP,
        theta=1.0,
        engine="python",
    )
    assert run.stats["steps"] == 10
    # a step in which a law turns may be looked at twice
    assert 10 * len(ONE) <= len(asked) <= 2 * 10 * len(ONE) < 10 * len(ONE) ** 2
