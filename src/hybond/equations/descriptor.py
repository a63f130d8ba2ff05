"""The equations of one mode as matrices: ``E v' = A v + B u``, ``y = C v + D u + F v'``.

`v` holds the stored quantities, in the graph's order, and after them the pseudo-states: variables
that the elimination kept because no formula gives them in all modes. E has no entries for those.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybond.errors import EquationError

Matrix = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Descriptor:
    """A linear mode in descriptor form.

    Examples
    --------
    >>> d = Descriptor.of([[1.0]], [[-2.0]], [[1.0]], states=("q",), inputs=("u",))
    >>> d.poles()
    array([-2.])
    """

    E: Matrix
    A: Matrix
    """Shape (n, n). `E` and `A`: n stored quantities and pseudo-states. E is the identity if all
    storage is integral."""
    B: Matrix
    """Shape (n, p)."""
    C: Matrix
    D: Matrix
    F: Matrix
    """Shapes (q, n), (q, p), (q, n). `C`, `D` and `F`: F is zero unless an output reads the rate of
    storage in derivative causality."""
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    """`states`, `inputs` and `outputs`: what the columns of A and B and the rows of C are called;
    `states` has the pseudo-states at its end."""
    stored: int
    """How many of `states` are stored quantities."""
    undetermined: tuple[str, ...] = ()
    """Outputs that the mode leaves open; their rows are those of one choice among many."""

    @staticmethod
    def of(
        E: object,
        A: object,
        B: object,
        *,
        states: tuple[str, ...],
        inputs: tuple[str, ...],
        C: object = (),
        D: object = (),
        outputs: tuple[str, ...] = (),
        stored: int | None = None,
    ) -> Descriptor:
        """Return a descriptor of plain lists; no outputs unless given."""
        n, p, q = len(states), len(inputs), len(outputs)
        return Descriptor(
            np.array(E, dtype=float).reshape(n, n),
            np.array(A, dtype=float).reshape(n, n),
            np.array(B, dtype=float).reshape(n, p),
            np.array(C, dtype=float).reshape(q, n),
            np.array(D, dtype=float).reshape(q, p),
            np.zeros((q, n)),
            states,
            inputs,
            outputs,
            n if stored is None else stored,
        )

    def poles(self) -> NDArray[np.generic]:
        """Return the finite generalised eigenvalues of (A, E), sorted by real part, 1/s.

        Raises
        ------
        EquationError
            HB-Q105 if the pencil is singular: the mode has no unique solution.
        """
        from hybond.equations.pencil import analyse

        found = analyse(self).poles
        if found is None:
            raise EquationError(
                "the equations of this mode do not determine all states",
                code="HB-Q105",
                where="the equations",
                hint="hybond analyse tells what is undetermined",
            )
        return found

    def response(self, s: complex) -> NDArray[np.complex128]:
        """Return the transfer matrix at the complex frequency `s`, shape (q, p)."""
        v = np.linalg.solve(s * self.E - self.A, self.B.astype(complex))
        return np.asarray((self.C + s * self.F) @ v + self.D)
