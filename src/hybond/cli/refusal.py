"""Any exception as a refusal with a code."""

from __future__ import annotations

from argparse import Namespace

from hybond.errors import FileError, HybondError, ModelError, NumericsError, UsageError


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
            where="hybond",
            hint="a shorter run, or fewer sample times",
        )
    said = " ".join(str(error).split())
    return NumericsError(
        f"internal error: {type(error).__name__}" + (f": {said[:300]}" if said else ""),
        code="HB-X001",
        where="hybond",
        hint="this is a bug of hybond: please report it with the model file and what "
        "HYBOND_DEBUG=1 shows",
    )


def placed(refusal: HybondError, given: Namespace) -> HybondError:
    """Return a refusal with the line of the model file that says what is refused.

    Most know it themselves; what only the flat graph knows of is looked up in the file.
    """
    file = getattr(given, "file", None)
    settings = getattr(given, "settings", ())
    if refusal.file or not file or not refusal.where:
        return refusal
    if not isinstance(refusal, ModelError | NumericsError) or isinstance(refusal, FileError):
        return refusal
    from hybond.files import load
    from hybond.model.located import locate

    try:
        return locate(refusal, load(file), [s.partition("=")[0].strip() for s in settings])
    except HybondError:
        return refusal
