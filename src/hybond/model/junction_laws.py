"""Junctions with a law of their own: ideal diodes, contacts, dry friction.

A junction that carries a *law* has no machine written for it. Its common variable (the flow of a
1-junction, the effort of a 0-junction) and its net variable (what its bonds bring in minus what
they take out) are tied by complementarity:

=========================  ====================================================================
``diode``, ``unilateral``  common >= 0, net <= 0, one of them zero
``thyristor``              a diode that begins to conduct only while its gate holds
``coulomb``, ``relay``     net in limit * Sgn(common); at rest anything between the limits;
                           two junctions in a `planar_friction` share one disk
=========================  ====================================================================

Here such a junction is opened into ordinary parts, so that causality, equations and drawing need
to know nothing new: a machine of its name, whose states are the branches of the law and whose
rules say when a branch is violated, and a source where the branch asks for one (the friction force
of a sliding branch, Newton's rebound in the branch ``impact``). Which branches are taken is decided
for all junctions at once, by complementarity, never rule by rule.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

from hybond.errors import ModelError, UnitError
from hybond.model.expressions import Expr, Name, Number, posterior_names, simplify
from hybond.model.expressions.slots import plain, slot_of
from hybond.model.fed_laws import fed_laws, switched_relay
from hybond.model.graph import FlatGraph, Machine, Node
from hybond.model.hierarchy import (
    BondEnd,
    Opened,
    Scope,
    Written,
    WrittenBond,
    literal,
    without_units,
)
from hybond.model.kinds import JUNCTIONS, law_hint
from hybond.model.laws import TWO_SIDED, JunctionLaw
from hybond.model.parts import MachinePart, Part, Value
from hybond.model.planar_friction import keep, pairs_of, planar_parts
from hybond.model.resolve import Resolver, balance
from hybond.names import did_you_mean, is_number, join
from hybond.units import DIMENSIONLESS, Dimension, parse_unit, try_quantity

_TIME = parse_unit("s")[1]

LAWS: dict[str, tuple[str, ...]] = {
    "diode": (),
    "thyristor": ("gate",),
    "unilateral": ("gap", "restitution", "stiffness"),
    "coulomb": ("limit", "breakaway", "impulsive", "pair"),
    "relay": ("limit", "breakaway", "impulsive", "pair"),
}
"""Each law and the options that it may have."""
_WITH_UNITS = ("limit", "breakaway", "gap", "restitution")
_READ = (*_WITH_UNITS, "gate", "stiffness")
"""Options that are expressions."""
NEEDED = {"thyristor": "gate", "coulomb": "limit", "relay": "limit"}
_LAW_ONLY = ("law", "gap", "gate", "restitution", "stiffness", "limit", "breakaway", "pair")
_QUANTITY = r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(.+)"
_COMMON_OPTIONS = ("law", "domain", "label")


def open_laws(opened: Opened) -> dict[str, str]:
    """Add the machine, and the source if there is one, of each junction with a law.

    Returns
    -------
    dict
        Path of the junction to the path of its source, empty if it has none.

    Raises
    ------
    ModelError
        HB-M200 an unknown law, HB-M201 an option that is missing, or that the law or element
        does not have,
        HB-M202 a name that is taken, HB-M206 a pair that does not fit together.
    """
    found: dict[str, str] = {}
    firsts = pairs_of(opened.nodes)
    seconds = set(firsts.values())
    fed = fed_laws(opened)
    for path, written in list(opened.nodes.items()):
        part = written.part
        if part.kind not in JUNCTIONS:
            _refuse_law(path, part)
            continue
        kind = _kind(path, part)
        if kind is None:
            continue
        if path in seconds:
            continue  # opened with the first of its pair
        name = _local(path, written)
        if path in opened.machines:
            raise ModelError(
                f"the junction {path!r} has a law, so its name is also that of its machine",
                code="HB-M202",
                where=path,
                hint="rename the machine that you wrote, or leave it out",
            )
        if path in firsts:
            found.update(_open_pair(opened, path, firsts[path]))
            continue
        machine, source = _parts(kind, name, part)
        if path in fed:
            machine = switched_relay(name, f"{name}.{_variables(part.kind)[0]}")
        opened.machines[path] = (written.scope, machine)
        found[path] = ""
        if source is not None:
            own, text = source
            found[path] = _add_source(opened, written.scope, path, own, text, part)
    return found


def _local(path: str, written: Written) -> str:
    prefix = written.scope.prefix
    return path.removeprefix(f"{prefix}.") if prefix else path


def _open_pair(opened: Opened, first: str, second: str) -> dict[str, str]:
    """Add the machine and both sources of friction in two directions; return these by junction."""
    written, other = opened.nodes[first], opened.nodes[second]
    part = written.part
    common, net = _variables(part.kind)
    limit = _text(part.options["limit"])
    machine, values = planar_parts(
        _local(first, written),
        _local(second, other),
        limit,
        _text(part.options.get("breakaway", part.options["limit"])),
        common=common,
        net=net,
    )
    opened.machines[first] = (written.scope, machine)
    keep(opened, first)
    return {
        path: _add_source(opened, written.scope, path, "friction", text, Part(part.kind))
        for path, text in zip((first, second), values, strict=True)
    }


def _variables(kind: str) -> tuple[str, str]:
    """Return the common and the net variable of a junction."""
    return ("f", "e") if kind == "1" else ("e", "f")


def _refuse_law(path: str, part: Part) -> None:
    """Refuse a law, or an option of one, at an element that is no junction."""
    for option in _LAW_ONLY:
        if option in part.options:
            raise ModelError(
                f"a {part.kind} has no option {option!r}",
                code="HB-M201",
                where=f"elements.{path}",
                hint=law_hint(part.kind, '{{ {kind} = {{ {of} = "..." }} }}'),
            )


def _kind(path: str, part: Part) -> str | None:
    """Return the law of a junction, None if it has none; check its options."""
    kind = part.options.get("law")
    where = f"elements.{path}"
    if kind is not None and kind not in LAWS:
        raise ModelError(
            f"there is no law {kind!r} for a junction",
            code="HB-M200",
            where=where,
            hint=did_you_mean(str(kind), LAWS) or "one of " + ", ".join(LAWS),
        )
    if kind == "thyristor" and part.kind == "0":
        raise ModelError(
            "a thyristor is a 1-junction: it blocks a flow",
            code="HB-M200",
            where=where,
            hint="junction = 1, in series with what it switches",
        )
    allowed = (*_COMMON_OPTIONS, *(LAWS[kind] if kind is not None else ()))
    for option in part.options:
        if option not in allowed:
            raise ModelError(
                f"a junction with law {kind!r} has no option {option!r}"
                if kind
                else f"a junction has no option {option!r} without a law",
                code="HB-M201",
                where=where,
                hint=did_you_mean(option, allowed) or "options: " + ", ".join(allowed),
            )
    needed = None if "pair" in part.options else NEEDED.get(str(kind))
    if needed is not None and needed not in part.options:
        raise ModelError(
            f"the law {kind!r} needs {needed!r}",
            code="HB-M201",
            where=where,
            hint='limit = "mu*N"' if needed == "limit" else 'gate = "u > 0.5"',
        )
    return None if kind is None else str(kind)


def _parts(kind: str, name: str, part: Part) -> tuple[MachinePart, tuple[str, str] | None]:
    """Return the machine of a law, and name and value of its source."""
    common, net = _variables(part.kind)
    x, y = f"{name}.{common}", f"{name}.{net}"
    options = part.options
    if kind in TWO_SIDED:
        limit = _text(options["limit"])
        rest = _text(options.get("breakaway", options["limit"]))
        rules: tuple[str, ...] = (
            f"sticks -> forward when {y} > ({rest})",
            f"sticks -> backward when -{y} > ({rest})",
            f"forward -> sticks when {x} < 0",
            f"backward -> sticks when {x} > 0",
        )
        states: dict[str, tuple[str, ...]] = {
            "sticks": (),
            "forward": (name,),
            "backward": (name,),
        }
        value = (
            f'if {name}.state == "forward" then ({limit}) '
            f'else if {name}.state == "backward" then -({limit}) else 0*({limit})'
        )
        return MachinePart(states, "sticks", rules), ("friction", value)
    off, on = ("open", "closed") if kind == "unilateral" else ("blocks", "conducts")
    begins = f"{y} > 0"
    if "gap" in options:
        begins = f"({_text(options['gap'])}) <= 0 and {begins}"
    if "gate" in options:
        begins = f"({_text(options['gate'])}) and {begins}"
    rules = (f"{off} -> {on} when {begins}", f"{on} -> {off} when {x} < 0")
    states = {off: (), on: (name,)}
    if "restitution" not in options:
        return MachinePart(states, off, rules), None
    states["impact"] = (name,)
    # a contact that a source closes with a jump had no approach before it: nothing is reversed
    value = (
        f'if {name}.state == "impact" then ({_text(options["restitution"])})*max(0, pre({y})) '
        f"else 0*{y}"
    )
    return MachinePart(states, off, rules), ("rebound", value)


def _text(value: Value) -> str:
    """Return an option as part of an expression: a quantity has its unit in brackets there."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if not isinstance(value, str):
        # numbers of NumPy show their type
        return repr(value if type(value) is int else float(value))
    if is_number(value):
        return value
    split = re.fullmatch(_QUANTITY, value.strip(), re.ASCII)
    if try_quantity(value) is None or split is None or "[" in value:
        return value
    return f"{split[1]} [{split[2]}]"


