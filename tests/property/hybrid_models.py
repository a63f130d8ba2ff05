"""Hybrid models as plain data, and what a run of one is made of. Nothing here computes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from dense_oracle import Net

# -- models ----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Atom:
    """A comparison: sum of coefficient times signal, `op`, bound.

    A term is (coefficient, name, whether it is ``pre()``).
    """

    terms: tuple[tuple[float, str, bool], ...]
    op: str
    bound: float

    def __str__(self) -> str:
        parts = [
            f"({c!r})*{f'pre({name})' if prior else name}"
            if c != 1.0
            else f"pre({name})"
            if prior
            else name
            for c, name, prior in self.terms
        ]
        return f"{' + '.join(parts)} {self.op} {self.bound!r}"


@dataclass(frozen=True)
class Guard:
    """``and``, ``or``, ``not`` of guards, or one ``atom``."""

    word: str
    parts: tuple[Guard, ...] = ()
    atom: Atom | None = None

    def __str__(self) -> str:
        if self.atom is not None:
            return str(self.atom)
        if self.word == "not":
            return f"not ({self.parts[0]})"
        return f" {self.word} ".join(f"({p})" for p in self.parts)

    def atoms(self) -> Iterator[Atom]:
        if self.atom is not None:
            yield self.atom
        for p in self.parts:
            yield from p.atoms()


@dataclass(frozen=True)
class Rule:
    source: str
    target: str
    guard: Guard

    def __str__(self) -> str:
        return f"{self.source} -> {self.target} when {self.guard}"


@dataclass(frozen=True)
class Machine:
    name: str
    states: dict[str, tuple[str, ...]]
    start: str
    rules: tuple[Rule, ...]


@dataclass(frozen=True)
class Law:
    """What a junction obeys: ``diode``, or ``coulomb`` with a limit and a breakaway limit."""

    kind: str
    limit: float = 0.0
    breakaway: float = 0.0

    @property
    def branches(self) -> tuple[str, ...]:
        """Names of the branches; the first carries nothing."""
        return ("blocks", "conducts") if self.kind == "diode" else ("sticks", "forward", "backward")


@dataclass(frozen=True)
class Hybrid:
    """A hybrid model as plain data.

    net: nodes and bonds; machines in order; integrals: signal to (integrand as terms, start);
    prior: source to the factors of its value, terms of ``pre()``; steps: source to (time, change of
    its constant part); laws: junction to law, in the order of `laws`.
    """

    net: Net
    machines: tuple[Machine, ...] = ()
    integrals: dict[str, tuple[tuple[tuple[float, str], ...], float]] = field(default_factory=dict)
    prior: dict[str, tuple[tuple[float, str], ...]] = field(default_factory=dict)
    steps: dict[str, tuple[float, float]] = field(default_factory=dict)
    laws: dict[str, Law] = field(default_factory=dict)
    least_leakage: bool = False


# -- outcomes --------------------------------------------------------------------------------------


@dataclass
class Visit:
    """A mode visited within an event: one line of a record."""

    mode: tuple[str, ...]
    kind: str
    fired: tuple[tuple[str, str, str], ...]
    jump: np.ndarray
    """x+ - x, stored quantities."""
    impulses: np.ndarray
    """Of all bond variables; NaN where they are shares."""
    before: float
    after: float
    supplied: float
    branches: tuple[str, ...] = ()
    several: bool = False

    @property
    def lost(self) -> float:
        return self.before + self.supplied - self.after


@dataclass
class Happening:
    t: float
    before: np.ndarray
    after: np.ndarray
    visits: list[Visit]


@dataclass
class Outcome:
    events: list[Happening]
    stop: str
    """How it ended: ``end``, or why not."""
    t: float
    """Up to where it can be compared."""
    end: np.ndarray | None = None
