"""The refusal of a module that is not portable."""

from __future__ import annotations

from hybond.errors import ModelError


class PortableError(ModelError):
    """A portable module that says something outside the subset.

    Examples
    --------
    >>> print(PortableError("a list", place="lu.py:12", hint="use floats(n)"))
    HB-E601 at lu.py:12: a list
      try: use floats(n)
    """

    def __init__(self, why: str, *, place: str, hint: str = "") -> None:
        super().__init__(why, code="HB-E601", where=place, hint=hint)

    def __reduce__(self) -> tuple[object, ...]:
        return _again, (self.why, self.where, self.hint)


def _again(why: str, place: str, hint: str) -> PortableError:
    return PortableError(why, place=place, hint=hint)
