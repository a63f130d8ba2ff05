"""`dataclass`, as that of the standard library, whose methods are made when they are first used.

Python writes the methods of a data class as text and compiles that, some 0.4 ms for each class. A
command imports more than a hundred records, uses half of them, and makes but a few of most: the
first of a class are made without. What a record is and does stays the same.
"""

from __future__ import annotations

import dataclasses
import sys
import threading
from collections.abc import Callable
from functools import partial
from operator import attrgetter
from reprlib import recursive_repr
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from dataclasses import dataclass as dataclass
else:

    def dataclass(kind=None, /, *, frozen=False, slots=False, **options):
        """Return a data class that has its methods when they are asked for.

        Examples
        --------
        >>> @dataclass(frozen=True, slots=True)
        ... class Point:
        ...     x: float
        ...     y: float = 0.0
        >>> Point(1.0), Point(1.0) == Point(1.0, 0.0), len({Point(1.0), Point(1.0)})
        (Point(x=1.0, y=0.0), True, 1)
        >>> "__init__" in vars(Point._written)
        False
        >>> dataclasses.replace(Point(1.0), y=2.0), [f.name for f in dataclasses.fields(Point)]
        (Point(x=1.0, y=2.0), ['x', 'y'])
        """

        def made(kind):
            if options.keys() <= {"eq", "repr", "kw_only"} and _is_plain(kind):
                return _later(kind, frozen, slots, **options)
            return dataclasses.dataclass(frozen=frozen, slots=slots, **options)(kind)

        return made if kind is None else made(kind)


_LOCK = threading.RLock()
_FEW = 16
"""Records of a class that are made before it is worth while to compile how."""
_SPECIAL = ("ClassVar", "InitVar", "KW_ONLY")
_OWN = ("__slots__", "__setattr__", "__delattr__", "__getstate__", "__setstate__")
_ALWAYS = ("__init__", "__match_args__", "__dataclass_fields__", "__dataclass_params__")
_REPLACED = ("__replace__",) if sys.version_info >= (3, 13) else ()


def _is_plain(kind: type) -> bool:
    """Whether a class says no more than which fields it has."""
    own = vars(kind)
    unread = "__annotations__" not in own and getattr(kind, "__annotate__", None) is not None
    if unread or any(name in own for name in _OWN):
        return False
    texts = own.get("__annotations__", {}).values()
    return not any(word in str(text) for text in texts for word in _SPECIAL)


def _later(
    kind: type,
    frozen: bool,
    slots: bool,
    *,
    eq: bool = True,
    repr: bool = True,
    kw_only: bool = False,
) -> type:
    """Return a class whose methods are made of `kind` when they are asked for."""
    own = dict(vars(kind))
    fields = own.get("__annotations__", {})
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
            space["__hash__"] = Later("__hash__") if frozen else None
    space |= {name: Later(name) for name in names if name not in space}
    if slots:
        space["__slots__"] = tuple(name for name in fields if name not in taken)
    if frozen:
        space |= {"__setattr__": _frozen, "__delattr__": _frozen}
    if frozen and slots:
        space |= {"__getstate__": _state, "__setstate__": _with_state}
    space["_written"] = kind
    space["_asked"] = {"frozen": frozen, "kw_only": kw_only}
    made: type = type(kind)(kind.__name__, kind.__bases__, space)
    made.__qualname__ = kind.__qualname__
    return made


class Later:
    """A method or a list of fields that is there once somebody looks.

    `wrap`, which may be set, is what is put around the method when it is made.
    """

    def __init__(self, name: str) -> None:
        self.name = name
        self.wrap: Callable[[Any], Any] | None = None
        self.calls = 0
        self.fields: dict[str, Any] | None = None

    def __get__(self, record: Any, kind: type) -> Any:
        owner = next((k for k in kind.__mro__ if vars(k).get(self.name) is self), None)
        if owner is None:
            # another thread has made it since it was looked up here
            return getattr(kind if record is None else record, self.name)
        if record is not None and self.name == "__init__" and self._by_hand(owner):
            return partial(self._fill, record, owner)
        with _LOCK:
            found = vars(owner)[self.name]
            if found is self:
                if self.name in _BY_FIELDS:
                    plain = _plain_fields(owner)
                    fields = tuple(plain.values()) if plain else dataclasses.fields(owner)
                    setattr(owner, self.name, _BY_FIELDS[self.name](fields))
                else:
                    _complete(owner)
                found = vars(owner)[self.name]
        return found.__get__(record, kind) if hasattr(found, "__get__") else found

    def _by_hand(self, owner: type) -> bool:
        """Whether one more record is made without a method for it."""
        if self.calls == 0:
            self.fields = None if self.wrap else _plain_fields(owner)
        self.calls += 1
        return self.fields is not None and self.calls <= _FEW

    def _fill(self, record: Any, owner: type, /, *args: Any, **given: Any) -> None:
        """Give a new record its values, as the method would."""
        fields = self.fields
        assert fields is not None
        values = {**dict(zip(fields, args, strict=False)), **given}
        missing = [f for name, f in fields.items() if name not in values and not _has_default(f)]
        if missing or values.keys() - fields or len(args) + len(given) != len(values):
            _complete(owner)  # whose method says what is wrong
            vars(owner)["__init__"](record, *args, **given)
            return
        for name, field in fields.items():
            value = values[name] if name in values else _default_of(field)
            object.__setattr__(record, name, value)
        if hasattr(owner, "__post_init__"):
            record.__post_init__()


def _plain_fields(kind: type) -> dict[str, Any] | None:
    """Return the fields of a record in order, None where it takes more than to set them."""
    found: dict[str, Any] = {}
    for base in reversed(kind.__mro__[:-1]):
        own = vars(base)
        if "_written" in own:
            if own["_asked"]["kw_only"]:
                return None
            fields = own["__dataclass_fields__"]
            if isinstance(fields, Later):
                given = vars(own["_written"])
                names = own.get("__annotations__", {})
                fields = {n: _field(n, given.get(n, dataclasses.MISSING)) for n in names}
            found |= fields
        elif "__dataclass_fields__" in own:
            return None
    special = (f.kw_only is True or not f.init or _is_shared(f.default) for f in found.values())
    return None if any(special) else found


def _field(name: str, default: Any) -> Any:
    """Return what a class says of a field."""
    given = isinstance(default, dataclasses.Field)
    found: Any = default if given else dataclasses.field(default=default)
    found.name = name
    return found


def _is_shared(default: Any) -> bool:
    """Whether it is a default that all records would share, which Python refuses."""
    return type(default).__hash__ is None


def _has_default(field: Any) -> bool:
    missing = dataclasses.MISSING
    return field.default is not missing or field.default_factory is not missing


def _default_of(field: Any) -> Any:
    return field.default if field.default is not dataclasses.MISSING else field.default_factory()


def _complete(kind: Any) -> None:
    """Make what Python writes as text: how a record is made, and its lists of fields."""
    with _LOCK:
        if not isinstance(vars(kind)["__dataclass_fields__"], Later):
            return
        written = dataclasses.dataclass(eq=False, repr=False, **kind._asked)(kind._written)
        for name in (*_ALWAYS, *_REPLACED):
            later = vars(kind).get(name)
            if isinstance(later, Later):
                made = vars(written)[name]
                setattr(kind, name, later.wrap(made) if later.wrap else made)


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
