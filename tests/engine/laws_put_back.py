"""What a graph says in a mode, put to values found elsewhere: nothing is solved here."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy.integrate import quad

from hybond.model.expressions import Expr, Name, Neg, compile_expression, substitute
from hybond.model.graph import FlatGraph, Node, Storage

Values = Sequence[float]


def laws_of(graph: FlatGraph) -> Laws:
    """Return the laws of a graph, on values in the order of `names_of`."""
    index = names_of(graph)
    return Laws(graph, index, len(index))


def names_of(graph: FlatGraph) -> dict[str, int]:
    """Return a place for each canonical name."""
    bonds = range(len(graph.bonds))
    names = [
        "time",
        *(f"{kind}:{i.index}" for kind in ("u", "du") for i in graph.inputs),
        *(f"s:{i.index}" for i in graph.integrals),
        *(f"x:{s.index}" for s in graph.storages),
        *(f"{kind}:{b}" for kind in "ef" for b in bonds),
        *(f"on:{n.index}" for n in graph.nodes if n.controlled),
        *(f"in:{m.index}:{k}" for m in graph.machines for k in range(len(m.states))),
        *(f"at:{w.index}" for w in graph.watches),
    ]
    return {name: k for k, name in enumerate(names)}


class Laws:
    """Junctions, elements, storage and integrals of a graph.

    Parameters
    ----------
    graph : FlatGraph
    index : dict
        Where each canonical name stands in values; a priori values stand `size` further on.
    size : int
    """

    def __init__(self, graph: FlatGraph, index: dict[str, int], size: int) -> None:
        self.graph, self.index, self.size = graph, index, size
        self.stored: dict[int, list[Storage]] = {}
        for s in graph.storages:
            self.stored.setdefault(s.node, []).append(s)
        self.laws = {
            n.index: [self.closure(self.localised(n, e)) for e in n.law.expressions]
            for n in graph.nodes
            if n.law is not None
        }

    def closure(self, e: Expr) -> Callable[[Values], float]:
        return compile_expression(e, self.index, pre_offset=self.size)

    def localised(self, node: Node, e: Expr) -> Expr:
        """Return a law in names of the graph; flow is counted into the element."""
        many = len(node.ends) > 1
        local: dict[str, Expr] = {}
        for end in node.ends:
            k = str(end.port + 1) if many else ""
            local[f"law:e{k}"] = Name(f"e:{end.bond}")
            flow = Name(f"f:{end.bond}")
            local[f"law:f{k}"] = flow if end.inward else Neg(flow)
        for s in self.stored.get(node.index, ()):
            local[f"law:{node.about.energy}{s.port + 1 if many else ''}"] = Name(f"x:{s.index}")
        return substitute(e, local)

    def e(self, v: Values, bond: int) -> float:
        return v[self.index[f"e:{bond}"]]

    def f(self, v: Values, bond: int) -> float:
        return v[self.index[f"f:{bond}"]]

    def into(self, v: Values, node: Node, port: int) -> tuple[float, float]:
        """Return effort and flow into a port."""
        end = next(end for end in node.ends if end.port == port)
        return self.e(v, end.bond), end.sign * self.f(v, end.bond)

    def switched(self, modes: Sequence[Sequence[int]]) -> set[int]:
        """Return the junctions that are not ON in all of some modes.

        Where such modes are combined each is held to what any of them forbids, and then says less
        of these junctions than it would alone.
        """
        on = [self.graph.on_nodes(tuple(mode)) for mode in modes]
        return set(frozenset.union(*on) - frozenset.intersection(*on))

    def off(
        self, v: Values, mode: Sequence[int], apart: set[int] | frozenset[int] = frozenset()
    ) -> dict[str, list[float]]:
        """Return what ought to be zero, by element, with the largest term that it is made of.

        The nodes `apart` are left out.
        """
        on = self.graph.on_nodes(tuple(mode))
        found: dict[str, list[float]] = {}
        for node in self.graph.nodes:
            if node.index in apart:
                continue
            active = not node.controlled or node.index in on
            if node.is_junction:
                pairs = self._junction(v, node, active)
            else:
                pairs = self._element(v, node, active)
            for k, terms in enumerate(pairs):
                found[f"{node.path} {k}"] = [sum(terms), max(abs(a) for a in terms)]
        return found

    def _junction(self, v: Values, node: Node, active: bool) -> list[list[float]]:
        read = (self.e, self.f) if node.kind == "0" else (self.f, self.e)
        common = [read[0](v, end.bond) for end in node.ends]
        if not active:
            return [[a, 0.0] for a in common]
        net = [end.sign * read[1](v, end.bond) for end in node.ends]
        return [*([a, -common[0]] for a in common[1:]), net]

    def _element(self, v: Values, node: Node, active: bool) -> list[list[float]]:
        # a source that is OFF gives nothing, a two-port has the modulus 0
        laws = [law(v) if active else 0.0 for law in self.laws[node.index]]
        if node.kind in ("TF", "GY"):
            (e1, f1), (e2, f2) = self.into(v, node, 0), self.into(v, node, 1)
            m = laws[0]
            if node.kind == "TF":
                return [[e1, -m * e2], [-f2, -m * f1]]
            return [[e1, m * f2], [e2, -m * f1]]
        gives = "e" if node.kind in ("Se", "C") else "f" if node.kind in ("Sf", "I") else None
        gives = gives or node.law.output
        found = []
        for port, law in enumerate(laws):
            e, f = self.into(v, node, port)
            if node.kind == "Sf":
                # a source gives in the direction of its arrow
                f = self.f(v, node.ends[0].bond)
            found.append([e if gives == "e" else f, -law])
        return found

    def rates(self, v: Values) -> np.ndarray:
        """Return what flows into each storage, then the rate of each integral."""
        nodes = self.graph.nodes
        stored = []
        for s in self.graph.storages:
            e, f = self.into(v, nodes[s.node], s.port)
            stored.append(f if s.kind == "C" else e)
        return np.array([*stored, *(self.closure(i.rate)(v) for i in self.graph.integrals)])

    def powers(self, v: Values) -> tuple[float, float]:
        """Return power supplied by sources and dissipated by resistors."""
        supplied = dissipated = 0.0
        for node in self.graph.nodes:
            for end in node.ends:
                if self.graph.bonds[end.bond].domain.pseudo:
                    continue
                power = end.sign * self.e(v, end.bond) * self.f(v, end.bond)
                if node.kind in ("Se", "Sf"):
                    supplied -= power
                elif node.kind in ("R", "G"):
                    dissipated += power
        return supplied, dissipated

    def energy(self, x: np.ndarray) -> float:
        """Return the stored energy, along a ray from nothing."""
        total = 0.0
        for node_index, own in self.stored.items():
            node = self.graph.nodes[node_index]
            if any(self.graph.bonds[end.bond].domain.pseudo for end in node.ends):
                continue
            x_own = np.array([x[s.index] for s in own])
            if node.law.matrix is not None:
                total += 0.5 * x_own @ np.array(node.law.matrix) @ x_own
                continue
            v = [0.0] * (2 * self.size)

            def power(part: float, own=own, x_own=x_own, laws=self.laws[node_index], v=v) -> float:
                for s, a in zip(own, x_own):
                    v[self.index[f"x:{s.index}"]] = part * a
                return sum(laws[s.port](v) * a for s, a in zip(own, x_own))

            total += quad(power, 0.0, 1.0, epsabs=0.0, epsrel=1e-13, limit=200)[0]
        return total