def _add_source(opened: Opened, scope: Scope, path: str, own: str, text: str, part: Part) -> str:
    """Add the source of a law and its bond; return its path.

    Friction takes what the junction's balance leaves, a rebound gives to it.
    """
    source = join(path, own)
    if source in opened.nodes:
        raise ModelError(
            f"the law of {path!r} makes an element {source!r}, but that name is taken",
            code="HB-M202",
            where=path,
            hint="rename the submodel",
        )
    options = {"impulsive": True} if part.options.get("impulsive") else {}
    kind = "Se" if part.kind == "1" else "Sf"
    opened.nodes[source] = Written(scope, Part(kind, text, options))
    ends = (BondEnd(path, ""), BondEnd(source, ""))
    tail, head = ends if own == "friction" else ends[::-1]
    name = f"{tail.path} -> {head.path}"
    opened.bonds.append(WrittenBond(tail, head, name, "", f"elements.{path}.law"))
    return source


def check_units(
    node: Node,
    written: Written,
    resolver: Resolver,
    dimensions: Mapping[str, Dimension | None],
) -> None:
    """Refuse options of a law in the wrong unit, before the parts that are made of them are read.

    Raises
    ------
    UnitError
        HB-U103 for a limit, breakaway, gap or restitution in the wrong unit.
    """
    for option in _WITH_UNITS:
        if option in written.part.options:
            _option(option, node, written, resolver, dimensions)


