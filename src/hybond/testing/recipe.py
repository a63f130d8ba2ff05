"""Hybrid bond graphs as plain data, from which a model is made; nothing here is random."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from hybond.model.builder import Model
from hybond.model.constructors import GY, TF, C, G, I, One, R, Se, Sf, Zero
from hybond.model.parts import InputPart, Integral, Sampled
from hybond.testing.curves import Curve

STORAGES = {"C": ("q", "e"), "I": ("p", "f")}
"""Kind of storage: the stored variable, the output of its law."""


@dataclass(frozen=True)
class Part:
    """A node: an element or a junction.

    Parameters
    ----------
    name, kind : str
        The kind is one of C, I, R, G, Se, Sf, TF, GY, 0, 1.
    value : str, Curve or tuple
        A text (names of what is stored in braces), a curve, or the rows of a field of two ports.
        Of a junction: the options of its law, as pairs; texts among them have such names too.
    start : tuple of float
        Stored quantities, a port each.
    """

    name: str
    kind: str
    value: str | Curve | tuple[tuple[Any, ...], ...] = ()
    start: tuple[float, ...] = ()

    @property
    def is_field(self) -> bool:
        """Whether it has two ports of one kind."""
        return self.kind in ("C", "I", "R") and isinstance(self.value, tuple)

    @property
    def stored(self) -> tuple[str, ...]:
        """Names of what it stores."""
        if self.kind not in STORAGES:
            return ()
        letter = STORAGES[self.kind][0]
        ports = ("1.", "2.") if self.is_field else ("",)
        return tuple(f"{self.name}.{port}{letter}" for port in ports)


@dataclass(frozen=True)
class Bond:
    """A bond; ports are ``"1"``, ``"2"`` or empty."""

    tail: str
    head: str
    tail_port: str = ""
    head_port: str = ""


@dataclass(frozen=True)
class Switch:
    """A machine of two states; `junctions` are ON in ``on``, `others` in ``off``."""

    name: str
    junctions: tuple[str, ...]
    others: tuple[str, ...]
    start: str
    closes: str
    opens: str


@dataclass(frozen=True)
class Clocked:
    """What a clock sets: a value sampled each `every` seconds, or a pulse of that period.

    Parameters
    ----------
    name, text : str
        What is sampled; of a pulse the part of its period for which it is 1.
    every : float
        In s.
    is_pulse : bool
        Whether it is an input that is 1 and then 0, and not a sampled signal.
    """

    name: str
    text: str
    every: float
    is_pulse: bool = False


@dataclass(frozen=True)
class Recipe:
    """A hybrid bond graph as plain data.

    Parameters
    ----------
    parts, bonds, switches
        What it is made of.
    integrals : tuple of (str, str, float)
        Name, integrand, start.
    until : float
        How long a run is, s.
    clocked : tuple of Clocked
        Sampled signals, and pulses.
    """

    parts: tuple[Part, ...]
    bonds: tuple[Bond, ...]
    switches: tuple[Switch, ...] = ()
    integrals: tuple[tuple[str, str, float], ...] = ()
    until: float = 1.0
    clocked: tuple[Clocked, ...] = ()

    def part(self, name: str) -> Part:
        """Return the part of that name."""
        return next(p for p in self.parts if p.name == name)

    @property
    def stored(self) -> tuple[str, ...]:
        """Names of all that is stored."""
        return tuple(name for part in self.parts for name in part.stored)

    def model(self) -> Model:
        """Return the model."""
        m = Model("random")
        for p in self.parts:
            m.add(**{p.name: _element(p)})
        for k, b in enumerate(self.bonds):
            tail = f"{b.tail}.{b.tail_port}" if b.tail_port else b.tail
            head = f"{b.head}.{b.head_port}" if b.head_port else b.head
            m.bond(f"b{k}: {tail} -> {head}")
        for s in self.switches:
            m.machine(
                s.name,
                states={"off": list(s.others), "on": list(s.junctions)},
                start=s.start,
                rules=[
                    f"off -> on when {written(s.closes, str)}",
                    f"on -> off when {written(s.opens, str)}",
                ],
            )
        for name, integrand, start in self.integrals:
            m.signal(**{name: Integral(written(integrand, str), start=start)})
        for c in self.clocked:
            if c.is_pulse:
                pulse = {"period": c.every, "duty": float(c.text), "high": 1.0, "low": 0.0}
                m.input(**{c.name: InputPart(pwm=pulse)})
            else:
                m.signal(**{c.name: Sampled(written(c.text, str), every=c.every)})
        return m


def written(text: str, word: Callable[[str], str]) -> str:
    """Return `text` with every name in braces written by `word`.

    Examples
    --------
    >>> written("2*{c.q} > 1", lambda name: f"(-{name})")
    '2*(-c.q) > 1'
    """
    return re.sub(r"\{([^}]*)\}", lambda found: word(found[1]), text)


def _element(p: Part) -> Any:
    value = p.value
    if p.kind in ("0", "1"):
        pairs = dict(value) if isinstance(value, tuple) else {}
        options: dict[str, Any] = {
            key: written(x, str) if isinstance(x, str) else x for key, x in pairs.items()
        }
        return Zero(**options) if p.kind == "0" else One(**options)
    if p.kind in STORAGES:
        letter, output = STORAGES[p.kind]
        law: Any = value
        start: Any = p.start[0]
        if isinstance(value, Curve):
            linear = value.is_linear
            law = value.width / value.height if linear else {output: value.law(letter)}
        elif isinstance(value, tuple):
            law, start = [list(row) for row in value], list(p.start)
        return C(law, q=start) if p.kind == "C" else I(law, p=start)
    if isinstance(value, tuple):
        return R([list(row) for row in value])
    if isinstance(value, Curve):
        output, argument = ("e", "f") if p.kind == "R" else ("f", "e")
        if value.is_linear:
            ratio = value.height / value.width
            return R(ratio) if p.kind == "R" else G(ratio)
        return R({output: value.law(argument)})
    text = written(value, str)
    return {"Se": Se, "Sf": Sf, "TF": TF, "GY": GY}[p.kind](text)
