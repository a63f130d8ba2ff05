"""What the texts of a model use: names in values, rules, signals; hints at what nothing uses."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

from hybond.errors import HybondError
from hybond.model.arrays import base_of, index_texts
from hybond.model.builder import Model
from hybond.model.checked import Hint
from hybond.model.expressions import names, parse
from hybond.model.indices import INSIDE
from hybond.model.parts import Integral, Part, Sampled, SubmodelPart
from hybond.names import join
from hybond.units import try_quantity

_WORD = re.compile(r"[A-Za-z_]\w*(?:\.\w+)*")
_NO_TEXTS = ("domain", "label", "law", "pair")


def used_in(text: str) -> set[str]:
    """Return the names in a text, those in front of their dots too.

    Examples
    --------
    >>> sorted(used_in("k*spring.q + 1 [m/s]"))
    ['k', 'spring', 'spring.q']
    >>> sorted(used_in("off -> on when time >= t_on"))
    ['t_on', 'time']
    >>> sorted(used_in("sum(cell[1..n].q)"))
    ['cell', 'cell.q', 'n']
    """
    rule = text.partition(" when ")[2] if "->" in text and " when " in text else text
    if try_quantity(rule) is not None:
        return set()
    try:
        found = set(names(parse(rule)))
    except HybondError:
        found = set(_WORD.findall(rule))
    if ".state" in rule:
        found |= set(_WORD.findall(rule))
    for name in [n for n in found if "[" in n]:
        found.discard(name)
        found |= {INSIDE.sub("", name), *_WORD.findall(" ".join(INSIDE.findall(name)))}
    for name in list(found):
        parts = name.split(".")
        found |= {".".join(parts[:k]) for k in range(1, len(parts))}
    return found


def texts_of(model: Model) -> Iterator[str]:
    """Yield all texts of a model that are read as expressions, those for submodels too."""
    yield from _texts(model.parameters)
    yield from index_texts(model)
    for part in model.elements.values():
        if isinstance(part, Part):
            yield from _texts(part.value)
            given = {k: v for k, v in part.options.items() if k not in _NO_TEXTS}
            yield from _texts(given)
        elif isinstance(part, SubmodelPart):
            yield from _texts(part.parameters)
            yield from _texts(part.inputs)
    for signal in model.signals.values():
        if isinstance(signal, Integral):
            yield from _texts([signal.rate, signal.start])
        elif isinstance(signal, Sampled):
            yield from _texts([signal.value, signal.every, signal.start, signal.phase])
        else:
            yield from _texts(signal)
    for given_input in model.inputs.values():
        waves = (given_input.constant, given_input.table, given_input.period, given_input.pwm)
        yield from _texts(waves)
    for machine in model.machines.values():
        yield from _texts(machine.rules)
    for block in model.blocks.values():
        yield from _texts([block.inputs, block.outputs, block.every, block.phase])
        yield from _texts(block.parameters)
    yield from _texts([v for k, v in model.experiment.items() if k not in ("solver", "impact")])


def _texts(value: Any) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, Mapping):
        for inner in value.values():
            yield from _texts(inner)
    elif isinstance(value, list | tuple):
        for inner in value:
            yield from _texts(inner)


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
