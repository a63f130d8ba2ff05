"""Operators, precedence, conversions and how numbers are written."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.words import (
    Floats,
    Text,
    float_table,
    floats,
    int_table,
    put_int,
    put_line,
    put_number,
    put_text,
    quotient,
)

SMALL: Final = 1e-12
MANY: Final = 7
HALF: Final = 2.0**-1
WHICH: Final = int_table(3, 1, 2)
WEIGHTS: Final = float_table(1, 0.5, 1e300)
GREETING: Final = 'a "word"?\n'
LOUD: Final = True


def show(name: Text, x: float) -> None:
    """Write a name and a number."""
    put_text(name)
    put_text(" ")
    put_number(x)
    put_line()


def mixed(a: float, b: float, n: int, k: int) -> float:
    """Everything at once; brackets stay where they matter."""
    left = a - (b - 1.0) - b
    right = a / (b / 3.0) / 2.0
    whole = (n + k) * (k - n) // 3 % 5
    bits = (n & 6 | k << 2) ^ (n >> 1) + 1
    return -(left + right) * -a + float(whole) / 2.0 + float(bits) * -b


def logic(a: float, n: int, on: bool) -> int:
    """Conditions inside conditions."""
    if (a < 0.0 or n > 2) and not (on or n == 4):
        return 1
    if a < 0.0 or (n > 2 and on):
        return 2
    if on == (n < 2):
        return 3
    return 4 if a > 1.0 else 5 if a > 0.5 else 6


def extremes(v: Floats) -> None:
    """Smallest, largest, and what is not a number."""
    show("min", min(v[0], v[1]))
    show("max", max(v[0], v[1]))
    put_int(min(2, -2) + max(5, 3) + abs(-4))
    put_line()
    show("abs", abs(v[1]))
    show("nan first", min(math.nan, 1.0))
    show("nan second", min(1.0, math.nan))
    if math.isnan(max(math.nan, 1.0)) and not math.isfinite(math.inf):
        put_text("nan stays\n")


def functions(x: float) -> None:
    """The library of each language rounds in its own way; what is exact is compared."""
    show("sqrt", math.sqrt(x))
    show("floor", math.floor(-x))
    show("ceil", math.ceil(-x))
    show("fabs", math.fabs(-x))
    show("fmod", math.fmod(-x, 0.7))
    show("copysign", math.copysign(x, -0.0))
    show("exp", math.floor(math.exp(x) * 1e9))
    show("trig", math.floor((math.sin(x) + math.cos(x) * math.tan(x)) * 1e9))
    show("arcs", math.floor((math.asin(0.3) + math.acos(0.3) + math.atan(x)) * 1e9))
    show("two", math.floor((math.atan2(x, -1.0) + math.hypot(x, 4.0) + math.pow(x, 1.5)) * 1e9))
    show("rest", math.floor((math.sinh(x) + math.cosh(x) + math.tanh(x)) * 1e8))
    show("logs", math.floor((math.log(x) + math.log10(x)) * 1e9))


def report() -> None:
    """Write all."""
    put_text(GREETING)
    if LOUD:
        show("small", SMALL)
    show("half", HALF)
    v = floats(2)
    v[0] = 2.5
    v[1] = -0.0
    # numbers as they are written
    x = 1e-8
    for _ in range(33):
        show("part", x / 3.0)
        show("whole", x)
        x = 10.0 * x
    show("third", 1.0 / 3.0)
    show("tenths", 0.1 + 0.2)
    show("minus zero", v[1])
    show("large", WEIGHTS[2] * 1e8)
    show("least", 5e-324)
    show("inf", quotient(1.0, 0.0))
    show("minus inf", quotient(-1.0, 0.0))
    show("nan", quotient(0.0, 0.0))
    show("pi", math.pi)
    for n in range(6):
        show("mixed", mixed(0.3 * float(n), 1.7 - float(n), n, WHICH[n % 3] + MANY))
        put_int(logic(0.4 * float(n) - 0.7, n, n % 2 == 0))
        put_line()
    extremes(v)
    functions(1.3)
    show("truncated", math.floor(-2.7) + int(2.7))
