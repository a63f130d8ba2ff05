"""Tables of the parts that elements play: rows, sources, and laws that are evaluated."""

from __future__ import annotations

import itertools
from typing import Any

from hybond.engine.mode.nonlinear.one_root import HANGS
from hybond.engine.tables.columns import FLOATS, INTS, ModelTables, put_rows
from hybond.engine.tables.forms import put_forms
from hybond.engine.tables.timestepping import put_steps
from hybond.equations.calculus import bent, gradient, partial_time, reads_bonds
from hybond.equations.element_parts import Dynamic, Part, Source
from hybond.equations.isolated import isolated
from hybond.equations.multiples import Multiple, multiples
from hybond.equations.one_sign import one_sign
from hybond.equations.rounding import rounding, rounding_of_law
from hybond.equations.surfaces import moves
from hybond.model.expressions import (
    Binary,
    Call,
    Expr,
    If,
    Name,
    Number,
    Table,
    differentiate,
    jumping,
    meets,
    names,
    posterior_names,
    simplify,
    substitute,
    turning,
    uses_pre,
)
from hybond.model.expressions.rounded_roots import magnitude
from hybond.model.expressions.tree import walk
from hybond.model.kinds import SOURCES


def put_parts(t: ModelTables, found: list[Part]) -> None:
    """Put parts of elements into the tables, and the sources and laws that they have."""
    dynamics: list[Dynamic] = []
    sources: list[Source] = []
    rows: list[list[tuple[int, float]]] = []
    power, laws, dynamic, source = [], [], [], []
    for part in found:
        power.append(len(rows))
        rows += [sorted(r.items()) for r in part.power]
        laws.append(len(rows))
        rows += [sorted(r.items()) for r in part.laws]
        dynamic.append(len(dynamics))
        dynamics += part.dynamic
        source.append(-1 if part.source is None else len(sources))
        if part.source is not None:
            sources.append(part.source)
    t.ints.update(
        part_power=[*power, len(rows)],
        part_law=laws,
        part_dynamic=[*dynamic, len(dynamics)],
        part_source=source,
    )
    put_rows(t, "row_first", rows, row_column=INTS, row_value=FLOATS)
    _dynamics(t, dynamics)
    g = t.graph
    entries = [t.values.entry(s.value, f"value of {g.nodes[s.node].path}") for s in sources]
    t.numbers["sources"] = len(sources)
    t.ints["source_node"] = [s.node for s in sources]
    t.ints["source_bond"] = [s.bond for s in sources]
    t.ints["source_value"] = [k for k, _ in entries]
    t.floats["source_constant"] = [a for _, a in entries]
    t.ints["source_rate"] = [
        -1 if s.rate == Number(0.0) else t.values.number(s.rate, f"{g.nodes[s.node].path}, rate")
        for s in sources
    ]
    slopes = [gradient(s.rate) for s in sources]
    t.ints["source_linear"] = [int(not reads_bonds(s.rate)) for s in sources]
    t.ints["source_curved"] = [int(any(reads_bonds(e) for e in d.values())) for d in slopes]
    t.ints["source_bent"] = [int(_bends(s.value)) for s in sources]
    t.ints["source_size"] = [_rounded(t, s.value) for s in sources]
    t.ints["source_timed"] = [int(_of_time(s.value)) for s in sources]
    put_rows(t, "look_first", [_bonds_read(t, s.value) for s in sources], look_bond=INTS)
    put_rows(
        t,
        "source_first",
        [_slopes(t, d) for d in slopes],
        source_column=INTS,
        source_slope=INTS,
        source_slope_constant=FLOATS,
    )
    put_forms(t, sources, dynamics)
    put_steps(t, dynamics)


def _bends(e: Expr) -> bool:
    """Whether a value is no linear function of what is stored and of bond variables."""

    def moves(part: Expr) -> bool:
        return any(n.startswith(("x:", "s:", "e:", "f:")) for n in posterior_names(part))

    slopes = (differentiate(e, n) for n in sorted(posterior_names(e)) if moves(Name(n)))
    return any(moves(part) for part in (*turning(e), *slopes))


