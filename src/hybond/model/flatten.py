"""Flattening: a `Model` with submodels, names and units becomes a `FlatGraph`.

The order is the order of this file: open submodels, find what is switched, wire bonds to ports,
give bonds domains, read laws, signals and inputs, then machines, then check what only the whole
can show (fieldless states).
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise

from hybond.errors import ModelError, UnitError
from hybond.model import fieldless
from hybond.model.builder import Model
from hybond.model.expressions import (
    Binary,
    Compare,
    Expr,
    Name,
    Number,
    Pre,
    children,
    parse,
)
from hybond.model.expressions.traced import Trail
from hybond.model.graph import (
    Bond,
    FlatGraph,
    Integral,
    Machine,
    Node,
    Rule,
    Storage,
)
from hybond.model.hierarchy import Opened, Scope, constant, literal, open_model
from hybond.model.inputs import Called, Constant, Input, Pwm, Timetable, Waveform
from hybond.model.junction_laws import (
    check_readers,
    check_units,
    law_of_junction,
    law_warnings,
    open_laws,
)
from hybond.model.kinds import KINDS, RESISTORS, STORAGES
from hybond.model.lawbook import law_of, start_of
from hybond.model.laws import JunctionLaw
from hybond.model.parametric import Parametric, parametric
from hybond.model.parts import InputPart, Value
from hybond.model.pins import pins_of, reference_of
from hybond.model.planar_friction import paired, pairs_of
from hybond.model.resolve import Resolver, is_condition
from hybond.model.sampled import samples_of
from hybond.model.wiring import RawBond, RawNode, domains_of, ends_of
from hybond.names import did_you_mean, join
from hybond.uncollected import uncollected
from hybond.units import DOMAINS, Dimension, parse_unit

_RULE = re.compile(r"\s*(\w+)\s*->\s*(\w+)\s+when\s+(.+)\Z", re.DOTALL)
_ROUNDED = 1e-12
"""Part of a period that two sums of times may differ by and still be the same instant."""
_TIME = parse_unit("s")[1]


@uncollected
def flatten(model: Model, overrides: Mapping[str, Value], trail: Trail | None = None) -> FlatGraph:
    """Return the flat graph of `model` with parameters replaced by `overrides`.

    With a `trail` its numbers know of which parameters they were made.

    Raises
    ------
    ModelError
        For anything that has no meaning; `where` is the path in the model.
    """
    opened = open_model(model, overrides, trail)
    with_laws = open_laws(opened)
    switched = _switched(opened)
    raw_nodes, raw_bonds = _graph(opened, switched)
    ends = ends_of(raw_nodes, raw_bonds)
    domains = domains_of(raw_nodes, raw_bonds, opened)
    bonds = tuple(Bond(k, b.tail, b.head, b.name, domains[k]) for k, b in enumerate(raw_bonds))
    nodes = [
        Node(
            index=k,
            path=raw.path,
            kind=raw.kind,
            ends=ends[k],
            domain=domains[ends[k][0].bond] if ends[k] else DOMAINS["generic"],
            controlled=raw.switched,
            machine=switched[raw.owner][0] if raw.switched else None,
            hidden=raw.written is None,
            impulsive=bool(raw.written and raw.written.part.options.get("impulsive", False)),
            label=_label(raw),
        )
        for k, raw in enumerate(raw_nodes)
    ]
    sources = set(with_laws.values()) - {""}
    nodes = [replace(n, implied=n.path in sources) for n in nodes] if sources else nodes
    storages = _storages(raw_nodes, nodes)
    states = {
        path: (k, tuple(part.states)) for k, (path, (_, part)) in enumerate(opened.machines.items())
    }
    resolver = Resolver(opened, tuple(nodes), bonds, storages, states)
    dimensions = _dimensions(bonds, storages, nodes)
    inputs = _inputs(opened)
    dimensions.update({f"u:{i.index}": i.dimension for i in inputs})
    _give_units(opened, resolver, dimensions)
    integrals = _integrals(opened, resolver, dimensions)
    samples = samples_of(opened, resolver, dimensions)
    for path in opened.given:
        given = resolver.dimension(resolver.signal(path), dimensions, f"signals.{path}")
        _check_given(path, given, opened)
    for raw, node in zip(raw_nodes, nodes, strict=True):
        if raw.path in with_laws and raw.written is not None:
            check_units(node, raw.written, resolver, dimensions)
    for k, raw in enumerate(raw_nodes):
        if raw.written is not None and raw.kind not in ("0", "1"):
            nodes[k] = replace(nodes[k], law=law_of(nodes[k], raw.written, resolver, dimensions))
    signals = {path: resolver.signal(path) for path in opened.signals}
    for path, tree in signals.items():
        dimensions[path] = resolver.dimension(tree, dimensions, f"signals.{path}")
    machines = _machines(opened, resolver, nodes, switched, dimensions)
    if with_laws:
        machines = _with_laws(machines, with_laws, opened, nodes, resolver, dimensions)
    root = Scope("", model, {k: v for k, v in opened.parameters.items() if "." not in k})
    graph = FlatGraph(
        name=model.name,
        title=model.title,
        nodes=tuple(nodes),
        bonds=bonds,
        storages=storages,
        machines=machines,
        integrals=integrals,
        inputs=inputs,
        watches=tuple(resolver.watches),
        signals=signals,
        parameters={k: v.value for k, v in opened.parameters.items()},
        dimensions=dimensions,
        samples=samples,
        experiment=dict(model.experiment),
        layout=opened.layout,
        warnings=law_warnings(machines),
        by_path={n.path: n.index for n in nodes},
        indeterminate=model.indeterminate,
        pins=pins_of(opened, resolver),
        reference=reference_of(opened, machines),
        read=lambda text: resolver.resolve(parse(text, where=text), root, text),
        parametric=lambda k: _parametric(nodes[k], raw_nodes[k], resolver),
    )
    check_readers(graph)
    return fieldless.checked(graph)


def _give_units(
    opened: Opened, resolver: Resolver, dimensions: Mapping[str, Dimension | None]
) -> None:
    """Read what is given to an input without a unit in the unit of the input's own value."""
    for path, (scope, part) in opened.given.items():
        own = _input(0, path, scope, part).dimension
        if own is None:
            continue
        tree = resolver.signal(path)
        scaled = Binary("*", tree, Number(1.0, own))
        where = f"signals.{path}"
        plain = resolver.dimension(tree, dimensions, where) is None
        # times a unit, plain numbers have it; what is unknown stays unknown
        if plain and resolver.dimension(scaled, dimensions, where) == own:
            resolver.read_as(path, scaled)


