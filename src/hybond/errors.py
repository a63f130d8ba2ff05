"""Every refusal of hybond: a code, a place, a reason, a remedy.

The tree has three branches, one per exit code of the terminal: `UsageError` (1),
`ModelError` (2) and `NumericsError` (3).
"""

from __future__ import annotations

from typing import Any


class HybondError(Exception):
    """A refusal that says where, why and what to try.

    Parameters
    ----------
    why : str
        The reason, one or two sentences, values quoted.
    code : str
        The code of the page in ``docs/errors``, such as ``"HB-C101"``.
    where : str
        Dotted path, bond, mode or path in a file; empty if there is none.
    hint : str
        What to try.

    Examples
    --------
    >>> error = HybondError("no element 'bal'", code="HB-M101", where="bonds[0]", hint="ball?")
    >>> print(error)
    HB-M101 at bonds[0]: no element 'bal'
      try: ball?
    """

    exit_code = 2

    def __init__(self, why: str, *, code: str, where: str = "", hint: str = "") -> None:
        super().__init__(why)
        self.code = code
        self.where = where
        self.why = why
        self.hint = hint
        self.partial: Any = None
        """What had been computed (a `Result`), or None."""

    def __str__(self) -> str:
        place = f" at {self.where}" if self.where else ""
        remedy = f"\n  try: {self.hint}" if self.hint else ""
        return f"{self.code}{place}: {self.why}{remedy}"

    def __reduce__(self) -> Any:
        # a copy, or another process: what is said, not the partial result
        return _said_again, (type(self), self.why, self.code, self.where, self.hint)

    def to_dict(self) -> dict[str, str]:
        """Return the refusal as plain data, the ``error`` object of ``--json``."""
        return {"code": self.code, "where": self.where, "why": self.why, "try": self.hint}


def _said_again(kind: type[HybondError], why: str, code: str, where: str, hint: str) -> HybondError:
    return kind(why, code=code, where=where, hint=hint)


class UsageError(HybondError):
    """The call itself is wrong: an unknown option, solver or signal name."""

    exit_code = 1


class ModelError(HybondError):
    """The model does not mean anything, or not one thing."""

    exit_code = 2


class FileError(ModelError):
    """A model file that cannot be read."""


class ExpressionError(ModelError):
    """A text that is not an expression of the language."""


class UnitError(ModelError):
    """A unit that is unknown, or a dimension that does not fit its place."""


class CausalityError(ModelError):
    """Two causes for one variable, or none."""


class EquationError(ModelError):
    """The model has no equations of the form that was asked for."""


class NumericsError(HybondError):
    """The model means something, but the computation cannot go on."""

    exit_code = 3


class DivergenceOfTime(NumericsError):
    """A loop of instantaneous changes: time cannot advance."""
