"""Linear systems of a mode: at many points at once, with ranks that may be less than full.

Most rows say one thing of one variable: a source, a storage. What is left when such rows, and the
variables that only one row reads, are taken off is small; its singular values tell the rank.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]

RANK = 1e-11
"""Singular values of scaled rows below this part of the largest count as zero."""
OPEN = 1e-7
"""A change that open variables make beyond this part of itself is undetermined."""
NO_SLOPE = "a law has no finite slope here"
PIVOT = 1e-2
"""What is taken off has, scaled, at least this coefficient."""


class Undetermined(Exception):
    """What is asked for has no one value here."""


def scaled(matrix: Vector) -> tuple[Vector, Vector, Vector]:
    """Return matrices with rows and columns near one, and what rows and columns were divided by.

    Raises
    ------
    Undetermined
        For what is not finite.
    """
    found = np.array(matrix, dtype=float)
    if not np.isfinite(found).all():
        raise Undetermined(NO_SLOPE)
    rows, columns = np.ones(found.shape[:-1]), np.ones(found.shape[:-2] + found.shape[-1:])
    for _ in range(3):
        for axis, kept in ((-1, rows), (-2, columns)):
            size = np.sqrt(np.abs(found).max(axis=axis, initial=0.0))
            size[size == 0.0] = 1.0
            size = 2.0 ** np.round(np.log2(size))
            kept *= size
            found /= np.expand_dims(size, axis)
    return found, rows, columns


def rank_of(matrix: Vector) -> int:
    """Return the rank of a matrix, its rows and columns scaled.

    Examples
    --------
    >>> rank_of(np.array([[1e-9, 0.0, 0.0], [1.0, 1.0, 2.0], [0.0, 1.0, 2.0]]))
    2
    """
    if not matrix.size:
        return 0
    return int(matrix.shape[1] - _open(scaled(matrix)[0]).shape[1])


def opens(matrix: Vector, rows: Vector) -> bool:
    """Whether what a matrix makes zero moves a combination of variables, a row each.

    Examples
    --------
    >>> matrix = np.array([[1.0, 1.0, 0.0]])
    >>> opens(matrix, np.array([[2.0, 2.0, 0.0]])), opens(matrix, np.array([[0.0, 0.0, 1.0]]))
    (False, True)
    """
    unit, _, columns = scaled(matrix)
    free = _open(unit)
    if not free.shape[1]:
        return False
    own = rows / columns
    size = np.abs(own).max(axis=1, initial=0.0)
    own = own[size > 0.0] / size[size > 0.0, None]
    return bool((np.abs(own @ free) > OPEN).any())


def open_ways(matrix: Vector) -> Vector:
    """Return what a matrix makes zero, as columns.

    Examples
    --------
    >>> ways = open_ways(np.array([[1.0, 1.0, 0.0], [0.0, 0.0, 2.0]]))
    >>> ways.shape, bool(abs(ways[0, 0] + ways[1, 0]) < 1e-15)
    ((3, 1), True)
    """
    unit, _, columns = scaled(matrix)
    return np.asarray(_open(unit) / columns[:, None])


def solved(left: Vector, right: Vector) -> Vector:
    """Return the solutions of ``left @ y = right`` at points; one matrix may serve all."""
    unit, rows, columns = scaled(left)
    scaled_right = right / rows[..., None]
    if len(unit) == 1 and len(right) > 1:
        points, n, many = scaled_right.shape
        flat = scaled_right.transpose(1, 0, 2).reshape(n, points * many)
        found = np.linalg.solve(unit[0], flat).reshape(n, points, many).transpose(1, 0, 2)
    else:
        found = np.linalg.solve(unit, scaled_right)
    return np.asarray(found / columns[..., None])


def smallest(left: Vector, right: Vector) -> Vector:
    """Return solutions where matrices are singular, at all points of one rank.

    The matrices are bordered with what the first one makes zero, from both sides; what the rows
    contradict falls into the border. Where that is not regular, each is decomposed.
    """
    unit, rows, columns = scaled(left)
    scaled_right = right / rows[..., None]
    free, idle = _open(unit[0]), _open(unit[0].T)
    many, wide = unit.shape[1:]
    size = many + free.shape[1]
    if size != wide + idle.shape[1]:
        return _decomposed(unit, scaled_right, columns)
    whole = np.zeros((len(unit), size, size))
    whole[:, :many, :wide] = unit
    whole[:, :many, wide:] = idle
    whole[:, many:, :wide] = free.T
    points = max(len(unit), len(right))
    border = np.zeros((points, size, right.shape[2]))
    border[:, :many] = scaled_right
    try:
        found = solved(whole, border)[:, :wide]
    except np.linalg.LinAlgError:
        found = np.full((1, 1, 1), np.inf)
    if not np.abs(found).max(initial=0.0) < 1.0 / RANK * np.abs(border).max(initial=1.0):
        return _decomposed(unit, scaled_right, columns)
    return np.asarray(found / columns[..., None])


def _decomposed(unit: Vector, right: Vector, columns: Vector) -> Vector:
    return np.asarray(np.linalg.pinv(unit, rcond=RANK) @ right / columns[..., None])


def _open(unit: Vector) -> Vector:
    """Return what a scaled matrix makes zero, as orthogonal columns."""
    return _kernel(np.ascontiguousarray(unit).tobytes(), *unit.shape)


@lru_cache(maxsize=256)
def _kernel(content: bytes, many: int, wide: int) -> Vector:
    """Return the same; linear modes ask again and again."""
    unit = np.frombuffer(content).reshape(many, wide)
    first, last = _order(np.packbits(np.abs(unit) >= PIVOT).tobytes(),
                         np.packbits(unit != 0.0).tobytes(), many, wide)  # fmt: skip
    rows = np.setdiff1d(np.arange(many), [i for i, _ in first + last])
    columns = np.setdiff1d(np.arange(wide), [j for _, j in first + last])
    core = unit[np.ix_(rows, columns)]
    if not core.size:
        kernel = np.eye(len(columns))
    else:
        _, sizes, vt = np.linalg.svd(core)
        kernel = vt[int((sizes > RANK * sizes.max(initial=0.0)).sum()) :].T
    found = np.zeros((wide, kernel.shape[1]))
    if not kernel.shape[1]:
        return found
    found[columns] = kernel
    for i, j in reversed(last):
        found[j] = -(unit[i] @ found) / unit[i, j]
    return np.asarray(np.linalg.qr(found)[0])


@lru_cache(maxsize=512)
def _order(
    large: bytes, some: bytes, many: int, wide: int
) -> tuple[tuple[tuple[int, int], ...], tuple[tuple[int, int], ...]]:
    """Return rows that determine one variable each, one after the other, as (row, column).

    Then such in which a variable stands that no other row reads, to be found last.
    """

    def pattern(bits: bytes) -> NDArray[np.bool_]:
        flat = np.unpackbits(np.frombuffer(bits, dtype=np.uint8))[: many * wide]
        return flat.reshape(many, wide).astype(bool)

    fits, left = pattern(large), pattern(some)
    first: list[tuple[int, int]] = []
    last: list[tuple[int, int]] = []
    found = True
    while found:
        found = False
        for i in np.flatnonzero(left.sum(axis=1) == 1).tolist():
            here = np.flatnonzero(left[i])
            if len(here) == 1 and fits[i, here[0]]:
                first.append((i, int(here[0])))
                left[i], left[:, here[0]] = False, False
                found = True
    found = True
    while found:
        found = False
        for j in np.flatnonzero(left.sum(axis=0) == 1).tolist():
            here = np.flatnonzero(left[:, j])
            if len(here) == 1 and fits[here[0], j]:
                last.append((int(here[0]), j))
                left[here[0]], left[:, j] = False, False
                found = True
    return tuple(first), tuple(last)