def _check_given(path: str, given: Dimension | None, opened: Opened) -> None:
    """Refuse an input of a submodel in another unit than its own value has."""
    scope, part = opened.given[path]
    own = _input(0, path, scope, part).dimension
    if own is not None and given is not None and own != given:
        raise UnitError(
            f"the input is in {own}, and is given in {given}",
            code="HB-U103",
            where=path,
            hint=f"give it in {own}",
        )


def _parametric(node: Node, raw: RawNode, resolver: Resolver) -> Parametric:
    assert raw.written is not None
    return parametric(node, raw.written, resolver)


def _switched(opened: Opened) -> dict[str, tuple[int, str]]:
    """Return ``{node path: (machine index, machine path)}`` for all that machines switch."""
    found: dict[str, tuple[int, str]] = {}
    for k, (path, (scope, machine)) in enumerate(opened.machines.items()):
        where = f"machines.{path}"
        if not machine.states:
            raise ModelError("a machine needs a state", code="HB-M140", where=where, hint="add one")
        for state, listed in machine.states.items():
            if isinstance(listed, str):
                raise ModelError(
                    f"the state {state!r} lists {listed!r}, which is a text",
                    code="HB-M140",
                    where=f"{where}.states.{state}",
                    hint=f"write [{listed!r}]",
                )
            for name in listed:
                node = join(scope.prefix, name)
                node = opened.ports.get(node, node)
                if node not in opened.nodes:
                    raise ModelError(
                        f"{name!r} is not an element or junction",
                        code="HB-M141",
                        where=f"{where}.states.{state}",
                        hint=did_you_mean(node, opened.nodes),
                    )
                if found.get(node, (k,))[0] != k:
                    raise ModelError(
                        f"{node!r} is switched by two machines, {found[node][1]!r} and {path!r}",
                        code="HB-M142",
                        where=f"{where}.states.{state}",
                        hint="let one machine control it",
                    )
                found[node] = (k, path)
    return found


