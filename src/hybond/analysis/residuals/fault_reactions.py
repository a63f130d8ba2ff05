"""Single faults, and whether a residual reacts to them.

What is added to a sensor or source can be read off a residual. For another value of a parameter,
or a machine in another state, the residual is compared with those of the faulty plant: it reacts
if it does not follow from them, that is, if some motion of the faulty plant does not make it zero.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from hybond.analysis.residuals.relations import ONE, PRIME, Module, Relation, evaluate, residue
from hybond.equations.element_rows import laws_of
from hybond.equations.symbolic.rational import Rational
from hybond.model.expressions import Expr, names
from hybond.model.graph import Mode
from hybond.model.kinds import SOURCES

if TYPE_CHECKING:
    from hybond.analysis.residuals.residuals import Residuals

DEVIATION = 1.0 + 2.0**-5 + 2.0**-9
"""The faulty value of a parameter, as a factor; any other would do but for rare exceptions."""

FaultKind = Literal["parameter", "sensor", "source", "switch"]


@dataclass(frozen=True, slots=True)
class Fault:
    """One single fault.

    Parameters
    ----------
    kind : {"parameter", "sensor", "source", "switch"}
    name : str
        ``R1.R``, ``De1``, ``V1``, ``S1 stuck on``.
    key : str
        The canonical name of a parameter.
    machine, state : int
        Of a switch.
    """

    kind: FaultKind
    name: str
    key: str = ""
    machine: int = -1
    state: int = -1


def faults_of(about: Residuals) -> list[Fault]:
    """Return all single faults: sources and parameters, sensors, machines that stay in a state."""
    graph = about.graph
    # a source that is zero, or that a signal modulates, has no value to deviate from
    given = {k.node for k in about.given.known.values() if k.kind == "source"}
    found: list[Fault] = []
    seen: set[str] = set()
    for node in graph.nodes:
        if node.is_junction or node.hidden:
            continue
        if node.kind in SOURCES and node.index in given:
            found.append(Fault("source", node.path))
        law = laws_of(graph, node, symbolic=True)
        read: set[str] = set()
        for e in [*law.expressions, *(c for row in law.matrix or () for c in row)]:
            read |= {n for n in names(e) if n.startswith("p:")}
        for name in sorted(read - seen):
            seen.add(name)
            found.append(Fault("parameter", about.display.name(name), name))
    found += [Fault("sensor", name) for name in about.sensors]
    for machine in graph.machines:
        for k, state in enumerate(machine.states):
            found.append(
                Fault("switch", f"{machine.path} stuck {state}", machine=machine.index, state=k)
            )
    return found


class Reactions:
    """Tells which residuals of `about` react to a fault, mode by mode."""

    def __init__(self, about: Residuals) -> None:
        self.about = about
        self._factors: dict[tuple[Expr, str], list[tuple[Hashable, Rational]]] = {}
        for known in about.given.known.values():
            if known.kind == "source":
                # read before values are taken: what is not rational becomes an atom
                self._source(known.formula, "")
        self.healthy = self._values({})
        self._relations: dict[tuple[Mode, str], list[Relation]] = {}

    def _values(self, over: Mapping[str, float]) -> dict[str, int]:
        known = self.about.ring.known(over)
        return {name: residue(v) for name, v in known.items() if v == v}

    # -- what is added to a sensor or source

    def added(self, fault: Fault, mode: Mode) -> tuple[list[bool], list[bool]]:
        """Return which residuals react to an additive fault, and which only while it changes."""
        about = self.about
        reacts, transient = [], []
        for residual in about:
            orders = set()
            for k in residual.row.at(mode, about.ring):
                jet = about.jets.jets[k]
                known = about.given.known[jet.column]
                own = (
                    known.kind == "sensor" and known.name == fault.name
                    if fault.kind == "sensor"
                    else known.node >= 0 and about.graph.nodes[known.node].path == fault.name
                )
                if own:
                    orders.add(jet.order)
            reacts.append(bool(orders))
            transient.append(bool(orders) and 0 not in orders)
        return reacts, transient

    # -- what makes another plant

    def changed(self, fault: Fault, mode: Mode) -> list[bool]:
        """Return which residuals react to another value of a parameter, or to a stuck switch."""
        own = self._all(mode, "")
        if fault.kind == "switch":
            stuck = (*mode[: fault.machine], fault.state, *mode[fault.machine + 1 :])
            faulty = self._all(stuck, "")
        else:
            faulty = self._all(mode, fault.key)
        if own == faulty:
            return [False] * len(own)
        plant = Module(faulty)
        return [a != b and not plant.contains(a) for a, b in zip(own, faulty, strict=True)]

    def _all(self, mode: Mode, parameter: str) -> list[Relation]:
        at = (mode, parameter)
        if at not in self._relations:
            values, mark = self.healthy, ""
            if parameter:
                value = self.about.ring.values.get(parameter, 0.0)
                new = value * DEVIATION if value else 1.0
                values, mark = self._values({parameter: new}), parameter
            self._relations[at] = [
                self._relation(r.row.at(mode, self.about.ring), values, mark) for r in self.about
            ]
        return self._relations[at]

    def _relation(
        self, row: Mapping[int, Rational], values: Mapping[str, int], mark: str
    ) -> Relation:
        about = self.about
        total: Relation = {}

        def add(key: Hashable, order: int, c: int) -> None:
            at = (key, order)
            value = (total.get(at, 0) + c) % PRIME
            if value:
                total[at] = value
            else:
                total.pop(at, None)

        for k, coefficient in row.items():
            jet = about.jets.jets[k]
            known = about.given.known[jet.column]
            c = evaluate(coefficient, values)
            if known.kind == "sensor":
                add(known.name, jet.order, c)
                continue
            for key, factor in self._source(known.formula, mark):
                if key == ONE and jet.order:
                    continue
                add(key, jet.order, c * evaluate(factor, values))
        return total

    def _source(self, formula: Expr, mark: str) -> list[tuple[Hashable, Rational]]:
        """Return what a source gives as functions of time with coefficients in parameters.

        A function that itself reads the faulty parameter is another one in the faulty plant.
        """
        at = (formula, mark)
        if at in self._factors:
            return self._factors[at]
        ring = self.about.ring
        whole = ring.read(formula)

        def reads(atom: str) -> set[str]:
            return set(names(ring.meaning[atom])) if atom in ring.meaning else {atom}

        def moving(atom: str) -> bool:
            return not all(n.startswith("p:") for n in reads(atom))

        def label(atoms: Iterable[object], inside: set[str]) -> Hashable:
            return (*atoms, mark if mark in inside else "")

        below = whole.denominator
        if any(moving(a) for factor in below for a in factor.atoms()):
            inside = {n for a in whole.atoms() for n in reads(a)}
            self._factors[at] = [(label([str(formula)], inside), Rational.of(1))]
            return self._factors[at]
        over = Rational.of(1)
        for factor, power in below.items():
            over = over * Rational.from_polynomial(factor) ** power
        found: dict[Hashable, Rational] = {}
        for monomial, number in whole.numerator.terms.items():
            c = Rational.of(number) / over
            atoms = []
            inside = set()
            for atom, power in monomial:
                if moving(atom):
                    atoms.append((atom, power))
                    inside |= reads(atom)
                else:
                    c = c * Rational.atom(atom) ** power
            key = label(sorted(atoms), inside) if atoms else ONE
            found[key] = found[key] + c if key in found else c
        self._factors[at] = list(found.items())
        return self._factors[at]
