"""Every refusal of hybond: a code, a place, a reason, a remedy.

The tree has three branches, one per exit code of the terminal: `UsageError` (1),
`ModelError` (2) and `NumericsError` (3).
"""

from __future__ import annotations

import re
from typing import Any, Self

LONGEST = 2000
"""Letters of a reason, a remedy or a place: what is quoted in it may be a megabyte."""
LONGEST_WORD = 400
"""Letters of it without a space between."""
_UNSEEN = (
    "[\x00-\x09\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ufeff\ud800-\udfff]"
)
"""What a terminal obeys or cannot write, and what turns the direction of writing around."""


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
        self.why = _readable(why)
        super().__init__(self.why)
        self.code = code
        self.where = where
        self.hint = _readable(hint)
        self.file = ""
        """The file that says it, empty if none does."""
        self.line: int | None = None
        """The line of that file, from 1."""
        self.written = ""
        """What that line says."""
        self.partial: Any = None
        """What had been computed (a `Result`), or None."""

    def said_in(self, file: str, line: int | None = None, written: str = "") -> Self:
        """Note the file that says what is refused, and return the refusal.

        Examples
        --------
        >>> error = ModelError("'10 kg' is in kg", code="HB-U103", where="elements.r.R")
        >>> print(error.said_in("rc.toml", 4, 'r = { R = "10 kg" }'))
        HB-U103 at rc.toml:4: elements.r.R: '10 kg' is in kg
            4 | r = { R = "10 kg" }
        """
        self.file, self.line, self.written = file, line, written
        return self

    @property
    def place(self) -> str:
        """File, line and path, as far as they are known: ``rc.toml:4: elements.r.R``."""
        if not self.file or self.where.startswith(self.file):
            return self.where
        file = f"{self.file}:{self.line}" if self.line else self.file
        return f"{file}: {self.where}" if self.where else file

    def __str__(self) -> str:
        place = f" at {_readable(self.place)}" if self.place else ""
        line = f"\n    {self.line} | {_readable(self.written)}" if self.written else ""
        remedy = f"\n  try: {self.hint}" if self.hint else ""
        return f"{self.code}{place}: {self.why}{line}{remedy}"

    def __reduce__(self) -> Any:
        # a copy, or another process: what is said, not the partial result
        said = (self.why, self.code, self.where, self.hint)
        return _said_again, (type(self), *said, self.file, self.line, self.written)

    def to_dict(self) -> dict[str, Any]:
        """Return the refusal as plain data, the ``error`` object of ``--json``."""
        said = {"code": self.code, "where": self.where, "why": self.why, "try": self.hint}
        if not self.file:
            return said
        return {**said, "file": self.file, "line": self.line, "written": self.written}


def _readable(text: str) -> str:
    r"""Return what is quoted from a stranger's file so that a terminal may show it.

    Examples
    --------
    >>> _readable("a name with \x1b[31m"), len(_readable("(" * 10**6))
    ('a name with \ufffd[31m', 403)
    """
    text = str(text)  # whatever a caller has named
    if len(text) > LONGEST_WORD:
        text = re.sub(rf"(\S{{{LONGEST_WORD}}})\S+", r"\1...", text)
        text = text if len(text) <= LONGEST else f"{text[:LONGEST]}..."
    return text if text.isprintable() else re.sub(_UNSEEN, "\ufffd", text)


def _said_again(
    kind: type[HybondError],
    why: str,
    code: str,
    where: str,
    hint: str,
    file: str = "",
    line: int | None = None,
    written: str = "",
) -> HybondError:
    return kind(why, code=code, where=where, hint=hint).said_in(file, line, written)


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
