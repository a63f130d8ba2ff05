"""What to add to a model that is refused: by name, and where."""

from __future__ import annotations

from collections.abc import Iterable

from hybond.causality.assign import assign
from hybond.causality.record import Conflict
from hybond.engine.outcome.closing import against_closing
from hybond.model.expressions import (
    Call,
    Expr,
    Neg,
    Number,
    compile_expression,
    jumping,
    meets,
    simplify,
    turning,
    uses_pre,
)
from hybond.model.expressions.differentiate import differentiate
from hybond.model.expressions.tree import names, walk
from hybond.model.graph import FlatGraph, Mode, Node
from hybond.model.joined import Joined
from hybond.model.kinds import TWO_PORTS

FADES = "instants at which its law jumps come ever faster"
"""How the engine says that (`run/kinks_passed`)."""
TO_REST = (
    "let the run end before that; or give what comes to rest there a friction, or a stop, that "
    "holds it: a junction with law = 'coulomb' or 'unilateral'"
)
MANY = 3
"""Elements that a remedy names at the most."""
PAINLEVE = "friction of a rigid contact may leave none (Painleve): give the contact a stiffness"
BESIDE = (1e-6, 1e-3)
"""Where it is seen whether a law is flat at zero, in SI: ..."""
FLAT = 0.1
"""... it is if it rises to less than this part of what a straight line would."""
STEPS = ("sign", "floor", "ceil", "mod")
"""Functions that jump wherever they are."""


def gives_effort(node: Node) -> bool:
    """Whether an element prescribes an effort: a source, or a law with a flat end."""
    return node.kind == "Se" if node.law is None or node.kind[0] == "S" else node.law.output == "e"


def resistors(nodes: Iterable[Node]) -> str:
    """Return where resistors go that let these elements give what they prescribe; "" for none."""
    parts = [
        ("in series with " if gives_effort(n) else "beside ") + n.path for n in dict.fromkeys(nodes)
    ]
    if len(parts) > MANY:
        parts[MANY - 1 :] = [f"so with {len(parts) - MANY + 1} more"]
    return f"put a resistor {', and one '.join(parts)}" if parts else ""


def of_law_that_jumps(graph: FlatGraph, path: str, why: str) -> str:
    """Return what to try where jumps of a law come ever faster, or one is a limit; "" if neither.

    A limit of dry friction, that is, which jumps as its own direction turns.
    """
    if why.startswith(FADES):
        return TO_REST
    for law in (m.law for m in graph.machines if m.law is not None):
        if law.source is None or graph.nodes[law.source].path != path:
            continue
        own = (simplify(law.common), simplify(Neg(law.common)))
        turns = [a for jump in jumping(law.limit or Number(0.0)) for a in turning(jump)]
        if any(simplify(a) in own for a in turns):
            return (
                "the limit holds as much either way: give it the mean of the two limits, and let a "
                "constant source at the junction have half of their difference; for 10 forward and "
                "3 backward a limit of 6.5, and an Se of -3.5 on a bond towards the junction"
            )
    return ""


def against_conflict(nodes: list[Node], switched: bool) -> str:
    """Return what to try where these elements prescribe one variable, or what holds it at zero.

    Where there are sources the rest is not to blame: laws with a flat end give way beside it.
    """
    sources = [n for n in nodes if n.kind in ("Se", "Sf")]
    flat = [n.path for n in nodes if n.kind not in ("Se", "Sf")]
    hint = resistors(sources or nodes)
    if flat:
        hint += f", or let the law of {' and '.join(flat[:MANY])} rise at its flat end"
    return hint + (", or change what switches it so" if switched else "")


def as_diodes(graph: FlatGraph, conflicts: Iterable[Conflict]) -> str:
    """Return which junctions could have a law in place of rules that are a diode's; "" for none.

    Machines fire on what holds in the mode they are in: where another switch closes, one that
    conducts is told to block by a current that has no value yet. A law answers together with it.
    """
    paths = [path for c in conflicts for path, on in c.switches if on]
    nodes = (graph.nodes[graph.by_path[path]] for path in dict.fromkeys(paths))
    found = [n.path for n in nodes if n.kind == "1" and _is_diode(graph, n)]
    return f", or let law = 'diode' of {' and '.join(found)} stand for its rules" if found else ""


