"""Tables of a model: the columns that `portable.model.Model` names."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import product
from typing import Any

from hybond.engine.tables.calls import put_rated, put_samples, refuse_calls
from hybond.engine.tables.code import check_depths
from hybond.engine.tables.contacts import put_contacts, rules_of
from hybond.engine.tables.expressions import Expressions, number_of
from hybond.engine.tables.forms import put_forms
from hybond.engine.tables.guards import magnitude, seen_in_motion
from hybond.engine.tables.laws import put_laws
from hybond.engine.tables.options import Options, options_of
from hybond.engine.tables.powers import put_powers
from hybond.engine.tables.start import start_of
from hybond.engine.tables.surfaces import put_surfaces
from hybond.engine.tables.timestepping import put_steps
from hybond.engine.tables.told import put_told
from hybond.equations.calculus import bent, gradient, partial_time, reads_bonds
from hybond.equations.element_parts import Dynamic, Part, Parts, Source
from hybond.equations.slots import Slots, slots_of
from hybond.equations.storage import EXACT, gauss, polynomial_degree
from hybond.equations.tableau import stiffness, stored_names
from hybond.errors import ModelError
from hybond.model.expressions import (
    Binary,
    Bool,
    Expr,
    Name,
    Number,
    comparisons,
    names,
    substitute,
    to_text,
    uses_pre,
)
from hybond.model.expressions.traced import Traced, give_up
from hybond.model.expressions.tree import walk
from hybond.model.fieldless import reads_pre, switches_of
from hybond.model.graph import FlatGraph, Machine, Node, Storage
from hybond.model.inputs import Called, Constant, Free, Pwm, Timetable
from hybond.model.interval import discrete_names, interval_after
from hybond.model.kinds import SOURCES, STORAGES
from hybond.model.resolve import affine_in_time, prior

MANY = 1024
"""Ways in which what is constant in a mode may select what one element says."""
_STILL = ("in:", "on:", "at:")
_OPERATORS = {"<": 0, "<=": 1, ">": 2, ">=": 3}
_ZERO_IS = {"<": 1, "<=": -1, ">": -1, ">=": 1}
"""The side of zero on which a difference has the truth that it has at zero."""


@dataclass(slots=True)
class ModelTables:
    """What a model brings along, in no language.

    Parameters
    ----------
    graph : FlatGraph
    slots : Slots
        Where names stand in the vector of values.
    numbers : dict
        Whole numbers and floats of `portable.model.Model`, by field.
    ints, floats : dict
        Its arrays, by field.
    values : Expressions
        What `value(m, k, v)` answers.
    pairs : list of Expr
        What `evaluate_pair(m, k, s)` answers: guards, then rates of integrated signals.
    machines, states, stored, outputs, nodes, bonds, rules : list of str
        Names, by number.
    reasons : list of str
        Why modes are not propagated exactly, by number.
    """

    graph: FlatGraph
    slots: Slots
    numbers: dict[str, float] = field(default_factory=dict)
    ints: dict[str, list[int]] = field(default_factory=dict)
    floats: dict[str, list[float]] = field(default_factory=dict)
    values: Expressions = field(default_factory=Expressions)
    pairs: list[Expr] = field(default_factory=list)
    machines: list[str] = field(default_factory=list)
    states: list[str] = field(default_factory=list)
    stored: list[str] = field(default_factory=list)
    outputs: list[str] = field(default_factory=list)
    nodes: list[str] = field(default_factory=list)
    bonds: list[str] = field(default_factory=list)
    rules: list[str] = field(default_factory=list)
    reasons: list[str] = field(default_factory=list)


def tables_of(
    graph: FlatGraph,
    plain: FlatGraph | None = None,
    *,
    options: Options | None = None,
    calling: bool = False,
    tells: bool = False,
    **given: Any,
) -> ModelTables:
    """Return the tables of a model; `given` are options of the run, by name.

    They are taken from the experiment unless all of them are there, `options`. With `calling` they
    are for a run that can call inputs that are functions in Python, and blocks. With `tells` it
    writes down what explains its events: what guards read, energies.

    If the numbers of the graph know of which parameters they are made, those in the tables do as
    well; `plain` is then the same graph without that, for what is tried out.

    Raises
    ------
    ModelError
        HB-M205 a gap that is not the distance of a contact, HB-E630 an input that is a function in
        Python or a block, without `calling`, HB-E631 an element that says too many things; those of
        `options.options_of`.
    """
    plain = plain or graph
    options = options or options_of(graph, plain, given)
    graph = options.graph
    t = ModelTables(graph, slots_of(graph))
    t.numbers.update(options.numbers)
    _sizes(t)
    _machines(t)
    _elements(t)
    _junctions(t)
    _storages(t, plain)
    put_powers(t)
    if not calling:
        refuse_calls(graph)
    _signals(t)
    _priors(t)
    put_laws(t)
    _check_gaps(plain)
    put_surfaces(t)
    put_contacts(t)
    put_told(t, tells=tells)
    _reads(t)
    _outputs(t, options.outputs)
    put_rated(t)
    check_depths(t.pairs, t.slots.index)
    return t


def _sizes(t: ModelTables) -> None:
    g, s = t.graph, t.slots
    t.numbers.update(
        bonds=len(g.bonds),
        storages=len(g.storages),
        integrals=len(g.integrals),
        inputs=len(g.inputs),
        watches=len(g.watches),
        machines=len(g.machines),
        switches=sum(n.controlled for n in g.nodes),
        nodes=len(g.nodes),
        slots=s.size,
        input_slot=s.u.start,
        input_rate_slot=s.du.start,
        signal_slot=s.s.start,
        stored_slot=s.x.start,
        bond_slot=s.w.start,
        on_slot=s.on.start,
        state_slot=s.states.start,
        at_slot=s.at.start,
        laws=sum(m.law is not None for m in g.machines),
        decided=int(g.indeterminate == "least leakage"),
    )
    t.nodes = [n.path for n in g.nodes]
    t.bonds = [f'"{b.name}".{kind}' for kind in "ef" for b in g.bonds]


def _check_gaps(g: FlatGraph) -> None:
    """Refuse contacts whose gap is not their distance, as a run does at its start: HB-M205."""
    laws = [law for m in g.machines if m.law is not None for law in m.law.junctions]
    if all(law.gap is None for law in laws):
        return
    from hybond.modes.laws.complementarity import Instant
    from hybond.modes.trial import Trials
    from hybond.programs.program import Program
    from hybond.trace import Trace

    program = Program(g)
    y = start_of(g)
    x, s = y[: program.nx], y[program.nx : program.nx + program.ns]
    interval = interval_after(g, 0.0)
    trials = Trials(program, Trace())
    pre = trials.a_priori(0.0, x, s, g.start_mode, interval)
    at = Instant(0.0, s, g.start_mode, interval, pre)
    trials.laws.consistent(at, x, abs(program.storage.energy(x)))


def _first(rows: list[list[Any]]) -> list[int]:
    """Return where each row begins in all of them, and where the last ends."""
    found = [0]
    for row in rows:
        found.append(found[-1] + len(row))
    return found


def _put(t: ModelTables, first: str, rows: list[list[Any]], **columns: list[Any]) -> None:
    """Put rows into the tables: where they begin, and a column for each item of their entries."""
    t.ints[first] = _first(rows)
    for k, name in enumerate(columns):
        flat = [entry[k] for row in rows for entry in row]
        if columns[name] is _FLOATS:
            t.floats[name] = [number_of(a) for a in flat]
        else:
            t.ints[name] = [int(a) for a in flat]


_INTS: list[Any] = []
_FLOATS: list[Any] = [0.0]


def _machines(t: ModelTables) -> None:
    g = t.graph
    switches = [n.index for n in g.nodes if n.controlled]
    place = {index: k for k, index in enumerate(switches)}
    t.machines = [m.path for m in g.machines]
    t.states = [s for m in g.machines for s in m.states]
    t.ints["state_first"] = _first([list(m.states) for m in g.machines])
    t.ints["start"] = [m.start for m in g.machines]
    t.ints["is_law"] = [int(m.law is not None) for m in g.machines]
    on = [[(place[n],) for n in sorted(nodes)] for m in g.machines for nodes in m.on]
    _put(t, "on_first", on, on_switch=_INTS)
    t.ints["switch_node"] = switches
    owners = _owners(g)
    t.ints["switch_machine"] = [owners[k].index for k in switches]
    forced = rules_of(g)
    rules = [[(f.rule.source, f.rule.target, f.sign, f.reaction) for f in own] for own in forced]
    _put(
        t,
        "rule_first",
        rules,
        rule_source=_INTS,
        rule_target=_INTS,
        rule_landed=_INTS,
        rule_reaction=_INTS,
    )
    tests, watched, plain, atoms = [], [], [], []
    for rule in (f.rule for own in forced for f in own):
        t.pairs.append(rule.guard)
        t.rules.append(rule.text)
        test, differences = seen_in_motion(rule)
        signs = [_ZERO_IS.get(c.op, 1) for c in comparisons(rule.guard)]
        plain.append(t.values.number(rule.guard, rule.text))
        tests.append(t.values.number(test, rule.text))
        moves = any(not n.startswith(_STILL) for n in names(rule.guard))
        watched.append(int(moves))
        atoms.append(
            [
                (t.values.number(d), t.values.number(magnitude(d)), sign)
                for d, sign in zip(differences, signs, strict=True)
            ]
            if moves
            else []
        )
    t.ints.update(rule_value=plain, rule_test=tests, rule_watched=watched)
    _put(t, "atom_first", atoms, atom_value=_INTS, atom_size=_INTS, atom_zero=_INTS)


def _owners(g: FlatGraph) -> dict[int, Machine]:
    """Return the machine that switches each controlled node."""
    return {k: m for m in reversed(g.machines) for k in m.controls}


# -- elements


def _elements(t: ModelTables) -> None:
    g = t.graph
    parts = Parts(g)
    owners = _owners(g)
    discrete = discrete_names(g)
    t.numbers["discrete"] = len(discrete)
    t.ints["discrete_kind"] = [1 if n.startswith("at:") else 2 for n in discrete]
    t.ints["discrete_index"] = [int(n.partition(":")[2]) for n in discrete]
    steady: list[Node] = []
    open_: list[Node] = []
    for node in g.nodes:
        if node.is_junction or node.kind in STORAGES:
            continue
        read = _selecting(g, node, discrete)
        (open_ if read or node.controlled else steady).append(node)
    elements = steady + open_
    t.numbers.update(elements=len(elements), steady=len(steady))
    # by what they say: equal numbers may come from parameters that differ
    found: dict[Any, int] = {}
    kept: list[Part] = []
    selects, chosen = [], []
    for node in elements:
        select, variants = _variants(t, parts, node, discrete, owners)
        selects.append(select)
        own = []
        for part in variants:
            said = _said(part)
            if said not in found:
                found[said] = len(kept)
                kept.append(part)
            own.append((found[said],))
        chosen.append(own)
    _put(t, "select_first", selects, select_kind=_INTS, select_index=_INTS, select_many=_INTS)
    _put(t, "element_first", chosen, element_part=_INTS)
    _parts(t, kept)
    per_element = [[kept[k] for (k,) in own] for own in chosen]
    sources = sum(any(p.source is not None for p in own) for own in per_element)
    ports = sum(len(m.law.junctions) for m in g.machines if m.law is not None)
    t.numbers["most_sources"] = sources + ports
    t.numbers["most_dynamic"] = sum(max(len(p.dynamic) for p in own) for own in per_element)


def _said(part: Part) -> tuple[Any, ...]:
    """Return a part as something that can be looked up."""
    rows = [tuple(sorted(row.items())) for row in (*part.power, *part.laws)]
    dynamic = [
        (d.kind, d.node, d.expression, *d.slopes.items(), *d.frozen.items(), *d.impulse_free)
        for d in part.dynamic
    ]
    return len(part.power), tuple(rows), tuple(dynamic), part.source, part.steady


def _selecting(g: FlatGraph, node: Node, discrete: tuple[str, ...]) -> list[str]:
    """Return the names in an element's law that are constant in a configuration."""
    assert node.law is not None
    read: set[str] = set().union(*(names(e) for e in node.law.expressions))
    return sorted(n for n in read if n.startswith(("on:", "in:")) or n in discrete)


