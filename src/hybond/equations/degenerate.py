"""Modes that leave something undetermined: what matters of their equations.

A floating node, a ring of ideal switches: a kept variable may have no influence on any rate, and
a row may say what other rows say. Both are left out of the matrices of that mode, and the outputs
that read such a variable are named: their value is free. What is left is square, unless the mode
truly determines too little of what is stored, or contradicts itself.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hybond.equations.descriptor import Descriptor
from hybond.equations.ranks import scaled

Matrix = NDArray[np.float64]

INDEPENDENT = 1e-10
"""A column that others explain up to this part of its size is dependent on them."""


def independent(matrix: Matrix) -> list[int]:
    """Return columns that form a basis of the column space, the first ones that do.

    Examples
    --------
    >>> independent(np.array([[1.0, 2.0, 0.0], [1.0, 2.0, 1.0]]))
    [0, 2]
    """
    basis: list[Matrix] = []
    found = []
    for k in range(matrix.shape[1]):
        column = matrix[:, k]
        size = float(np.linalg.norm(column))
        if size == 0.0:
            continue
        rest = column / size
        for _ in range(2):  # twice is enough for orthogonality
            for b in basis:
                rest = rest - (b @ rest) * b
        if np.linalg.norm(rest) > INDEPENDENT:
            basis.append(rest / np.linalg.norm(rest))
            found.append(k)
    return found


def effective(
    E: Matrix, A: Matrix, B: Matrix, stored: int
) -> tuple[list[int], list[int], Matrix] | None:
    """Return which rows and kept variables of a mode matter.

    It is decided in scaled units: beside a stiffness of 1e13 Pa/m^3, two rows in SI that differ by
    an area of 1e-3 m^2 are one.

    Parameters
    ----------
    E, A, B : array, shapes (r, n), (r, n), (r, p)
    stored : int
        The first columns of E and A; those after them are kept variables.

    Returns
    -------
    rows, columns : list of int
        Into `A`; as many rows as columns.
    free : array, shape (n, k)
        Directions of kept variables that no row sees.
    None
        If no square system is left.
    """
    n = A.shape[1]
    none = np.zeros((0, n))
    unit = scaled(Descriptor(E, A, B, none, np.zeros((0, B.shape[1])), none, (), (), (), stored))
    kept = independent(unit.A[:, stored:])
    columns = [*range(stored), *(stored + k for k in kept)]
    inside = set(columns)
    lost = [k for k in range(stored, n) if k not in inside]
    free = np.zeros((n, len(lost)))
    if lost:
        share = np.linalg.lstsq(unit.A[:, columns[stored:]], unit.A[:, lost], rcond=None)[0]
        free[lost, range(len(lost))] = 1.0
        free[columns[stored:], :] = -share
        free *= unit.columns[:, None] / unit.columns[lost]
    # rows with rates first: a row that repeats others is then one without
    order = sorted(range(len(A)), key=lambda i: (not E[i].any(), i))
    whole = np.hstack([unit.E, unit.A[:, columns], unit.B])[order]
    rows = sorted(order[k] for k in independent(whole.T))
    return (rows, columns, free) if len(rows) == len(columns) else None
