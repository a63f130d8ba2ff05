"""Edits: from the data of a model file and what a gesture says to the data after it.

Each gesture of the page is one edit, and one step of undo: deleting an element takes its bonds
along. An edit never changes the data it is given, and refuses what it cannot do.
"""

from __future__ import annotations

import copy
import re
from collections.abc import Callable, Mapping
from typing import Any

from hybond.errors import UsageError
from hybond.files import limits
from hybond.model.arrays import base_of, is_array, parts_of
from hybond.model.builder import RESERVED
from hybond.studio.chains import links, node_of, renamed, reversed_bonds, without
from hybond.studio.levels import Data, Level, bonds_of, level_of, table

Message = Mapping[str, Any]

NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]{0,63}\Z")
BY_NAME = ("elements", "signals", "inputs", "machines", "blocks")
"""What has a name that expressions may read."""
LONGEST = 100_000
"""Letters of a text that an edit brings."""


def apply(data: Data, edit: Message) -> Data:
    """Return the data after an edit.

    Parameters
    ----------
    data : dict
        Of a model file.
    edit : mapping
        ``do`` names it; ``level`` is the path of the submodel that is open; ``keep``, places of
        elements that have none, is written with it.

    Raises
    ------
    UsageError
        HB-W101 for an edit that cannot be done.

    Examples
    --------
    >>> data = {"hybond": 1, "elements": {"v": {"junction": 1}}}
    >>> after = apply(data, {"do": "add", "element": {"I": "1 kg"}, "at": [1, 0], "name": "m"})
    >>> after["elements"]["m"], data["elements"]
    ({'I': '1 kg'}, {'v': {'junction': 1}})
    """
    done = EDITS.get(str(edit.get("do")))
    if done is None:
        raise refused(f"there is no edit {edit.get('do')!r}", hint=", ".join(EDITS))
    new = copy.deepcopy(data)
    level = level_of(new, str(edit.get("level") or ""))
    if level is None:
        raise refused("there is no such submodel", where=str(edit.get("level")))
    if not level.editable:
        raise refused(
            f"{level.name or level.path} is not said in this file",
            where=level.path,
            hint="a ready part is changed by its parameters; or copy it into the file",
        )
    done(level, edit)
    _keep(level, edit.get("keep"))
    return new


def _keep(level: Level, places: Any) -> None:
    """Write where the others were shown: what is put down by hand must not move them later."""
    elements = table(level.data, "elements")
    for name, at in places.items() if isinstance(places, dict) else ():
        if name in elements and name not in table(level.data, "layout"):
            _section(level, "layout")[name] = _place(at)


def refused(why: str, *, where: str = "", hint: str = "") -> UsageError:
    """Return the refusal of an edit."""
    hint = hint or "undo brings back what was"
    return UsageError(why, code="HB-W101", where=where or "edit", hint=hint)


def edit_of(message: Message) -> Data:
    """Return the edit of a message; HB-W101 if there is none."""
    edit = message.get("edit")
    if not isinstance(edit, dict):
        raise refused("there is no edit", hint='say what to do: {"do": "add", "element": {"R": 1}}')
    return edit


def fresh(taken: Mapping[str, Any] | set[str], stem: str) -> str:
    """Return a name that is not taken: ``R``, ``R1``, ``R2``.

    Examples
    --------
    >>> fresh({"R": 1, "R1": 1}, "R"), fresh(set(), "C")
    ('R2', 'C')
    """
    if stem not in taken and stem not in RESERVED:
        return stem
    stem = stem.rstrip("0123456789") or "x"
    return next(n for k in range(1, 10**6) if (n := f"{stem}{k}") not in taken)


def _taken(level: Level) -> set[str]:
    return {name for section in BY_NAME for name in table(level.data, section)}


def _section(level: Level, *keys: str) -> Data:
    at = level.data
    for key in keys:
        at = at.setdefault(key, {})
        if not isinstance(at, dict):
            raise refused(f"{key} is no table", where=key, hint="mend it in the text")
    return at


