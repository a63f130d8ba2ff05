"""The matrices of each mode in what is stored, at the model's values or at others.

A law that is no constant need not make a mode nonlinear: behind a junction that is OFF it acts on
nothing that is stored. That is found by putting two random constants in its place. If the
equations of what is stored come out the same, the law has no part in them.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from hybond.analysis.structure.generic import with_constants
from hybond.analysis.structure.stored_form import stored_form
from hybond.equations.derive import state_equations
from hybond.equations.descriptor import Descriptor
from hybond.equations.ranks import rank_of, scaled
from hybond.equations.state_form import StateEquations
from hybond.errors import EquationError, NumericsError
from hybond.model.graph import FlatGraph, Mode

SEEDS = (11, 12)
"""Of the constants that stand for laws which are none."""


class ModeMatrices:
    """The linear equations of a graph, mode by mode.

    Parameters
    ----------
    reference : tuple of int, optional
        The reference mode of the equations.

    Examples
    --------
    A damper with a cubic law, which is not there while the contact is open:

    >>> import hybond as hb
    >>> m = hb.Model("contact")
    >>> m.add(F=hb.Se(1), v=hb.One(), m=hb.I(2), hit=hb.Zero(), pad=hb.R({"e": "f^3"}))
    >>> m.bond("F -> v -> m", "v -> hit -> pad")
    >>> m.machine("S", states={"away": [], "touching": ["hit"]}, start="away")
    >>> found = ModeMatrices(m.flatten(), ()).at((0,), {0})
    >>> found.states, found.A.tolist(), found.B.tolist()
    (('m.p',), [[0.0]], [[1.0]])
    """

    def __init__(
        self, graph: FlatGraph, outputs: Sequence[str], *, reference: Mode | None = None
    ) -> None:
        self.graph = replace(graph, parametric=None)
        self.outputs = tuple(outputs)
        try:
            self.equations = self._derived(self.graph, reference, symbolic=False)
        except NumericsError:
            # a modulus reads the state: numbers with a symbol for it, which some modes do not need
            self.equations = self._derived(self.graph, reference, symbolic=True)

    @property
    def reference(self) -> Mode:
        """The reference mode of the equations."""
        return self.equations.reference

    def at(self, mode: Mode, inputs: Collection[int]) -> Descriptor:
        """Return the matrices of a mode; `inputs` are the source nodes that give columns of B.

        Raises
        ------
        EquationError, NumericsError
            If a law that is no constant has a part in the mode.
        """
        try:
            return self._stored(self.equations, mode, inputs)
        except (EquationError, NumericsError):
            a, b = (self._stored(eq, mode, inputs) for eq in self._settled)
            if not _same(a, b):
                raise
            return a

    @cached_property
    def _settled(self) -> list[StateEquations[Any]]:
        return [
            self._derived(with_constants(self.graph, seed), self.reference, symbolic=False)
            for seed in SEEDS
        ]

    def _derived(
        self, graph: FlatGraph, reference: Mode | None, *, symbolic: bool
    ) -> StateEquations[Any]:
        return state_equations(graph, outputs=self.outputs, symbolic=symbolic, reference=reference)

    def _stored(self, eq: StateEquations[Any], mode: Mode, inputs: Collection[int]) -> Descriptor:
        d = eq.at(mode)
        own = {j: eq.column(k).index for j, k in enumerate(eq.sources)}
        columns = [j for j, k in own.items() if k >= 0 and k in inputs]
        names = tuple(eq.graph.nodes[own[j]].path for j in columns)
        return stored_form(replace(d, B=d.B[:, columns], D=d.D[:, columns], inputs=names))


def _same(a: Descriptor, b: Descriptor) -> bool:
    """Whether two modes have the same equations, however their rows are combined."""
    shapes = [(m.A.shape, m.B.shape, m.C.shape) for m in (a, b)]
    if shapes[0] != shapes[1]:
        return False
    both = replace(a, E=np.vstack([a.E, b.E]), A=np.vstack([a.A, b.A]), B=np.vstack([a.B, b.B]))
    s = scaled(both)
    n = len(a.states)
    rows = np.hstack([s.E, s.A, s.B])
    outputs = all(np.allclose(getattr(a, k), getattr(b, k), rtol=1e-9, atol=0.0) for k in "CDF")
    return outputs and rank_of(rows).value == rank_of(rows[:n]).value
