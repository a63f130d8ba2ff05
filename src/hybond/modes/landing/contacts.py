"""Contacts: pinnacle states that impacts happen in, seen as structure.

The impact law is a source; what it prescribes must vanish for the contact to rest, and the
conjugate variable is the reaction, which the contact then carries.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial, reduce

from hybond.model.expressions import (
    Binary,
    Call,
    Compare,
    Expr,
    Name,
    Number,
    Pre,
    names,
    substitute,
    transform,
)
from hybond.model.fieldless import reads_pre
from hybond.model.graph import FlatGraph, Machine, Mode, Node, Rule


@dataclass(frozen=True, slots=True)
class Reaction:
    """One impact law and what it makes the contact carry.

    Parameters
    ----------
    law : int
        The source that reads ``pre()``.
    prescribed : tuple of (str, float)
        Canonical names and signs whose sum the law prescribes: what must vanish at rest.
    own : float
        Sign of the law's own value in that sum.
    name, text : str
        The conjugate variable, canonical and as written.
    """

    law: int
    prescribed: tuple[tuple[str, float], ...]
    own: float
    name: str
    text: str


@dataclass(frozen=True, slots=True)
class Contact:
    """A pinnacle state of a machine, its reactions, and the state that it rests in.

    That is the same state for a machine that was written, ``closed`` for a junction with a law.
    """

    machine: Machine
    state: int
    reactions: tuple[Reaction, ...]
    rest: int


def contact_of(graph: FlatGraph, machine: Machine, state: int) -> Contact | None:
    """Return the contact that a state of a machine closes by an impact law; None if it does not.

    The law is a source beside a junction whose common variable it does not prescribe: ``Sf`` on a
    0-junction, or ``Se`` on a 1-junction. It reads ``pre()``, unless its restitution is zero.
    """
    own = machine.law
    if own is not None and own.two_sided:
        return None  # dry friction
    laws = [
        node
        for node in _beside(graph, machine.on[state])
        if node.kind in ("Se", "Sf")
        and (not node.implied if own is None else node.index == own.source)
    ]
    if machine.fieldless and machine.fieldless[state]:
        laws = [node for node in laws if reads_pre(node)]
    reactions = [r for r in (_reaction(graph, node) for node in laws) if r is not None]
    if not reactions or len(reactions) < len(laws):
        return None
    rest = machine.states.index("closed") if own is not None else state
    return Contact(machine, state, tuple(reactions), rest)


def _beside(graph: FlatGraph, switched: Iterable[int]) -> list[Node]:
    """Return some nodes and their neighbours."""
    found = set(switched)
    for k in switched:
        bonds = (graph.bonds[end.bond] for end in graph.nodes[k].ends)
        found.update(b.head if b.tail == k else b.tail for b in bonds)
    return [graph.nodes[k] for k in sorted(found)]


def _reaction(graph: FlatGraph, node: Node) -> Reaction | None:
    own, other = ("f", "e") if node.kind == "Sf" else ("e", "f")
    end = node.ends[0]
    bond = graph.bonds[end.bond]
    junction = graph.nodes[bond.head if bond.tail == node.index else bond.tail]
    if junction.kind != ("0" if node.kind == "Sf" else "1"):
        return None
    # what the other bonds bring in; the source's own bond carries what its law says at rest
    around = [e for e in junction.ends if e.bond != end.bond]
    sign = next(float(e.sign) for e in junction.ends if e.bond == end.bond)
    prescribed = tuple((f"{own}:{e.bond}", float(e.sign)) for e in around)
    text = f"{node.path if junction.hidden else junction.path}.{other}"
    return Reaction(node.index, prescribed, sign, f"{other}:{end.bond}", text)


def approach(graph: FlatGraph, contact: Contact) -> Expr:
    """Return how far a state is from what the impact laws prescribe at rest."""
    parts: list[Expr] = []
    for r in contact.reactions:
        terms: list[Expr] = [Binary("*", Number(sign), Name(name)) for name, sign in r.prescribed]
        law = graph.nodes[r.law].law
        if r.own and law is not None:
            terms.append(Binary("*", Number(r.own), transform(law.expressions[0], _without_prior)))
        parts.append(Call("abs", (reduce(partial(Binary, "+"), terms),)))
    return reduce(lambda a, b: Call("max", (a, b)), parts)


def _without_prior(e: Expr) -> Expr:
    """Return an expression with what was before at its limit, zero."""
    if not isinstance(e, Pre):
        return e
    return substitute(e.arg, {name: Number(0.0) for name in names(e.arg)})


def with_states(mode: Mode, contacts: Sequence[Contact]) -> Mode:
    """Return the mode with these contacts at rest."""
    states = list(mode)
    for contact in contacts:
        states[contact.machine.index] = contact.rest
    return tuple(states)


def at_rest(machine: Machine, contact: Contact, signs: Mapping[str, int]) -> Machine:
    """Return a landed machine: it is left by its first exit when a reaction changes its sign."""
    exits = [r for r in machine.rules if r.source == contact.state]
    rules = []
    for reaction in contact.reactions:
        op = "<" if signs[reaction.name] > 0 else ">"
        name = Name(reaction.name)
        rules.append(
            Rule(
                contact.state,
                exits[0].target,
                Compare(op, name, Number(0.0)),
                f"{reaction.text} {op} 0",
                ((reaction.text, name),),
            )
        )
    others = tuple(r for r in machine.rules if r.source != contact.state)
    return replace(machine, rules=(*others, *rules))