def _graph(
    opened: Opened, switched: Mapping[str, tuple[int, str]]
) -> tuple[list[RawNode], list[RawBond]]:
    """Number nodes and bonds; a switched C, I, R or G gets a junction of its own as its switch."""
    nodes: list[RawNode] = []
    number: dict[str, int] = {}
    for path, written in opened.nodes.items():
        kind = written.part.kind
        if kind not in KINDS:
            raise ModelError(
                f"there is no element kind {kind!r}",
                code="HB-M102",
                where=path,
                hint=did_you_mean(kind, KINDS),
            )
        behind = path in switched and kind in STORAGES + RESISTORS
        number[path] = len(nodes)
        nodes.append(RawNode(path, kind, written, switched=path in switched and not behind))
    bonds = [
        RawBond(number[b.tail.path], number[b.head.path], b.tail.port, b.head.port, b.name, b.where)
        for b in opened.bonds
    ]
    touching: list[list[int]] = [[] for _ in nodes]
    for k, b in enumerate(bonds):
        touching[b.tail].append(k)
        touching[b.head].append(k)
    for path in switched:
        node = nodes[number[path]]
        if node.switched:
            continue
        at = touching[number[path]]
        if len(at) != 1:
            raise ModelError(
                f"the switched element {path!r} must have one bond, it has {len(at)}",
                code="HB-M143",
                where=path,
                hint="switch a junction next to it instead",
            )
        # OFF: no effort on what gives effort (C, R), no flow on what gives flow (I, G)
        kind = "0" if node.kind in ("C", "R") else "1"
        switch = len(nodes)
        nodes.append(RawNode(f"{path}.switch", kind, None, switched=True))
        old = bonds[at[0]]
        inner = f"{path}.switch -> {path}"
        if old.head == number[path]:
            bonds[at[0]] = replace(old, head=switch, head_port="")
            bonds.append(RawBond(switch, number[path], "", old.head_port, inner, old.where))
        else:
            bonds[at[0]] = replace(old, tail=switch, tail_port="")
            inner = f"{path} -> {path}.switch"
            bonds.append(RawBond(number[path], switch, old.tail_port, "", inner, old.where))
    return nodes, bonds


def _label(raw: RawNode) -> str:
    """Return the parameter as written, if it is short enough to draw."""
    if raw.written is None or raw.kind in ("0", "1"):
        return ""
    given = raw.written.part.options.get("label", raw.written.part.value)
    if isinstance(given, str | int | float):
        return str(given)
    if isinstance(given, Mapping) and len(given) == 1:
        (output, law), *_ = given.items()
        return f"{output} = {law}" if isinstance(law, str) else ""
    return ""


def _storages(raw_nodes: list[RawNode], nodes: list[Node]) -> tuple[Storage, ...]:
    storages: list[Storage] = []
    for raw, node in zip(raw_nodes, nodes, strict=True):
        if node.kind not in STORAGES or raw.written is None:
            continue
        starts, meaning = start_of(node, raw.written)
        for end, start in zip(node.ends, starts, strict=True):
            port = f".{end.port + 1}" if len(node.ends) > 1 else ""
            storages.append(
                Storage(
                    index=len(storages),
                    node=node.index,
                    port=end.port,
                    bond=end.bond,
                    sign=end.sign,
                    kind="C" if node.kind == "C" else "I",
                    path=f"{node.path}{port}.{node.about.energy}",
                    start=start,
                    start_is="stored" if meaning == "stored" else "co-energy",
                )
            )
    return tuple(storages)


def _dimensions(
    bonds: tuple[Bond, ...], storages: tuple[Storage, ...], nodes: list[Node]
) -> dict[str, Dimension | None]:
    found: dict[str, Dimension | None] = {"time": _TIME}
    for bond in bonds:
        found[f"e:{bond.index}"] = bond.domain.effort
        found[f"f:{bond.index}"] = bond.domain.flow
    for s in storages:
        domain = bonds[s.bond].domain
        rate = domain.flow if s.kind == "C" else domain.effort
        found[f"x:{s.index}"] = None if rate is None else rate * _TIME
    return found


def _inputs(opened: Opened) -> tuple[Input, ...]:
    return tuple(
        _input(k, path, scope, part)
        for k, (path, (scope, part)) in enumerate(opened.inputs.items())
    )


