"""Calls from Python that do not fit: refused as all else is, with what fits."""

from __future__ import annotations

import inspect
import os
from collections.abc import Callable
from functools import cache, wraps
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

from hybond.errors import FileError, HybondError, UsageError
from hybond.names import did_you_mean
from hybond.records import Later

if TYPE_CHECKING:
    from pathlib import Path

P = ParamSpec("P")
T = TypeVar("T")
C = TypeVar("C")

DEBUG = "HYBOND_DEBUG"
"""An environment variable: if it is set, a refusal has the frames inside hybond, too."""


def called(
    example: str,
    *,
    code: str = "HB-S130",
    kind: type[HybondError] = UsageError,
    options: type | None = None,
) -> Callable[[Callable[P, T]], Callable[P, T]]:
    """Return a decorator that refuses arguments that a function does not have.

    Parameters
    ----------
    example : str
        A call that fits, for the remedy.
    code : str
        The code of the refusal.
    options : type, optional
        A typed dictionary whose keys are arguments of the function, too, behind its ``**``.

    Examples
    --------
    >>> @called('half(x, digits=3)')
    ... def half(x: float, *, digits: int = 3) -> float:
    ...     return round(x / 2, digits)
    >>> half(3.0)
    1.5
    >>> half(3.0, digit=1)
    Traceback (most recent call last):
        ...
    hybond.errors.UsageError: HB-S130 at half: there is no argument 'digit'
      try: did you mean 'digits'? As in half(x, digits=3)
    """

    def decorate(function: Callable[P, T]) -> Callable[P, T]:
        @cache
        def signed() -> inspect.Signature:
            signature = inspect.signature(function)
            return signature if options is None else _with_options(signature, options)

        name = function.__name__
        if name.startswith("__"):  # of a class, or of a room that can be called
            name = example.partition("(")[0].rpartition(".")[2]

        @wraps(function)
        def call(*args: P.args, **given: P.kwargs) -> T:
            try:
                signed().bind(*args, **given)
            except TypeError:
                why, hint = _misfit(name, signed(), args, given)
                stop = "" if hint.endswith(("?", ".")) else "."
                remedy = f"{hint}{stop} As in {example}" if hint else example
                raise kind(why, code=code, where=name, hint=remedy) from None
            try:
                return function(*args, **given)
            except HybondError as error:
                if os.environ.get(DEBUG):
                    raise
                # what is refused is the caller's: the frames between are of no use to them
                raise error.with_traceback(None) from error.__cause__

        if options is not None:
            call.__signature__ = signed()  # type: ignore[attr-defined]
        return call

    return decorate


def _with_options(signature: inspect.Signature, options: type) -> inspect.Signature:
    """Return a signature with keys of a typed dictionary as arguments, in place of its ``**``."""
    own = [p for p in signature.parameters.values() if p.kind is not p.VAR_KEYWORD]
    more = [
        inspect.Parameter(
            key,
            inspect.Parameter.KEYWORD_ONLY,
            default=None,
            annotation=getattr(kind, "__forward_arg__", kind),
        )
        for key, kind in options.__annotations__.items()
    ]
    return signature.replace(parameters=[*own, *more])


def named_file(path: Any, example: str) -> Path:
    """Return the path that a name says, and refuse what is no name of a file.

    Parameters
    ----------
    path : str or path
    example : str
        A call that fits, for the remedy.

    Raises
    ------
    FileError
        HB-F102.

    Examples
    --------
    >>> named_file("ball.toml", 'hb.load("ball.toml")').suffix
    '.toml'
    """
    if isinstance(path, str | os.PathLike):
        from pathlib import Path

        return Path(path)
    raise FileError(
        f"{path!r} is not the name of a file", code="HB-F102", where="path", hint=example
    )


def fits(example: str, *, code: str = "HB-S130") -> Callable[[type[C]], type[C]]:
    """Return a decorator of a class that is made with the arguments that it has, and no others.

    Parameters
    ----------
    example : str
        A call that fits, for the remedy.
    code : str
        The code of the refusal.

    Examples
    --------
    >>> @fits('Pair(1, 2)')
    ... class Pair:
    ...     def __init__(self, a: int, b: int) -> None:
    ...         self.sum = a + b
    >>> Pair(1)
    Traceback (most recent call last):
        ...
    hybond.errors.UsageError: HB-S130 at Pair: the b is missing
      try: Pair(1, 2)
    """

    def decorate(kind: type[C]) -> type[C]:
        around, own = called(example, code=code), vars(kind).get("__init__")
        if isinstance(own, Later):
            own.wrap = around
        else:
            kind.__init__ = around(kind.__init__)  # type: ignore[method-assign]
        return kind

    return decorate


_ELSEWHERE = {
    "until": ("t_end", "tend", "t_final", "tf", "t_max", "tmax", "t_stop", "stop_time", "end"),
    "step": ("dt", "h", "step_size", "stepsize"),
    "rtol": ("tol", "tolerance", "reltol", "rel_tol"),
    "atol": ("abstol", "abs_tol"),
    "solver": ("integrator",),
}
"""What others call arguments of runs, by what they are called here."""


def _misfit(
    owner: str, signature: inspect.Signature, args: tuple[Any, ...], options: dict[str, Any]
) -> tuple[str, str]:
    """Return what does not fit, and what may be meant."""
    own = {n: p for n, p in signature.parameters.items() if n != "self"}
    methods = len(signature.parameters) - len(own)
    positional = [
        n for n, p in own.items() if p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD)
    ]
    # what takes names that it does not list itself looks at them later
    more = any(p.kind is p.VAR_KEYWORD for p in own.values())
    unknown = [n for n in options if n not in own and not more]
    if unknown:
        known = [n for n, p in own.items() if p.kind is not p.POSITIONAL_ONLY]
        meant = next((n for n, words in _ELSEWHERE.items() if unknown[0] in words), "")
        hint = f"it is named {meant!r} here." if meant in known else did_you_mean(unknown[0], known)
        return f"there is no argument {unknown[0]!r}", hint
    given = len(args) - methods
    if given > len(positional):
        rest = [n for n, p in own.items() if p.kind is p.KEYWORD_ONLY]
        extra = f"{args[methods + len(positional)]!r}"
        takes = {0: "no value", 1: "one value"}.get(len(positional), f"{len(positional)} values")
        named = ", ".join(f"{n}=..." for n in rest[:3])
        hint = f"write the name before it: {named}." if rest else ""
        if not positional and not methods:
            hint = f"hb.{owner}()."
        return f"it takes {takes} without a name; {extra[:60]} is one more", hint
    for name in options:
        if name in positional[:given]:
            return f"{name} is given twice", "give it once."
    missing = [
        n
        for k, (n, p) in enumerate(own.items())
        if p.default is p.empty
        and p.kind not in (p.VAR_POSITIONAL, p.VAR_KEYWORD)
        and n not in options
        and not (n in positional and k < given)
    ]
    return f"the {missing[0] if missing else 'argument'} is missing", ""
