"""Bonds as they are written, ``"a -> b -> c"``, and what editing does to them."""

from __future__ import annotations

import re
from collections.abc import Collection
from dataclasses import dataclass
from itertools import pairwise

from hybond.model.arrays import base_of, is_array
from hybond.names import steps

_CHAIN = re.compile(r"\s*(?:([A-Za-z_]\w*)\s*:)?(.+)\Z", re.DOTALL)


@dataclass(frozen=True, slots=True)
class Link:
    """One bond of a chain: the `arrow`-th of the text with the number `chain`."""

    chain: int
    arrow: int
    tail: str
    head: str
    label: str = ""

    @property
    def key(self) -> str:
        """What the page calls it."""
        return f"{self.chain}.{self.arrow}"


def links(bonds: list[str]) -> list[Link]:
    """Return the bonds one by one; a text that is none gives none.

    Examples
    --------
    >>> [(b.key, b.tail, b.head) for b in links(["a -> b -> c.plus", "x: c -> d", "what"])]
    [('0.0', 'a', 'b'), ('0.1', 'b', 'c.plus'), ('1.0', 'c', 'd')]
    """
    found = []
    for k, text in enumerate(bonds):
        label, ends = _split(text)
        found += [Link(k, j, a, b, label) for j, (a, b) in enumerate(pairwise(ends))]
    return found


def _split(text: str) -> tuple[str, list[str]]:
    match = _CHAIN.match(text)
    if match is None:
        return "", []
    ends = [e.strip() for e in match[2].split("->")]
    return match[1] or "", ends if len(ends) > 1 and all(ends) else []


def _join(label: str, ends: list[str]) -> str:
    return (f"{label}: " if label else "") + " -> ".join(ends)


def node_of(end: str, known: Collection[str] = ()) -> str:
    """Return the node that an end names, less its port: the first part of the path.

    What is in brackets is a member of an array, or several: the array is meant, if it is `known`.

    Examples
    --------
    >>> node_of("motor.shaft"), node_of("v"), node_of("c[2..n].in", ["v", "c[1..n]"])
    ('motor', 'v', 'c[1..n]')
    """
    if "[" not in end:
        return end.partition(".")[0]
    first = steps(end)[0]
    if first in known:
        return first
    return next((k for k in known if is_array(k) and base_of(k) == base_of(first)), first)


def without(bonds: list[str], keys: Collection[str]) -> list[str]:
    """Return the bonds less some, chains cut where one is gone.

    Examples
    --------
    >>> without(["a -> b -> c -> d", "e -> f"], {"0.1"})
    ['a -> b', 'c -> d', 'e -> f']
    """
    kept = []
    for k, text in enumerate(bonds):
        label, ends = _split(text)
        if not any(f"{k}.{j}" in keys for j in range(len(ends) - 1)):
            kept.append(text)
            continue
        run = [ends[0]]
        for j, end in enumerate(ends[1:]):
            if f"{k}.{j}" in keys:
                kept += [_join(label, run)] if len(run) > 1 else []
                run = [end]
            else:
                run.append(end)
        kept += [_join(label, run)] if len(run) > 1 else []
    return kept


def reversed_bonds(bonds: list[str], keys: Collection[str]) -> list[str]:
    """Return the bonds with some turned round; a chain is cut at these.

    Examples
    --------
    >>> reversed_bonds(["a -> b -> c", "x: d -> e"], {"0.0", "1.0"})
    ['b -> a', 'b -> c', 'x: e -> d']
    """
    found = []
    for k, text in enumerate(bonds):
        label, ends = _split(text)
        turned = [j for j in range(len(ends) - 1) if f"{k}.{j}" in keys]
        if not turned:
            found.append(text)
            continue
        run = [ends[0]]
        for j, (a, b) in enumerate(pairwise(ends)):
            if j not in turned:
                run.append(b)
                continue
            found += [_join(label, run)] if len(run) > 1 else []
            found.append(_join(label, [b, a]))
            run = [b]
        found += [_join(label, run)] if len(run) > 1 else []
    return found


def renamed(bonds: list[str], names: dict[str, str]) -> list[str]:
    """Return the bonds with nodes renamed.

    Examples
    --------
    >>> renamed(["a -> b.plus", "a: a -> c"], {"a": "x", "b": "y"})
    ['x -> y.plus', 'a: x -> c']
    >>> renamed(["c[1..n-1].out -> c[2..n]"], {"c[1..n]": "d[1..n]"})
    ['d[1..n-1].out -> d[2..n]']
    """
    found = []
    for text in bonds:
        label, ends = _split(text)
        if not any(node_of(e, names) in names for e in ends):
            found.append(text)
            continue
        moved = []
        for e in ends:
            node, new = steps(e)[0], names.get(node_of(e, names))
            if new is not None and node not in names:
                new = base_of(new) + node[len(base_of(node)) :]  # an array keeps its ranges
            moved.append((node if new is None else new) + e[len(node) :])
        found.append(_join(label, moved))
    return found
