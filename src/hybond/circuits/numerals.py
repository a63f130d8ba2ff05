"""Numbers as SPICE writes them, and quantities as hybond writes them."""

from __future__ import annotations

import math
import re
from decimal import Decimal
from functools import lru_cache

from hybond.units import try_quantity

SUFFIXES = {
    "t": 1e12,
    "g": 1e9,
    "meg": 1e6,
    "k": 1e3,
    "mil": 25.4e-6,
    "m": 1e-3,
    "u": 1e-6,
    "µ": 1e-6,
    "μ": 1e-6,
    "n": 1e-9,
    "p": 1e-12,
    "f": 1e-15,
}
"""Scale factors; case does not matter, so ``M`` is a thousandth and ``MEG`` a million.

None for ``a``: ``1A`` is an ampere where no scale factor is known, and 1e-18 where there is."""
AMBIGUOUS = "a"
NUMERAL = re.compile(
    r"(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:e[+-]?[0-9]+)?"
    r"(?P<scale>meg|mil|[tgkmuµμnpf])?(?P<unit>[a-zΩ]*)",
    re.IGNORECASE,
)
"""A number without a sign; letters after the scale factor are a unit, which SPICE ignores."""
LETTERED = re.compile(r"([0-9]+)(meg|[tgkmuµμnpfr])([0-9]+)", re.IGNORECASE)
"""``4k7`` and ``2R2``, as on schematics: the letter stands where the point is."""
_PREFIXES = {9: "G", 6: "M", 3: "k", 0: "", -3: "m", -6: "u", -9: "n", -12: "p", -15: "f"}
_SAME = 4e-16
"""Relative difference of two readings of one decimal number."""


def numeral(text: str) -> float | None:
    """Return the number that a SPICE numeral stands for, None if it is not one.

    Examples
    --------
    >>> numeral("4.7k"), numeral("10uF"), numeral("2MEG"), numeral("1e-3"), numeral("-3mil")
    (4700.0, 1e-05, 2000000.0, 0.001, -7.62e-05)
    >>> numeral("1F")  # F is femto, as in every SPICE
    1e-15
    >>> numeral("4k7"), numeral("2n2"), numeral("0R5")  # a letter where the point is
    (4700.0, 2.2e-09, 0.5)
    >>> numeral("1A") is None, numeral("0A")
    (True, 0.0)
    """
    sign = -1.0 if text.startswith("-") else 1.0
    bare = text[1:] if text[:1] in ("+", "-") else text
    if lettered := LETTERED.fullmatch(bare):
        scale = "" if lettered[2].lower() == "r" else lettered[2]
        bare = f"{lettered[1]}.{lettered[3]}{scale}"
    match = NUMERAL.fullmatch(bare)
    if match is None:
        return None
    if is_ambiguous(match):
        return None
    value = sign * scaled(match)
    return value if math.isfinite(value) else None


def is_ambiguous(match: re.Match[str]) -> bool:
    """Say whether the letters of a match of `NUMERAL` may be a unit or a scale factor.

    Zero is the same with either.
    """
    if match["scale"] or match["unit"][:1].lower() != AMBIGUOUS:
        return False
    return scaled(match) != 0.0


def scaled(match: re.Match[str]) -> float:
    """Return the value of a match of `NUMERAL`."""
    scale = match["scale"]
    end = match.start("scale") if scale else match.start("unit")
    mantissa = match.string[match.start() : end].lower()
    if not scale:
        return float(mantissa)
    factor = SUFFIXES[scale.lower()]
    if scale.lower() == "mil":
        return float(mantissa) * factor
    # read as one decimal number, so that 4.7u is the float nearest to 4.7e-6
    body, _, exponent = mantissa.partition("e")
    return float(f"{body}e{int(exponent or 0) + round(math.log10(factor))}")


@lru_cache(maxsize=4096)
def quantity(value: float, unit: str) -> str | float:
    """Return a value as a quantity, with a prefix if there is one.

    Examples
    --------
    >>> quantity(4.7e-6, "F"), quantity(1000.0, "ohm"), quantity(-12.0, "V"), quantity(0.0, "V")
    ('4.7 uF', '1 kohm', '-12 V', '0 V')
    >>> quantity(1e-21, "F"), quantity(1e-5, "F"), quantity(2.5, "")
    ('1e-21 F', '10 uF', 2.5)
    """
    if not unit:
        return value
    plain = f"{short(value)} {unit}"
    if not value:
        return plain
    exact = Decimal(repr(value))
    power = exact.adjusted() // 3 * 3
    if power not in _PREFIXES:
        return plain
    mantissa = (exact.scaleb(-power)).normalize()
    text = f"{mantissa:f} {_PREFIXES[power]}{unit}"
    read = try_quantity(text)
    same = read is not None and abs(read.value - value) <= _SAME * abs(value)
    return text if same else plain


def short(value: float) -> str:
    """Return a number without a useless ``.0``.

    Examples
    --------
    >>> short(5.0), short(0.1), short(1e-7), short(1e22)
    ('5', '0.1', '1e-07', '1e+22')
    """
    return repr(value).removesuffix(".0")
