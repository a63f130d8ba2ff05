"""Tables of contacts that may come to rest: the columns `contact_*` and `reaction_*` of the model.

A state of a machine that closes a contact by an impact law is a contact. The law is a source; what
it prescribes must vanish for the contact to rest, and the conjugate variable is the reaction, which
the contact then carries. Once impacts accumulate, the machine stays in it, and leaves when a
reaction changes its sign: rules that are in force only then stand behind the machine's own.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from typing import TYPE_CHECKING

from hybond.equations.surfaces import moves
from hybond.model.expressions import (
    Binary,
    Compare,
    Expr,
    Name,
    Number,
    Pre,
    differentiate,
    names,
    posterior_names,
    prior_names,
    simplify,
    transform,
)
from hybond.model.fieldless import reads_pre
from hybond.model.graph import FlatGraph, Machine, Node, Rule
from hybond.records import dataclass

if TYPE_CHECKING:
    from hybond.engine.tables.columns import ModelTables


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


def limit_at_rest(graph: FlatGraph, node: Node) -> Expr:
    """Return what the one variable that an impact law reads comes to where impacts end.

    There the law prescribes what it reads: ``u - eps*(pre(v.f) - u)`` reads `u`, the speed of the
    table that a ball comes to rest on. Zero of laws that read something else, or what moves.
    """
    zero = Number(0.0)
    assert node.law is not None
    law = node.law.expressions[0]
    reaction = _reaction(graph, node)
    read = sorted(prior_names(law))
    if reaction is None or len(read) != 1 or len(reaction.prescribed) != 1:
        return zero
    if any(moves(Name(n)) for n in posterior_names(law)):
        return zero
    ((prescribed, sign),) = reaction.prescribed
    if not _is_common(graph, read[0], prescribed):
        return zero
    here = Name(read[0])
    plain = transform(law, lambda n: n.arg if isinstance(n, Pre) else n)
    slope = differentiate(plain, read[0])
    if read[0] in names(slope) or moves(slope):
        return zero
    begin = simplify(transform(plain, lambda n: zero if n == here else n))
    if begin == zero:
        return zero
    way = Number(-reaction.own / sign)
    left = Binary("-", Number(1.0), Binary("*", way, slope))
    return simplify(Binary("/", Binary("*", way, begin), left))


def _is_common(graph: FlatGraph, one: str, other: str) -> bool:
    """Whether two variables of bonds are the same at a junction that both bonds are at."""
    (kind, _, first), (same, _, second) = one.partition(":"), other.partition(":")
    if kind != same or kind not in ("e", "f"):
        return False
    of = "0" if kind == "e" else "1"
    ends = [{b.tail, b.head} for b in (graph.bonds[int(first)], graph.bonds[int(second)])]
    return one == other or any(graph.nodes[k].kind == of for k in ends[0] & ends[1])


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
    priors = [n.index for n in g.nodes if reads_pre(n)]
    t.ints["reaction_prior"] = [priors.index(r.law) if r.law in priors else -1 for r in reactions]
    first, columns, signs = [0], [], []
    for r in reactions:
        for name, sign in r.prescribed:
            columns.append(column(name))
            signs.append(sign)
        first.append(len(columns))
    t.ints["prescribed_first"] = first
    t.ints["prescribed_column"] = columns
    t.floats["prescribed_sign"] = signs
