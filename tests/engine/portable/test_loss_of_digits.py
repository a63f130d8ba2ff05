"""Elimination knows how many digits it lost: held against the same sums with fractions."""

import math
import sys
from fractions import Fraction

import numpy as np
import pytest

from hybond.engine.mode.elimination import Elimination, add_row, give, make_elimination

KNOWN = 2
Matrix = list[list[Fraction]]


def eliminated(rows: Matrix, n: int) -> Elimination:
    e = make_elimination(n, n + KNOWN)
    for row in rows:
        for k, c in enumerate(row):
            if c:
                give(e, k, float(c))
        assert add_row(e) == -1
    return e


def solved(rows: Matrix, n: int) -> Matrix:
    """What the knowns add to each unknown, by Gauss and Jordan without rounding."""
    a = [list(row) for row in rows]
    for k in range(n):
        pivot = next(i for i in range(k, n) if a[i][k])
        a[k], a[pivot] = a[pivot], a[k]
        a[k] = [c / a[k][k] for c in a[k]]
        for i in range(n):
            if i != k and a[i][k]:
                factor = a[i][k]
                a[i] = [x - factor * y for x, y in zip(a[i], a[k], strict=True)]
    return [row[n:] for row in a]


def ladder(seed: int) -> tuple[Matrix, int]:
    """Node potentials and currents of a random net of resistors over ten powers of ten."""
    draw = np.random.default_rng(seed)
    nodes = int(draw.integers(2, 6))
    edges = [(k, int(draw.integers(-1, k))) for k in range(nodes)]
    edges += [tuple(int(i) for i in draw.integers(-1, nodes, 2)) for _ in range(nodes)]
    edges = [(a, b) for a, b in edges if a != b]
    n = nodes + len(edges)
    rows = []
    for i, (a, b) in enumerate(edges):
        row = [Fraction(0)] * (n + KNOWN)
        row[nodes + i] = Fraction(float(10.0 ** draw.uniform(-5, 5)))
        for node, sign in ((a, -1), (b, 1)):
            if node >= 0:
                row[node] += sign
        rows.append(row)
    for node in range(nodes):
        row = [Fraction(0)] * (n + KNOWN)
        for i, (a, b) in enumerate(edges):
            row[nodes + i] += (a == node) - (b == node)
        row[n + int(draw.integers(0, KNOWN))] = Fraction(float(draw.normal()))
        rows.append(row)
    return rows, n


@pytest.mark.parametrize("seed", range(40))
def test_no_more_is_lost_than_it_says(seed: int) -> None:
    rows, n = ladder(seed)
    e, exact = eliminated(rows, n), solved(rows, n)
    for k in range(n):
        for i in range(e.first[k], e.first[k] + e.count[k]):
            assert e.column.at[i] >= n
            true = exact[k][e.column.at[i] - n]
            off = float(abs(Fraction(e.entry.at[i]) - true))
            assert off <= 8.0 * sys.float_info.epsilon * e.loss.at[i]
            assert e.loss.at[i] >= abs(e.entry.at[i])


@pytest.mark.parametrize("seed", range(40))
def test_entries_and_their_rests_have_twice_the_digits(seed: int) -> None:
    rows, n = ladder(seed)
    e, exact = eliminated(rows, n), solved(rows, n)
    for k in range(n):
        for i in range(e.first[k], e.first[k] + e.count[k]):
            true = exact[k][e.column.at[i] - n]
            assert e.entry.at[i] == pytest.approx(float(true), rel=2.0**-52)
            off = float(abs(Fraction(e.entry.at[i]) + Fraction(e.rest.at[i]) - true))
            assert off <= 2.0**-96 * e.loss.at[i]


def test_what_cancelled_is_known_to_be_uncertain() -> None:
    # x + y = a, x + (1 + 2^-30) y = b: y is 2^30 (b - a), of which thirty binary digits are lost
    small = Fraction(1, 2**30)
    one = Fraction(1)
    e = eliminated([[one, one, -one, 0 * one], [one, 1 + small, 0 * one, -one]], 2)
    losses = [e.loss.at[i] / abs(e.entry.at[i]) for i in range(e.first[1], e.first[1] + 2)]
    assert [math.log2(x) for x in losses] == pytest.approx([31, 31], abs=2)


def test_what_does_not_cancel_loses_little() -> None:
    # a chain of equal resistors from a source: sums of terms of one sign
    n = 60
    rows = []
    for k in range(n):
        row = [Fraction(0)] * (n + KNOWN)
        row[k] = Fraction(1)
        row[k - 1 if k else n] = Fraction(-1, 2)
        rows.append(row)
    e = eliminated(rows, n)
    for k in range(n):
        assert e.loss.at[e.first[k]] <= 4 * (k + 1) * abs(e.entry.at[e.first[k]])
