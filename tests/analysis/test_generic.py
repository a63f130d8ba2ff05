"""Random values in place of the model's: patterns stay, laws stay laws."""

from __future__ import annotations

import numpy as np
import pytest

import hybond as hb
from hybond.analysis.structure.generic import generic, with_constants
from hybond.model.expressions import compile_expression
from hybond.model.graph import FlatGraph


def fields() -> FlatGraph:
    """One of each: a field of storage, one of resistance, both two-ports, a nonlinear law."""
    m = hb.Model("fields")
    m.add(a=hb.One(), b=hb.One(), c=hb.One(), V=hb.Se(3), cubic=hb.R({"e": "f^3"}))
    m.add(L=hb.I([[2, 1, 0], [1, 2, 0], [0, 0, 4]]), R=hb.R([[1, 0, -2], [0, 0, 0], [5, 0, 6]]))
    m.add(t=hb.TF(-2), g=hb.GY(3), k=hb.C(2), G=hb.G(0), z=hb.Zero())
    for k, name in enumerate("abc", 1):
        m.bond(f"{name} -> L.{k}", f"{name} -> R.{k}")
    m.bond("V -> a")
    m.bond("a -> t.1", "t.2 -> z -> k", "b -> g.1", "g.2 -> z", "z -> G", "c -> cubic")
    return m.flatten()


def matrices(graph: FlatGraph) -> dict[str, np.ndarray]:
    return {
        n.path: np.array(n.law.matrix)
        for n in graph.nodes
        if n.law is not None and n.law.matrix is not None
    }


@pytest.mark.parametrize("seed", range(5))
def test_zeros_stay_and_all_else_changes(seed: int) -> None:
    old, new = matrices(fields()), matrices(generic(fields(), seed))
    assert old.keys() == new.keys()
    for path in old.keys() - {"V"}:
        assert np.array_equal(old[path] == 0.0, new[path] == 0.0), path
        where = old[path] != 0.0
        assert (old[path] != new[path])[where].all(), path
    assert np.array_equal(new["V"], old["V"])
    assert np.array_equal(new["L"], new["L"].T)
    assert np.linalg.eigvalsh(new["L"]).min() > 0.0
    # entries of a resistance are independent of each other unless it was symmetric
    assert new["R"][0, 2] != new["R"][2, 0]


def test_the_same_seed_gives_the_same_values() -> None:
    one, two, other = (matrices(generic(fields(), k)) for k in (3, 3, 4))
    assert all(np.array_equal(one[p], two[p]) for p in one)
    assert not np.array_equal(one["L"], other["L"])


def test_expressions_say_what_matrices_say() -> None:
    for node in generic(fields(), 0).nodes:
        law = node.law
        if law is None or law.matrix is None or node.kind not in ("C", "I", "R", "G"):
            continue
        argument = node.about.energy or ("f" if law.output == "e" else "e")
        many = len(node.ends) > 1
        names = [f"law:{argument}{k + 1 if many else ''}" for k in range(len(node.ends))]
        slots = {name: k for k, name in enumerate(names)}
        values = list(np.random.default_rng(1).normal(size=len(names)))
        found = [compile_expression(e, slots, pre_offset=0)(values) for e in law.expressions]
        assert found == pytest.approx(list(np.array(law.matrix) @ values))


def test_only_laws_that_are_no_constants_are_replaced() -> None:
    old, new = matrices(fields()), matrices(with_constants(fields(), 0))
    assert new.keys() - old.keys() == {"cubic"}
    assert all(np.array_equal(old[p], new[p]) for p in old)
