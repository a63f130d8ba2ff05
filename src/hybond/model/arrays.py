"""Arrays: ``"cell[1..n]"`` stands for n of what is written beside it, ``cell[3]`` for one of them.

Elements, signals, inputs, machines and ports may be arrays. What is said of the members may read
their index, which is called ``i`` unless the array names it: ``"cell[k = 1..n]"``. A model keeps
what is written; members are made while it is flattened. Ranges in a bond run together: bond by
bond, each end that has a range takes its next member.
"""

from __future__ import annotations

import copy
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Any

from hybond.errors import ModelError
from hybond.model.builder import Model
from hybond.model.expressions import Number
from hybond.model.indices import INSIDE, one, span, spread
from hybond.model.parts import MachinePart, Part, SubmodelPart
from hybond.model.scope import Scope
from hybond.names import join
from hybond.records import dataclass

INDEX = "i"
"""What the index is called, unless an array says otherwise."""
_KEY = r"(?P<name>[A-Za-z_]\w*)\[\s*(?:(?P<index>[A-Za-z_]\w*)\s*=)?(?P<inside>[^\[\]=]+)\]\Z"


@dataclass(frozen=True, slots=True)
class Member:
    """One member of an array, or what is no array.

    Parameters
    ----------
    name : str
        As paths have it: ``cell[3]``.
    scope : Scope
        What its texts are read in: the index is a parameter there.
    place : int or None
        Which member it is, from 0; None for what is no array.
    count : int
        How many there are.
    """

    name: str
    scope: Scope
    place: int | None = None
    count: int = 1


def is_array(key: str) -> bool:
    """Whether a key stands for members rather than for one thing.

    Examples
    --------
    >>> is_array("cell[1..10]"), is_array("cell")
    (True, False)
    """
    return "[" in key


def base_of(key: str) -> str:
    """Return the name of an array, or of a member, or what is neither as it is.

    Examples
    --------
    >>> base_of("cell[k = 1..n]"), base_of("cell[3]"), base_of("c")
    ('cell', 'cell', 'c')
    """
    return key.partition("[")[0]


def parts_of(key: str) -> tuple[str, str, str, str] | None:
    """Return name, name of the index, first and last index as written; None for what is no key.

    Examples
    --------
    >>> parts_of("cell[k = 2..n-1]"), parts_of("cell[3]"), parts_of("cell[]")
    (('cell', 'k', '2', 'n-1'), ('cell', 'i', '3', '3'), None)
    """
    match = re.match(_KEY, key, re.ASCII)
    if match is None:
        return None
    first, dots, last = (part.strip() for part in match["inside"].partition(".."))
    if not first or (dots and not last):
        return None
    return match["name"], match["index"] or INDEX, first, last or first


def members(key: str, scope: Scope, where: str) -> Iterator[Member]:
    """Yield the members of a key; what is no array is its own only member.

    Raises
    ------
    ModelError
        HB-M103 for a key that is none, HB-M152 for its bounds, HB-M104 where the index has the name
        of something else that its texts may read.

    Examples
    --------
    >>> import hybond as hb
    >>> scope = Scope("", hb.Model(), {"n": Number(3.0)})
    >>> [m.name for m in members("cell[1..n]", scope, "")]
    ['cell[1]', 'cell[2]', 'cell[3]']
    """
    if "[" not in key:
        yield Member(key, scope)
        return
    found = parts_of(key)
    if found is None:
        raise ModelError(
            f"{key!r} is no array", code="HB-M103", where=where, hint='write "cell[1..10]"'
        )
    name, index, first, last = found
    model = scope.model
    for what, group in (
        *(("parameter", scope.parameters), ("signal", model.signals), ("input", model.inputs)),
    ):
        if index in group:
            raise ModelError(
                f"the index of {key!r} is called {index!r}, and so is a {what}",
                code="HB-M104",
                where=where,
                hint=f'call the index otherwise: "{name}[k = {first}..{last}]"',
            )
    for place, k in enumerate(indices := span(f"{first}..{last}", scope, where)):
        own = Scope(scope.prefix, model, {**scope.parameters, index: Number(float(k))}, index)
        yield Member(f"{name}[{k}]", own, place, len(indices))


def of_member(part: Any, member: Member, where: str) -> Any:
    """Return the part of one member: lists give each its value, names with an index one name.

    Raises
    ------
    ModelError
        HB-M155 for a list that has not one value for each member.
    """
    if member.place is None:
        return part

    def own(value: Any) -> Any:
        if not isinstance(value, list | tuple):
            return value
        if len(value) != member.count:
            raise ModelError(
                f"{len(value)} values for the {member.count} members of an array",
                code="HB-M155",
                where=where,
                hint="give one value for each member, or one for all that reads the index",
            )
        return value[member.place or 0]

    found = _with_own(part, own)
    if isinstance(found, Part) and "pair" in found.options:
        pair = one(str(found.options["pair"]), member.scope, where)
        return replace(found, options={**found.options, "pair": pair})
    return found


def _with_own(part: Any, own: Callable[[Any], Any]) -> Any:
    """Return a part with what `own` makes of each of its values; a matrix is one value."""
    if isinstance(part, SubmodelPart):
        given = {k: own(v) for k, v in part.parameters.items()}
        inputs = {k: own(v) for k, v in part.inputs.items()}
        return replace(part, parameters=given, inputs=inputs)
    if isinstance(part, Part):
        field = _is_matrix(part.value) or _gives_list(part.value)
        options = {k: v if field else own(v) for k, v in part.options.items()}
        value = part.value if _is_matrix(part.value) else own(part.value)
        return replace(part, value=value, options=options)
    return part


