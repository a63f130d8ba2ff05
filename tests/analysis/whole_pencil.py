"""A second derivation for tests: every effort and flow of a random net stays a variable.

``x' = Y w`` and the junctions, two-ports, resistors, sources and storages as they stand make one
large descriptor, ``v = [x, w]``. Eliminating w changes neither its finite eigenvalues nor which of
them an input reaches, so it judges the equations that hybond derives. Nothing of hybond's
equations is used.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

from hybond.equations.descriptor import Descriptor

sys.path.insert(0, str(Path(__file__).parents[1] / "property"))

from dense_oracle import Dense, Net, random_net


def whole(net: Net, *outputs: str) -> Descriptor:
    """Return the large descriptor of the net's mode.

    Its inputs are all sources; `outputs` are variables of one-ports, such as ``"r1.f"``.
    """
    d = Dense(net)
    n, nw, nu, nk = len(d.h), 2 * d.nb, len(d.s), len(d.k)
    size = n + nw
    e, a, b = np.zeros((size, size)), np.zeros((size, size)), np.zeros((size, nu))
    e[:n, :n] = np.eye(n)
    a[:n, n:] = d.y
    a[n:, n:] = d.m
    a[n + nk + nu :, :n] = -np.diag(d.h)
    b[n + nk : n + nk + nu] = -np.eye(nu)
    c = np.zeros((len(outputs), size))
    for row, output in zip(c, outputs, strict=True):
        name, _, variable = output.partition(".")
        ((bond, _, _),) = net.ends(name)
        row[n + bond + (d.nb if variable == "f" else 0)] = 1.0
    names = tuple(net.of("C", "I")) + tuple(f"w{k}" for k in range(nw))
    sources = tuple(net.of("Se", "Sf"))
    return Descriptor(
        e, a, b, c, np.zeros((len(c), nu)), np.zeros_like(c), names, sources, outputs, n
    )


def with_moduli_in_rings(net: Net, seed: int) -> Net:
    """Return the net with a transformer in each ring of bonds that would have none."""
    rng = np.random.default_rng(seed)
    root = {n: n for n in net.nodes}

    def find(n: str) -> str:
        while root[n] != n:
            n = root[n]
        return n

    def ends(bond: tuple[str, str]) -> list[str]:
        return [end.partition(".")[0] for end in bond]

    def plain(bond: tuple[str, str]) -> bool:
        return all(net.nodes[n][0] in "01" for n in ends(bond))

    nodes, bonds = dict(net.nodes), []
    for bond in sorted(net.bonds, key=plain):
        a, b = (find(n) for n in ends(bond))
        root[a] = b
        if a != b or not plain(bond):
            bonds.append(bond)
        else:
            name = f"ring{len(bonds)}"
            nodes[name] = ("TF", float(rng.uniform(0.4, 2.5)))
            bonds += [(bond[0], f"{name}.1"), (f"{name}.2", bond[1])]
    return replace(net, nodes=nodes, bonds=bonds)


__all__ = ["Net", "random_net", "whole", "with_moduli_in_rings"]