def _variants(
    t: ModelTables,
    parts: Parts,
    node: Node,
    discrete: tuple[str, ...],
    owners: Mapping[int, Machine],
) -> tuple[list[tuple[int, int, int]], list[Part]]:
    """Return what selects the part of an element, and its parts in that order."""
    g = t.graph
    read = _selecting(g, node, discrete)
    machines = {int(n.split(":")[1]) for n in read if n.startswith("in:")}
    machines |= {owners[int(n.split(":")[1])].index for n in read if n.startswith("on:")}
    if node.controlled:
        machines.add(owners[node.index].index)
    select = [(0, k, len(g.machines[k].states)) for k in sorted(machines)]
    for name in read:
        if name in discrete:
            kind, _, index = name.partition(":")
            levels = [0.0, 1.0] if kind == "at" else levels_of(g, int(index))
            select.append((1 if kind == "at" else 2, int(index), len(levels)))
    total = 1
    for _, _, many in select:
        total *= many
    if total > MANY:
        raise ModelError(
            f"what {node.kind} {node.path} says depends on {total} combinations of states",
            code="HB-E631",
            where=f"elements.{node.path}",
            hint="let the law read fewer machines, or inputs with fewer levels",
        )
    found = []
    for choice in product(*(range(many) for _, _, many in select)):
        state = {k: c for (kind, k, _), c in zip(select, choice, strict=True) if kind == 0}
        values = _settings(g, read, state, select, choice)
        off = node.controlled and not any(
            node.index in g.machines[k].on[c] for k, c in state.items()
        )
        found.append(parts.of(node, off, values))
    return select, found


