"""From nested models to flat lists of dotted paths, with parameter values.

This is the first half of flattening: it opens submodels, evaluates parameters in the scope that
gives them, and follows ports. It does not know what a name in a law means; `resolve` does.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import field
from itertools import pairwise

from hybond.errors import HybondError, ModelError
from hybond.model.array_places import places_of
from hybond.model.arrays import base_of, each, switching
from hybond.model.builder import Model
from hybond.model.expressions import Number, names, parse
from hybond.model.expressions.slots import Slots
from hybond.model.indices import no_member, one, spread, together
from hybond.model.misnamed import check_given, no_such_end, no_such_target
from hybond.model.parts import (
    BlockPart,
    InputPart,
    Integral,
    MachinePart,
    Part,
    Sampled,
    SubmodelPart,
    Value,
)
from hybond.model.scope import Scope as Scope
from hybond.model.scope import constant as constant
from hybond.model.scope import literal as literal
from hybond.model.scope import without_units as without_units
from hybond.names import did_you_mean, join
from hybond.records import dataclass
from hybond.units import DIMENSIONLESS, try_quantity

_DEPTH = 64
OPENED = 200_000
"""Elements of a model whose submodels and arrays are opened, with the bonds of its ranges."""
TOLD = 8
"""Parameters in a circle that a refusal names."""
_END = re.compile(r"\w+(?:\[\d+\])?(?:\.\w+(?:\[\d+\])?)*\Z")
_BOND = re.compile(r"\s*(?:(?P<label>[A-Za-z_]\w*)\s*:)?(?P<chain>.+)\Z", re.DOTALL)


@dataclass(frozen=True, slots=True)
class Written:
    """Something written in a scope."""

    scope: Scope
    part: Part


@dataclass(frozen=True, slots=True)
class BondEnd:
    """The end of a bond as written: a node's absolute path and a port label, if any."""

    path: str
    port: str


@dataclass(frozen=True, slots=True)
class WrittenBond:
    """A bond as written, with absolute paths."""

    tail: BondEnd
    head: BondEnd
    name: str
    label: str
    where: str
    arrow: int = 0
    """Which arrow of its chain it is, or one of the bonds of."""


@dataclass(frozen=True, slots=True)
class WrittenPin:
    """A pinned stroke: the bond and the node as written, and the node's absolute path."""

    scope: Scope
    bond: str
    at: str
    path: str


@dataclass(slots=True)
class Opened:
    """All that a model and its submodels contain, by absolute dotted path."""

    nodes: dict[str, Written] = field(default_factory=dict)
    bonds: list[WrittenBond] = field(default_factory=list)
    signals: dict[str, tuple[Scope, str]] = field(default_factory=dict)
    integrals: dict[str, tuple[Scope, Integral]] = field(default_factory=dict)
    sampled: dict[str, tuple[Scope, Sampled]] = field(default_factory=dict)
    """Those of the integrals, with rate zero, that are set at instants."""
    blocks: dict[str, tuple[Scope, BlockPart]] = field(default_factory=dict)
    inputs: dict[str, tuple[Scope, InputPart]] = field(default_factory=dict)
    given: dict[str, tuple[Scope, InputPart]] = field(default_factory=dict)
    """Inputs of submodels that are signals of the model around them; and what they were."""
    machines: dict[str, tuple[Scope, MachinePart]] = field(default_factory=dict)
    parameters: dict[str, Number] = field(default_factory=dict)
    ports: dict[str, str] = field(default_factory=dict)
    arrays: dict[str, list[int]] = field(default_factory=dict)
    """The indices of each array."""
    layout: dict[str, tuple[float, float]] = field(default_factory=dict)
    pins: list[WrittenPin] = field(default_factory=list)
    reference: dict[str, str] = field(default_factory=dict)
    count: int = 0
    """Elements so far, submodels among them."""


def open_model(model: Model, overrides: Mapping[str, Value], slots: Slots | None = None) -> Opened:
    """Open `model` and all submodels; follow parameters if there is a `trail`.

    Raises
    ------
    ModelError
        HB-M105 unknown submodel, HB-M106 submodels that contain each other, HB-M107 unknown
        parameter, HB-M108 parameters that depend on each other, HB-M109 a bad bond, HB-M111
        unknown input of a submodel.
    """
    opened = Opened()
    left = dict(overrides)
    _open(model, "", {}, opened, left, (model,), {}, slots)
    if left:
        wrong = min(left)
        raise ModelError(
            f"the model has no parameter {wrong!r}",
            code="HB-M107",
            where=wrong,
            hint=did_you_mean(wrong, opened.parameters),
        )
    for bond in opened.bonds:
        for end in (bond.tail, bond.head):
            if end.path not in opened.nodes:
                for port, target in opened.ports.items():
                    if target == end.path:
                        raise no_such_target(port, target, opened.nodes)
                missing = no_member(end.path, opened.arrays)
                if missing is not None:
                    raise ModelError(
                        f"the bond {bond.name!r} ends at {end.path!r}, but {missing[0]}",
                        code="HB-M154",
                        where=bond.where,
                        hint=missing[1],
                    )
                raise no_such_end(bond.name, end.path, bond.where, opened.nodes, opened.ports)
    return opened


