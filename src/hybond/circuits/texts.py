"""Values as the model says them: quantities with units, or expressions of its parameters."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Decimal

from hybond.circuits.formulas import written
from hybond.circuits.numerals import quantity, short
from hybond.circuits.opened import Value
from hybond.model.expressions import Name, Number


@dataclass(frozen=True, slots=True)
class Texts:
    """How values are written; `names` are the parameters of the model by their keys."""

    names: Mapping[str, str]

    def value(self, value: Value, unit: str) -> str | float:
        """Return what an element says: ``"10 uF"`` or ``"2*C0"``."""
        if value.parametric:
            return written(value.formula, self.names)
        return quantity(value.number, unit)

    def factor(self, value: Value, unit: str) -> str:
        """Return a value as a factor of a product."""
        if value.parametric:
            text = written(value.formula, self.names)
            return text if isinstance(value.formula, Number | Name) else f"({text})"
        if "/" in unit:
            return f"{short(value.number)} [{unit}]"
        return str(quantity(value.number, unit)) if unit else short(value.number)

    def total(self, values: list[Value], unit: str) -> str | float:
        """Return the sum of values; decimal numbers add up as on paper."""
        if any(v.parametric for v in values):
            rest = [v for v in values if not v.parametric]
            texts = [self.factor(v, unit) for v in values if v.parametric]
            if sum(v.number for v in rest):
                texts.append(str(quantity(exact_sum(rest), unit)))
            return " + ".join(texts)
        return quantity(exact_sum(values), unit)


def exact_sum(values: list[Value]) -> float:
    """Return the sum of the decimal numbers that are nearest to values.

    Examples
    --------
    >>> exact_sum([Value(Number(x), x) for x in (0.1, 0.2)])
    0.3
    """
    return float(sum((Decimal(repr(v.number)) for v in values), Decimal(0)))


def minus(text: str | float) -> str | float:
    """Return minus a value as text.

    Examples
    --------
    >>> minus("5 V"), minus("-5 V"), minus("2 V*sin(w)"), minus("a + b")
    ('-5 V', '5 V', '-(2 V*sin(w))', '-(a + b)')
    """
    if not isinstance(text, str):
        return -text
    words = text.split()
    try:
        float(words[0])
    except (ValueError, IndexError):
        return f"-{text}" if text.isidentifier() else f"-({text})"
    if len(words) != 2 or not words[1].isalpha():
        return f"-({text})"
    return text[1:] if text.startswith("-") else f"-{text}"
