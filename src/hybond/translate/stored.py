"""The typed tree as bytes and back, so that a program is read once: numbers, texts, lists.

Bytes hold what the tree is made of, by number; nothing in them is run.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from typing import Any

import msgspec

from hybond.translate import tree
from hybond.translate.effects import Effects
from hybond.translate.modules import Program
from hybond.translate.reach import Uses

_TREE = (
    *(tree.Type, tree.Value, tree.Local, tree.Global, tree.Field, tree.Element, tree.Unary),
    *(tree.Binary, tree.Choice, tree.Call, tree.Word, tree.Notes, tree.Assign, tree.Augment),
    *(tree.If, tree.While, tree.For, tree.Jump, tree.Return, tree.Do, tree.Block, tree.Member),
    *(tree.Record, tree.Constant, tree.Signature, tree.Function, tree.Module),
)
_RECORDS: tuple[type, ...] = (*_TREE, Program, Effects, Uses)
_NUMBERS = {kind: k for k, kind in enumerate(_RECORDS)}
_NAMES = {kind: tuple(f.name for f in fields(kind)) for kind in _RECORDS}
_GROUPS: tuple[Callable[[list[Any]], Any], ...] = (tuple, list, frozenset, set, dict)
"""What is no record: written with -1, -2 and so on before what is in it."""


def stored(thing: object) -> bytes:
    """Return a tree, or groups of trees, as bytes: the same bytes for the same thing.

    Examples
    --------
    >>> restored(stored((tree.Local("x", tree.FLOAT), {"a": 1.0, "b": None})))
    (Local(name='x', type=Type(kind='float', record='')), {'a': 1.0, 'b': None})
    """
    return msgspec.msgpack.encode(_plain(thing))


def _plain(thing: Any) -> Any:
    kind = type(thing)
    number = _NUMBERS.get(kind)
    if number is not None:
        return [number, *(_plain(getattr(thing, name)) for name in _NAMES[kind])]
    if kind in (tuple, list):
        return [-1 - _GROUPS.index(kind), *map(_plain, thing)]
    if kind in (frozenset, set):
        # a set has no order of its own
        return [-1 - _GROUPS.index(kind), *sorted(map(_plain, thing), key=repr)]
    if kind is dict:
        return [-1 - _GROUPS.index(dict), *([_plain(k), _plain(v)] for k, v in thing.items())]
    if thing is None or kind in (int, float, bool, str, bytes):
        return thing
    raise TypeError(f"{kind.__name__} is no part of a program")


def restored(data: bytes) -> Any:
    """Return what `stored` has made bytes of."""
    return _thing(msgspec.msgpack.decode(data))


def _thing(plain: Any) -> Any:
    if type(plain) is not list:
        return plain
    number = plain[0]
    if number >= 0:
        return _RECORDS[number](*[_thing(x) if type(x) is list else x for x in plain[1:]])
    if number == -5:
        return {_thing(k): _thing(v) for k, v in plain[1:]}
    return _GROUPS[-1 - number]([_thing(x) if type(x) is list else x for x in plain[1:]])
