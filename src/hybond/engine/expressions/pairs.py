"""Signals that jump: a finite part and an impulse part, on a small stack.

At a jump a signal is ``impulse * delta + finite``. Pairs add; a pair times a factor that does not
jump scales both parts; comparisons, abs, min, max and sign look at the impulse first. Anything else
on an impulse has no meaning and is refused. Each value also carries the size of the terms it was
made of, because rounding is relative to these.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.expressions.functions import BELOW, SQRT, function_of, power, ratio
from hybond.engine.words import Floats, floats, record

DEPTH: Final = 256
"""Pairs that the stack has room for; tables with expressions that need more are refused."""
ROUNDING: Final = 1e-13
"""A difference below this part of its terms is rounding, hence zero."""
LARGEST: Final = 1e300
"""The size of a term that is beyond all numbers: sums of such sizes are numbers."""
IMPULSE_RTOL: Final = 1e-9
"""An impulse below this part of the largest one or stored quantity of its kind is zero."""

# why an expression has no meaning at a jump (HB-J101)
NOT_A_NUMBER: Final = 1
PRODUCT: Final = 2
FACTOR_JUMPS: Final = 3
DIVISION: Final = 4
DIVIDED_JUMPS: Final = 5
FUNCTION: Final = 6
POWER: Final = 7
TABLE: Final = 8
TOO_DEEP: Final = 9


@record
class Stack:
    """Values under way, and the signals that they are made of.

    Entry k of `finite`, `impulse`, `before`, `size` and `impulse_size` is one pair; `top` is the
    last one. Signal k is now ``now[k]`` and was ``was[was_first + k]``; it carries the impulse
    ``jump[k]`` if `jumps`, and ``terms[k]`` is the size of the terms that made it,
    ``prior_terms[k]`` of those that made what it was. Comparisons past zero by no more than
    `level` count as zero.
    """

    finite: Floats
    impulse: Floats
    before: Floats
    size: Floats
    impulse_size: Floats
    top: int
    refused: int
    now: Floats
    was: Floats
    was_first: int
    jump: Floats
    jumps: bool
    terms: Floats
    prior_terms: Floats
    level: float
    touching: bool
    """Whether functions are known to the rounding of their arguments only, as where a guard asks
    for both sides of a zero."""


def make_stack() -> Stack:
    """Return a stack without signals."""
    s = Stack()
    s.finite = floats(DEPTH)
    s.impulse = floats(DEPTH)
    s.before = floats(DEPTH)
    s.size = floats(DEPTH)
    s.impulse_size = floats(DEPTH)
    return s


def clear(s: Stack) -> None:
    """Forget what is on the stack."""
    s.top = -1
    s.refused = 0


def push(s: Stack, finite: float, impulse: float, before: float, size: float) -> None:
    """Put a pair on top."""
    if s.top + 1 >= DEPTH:
        s.refused = TOO_DEEP
        return
    s.top += 1
    s.finite[s.top] = finite
    s.impulse[s.top] = impulse
    s.before[s.top] = before
    s.size[s.top] = size
    s.impulse_size[s.top] = math.fabs(impulse)


def push_number(s: Stack, a: float) -> None:
    """Put a value on top that does not jump."""
    push(s, a, 0.0, a, math.fabs(a))


def push_truth(s: Stack, a: bool) -> None:
    """Put 1 or 0 on top."""
    push_number(s, 1.0 if a else 0.0)


def push_signal(s: Stack, k: int) -> None:
    """Put signal k on top."""
    push(s, s.now[k], s.jump[k] if s.jumps else 0.0, s.was[s.was_first + k], s.terms[k])


def push_prior(s: Stack, k: int) -> None:
    """Put what signal k was on top."""
    b = s.was[s.was_first + k]
    push(s, b, 0.0, b, max(math.fabs(b), s.prior_terms[k]))


def pop_truth(s: Stack) -> bool:
    """Take the top off and return whether it is true."""
    s.top -= 1
    return s.refused == 0 and s.finite[s.top + 1] != 0.0


def is_impulsive(s: Stack, k: int) -> bool:
    """Whether the impulse of a pair is more than rounding."""
    return math.fabs(s.impulse[k]) > ROUNDING * s.impulse_size[k]


def is_steady(s: Stack, k: int) -> bool:
    """Whether a pair is the same before and after."""
    return not is_impulsive(s, k) and math.fabs(s.finite[k] - s.before[k]) <= 1e-9 * max(
        s.size[k], math.fabs(s.before[k])
    )


def sign_at(s: Stack, k: int) -> int:
    """Return the sign of a pair, the impulse first."""
    if is_impulsive(s, k):
        return 1 if s.impulse[k] > 0.0 else -1
    if math.fabs(s.finite[k]) > ROUNDING * s.size[k]:
        return 1 if s.finite[k] > 0.0 else -1
    if s.finite[k] != s.finite[k]:
        s.refused = NOT_A_NUMBER
    return 0


def add(s: Stack) -> None:
    """Replace the two on top by their sum."""
    k = s.top - 1
    s.finite[k] += s.finite[k + 1]
    s.impulse[k] += s.impulse[k + 1]
    s.before[k] += s.before[k + 1]
    s.size[k] += s.size[k + 1]
    s.impulse_size[k] += s.impulse_size[k + 1]
    s.top = k


def negate(s: Stack) -> None:
    """Change the sign of the top."""
    k = s.top
    s.finite[k] = -s.finite[k]
    s.impulse[k] = -s.impulse[k]
    s.before[k] = -s.before[k]


def subtract(s: Stack) -> None:
    """Replace the two on top by their difference."""
    negate(s)
    add(s)


def exchange(s: Stack) -> None:
    """Exchange the two on top."""
    k = s.top
    finite = s.finite[k]
    impulse = s.impulse[k]
    before = s.before[k]
    size = s.size[k]
    impulse_size = s.impulse_size[k]
    s.finite[k] = s.finite[k - 1]
    s.impulse[k] = s.impulse[k - 1]
    s.before[k] = s.before[k - 1]
    s.size[k] = s.size[k - 1]
    s.impulse_size[k] = s.impulse_size[k - 1]
    s.finite[k - 1] = finite
    s.impulse[k - 1] = impulse
    s.before[k - 1] = before
    s.size[k - 1] = size
    s.impulse_size[k - 1] = impulse_size


def multiply(s: Stack) -> None:
    """Replace the two on top by their product."""
    if is_impulsive(s, s.top) and is_impulsive(s, s.top - 1):
        s.refused = PRODUCT
    elif is_impulsive(s, s.top):
        exchange(s)
    k = s.top - 1
    jumps = is_impulsive(s, k)
    if jumps and not is_steady(s, k + 1):
        s.refused = FACTOR_JUMPS
    own = s.finite[k]
    factor = s.finite[k + 1]
    s.finite[k] *= factor
    s.impulse[k] = s.impulse[k] * factor if jumps else 0.0
    s.impulse_size[k] = math.fabs(s.impulse_size[k] * factor) if jumps else 0.0
    s.before[k] *= s.before[k + 1]
    s.size[k] = size_of_product(own, s.size[k], factor, s.size[k + 1])
    s.top = k


def size_of_product(a: float, a_size: float, b: float, b_size: float) -> float:
    """Return what rounding of a product is measured by: it is that of each factor times the other.

    Of the product of two differences that are nothing but rounding there is next to none.
    """
    if not (math.isfinite(a) and math.isfinite(b)):
        return a_size * b_size
    first = max(math.fabs(a), ROUNDING * a_size) * b_size
    return max(first, max(math.fabs(b), ROUNDING * b_size) * a_size)


def size_of_power(a: float, size: float, b: float, finite: float) -> float:
    """Return the same of a power, whose value is known: its slope times the rounding of its base.

    So the root of what is rounding is, too, though it is a million times as large.
    """
    own = math.fabs(finite)
    if not (size > math.fabs(a) and b > 0.0 and math.isfinite(own) and size < LARGEST):
        return own
    return max(own, power(max(math.fabs(a), ROUNDING * size), b - 1.0) * size)


def divide(s: Stack) -> None:
    """Replace the two on top by their quotient."""
    k = s.top - 1
    jumps = is_impulsive(s, k)
    if is_impulsive(s, k + 1):
        s.refused = DIVISION
    elif jumps and not is_steady(s, k + 1):
        s.refused = DIVIDED_JUMPS
    factor = s.finite[k + 1]
    s.finite[k] = ratio(s.finite[k], factor)
    s.impulse[k] = ratio(s.impulse[k], factor) if jumps else 0.0
    s.impulse_size[k] = math.fabs(ratio(s.impulse_size[k], factor)) if jumps else 0.0
    s.before[k] = ratio(s.before[k], s.before[k + 1])
    s.size[k] = ratio(s.size[k], math.fabs(factor))
    s.top = k


def put_plain(s: Stack, k: int, finite: float, before: float) -> None:
    """Make pair k one that carries no impulse.

    A value beyond all numbers is more than rounding, unless it comes of one that is no value.
    """
    beyond = math.fabs(finite) == math.inf and math.isfinite(s.size[k])
    s.finite[k] = finite
    s.impulse[k] = 0.0
    s.before[k] = before
    s.size[k] = LARGEST if beyond else math.fabs(finite)
    s.impulse_size[k] = 0.0


def apply(s: Stack, which: int) -> None:
    """Replace the top by a function of it, of those in functions.py."""
    k = s.top
    if is_impulsive(s, k):
        s.refused = FUNCTION
    if which == SQRT:
        clear_root(s, k)
    own = s.finite[k]
    size = s.size[k]
    put_plain(s, k, function_of(which, s.finite[k], 0.0), function_of(which, s.before[k], 0.0))
    if s.touching:
        moved = function_of(which, own + ROUNDING * size, 0.0) - s.finite[k]
        if math.isfinite(moved) and size < LARGEST:
            s.size[k] = max(s.size[k], math.fabs(moved) / ROUNDING)


def clear_root(s: Stack, k: int) -> None:
    """Let nothing be left of what is below nothing by rounding, where its root is taken."""
    rounding = BELOW * s.size[k] if s.size[k] < LARGEST else 0.0
    if s.finite[k] < 0.0 and s.finite[k] >= -rounding:
        s.finite[k] = 0.0
    if s.before[k] < 0.0 and s.before[k] >= -rounding:
        s.before[k] = 0.0


def apply_to_two(s: Stack, which: int) -> None:
    """Replace the two on top by a function of them, of those in functions.py."""
    k = s.top - 1
    if is_impulsive(s, k) or is_impulsive(s, k + 1):
        s.refused = FUNCTION
    put_plain(
        s,
        k,
        function_of(which, s.finite[k], s.finite[k + 1]),
        function_of(which, s.before[k], s.before[k + 1]),
    )
    s.top = k


def put_read(s: Stack, finite: float, before: float) -> None:
    """Replace the top by what a table says of it."""
    if is_impulsive(s, s.top):
        s.refused = TABLE
    put_plain(s, s.top, finite, before)


def raise_to(s: Stack) -> None:
    """Replace the two on top by a power."""
    k = s.top - 1
    s.top = k
    if is_impulsive(s, k) or is_impulsive(s, k + 1):
        if not is_impulsive(s, k + 1) and s.finite[k + 1] == 1.0:
            return
        s.refused = POWER
    raised = s.finite[k + 1]
    if raised > 0.0 and math.isfinite(raised) and math.floor(raised) != raised:
        clear_root(s, k)
    own = s.finite[k]
    size = s.size[k]
    put_plain(s, k, power(s.finite[k], s.finite[k + 1]), power(s.before[k], s.before[k + 1]))
    s.size[k] = max(s.size[k], size_of_power(own, size, raised, s.finite[k]))


def absolute(s: Stack) -> None:
    """Make the top positive."""
    k = s.top
    if sign_at(s, k) < 0:
        negate(s)
    elif not is_impulsive(s, k):
        # on the wrong side by rounding
        s.finite[k] = math.fabs(s.finite[k])


def put_sign(s: Stack) -> None:
    """Replace the top by its sign."""
    sign = sign_at(s, s.top)
    s.top -= 1
    push_number(s, float(sign))


def length(s: Stack) -> None:
    """Replace the two on top by the length of what has them as components."""
    k = s.top - 1
    p = s.impulse[k] if is_impulsive(s, k) else 0.0
    q = s.impulse[k + 1] if is_impulsive(s, k + 1) else 0.0
    impulse = math.hypot(p, q)
    if impulse != 0.0:
        s.finite[k] = (s.finite[k] * p + s.finite[k + 1] * q) / impulse
    else:
        s.finite[k] = math.hypot(s.finite[k], s.finite[k + 1])
    s.impulse[k] = impulse
    s.before[k] = math.hypot(s.before[k], s.before[k + 1])
    s.size[k] = math.hypot(s.size[k], s.size[k + 1])
    s.impulse_size[k] = math.hypot(s.impulse_size[k], s.impulse_size[k + 1])
    s.top = k


def compared(s: Stack) -> int:
    """Take the two on top off and return the sign of their difference, as `sign_at` does."""
    k = s.top - 1
    s.top = k - 1
    impulse = s.impulse[k] - s.impulse[k + 1]
    if math.fabs(impulse) > ROUNDING * (s.impulse_size[k] + s.impulse_size[k + 1]):
        return 1 if impulse > 0.0 else -1
    finite = s.finite[k] - s.finite[k + 1]
    if math.fabs(finite) > ROUNDING * (s.size[k] + s.size[k + 1]):
        if math.fabs(finite) <= math.fabs(s.level) and (finite > 0.0) == (s.level > 0.0):
            return 0
        return 1 if finite > 0.0 else -1
    if finite != finite:
        s.refused = NOT_A_NUMBER
    return 0


def less(s: Stack) -> None:
    """Replace the two on top by whether the first is less."""
    push_truth(s, compared(s) < 0)


def less_or_equal(s: Stack) -> None:
    """Replace the two on top by whether the first is not greater."""
    push_truth(s, compared(s) <= 0)


def greater(s: Stack) -> None:
    """Replace the two on top by whether the first is greater."""
    push_truth(s, compared(s) > 0)


def greater_or_equal(s: Stack) -> None:
    """Replace the two on top by whether the first is not less."""
    push_truth(s, compared(s) >= 0)


def equal(s: Stack) -> None:
    """Replace the two on top by whether they are equal."""
    push_truth(s, compared(s) == 0)


def unequal(s: Stack) -> None:
    """Replace the two on top by whether they differ."""
    push_truth(s, compared(s) != 0)


def deny(s: Stack) -> None:
    """Replace the top by whether it is false."""
    push_truth(s, not pop_truth(s))


def affirm(s: Stack) -> None:
    """Replace the top by whether it is true."""
    push_truth(s, pop_truth(s))


def keep_one(s: Stack, sign: int) -> None:
    """Replace the two on top by the second if its difference to the first has this sign."""
    k = s.top - 1
    finite = s.finite[k + 1]
    impulse = s.impulse[k + 1]
    before = s.before[k + 1]
    size = s.size[k + 1]
    impulse_size = s.impulse_size[k + 1]
    s.finite[k + 1] = finite - s.finite[k]
    s.impulse[k + 1] = impulse - s.impulse[k]
    s.size[k + 1] = size + s.size[k]
    s.impulse_size[k + 1] = impulse_size + s.impulse_size[k]
    s.top = k
    if sign_at(s, k + 1) == sign:
        s.finite[k] = finite
        s.impulse[k] = impulse
        s.before[k] = before
        s.size[k] = size
        s.impulse_size[k] = impulse_size


def least(s: Stack) -> None:
    """Replace the two on top by the lesser."""
    keep_one(s, -1)


def greatest(s: Stack) -> None:
    """Replace the two on top by the greater."""
    keep_one(s, 1)