def _is_diode(graph: FlatGraph, node: Node) -> bool:
    """Whether a machine switches this junction alone, by the two rules of an ideal diode."""
    machine = None if node.machine is None else graph.machines[node.machine]
    if machine is None or machine.law is not None or len(machine.rules) != len(machine.on):
        return False
    if sorted(map(sorted, machine.on)) != [[], [node.index]]:
        return False
    name = node.path.rpartition(".")[2]
    rules = {(bool(machine.on[r.source]), "".join(r.text.split())) for r in machine.rules}
    return rules == {(True, f"{name}.f<0"), (False, f"{name}.e>0")}


def against_no_branches(graph: FlatGraph, mode: Mode, laws: Iterable[int]) -> str:
    """Return what to try where junctions with these laws have no branches.

    Where every limit is known before its force is, laws that ask for nothing would all hold: it is
    sources that ask for more. Those in the way of a conflict are named, else all that hang together
    with the junctions. Where a limit follows a force it is inertia and leverage that leave no
    answer, and a resistance has none at that instant either.
    """
    laws = list(laws)
    opposing = resistors(_opposing(graph, mode))
    if _follows_force(graph, laws):
        return f"{PAINLEVE}, or {opposing}" if opposing else PAINLEVE
    hint = opposing or resistors(_sources_at(graph, laws))
    return hint or f"{PAINLEVE}, or a source a resistance"


def without_solution(graph: FlatGraph, elements: list[Node], t: float) -> tuple[str, str]:
    """Return that laws of these elements have no common solution at `t`, s, and what to try."""
    names = ", ".join(n.path for n in elements)
    why = f"the laws of {names} have no common solution that was found (t = {t:.9g} s)"
    return why, against_no_solution(graph, elements)


def against_no_solution(graph: FlatGraph, elements: list[Node]) -> str:
    """Return what to try where laws of these elements have no common solution.

    A law that jumps has no value within its jump; dry friction has. One that ends gives more with a
    resistor added to what it gives. Two-ports of the loop hand on what others give.
    """
    elements = [n for n in elements if n.kind not in TWO_PORTS] or elements
    stepped = [n for n in elements if n.law is not None and any(map(_steps, n.law.expressions))]
    if not stepped:
        hint = (
            f"look whether these laws can give what is asked of them; {resistors(elements)}, "
            "which gives what they cannot"
        )
        closing = against_closing(graph, elements)
        return f"{hint}; {closing}" if closing else hint
    path = " and ".join(n.path for n in stepped[:MANY])
    kinds = sorted({"1" if n.law is not None and n.law.output == "e" else "0" for n in stepped})
    where = " or ".join(f"{k}-junction" for k in kinds)
    others = [n for n in elements if n not in stepped]
    more = f"; {resistors(others)}, if more is asked than they give" if others else ""
    return (
        f"{path} may be asked for a value within a jump: where sign() stands for dry friction, a "
        f"{where} with law = 'coulomb' has these values; else write the steep line, such as "
        f"tanh(){more}"
    )


def beside_flat_laws(graph: FlatGraph) -> str:
    """Return what to add to laws that are flat where what they read is zero; "" without any.

    Where the rest says what such a law gives, what it reads is a root, and steeper than steps can
    follow: a varistor behind a coil.
    """
    found = [
        (n.path, n.law.output if n.kind in ("R", "G") else "f" if n.kind == "Sf" else "e")
        for n in graph.nodes
        if n.law is not None and is_flat(n)
    ]
    if not found:
        return ""
    beside = [
        f"a capacitance or a resistance across {path}"
        if output == "f"
        else f"an inertia or a resistance in series with {path}"
        for path, output in found[:MANY]
    ]
    return (
        f"; {' and '.join(path for path, _ in found[:MANY])} is flat where what it reads is zero, "
        f"and as steep as a jump where it is read backwards: add what it has beside it in reality, "
        f"{', '.join(beside)}"
    )