def _rounded(t: ModelTables, e: Expr) -> int:
    """Return what a value is measured by where it is zero: the terms that it is a difference of.

    A sine of a great angle is known to rounding of the angle.
    """
    if uses_pre(e):
        return -1
    if turning(e):
        return t.values.number(magnitude(e))
    differs = any(isinstance(part, Binary) and part.op in "+-" for part, _ in walk(e))
    return t.values.number(rounding(e)) if _bends(e) or (differs and moves(e)) else -1


def _of_time(e: Expr) -> bool:
    return not uses_pre(e) and all(n == "time" or n.startswith("u:") for n in names(e))


def _follows(e: Expr) -> bool:
    return any(name.partition(":")[0] in ("e", "f", "x") for name in posterior_names(e))


def _bonds_read(t: ModelTables, e: Expr) -> list[tuple[int]]:
    """Return the bonds whose variables a value reads, those of what is stored among them."""
    found = set()
    for kind, _, index in (name.partition(":") for name in names(e)):
        if kind in ("e", "f"):
            found.add(int(index))
        elif kind == "x":
            found.add(t.graph.storages[int(index)].bond)
    return [(bond,) for bond in sorted(found)]


def _variables_read(t: ModelTables, d: Dynamic) -> list[tuple[int]]:
    """Return the bond variables that a row reads, those inside of signs and conditions too."""
    first = t.slots.w.start
    read = {name for name in names(d.expression) if name.partition(":")[0] in ("e", "f")}
    return sorted((t.slots.index[name] - first,) for name in read | set(d.slopes))


def _slopes(t: ModelTables, slopes: Any) -> list[tuple[int, int, float]]:
    """Return derivatives by bond variables as entries: column, expression, constant."""
    first = t.slots.w.start
    return [(t.slots.index[n] - first, *t.values.entry(e)) for n, e in slopes.items()]


def _bent(d: Dynamic) -> bool:
    """Whether slopes of a row read bond variables."""
    return bent(d.expression) or any(reads_bonds(e) for e in d.slopes.values())


def _turns_on_dust(d: Dynamic) -> int:
    """Return 1 for a law that jumps where what it reads is zero, 2 for one that bends or is flat.

    Rounding of what it reads is then a whole jump, or the root of itself in what is solved for.
    """
    if d.partner is None or not _bent(d):
        return 0
    read = d.partner[0]
    if any(read in names(a) for a in jumping(d.expression)):
        return 2 if meets(d.expression, Name(read)) else 1
    return 2 if is_flat_at_zero(d.expression, read) else 0


def _breaks(d: Dynamic) -> bool:
    """Whether a law may jump: at a number that it reads, or as that comes through zero."""
    read = "" if d.partner is None else d.partner[0]
    jumps = [a for a in jumping(d.expression) if reads_bonds(a)]
    return any(names(a) != {read} or not meets(d.expression, Name(read)) for a in jumps)


def is_flat_at_zero(law: Expr, read: str) -> bool:
    """Whether a law gives nothing more, to first order, beside where what it reads is zero."""
    slope = substitute(differentiate(law, read), {read: Number(0.0)})
    return simplify(slope) == Number(0.0)


def is_flat_on_a_stretch(slope: Expr) -> bool:
    """Whether a slope, as far as it is seen from its parts, is zero on one side of a corner."""
    for part, _ in walk(slope):
        if isinstance(part, If) and Number(0.0) in (part.then, part.orelse):
            return True
        if isinstance(part, Call) and part.function == "sign":
            return True
        if isinstance(part, Table) and part.slope:
            return any(a == b for a, b in itertools.pairwise(part.y))
    return False


def _multiples(t: ModelTables, rows: list[Dynamic]) -> None:
    """Put which slopes of a row are multiples of one that stands before them, and by how much."""
    like: list[int] = []
    found: list[Multiple] = []
    for d in rows:
        own = [e for _, e in sorted(d.slopes.items(), key=lambda item: t.slots.index[item[0]])]
        begin = len(found)
        found += multiples(own)
        like += [begin + part.like for part in found[begin:]]
    t.ints["slope_like"] = like
    t.ints["slope_like_sign"] = [part.sign for part in found]
    t.floats["slope_times"] = [part.times for part in found]
    t.floats["slope_beside"] = [part.beside for part in found]


