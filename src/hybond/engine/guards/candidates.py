"""Instants of a block at which a guard may hold although no sample says so.

An even number of crossings between two samples shows as an extremum that nearly reaches zero; a
window between the roots of two comparisons may be narrower than the sampling.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import Engine
from hybond.engine.guards.bracket import SEARCH, root
from hybond.engine.guards.guard_shape import NEAR, floor_of, rest_of
from hybond.engine.guards.guard_values import atom_at
from hybond.engine.guards.locator import FRACTION, GRID, SAMPLES, Instants, Locator
from hybond.engine.words import floats

AROUND: Final = 6
"""Grid points on either side of an extremum of the polynomial where the true one is sought."""


def keep(list_of: Instants, t: float) -> None:
    """Add an instant."""
    if list_of.count == list_of.room:
        old = list_of.at
        list_of.room *= 2
        list_of.at = floats(list_of.room)
        for k in range(list_of.count):
            list_of.at[k] = old[k]
    list_of.at[list_of.count] = t
    list_of.count += 1


def sort(list_of: Instants) -> None:
    """Put instants in order."""
    a = list_of.at
    for i in range(1, list_of.count):
        t = a[i]
        j = i
        while j > 0 and a[j - 1] > t:
            a[j] = a[j - 1]
            j -= 1
        a[j] = t


def between_roots(e: Engine, g: Locator, first: int, stop: int, end: float) -> None:
    """Ask halfway between any two neighbouring roots of the comparisons of one guard.

    A window between two crossings may be narrower than the sampling.
    """
    c = g.candidate
    for a in range(first, stop):
        for i in range(SAMPLES - 1):
            here = g.shape[a * SAMPLES + i]
            there = g.shape[a * SAMPLES + i + 1]
            turns = (here > 0.0 and there < 0.0) or (here < 0.0 and there > 0.0)
            if turns and g.t[i] < end and not g.failed:
                keep(g.mark, root(e, g, a, g.t[i], g.t[i + 1]))
    if g.mark.count == 0:
        return
    roots = g.mark.count
    for i in range(roots):
        keep(c, g.mark.at[i])
    for i in range(SAMPLES):
        keep(g.mark, g.t[i])
    sort(g.mark)
    for i in range(g.mark.count - 1):
        if g.mark.at[i + 1] - g.mark.at[i] > 0.0:
            keep(c, 0.5 * (g.mark.at[i] + g.mark.at[i + 1]))


def beside(e: Engine, g: Locator, a: int, c: float) -> None:
    """Mark the roots of a comparison on both sides of an extremum beyond zero between samples.

    Another comparison may hold on one side of it only: of a ball that grazes, on the way up.
    """
    after = 0
    while after < SAMPLES and g.t[after] < c:
        after += 1
    if after == 0 or after == SAMPLES or g.t[after] == c:
        return
    low = g.t[after - 1]
    high = g.t[after]
    middle = atom_at(e, g, a, c)
    if atom_at(e, g, a, low) * middle < 0.0:
        keep(g.mark, root(e, g, a, low, c))
    if atom_at(e, g, a, high) * middle < 0.0:
        keep(g.mark, root(e, g, a, c, high))


def extrema(e: Engine, g: Locator, a: int, end: float) -> None:
    """Add extrema of a comparison that reach, or nearly reach, zero between samples."""
    least = g.shape[a * SAMPLES]
    most = least
    for i in range(SAMPLES):
        least = min(least, g.shape[a * SAMPLES + i])
        most = max(most, g.shape[a * SAMPLES + i])
    near = NEAR * (most - least) + 3.0 * rest_of(g, a)
    # nothing to find where the polynomial cannot come so near
    up = most > 0.0 and not floor_of(g, least, most, 1.0) > near
    down = least < 0.0 and not floor_of(g, least, most, -1.0) > near
    if up or down:
        put_polynomial(g, a)
    if up:
        dips(e, g, a, 1.0, near, end)
    if down:
        dips(e, g, a, -1.0, near, end)


def put_polynomial(g: Locator, a: int) -> None:
    """Put the polynomial through the samples of a comparison there, on the grid."""
    for i in range(GRID):
        total = 0.0
        for j in range(SAMPLES):
            total += g.fine[i * SAMPLES + j] * g.shape[a * SAMPLES + j]
        g.polynomial[i] = total


def grid_time(g: Locator, k: int) -> float:
    """Return the instant of a point of the grid."""
    return g.t[0] + (g.t[SAMPLES - 1] - g.t[0]) * (float(k) / float(GRID - 1))


def dips(e: Engine, g: Locator, a: int, sign: float, near: float, end: float) -> None:
    """Add minima of ``sign * comparison`` near zero, between samples where it is positive."""
    last = GRID - 1
    fine = g.polynomial
    d = g.d
    for i in range(SAMPLES):
        d[i] = sign * g.shape[a * SAMPLES + i]
    after = 0
    for i in range(1, last):
        while after < SAMPLES and FRACTION[after] <= float(i) / float(last):
            after += 1
        here = sign * fine[i]
        if (
            here <= near
            and here <= sign * fine[i - 1]
            and here <= sign * fine[i + 1]
            and d[after - 1] > 0.0
            and d[after] > 0.0
        ):
            dip(e, g, a, max(i - AROUND, 0), min(i + AROUND, last), sign, end)
    # the polynomials of two neighbouring blocks may each place an extremum in the other
    for side in range(2):
        edge = 0 if side == 0 else last
        away = AROUND if side == 0 else last - AROUND
        at = d[0] if side == 0 else d[SAMPLES - 1]
        if not (at > 0.0 and at <= near and sign * fine[edge] <= sign * fine[away]):
            continue
        begin = grid_time(g, edge)
        there = grid_time(g, away)
        if sign * atom_at(e, g, a, begin + 1e-3 * (there - begin)) < at:
            dip(e, g, a, min(edge, away), max(edge, away), sign, end)


def dip(e: Engine, g: Locator, a: int, first: int, stop: int, sign: float, end: float) -> None:
    """Add the instant between two points of the grid where ``sign * comparison`` is least.

    Golden section; it ends where zero is reached.
    """
    low = grid_time(g, first)
    high = grid_time(g, stop)
    if not low < end or g.failed:
        return
    ratio = 0.5 * (math.sqrt(5.0) - 1.0)
    c = high - ratio * (high - low)
    d = low + ratio * (high - low)
    fc = sign * atom_at(e, g, a, c)
    fd = sign * atom_at(e, g, a, d)
    for _ in range(SEARCH):
        if min(fc, fd) <= 0.0:
            break
        if fc < fd:
            high = d
            d = c
            fd = fc
            c = high - ratio * (high - low)
            fc = sign * atom_at(e, g, a, c)
        else:
            low = c
            c = d
            fc = fd
            d = low + ratio * (high - low)
            fd = sign * atom_at(e, g, a, d)
    keep(g.candidate, c if fc <= fd else d)
