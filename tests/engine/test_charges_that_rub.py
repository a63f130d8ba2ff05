"""Capacitors joined by dry friction and one-way junctions: where their charges jump to.

What is stored after a jump is the least of stored energy and friction's: one answer. It is looked
for among all branches of the laws, from the charges of nodes alone.
"""

from __future__ import annotations

import itertools
import random

import numpy as np
import pytest

import hybond as hb


def expected(node: np.ndarray, charge: np.ndarray, ratio: float, limit: float) -> np.ndarray:
    """Return the efforts of nodes 0, 2, 5 after the jump.

    Node 0 and node 5 are never below zero, for which charge comes; through the friction it goes
    from node 0, and `ratio` of it from node 5, to node 2.
    """
    k = np.linalg.inv(node)
    ways = np.array([[1.0, 0.0, 0.0], [-1.0, 1.0, -ratio], [0.0, 0.0, 1.0]])
    m, q = ways @ k @ ways.T, ways @ k @ charge
    found = []
    for left, slip, right in itertools.product((0, 1), (-1, 0, 1), (0, 1)):
        active = [i for i, on in enumerate((left, slip, right)) if on]
        aim = np.array([0.0, -limit * slip, 0.0])
        moved = np.zeros(3)
        if active:
            block = m[np.ix_(active, active)]
            moved[active] = np.linalg.solve(block, (aim - q)[active])
        w = m @ moved + q
        size = 1e-9 * (np.abs(m) @ np.abs(moved) + np.abs(q))
        holds = [w[i] >= -size[i] and moved[i] >= 0.0 for i in (0, 2)]
        rubs = abs(w[1]) <= limit + size[1] and moved[1] * slip >= 0.0
        if all(holds) and rubs:
            found.append(k @ (charge + ways.T @ moved))
    assert found
    assert np.allclose(found, found[0], rtol=1e-6, atol=1e-6 * np.abs(found).max())
    return found[0]


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("seed", range(106, 146))
def test_charges_jump_to_the_least_energy(seed: int, turned: bool) -> None:
    r = random.Random(seed)
    unit = 10.0 ** r.uniform(-6.0, 3.0)

    def field() -> np.ndarray:
        a = np.array([[r.uniform(-1.0, 1.0) for _ in range(2)] for _ in range(2)])
        spread = 10.0 ** r.uniform(-2.0, 1.0)
        return np.asarray(unit * (a @ np.diag([1.0, spread]) @ a.T + 0.05 * np.eye(2)))

    def some() -> list[float]:
        return [unit * r.uniform(-2.0, 2.0) for _ in range(2)]

    c2, c4, c1, c5 = field(), field(), unit * r.uniform(0.1, 3.0), unit * r.uniform(0.1, 3.0)
    q2, q4, q1 = some(), some(), unit * r.uniform(-1.0, 1.0)
    ratio, limit = r.uniform(-1.0, 1.0), 10.0 ** r.uniform(-1.0, 1.0)
    m = hb.Model("rubbed")
    m.add(j0=hb.Zero(law="unilateral"), j2=hb.Zero(), j5=hb.Zero(law="unilateral"))
    m.add(j1=hb.One(law="coulomb", limit=limit), t=hb.TF(ratio), c1=hb.C(c1, q=q1))
    m.add(c2=hb.C(c2.tolist(), q=q2), c4=hb.C(c4.tolist(), q=q4), c5=hb.C(c5, q=0.0))
    to_c5 = "c5 -> j0" if turned else "j0 -> c5"
    m.bond("j2 -> c4.1", "j0 -> c4.2", "j2 -> c1", "j1 -> j2", to_c5, "j0 -> j1", "j5 -> c2.2")
    m.bond("c2.1 -> j2" if turned else "j2 -> c2.1", "j5 -> t.2", "t.1 -> j1")
    # charges of nodes 0, 2, 5 and what they answer to
    node = np.zeros((3, 3))
    node[np.ix_([1, 0], [1, 0])] += c4
    node[np.ix_([1, 2], [1, 2])] += c2
    node[1, 1] += c1
    node[0, 0] += c5
    charge = np.array([q4[1], q4[0] + q2[0] + q1, q2[1]])
    efforts = expected(node, charge, ratio, limit)
    run = hb.simulate(m, 1e-3)
    names = [s.path for s in run.graph.storages]
    found = [float(run.events[0].after[names.index(name)]) for name in ("c5.q", "c1.q")]
    assert found == pytest.approx(
        [c5 * efforts[0], c1 * efforts[1]], rel=1e-7, abs=1e-8 * unit * np.abs(efforts).max()
    )
    assert run.audit().holds()
