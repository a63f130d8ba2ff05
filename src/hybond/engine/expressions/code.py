"""Expressions as instructions in tables, on a stack: what a library for all models evaluates.

An instruction is a number of those below, with what it works on behind it. The same instructions
mean an expression on numbers (`run_code`) and on pairs (`run_pair_code`), but for what reads a
value: `SIGNAL` reads a slot; a priori values are slots further on for numbers, and `PRIOR` of the
same slot for pairs. `tables/code.py` makes them.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.expressions.functions import function_of, power, sign_of
from hybond.engine.expressions.lookup import greatest_of, least_of, read_table, slope_of_table
from hybond.engine.expressions.pairs import (
    DEPTH,
    Stack,
    absolute,
    add,
    affirm,
    apply,
    apply_to_two,
    deny,
    divide,
    equal,
    greater,
    greater_or_equal,
    greatest,
    least,
    length,
    less,
    less_or_equal,
    multiply,
    negate,
    pop_truth,
    push_number,
    push_prior,
    push_signal,
    put_read,
    put_sign,
    raise_to,
    subtract,
    unequal,
)
from hybond.engine.words import Floats, Ints, quotient

DEEPEST: Final = DEPTH
"""Values that the stack of numbers has room for, likewise."""

END: Final = 0
NUMBER: Final = 1  # and which one
SIGNAL: Final = 2  # and its slot
PRIOR: Final = 3  # and its slot
ADD: Final = 4
SUBTRACT: Final = 5
MULTIPLY: Final = 6
DIVIDE: Final = 7
RAISE: Final = 8
NEGATE: Final = 9
SQUARE: Final = 10
LESS: Final = 11
LESS_OR_EQUAL: Final = 12
GREATER: Final = 13
GREATER_OR_EQUAL: Final = 14
EQUAL: Final = 15
UNEQUAL: Final = 16
DENY: Final = 17
AFFIRM: Final = 18
SKIP: Final = 19  # and how many places
SKIP_UNLESS: Final = 20  # what is on top, which is taken off
SKIP_IF: Final = 21
ABSOLUTE: Final = 22
SIGN: Final = 23
LENGTH: Final = 24
LEAST: Final = 25
GREATEST: Final = 26
APPLY: Final = 27  # and a function of functions.py, of one number
APPLY_TO_TWO: Final = 28
READ: Final = 29  # and where a table begins: how many points, whether it goes on, the points
SLOPE: Final = 30
ADD_NUMBER: Final = 31  # and which one; four operators in the order of those above, on numbers only
DIVIDE_NUMBER: Final = 34
ADD_SIGNAL: Final = 35  # and its slot, likewise
DIVIDE_SIGNAL: Final = 38
SKIP_UNLESS_BELOW: Final = 39  # nothing is what is on top, which stays


def run_code(code: Ints, begin: int, number: Floats, v: Floats, stack: Floats) -> float:
    """Return the expression whose instructions begin at `begin`, at the values `v`.

    What is on top of the stack is at hand as `x`, and `stack` has what lies below it.
    """
    x = 0.0
    below = -1
    i = begin
    while code[i] != END:
        what = code[i]
        i += 1
        if what == NUMBER:
            below += 1
            stack[below] = x
            x = number[code[i]]
            i += 1
        elif what == SIGNAL:
            below += 1
            stack[below] = x
            x = v[code[i]]
            i += 1
        elif what >= ADD_NUMBER and what <= DIVIDE_NUMBER:
            x = combined(what - ADD_NUMBER + ADD, x, number[code[i]])
            i += 1
        elif what >= ADD_SIGNAL and what <= DIVIDE_SIGNAL:
            x = combined(what - ADD_SIGNAL + ADD, x, v[code[i]])
            i += 1
        elif what >= ADD and what <= RAISE:
            x = combined(what, stack[below], x)
            below -= 1
        elif what == NEGATE:
            x = -x
        elif what == SQUARE:
            x = x * x
        elif what >= LESS and what <= UNEQUAL:
            x = 1.0 if is_so(what, stack[below], x) else 0.0
            below -= 1
        elif what == DENY:
            x = 1.0 if x == 0.0 else 0.0
        elif what == AFFIRM:
            x = 1.0 if x != 0.0 else 0.0
        elif what == SKIP:
            i += code[i] + 1
        elif what == SKIP_UNLESS or what == SKIP_IF:
            i += code[i] + 1 if (x != 0.0) == (what == SKIP_IF) else 1
            x = stack[below]
            below -= 1
        elif what == SKIP_UNLESS_BELOW:
            i += 1 if x < 0.0 else code[i] + 1
        elif what == ABSOLUTE:
            x = math.fabs(x)
        elif what == SIGN:
            x = sign_of(x)
        elif what == LENGTH:
            x = math.hypot(stack[below], x)
            below -= 1
        elif what == LEAST:
            x = least_of(stack[below], x)
            below -= 1
        elif what == GREATEST:
            x = greatest_of(stack[below], x)
            below -= 1
        elif what == APPLY:
            x = function_of(code[i], x, 0.0)
            i += 1
        elif what == APPLY_TO_TWO:
            x = function_of(code[i], stack[below], x)
            below -= 1
            i += 1
        else:
            x = looked_up(what, number, code[i], x)
            i += 1
    return x


def combined(what: int, a: float, b: float) -> float:
    """Return what an operator of arithmetic makes of two numbers."""
    if what == ADD:
        return a + b
    if what == SUBTRACT:
        return a - b
    if what == MULTIPLY:
        return a * b
    return quotient(a, b) if what == DIVIDE else power(a, b)


def is_so(what: int, a: float, b: float) -> bool:
    """Whether a comparison of two numbers holds."""
    if what == LESS:
        return a < b
    if what == LESS_OR_EQUAL:
        return a <= b
    if what == GREATER:
        return a > b
    if what == GREATER_OR_EQUAL:
        return a >= b
    return a == b if what == EQUAL else a != b


def looked_up(what: int, number: Floats, at: int, x: float) -> float:
    """Return what the table at a place among the numbers says at x, or the slope there."""
    n = int(number[at])
    goes_on = number[at + 1] != 0.0
    if what == SLOPE:
        return slope_of_table(n, number, at + 2, goes_on, x)
    return read_table(n, number, at + 2, goes_on, x)


def run_pair_code(code: Ints, begin: int, number: Floats, s: Stack) -> None:
    """Leave the pair whose instructions begin at `begin` on top of the stack."""
    i = begin
    while code[i] != END:
        what = code[i]
        i += 1
        if what == NUMBER:
            push_number(s, number[code[i]])
            i += 1
        elif what == SIGNAL:
            push_signal(s, code[i])
            i += 1
        elif what == PRIOR:
            push_prior(s, code[i])
            i += 1
        elif what >= LESS and what <= UNEQUAL:
            compare_pairs(what, s)
        elif what == DENY:
            deny(s)
        elif what == AFFIRM:
            affirm(s)
        elif what == SKIP:
            i += code[i] + 1
        elif what == SKIP_UNLESS or what == SKIP_IF:
            holds = pop_truth(s)
            i += code[i] + 1 if holds == (what == SKIP_IF) else 1
        elif what == APPLY:
            apply(s, code[i])
            i += 1
        elif what == APPLY_TO_TWO:
            apply_to_two(s, code[i])
            i += 1
        elif what == READ or what == SLOPE:
            now = looked_up(what, number, code[i], s.finite[s.top])
            was = looked_up(what, number, code[i], s.before[s.top])
            put_read(s, now, was)
            i += 1
        else:
            combine_pairs(what, s)


def combine_pairs(what: int, s: Stack) -> None:
    """Do to what is on top of the stack what an operator says."""
    if what == ADD:
        add(s)
    elif what == SUBTRACT:
        subtract(s)
    elif what == MULTIPLY:
        multiply(s)
    elif what == DIVIDE:
        divide(s)
    elif what == RAISE:
        raise_to(s)
    elif what == NEGATE:
        negate(s)
    elif what == ABSOLUTE:
        absolute(s)
    elif what == SIGN:
        put_sign(s)
    elif what == LENGTH:
        length(s)
    elif what == LEAST:
        least(s)
    else:
        greatest(s)


def compare_pairs(what: int, s: Stack) -> None:
    """Replace the two pairs on top by the truth of a comparison."""
    if what == LESS:
        less(s)
    elif what == LESS_OR_EQUAL:
        less_or_equal(s)
    elif what == GREATER:
        greater(s)
    elif what == GREATER_OR_EQUAL:
        greater_or_equal(s)
    elif what == EQUAL:
        equal(s)
    else:
        unequal(s)
