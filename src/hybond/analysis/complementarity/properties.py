"""What the matrices of a complementarity system say: passivity, relative degrees.

A passive system with D positive semi-definite has a solution from every state (Camlibel, Heemels
and Schumacher, *On linear passive complementarity systems*, European J. Control 8 (2002)).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hybond.equations.storage import stiffness_at
from hybond.model.expressions import names

if TYPE_CHECKING:
    from hybond.analysis.complementarity.form import ComplementarityForm

Matrix = NDArray[np.float64]
SMALL = 1e-9
"""Part of the largest entry below which an eigenvalue counts as zero."""


@dataclass(frozen=True, slots=True)
class Properties:
    """Properties of a complementarity system, in numbers."""

    semidefinite: bool
    """Whether ``D + D^T`` is positive semi-definite."""
    passive: bool
    """Whether what is stored is a storage function: its rate, sources being zero, is at most ``l .
    w``. Sufficient: another function may do where this one does not."""
    degrees: tuple[int | None, ...]
    """Of each port: 0 if `l` acts on its own `w` at once, 1 if through one storage, and so on; None
    if not at all."""
    follow: tuple[int, ...] = ()
    """Ports whose limit of friction follows other bond variables, such as a contact force: then
    neither D nor passivity says that the laws have an answer, or only one."""

    def sentences(self, given: tuple[str, ...], answers: tuple[str, ...]) -> list[str]:
        """Return the properties in words."""
        first = "D is positive semidefinite" if self.semidefinite else "D is not semidefinite"
        passive = "passive: what is stored is a storage function"
        other = "not passive by what is stored (another storage function may do)"
        found = [f"{first}; {passive if self.passive else other}"]
        if self.follow:
            names = ", ".join(given[k] for k in self.follow)
            found.append(
                f"the limit of {names} follows other variables: there may be no answer, or "
                "several, whatever D is (Painleve)"
            )
        for degree in sorted({d for d in self.degrees if d is not None}):
            pairs = [
                f"{g} acts on {w}"
                for g, w, d in zip(given, answers, self.degrees, strict=True)
                if d == degree
            ]
            how = {0: "at once", 1: "through storage"}.get(degree, f"through {degree} storages")
            found.append(f"{', '.join(pairs)} {how} (relative degree {degree})")
        pairs = [
            f"{g} on {w}" for g, w, d in zip(given, answers, self.degrees, strict=True) if d is None
        ]
        if pairs:
            found.append(f"does not act at all: {', '.join(pairs)}")
        return found


def properties_of(form: ComplementarityForm) -> Properties:
    """Return the properties of a complementarity system at the values of the model."""
    m = form.numbers()
    a, e, c, d = (np.asarray(m[k]) for k in "AECD")
    follow = tuple(
        k
        for k, law in enumerate(form.laws)
        for limit in [law.limit]
        if limit is not None and any(name[:2] in ("e:", "f:") for name in names(limit))
    )
    return Properties(
        _semidefinite(d + d.T, d), _passive(form, a, e, c, d), _degrees(a, e, c, d), follow
    )


def _semidefinite(symmetric: Matrix, terms: Matrix | None = None) -> bool:
    """Whether it is so but for rounding; `terms` are what it is the sum of."""
    if not symmetric.size:
        return True
    values = np.linalg.eigvalsh(symmetric)
    size = float(np.abs(symmetric if terms is None else terms).max())
    return bool(values.min() >= -SMALL * max(size, 1e-300))


def _passive(form: ComplementarityForm, a: Matrix, e: Matrix, c: Matrix, d: Matrix) -> bool:
    """Whether ``x' K x <= l w`` for all consistent x and all l, K the slope of what is stored."""
    graph = form.graph
    x = np.array(list(form.point.values())) if form.point is not None else np.zeros(len(a))
    k = stiffness_at(graph, x)
    if not np.isfinite(k).all() or not _semidefinite(k + k.T):
        return False
    if any(graph.bonds[s.bond].domain.pseudo for s in graph.storages):
        return False
    rows = form.constraint_rows
    onto = _null(rows) if len(rows) else np.eye(len(a))
    moved = onto.T @ (k @ a) @ onto
    both = onto.T @ (k @ e - c.T)
    whole: Any = np.block([[moved + moved.T, both], [both.T, -(d + d.T)]])
    # what is left of terms that cancel is rounding
    wide = np.abs(onto)
    terms = wide.T @ np.abs(k) @ np.abs(a) @ wide
    mixed = wide.T @ (np.abs(k) @ np.abs(e) + np.abs(c).T)
    size: Any = np.block([[terms + terms.T, mixed], [mixed.T, np.abs(d) + np.abs(d.T)]])
    whole = np.where(np.abs(whole) <= SMALL * size, 0.0, whole)
    # states and laws have units of their own: scale each before the sizes are compared
    scale = np.sqrt(np.maximum(np.diag(size), SMALL * size.max(axis=1, initial=0.0)))
    scale[scale == 0.0] = 1.0
    return _semidefinite(-whole / np.outer(scale, scale), np.eye(len(whole)))


def _null(rows: Matrix) -> Matrix:
    _, s, vt = np.linalg.svd(rows)
    rank = int((s > SMALL * s.max(initial=0.0)).sum())
    found = vt[rank:].T
    return np.where(np.abs(found) <= SMALL, 0.0, found)


def _degrees(a: Matrix, e: Matrix, c: Matrix, d: Matrix) -> tuple[int | None, ...]:
    found: list[int | None] = []
    n = len(a)
    for k in range(len(d)):
        degree: int | None = 0
        if d[k, k] == 0.0:
            degree = None
            row, size = c[k], np.abs(c[k])
            for order in range(1, n + 1):
                if abs(row @ e[:, k]) > 1e-12 * float(size @ np.abs(e[:, k])):
                    degree = order
                    break
                row, size = row @ a, size @ np.abs(a)
        found.append(degree)
    return tuple(found)