def _is_matrix(value: Any) -> bool:
    return isinstance(value, list | tuple) and any(isinstance(row, list | tuple) for row in value)


def _gives_list(value: Any) -> bool:
    """Whether the law is that of a field."""
    return isinstance(value, Mapping) and any(isinstance(v, list | tuple) for v in value.values())


def each(
    written: Mapping[str, Any], scope: Scope, section: str, arrays: dict[str, list[int]]
) -> Iterator[tuple[str, Any, Scope]]:
    """Yield what a section has by name, arrays member by member, with the scope of its texts.

    Parameters
    ----------
    written : mapping
        Names and arrays to parts.
    section : str
        Which section of the model it is.
    arrays : dict
        The indices of each array by path: those of this section are added.

    Raises
    ------
    ModelError
        HB-M104 where two members have one name, and those of `members` and `of_member`.
    """
    checked: set[str] = set()
    for key, part in written.items():
        if not is_array(key):
            yield key, part, scope
            continue
        where = join(scope.prefix, "" if section == "elements" else section, key)
        base = base_of(key)
        if base not in checked and section != "ports":
            _check_taken(base, written, scope, where)
        checked.add(base)
        indices = arrays.setdefault(join(scope.prefix, base), [])
        known = set() if section == "ports" else set(indices)
        for member in members(key, scope, where):
            index = int(member.name[len(base) + 1 : -1])
            if index in known:
                raise _twice(member.name, where)
            indices.append(index)
            yield member.name, of_member(part, member, where), member.scope


def _check_taken(base: str, written: Mapping[str, Any], scope: Scope, where: str) -> None:
    model = scope.model
    for group in (model.elements, model.signals, model.inputs, model.machines, model.blocks):
        if base in group or (group is not written and any(base_of(k) == base for k in group)):
            raise _twice(base, where)
    if base in scope.parameters:
        raise _twice(base, where)


def _twice(name: str, where: str) -> ModelError:
    return ModelError(
        f"the name {name!r} is used twice", code="HB-M104", where=where, hint="rename one"
    )


def switching(machine: MachinePart, scope: Scope, where: str) -> MachinePart:
    """Return a machine with the junctions that its states list one by one."""
    if not any("[" in name for on in machine.states.values() for name in on):
        return machine
    states = {
        state: tuple(n for name in on for n in spread(name, scope, f"{where}.states.{state}"))
        for state, on in machine.states.items()
    }
    return replace(machine, states=states)


def index_texts(model: Model) -> Iterator[str]:
    """Yield the expressions by which arrays and ranges of a model are counted.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model()
    >>> m.add({"c[1..n]": hb.C("1 mF")})
    >>> m.bond("c[1..n-1] -> c[2..n]")
    >>> list(index_texts(m))
    ['1', 'n', '1', 'n-1', '2', 'n']
    """
    for section in (model.elements, model.signals, model.inputs, model.machines, model.ports):
        for key in section:
            found = parts_of(key) if is_array(key) else None
            if found is not None:
                yield from found[2:]
    for text in model.bonds:
        for inside in INSIDE.findall(text) if "[" in text else ():
            yield from inside.split("..")
    for machine in model.machines.values():
        for inside in (i for on in machine.states.values() for n in on for i in INSIDE.findall(n)):
            yield from inside.split("..")


def with_member_apart(model: Model, name: str) -> Model:
    """Return a copy of a model in which one member of an array stands on its own.

    Arrays are cut in three, ``c[1..3-1]``, ``c[3]``, ``c[3+1..n]``: what is said of the member can
    then be changed. The same model comes back if it has no such array, or not with that member.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model()
    >>> m.add({"c[1..n]": hb.C("1 mF")})
    >>> list(with_member_apart(m, "c[3]").elements)
    ['c[1..3-1]', 'c[3]', 'c[3+1..n]']
    """
    base, k = base_of(name), name.partition("[")[2].rstrip("]")
    for section in ("elements", "signals", "inputs", "machines"):
        group = getattr(model, section)
        for key in group:
            found = parts_of(key) if base_of(key) == base else None
            pieces = _cut(found, k, group[key]) if found is not None else {}
            if pieces:
                new = copy.copy(model)
                changed: dict[str, Any] = {}
                for other, part in group.items():
                    changed.update(pieces if other == key else {other: part})
                setattr(new, section, changed)
                return new
    return model


def _cut(key: tuple[str, str, str, str], k: str, part: Any) -> dict[str, Any]:
    """Return an array in pieces around one member, nothing if it has no such member."""
    name, index, first, last = key
    known = all(text.isdecimal() for text in (first, last))
    if not k.isdecimal() or (known and not int(first) <= int(k) <= int(last)):
        return {}
    ranges = (f"{first}..{k}-1", k, f"{k}+1..{last}")
    start = int(first) if first.isdecimal() else 0
    cuts: tuple[slice | int, ...] = (
        slice(0, int(k) - start),
        int(k) - start,
        slice(int(k) - start + 1, None),
    )
    other = "" if index == INDEX else f"{index} = "
    own = f"{name}[{other}{k}]" if other else f"{name}[{k}]"
    keys = (f"{name}[{other}{ranges[0]}]", own, f"{name}[{other}{ranges[2]}]")
    return {key: _piece(part, cut) for key, cut in zip(keys, cuts)}


def _piece(part: Any, cut: slice | int) -> Any:
    """Return what is said of some of the members, where lists give each a value."""

    def own(value: Any) -> Any:
        if isinstance(value, list | tuple) and not _is_matrix(value):
            return value[cut] if isinstance(cut, slice) else [value[cut]]
        return value

    return _with_own(part, own)
