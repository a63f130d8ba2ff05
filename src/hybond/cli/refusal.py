"""Any exception as a refusal with a code."""

from __future__ import annotations

from hybond.errors import HybondError, NumericsError, UsageError


def refusal_of(error: BaseException) -> HybondError:
    """Return `error`, or a refusal that says the same.

    Examples
    --------
    >>> print(refusal_of(PermissionError(13, "Permission denied", "out.csv")))
    HB-X002 at out.csv: Permission denied
      try: check that the place is there and yours to write
    """
    if isinstance(error, HybondError):
        return error
    if isinstance(error, OSError) and error.filename is not None:
        return UsageError(
            error.strerror or str(error),
            code="HB-X002",
            where=str(error.filename),
            hint="check that the place is there and yours to write",
        )
    if isinstance(error, OSError):
        return UsageError(
            error.strerror or str(error) or type(error).__name__,
            code="HB-X002",
            where="what is printed",
            hint="check that there is room where it goes",
        )
    if isinstance(error, MemoryError):
        return NumericsError(
            "there is not enough memory",
            code="HB-X003",
            hint="a shorter run, or fewer sample times",
        )
    said = " ".join(str(error).split())
    return NumericsError(
        f"internal error: {type(error).__name__}" + (f": {said[:300]}" if said else ""),
        code="HB-X001",
        hint="this is a bug of hybond: please report it with the model file and what "
        "HYBOND_DEBUG=1 shows",
    )
