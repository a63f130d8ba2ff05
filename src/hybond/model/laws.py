"""Laws: what an element says about the variables of its ports, or a junction about its pair.

A law is data. Local names are ``law:e``, ``law:f``, ``law:q``, ``law:p`` for a one-port and
``law:e1``, ``law:f2``, ... for a field; they are the element's own variables, with power
positive *into* the element (for a source: those of its bond). Other names are canonical.
"""

from __future__ import annotations

from typing import Literal

from hybond.model.expressions import Expr
from hybond.records import dataclass


@dataclass(frozen=True, slots=True)
class Law:
    """One output expression per port."""

    output: Literal["e", "f"]
    """Which variable the expressions give. A storage gives its co-energy variable (C: e, I: f)."""
    expressions: tuple[Expr, ...]
    """One per port, in local and canonical names. A two-port has one: its modulus."""
    matrix: tuple[tuple[float, ...], ...] | None = None
    """Set if the law is linear with constant coefficients: ``output = matrix @ argument``, the
    argument being the stored quantities of a storage, the conjugate variables of a resistor.
    Constant sources and moduli have a matrix of one entry."""

    @property
    def linear(self) -> bool:
        """Whether the law is linear with constant coefficients."""
        return self.matrix is not None


TWO_SIDED = ("coulomb", "relay")
"""Laws of junctions whose common variable may have either sign."""


@dataclass(frozen=True, slots=True)
class JunctionLaw:
    """The law of a junction, in canonical names."""

    kind: str
    """``diode``, ``thyristor``, ``unilateral``, ``coulomb`` or ``relay``; see `junction_laws`."""
    node: int
    """The junction."""
    common: Expr
    net: Expr
    """`common` and `net`: the conjugate pair; `net` leaves out the source that the law itself
    brought in."""
    limit: Expr | None = None
    breakaway: Expr | None = None
    """`limit` and `breakaway`: of ``coulomb`` and ``relay``: what the net variable is while it
    slides, and at most at rest."""
    gap: Expr | None = None
    """Distance: the contact can be closed only where it is not positive."""
    gate: Expr | None = None
    """Condition under which a thyristor may begin to conduct."""
    restitution: Expr | None = None
    """Newton's coefficient."""
    stiffness: Expr | None = None
    """Of the contact, for impact laws that spread an impact over several contacts."""
    source: int | None = None
    """The source that the law brought in."""
    impulsive: bool = False
    """Whether friction may carry an impulse."""
    second: JunctionLaw | None = None
    """Friction in two directions: the law of the other junction of the pair."""
    planar: bool = False
    """Whether the law is one of such a pair."""

    @property
    def junctions(self) -> tuple[JunctionLaw, ...]:
        """The law of each junction that the machine stands for: two of friction in the plane."""
        return (self,) if self.second is None else (self, self.second)

    @property
    def two_sided(self) -> bool:
        """Whether the common variable may have either sign."""
        return self.kind in TWO_SIDED