def _settings(
    g: FlatGraph,
    read: list[str],
    state: dict[int, int],
    select: list[tuple[int, int, int]],
    choice: tuple[int, ...],
) -> dict[str, Expr]:
    """Return the names that an element reads with their values in one combination."""
    values: dict[str, Expr] = {}
    for name in read:
        kind, _, rest = name.partition(":")
        if kind == "in":
            machine, k = map(int, rest.split(":"))
            values[name] = Bool(state[machine] == k)
        elif kind == "on":
            on = any(int(rest) in g.machines[k].on[c] for k, c in state.items())
            values[name] = Bool(on)
        else:
            code = 1 if kind == "at" else 2
            at = next(i for i, s in enumerate(select) if s[:2] == (code, int(rest)))
            levels = [0.0, 1.0] if kind == "at" else levels_of(g, int(rest))
            values[name] = Number(levels[choice[at]])
    return values


def levels_of(g: FlatGraph, k: int) -> list[float]:
    """Return the levels of an input that is held, in the order of their numbers."""
    waveform = g.inputs[k].waveform
    if isinstance(waveform, Constant):
        return [waveform.level]
    if isinstance(waveform, Pwm):
        return [waveform.high, waveform.low]
    assert isinstance(waveform, Timetable)
    return list(dict.fromkeys(waveform.values))


