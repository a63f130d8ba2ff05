"""What models can be exported to, by name; each is imported when it is used."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

from hybond.errors import UsageError
from hybond.files.whole import write_whole
from hybond.model.builder import Model
from hybond.names import did_you_mean
from hybond.options import MADE


@dataclass(frozen=True, slots=True)
class Target:
    """One language or format."""

    home: str
    function: str
    """`home` and `function`: module and function: ``function(model, **options)`` returns the text,
    or the bytes of a file that is not a text."""
    suffix: str
    """How names of such files end."""
    options: frozenset[str] = frozenset()
    """Options that the function takes."""


RUN = frozenset(("until", "points", "method", *MADE))
"""Options of a run that an exported program begins with."""

TARGETS: Mapping[str, Target] = {
    "c": Target("hybond.export.c", "to_c", ".c", RUN),
    "fmu": Target(
        "hybond.export.fmu.package",
        "to_fmu",
        ".fmu",
        RUN - {"points"} | {"fmi"},
    ),
    "java": Target("hybond.export.java", "to_java", ".java", RUN | frozenset(["name"])),
    "latex": Target("hybond.export.latex", "to_latex", ".tex"),
    "modelica": Target("hybond.export.modelica", "to_modelica", ".mo"),
    "python": Target("hybond.export.python", "to_python", ".py"),
}


def export(model: Model, *, to: str, path: str | Path | None = None, **options: Any) -> str | bytes:
    """Return a model in another language; write it if `path` is given.

    Parameters
    ----------
    model : Model
    to : str
        One of `TARGETS`: ``"c"``, ``"fmu"``, ``"java"``, ``"latex"``, ``"modelica"``,
        ``"python"``.
    path : str or Path, optional
        The file to write.
    **options
        Of a program's run, which are those of `hybond.simulate`: ``until``, ``method`` and what is
        short for it, ``impact``; ``points``, of its table; ``name``, of a Java class; ``fmi``, the
        version of a functional mock-up unit.

    Returns
    -------
    str or bytes
        What the file holds.

    Raises
    ------
    UsageError
        HB-E602 for a target or option that does not exist.
    ModelError
        For what the target does not have; see its page in docs/export.md.

    Examples
    --------
    >>> import hybond as hb
    >>> text = hb.export(hb.load("examples/buck.toml"), to="c")
    >>> print(text.splitlines()[0])
    /* Buck converter with a compensator, a dead time and body diodes
    """
    target = TARGETS.get(to)
    if target is None:
        raise UsageError(
            f"there is no export to {to!r}",
            code="HB-E602",
            where="to",
            hint=did_you_mean(to, TARGETS),
        )
    for name in options:
        if name not in target.options:
            others = [t for t, kind in TARGETS.items() if name in kind.options]
            raise UsageError(
                f"an export to {to!r} has no option {name!r}",
                code="HB-E602",
                where=name,
                hint=did_you_mean(name, target.options)
                or f"leave it out; it is for {', '.join(others) or 'nothing'}",
            )
    if to == "java" and path is not None:
        options.setdefault("name", Path(path).stem)
    found: str | bytes = getattr(import_module(target.home), target.function)(model, **options)
    if path is not None:
        write_whole(path, found)
    return found


def default_name(to: str, stem: str) -> str:
    """Return what the file of an export is called, unless the user says otherwise.

    Examples
    --------
    >>> default_name("c", "my_ball"), default_name("java", "my_ball")
    ('my_ball.c', 'MyBall.java')
    """
    if to == "java":
        from hybond.export.java import class_name

        stem = class_name(stem)
    return stem + TARGETS[to].suffix
