"""Time constants against the finite eigenvalues of the whole descriptor pencil (QZ)."""

import itertools
import random

import numpy as np
import pytest
import scipy.linalg

from hybond.causality.time_constants import time_constants
from hybond.model.graph import FlatGraph

OUTPUT = {"R": "e", "G": "f"}


def pencil(graph: FlatGraph, off: frozenset[int]) -> tuple[np.ndarray, np.ndarray]:
    """Return E, A of ``E z' = A z`` with z = (efforts, flows, stored); from the definitions."""
    n, m = len(graph.bonds), len(graph.storages)
    rows: list[np.ndarray] = []

    def row(**entries: float) -> None:
        rows.append(np.zeros(2 * n + m))
        for name, value in entries.items():
            rows[-1][int(name[1:]) + {"e": 0, "f": n, "x": 2 * n}[name[0]]] += value

    for node in graph.nodes:
        ends = node.ends
        if node.is_junction:
            same, other = ("e", "f") if node.kind == "0" else ("f", "e")
            if node.index in off:
                for end in ends:
                    row(**{f"{same}{end.bond}": 1.0})
                continue
            for a, b in itertools.pairwise(ends):
                row(**{f"{same}{a.bond}": 1.0, f"{same}{b.bond}": -1.0})
            row(**{f"{other}{end.bond}": end.sign for end in ends})
        elif node.kind in ("TF", "GY"):
            a, b = ends
            value = 0.0 if node.index in off else node.law.matrix[0][0]
            power_a, power_b = a.sign, -b.sign  # in at the first, out at the second
            if node.kind == "TF":
                row(**{f"e{a.bond}": 1.0, f"e{b.bond}": -value})
                row(**{f"f{b.bond}": power_b, f"f{a.bond}": -value * power_a})
            else:
                row(**{f"e{a.bond}": 1.0, f"f{b.bond}": -value * power_b})
                row(**{f"e{b.bond}": 1.0, f"f{a.bond}": -value * power_a})
        elif node.kind in ("R", "G"):
            value = node.law.matrix[0][0] if node.kind == "R" else 1 / node.law.matrix[0][0]
            row(**{f"e{ends[0].bond}": 1.0, f"f{ends[0].bond}": -value * ends[0].sign})
        elif node.kind in ("Se", "Sf"):
            row(**{f"{'e' if node.kind == 'Se' else 'f'}{ends[0].bond}": 1.0})
    for s in graph.storages:
        stiffness = graph.nodes[s.node].law.matrix[0][0]
        gives = {f"e{s.bond}": 1.0} if s.kind == "C" else {f"f{s.bond}": float(s.sign)}
        row(**gives, **{f"x{s.index}": -stiffness})
    above = len(rows)
    E = np.zeros((above + m, 2 * n + m))
    for s in graph.storages:
        E[above + s.index, 2 * n + s.index] = 1.0
        row(**({f"f{s.bond}": float(s.sign)} if s.kind == "C" else {f"e{s.bond}": 1.0}))
    return E, np.array(rows)


def random_graph(build, draw: random.Random):
    count = draw.randint(1, 5)
    kinds = {f"n{k}": draw.choice("01") for k in range(count)}
    bonds = []
    for k in range(1, count):
        other, link = draw.randrange(k), draw.choice(["", "", "TF", "GY"])
        if link:
            kinds[f"t{k}"] = link
            bonds += [f"n{other} -> t{k}", f"t{k} -> n{k}"]
        else:
            bonds.append(f"n{other} -> n{k}")
    for k in range(count):
        for j in range(draw.randint(1, 3)):
            kinds[f"x{k}_{j}"] = draw.choice(["C", "I", "C", "I", "R", "G", "Se", "Sf"])
            bonds.append(f"n{k} -> x{k}_{j}")
    values = {name: draw.uniform(0.3, 3.0) for name in kinds}
    able = [name for name, kind in kinds.items() if kind in ("0", "1", "TF", "GY")]
    switches = draw.sample(able, draw.randint(0, min(2, len(able))))
    reverse = [k for k in range(len(bonds)) if draw.random() < 0.4]
    return build(kinds, bonds, values=values, switches=switches, reverse=reverse)


@pytest.mark.slow
def test_they_are_the_finite_eigenvalues_of_the_pencil(build) -> None:
    compared = dependent = 0
    for seed in range(600):
        draw = random.Random(seed)
        graph = random_graph(build, draw)
        mode = tuple(draw.randint(0, 1) for _ in graph.machines)
        E, A = pencil(graph, graph.off_nodes(mode))
        if A.shape[0] != A.shape[1] or np.linalg.cond(A - 0.6180339 * E) > 1e8:
            continue  # no causality: the equations are not those of a motion
        infinite = scipy.linalg.eig(A, E, right=False, homogeneous_eigvals=True)
        finite = np.abs(infinite[1]) > 1e-6 * np.abs(infinite[0])
        rates = np.abs(infinite[0][finite] / infinite[1][finite])
        expected = sorted(1 / rate for rate in rates if rate > 1e-6)
        found = [tau for tau in time_constants(graph, mode) if tau < 1e6]
        assert found == pytest.approx(expected, rel=1e-5), (seed, mode)
        compared += 1
        dependent += int(np.sum(finite)) < len(graph.storages)
    assert compared > 200 and dependent > 50