def _parts(t: ModelTables, found: list[Part]) -> None:
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
    _put(t, "row_first", rows, row_column=_INTS, row_value=_FLOATS)
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
    t.ints["source_timed"] = [int(_of_time(s.value)) for s in sources]
    _put(
        t,
        "source_first",
        [_slopes(t, d) for d in slopes],
        source_column=_INTS,
        source_slope=_INTS,
        source_slope_constant=_FLOATS,
    )
    put_forms(t, sources, dynamics)
    put_steps(t, dynamics)


def _of_time(e: Expr) -> bool:
    return not uses_pre(e) and all(n == "time" or n.startswith("u:") for n in names(e))


def _slopes(t: ModelTables, slopes: Any) -> list[tuple[int, int, float]]:
    """Return derivatives by bond variables as entries: column, expression, constant."""
    first = t.slots.w.start
    return [(t.slots.index[n] - first, *t.values.entry(e)) for n, e in slopes.items()]


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
    t.ints["dynamic_affine"] = [
        int(not (bent(d.expression) or any(reads_bonds(e) for e in d.slopes.values())))
        for d in rows
    ]
    free = [[(t.slots.index[n] - first,) for n in d.impulse_free] for d in rows]
    _put(t, "dynamic_free", free, free_column=_INTS)
    for name in ("slope", "frozen"):
        own = [_slopes(t, d.slopes if name == "slope" else d.frozen) for d in rows]
        columns: dict[str, list[Any]] = {
            f"{name}_column": _INTS,
            f"{name}_value": _INTS,
            f"{name}_constant": _FLOATS,
        }
        _put(t, f"{name}_first", own, **columns)
    drifts = [partial_time(d.expression, g) if d.kind == "structure" else Number(0.0) for d in rows]
    t.ints["drift_value"] = [-1 if e == Number(0.0) else t.values.number(e) for e in drifts]
    _put(
        t,
        "drift_first",
        [_slopes(t, gradient(e)) for e in drifts],
        drift_column=_INTS,
        drift_slope=_INTS,
        drift_constant=_FLOATS,
    )