def _dynamics(t: ModelTables, rows: list[Dynamic]) -> None:
    g = t.graph
    first = t.slots.w.start
    t.numbers["dynamics"] = len(rows)
    t.ints["dynamic_kind"] = [0 if d.kind == "structure" else 1 for d in rows]
    t.ints["dynamic_node"] = [d.node for d in rows]
    t.ints["dynamic_source"] = [int(g.nodes[d.node].kind in SOURCES) for d in rows]
    t.ints["dynamic_impulsive"] = [
        int(g.nodes[d.node].impulsive and not g.nodes[d.node].implied) for d in rows
    ]
    t.ints["dynamic_value"] = [
        t.values.number(d.expression, f"law of {g.nodes[d.node].path}, zero") for d in rows
    ]
    t.ints["dynamic_follows"] = [
        int(
            d.kind == "structure"
            and g.nodes[d.node].kind not in SOURCES
            and any(_follows(e) for e in d.frozen.values())
        )
        for d in rows
    ]
    t.ints["dynamic_affine"] = [int(not _bent(d)) for d in rows]
    t.ints["dynamic_jumps"] = [_turns_on_dust(d) for d in rows]
    t.ints["dynamic_breaks"] = [int(_breaks(d)) for d in rows]
    t.ints["dynamic_rounding"] = [
        t.values.number(rounding_of_law(d.expression), f"law of {g.nodes[d.node].path}, its terms")
        for d in rows
    ]
    partners = [d.partner for d in rows]
    t.ints["dynamic_partner"] = [-1 if p is None else t.slots.index[p[0]] - first for p in partners]
    t.floats["dynamic_way"] = [0.0 if p is None else p[1] for p in partners]
    free = [[(t.slots.index[n] - first,) for n in d.impulse_free] for d in rows]
    put_rows(t, "dynamic_free", free, free_column=INTS)
    put_rows(t, "law_reads", [_variables_read(t, d) for d in rows], law_column=INTS)
    for name in ("slope", "frozen"):
        own = [sorted(_slopes(t, d.slopes if name == "slope" else d.frozen)) for d in rows]
        columns: dict[str, list[Any]] = {
            f"{name}_column": INTS,
            f"{name}_value": INTS,
            f"{name}_constant": FLOATS,
        }
        put_rows(t, f"{name}_first", own, **columns)
    t.ints["slope_flat"] = [
        int(d.partner is not None and is_flat_on_a_stretch(e))
        for d in rows
        for _, e in sorted(d.slopes.items(), key=lambda item: t.slots.index[item[0]])
    ]
    t.ints["slope_sign"] = [
        one_sign(e) or (0 if d.partner is not None and names(e) == {d.partner[0]} else HANGS)
        for d in rows
        for _, e in sorted(d.slopes.items(), key=lambda item: t.slots.index[item[0]])
    ]
    _multiples(t, rows)
    t.numbers["curved"] = t.ints["dynamic_affine"].count(0)
    t.numbers["flats"] = sum(t.ints["slope_flat"])
    t.ints["slope_isolated"] = [
        int(names(e) == {name} and isolated(e))
        for d in rows
        for name, e in sorted(d.slopes.items(), key=lambda item: t.slots.index[item[0]])
    ]
    t.ints["frozen_isolated"] = [
        int(g.nodes[d.node].kind in SOURCES and reads_bonds(e) and isolated(e))
        for d in rows
        for _, e in sorted(d.frozen.items(), key=lambda item: t.slots.index[item[0]])
    ]
    drifts = [partial_time(d.expression, g) if d.kind == "structure" else Number(0.0) for d in rows]
    t.ints["drift_value"] = [-1 if e == Number(0.0) else t.values.number(e) for e in drifts]
    put_rows(
        t,
        "drift_first",
        [_slopes(t, gradient(e)) for e in drifts],
        drift_column=INTS,
        drift_slope=INTS,
        drift_constant=FLOATS,
    )
