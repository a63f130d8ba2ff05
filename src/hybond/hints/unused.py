"""Hints at parameters that nothing uses, and at signals and inputs that nobody reads."""

from __future__ import annotations

import re
from collections.abc import Iterator

from hybond.hints.uses import texts_of, used_in
from hybond.model.arrays import base_of
from hybond.model.builder import Model
from hybond.model.checked import Hint
from hybond.names import join


def unused_hints(model: Model) -> Iterator[Hint]:
    """Yield what a model and the models within its file declare and do not use."""
    yield from _of(model, "", outer=set())


def _of(model: Model, prefix: str, outer: set[str]) -> Iterator[Hint]:
    used = {name for text in texts_of(model) for name in used_in(text)}
    for name in model.parameters:
        if name not in used and not _read_outside(name, outer):
            yield Hint(
                "HB-H106",
                _where("parameters", prefix, name),
                f"nothing uses the parameter {name!r}",
                "use it, or take it out",
            )
    for name in model.inputs:
        if base_of(name) not in used and not _read_outside(name, outer):
            yield Hint(
                "HB-H108",
                _where("inputs", prefix, name),
                f"nobody reads the input {name!r}",
                "use it in a law, a signal or a guard, or take it out",
            )
    listed = {str(n) for key in ("plot", "outputs") for n in model.experiment.get(key, ())}
    for text in model.experiment.get("measure", ()):
        listed |= set(re.findall(r"\w+(?:\.\w+)*", str(text)))
    for name in model.signals if listed and not prefix else ():
        if base_of(name) not in used:
            yield Hint(
                "HB-H108",
                _where("signals", prefix, name),
                f"nobody reads the signal {name!r}, and plot and outputs of the experiment do not "
                "list it",
                "list it in [experiment] outputs, or take it out",
            )


def _read_outside(name: str, outer: set[str]) -> bool:
    return any(path.rpartition(".")[2] == name for path in outer)


def _where(section: str, prefix: str, name: str) -> str:
    return f"{section}.{join(prefix, name)}"
