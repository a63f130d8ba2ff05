"""Records whose methods are made when they are asked for, beside those of the standard library."""

from __future__ import annotations

import copy
import dataclasses
import inspect
import math
from dataclasses import field
from typing import Any

import pytest

from hybond.records import dataclass


def pair(make: Any) -> tuple[type, type]:
    """Return a class, and one that is derived from it, made by some `dataclass`."""

    @make(frozen=True, slots=True)
    class Point:
        x: float
        y: float = field(default=2.0, compare=False)
        kept: list[int] = field(default_factory=list, repr=False, hash=False)

        def __post_init__(self) -> None:
            if self.x < 0.0:
                raise ValueError("negative")

    @make(frozen=True, slots=True)
    class Named(Point):
        name: str = "p"

    return Point, Named


OURS, THEIRS = pair(dataclass), pair(dataclasses.dataclass)


@pytest.mark.parametrize("which", [0, 1])
def test_they_say_and_do_the_same(which: int) -> None:
    ours, theirs = OURS[which], THEIRS[which]
    assert repr(ours(1.0)) == repr(theirs(1.0))
    assert [f.name for f in dataclasses.fields(ours)] == [
        f.name for f in dataclasses.fields(theirs)
    ]
    assert str(inspect.signature(ours)) == str(inspect.signature(theirs))
    assert ours.__match_args__ == theirs.__match_args__ and ours.__slots__ == theirs.__slots__
    for a, b in ((1.0, 1.0), (1.0, 2.0), (math.nan, math.nan)):
        assert (ours(a) == ours(b)) is (theirs(a) == theirs(b))
    assert ours(1.0, 3.0) == ours(1.0, 4.0) and ours(1.0) != theirs(1.0)
    assert len({ours(1.0, 3.0), ours(1.0, 4.0), ours(2.0)}) == 2
    assert ours(1.0).kept is not ours(1.0).kept
    assert dataclasses.asdict(ours(1.0)) == dataclasses.asdict(theirs(1.0))
    new = dataclasses.replace(ours(1.0, 3.0), x=5.0)
    assert (new.x, new.y, type(new)) == (5.0, 3.0, ours)
    with pytest.raises(ValueError, match="negative"):
        dataclasses.replace(new, x=-1.0)
    match new:
        case ours(x, y):
            assert (x, y) == (5.0, 3.0)


def test_nothing_is_set() -> None:
    for kind in OURS:
        one = kind(1.0)
        for name in ("x", "other"):
            with pytest.raises(dataclasses.FrozenInstanceError):
                setattr(one, name, 2.0)
        with pytest.raises(dataclasses.FrozenInstanceError, match="cannot delete field 'x'"):
            del one.x
        assert not hasattr(one, "__dict__")
        twin = copy.deepcopy(one)
        assert twin == one and twin.kept is not one.kept


def test_one_with_methods_of_its_own_keeps_them() -> None:
    @dataclass(frozen=True, slots=True, eq=False)
    class Own:
        x: float

        def __repr__(self) -> str:
            return f"<{self.x}>"

    assert repr(Own(1.0)) == "<1.0>" and Own(1.0) != Own(1.0) and hash(Own(1.0)) is not None


def test_what_is_wrong_is_refused_when_it_is_made() -> None:
    for kind in (OURS[0], THEIRS[0]):
        with pytest.raises(TypeError, match="missing 1 required positional argument: 'x'"):
            kind()
        with pytest.raises(TypeError, match="unexpected keyword argument 'z'"):
            kind(1.0, z=1.0)


def test_fields_may_have_the_names_that_making_a_record_uses() -> None:
    @dataclass(frozen=True)
    class Held:
        record: int
        owner: str = ""

    held = Held(record=1, owner="me")
    assert (held.record, held.owner) == (1, "me")


def test_threads_that_make_the_first_record_at_once_all_get_one() -> None:
    """One of them looked a method up that another had just made: StopIteration."""

    @dataclass(frozen=True, slots=True)
    class Point:
        x: float

    later = vars(Point)["__eq__"]
    assert Point(1.0) == Point(1.0)
    # as a thread has it that looked it up before
    assert later.__get__(Point(2.0), Point)(Point(2.0))
