"""`dataclass`, as that of the standard library, whose methods are made when they are first used.

Python writes the methods of a data class as text and compiles that, some 0.4 ms for each class. A
command imports more than a hundred records and uses half of them: this is a third of what it
takes to begin. What a record is and does stays the same.
"""

from __future__ import annotations

import dataclasses
import sys
import threading
from collections.abc import Callable
from operator import attrgetter
from reprlib import recursive_repr
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from dataclasses import dataclass as dataclass
else:

    def dataclass(kind=None, /, *, frozen=False, slots=False, **options):
        """Return a data class; a frozen one with slots has its methods when they are asked for.

        Examples
        --------
        >>> @dataclass(frozen=True, slots=True)
        ... class Point:
        ...     x: float
        ...     y: float = 0.0
        >>> "__init__" in vars(Point._written)
        False
        >>> Point(1.0), Point(1.0) == Point(1.0, 0.0), len({Point(1.0), Point(1.0)})
        (Point(x=1.0, y=0.0), True, 1)
        >>> dataclasses.replace(Point(1.0), y=2.0), [f.name for f in dataclasses.fields(Point)]
        (Point(x=1.0, y=2.0), ['x', 'y'])
        """

        def made(kind):
            if frozen and slots and options.keys() <= {"eq", "repr"} and _is_plain(kind):
                return _later(kind, **options)
            return dataclasses.dataclass(frozen=frozen, slots=slots, **options)(kind)

        return made if kind is None else made(kind)


_LOCK = threading.RLock()
_SPECIAL = ("ClassVar", "InitVar", "KW_ONLY")
_OWN = ("__slots__", "__setattr__", "__delattr__", "__getstate__", "__setstate__")
_ALWAYS = ("__init__", "__match_args__", "__dataclass_fields__", "__dataclass_params__")
_REPLACED = ("__replace__",) if sys.version_info >= (3, 13) else ()


def _is_plain(kind: type) -> bool:
    """Whether a class says no more than which fields it has."""
    own = vars(kind)
    if "__annotations__" not in own or any(name in own for name in _OWN):
        return False
    texts = own["__annotations__"].values()
    return not any(word in str(text) for text in texts for word in _SPECIAL)


def _later(kind: type, *, eq: bool = True, repr: bool = True) -> type:
    """Return a class with slots whose methods are made of `kind` when they are asked for."""
    own = dict(vars(kind))
    fields = own["__annotations__"]
    taken = {name for base in kind.__mro__[1:-1] for name in _slots_of(base)}
    space = {k: v for k, v in own.items() if k not in fields}
    for name in ("__dict__", "__weakref__"):
        space.pop(name, None)
    names = [*_ALWAYS, *_REPLACED]
    if repr:
        names.append("__repr__")
    if eq:
        names.append("__eq__")
        if own.get("__hash__") is None and ("__hash__" not in own or "__eq__" in own):
            names.append("__hash__")
            space.pop("__hash__", None)
    names = [name for name in names if name not in space]
    space |= {name: _Later(name) for name in names}
    space["__slots__"] = tuple(name for name in fields if name not in taken)
    space |= {"__setattr__": _frozen, "__delattr__": _frozen}
    space |= {"__getstate__": _state, "__setstate__": _with_state}
    space["_written"] = kind
    made: type = type(kind)(kind.__name__, kind.__bases__, space)
    made.__qualname__ = kind.__qualname__
    return made


class _Later:
    """A method or a list of fields that is there once somebody looks."""

    def __init__(self, name: str) -> None:
        self.name = name

    def __get__(self, record: Any, kind: type) -> Any:
        owner = next(k for k in kind.__mro__ if vars(k).get(self.name) is self)
        with _LOCK:
            found = vars(owner)[self.name]
            if found is self:
                if self.name in _BY_FIELDS:
                    setattr(owner, self.name, _BY_FIELDS[self.name](dataclasses.fields(owner)))
                else:
                    _complete(owner)
                found = vars(owner)[self.name]
        return found.__get__(record, kind) if hasattr(found, "__get__") else found


def _complete(kind: Any) -> None:
    """Make what Python writes as text: how a record is made, and its lists of fields."""
    written = dataclasses.dataclass(frozen=True, eq=False, repr=False)(kind._written)
    for name in (*_ALWAYS, *_REPLACED):
        if isinstance(vars(kind).get(name), _Later):
            setattr(kind, name, vars(written)[name])


def _equal(fields: tuple[Any, ...]) -> Callable[[Any, Any], Any]:
    names = [f.name for f in fields if f.compare]
    read = attrgetter(*names) if names else _nothing

    def equal(record: Any, other: Any) -> Any:
        if other.__class__ is record.__class__:
            return read(record) == read(other)
        return NotImplemented

    def equal_in_one(record: Any, other: Any) -> Any:
        # as tuples, which take what is the same object for equal: nan
        if other.__class__ is record.__class__:
            return (read(record),) == (read(other),)
        return NotImplemented

    return equal_in_one if len(names) == 1 else equal


def _hashed(fields: tuple[Any, ...]) -> Callable[[Any], int]:
    names = [f.name for f in fields if (f.compare if f.hash is None else f.hash)]
    read = attrgetter(*names) if names else _nothing
    if len(names) == 1:
        return lambda record: hash((read(record),))
    return lambda record: hash(read(record))


def _nothing(record: Any) -> tuple[()]:
    return ()


def _shown(fields: tuple[Any, ...]) -> Callable[[Any], str]:
    names = [f.name for f in fields if f.repr]

    @recursive_repr()
    def shown(record: Any) -> str:
        words = ", ".join(f"{name}={getattr(record, name)!r}" for name in names)
        return f"{type(record).__qualname__}({words})"

    return shown


_BY_FIELDS: dict[str, Callable[[tuple[Any, ...]], Any]] = {
    "__eq__": _equal,
    "__hash__": _hashed,
    "__repr__": _shown,
}


def _slots_of(kind: type) -> tuple[str, ...]:
    slots = vars(kind).get("__slots__", ())
    return (slots,) if isinstance(slots, str) else tuple(slots)


def _frozen(record: Any, name: str, *value: Any) -> None:
    what = "assign to" if value else "delete"
    raise dataclasses.FrozenInstanceError(f"cannot {what} field {name!r}")


def _state(record: Any) -> list[Any]:
    return [getattr(record, field.name) for field in dataclasses.fields(record)]


def _with_state(record: Any, state: list[Any]) -> None:
    for field, value in zip(dataclasses.fields(record), state, strict=True):
        object.__setattr__(record, field.name, value)