def beside_folds(graph: FlatGraph) -> str:
    """Return where the state that a source binds may have nowhere to go on; "" without such ones.

    A source right onto a storage binds what it stores. If it reads that itself, by a law that
    bends, it may come to give as much more of it as the storage does: solutions end there.
    """
    found = [
        n.path
        for n in graph.nodes
        if _binds(graph, n) and n.law is not None and any(map(_bends, n.law.expressions))
    ]
    if not found:
        return ""
    paths = " or ".join(found[:MANY])
    return (
        f"; where what {paths} gives rises as fast as that of the storage it is bound to, no "
        "solution goes on: put a resistance between them"
    )


def _binds(graph: FlatGraph, node: Node) -> bool:
    """Whether a source gives what a storage beside it has: an effort at a C, a flow at an I."""
    if node.kind not in ("Se", "Sf"):
        return False
    common, storage = ("0", "C") if node.kind == "Se" else ("1", "I")
    for end in node.ends:
        bond = graph.bonds[end.bond]
        other = graph.nodes[bond.tail if bond.head == node.index else bond.head]
        beside = [other]
        if other.kind == common:
            ends = (graph.bonds[e.bond] for e in other.ends)
            beside += [graph.nodes[k] for b in ends for k in (b.tail, b.head)]
        if any(n.kind == storage for n in beside):
            return True
    return False


def _bends(law: Expr) -> bool:
    """Whether a law is no straight line of the stored quantities and bond variables that it reads.

    What jumps is none of these: it has remedies of its own.
    """
    read = [name for name in names(law) if name.startswith(("e:", "f:", "x:"))]
    if uses_pre(law) or not read:
        return False
    return any(names(simplify(differentiate(law, a))) & set(read) for a in read)


def is_flat(node: Node) -> bool:
    """Whether a law gives next to nothing beside where what it reads is zero, by two values.

    ``sign(e)*abs(e)^5`` does not jump there, though it has a sign in it. Sources of netlists may
    read a difference of variables.
    """
    if node.kind not in ("R", "G", "Se", "Sf") or node.law is None:
        return False
    law = node.law.expressions[0]
    read = sorted(names(law))
    if len(node.law.expressions) > 1 or not read or uses_pre(law):
        return False
    if not all(name.startswith(("law:e", "law:f", "e:", "f:")) for name in read):
        return False
    at = compile_expression(law, {name: k for k, name in enumerate(read)}, pre_offset=0)
    rest = [0.0] * (len(read) - 1)
    try:
        none, near, far = (abs(float(at([x, *rest]))) for x in (0.0, *BESIDE))
    except (ArithmeticError, ValueError):
        return False
    return none == 0.0 and near < FLAT * BESIDE[0] / BESIDE[1] * far


def _steps(e: Expr) -> bool:
    """Whether an expression jumps where a function in it does; ``sign(q)*abs(q)^2`` does not."""
    for part, _ in walk(e):
        if isinstance(part, Call) and part.function in STEPS:
            if part.function != "sign" or not meets(e, simplify(part.args[0])):
                return True
    return False


def _opposing(graph: FlatGraph, mode: Mode) -> list[Node]:
    """Return the sources at the ends of what disagrees in a mode."""
    found: dict[int, Node] = {}
    for conflict in assign(graph, mode).conflicts:
        for origin in (conflict.origin_a, conflict.origin_b):
            node = graph.nodes[origin.node]
            if node.kind in ("Se", "Sf") and not node.implied:
                found[node.index] = node
    return [found[k] for k in sorted(found)]


def _sources_at(graph: FlatGraph, ports: Iterable[int]) -> list[Node]:
    """Return the sources that hang together with some nodes by bonds."""
    joined = Joined(range(len(graph.nodes)))
    for bond in graph.bonds:
        joined.join((bond.tail, bond.head))
    roots = {joined.root(k) for k in ports}
    return [
        n
        for n in graph.nodes
        if n.kind in ("Se", "Sf") and not n.implied and joined.root(n.index) in roots
    ]


def _follows_force(graph: FlatGraph, nodes: list[int]) -> bool:
    """Whether friction at one of these junctions has a limit that the laws may change at once."""
    for machine in graph.machines:
        for law in machine.law.junctions if machine.law is not None else ():
            for limit in (law.limit, law.breakaway) if law.node in nodes else ():
                if limit is not None and any(n.startswith(("e:", "f:")) for n in names(limit)):
                    return True
    return False
