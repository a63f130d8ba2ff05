"""Modes whose motion is linear, as one matrix: ``z' = M z``.

`z` are the stored quantities and the integrated signals that move linearly, then the generators of
all sources (`hybond.engine.tables.generators`). Where a mode is not of that kind there is a reason.
"""

from __future__ import annotations

from collections import Counter, OrderedDict
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hybond.engine.tables.generators import (
    Found,
    Generators,
    Terms,
    combined,
    constant,
    generators,
    of_name,
    terms_of,
)
from hybond.equations.mode import ModeEquations
from hybond.model.expressions import Expr, Number, posterior_names
from hybond.model.graph import Mode
from hybond.model.inputs import Constant, Pwm, Timetable
from hybond.model.interval import Interval
from hybond.programs.solved_rows import is_open, solve_rows

if TYPE_CHECKING:
    from hybond.programs.program import Program

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
LARGEST = 400
"""Stored quantities of a mode whose matrix, which is full, is made."""
KEPT = 512
"""Modes kept; the least recently used is forgotten first."""


@dataclass(frozen=True, slots=True, eq=False)
class LinearForm:
    """The motion of one mode.

    Parameters
    ----------
    matrix : array, shape (N, N)
        Of z.
    states : array of int
        The components of a state vector that z begins with.
    generators : tuple of Expr
        What the others are at any time.
    watched : array of int
        Places in z of what powers read and what is no polynomial of time: steps must resolve it.
    timely : bool
        Whether comparisons of time are part of the matrix.
    """

    matrix: Matrix
    states: NDArray[np.intp]
    generators: tuple[Expr, ...]
    watched: NDArray[np.intp]
    timely: bool


class LinearForms:
    """The linear forms of a program's modes, made when asked for, and why there are none."""

    def __init__(self, program: Program) -> None:
        self._program = program
        self._known: OrderedDict[object, tuple[ModeEquations, LinearForm | str]] = OrderedDict()
        self._why: dict[Mode, str] = {}
        """Why a mode has none, no text if it has one: as last asked."""
        self._slid: set[int] = set()

    def of(self, equations: ModeEquations, interval: Interval) -> LinearForm | str:
        """Return the form of a mode in an interval, or why there is none."""
        # most forms are the same in all intervals
        keys: list[object] = [id(equations), (id(equations), interval.at)]
        known = ((k, self._known.get(k)) for k in keys)
        key = next((k for k, at in known if at is not None and at[0] is equations), None)
        if key is None:
            form = linear_form(self._program, equations, interval)
            key = keys[0] if isinstance(form, LinearForm) and not form.timely else keys[1]
            self._known[key] = equations, form
            if len(self._known) > KEPT:
                self._known.popitem(last=False)
        self._known.move_to_end(key)
        form = self._known[key][1]
        self._why[equations.mode] = form if isinstance(form, str) else ""
        return form

    def slid(self, which: int) -> None:
        """Note a motion along a surface, which has no form here."""
        self._slid.add(which)

    @property
    def found(self) -> Counter[str]:
        """How many modes have none, by reason; those that have one by no text."""
        found = Counter(self._why.values())
        if self._slid:
            found["motion along a surface"] = len(self._slid)
        return found

    def generated(self, form: LinearForm, interval: Interval) -> Callable[[float], Vector]:
        """Return the generators as a function of time within an interval."""
        program = self._program
        closures = [program.compile(e) for e in form.generators]
        v = [0.0] * (2 * program.slots.size)

        def at(t: float) -> Vector:
            program.set_time(v, t, interval)
            return np.array([f(v) for f in closures])

        return at

    def report(self, other: str) -> str:
        """Return how many modes were propagated, and why not more; `other` took the rest."""
        found = self.found
        texts = [f"{_modes(found[''])} propagated exactly"]
        texts += [f"{_modes(n)} left to {other}: {why}" for why, n in sorted(found.items()) if why]
        return "; ".join(texts)


def _modes(n: int) -> str:
    return f"{n} mode{'' if n == 1 else 's'}"


def linear_form(program: Program, equations: ModeEquations, interval: Interval) -> LinearForm | str:
    """Return the motion of a mode as a matrix, or why it is none."""
    if not equations.storage.linear:
        return "nonlinear storage"
    if program.nx > LARGEST:
        return f"more than {LARGEST} stored quantities"
    return _Making(program, equations, interval).form()