def _open(
    model: Model,
    prefix: str,
    given: Mapping[str, Number],
    opened: Opened,
    overrides: dict[str, Value],
    chain: tuple[Model, ...],
    known: Mapping[str, Model],
    slots: Slots | None,
) -> None:
    if len(chain) > _DEPTH:
        raise ModelError(
            f"submodels nest deeper than {_DEPTH}",
            code="HB-M106",
            where=prefix,
            hint="a model cannot contain itself",
        )
    known = {**known, **model.models}
    scope = Scope(prefix, model)
    scope.parameters = parameters_of(model, prefix, given, overrides, slots)
    opened.parameters.update({join(prefix, k): v for k, v in scope.parameters.items()})
    places = places_of(model.layout, scope, lambda name: width_of(model, name, known))
    for name, part, own in each(model.elements, scope, "elements", opened.arrays):
        path = join(prefix, name)
        # a loop in Python may write more
        _count(opened, bool(prefix) or own is not scope, prefix)
        if isinstance(part, Part):
            opened.nodes[path] = Written(own, part)
            continue
        inner = submodel_of(part, path, known)
        if any(inner is outer for outer in chain):
            raise ModelError(
                f"the submodel {inner.name!r} contains itself",
                code="HB-M106",
                where=path,
                hint="break the cycle",
            )
        check_given(part.parameters, "parameter", _known(inner), inner.name, path)
        passed = {k: constant(v, own.parameters, join(path, k)) for k, v in part.parameters.items()}
        _open(inner, path, passed, opened, overrides, (*chain, inner), known, slots)
        _connect(part, inner, path, own, opened)
        _put(path, places.get(name), opened.layout)
    for port, target, own in each(model.ports, scope, "ports", opened.arrays):
        _count(opened, own is not scope, prefix)
        path = join(prefix, port)
        opened.ports[path] = join(prefix, one(target, own, path))
    for name, signal, own in each(model.signals, scope, "signals", opened.arrays):
        _count(opened, own is not scope, prefix)
        path = join(prefix, name)
        if isinstance(signal, Integral):
            opened.integrals[path] = (own, signal)
        elif isinstance(signal, Sampled):
            opened.integrals[path] = (own, Integral("0", signal.start))
            opened.sampled[path] = (own, signal)
        else:
            opened.signals[path] = (own, signal)
    for name, block in model.blocks.items():
        path = join(prefix, name)
        opened.blocks[path] = (scope, block)
        for output, start in block.outputs.items():
            opened.integrals[join(path, output)] = (scope, Integral("0", start))
    for name, given_input, own in each(model.inputs, scope, "inputs", opened.arrays):
        _count(opened, own is not scope, prefix)
        opened.inputs[join(prefix, name)] = (own, given_input)
    for name, machine, own in each(model.machines, scope, "machines", opened.arrays):
        path = join(prefix, name)
        switched = switching(machine, own, f"machines.{path}")
        if switched is not machine:
            _count(opened, sum(map(len, switched.states.values())), prefix)
        opened.machines[path] = (own, switched)
    for k, text in enumerate(model.bonds):
        bonds = _bonds(text, scope, opened, join(prefix, f"graph.bonds[{k}]"))
        _count(opened, len(bonds) if "[" in text else 0, prefix)
        opened.bonds.extend(bonds)
    for bond, at in model.pins.items():
        where = join(prefix, "causality.pins")
        bond, at = one(bond, scope, where), one(at, scope, where)
        opened.pins.append(WrittenPin(scope, bond, at, _end(at, scope, opened).path))
    for machine_name, state in model.reference_states.items():
        for name in spread(machine_name, scope, join(prefix, "causality.reference")):
            opened.reference[join(prefix, name)] = state
    opened.layout.update({join(prefix, k): v for k, v in places.items()})


