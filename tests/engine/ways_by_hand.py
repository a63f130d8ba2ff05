"""Ways on from switching surfaces, found by trying all choices."""

from __future__ import annotations

import itertools

import numpy as np
from hypothesis import strategies as st


def ways_by_hand(a: np.ndarray, b: np.ndarray) -> list[np.ndarray]:
    """Return all w in [0, 1]^k with dg/dt = a + B w such that each g that moves has chosen."""
    found: list[np.ndarray] = []
    k = len(a)
    for choice in itertools.product((0.0, 1.0, None), repeat=k):
        # a row each: w_j given, or dg_j/dt = 0
        rows = np.array([np.eye(k)[j] if c is not None else b[j] for j, c in enumerate(choice)])
        right = np.array([c if c is not None else -a[j] for j, c in enumerate(choice)])
        if abs(np.linalg.det(rows)) < 1e-12:
            continue
        w = np.linalg.solve(rows, right)
        speed = a + b @ w
        fits = [
            -1e-12 <= w[j] <= 1 + 1e-12 if c is None else speed[j] * (2 * c - 1) >= -1e-12
            for j, c in enumerate(choice)
        ]
        if all(fits) and not any(np.abs(w - other).max() < 1e-9 for other in found):
            found.append(w)
    return found


entries = st.integers(-20, 20).map(lambda n: n / 10.0)


@st.composite
def switching(draw, most: int = 4):
    k = draw(st.integers(1, most))
    b = np.array([[draw(entries) for _ in range(k)] for _ in range(k)])
    b[np.diag_indices(k)] = -np.abs(b.diagonal()) - 0.5
    a = np.array([draw(entries) + 0.013 * (j + 1) for j in range(k)])
    return a, b