class _Making:
    """One form being made."""

    def __init__(self, program: Program, equations: ModeEquations, interval: Interval) -> None:
        self.program = program
        self.equations = equations
        self.interval = interval
        self.timely = False
        slots = program.slots
        flags = program.flags(equations.mode)
        self.flags = {
            name: flags[k - slots.on.start]
            for name, k in slots.index.items()
            if slots.on.start <= k < slots.states.stop
        }
        self.rows = solve_rows(equations, self._name)
        self.known, self.row = self.rows.known, self.rows.row
        self.xi: list[Found] = []

    def form(self) -> LinearForm | str:
        """Return the form, or why there is none."""
        nx, matrix = self.program.nx, self.equations.storage.matrix
        found: list[Found] = [
            {(0j, 0.0, (f"x:{j}",)): complex(row[j]) for j in np.flatnonzero(row).tolist()}
            for row in matrix.dense()
        ]
        found += self._sources()
        found += self.rows.rests
        if self._open():
            return "laws that are not linear"
        used = self._used()
        for k in used:
            reason = found[k]
            if k >= nx + 2 * len(self.equations.tableau.sources):
                assert isinstance(reason, dict)
                if not all(map(_straight, reason)):
                    return "a product with what is stored in a law"
            if isinstance(reason, str):
                return f"{reason} in the source {self._source_name(k - nx)}"
        self.xi = found
        rates = self._signals(used)
        return rates if isinstance(rates, str) else self._assembled(used, rates)

    def _open(self) -> bool:
        """Whether rates or powers depend on more than knowns."""
        meter = self.program.meter
        pairs = [
            (int(e), int(f))
            for ends in (meter.supplied, meter.dissipated)
            for e, f in zip(ends[0], ends[1], strict=True)
        ]
        return bool(self.rows.open[self.equations.storage.bond].any()) or is_open(self.rows, pairs)

    def _used(self) -> list[int]:
        """Return the knowns that rates or powers depend on."""
        w = self.known[self.row]
        seen = np.any(w[self.equations.storage.bond], axis=0)
        for e, f, _ in (self.program.meter.supplied, self.program.meter.dissipated):
            for one, other in zip(w[e], w[f], strict=True):
                if one.any() and other.any():
                    seen |= (one != 0.0) | (other != 0.0)
        return [int(k) for k in np.flatnonzero(seen)]

    def _source_name(self, k: int) -> str:
        sources = self.equations.tableau.sources
        node = sources[k % len(sources)].node
        return self.program.graph.nodes[node].path if node >= 0 else "of a junction"

    def _name(self, path: str) -> Found:
        """Return the terms of a name that no bond variable is behind."""
        kind, _, index = path.partition(":")
        if kind in ("time", "x", "s"):
            return of_name(path)
        if path in self.flags:
            return constant(self.flags[path])
        if kind == "at":
            self.timely = True
            return constant(float(self.interval.at[int(index)]))
        if kind in ("u", "du"):
            waveform = self.program.graph.inputs[int(index)].waveform
            if isinstance(waveform, Constant):
                return constant(waveform.level if kind == "u" else 0.0)
            if not isinstance(waveform, Pwm | Timetable):
                return "an input that is a function in Python"
            return constant(0.0) if kind == "du" and not _slopes(waveform) else of_name(path)
        return "a bond variable"

    def _bond(self, path: str) -> Found:
        """Return the terms of any name."""
        if not path.startswith(("e:", "f:")):
            return self._name(path)
        k = self.program.slots.index[path] - self.program.slots.w.start
        if self.rows.open[k]:
            return "a law that is not linear"
        row = self.known[self.row[k]]
        parts: list[tuple[complex, Terms]] = []
        for c in np.flatnonzero(row).tolist():
            terms = self.xi[c]
            if isinstance(terms, str):
                return terms
            parts.append((complex(row[c]), terms))
        return combined(parts)

    def _sources(self) -> list[Found]:
        """Return the terms of all sources, then of the rates that something asks for."""
        given = self.equations.tableau.sources
        asked = {k for k, _ in self.equations.rate_values}
        wanted = [s.value for s in given]
        wanted += [s.rate if k in asked else Number(0.0) for k, s in enumerate(given)]
        found: list[Found] = []
        for e in wanted:
            terms = terms_of(e, self._name)
            if isinstance(terms, dict) and not all(map(_straight, terms)):
                terms = "a product with what is stored"
            found.append(terms)
        return found

    def _signals(self, used: list[int]) -> dict[int, Terms] | str:
        """Return the rates of the signals that move linearly; the others are integrated along."""
        rates: dict[int, Terms] = {}
        integrals = self.program.graph.integrals
        for i in integrals:
            terms = terms_of(i.rate, self._bond)
            if isinstance(terms, dict) and all(map(_straight, terms)):
                rates[i.index] = terms
        while lost := [k for k, terms in rates.items() if _signals_in(terms) - rates.keys()]:
            for k in lost:
                del rates[k]
        others = {i.index for i in integrals} - rates.keys()
        for k in used:
            terms = self.xi[k]
            assert isinstance(terms, dict)
            if held := sorted(_signals_in(terms) & others):
                return f"a source follows {integrals[held[0]].path}, which does not move linearly"
        for k in sorted(others):
            read = {int(n[2:]) for n in self._reach(integrals[k].rate) if n.startswith("s:")}
            if held := sorted(read & others):
                name = integrals[held[0]].path
                return f"{integrals[k].path} follows {name}, which does not move linearly"
        return rates

    def _reach(self, e: Expr) -> set[str]:
        """Return the names that an expression depends on, those behind bond variables included."""
        found = set(posterior_names(e))
        for path in list(found):
            if path.startswith(("e:", "f:")):
                terms = self._bond(path)
                found |= {n for key in terms for n in key[2]} if isinstance(terms, dict) else set()
        return found

    def _assembled(self, used: list[int], rates: dict[int, Terms]) -> LinearForm:
        program, storage = self.program, self.equations.storage
        nx, signals = program.nx, sorted(rates)
        knowns = {k: terms for k in used if isinstance(terms := self.xi[k], dict)}
        made = generators(
            (key for t in (*knowns.values(), *rates.values()) for key in t if not _stored(key)),
            self._slope,
        )
        first = nx + len(signals)
        place = {f"x:{k}": k for k in range(nx)} | {f"s:{k}": nx + i for i, k in enumerate(signals)}
        size = first + len(made.expressions)

        def row(terms: Terms) -> Vector:
            found = np.zeros(size)
            found[first:] = made.row(terms)
            for key, c in terms.items():
                if _stored(key):
                    found[place[key[2][0]]] += c.real
            return found

        xi = np.zeros((len(self.xi), size))
        for k, terms in knowns.items():
            xi[k] = row(terms)
        w = (self.known @ xi)[self.row]
        matrix = np.zeros((size, size))
        matrix[:nx] = storage.rates_of(w)
        for k in signals:
            matrix[place[f"s:{k}"]] = row(rates[k])
        matrix[first:, first:] = made.matrix
        states = np.array([*range(nx), *(nx + k for k in signals)], dtype=np.intp)
        return LinearForm(matrix, states, made.expressions, self._watched(w, made), self.timely)

    def _watched(self, w: Matrix, made: Generators) -> NDArray[np.intp]:
        """Return the generators that some power reads."""
        first = w.shape[1] - len(made.expressions)
        seen = np.zeros(len(made.expressions), dtype=bool)
        for e, f, _ in (self.program.meter.supplied, self.program.meter.dissipated):
            both = np.any(w[e], axis=1) & np.any(w[f], axis=1)
            seen |= np.any((w[e] != 0.0) | (w[f] != 0.0), axis=0, where=both[:, None])[first:]
        return np.asarray(first + np.flatnonzero(seen & made.moving), dtype=np.intp)

    def _slope(self, path: str) -> str | None:
        """Return the name of the slope of an input, None if it has none."""
        kind, _, index = path.partition(":")
        if kind != "u":
            return None
        waveform = self.program.graph.inputs[int(index)].waveform
        return f"du:{index}" if _slopes(waveform) else None


def _slopes(waveform: object) -> bool:
    return isinstance(waveform, Timetable) and waveform.linear


def _stored(key: tuple[complex, float, tuple[str, ...]]) -> bool:
    return any(name.startswith(("x:", "s:")) for name in key[2])


def _straight(key: tuple[complex, float, tuple[str, ...]]) -> bool:
    """Whether a term is linear in what is stored, with a constant factor, or free of it."""
    return not _stored(key) or (not key[0] and not key[1] and len(key[2]) == 1)


def _signals_in(terms: Terms) -> set[int]:
    return {int(n[2:]) for key in terms for n in key[2] if n.startswith("s:")}
