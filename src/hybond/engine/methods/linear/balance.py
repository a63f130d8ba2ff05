"""The matrix of a motion in units in which it is balanced.

In other units the norm is often much smaller. Sources: E. E. Osborne, J. ACM 7(4), 1960; B. N.
Parlett, C. Reinsch, Numer. Math. 13, 1969.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import Places, Rows, fit, fit_rows
from hybond.engine.methods.linear.flow_records import Flow
from hybond.engine.words import Floats

SWEEPS: Final = 12


def balance(n: int, a: Floats, d: Floats) -> None:
    """Put powers of two there for which ``a[i, j] d[j]/d[i]``, put into `a`, is even."""
    for i in range(n):
        d[i] = 1.0
    for _ in range(SWEEPS):
        settled = True
        for i in range(n):
            row = 0.0
            column = 0.0
            for j in range(n):
                if j != i:
                    row += math.fabs(a[i * n + j])
                    column += math.fabs(a[j * n + i])
            if row == 0.0 or column == 0.0:
                continue
            exponent = math.floor(0.5 * math.log(row / column) / math.log(2.0) + 0.5)
            factor = math.pow(2.0, exponent)
            if exponent == 0.0 or column * factor + row / factor >= 0.95 * (row + column):
                continue
            for j in range(n):
                if j != i:
                    a[j * n + i] *= factor
                    a[i * n + j] /= factor
            d[i] *= factor
            settled = False
        if settled:
            return


def take_matrix(f: Flow, n: int, a: Floats) -> None:
    """Take a matrix, which is balanced in its place, as that of a flow."""
    f.n = n
    fit(f.scale, n)
    balance(n, a, f.scale.at)
    f.norm = put_rows(f.rows, n, a)
    f.levels = 0
    take_unit(f)


def put_rows(rows: Rows, n: int, a: Floats) -> float:
    """Put what is not zero of a matrix into `rows`; return its norm."""
    entries = 0
    norm = 0.0
    for i in range(n):
        total = 0.0
        for j in range(n):
            total += math.fabs(a[i * n + j])
            entries += 1 if a[i * n + j] != 0.0 else 0
        norm = max(norm, total)
    fit_rows(rows, n, entries)
    entries = 0
    for i in range(n):
        rows.first.at[i] = entries
        for j in range(n):
            if a[i * n + j] != 0.0:
                rows.column.at[entries] = j
                rows.value.at[entries] = a[i * n + j]
                entries += 1
    rows.first.at[n] = entries
    return norm


def take_unit(f: Flow) -> None:
    """Take a unit of time that fits the norm."""
    f.unit = math.inf
    if f.norm > 0.0:
        f.unit = 1.0
        while f.unit * f.norm > 1.0:
            f.unit *= 0.5
        while f.unit * f.norm <= 0.5:
            f.unit *= 2.0


def even_unread(f: Flow, a: Floats, storages: int, states: int, order: Places) -> None:
    """Measure storages that nothing reads as what they read, in the balanced matrix there.

    Balance says nothing of their units, nor of those that only such states read. In these the rate
    of a storage is as fast as the others' that stand in it: a capacitor that another one is tied to
    follows as fast as that one moves. `order` is room for as many places as there are states.
    """
    n = f.n
    found = 0
    more = True
    for i in range(states):
        order.at[i] = -1
    while more:
        more = False
        for i in range(states):
            if order.at[i] < 0 and is_unread(a, n, i, states, order):
                order.at[i] = found
                found += 1
                more = True
    # those that were found last are read by those before them
    for step in range(found - 1, -1, -1):
        for i in range(states):
            if order.at[i] == step:
                even_row(f, a, i, states, i < storages)
    if found > 0:
        put_rows(f.rows, n, a)


def is_unread(a: Floats, n: int, j: int, states: int, order: Places) -> bool:
    """Whether no rate reads a state, but those that were found to be such."""
    for i in range(states):
        if a[i * n + j] != 0.0 and order.at[i] < 0:
            return False
    return True


def even_row(f: Flow, a: Floats, i: int, states: int, grows: bool) -> None:
    """Measure state i so that its row is as large as the norm, or if not `grows` no larger."""
    n = f.n
    row = 0.0
    reads = False
    for j in range(n):
        row += math.fabs(a[i * n + j])
        reads = reads or (j < states and a[i * n + j] != 0.0)
    if not reads or (row <= f.norm and not grows):
        return
    factor = math.pow(2.0, math.floor(math.log(f.norm / row) / math.log(2.0)))
    for j in range(n):
        a[i * n + j] *= factor
    for k in range(states):
        a[k * n + i] /= factor
    f.scale.at[i] /= factor