def _name(level: Level, text: object, where: str) -> str:
    name = str(text)
    array = is_array(name) and parts_of(name) is not None and len(name) < 128
    if not NAME.match(base_of(name) if array else name) or name in RESERVED:
        raise refused(
            f"{name!r} cannot be a name",
            where=where,
            hint="letters, digits and _, not beginning with a digit",
        )
    if name in _taken(level):
        raise refused(f"{name!r} is taken", where=where, hint="take another name")
    return name


def _add(level: Level, edit: Message) -> None:
    element = edit.get("element")
    if not isinstance(element, dict):
        raise refused("there is no element to add")
    stem = str(edit.get("stem") or "x")
    name = _name(level, edit.get("name") or fresh(_taken(level), stem), "name")
    _section(level, "elements")[name] = element
    if edit.get("at") is not None:
        _section(level, "layout")[name] = _place(edit["at"])
    for tail, head in ((edit.get("from"), name), (name, edit.get("to"))):
        if tail and head:
            _bond(level, {"tail": tail, "head": head})


def _place(at: Any) -> list[float]:
    try:
        x, y = (round(float(v), 3) for v in at)
    except (TypeError, ValueError):
        raise refused(f"{at!r} is no place", where="layout") from None
    if not (abs(x) < 1e6 and abs(y) < 1e6):
        raise refused(f"{at!r} is no place", where="layout")
    return [int(v) if v == int(v) else v for v in (x, y)]


def _remove(level: Level, edit: Message) -> None:
    names = {str(n) for n in edit.get("names", ())}
    keys = {str(k) for k in edit.get("bonds", ())}
    bonds = bonds_of(level.data)
    elements = table(level.data, "elements")
    for b in links(bonds):
        if {node_of(b.tail, elements), node_of(b.head, elements)} & names:
            keys.add(b.key)
    if keys:
        _section(level, "graph")["bonds"] = without(bonds, keys)
    for section in ("elements", "layout", "machines", "signals", "inputs", "blocks"):
        held = table(level.data, section)
        for name in names & held.keys():
            del held[name]
        if section in level.data and not held:
            del level.data[section]
    for machine in table(level.data, "machines").values():
        states = table(machine, "states") if isinstance(machine, dict) else {}
        for state, on in states.items():
            states[state] = [n for n in on if n not in names] if isinstance(on, list) else on


def _move(level: Level, edit: Message) -> None:
    layout = _section(level, "layout")
    at = edit.get("at")
    for name, place in at.items() if isinstance(at, dict) else ():
        layout[str(name)] = _place(place)


def _bond(level: Level, edit: Message) -> None:
    tail, head = str(edit.get("tail", "")).strip(), str(edit.get("head", "")).strip()
    elements = table(level.data, "elements")
    for end in (tail, head):
        if node_of(end, elements) not in elements:
            raise refused(f"there is no element {end!r}", where="graph.bonds")
    if tail == head:
        raise refused("a bond joins two elements", where="graph.bonds")
    graph = _section(level, "graph")
    graph["bonds"] = [*bonds_of(level.data), f"{tail} -> {head}"]


def _reverse(level: Level, edit: Message) -> None:
    keys = {str(k) for k in edit.get("bonds", ())}
    _section(level, "graph")["bonds"] = reversed_bonds(bonds_of(level.data), keys)


def _write_bond(level: Level, edit: Message) -> None:
    """Set the text of one chain, or add one; an empty text takes it out."""
    bonds, k, text = bonds_of(level.data), edit.get("chain"), str(edit.get("text", "")).strip()
    if isinstance(k, int) and 0 <= k < len(bonds):
        bonds[k : k + 1] = [text] if text else []
    elif text:
        bonds.append(text)
    _section(level, "graph")["bonds"] = bonds