def _input(index: int, path: str, scope: Scope, part: InputPart) -> Input:
    where = f"inputs.{path}"
    given = [
        name for name in ("constant", "table", "pwm", "function") if getattr(part, name) is not None
    ]
    if len(given) != 1:
        raise ModelError(
            f"an input is one of constant, table, pwm or function; given: {given or 'nothing'}",
            code="HB-M150",
            where=where,
            hint="keep one of them",
        )

    def number(value: Value, what: str) -> Number:
        return constant(value, scope.parameters, f"{where}.{what}")

    if part.period is not None and part.table is None:
        raise ModelError(
            f"'period' belongs to a table, not to {given[0]!r}",
            code="HB-M150",
            where=where,
            hint="leave it out; a pwm has its period within",
        )
    waveform: Waveform
    if part.constant is not None:
        level = number(part.constant, "constant")
        return Input(index, path, Constant(level.value), level.dimension)
    if part.function is not None:
        return Input(index, path, Called(part.function, tuple(sorted(part.breaks))), None)
    if part.pwm is not None:
        unknown = set(part.pwm) - {"period", "duty", "high", "low", "phase"}
        missing = {"period", "duty"} - set(part.pwm)
        if unknown or missing:
            raise ModelError(
                f"pwm has no {min(unknown)!r}" if unknown else f"pwm needs {min(missing)!r}",
                code="HB-M150",
                where=where,
                hint="period, duty, high, low, phase",
            )
        values = {k: number(v, f"pwm.{k}") for k, v in part.pwm.items()}
        waveform = Pwm(**{k: v.value for k, v in values.items()})
        if waveform.period <= 0 or not 0.0 <= waveform.duty <= 1.0:
            raise ModelError(
                f"period = {waveform.period:g} s, duty = {waveform.duty:g}",
                code="HB-M150",
                where=where,
                hint="a positive period and a duty from 0 to 1",
            )
        high = values.get("high")
        return Input(index, path, waveform, high.dimension if high else None)
    rows = list(part.table or ())
    if not rows or any(not isinstance(r, list | tuple) or len(r) != 2 for r in rows):
        raise ModelError(
            "a table is rows of [time, value]", code="HB-M150", where=where, hint="[[0, 1], [2, 5]]"
        )
    times = [number(r[0], f"table[{k}][0]") for k, r in enumerate(rows)]
    levels = [number(r[1], f"table[{k}][1]") for k, r in enumerate(rows)]
    if any(b.value < a.value for a, b in pairwise(times)):
        raise ModelError(
            "the times of a table must not decrease", code="HB-M150", where=where, hint="sort it"
        )
    instants = [n.value for n in times]
    period = 0.0
    if part.period is not None:
        period = number(part.period, "period").value
        instants[-1] = _closing(instants, period, where)
    waveform = Timetable(
        tuple(instants), tuple(n.value for n in levels), linear=part.linear, period=period
    )
    dimension = next((n.dimension for n in levels if n.dimension is not None), None)
    return Input(index, path, waveform, dimension)


def _closing(times: list[float], period: float, where: str) -> float:
    """Return the last time of a table that repeats, exactly a period after the first if it is."""
    lasts = times[-1] - times[0]
    if not period > 0.0 or lasts > period * (1.0 + _ROUNDED):
        raise ModelError(
            f"the table lasts {lasts:g} s, its period is {period:g} s",
            code="HB-M150",
            where=where,
            hint="a positive period, not shorter than the table",
        )
    # a sum of times that should be the period is off by rounding: no piece is that short
    return times[0] + period if lasts > period * (1.0 - _ROUNDED) else times[-1]


def _integrals(
    opened: Opened, resolver: Resolver, dimensions: dict[str, Dimension | None]
) -> tuple[Integral, ...]:
    found = []
    starts = {}
    for k, (path, (scope, part)) in enumerate(opened.integrals.items()):
        starts[path] = constant(part.start, scope.parameters, f"signals.{path}.start")
        dimensions[f"s:{k}"] = starts[path].dimension
    for k, (path, (scope, part)) in enumerate(opened.integrals.items()):
        where = f"signals.{path}.integral"
        rate = resolver.resolve(literal(part.rate, where), scope, where)
        dimension = resolver.dimension(rate, dimensions, where)
        if dimension is not None:
            whole = dimension * _TIME
            given = starts[path].dimension
            if given is not None and given != whole:
                raise UnitError(
                    f"the start is in {given}, the integral in {whole}",
                    code="HB-U102",
                    where=f"signals.{path}.start",
                    hint=f"give it in {whole}",
                )
            dimensions[f"s:{k}"] = whole
        dimensions[path] = dimensions[f"s:{k}"]
        found.append(Integral(k, path, rate, starts[path].value))
    return tuple(found)


