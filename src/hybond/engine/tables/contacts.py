"""Tables of contacts that may come to rest: the columns `contact_*` and `reaction_*` of the model.

A state of a machine that closes a contact by an impact law is a contact. Once impacts accumulate,
the machine stays in it, and leaves when a reaction changes its sign: rules that are in force only
then stand behind the machine's own.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

from hybond.model.expressions import Compare, Name, Number
from hybond.model.graph import FlatGraph, Machine, Rule
from hybond.modes.landing.contacts import Contact, contact_of

if TYPE_CHECKING:
    from hybond.engine.tables.make import ModelTables


@dataclass(frozen=True, slots=True)
class Forced:
    """A rule with the sign of the reaction at which it is in force; 0: it always is.

    Parameters
    ----------
    rule : Rule
    sign : int
    reaction : int
        Among all reactions; -1 without.
    """

    rule: Rule
    sign: int
    reaction: int


def contacts_of(graph: FlatGraph) -> dict[tuple[int, int], Contact]:
    """Return the contacts by machine and state."""
    found = {}
    for machine in graph.machines:
        for state in range(len(machine.states)):
            contact = contact_of(graph, machine, state)
            if contact is not None:
                found[machine.index, state] = contact
    return found


def rules_of(graph: FlatGraph) -> list[list[Forced]]:
    """Return the rules of each machine, then those by which it leaves where it has landed."""
    first: dict[tuple[int, int], int] = {}
    reactions = 0
    contacts = contacts_of(graph)
    for key, contact in contacts.items():
        first[key] = reactions
        reactions += len(contact.reactions)
    return [
        [
            *(Forced(r, 0, -1) for r in machine.rules),
            *(
                forced
                for (index, state), contact in contacts.items()
                if index == machine.index and machine.law is None
                for forced in _leaving(machine, state, contact, first[index, state])
            ),
        ]
        for machine in graph.machines
    ]


def _leaving(machine: Machine, state: int, contact: Contact, first: int) -> list[Forced]:
    exits = [r for r in machine.rules if r.source == state]
    if not exits:
        return []
    found = []
    for k, reaction in enumerate(contact.reactions):
        for sign, op in ((1, "<"), (-1, ">")):
            name = Name(reaction.name)
            guard = Compare(op, name, Number(0.0))
            text = f"{reaction.text} {op} 0"
            rule = Rule(state, exits[0].target, guard, text, ((reaction.text, name),))
            found.append(Forced(rule, sign, first + k))
    return found


def put_contacts(t: ModelTables) -> None:
    """Put contacts, their reactions, and what must vanish at rest into the tables."""
    g = t.graph
    contacts = contacts_of(g)
    at = cache(lambda machine, state: list(contacts).index((machine, state)))
    t.ints["contact_at"] = [
        at(m.index, k) if (m.index, k) in contacts else -1
        for m in g.machines
        for k in range(len(m.states))
    ]
    t.numbers["contacts"] = len(contacts)
    t.ints["contact_machine"] = [c.machine.index for c in contacts.values()]
    t.ints["contact_state"] = [c.state for c in contacts.values()]
    t.ints["contact_rest"] = [c.rest for c in contacts.values()]
    reactions = [r for c in contacts.values() for r in c.reactions]
    t.numbers["reactions"] = len(reactions)
    first = [0]
    for c in contacts.values():
        first.append(first[-1] + len(c.reactions))
    t.ints["reaction_first"] = first
    bonds = len(g.bonds)

    def column(name: str) -> int:
        kind, _, index = name.partition(":")
        return int(index) + (bonds if kind == "f" else 0)

    t.ints["reaction_column"] = [column(r.name) for r in reactions]
    t.floats["reaction_own"] = [r.own for r in reactions]
    laws, constants = [], []
    for r in reactions:
        law = g.nodes[r.law].law
        assert law is not None
        number, constant = t.values.entry(law.expressions[0])
        laws.append(number)
        constants.append(constant)
    t.ints["reaction_law"] = laws
    t.floats["reaction_law_constant"] = constants
    first, columns, signs = [0], [], []
    for r in reactions:
        for name, sign in r.prescribed:
            columns.append(column(name))
            signs.append(sign)
        first.append(len(columns))
    t.ints["prescribed_first"] = first
    t.ints["prescribed_column"] = columns
    t.floats["prescribed_sign"] = signs
