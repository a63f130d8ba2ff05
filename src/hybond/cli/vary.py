"""``--vary path=values``: the values of a parameter, and the sets that several make."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Sequence

import numpy as np

from hybond.cli.lists import scaled, split
from hybond.errors import UsageError
from hybond.sweep.factors import factor_of
from hybond.sweep.laws import LAWS
from hybond.units import parse_unit, try_quantity

MEMBERS = 1_000_000
"""Members that one sweep may have."""
_NUMBER = re.compile(r"\s*[+-]?[\d.]+([eE][+-]?\d+)?")
_COUNT = re.compile(r"0*([0-9]{1,18})")
_OTHER = re.compile(
    rf"({'|'.join(LAWS)})\s*\([^()]*\)|(lin|log)\s*\([^(),]*,[^(),]*,[^(),]*\)|[^,:(]+(:[^,:(]+){{2}}"
)
"""Levels and distributions of a plan."""
Values = tuple[str, list[str | float]]


def values_of(text: str) -> Values:
    """Return the path and the values of ``path=low..high:number`` or ``path=v,w,...``.

    A range takes its unit from either end. Other levels are those of `hybond.sweep.factors`.

    Raises
    ------
    UsageError
        HB-X103.

    Examples
    --------
    >>> values_of("m=1..2 kg:3")
    ('m', ['1.0 kg', '1.5 kg', '2.0 kg'])
    >>> values_of("k=2 N/m, 1e3")
    ('k', ['2 N/m', '1e3'])
    >>> values_of("R=1k,2.2k")
    ('R', ['1e3', '2.2e3'])
    """
    path, _, given = (word.strip() for word in text.partition("="))
    if ".." not in given and path and _OTHER.fullmatch(given):
        factor = factor_of(path, given)
        if factor.levels is None:
            raise _refusal(f"{text!r} is a distribution: --sample says how many are drawn")
        _check_members(factor.many)
        return path, [factor.shown(float(v)) for v in factor.levels]
    if ".." not in given:
        written = split([given])
        words: list[str | float] = [scaled(word) for word in written]
        if not path or not words:
            raise _refusal(f"{text!r} varies nothing")
        _check_last_unit(written)
        return path, words
    span, _, count = (word.strip() for word in given.rpartition(":"))
    low, _, high = (scaled(word.strip()) for word in span.partition(".."))
    ends = [try_quantity(low), try_quantity(high)]
    number = int(match[1]) if (match := _COUNT.fullmatch(count)) else 0
    if not path or number < 2 or None in ends:
        raise _refusal(f"{text!r} is not PATH=LOW..HIGH:NUMBER")
    a, b = (end for end in ends if end is not None)
    none = parse_unit("1")[1]
    # "1..5 mm" is a range in mm
    unit = _unit(high) or _unit(low)
    if a.dimension == none and not _unit(low):
        a = try_quantity(f"{low} {unit}") or a
    if b.dimension == none and not _unit(high):
        b = try_quantity(f"{high} {unit}") or b
    if a.dimension != b.dimension:
        raise _refusal(f"{low!r} and {high!r} are not of one kind")
    _check_members(number)
    values = np.linspace(a.value, b.value, number).tolist()
    name = "" if a.dimension == none else f" {a.dimension}"
    return path, [f"{value!r}{name}" if name else value for value in values]


def columns(vary: Sequence[str], *, together: bool) -> dict[str, list[str | float]]:
    """Return the columns of all combinations, the last option fastest; or of values `together`.

    Raises
    ------
    UsageError
        HB-X103.

    Examples
    --------
    >>> columns(["m=1,2", "k=5,6"], together=False)
    {'m': ['1', '1', '2', '2'], 'k': ['5', '6', '5', '6']}
    >>> columns(["m=1,2", "k=5,6"], together=True)
    {'m': ['1', '2'], 'k': ['5', '6']}
    """
    found = [values_of(text) for text in vary]
    paths = [path for path, _ in found]
    if not found:
        raise _refusal("nothing is varied")
    if len(set(paths)) < len(paths):
        raise _refusal("one parameter is varied twice")
    if together:
        return dict(found)
    _check_members(math.prod(len(values) for _, values in found))
    rows = list(itertools.product(*(values for _, values in found)))
    return {path: [row[k] for row in rows] for k, path in enumerate(paths)}


def _check_last_unit(words: Sequence[str]) -> None:
    """Refuse ``3,5 mph``: whether the unit is that of all of them is a guess."""
    unit = _unit(words[-1])
    if not unit or try_quantity(words[-1]) is None:
        return
    for word in words:
        quantity = try_quantity(word)
        if quantity is not None and quantity.value != 0.0 and not _unit(word):
            raise UsageError(
                f"{word!r} has no unit, and {words[-1]!r} has one",
                code="HB-X103",
                where="--vary",
                hint=f"{word} {unit}, if it is in that unit",
            )


def _check_members(number: int) -> None:
    if number > MEMBERS:
        raise _refusal(f"more than {MEMBERS} members")


def _unit(text: str) -> str:
    return _NUMBER.sub("", text, count=1).strip()


def _refusal(why: str) -> UsageError:
    return UsageError(why, code="HB-X103", where="--vary", hint="--vary m=1..2kg:11 or m=1kg,2kg")
