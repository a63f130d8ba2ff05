"""What the texts of a model use: names in values, rules, signals."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

from hybond.errors import HybondError
from hybond.model.arrays import index_texts
from hybond.model.builder import Model
from hybond.model.expressions import names, parse
from hybond.model.indices import INSIDE
from hybond.model.parts import Integral, Part, Sampled, SubmodelPart
from hybond.units import try_quantity

_WORD = re.compile(r"[A-Za-z_]\w*(?:\.\w+)*")


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


def texts_of(model: Model, *, parameters: bool = True) -> Iterator[str]:
    """Yield all texts of a model that are read as expressions, those for submodels too."""
    if parameters:
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


_NO_TEXTS = ("domain", "label", "law", "pair")


def _texts(value: Any) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, Mapping):
        for inner in value.values():
            yield from _texts(inner)
    elif isinstance(value, list | tuple):
        for inner in value:
            yield from _texts(inner)