def _machines(
    opened: Opened,
    resolver: Resolver,
    nodes: list[Node],
    switched: Mapping[str, tuple[int, str]],
    dimensions: Mapping[str, Dimension | None],
) -> tuple[Machine, ...]:
    by_path = {n.path: n for n in nodes}
    found = []
    for k, (path, (scope, part)) in enumerate(opened.machines.items()):
        where = f"machines.{path}"
        states = tuple(part.states)
        on = []
        for state in states:
            listed = (join(scope.prefix, name) for name in part.states[state])
            targets = (opened.ports.get(name, name) for name in listed)
            on.append(
                frozenset(
                    by_path[t if by_path[t].controlled else f"{t}.switch"].index for t in targets
                )
            )
        if part.start not in states:
            raise ModelError(
                f"the start state {part.start!r} is not one of the states",
                code="HB-M144",
                where=f"{where}.start",
                hint=did_you_mean(part.start, states),
            )
        rules = tuple(
            _rule(text, states, resolver, scope, f"{where}.rules[{j}]", dimensions)
            for j, text in enumerate(part.rules)
        )
        found.append(Machine(k, path, states, tuple(on), states.index(part.start), rules))
    return tuple(found)


def _with_laws(
    machines: tuple[Machine, ...],
    with_laws: Mapping[str, str],
    opened: Opened,
    nodes: list[Node],
    resolver: Resolver,
    dimensions: Mapping[str, Dimension | None],
) -> tuple[Machine, ...]:
    """Return the machines, those that stand for the law of a junction with that law."""
    by_path = {n.path: n for n in nodes}
    pairs = pairs_of(opened.nodes)

    def of(path: str) -> JunctionLaw:
        source = by_path.get(with_laws[path])
        return law_of_junction(by_path[path], source, opened.nodes[path], resolver, dimensions)

    found = []
    for machine in machines:
        if machine.path in with_laws:
            law = of(machine.path)
            if machine.path in pairs:
                law = paired(law, of(pairs[machine.path]))
            machine = replace(machine, law=law)
        found.append(machine)
    return tuple(found)


def _rule(
    text: str,
    states: tuple[str, ...],
    resolver: Resolver,
    scope: Scope,
    where: str,
    dimensions: Mapping[str, Dimension | None],
) -> Rule:
    match = _RULE.match(text) if isinstance(text, str) else None
    if match is None:
        raise ModelError(
            f"{text!r} is not a rule",
            code="HB-M145",
            where=where,
            hint='write "closed -> open when time >= t_off"',
        )
    for name in match.group(1, 2):
        if name not in states:
            raise ModelError(
                f"{name!r} is not a state of this machine",
                code="HB-M144",
                where=where,
                hint=did_you_mean(name, states),
            )
    tree = parse(match[3], where=where)
    guard = resolver.resolve(tree, scope, where)
    if not is_condition(guard):
        raise ModelError(
            f"the guard {match[3].strip()!r} is a number, not a condition",
            code="HB-M146",
            where=where,
            hint="compare it with something, such as > 0",
        )
    resolver.dimension(guard, dimensions, where)
    reads = []
    for read in _reads(tree):
        meaning = resolver.resolve(read, scope, where)
        if not isinstance(meaning, Number):
            reads.append((str(read), meaning))
    return Rule(
        states.index(match[1]), states.index(match[2]), guard, match[3].strip(), tuple(reads)
    )


def _reads(tree: Expr) -> list[Expr]:
    """Return the names and ``pre()`` in a guard, in order, each once."""
    if isinstance(tree, Name | Pre):
        return [tree]
    if isinstance(tree, Compare) and tree.op in ("==", "!="):
        return []
    return list(dict.fromkeys(r for c in children(tree) for r in _reads(c)))
