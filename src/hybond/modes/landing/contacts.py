"""Contacts: pinnacle states that impacts happen in, seen as structure.

The impact law is a source; what it prescribes must vanish for the contact to rest, and the
conjugate variable is the reaction, which the contact then carries.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial, reduce

from hybond.engine.tables.contacts import Contact
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
from hybond.model.graph import FlatGraph, Machine, Mode, Rule


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
