"""Tables of kinks: what changes its sign where a law, a source or the rate of a signal has one.

Comparisons, `abs`, `sign`, `min`, `max`, whole numbers and corners of tables. A method of high
order ends its step there; those with steps of their own do so for sources alone, which may jump
onto what is stored.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from hybond.engine.inputs.calls import CALLED, FREE
from hybond.engine.tables.columns import INTS, put_rows
from hybond.engine.tables.options import METHODS
from hybond.engine.tables.parts import is_flat_at_zero
from hybond.engine.tables.turning_points import put_turning_points
from hybond.equations.surfaces import moves, surfaces_of
from hybond.model.expressions import (
    Binary,
    Call,
    Expr,
    Name,
    Neg,
    Number,
    differentiate,
    ending,
    jumping,
    meets,
    names,
    rooted,
    simplify,
    turning,
    uses_pre,
)
from hybond.model.expressions.kinks import clipped, leaping
from hybond.model.expressions.level_sides import joins
from hybond.model.expressions.rounded_roots import cleared, magnitude
from hybond.model.expressions.slots import plain
from hybond.model.graph import FlatGraph
from hybond.options import QUANTISED

if TYPE_CHECKING:
    from hybond.engine.tables.columns import ModelTables

FOLLOWED = tuple(METHODS[name] for name in ("rk45", "radau", "exact", "auto", *QUANTISED))
"""Methods that end a step at a kink."""
MOST = 64
"""Most kinks of one expression; a longer table is a curve."""


def put_kinks(t: ModelTables) -> None:
    """Put what is watched for kinks behind the comparisons of guards."""
    found: dict[Expr, int] = {}
    switches: dict[Expr, set[int]] = {}
    said: dict[Expr, list[Expr]] = {}
    heard = _heard(t)
    for e, node in _followed(t):
        turns = [a for a in turning(e) if moves(a) and not uses_pre(a) and not _is_led_on(t, a)]
        for a in turns if len(turns) <= MOST else []:
            found.setdefault(a, node)
            said.setdefault(a, []).append(e)
            switches.setdefault(a, set()).add(_switch_of(t.graph, node, heard))
    left = _left_at(t)
    for a, node in left:
        found.setdefault(a, node)
        switches.setdefault(a, set()).add(-1)
    flat = _flat_at_zero(t)
    for read, _, node in flat:
        if simplify(Neg(read)) not in found:
            found.setdefault(read, node)
            switches.setdefault(read, set()).add(_switch_of(t.graph, node, heard))
    more = _put_surface_jumps(t, found)
    t.numbers["kinks"] = len(found)
    t.ints["jumping_gap"] = sorted({list(found).index(a) for a, _ in left})
    t.numbers["jumping_gaps"] = len(t.ints["jumping_gap"])
    led_on = [abs(at) for m in t.graph.machines for at in m.led_on]
    t.numbers["bends"] = min(led_on, default=0.0)
    watched = [*found, *more]
    compared = list(t.ints["atom_value"])
    put_turning_points(t, watched)
    t.numbers["kink_atom"] = len(t.ints["atom_value"])
    t.ints["kink_node"] = list(found.values())
    t.ints["kink_switch"] = [min(s) if len(s) == 1 else -1 for s in switches.values()]
    roots = {a for e, _ in _followed(t) for a in rooted(e)}
    rests = {simplify(b): a for a in roots for b in (a, Neg(a))}
    smooth = {a for read, given, _ in flat if given is None for a in (read, simplify(Neg(read)))}
    for read, given, _ in flat:
        if given is not None:
            rests.setdefault(read, given)
            rests.setdefault(simplify(Neg(read)), given)
    at_rest = [rests.get(simplify(a)) for a in found]
    sides = _sides_of_roots(t)
    t.ints["kink_rest"] = [
        -1 if a is None else t.values.number(a)
        for a in (
            sides.get(simplify(k)) if a is None else a for k, a in zip(found, at_rest, strict=True)
        )
    ]
    t.numbers["rests_apart"] = sum(
        k >= 0 and not set(names(t.values.all[k])) <= set(names(a))
        for k, a in zip(t.ints["kink_rest"], found, strict=True)
    )
    t.ints["kink_meets"] = [
        int(
            all(meets(e, simplify(a)) for e in said.get(a, ()))
            if rest is not None or simplify(a) in smooth
            else simplify(a) in sides and all(joins(e, a) for e in said.get(a, ()))
        )
        for a, rest in zip(found, at_rest, strict=True)
    ]
    t.ints["kink_rooted"] = [
        int(_unscaled(a) in rests and all(meets(e, _unscaled(a)) for e in said.get(a, ())))
        for a in found
    ]
    for name, nothing in (("node", -1), ("rest", -1), ("meets", 0), ("rooted", 0)):
        t.ints[f"kink_{name}"] += [nothing] * len(more)
    t.ints["kink_pair"] = [len(t.pairs) + k for k in range(len(watched))]
    t.pairs += watched
    t.ints["atom_value"] += [t.values.number(a) for a in watched]
    t.ints["atom_size"] += [t.values.number(_terms(a)) for a in watched]
    t.ints["atom_zero"] += [1] * len(watched)
    jumps = dict.fromkeys(a for e, _ in _followed(t) for a in jumping(e) if _is_timed(t, a))
    t.numbers["timed_laws"] = len(jumps)
    decided = (a for e in _decided_by(t, compared) for a in jumping(e) if _is_timed(t, a))
    jumps |= dict.fromkeys(decided)
    t.ints["timed_jump"] = [t.values.number(a) for a in jumps]
    t.numbers["timed_jumps"] = len(jumps)
    edges = dict.fromkeys(
        a for e, _ in _asked(t) for a in ending(e) if moves(a) and not uses_pre(a)
    )
    t.numbers["edges"] = len(edges)
    rest = [a for a in at_rest if a is not None]
    ordered = [a for e, _ in _followed(t) for a in rooted(e)]
    levels = [a for a in (*edges, *ordered, *rest) if moves(a) and not uses_pre(a)]
    begins = dict.fromkeys((*edges, *levels))
    written = {*edges, *(a for a in ordered if moves(a) and not uses_pre(a))}
    t.numbers["rooted"] = len(written)
    t.numbers["begins"] = len(begins)
    rows = (*map(cleared, begins), *map(_unclamped, begins))
    t.ints["edge_value"] = [t.values.number(a) for a in rows]
    met = {_unscaled(a) for a, k in zip(found, t.ints["kink_meets"], strict=False) if k}
    decide = {_unscaled(a) for a in found}
    t.ints["edge_met"] = [
        1 if _unscaled(a) in met else 2 if _unscaled(a) in decide else 0 for a in begins
    ]
    t.ints["edge_size"] = [t.values.number(magnitude(a)) for a in begins]
    bonds = range(t.slots.w.start, t.slots.w.start + 2 * len(t.graph.bonds))
    places = [t.slots.index[a.path] if isinstance(a, Name) else -1 for a in begins]
    t.ints["begin_bond"] = [k - bonds.start if k in bonds else -1 for k in places]
    seen = sorted({t.slots.index[n] for a in levels for n in names(a)})
    t.ints["edge_bond"] = [k - bonds.start for k in seen if k in bonds]
    t.numbers["edge_bonds"] = len(t.ints["edge_bond"])
    meeting = [simplify(a) for a, k in zip(found, t.ints["kink_meets"], strict=False) if k]
    pairs = [
        (t.slots.index[a.left.path] - bonds.start, t.slots.index[a.right.path] - bonds.start)
        for a in dict.fromkeys(meeting)
        if isinstance(a, Binary) and isinstance(a.left, Name) and isinstance(a.right, Name)
        if t.slots.index[a.left.path] in bonds and t.slots.index[a.right.path] in bonds
    ]
    t.numbers["level_pairs"] = len(pairs)
    t.ints["level_pair"] = [k for pair in pairs for k in pair]


def _unclamped(a: Expr) -> Expr:
    """Return what ``max(0, x)`` is of, which is below zero where that is nothing: a valve is shut.

    Where that is a pressure, or how much one is above another: what bends may be below zero in a
    branch that is not taken.
    """
    match a:
        case Call("max", (Number(0.0), x)) | Call("max", (x, Number(0.0))):
            sides = (x.left, x.right) if isinstance(x, Binary) and x.op == "-" else (x,)
            return x if all(isinstance(side, Name | Number) for side in sides) else a
    return a


def _put_surface_jumps(t: ModelTables, found: dict[Expr, int]) -> list[Expr]:
    """Put at which kinks the function of each surface may jump; return those that no law has.

    What slides there is left behind: the surface is somewhere else from one instant to the next.
    """
    rows = [
        [a for jump in jumping(s.g) for a in turning(jump) if moves(a) and not uses_pre(a)]
        for s in surfaces_of(t.graph)
    ]
    more = [a for a in dict.fromkeys(a for row in rows for a in row) if a not in found]
    place = {a: k for k, a in enumerate((*found, *more))}
    places = [[(place[a],) for a in dict.fromkeys(row)] for row in rows]
    put_rows(t, "surface_jump_first", places, surface_jump=INTS)
    t.numbers["slide_kinks"] = len(more)
    return more


def _left_at(t: ModelTables) -> list[tuple[Expr, int]]:
    """Return where gaps of contacts jump, which a closed one sees at no guard of its own."""
    if t.numbers["method"] == METHODS["moreau-jean"]:
        return []
    return [
        (a, node)
        for k, node in zip(t.ints["port_gap"], t.ints["port_node"], strict=True)
        if k >= 0
        for jump in jumping(t.values.all[k])
        for a in turning(jump)
        if moves(a) and not uses_pre(a)
    ]


def _decided_by(t: ModelTables, compared: list[int]) -> list[Expr]:
    """Return signs of what guards compare, and what gates and gaps of laws are."""
    laws = [k for name in ("port_gap", "port_gate") for k in t.ints[name] if k >= 0]
    signs = [Call("sign", (t.values.all[k],)) for k in compared]
    return [*signs, *(t.values.all[k] for k in laws)]


def _unscaled(a: Expr) -> Expr:
    """Return what is zero where a multiple of it is."""
    match simplify(a):
        case Neg(arg) | Binary("/", arg, Number()) | Binary("*", Number(), arg):
            return _unscaled(arg)
        case Binary("*", arg, Number()):
            return _unscaled(arg)
        case bare:
            return bare


def _is_led_on(t: ModelTables, a: Expr) -> bool:
    """Whether a law only goes on from there in a straight line with the slope that it has."""
    match a:
        case Binary("-", _, Number(at)):
            return any(abs(plain(at)) in map(abs, m.led_on) for m in t.graph.machines)
    return False


def _flat_at_zero(t: ModelTables) -> list[tuple[Expr, Expr | None, int]]:
    """Return what laws read that are flat where it is zero, what they give, and the elements.

    A root the other way round: of ``e = k*f*abs(f)`` the flow is the root of the effort; None where
    that flow is stored, and nobody asks for the root. A law that jumps may hold what is stored.
    What only decides of the sides of another root is none.
    """
    bonds = len(t.graph.bonds)
    stored = _stored(t.graph)
    found: list[tuple[Expr, Expr | None, int]] = []
    if t.numbers["method"] not in FOLLOWED:
        return found
    rows = ("dynamic_value", "dynamic_partner", "dynamic_node")
    for value, partner, node in zip(*(t.ints[name] for name in rows), strict=True):
        if partner < 0:
            continue
        of, given = ("e", "f") if partner < bonds else ("f", "e")
        bond = partner % bonds
        law, read = t.values.all[value], f"{of}:{bond}"
        side = rooted(law) and simplify(differentiate(law, read)) == Number(0.0)
        if read in names(law) and not side and is_flat_at_zero(law, read):
            known = read in stored and meets(law, Name(read))
            root = None if known else Name(f"{given}:{bond}")
            found.append((Name(read), root, node))
    return found


def _stored(graph: FlatGraph) -> set[str]:
    """Return the flows that are those of inertias, and the efforts of capacitances.

    Those of all bonds at a junction with one of them: where it is switched off they are zero.
    """
    found: set[str] = set()
    for storage in graph.storages:
        of, kind = ("e", "0") if storage.kind == "C" else ("f", "1")
        bond = graph.bonds[storage.bond]
        beside = [graph.nodes[k] for k in (bond.tail, bond.head) if graph.nodes[k].kind == kind]
        found.add(f"{of}:{storage.bond}")
        found |= {f"{of}:{end.bond}" for node in beside for end in node.ends}
    return found


def _sides_of_roots(t: ModelTables) -> dict[Expr, Expr]:
    """Return what laws with a root compare, each by its simplest form.

    A valve by ISO 6358 compares two pressures, and takes the root of a sum of their ratio which is
    zero where they are equal: it may come to rest there. Whether it does is seen as it gets there.
    So may a tank whose outlet takes the root of a head that is cut off at the bottom.
    """
    if t.numbers["method"] not in FOLLOWED:
        return {}
    rows = [(*leaping(e), *clipped(e)) for e, _ in _followed(t) if rooted(e)]
    return {simplify(a): a for row in rows for a in row}


def _is_timed(t: ModelTables, jumping: Expr) -> bool:
    """Whether something changes with time alone, or with inputs that are known beforehand."""
    if uses_pre(jumping) or not moves(jumping):
        return False
    kinds = t.ints["input_kind"]
    read = [n for n in names(jumping) if n != "time"]
    return all(n.startswith("u:") and kinds[int(n[2:])] not in (FREE, CALLED) for n in read)


def _terms(turning: Expr) -> Expr:
    """Return what the terms of something that turns add up to; a sine turns between -1 and 1."""
    if isinstance(turning, Call) and turning.function == "sin":
        return Number(1.0)
    return magnitude(turning)


def _followed(t: ModelTables) -> list[tuple[Expr, int]]:
    """Return what is watched for kinks: of methods of low order, sources alone, which may jump."""
    if t.numbers["method"] == METHODS["moreau-jean"]:
        return []
    asked = _asked(t)
    if t.numbers["method"] in FOLLOWED:
        return asked
    return [(e, k) for e, k in asked if k >= 0 and t.graph.nodes[k].kind in ("Se", "Sf")]


def _heard(t: ModelTables) -> dict[str, set[int]]:
    """Return who reads each name: elements, and -1 for rates of signals and what guards compare."""
    heard: dict[str, set[int]] = {}
    guards = ((t.values.all[k], -1) for k in t.ints["atom_value"])
    for e, node in (*_asked(t), *guards):
        for name in names(e):
            heard.setdefault(name, set()).add(node)
    return heard


def _switch_of(graph: FlatGraph, node: int, heard: dict[str, set[int]]) -> int:
    """Return which switch cuts an element with one bond off, as a place among them; -1: none.

    What others read of its bond is there while it is cut off, too: the value of a source, at least.
    """
    if node < 0 or len(graph.nodes[node].ends) != 1:
        return -1
    at = graph.nodes[node].ends[0].bond
    if (heard.get(f"e:{at}", set()) | heard.get(f"f:{at}", set())) - {node}:
        return -1
    bond = graph.bonds[at]
    controlled = [n.index for n in graph.nodes if n.controlled]
    for place in (node, bond.tail, bond.head):
        if place in controlled:
            return controlled.index(place)
    return -1


def _asked(t: ModelTables) -> list[tuple[Expr, int]]:
    """Return what a step evaluates, and the element that says it; -1 for signals."""
    storages = [t.graph.storages[k].node for k in range(len(t.graph.storages))]
    numbers = [
        *zip(t.ints["dynamic_value"], t.ints["dynamic_node"], strict=True),
        *zip(t.ints["source_value"], t.ints["source_node"], strict=True),
        *zip(t.ints["co_energy"], storages, strict=True),
        *((k, -1) for k in t.ints["integral_rate"]),
    ]
    return [(t.values.all[k], node) for k, node in numbers if k >= 0]