def _rename(level: Level, edit: Message) -> None:
    old, new = str(edit.get("old")), edit.get("new")
    section = next((s for s in (*BY_NAME, "parameters") if old in table(level.data, s)), None)
    if section is None:
        raise refused(f"there is no {old!r}", where=old)
    if new == old:
        return
    name = _name(level, new, old)
    for key in (section, "layout"):
        if old in table(level.data, key):
            level.data[key] = {name if k == old else k: v for k, v in level.data[key].items()}
    if section == "elements":
        graph = table(level.data, "graph")
        if "bonds" in graph:
            graph["bonds"] = renamed(bonds_of(level.data), {old: name})
    if is_array(old) != is_array(name):
        raise refused("an array stays one", where=old, hint="change it in the text")
    word, word_of = _word(old), base_of(name)
    for key in ("elements", "signals", "inputs", "blocks", "parameters", "experiment"):
        if key in level.data:
            level.data[key] = _replaced(level.data[key], word, word_of)
    for machine in table(level.data, "machines").values():
        _rename_in_machine(machine, word, word_of)
    ports = table(level.data, "ports")
    for port, target in ports.items():
        if isinstance(target, str) and node_of(target, (old,)) == old:
            ports[port] = base_of(name) + target[len(base_of(old)) :]


def _word(name: str) -> re.Pattern[str]:
    """Return what finds a name in a text: of an array, before its brackets."""
    end = r"(?=\[)" if is_array(name) else r"(?!\w)"
    return re.compile(rf"(?<![\w.]){re.escape(base_of(name))}{end}")


def _replaced(value: Any, what: re.Pattern[str], by: str) -> Any:
    """Return data with a pattern replaced in all its texts; keys stay."""
    if isinstance(value, str):
        return what.sub(by, value)
    if isinstance(value, list):
        return [_replaced(v, what, by) for v in value]
    if isinstance(value, dict):
        return {
            k: v if k in ("submodel", "title", "domain") else _replaced(v, what, by)
            for k, v in value.items()
        }
    return value


def _rename_in_machine(machine: Any, word: re.Pattern[str], name: str) -> None:
    """Rename what a machine controls and reads; its states are words of its own."""
    if not isinstance(machine, dict):
        return
    machine["states"] = _replaced(machine.get("states", {}), word, name)
    rules = machine.get("rules")
    if isinstance(rules, list):
        parts = [r.partition(" when ") if isinstance(r, str) else (r, "", "") for r in rules]
        machine["rules"] = [a + b + word.sub(name, c) if b else a for a, b, c in parts]


def _rename_state(level: Level, edit: Message) -> None:
    """Give a state another name, also in rules, start, and wherever it is asked for by name."""
    machine, old, new = str(edit.get("machine")), str(edit.get("old")), str(edit.get("new"))
    known = table(level.data, "machines").get(machine)
    states = table(known, "states") if isinstance(known, dict) else {}
    if not isinstance(known, dict) or old not in states:
        raise refused(f"{machine!r} has no state {old!r}", where=f"machines.{machine}")
    if new == old:
        return
    if not NAME.match(new) or new in states:
        raise refused(
            f"{machine!r} has a state {new!r} already" if new in states else f"{new!r} is no name",
            where=f"machines.{machine}.states",
        )
    known["states"] = {new if k == old else k: v for k, v in states.items()}
    if known.get("start") == old:
        known["start"] = new
    rules = known.get("rules")
    if isinstance(rules, list):
        arrow = re.compile(rf"(?<![\w.]){re.escape(old)}(?!\w)")
        parts = [r.partition(" when ") if isinstance(r, str) else (r, "", "") for r in rules]
        known["rules"] = [arrow.sub(new, a) + b + c if b else a for a, b, c in parts]
    name = re.escape(machine)
    asked = re.compile(rf"(?<![\w.])({name}\.state\s*[!=]=\s*)(['\"]){re.escape(old)}\2")
    asking = re.compile(rf"(['\"]){re.escape(old)}\1(\s*[!=]=\s*{name}\.state)(?!\w)")
    for key in ("elements", "signals", "inputs", "blocks", "machines", "experiment"):
        if key in level.data:
            found = _replaced(level.data[key], asked, rf"\g<1>\g<2>{new}\g<2>")
            level.data[key] = _replaced(found, asking, rf"\g<1>{new}\g<1>\g<2>")
    reference = table(table(level.data, "causality"), "reference")
    if reference.get(machine) == old:
        reference[machine] = new