def _option(
    option: str,
    node: Node,
    written: Written,
    resolver: Resolver,
    dimensions: Mapping[str, Dimension | None],
) -> Expr:
    """Return an option of a law in canonical names, its unit and kind checked."""
    from hybond.model.resolve import is_condition

    value = written.part.options[option]
    at = f"elements.{node.path}.{option}"
    if option == "gate":
        value = _text(value)  # True is a gate that is always open
    tree = resolver.resolve(literal(value, at), written.scope, at)
    if option == "gate" and not is_condition(tree):
        raise ModelError(
            f"the gate {value!r} is a number, not a condition",
            code="HB-M146",
            where=at,
            hint="compare it with something, such as > 0",
        )
    found = resolver.dimension(tree, dimensions, at)
    target = _wanted(option, node, dimensions)
    if target is not None and found is not None and found != target:
        plain_number = target == DIMENSIONLESS
        raise UnitError(
            f"{value!r} is in {found}; {option} is "
            + ("a number without a unit" if plain_number else f"in {target}"),
            code="HB-U103",
            where=at,
            hint=f"divide by a reference: ({value})/(1 [{found}])"
            if plain_number
            else f"give it in {target}",
        )
    return simplify(without_units(tree))


def _wanted(
    option: str, node: Node, dimensions: Mapping[str, Dimension | None]
) -> Dimension | None:
    """Return the dimension that an option must have, None if it may have any."""
    if option == "restitution":
        return DIMENSIONLESS
    if option not in _WITH_UNITS or not node.ends:
        return None
    net = dimensions.get(f"{_variables(node.kind)[1]}:{node.ends[0].bond}")
    return net * _TIME if option == "gap" and net is not None else net


