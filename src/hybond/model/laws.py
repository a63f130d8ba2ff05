"""Laws: what an element says about the variables of its ports.

A law is data. Local names are ``law:e``, ``law:f``, ``law:q``, ``law:p`` for a one-port and
``law:e1``, ``law:f2``, ... for a field; they are the element's own variables, with power
positive *into* the element (for a source: those of its bond). Other names are canonical.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from hybond.model.expressions import Expr


@dataclass(frozen=True, slots=True)
class Law:
    """One output expression per port.

    Parameters
    ----------
    output : {"e", "f"}
        Which variable the expressions give. A storage gives its co-energy variable (C: e, I: f).
    expressions : tuple of Expr
        One per port, in local and canonical names. A two-port has one: its modulus.
    matrix : tuple of tuples or None
        Set if the law is linear with constant coefficients: ``output = matrix @ argument``, the
        argument being the stored quantities of a storage, the conjugate variables of a
        resistor. Constant sources and moduli have a matrix of one entry.
    """

    output: Literal["e", "f"]
    expressions: tuple[Expr, ...]
    matrix: tuple[tuple[float, ...], ...] | None = None

    @property
    def linear(self) -> bool:
        """Whether the law is linear with constant coefficients."""
        return self.matrix is not None