def _set(level: Level, edit: Message) -> None:
    """Set one value by its path in the level; without a value it is taken out."""
    path = [str(k) for k in edit.get("path", ())]
    value = edit.get("value")
    if not path or len(path) > 8 or path[0] in ("hybond", "models"):
        raise refused(f"{'.'.join(path)!r} cannot be set", where=".".join(path))
    if any(len(key) > limits.KEY for key in path):
        raise refused("the name is too long", where=path[0][:40])
    if isinstance(value, str) and len(value) > LONGEST:
        raise refused("the text is too long", where=".".join(path))
    *way, last = path
    if value is None:
        at: Any = level.data
        for key in way:
            at = at.get(key) if isinstance(at, dict) else None
        if isinstance(at, dict):
            at.pop(last, None)
        if len(way) == 1 and not table(level.data, way[0]):
            level.data.pop(way[0], None)
        return
    _section(level, *way)[last] = value


def _paste(level: Level, edit: Message) -> None:
    """Put in elements with their bonds, machines and places; what is taken gets a new name."""
    given = edit.get("data")
    if not isinstance(given, dict):
        raise refused("there is nothing to paste")
    taken = _taken(level)
    names: dict[str, str] = {}
    for section in ("elements", "machines"):
        for name in table(given, section):
            if not NAME.match(base_of(str(name))):
                raise refused(f"{name!r} cannot be a name", where=section)
            base = base_of(str(name))
            names[name] = fresh({base_of(t) for t in taken}, base) + str(name)[len(base) :]
            taken.add(names[name])
    for section in ("elements", "machines"):
        for name, value in table(given, section).items():
            words = copy.deepcopy(value)
            for old, new in names.items():
                if old != new:
                    words = _replaced(words, _word(old), base_of(new))
            _section(level, section)[names[name]] = words
    bonds = renamed(bonds_of(given), {k: v for k, v in names.items()})
    if bonds:
        _section(level, "graph")["bonds"] = [*bonds_of(level.data), *bonds]
    dx, dy = _place(edit.get("by") or [1, 1])
    for name, place in table(given, "layout").items():
        if name in names:
            x, y = _place(place)
            _section(level, "layout")[names[name]] = _place([x + dx, y + dy])


EDITS: dict[str, Callable[[Level, Message], None]] = {
    "add": _add,
    "remove": _remove,
    "move": _move,
    "bond": _bond,
    "reverse": _reverse,
    "write bond": _write_bond,
    "rename": _rename,
    "rename state": _rename_state,
    "set": _set,
    "paste": _paste,
}


def cut_out(data: Data, path: str, names: set[str]) -> Data:
    """Return the part of a level that copying these elements takes along.

    Examples
    --------
    >>> data = {"elements": {"a": {"I": 1}, "b": {"junction": 1}}, "graph": {"bonds": ["b -> a"]}}
    >>> cut_out(data, "", {"a", "b"})["graph"]
    {'bonds': ['b -> a']}
    """
    level = level_of(data, path)
    if level is None:
        return {}
    found: Data = {}
    for section in ("elements", "layout"):
        kept = {k: v for k, v in table(level.data, section).items() if k in names}
        if kept:
            found[section] = kept
    bonds = [
        f"{b.tail} -> {b.head}"
        for b in links(bonds_of(level.data))
        if node_of(b.tail, names) in names and node_of(b.head, names) in names
    ]
    if bonds:
        found["graph"] = {"bonds": bonds}
    machines = {
        name: machine
        for name, machine in table(level.data, "machines").items()
        if (on := _controls(machine)) and on <= names
    }
    if machines:
        found["machines"] = machines
    return copy.deepcopy(found)


def _controls(machine: Any) -> set[str]:
    states = machine.get("states") if isinstance(machine, dict) else None
    lists = states.values() if isinstance(states, dict) else ()
    return {str(n) for on in lists if isinstance(on, list) for n in on}
