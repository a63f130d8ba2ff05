"""`Hint`, one thing worth a look, and `Checked`, all that a check of a model says."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from hybond.errors import HybondError
from hybond.names import html_lines, html_table
from hybond.records import dataclass


@dataclass(frozen=True, slots=True)
class Hint:
    """Something in a model that is allowed, and seldom meant.

    Parameters
    ----------
    code : str
        Of the page in ``docs/errors``.
    where : str
        The path in the model.
    why, remedy : str
        What it is, and what to try.
    file, line, written
        The file that says it, the line, and what stands there, if the model comes from a file.

    Examples
    --------
    >>> print(Hint("HB-H106", "Rs", "no one uses the parameter 'Rs'", "take it out"))
    hint HB-H106 at Rs: no one uses the parameter 'Rs'
      try: take it out
    """

    code: str
    where: str
    why: str
    remedy: str
    file: str = ""
    line: int | None = None
    written: str = ""

    def __str__(self) -> str:
        said = HybondError(self.why, code=self.code, where=self.where, hint=self.remedy)
        return "hint " + str(said.said_in(self.file, self.line, self.written))

    def to_dict(self) -> dict[str, Any]:
        """Return the hint as plain data, with the keys of a refusal."""
        said = HybondError(self.why, code=self.code, where=self.where, hint=self.remedy)
        return said.said_in(self.file, self.line, self.written).to_dict()


@dataclass(frozen=True, slots=True, repr=False)
class Checked:
    """What a check of a model says: a refusal, if it has no meaning, and hints.

    Parameters
    ----------
    title : str
        Of the model.
    error : HybondError or None
    hints : tuple of Hint

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("rc", domain="electrical", parameters={"r": "1 ohm", "c": "1 F"})
    >>> m.add(c1=hb.C("c"), r1=hb.R("1 ohm"), n=hb.Zero())
    >>> m.bond("n -> c1", "n -> r1")
    >>> m.check()
    <Checked 'rc': fine, 1 hint>
    hint HB-H106 at parameters.r: nothing uses the parameter 'r'
      try: use it, or take it out
    """

    title: str
    error: HybondError | None
    hints: tuple[Hint, ...]

    @property
    def ok(self) -> bool:
        """Whether the model has a meaning; it may have hints all the same."""
        return self.error is None

    def __iter__(self) -> Iterator[Hint]:
        return iter(self.hints)

    def __len__(self) -> int:
        return len(self.hints)

    def __bool__(self) -> bool:
        return self.ok

    def to_data(self) -> dict[str, Any]:
        """Return all of it as plain data, for editors."""
        return {
            "ok": self.ok,
            "error": None if self.error is None else self.error.to_dict(),
            "hints": [hint.to_dict() for hint in self.hints],
        }

    def __repr__(self) -> str:
        count = len(self.hints)
        how = "refused" if self.error is not None else "fine"
        how += f", {count} hint{'s' * (count != 1)}" if count else ""
        said = [] if self.error is None else [str(self.error)]
        return "\n".join([f"<Checked {self.title!r}: {how}>", *said, *map(str, self.hints)])

    def _repr_html_(self) -> str:
        e = self.error
        rows = [] if e is None else [(e.code, e.place, e.why, e.hint)]
        rows += [(h.code, h.where, h.why, h.remedy) for h in self.hints]
        if not rows:
            return html_lines([f"{self.title}: fine"])
        return html_lines([self.title]) + html_table(rows, ("code", "where", "what", "try"))
