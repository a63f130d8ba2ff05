"""What a level looks like, read from the data alone: also while it means nothing yet."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from typing import Any

from hybond.draw.arrange import layout
from hybond.draw.sketch import typeset
from hybond.model.kinds import KINDS
from hybond.names import steps
from hybond.studio.chains import Link, links, node_of
from hybond.studio.levels import Data, Level, bonds_of, level_of, table
from hybond.studio.places import Places

_WORD = re.compile(r"(?<![\w.])[A-Za-z_]\w*(?:\[[^\[\]]*\])?(?:\.\w+)*")
LAID_OUT = 1500
"""Nodes up to which what has no place is laid out with care; beyond, in rows."""


def view(data: Data, path: str, shown: Places | None = None) -> dict[str, Any] | None:
    """Return nodes, bonds and signals of a level as the page draws them, None if it is gone.

    `shown` is where nodes were shown before: those that the data put nowhere stay there.

    Examples
    --------
    >>> data = {"elements": {"m": {"I": "2 kg"}, "v": {"junction": 1}},
    ...         "graph": {"bonds": ["v -> m"]}}
    >>> seen = view(data, "")
    >>> [(n["name"], n["kind"], n["says"]) for n in seen["nodes"]]
    [('m', 'I', '2 kg'), ('v', '1', '')]
    >>> seen["bonds"]
    [{'key': '0.0', 'tail': 'v', 'head': 'm', 'ends': ['v', 'm'], 'text': 'v -> m'}]
    """
    level = level_of(data, path)
    if level is None:
        return None
    elements = {k: v for k, v in table(level.data, "elements").items() if isinstance(v, dict)}
    written = links(bonds_of(level.data))
    bonds = [b for b in written if _ends(b, elements) <= elements.keys()]
    machines = _switched(level)
    places = _places(level, elements, bonds, shown or {})
    nodes = [_node(name, entry, data, path, machines, places) for name, entry in elements.items()]
    ports = {str(target): port for port, target in table(level.data, "ports").items()}
    for node in nodes:
        outside = [
            p
            for t, p in ports.items()
            if isinstance(t, str) and node_of(t, elements) == node["name"]
        ]
        if outside:
            node["outside"] = outside
    signals = _signal_nodes(level)
    return {
        "path": path,
        "name": level.name,
        "editable": level.editable,
        "crumbs": steps(path) if path else [],
        "domain": level.data.get("domain", "generic"),
        "nodes": nodes,
        "bonds": [_bond(b, elements) for b in bonds],
        "modulations": list(_modulations(level, elements, signals)),
        "signals": signals,
    }


def kind_of(entry: Mapping[str, Any]) -> str:
    """Return the kind of an element: a letter, a junction, ``part``, or ``?``."""
    for key in entry:
        if key == "junction":
            # not 1.0, and not true: a file says 0 or 1
            return str(entry[key]) if type(entry[key]) is int and entry[key] in (0, 1) else "?"
        if key == "submodel":
            return "part"
        if key in KINDS:
            return key
    return "?"


def _node(
    name: str,
    entry: Mapping[str, Any],
    data: Data,
    path: str,
    machines: Mapping[str, str],
    places: Mapping[str, tuple[float, float]],
) -> dict[str, Any]:
    kind = kind_of(entry)
    x, y = places[name]
    node: dict[str, Any] = {"name": name, "kind": kind, "x": x, "y": y, "entry": dict(entry)}
    if kind == "part":
        inner = level_of(data, f"{path}.{name}" if path else name)
        node["letters"] = str(entry["submodel"]).rpartition(".")[2]
        node["says"] = _given(entry)
        node["ports"] = [] if inner is None else list(table(inner.data, "ports"))
        node["inputs"] = [] if inner is None else list(table(inner.data, "inputs"))
        node["known"] = inner is not None
    else:
        node["letters"] = KINDS[kind].symbol if kind in KINDS else "?"
        node["says"] = typeset(_value(kind, entry))
        if isinstance(entry.get("law"), str):
            node["law"] = entry["law"]
    if name in machines:
        node["machine"] = machines[name]
    return node


def _value(kind: str, entry: Mapping[str, Any]) -> str:
    value = entry.get("label", entry.get(kind))
    if kind in ("0", "1", "?") or value is None:
        return ""
    if isinstance(value, dict) and len(value) == 1:
        ((output, law),) = value.items()
        value = f"{output} = {law}" if isinstance(law, str) else f"{output} = …"
    elif isinstance(value, list):
        value = f"field, {len(value)} ports"
    return f"G = {value}" if kind == "G" else str(value)


def _given(entry: Mapping[str, Any]) -> str:
    given = [str(v) for v in table(dict(entry), "parameters").values()]
    return ", ".join(given[:2]) + (", …" if len(given) > 2 else "")


def _ends(link: Link, elements: Mapping[str, Any]) -> set[str]:
    return {node_of(link.tail, elements), node_of(link.head, elements)}


def _bond(link: Link, elements: Mapping[str, Any]) -> dict[str, Any]:
    text = f"{link.tail} -> {link.head}"
    return {
        "key": link.key,
        "tail": node_of(link.tail, elements),
        "head": node_of(link.head, elements),
        "ends": [link.tail, link.head],
        "text": f"{link.label}: {text}" if link.label else text,
    }


def _switched(level: Level) -> dict[str, str]:
    """Return the machine of each node that one switches."""
    found = {}
    for name, machine in table(level.data, "machines").items():
        states = machine.get("states") if isinstance(machine, dict) else None
        for on in states.values() if isinstance(states, dict) else ():
            for node in on if isinstance(on, list) else ():
                found[node_of(str(node), level.data.get("elements", ()))] = name
    return found


def _places(
    level: Level, elements: Mapping[str, Any], bonds: Sequence[Link], shown: Places
) -> dict[str, tuple[float, float]]:
    """Return where each node stands, in cells: as written, as shown, else as a drawing has it."""
    given = {name: at for name, at in shown.items() if name in elements}
    for name, at in table(level.data, "layout").items():
        numbers = isinstance(at, list) and len(at) == 2
        numbers = numbers and all(isinstance(v, int | float) and abs(v) < FARTHEST for v in at)
        if name in elements and numbers:
            given[name] = (float(at[0]), float(at[1]))
    if len(given) == len(elements):
        return given
    names = list(elements)
    number = {name: k for k, name in enumerate(names)}
    kinds = tuple("TF" if (k := kind_of(e)) in ("part", "?") else k for e in elements.values())
    ends = [(node_of(b.tail, number), node_of(b.head, number)) for b in bonds]
    pairs = tuple((number[tail], number[head]) for tail, head in ends)
    pins = tuple((number[name], at) for name, at in given.items())
    return dict(zip(names, _laid_out(kinds, pairs, pins), strict=True))


FARTHEST = 1e6
"""Cells from the middle at which something may be put down, as `edits` has it."""


@lru_cache(maxsize=64)
def _laid_out(
    kinds: tuple[str, ...],
    bonds: tuple[tuple[int, int], ...],
    pins: tuple[tuple[int, tuple[float, float]], ...],
) -> tuple[tuple[float, float], ...]:
    straight = tuple(b for b in bonds if b[0] != b[1])
    if len(kinds) - len(pins) > LAID_OUT:
        width = max(8, int((2 * len(kinds)) ** 0.5))
        free = {k: (float(k % width), float(k // width)) for k in range(len(kinds))}
        return tuple({**free, **dict(pins)}[k] for k in range(len(kinds)))
    return layout(kinds, straight, pinned=dict(pins))


def _signal_nodes(level: Level) -> list[dict[str, Any]]:
    """Return signals and inputs that have a place of their own in lists and as sources."""
    found = []
    for section in ("inputs", "signals"):
        for name, entry in table(level.data, section).items():
            text = entry if isinstance(entry, str | int | float) else _words(entry)
            found.append({"name": name, "section": section, "text": str(text)})
    return found


def _words(entry: Any) -> str:
    if not isinstance(entry, dict):
        return "…"
    return ", ".join(f"{k} = {v}" for k, v in entry.items() if not isinstance(v, dict | list))


def _modulations(
    level: Level, elements: Mapping[str, Any], signals: Sequence[Mapping[str, Any]]
) -> Iterator[dict[str, str]]:
    """Yield which element reads which: through its law, signals, or an input that is given.

    A signal is followed to the elements that it reads.
    """
    sections = {s["name"]: table(level.data, s["section"])[s["name"]] for s in signals}

    def sources(value: Any, seen: frozenset[str]) -> Iterator[str]:
        for word in _read(value):
            head = node_of(word, elements)
            if head in elements:
                if "." in word.rpartition("]")[2]:
                    yield head
            elif head in sections and head not in seen:
                yield from sources(sections[head], seen | {head})

    for name, entry in elements.items():
        own = {k: v for k, v in entry.items() if k not in ("submodel", "parameters", "domain")}
        for source in sorted(set(sources(own, frozenset())) - {name}):
            yield {"from": source, "to": name}


def _read(value: Any) -> Iterator[str]:
    if isinstance(value, str):
        yield from _WORD.findall(value)
    elif isinstance(value, dict):
        for v in value.values():
            yield from _read(v)
    elif isinstance(value, list):
        for v in value:
            yield from _read(v)
