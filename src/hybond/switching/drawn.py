"""Bonds as they are drawn, and machines as they are written: what all formalisms share."""

from __future__ import annotations

import copy
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from hybond.errors import ModelError
from hybond.model.builder import Model
from hybond.model.parts import Part, SubmodelPart
from hybond.names import did_you_mean

_LABEL = re.compile(r"\s*(?:(?P<label>[A-Za-z_]\w*)\s*:)?(?P<chain>.+)\Z", re.DOTALL)


@dataclass(frozen=True, slots=True)
class DrawnBond:
    """One bond of a text: its label, if any, and the names at its ends."""

    label: str
    tail: str
    head: str

    def touches(self, name: str) -> bool:
        """Whether the bond ends at `name` or at one of its numbered ports."""
        return _is(self.tail, name) or _is(self.head, name)

    def other(self, name: str) -> str:
        """Return the end that is not `name`."""
        return self.head if _is(self.tail, name) else self.tail

    def moved(self, name: str, target: str) -> DrawnBond:
        """Return the bond with its end at `name` put at `target`."""
        if _is(self.tail, name):
            return replace(self, tail=target)
        return replace(self, head=target)

    def cut(self, name: str, *middle: str) -> list[DrawnBond]:
        """Return the chain along the arrow through the nodes `middle`, one end being `name`.

        The label stays with the piece at the other end.
        """
        pieces = [DrawnBond("", a, b) for a, b in pairwise([self.tail, *middle, self.head])]
        outer = -1 if _is(self.tail, name) else 0
        pieces[outer] = replace(pieces[outer], label=self.label)
        return pieces

    def __str__(self) -> str:
        return (f"{self.label}: " if self.label else "") + f"{self.tail} -> {self.head}"


def _is(end: str, name: str) -> bool:
    return end == name or (end.startswith(f"{name}.") and end[len(name) + 1 :].isdigit())


def drawn(bonds: str | Iterable[str], where: str) -> list[DrawnBond]:
    """Return the bonds of one or several chains.

    Raises
    ------
    ModelError
        HB-M109 for a text that is not a bond.

    Examples
    --------
    >>> [str(b) for b in drawn("a -> sw -> b", "sw")]
    ['a -> sw', 'sw -> b']
    """
    found: list[DrawnBond] = []
    for text in [bonds] if isinstance(bonds, str) else bonds:
        match = _LABEL.match(text)
        ends = [] if match is None else [e.strip() for e in match["chain"].split("->")]
        label = "" if match is None else match["label"] or ""
        if len(ends) < 2 or not all(ends) or (label and len(ends) > 2):
            raise ModelError(
                f"{text!r} is not a bond",
                code="HB-M109",
                where=where,
                hint='write "a -> b", "a -> b -> c" or "b3: a -> b"',
            )
        found += [DrawnBond(label, a, b) for a, b in pairwise(ends)]
    return found


def bonds_of(name: str, bonds: str | Iterable[str], *, count: int | None) -> list[DrawnBond]:
    """Return the drawn bonds, all of which end at `name`.

    Raises
    ------
    ModelError
        HB-M190 if one does not, or there are not `count` of them.
    """
    found = drawn(bonds, name)
    stray = [str(b) for b in found if not b.touches(name)]
    if stray or (count is not None and len(found) != count):
        wanted = "its bonds" if count is None else "one bond" if count == 1 else f"{count} bonds"
        example = f'"a -> {name}"' if count == 1 else f'"a -> {name} -> b"'
        raise ModelError(
            f"the bond {stray[0]!r} does not end at {name!r}"
            if stray
            else f"a switch like {name!r} has {count} bond{'s' if count != 1 else ''}, "
            f"{len(found)} are drawn",
            code="HB-M190",
            where=name,
            hint=f"draw {wanted}, such as {example}",
        )
    return found


def choice(value: str, allowed: Sequence[str], where: str) -> str:
    """Return `value` if it is one of `allowed`; HB-M191 if not."""
    if value not in allowed:
        raise ModelError(
            f"{value!r} is not a choice here",
            code="HB-M191",
            where=where,
            hint=f"one of {', '.join(repr(a) for a in allowed)}",
        )
    return value


def states_of(m: Model, machine: str, on: str | Sequence[str], where: str) -> tuple[str, ...]:
    """Return the states that `on` names, checked; HB-M144 for a machine or state unknown."""
    part = m.machines.get(machine)
    if part is None:
        raise ModelError(
            f"no machine {machine!r}: a switch needs its machine first",
            code="HB-M144",
            where=where,
            hint=did_you_mean(machine, m.machines) or "add it with m.machine(...)",
        )
    states = (on,) if isinstance(on, str) else tuple(on)
    for state in states:
        if state not in part.states:
            raise ModelError(
                f"{machine!r} has no state {state!r}",
                code="HB-M144",
                where=where,
                hint=did_you_mean(state, part.states),
            )
    if not states:
        raise ModelError(
            f"no state of {machine!r} is named, so nothing would be switched",
            code="HB-M144",
            where=where,
            hint="name the states in which it is ON",
        )
    return states


def switch_on(m: Model, machine: str, states: Iterable[str], *nodes: str) -> None:
    """List `nodes` in these states of a machine, behind what they list already."""
    part = m.machines[machine]
    chosen = set(states)
    lists = {k: (*v, *nodes) if k in chosen else tuple(v) for k, v in part.states.items()}
    m.machines[machine] = replace(part, states=lists)


def add_all(m: Model, parts: Mapping[str, Part | SubmodelPart], bonds: Iterable[DrawnBond]) -> None:
    """Add parts and bonds; nothing is added if a name is taken."""
    for name in parts:
        m._new_name(name)
    m.add(**parts)
    m.bond(*(str(b) for b in bonds))


def copied(m: Model) -> Model:
    """Return a model that shares no list or table with `m`."""
    new = copy.copy(m)
    for key, value in vars(m).items():
        if isinstance(value, dict | list):
            setattr(new, key, value.copy())
    return new


def kind_at(m: Model, end: str) -> str:
    """Return the kind of the node that a bond's end means, or "" if it is not there."""
    head, _, rest = end.partition(".")
    if head in m.ports:
        return kind_at(m, m.ports[head])
    part = m.elements.get(head)
    if isinstance(part, Part):
        return part.kind
    if isinstance(part, SubmodelPart):
        inner = part.model if isinstance(part.model, Model) else m.models.get(part.model)
        return kind_at(inner, rest) if inner is not None and rest else ""
    return ""