def law_of_junction(
    node: Node,
    source: Node | None,
    written: Written,
    resolver: Resolver,
    dimensions: Mapping[str, Dimension | None],
) -> JunctionLaw:
    """Return the law of a junction with its expressions resolved and their units checked.

    Raises
    ------
    UnitError
        HB-U103 for a limit or gap in the wrong unit.
    ModelError
        HB-M146 for a gate that is no condition, HB-M203 for a coefficient of restitution, a limit
        or a stiffness below zero, or a breakaway below the limit.
    """
    part = written.part
    common, net = _variables(node.kind)
    given = {
        option: _option(option, node, written, resolver, dimensions)
        for option in _READ
        if option in part.options
    }
    _check_values(given, f"elements.{node.path}")
    return JunctionLaw(
        kind=str(part.options["law"]),
        node=node.index,
        common=_common(node, common),
        net=balance(node, net, without=None if source is None else source.ends[0].bond),
        limit=given.get("limit"),
        breakaway=given.get("breakaway"),
        gap=given.get("gap"),
        gate=given.get("gate"),
        restitution=given.get("restitution"),
        stiffness=given.get("stiffness"),
        source=None if source is None else source.index,
        impulsive=bool(part.options.get("impulsive", False)),
    )


def _common(node: Node, variable: str) -> Expr:
    return Name(f"{variable}:{node.ends[0].bond}") if node.ends else Number(0.0)


_NOT_NEGATIVE = {
    "restitution": "0 (plastic) to 1 (elastic)",
    "limit": "the size of the friction force; its direction follows the motion",
    "stiffness": "a stiffness above zero; only the ratios between contacts matter",
}


def _check_values(given: Mapping[str, Expr], where: str) -> None:
    values = {k: e.value for k, e in given.items() if isinstance(e, Number)}
    wrong = hint = ""
    for option, advice in _NOT_NEGATIVE.items():
        if values.get(option, 0.0) < 0.0:
            wrong, hint = f"{option} = {values[option]:g} is negative", advice
    if "limit" in values and values.get("breakaway", values["limit"]) < values["limit"]:
        wrong = f"breakaway = {values['breakaway']:g} is below the limit, {values['limit']:g}"
        hint = "what breaks loose holds at least as much as what slides"
    if wrong:
        raise ModelError(wrong, code="HB-M203", where=where, hint=hint)


def law_warnings(machines: Iterable[Machine]) -> tuple[str, ...]:
    """Return what is allowed in laws but hardly meant: a restitution above 1."""
    found = []
    for machine in machines:
        eps = None if machine.law is None else machine.law.restitution
        # a warning is no part of the model: nothing is written down here of what it asks
        if isinstance(eps, Number) and plain(eps.value) > 1.0:
            found.append(
                f"restitution = {eps.value:g} of {machine.path!r} is above 1: "
                "it creates energy at each impact"
            )
    return tuple(found)


def warn_of_values(graph: FlatGraph) -> bool:
    """Whether warnings of laws speak of numbers that parameters write; what is asked is noted."""
    laws = (machine.law for machine in graph.machines if machine.law is not None)
    slots = [slot for law in laws if (slot := slot_of(law.restitution)) is not None]
    return any([eps > 1.0 for eps in slots])


def check_readers(graph: FlatGraph) -> None:
    """Refuse what the equations read of a law's branch: the branches are decided from them.

    Signals, and guards of machines written by hand, may read them.

    Raises
    ------
    ModelError
        HB-M204 for an element's law, or an option of a law, that does.
    """
    owner: dict[str, Machine] = {}
    for machine in graph.machines:
        if machine.law is not None:
            owner.update({f"in:{machine.index}:{k}": machine for k in range(len(machine.states))})
            owner.update({f"on:{n}": machine for n in machine.controls})
    if not owner:
        return
    read: list[tuple[str, Expr]] = [
        (node.path, e)
        for node in graph.nodes
        if node.law is not None and not node.implied
        for e in node.law.expressions
    ]
    for machine in graph.machines:
        if machine.law is not None:
            given = [(f"{machine.path}.{o}", getattr(machine.law, o)) for o in _READ]
            read += [(path, e) for path, e in given if e is not None]
    for path, e in read:
        for name in sorted(posterior_names(e)):
            if name in owner:
                raise ModelError(
                    f"{path} reads which branch the law of {owner[name].path!r} takes, "
                    "and that branch is decided from what is read",
                    code="HB-M204",
                    where=f"elements.{path}",
                    hint="read a variable (its effort or flow), or write a machine; "
                    "signals and guards may read the branch",
                )
