"""Limits of friction that vary: they must stay what friction can have.

A limit that is a number is looked at when the model is made. One that follows a force or the time
may become negative in a run, mostly because of the sign of that force: friction would then push.
"""

from __future__ import annotations

from collections.abc import Sequence

from hybond.errors import NumericsError
from hybond.model.expressions import Expr, Number
from hybond.model.laws import JunctionLaw
from hybond.programs.program import Program

ROUNDING = 1e-6
"""Part of the largest limit so far up to which a limit below zero is one that ends there."""


class FrictionLimits:
    """Watches the limits of a program's friction that are no numbers."""

    def __init__(self, program: Program) -> None:
        self.program = program
        self.laws = {
            m.path: m.law
            for m in program.graph.machines
            if m.law is not None and any(_varies(m.law))
        }
        self._largest: dict[str, float] = {}

    def check(self, t: float, v: Sequence[float]) -> None:
        """Look at all values `v` of one instant.

        Raises
        ------
        NumericsError
            HB-N407 for a limit below zero, or above that of breaking loose.
        """
        for path, law in self.laws.items():
            assert law.limit is not None
            limit = self._value(law.limit, v)
            breakaway = limit if law.breakaway is None else self._value(law.breakaway, v)
            largest = max(abs(limit), abs(breakaway), self._largest.get(path, 0.0))
            self._largest[path] = largest
            if min(limit, breakaway) < -ROUNDING * largest:
                raise _refusal(
                    path,
                    f"the limit of the friction is {min(limit, breakaway):.6g} at t = {t:.9g} s: "
                    "it would push",
                    "a size: abs(...), or the other sign of the force that it follows",
                )
            if breakaway < limit - ROUNDING * largest:
                raise _refusal(
                    path,
                    f"friction breaks loose at {breakaway:.6g} and slides with {limit:.6g} at "
                    f"t = {t:.9g} s",
                    "a breakaway of at least the limit",
                )

    def _value(self, e: Expr, v: Sequence[float]) -> float:
        return e.value if isinstance(e, Number) else float(self.program.compile(e)(v))


def _varies(law: JunctionLaw) -> list[bool]:
    """Return for each limit that a law has whether it is no number."""
    limits = (law.limit, law.breakaway)
    return [not isinstance(e, Number) for e in limits if e is not None]


def _refusal(path: str, why: str, hint: str) -> NumericsError:
    return NumericsError(why, code="HB-N407", where=path, hint=hint)