def _count(opened: Opened, number: int, prefix: str) -> None:
    """Note that so many more elements, members and bonds of ranges are opened."""
    opened.count += number
    if opened.count > OPENED:
        raise ModelError(
            f"more than {OPENED} elements when all submodels and arrays are opened",
            code="HB-F103",
            where=prefix,
            hint="simulate a part of the model",
        )


def _put(path: str, at: tuple[float, float] | None, layout: dict[str, tuple[float, float]]) -> None:
    """Put the nodes of a submodel where it stands; one that stands nowhere keeps no places."""
    for inner in [k for k in layout if k.startswith(f"{path}.")]:
        x, y = layout.pop(inner)
        if at is not None:
            layout[inner] = (at[0] + x, at[1] + y)


def _known(inner: Model) -> dict[str, Collection[str]]:
    return {"parameter": inner.parameters.keys(), "input": inner.inputs.keys()}


def _connect(part: SubmodelPart, inner: Model, path: str, scope: Scope, opened: Opened) -> None:
    """Put in what the inputs of a submodel are in the model around it."""
    for name, value in part.inputs.items():
        own = join(path, name)
        if own not in opened.inputs:
            check_given([name], "input", _known(inner), inner.name, path)
        if isinstance(literal(value, own), Number):
            opened.inputs[own] = (scope, InputPart(constant=value))
        else:
            opened.given[own] = opened.inputs.pop(own)
            opened.signals[own] = (scope, value)


def submodel_of(part: SubmodelPart, path: str, known: Mapping[str, Model]) -> Model:
    """Return the model of an instance: given as such, known by name, or a ready part; HB-M105."""
    if isinstance(part.model, Model):
        return part.model
    if part.model in known:
        return known[part.model]
    from hybond.library import find
    from hybond.library import names as ready_parts

    ready = find(part.model)
    if ready is None:
        raise ModelError(
            f"there is no submodel {part.model!r}",
            code="HB-M105",
            where=path,
            hint=did_you_mean(str(part.model), [*known, *ready_parts()]),
        )
    return ready


def width_of(model: Model, name: str, known: Mapping[str, Model]) -> float:
    """Return how many cells a member of an array is wide when it is drawn."""
    for key, part in model.elements.items():
        if base_of(key) == name and isinstance(part, SubmodelPart):
            across = [x for x, _ in submodel_of(part, key, known).layout.values()]
            return max(across, default=0.0) - min(across, default=0.0)
    return 0.0


def parameters_of(
    model: Model,
    prefix: str,
    given: Mapping[str, Number],
    overrides: dict[str, Value],
    slots: Slots | None,
) -> dict[str, Number]:
    """Return the values of the parameters of a model, those that are `given` as they are.

    What is used of `overrides` is taken out of it.
    """
    values: dict[str, Number] = dict(given)
    written: dict[str, Value] = {k: v for k, v in model.parameters.items() if k not in given}
    for name in model.parameters:
        path = join(prefix, name)
        if path in overrides:
            written[name] = overrides.pop(path)
            values.pop(name, None)
    bare = [k for k, v in values.items() if v.dimension is None]
    bare += [k for k, v in written.items() if v is not model.parameters[k] and _is_bare(v)]
    if bare:
        # a number without a unit is in SI, and of what the model's own value is made of
        try:
            own = parameters_of(model, prefix, {}, {}, None)
        except HybondError:
            own = {}  # what the model says itself has no value, and need not have one
        for name in bare:
            if name in written:
                values[name] = constant(written.pop(name), {}, join(prefix, name))
            if name in own:
                values[name] = Number(values[name].value, own[name].dimension)
    if slots is not None:
        values = {name: slots.follow(join(prefix, name), v) for name, v in values.items()}
    for name in _in_order(written, prefix):
        path = join(prefix, name)
        found = constant(written[name], values, path, known=model.parameters.keys() - {name})
        values[name] = found if slots is None else slots.follow(path, found)
    return values


