"""The words of the portable subset, as Python sees them."""

from __future__ import annotations

from typing import TypeAlias, TypeVar

R = TypeVar("R")

Floats: TypeAlias = list[float]
"""An array of 64 bit numbers whose length never changes."""
Ints: TypeAlias = list[int]
"""An array of 32 bit integers whose length never changes."""


def floats(n: int) -> Floats:
    """Return an array of `n` zeros."""
    return [0.0] * n


def ints(n: int) -> Ints:
    """Return an array of `n` integers, all zero."""
    return [0] * n


def record(cls: type[R]) -> type[R]:
    """Make a class of annotated fields a record: without arguments it is made of zeros."""
    zeros: dict[str, object] = {"int": 0, "float": 0.0, "bool": False}
    start = {name: zeros.get(str(kind)) for name, kind in cls.__annotations__.items()}

    def make(self: object) -> None:
        self.__dict__.update(start)

    cls.__init__ = make  # type: ignore[method-assign]
    return cls
