"""Flattening: a `Model` with submodels, names and units becomes a `FlatGraph`.

The order is that of `flatten`: open submodels, find what is switched, wire bonds to ports, give
bonds domains, read inputs, signals and laws, then machines, then check what only the whole can show
(fieldless states).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from hybond.errors import HybondError, ModelError, UnitError
from hybond.model import fieldless
from hybond.model.builder import Model
from hybond.model.dimensions import Loose
from hybond.model.expressions import Expr, Name, names, parse
from hybond.model.expressions.sided_roots import sided_roots
from hybond.model.expressions.slots import Slots
from hybond.model.flat_pieces import with_flat_pieces
from hybond.model.graph import Bond, FlatGraph, Integral, Node, Storage
from hybond.model.hierarchy import Opened, Scope, WrittenBond, constant, literal, open_model
from hybond.model.indices import spread
from hybond.model.junction_laws import check_readers, check_units, law_warnings, open_laws
from hybond.model.kinds import KINDS, RESISTORS, STORAGES
from hybond.model.lawbook import law_of, start_of
from hybond.model.located import locate
from hybond.model.machines import machines_of, rule_of, switched_by, with_laws_of_junctions
from hybond.model.misfits import of_a_given_parameter, units_of
from hybond.model.one_energy import check_energies
from hybond.model.parametric import Parametric, parametric
from hybond.model.parts import Value
from hybond.model.paths import settable_like, with_parts
from hybond.model.pins import pins_of, reference_of
from hybond.model.resolve import Resolver
from hybond.model.rigid_friction import held_together
from hybond.model.sampled import samples_of
from hybond.model.waveforms import check_given, give_units, inputs_of
from hybond.model.wiring import RawBond, RawNode, domains_of, ends_of
from hybond.names import did_you_mean
from hybond.uncollected import uncollected
from hybond.units import DIMENSIONLESS, DOMAINS, Dimension, parse_unit, try_quantity

_TIME = parse_unit("s")[1]


@uncollected
def flatten(model: Model, overrides: Mapping[str, Value], slots: Slots | None = None) -> FlatGraph:
    """Return the flat graph of `model` with parameters replaced by `overrides`.

    With `slots` its numbers are expressions of the parameters that these want.

    Raises
    ------
    ModelError
        For anything that has no meaning; `where` is the path in the model, and `file`, `line` and
        `written` what says so in the file that the model was read from.
    """
    changed, left = with_parts(model, overrides)
    if slots is not None and changed is not model:
        # what a law is made of is not known in slots
        raise ModelError(
            "parts of the model are set", code="HB-M107", where="parameters", hint="flatten it anew"
        )
    try:
        return _flatten(changed, left, slots, overrides)
    except HybondError as error:
        if error.code == "HB-M107" and error.where in overrides:
            error.hint = settable_like(model, error.where)
        if isinstance(error, UnitError):
            error = of_a_given_parameter(error, changed, left)
        raise locate(error, changed, overrides) from None


def _flatten(
    model: Model, overrides: Mapping[str, Value], slots: Slots | None, asked: Mapping[str, Value]
) -> FlatGraph:
    opened = open_model(model, overrides, slots)
    written = tuple(opened.bonds)  # after these come bonds of laws and behind switched elements
    with_laws = open_laws(opened)
    switched = switched_by(opened)
    raw_nodes, raw_bonds = _graph(opened, switched)
    ends = ends_of(raw_nodes, raw_bonds)
    domains = domains_of(raw_nodes, raw_bonds)
    bonds = tuple(
        Bond(k, b.tail, b.head, b.name, domains[k], *_place(written, k))
        for k, b in enumerate(raw_bonds)
    )
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
            finite=bool(raw.written and raw.written.part.options.get("impulsive") is False),
            label=_label(raw),
            shown=_shown(raw),
        )
        for k, raw in enumerate(raw_nodes)
    ]
    sources = set(with_laws.values()) - {""}
    nodes = [replace(n, implied=n.path in sources) for n in nodes] if sources else nodes
    storages = _storages(raw_nodes, nodes, bonds)
    states = {
        path: (k, tuple(part.states)) for k, (path, (_, part)) in enumerate(opened.machines.items())
    }
    resolver = Resolver(opened, tuple(nodes), bonds, storages, states)
    dimensions = _dimensions(bonds, storages)
    inputs = inputs_of(opened)
    dimensions.update({f"u:{i.index}": i.dimension for i in inputs})
    give_units(opened, resolver, dimensions)
    try:
        integrals = _integrals(opened, resolver, dimensions)
        samples = samples_of(opened, resolver, dimensions)
    except UnitError as error:
        raise _of_a_domain(raw_nodes, nodes, resolver, dimensions) or error from None
    for path in opened.given:
        given = resolver.dimension(resolver.signal(path), dimensions, f"signals.{path}")
        check_given(path, given, opened)
    try:
        for raw, node in zip(raw_nodes, nodes, strict=True):
            if raw.path in with_laws and raw.written is not None:
                check_units(node, raw.written, resolver, dimensions)
        for k, raw in enumerate(raw_nodes):
            if raw.written is not None and raw.kind not in ("0", "1"):
                law = law_of(nodes[k], raw.written, resolver, dimensions)
                sided = tuple(sided_roots(e) for e in law.expressions)
                law = law if sided == law.expressions else replace(law, expressions=sided)
                nodes[k] = replace(nodes[k], law=law)
    except UnitError:  # where a signal is wrong in itself, that is the place
        for path in opened.signals:
            resolver.dimension(resolver.signal(path), dimensions, f"signals.{path}")
        raise
    signals = {path: resolver.signal(path) for path in opened.signals}
    for path, tree in signals.items():
        dimensions[path] = resolver.dimension(tree, dimensions, f"signals.{path}")
    machines = machines_of(opened, resolver, nodes, dimensions)
    if with_laws:
        machines = with_laws_of_junctions(machines, with_laws, opened, nodes, resolver, dimensions)
        machines = held_together(machines, nodes, bonds)
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
        experiment=_experiment(model, root),
        layout=opened.layout,
        warnings=law_warnings(machines),
        by_path={n.path: n.index for n in nodes},
        indeterminate=model.indeterminate,
        pins=pins_of(opened, resolver),
        reference=reference_of(opened, machines),
        read=lambda text: _read(text, resolver, root, dimensions),
        condition=lambda text: (
            rule_of(text, resolver, root, text, dimensions),
            tuple(resolver.watches),
        ),
        parametric=lambda k: _parametric(nodes[k], raw_nodes[k], resolver),
        locate=lambda error: locate(error, model, asked),
    )
    check_readers(graph)
    check_energies(graph)
    return with_flat_pieces(fieldless.checked(graph))


def _read(
    text: str, resolver: Resolver, root: Scope, dimensions: dict[str, Dimension | None]
) -> Expr:
    """Return what somebody asks a model for, as its own signals are read: units have to fit."""
    tree = resolver.resolve(parse(text, where=text), root, text)
    resolver.dimension(tree, dimensions, text)
    return tree


def _experiment(model: Model, root: Scope) -> dict[str, Any]:
    """Return what a run of the model is, with members of arrays one by one in its lists."""
    found = dict(model.experiment)
    for key in ("plot", "outputs"):
        listed = found.get(key)
        if isinstance(listed, list | tuple) and any("[" in str(name) for name in listed):
            where = f"experiment.{key}"
            found[key] = [own for name in listed for own in _listed(str(name), root, where)]
    return found


def _listed(text: str, root: Scope, where: str) -> list[str]:
    """Return the signals that a text in a list stands for: several only if it is a name."""
    try:
        tree = parse(text, where=where) if "[" in text else None
    except HybondError:
        return [text]  # refused where it is read
    return spread(text, root, where) if isinstance(tree, Name) else [text]


def _place(written: Sequence[WrittenBond], k: int) -> tuple[str, int]:
    """Return where a bond is written, and as which arrow of its chain."""
    return (written[k].where, written[k].arrow) if k < len(written) else ("", 0)


def _parametric(node: Node, raw: RawNode, resolver: Resolver) -> Parametric:
    assert raw.written is not None
    return parametric(node, raw.written, resolver)


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


def _shown(raw: RawNode) -> tuple[float, Dimension] | None:
    """Return the value of the parameter that an element of a submodel has: ``R`` says little.

    So does what an array says of all its members, ``(1 + 0.1*i) [mF]``.
    """
    if raw.written is None:
        return None
    scope, label = raw.written.scope, _label(raw)
    number = scope.parameters.get(label) if scope.prefix else None
    if scope.index and label and try_quantity(label) is None and scope.index in _names(label):
        try:
            number = constant(label, scope.parameters, raw.path)
        except HybondError:
            number = None  # it reads signals
    return None if number is None else (number.value, number.dimension or DIMENSIONLESS)


def _names(text: str) -> set[str]:
    try:
        return names(parse(text))
    except HybondError:
        return set()


def _storages(
    raw_nodes: list[RawNode], nodes: list[Node], bonds: Sequence[Bond]
) -> tuple[Storage, ...]:
    storages: list[Storage] = []
    for raw, node in zip(raw_nodes, nodes, strict=True):
        if node.kind not in STORAGES or raw.written is None:
            continue
        domains = [bonds[end.bond].domain for end in node.ends]
        starts, meaning = start_of(node, raw.written, domains)
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
    bonds: tuple[Bond, ...], storages: tuple[Storage, ...]
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


def _of_a_domain(
    raw_nodes: Sequence[RawNode],
    nodes: Sequence[Node],
    resolver: Resolver,
    dimensions: dict[str, Dimension | None],
) -> UnitError | None:
    """Return the refusal of a declared domain, in which units of signals are others, if any."""
    for raw, node in zip(raw_nodes, nodes, strict=True):
        if raw.written is not None and raw.kind not in ("0", "1"):
            try:
                law_of(node, raw.written, resolver, dimensions)
            except HybondError as error:
                if isinstance(error, UnitError) and error.where.endswith(".domain"):
                    return error
    return None


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
            certain = resolver.dimension(rate, dimensions, where, certain=True) is not None
            if given is not None and given != whole and certain:
                made = units_of([part.start, part.rate], scope.parameters)
                raise UnitError(
                    f"the start {part.start!r} is in {given}, the integral of {part.rate!r} in "
                    f"{whole}{made}",
                    code="HB-U102",
                    where=f"signals.{path}.start",
                    hint=f"give the start in {whole}"
                    + (", or mend the unit of the parameter" if made else ""),
                )
            # the numbers in 4*speed may have any unit, which the start may say
            dimensions[f"s:{k}"] = whole if certain else given or Loose(whole.exponents)
        dimensions[path] = dimensions[f"s:{k}"]
        found.append(Integral(k, path, rate, starts[path].value))
    return tuple(found)