def _in_order(written: Mapping[str, Value], prefix: str) -> Iterator[str]:
    """Yield the names of parameters, each after those that its value is made of."""
    waits: dict[str, int] = {}
    users: dict[str, list[str]] = {}
    for name, value in written.items():
        plain = not isinstance(value, str) or try_quantity(value) is not None
        used = set() if plain else names(parse(str(value), where=join(prefix, name)))
        if name in used:
            raise ModelError(
                f"the parameter {name} is made of itself",
                code="HB-M108",
                where=join(prefix, name),
                hint="give it a value, or name another parameter",
            )
        needs = [other for other in used if other in written and other != name]
        waits[name] = len(needs)
        for other in needs:
            users.setdefault(other, []).append(name)
    place = {name: k for k, name in enumerate(written)}
    ready = [name for name, count in waits.items() if not count]
    while ready:
        for name in ready:
            del waits[name]
        yield from ready
        freed = []
        for user in (u for name in ready for u in users.get(name, ())):
            waits[user] -= 1
            if not waits[user]:
                freed.append(user)
        ready = sorted(freed, key=place.__getitem__)
    if waits:
        waiting = list(waits)
        others = f" and {len(waiting) - TOLD} more" if len(waiting) > TOLD else ""
        raise ModelError(
            f"the parameters {', '.join(waiting[:TOLD])}{others} depend on each other",
            code="HB-M108",
            where=join(prefix, waiting[0]),
            hint="give one of them a value",
        )


def _is_bare(value: Value) -> bool:
    """Whether a value is a number without a unit."""
    if not isinstance(value, str):
        return not isinstance(value, bool) and isinstance(value, int | float)
    quantity = try_quantity(value)
    return quantity is not None and quantity.dimension == DIMENSIONLESS


def _bond_meant(text: object) -> str:
    """Return the remedy for two names with another sign than an arrow between, else nothing."""
    match = re.fullmatch(r"\s*([\w.]+)\s*(<?)\s*([-=–—→>,]|=+>)\s*([\w.]+)\s*", str(text))
    if match is None:
        return ""
    tail, back, _, head = match.groups()
    return f'write "{head} -> {tail}"' if back else f'write "{tail} -> {head}"'


def bonds_in(text: str, scope: Scope, where: str) -> tuple[str, list[list[list[str]]]]:
    """Return the label of a text of bonds, and for each arrow the ends of its bonds.

    Ranges at one arrow run together; elsewhere in a chain they may be others.

    Raises
    ------
    ModelError
        HB-M109 for what is no bond, HB-M152 and HB-M153 for ranges.
    """
    match = _BOND.match(text) if isinstance(text, str) else None
    ends = [] if match is None else [e.strip() for e in match["chain"].split("->")]
    if match is None or len(ends) < 2 or not all(ends):
        raise ModelError(
            f"{text!r} is not a bond",
            code="HB-M109",
            where=where,
            hint=_bond_meant(text) or 'write "a -> b", "a -> b -> c" or "b3: a -> b"',
        )
    label = match["label"] or ""
    arrows = [together(pair, scope, where) for pair in pairwise(ends)]
    if label and (len(ends) > 2 or len(arrows[0]) > 1):
        what = "a chain" if len(ends) > 2 else f"{len(arrows[0])} bonds"
        raise ModelError(
            f"a label names one bond, {text!r} is {what}",
            code="HB-M109",
            where=where,
            hint="write the labelled bond on its own",
        )
    for end in (end for bonds in arrows for pair in bonds[:1] for end in pair):
        if not _END.match(end):
            shown = re.sub(r"\s*(?:[=–—-]+\s*>|→)\s*", " -> ", text)
            hint = 'write "a -> b", and names with letters, digits and _'
            if "<" in text or "←" in text:
                hint = 'turn it round: the half arrow of "a -> b" points at b'
            elif shown != text and "->" in shown:
                hint = f'write "{shown[:60]}"'
            raise ModelError(
                f"{text!r} is not a bond: {end!r} names no element",
                code="HB-M109",
                where=where,
                hint=hint,
            )
    return label, arrows


def _bonds(text: str, scope: Scope, opened: Opened, where: str) -> list[WrittenBond]:
    label, arrows = bonds_in(text, scope, where)
    found = []
    for arrow, bonds in enumerate(arrows):
        for a, b in bonds:
            name = f"{label}: {a} -> {b}" if label else f"{a} -> {b}"
            tail, head = (_end(e, scope, opened) for e in (a, b))
            found.append(WrittenBond(tail, head, join(scope.prefix, name), label, where, arrow))
    return found


def _end(text: str, scope: Scope, opened: Opened) -> BondEnd:
    """Follow ports of submodels, and split a trailing port number off."""
    path = join(scope.prefix, text)
    port = ""
    if path not in opened.nodes and path not in opened.ports:
        head, _, last = path.rpartition(".")
        if last.isdigit() and (head in opened.nodes or head in opened.ports):
            path, port = head, last
    for _ in range(_DEPTH):
        if path not in opened.ports:
            break
        path = opened.ports[path]
        head, _, last = path.rpartition(".")
        if last.isdigit() and head in opened.nodes:
            path, port = head, last
    return BondEnd(path, port)