# -- junctions, storage


def _junctions(t: ModelTables) -> None:
    g = t.graph
    switches = [n.index for n in g.nodes if n.controlled]
    nodes = [n for n in g.nodes if n.is_junction]
    t.numbers["junctions"] = len(nodes)
    t.ints["junction_kind"] = [int(n.kind) for n in nodes]
    t.ints["junction_switch"] = [switches.index(n.index) if n.controlled else -1 for n in nodes]
    t.ints["junction_node"] = [n.index for n in nodes]
    ends = [[(end.bond, end.sign) for end in n.ends] for n in nodes]
    _put(t, "end_first", ends, end_bond=_INTS, end_sign=_INTS)


def _storages(t: ModelTables, plain: FlatGraph) -> None:
    g = t.graph
    start = start_of(plain)
    t.stored = [s.path for s in g.storages] + [i.path for i in g.integrals]
    t.ints["storage_bond"] = [s.bond for s in g.storages]
    t.ints["storage_kind"] = [int(s.kind == "I") for s in g.storages]
    t.ints["storage_sign"] = [s.sign for s in g.storages]
    t.floats["storage_start"] = [
        _stored_at_start(g, s, float(a)) for s, a in zip(g.storages, start)
    ]
    t.ints["storage_pseudo"] = [int(g.bonds[s.bond].domain.pseudo) for s in g.storages]
    domains = list(dict.fromkeys(b.domain.name for b in g.bonds))
    t.numbers["classes"] = 2 * len(domains)
    own = [domains.index(b.domain.name) for b in g.bonds]
    t.ints["bond_class"] = [2 * k for k in own] + [2 * k + 1 for k in own]
    t.ints["storage_class"] = [2 * own[s.bond] + int(s.kind == "C") for s in g.storages]
    laws, rows = [], []
    groups: dict[int, list[int]] = {}
    degrees: dict[int, int | None] = {}
    together: dict[int, list[Storage]] = {}
    for s in g.storages:
        together.setdefault(s.node, []).append(s)
    for s in g.storages:
        node = g.nodes[s.node]
        assert node.law is not None
        siblings = together[s.node]
        slopes = [(o, stiffness(node, s.port, o.port, g, siblings)) for o in siblings]
        rows.append([(o.index, *t.values.entry(e)) for o, e in slopes])
        if node.law.matrix is not None:
            laws.append(-1)
            continue
        law = substitute(node.law.expressions[s.port], stored_names(node, g, siblings))
        laws.append(t.values.number(law, f"law of {node.path}"))
        groups.setdefault(s.node, []).append(s.index)
        degree, before = polynomial_degree(law), degrees.get(s.node, 0)
        degrees[s.node] = None if degree is None or before is None else max(degree, before)
    t.ints["co_energy"] = laws
    _put(t, "stiff_first", rows, stiff_other=_INTS, stiff_value=_INTS, stiff_constant=_FLOATS)
    t.numbers["groups"] = len(groups)
    _put(t, "group_first", [[(k,) for k in own] for own in groups.values()], group_storage=_INTS)
    points = []
    for node_index in groups:
        degree = degrees[node_index]
        exact = degree is not None and degree <= EXACT
        points.append(list(zip(*gauss((degree or 0) // 2 + 1), strict=True)) if exact else [])
    _put(t, "point_first", points, point_at=_FLOATS, point_weight=_FLOATS)


def _stored_at_start(g: FlatGraph, s: Storage, value: float) -> float:
    """Return what is stored at the start, `value`, with what it is made of if it is followed."""
    law = g.nodes[s.node].law
    assert law is not None
    if s.start_is == "stored":
        return number_of(s.start)
    if law.matrix is None or len(law.matrix) > 1:
        constants = [n.value for e in law.expressions for n, _ in walk(e) if isinstance(n, Number)]
        own = [o.start for o in g.storages if o.node == s.node]
        give_up((*own, *constants), "a start that is found by iteration")
        return value
    stored = s.start / law.matrix[0][0]
    # the quotient may differ from what the solution of a linear system is by a rounding
    return Traced(value, stored.tree, stored.trail) if isinstance(stored, Traced) else value


# -- signals, inputs, time


def _signals(t: ModelTables) -> None:
    g = t.graph
    t.pairs += [i.rate for i in g.integrals]
    t.ints["integral_rate"] = [t.values.number(i.rate, f"{i.path}'") for i in g.integrals]
    t.floats["integral_start"] = [number_of(i.start) for i in g.integrals]
    put_samples(t)
    kinds, rows, levels = [], [], []
    for i in g.inputs:
        w = i.waveform
        own: list[tuple[int]] = []
        if isinstance(w, Free):
            kinds.append(4)
            rows.append([(w.level,)])
        elif isinstance(w, Constant):
            kinds.append(0)
            rows.append([(w.level,)])
        elif isinstance(w, Pwm):
            kinds.append(3)
            rows.append([(a,) for a in (w.period, w.duty, w.high, w.low, w.phase)])
        elif isinstance(w, Timetable):
            kinds.append(2 if w.linear else 1)
            rows.append([(a,) for a in (*w.times, *w.values)])
            if not w.linear:
                place = {a: k for k, a in enumerate(levels_of(g, i.index))}
                own = [(place[a],) for a in (w.values[0], *w.values)]
        else:
            assert isinstance(w, Called)
            kinds.append(5)
            rows.append([(a,) for a in w.breaks])
        levels.append(own)
    t.ints["input_kind"] = kinds
    _put(t, "input_first", rows, input_number=_FLOATS)
    tables = [i.waveform if isinstance(i.waveform, Timetable) else None for i in g.inputs]
    t.floats["input_period"] = [0.0 if w is None else w.period for w in tables]
    _put(t, "level_first", levels, level_of=_INTS)
    lines = [
        affine_in_time(Binary("-", w.compare.left, w.compare.right)) or (0.0, 0.0)
        for w in g.watches
    ]
    t.floats["watch_slope"] = [a for a, _ in lines]
    t.floats["watch_offset"] = [b for _, b in lines]
    t.ints["watch_operator"] = [_OPERATORS[w.compare.op] for w in g.watches]
    t.floats["watch_time"] = [w.times[0] for w in g.watches]


def _priors(t: ModelTables) -> None:
    g = t.graph
    switches = [n.index for n in g.nodes if n.controlled]
    nodes = [n for n in g.nodes if reads_pre(n)]
    by_source = {m.law.source: m for m in reversed(g.machines) if m.law}
    acting, machine, state, read = [], [], [], []
    for node in nodes:
        acting.append([(switches.index(s.index),) for s in switches_of(g, node)])
        owner = by_source.get(node.index)
        machine.append(owner.index if owner is not None and node.implied else -1)
        state.append(owner.states.index("impact") if owner and "impact" in owner.states else -1)
        assert node.law is not None
        slots = {t.slots.index[n] for e in node.law.expressions for a in prior(e) for n in names(a)}
        read.append([(k,) for k in sorted(slots)])
    t.numbers["priors"] = len(nodes)
    _put(t, "prior_first", acting, prior_switch=_INTS)
    t.ints["prior_machine"] = machine
    t.ints["prior_state"] = state
    _put(t, "prior_read", read, prior_slot=_INTS)


def _reads(t: ModelTables) -> None:
    """Put what each pair reads, a guard in the forms that it has while time passes too."""
    forms = [[e] for e in t.pairs]
    first = t.ints["atom_first"]
    for k, test in enumerate(t.ints["rule_test"]):
        own = slice(first[k], first[k + 1])
        numbers = [test, *t.ints["atom_value"][own], *t.ints["atom_size"][own]]
        forms[k] += [t.values.all[n] for n in numbers]
    first = t.ints["rest_atom"]
    for r, (k, test) in enumerate(zip(t.ints["rest_pair"], t.ints["rest_test"], strict=True)):
        own = slice(first[r], first[r + 1])
        numbers = [test, *t.ints["atom_value"][own], *t.ints["atom_size"][own]]
        if k >= 0:
            forms[k] += [t.values.all[n] for n in numbers]
    read = [{t.slots.index[n] for e in own for n in names(e)} for own in forms]
    _put(t, "read_first", [[(k,) for k in sorted(own)] for own in read], read_slot=_INTS)


def _outputs(t: ModelTables, outputs: list[tuple[str, Expr]]) -> None:
    t.outputs = [name for name, _ in outputs]
    t.numbers["outputs"] = len(outputs)
    t.ints["output_value"] = [t.values.number(e, name) for name, e in outputs]


def text_of(e: Expr, slots: Slots) -> str:
    """Return an expression in canonical names, for a comment."""
    return to_text(e) if not isinstance(e, Name) else e.path
