"""Where a run begins, if not where its model says: from states by name to what the engine takes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from hybond.engine.contacts.landing_records import LAST_TIMES
from hybond.engine.surfaces.corners import most_combined
from hybond.engine.tables import ModelTables
from hybond.engine.tables.start import start_of
from hybond.errors import UsageError
from hybond.model.fingerprint import fingerprint_of
from hybond.model.graph import FlatGraph, Mode
from hybond.names import did_you_mean
from hybond.options import seconds
from hybond.records import dataclass
from hybond.runs.states import State
from hybond.units import Dimension, try_quantity

GIVEN: Final = 1
CHANGED: Final = 2
GOES_ON: Final = 3
"""How a run begins: as in `hybond.engine.run.run_records`."""


@dataclass(frozen=True, slots=True)
class Beginning:
    """The numbers that a run is handed: see `engine.run.carried`."""

    number: NDArray[np.float64]
    place: NDArray[np.intc]
    way: int
    """GIVEN, CHANGED or GOES_ON."""
    deep: bool
    """Whether they hold what another run remembers."""
    states: int

    @property
    def t(self) -> float:
        """When it begins, s."""
        return float(self.number[0])

    @property
    def state(self) -> NDArray[np.float64]:
        """What is stored and integrated there, before it is settled."""
        return self.number[1 : 1 + self.states]


def states_of(graph: FlatGraph) -> int:
    """Return how many numbers the state of a model is."""
    return len(graph.storages) + len(graph.integrals)


def place_of(
    tables: ModelTables,
    mode: Mode,
    landed: Sequence[str] = (),
    surfaces: Sequence[int] = (),
    *,
    product: bool = False,
    modes: NDArray[np.intc] | None = None,
    meant: Sequence[int] = (),
) -> NDArray[np.intc]:
    """Return the whole numbers of a state: the mode, what has landed where, what is slid on.

    `modes` are those that are combined, a row of states of machines each.
    """
    ints, machines = tables.ints, tables.graph.machines
    at = []
    for m, k in zip(machines, mode, strict=True):
        contact = ints["contact_at"][ints["state_first"][m.index] + k]
        at.append(contact if m.path in landed else -1)
    slid = [int(k in surfaces) for k in range(int(tables.numbers["surfaces"]))]
    kept = np.full((_combined_at_most(tables), len(machines)), -1, dtype=np.intc)
    if modes is not None and len(kept) > 0:
        kept[: len(modes)] = modes[:, : len(machines)]
    friction = np.zeros(int(tables.numbers["ports"]) if len(kept) > 0 else 0, dtype=np.intc)
    friction[: len(meant)] = meant
    return np.array([*mode, *at, *slid, int(product), *kept.flat, *friction], dtype=np.intc)


def _combined_at_most(tables: ModelTables) -> int:
    """Return how many modes a state has a row for."""
    return most_combined(int(tables.numbers["laws"]), int(tables.numbers["surfaces"]))


def beginning_of(start: State, graph: FlatGraph, tables: ModelTables) -> Beginning:
    """Return how a run of a model begins with a state.

    Of the same model it goes on. Of another one it has the states of storages and signals, which
    both must have, and of the machines that both have; it is settled as at any start.

    Raises
    ------
    UsageError
        HB-S134 for names that only one of them has, or states that are none.
    """
    memory = start.memory
    if memory is not None and memory.fingerprint == fingerprint_of(graph):
        number = np.array(memory.number, dtype=np.float64)
        place = np.array(memory.place, dtype=np.intc)
        _check(graph, tables, number, place, deep=memory.deep)
        return Beginning(number, place, GOES_ON, memory.deep, states_of(graph))
    paths = [s.path for s in graph.storages], [i.path for i in graph.integrals]
    y = [*_by_name(start.stored, paths[0]), *_by_name(start.signals, paths[1])]
    here = {m.path for m in graph.machines}
    mode = mode_named(graph, {k: v for k, v in start.machines.items() if k in here})
    return beginning_at(start.t, y, mode, tables)


def _check(
    graph: FlatGraph,
    tables: ModelTables,
    number: NDArray[np.float64],
    place: NDArray[np.intc],
    *,
    deep: bool,
) -> None:
    """Refuse numbers that no run has written: the engine takes them as places in its memory."""
    many, surfaces = len(graph.machines), int(tables.numbers["surfaces"])
    mode, landed = place[:many].tolist(), place[many : 2 * many].tolist()
    combined = 2 * many + surfaces + 1
    rows = _combined_at_most(tables)
    meant = combined + many * rows
    first = meant + (int(tables.numbers["ports"]) if rows > 0 else 0)
    fits = len(place) >= first and len(number) >= 1 + states_of(graph)
    fits = fits and bool(np.isfinite(number[: 1 + states_of(graph)]).all()) and number[0] >= 0.0
    at = tables.ints["contact_at"]
    for m, k, contact in zip(graph.machines, mode, landed):
        fits = fits and 0 <= k < len(m.states)
        fits = fits and contact in (-1, at[tables.ints["state_first"][m.index] + k])
    fits = fits and bool(np.isin(place[meant:first], (0, 1)).all())
    for row in place[combined:meant].reshape(-1, max(many, 1)) if fits else ():
        known = all(0 <= k < len(m.states) for m, k in zip(graph.machines, row.tolist()))
        fits = fits and (known or all(k == -1 for k in row.tolist()))
    if deep and fits:
        kept = place[first : first + many], place[first + 3 * many : first + 4 * many]
        events = first + 4 * many + int(tables.numbers["reactions"]) + len(graph.storages)
        fits = len(place) > events and place[events] >= 0
        fits = fits and all(((k >= 0) & (k <= LAST_TIMES)).all() for k in kept)
    if not fits:
        raise not_of_this_model("they are no places of it")


def not_of_this_model(why: str) -> UsageError:
    """Return the refusal of numbers that no run of a model has written."""
    said = f"its numbers are not those of a run of this model: {why}"
    return _wrong("memory", said, "save the state anew")


def beginning_at(t: float, y: Sequence[float], mode: Mode, tables: ModelTables) -> Beginning:
    """Return how a run begins in a state and a mode, as if the model said so; it is settled."""
    place = place_of(tables, mode)
    return Beginning(np.array([t, *y], dtype=np.float64), place, GIVEN, False, len(y))


def _by_name(values: Mapping[str, float], paths: Sequence[str]) -> list[float]:
    for path in values:
        if path not in paths:
            raise _wrong(path, f"the model has no {path!r}", did_you_mean(path, paths))
    for path in paths:
        if path not in values:
            raise _wrong(path, f"the state says nothing of {path!r}", did_you_mean(path, values))
    return [values[path] for path in paths]


def _wrong(where: str, why: str, hint: str) -> UsageError:
    return UsageError(
        f"the run cannot start there: {why}", code="HB-S134", where=f"start.{where}", hint=hint
    )


def mode_named(graph: FlatGraph, states: Mapping[str, Any]) -> Mode:
    """Return the mode with these states of machines; others are as the model starts.

    Raises
    ------
    UsageError
        HB-S134 for a state that is none.
    """
    by_path = {m.path: m for m in graph.machines}
    mode = list(graph.start_mode)
    for path, state in states.items():
        known = by_path[path].states
        if state not in known:
            why = f"the machine {path!r} has no state {state!r}"
            raise _wrong(path, why, did_you_mean(str(state), known) or ", ".join(known))
        mode[by_path[path].index] = known.index(state)
    return tuple(mode)


def beginning_by_name(given: Mapping[str, Any], graph: FlatGraph, tables: ModelTables) -> Beginning:
    """Return how a run begins with values by name; what is not named is as the model starts.

    Names are those of stored quantities (``ball.p``), their co-energy variables (``ball.f``),
    integrated signals, machines, and ``time``.

    Raises
    ------
    UsageError
        HB-S134 for other names, and for values that do not fit.
    """
    machines = {m.path for m in graph.machines}
    integrals = {i.path: i for i in graph.integrals}
    stored = {s.path: s for s in graph.storages}
    co_energy = {
        f"{s.path.rpartition('.')[0]}.{'e' if s.kind == 'C' else 'f'}": s for s in graph.storages
    }
    storages, signals = list(graph.storages), list(graph.integrals)
    states: dict[str, Any] = {}
    t = 0.0
    for name, value in given.items():
        if name == "time":
            t = seconds(value, "start.time")
        elif name in machines:
            states[name] = value
        elif name in integrals:
            k = integrals[name].index
            number = _read(name, value, graph.dimensions.get(f"s:{k}"))
            signals[k] = replace(signals[k], start=number)
        elif name in stored:
            s = stored[name]
            number = _read(name, value, graph.dimensions.get(f"x:{s.index}"))
            storages[s.index] = replace(s, start=number, start_is="stored")
        elif name in co_energy:
            s = co_energy[name]
            kind = "e" if s.kind == "C" else "f"
            number = _read(name, value, graph.dimensions.get(f"{kind}:{s.bond}"))
            # the name is that of a signal: the flow of its bond, which may point out of the storage
            into = number if s.kind == "C" else s.sign * number
            storages[s.index] = replace(s, start=into, start_is="co-energy")
        else:
            known = [*stored, *co_energy, *integrals, *machines, "time"]
            raise _wrong(name, f"the model has no {name!r}", did_you_mean(str(name), known))
    y = start_of(replace(graph, storages=tuple(storages), integrals=tuple(signals)))
    return beginning_at(t, y, mode_named(graph, states), tables)


def _read(name: str, value: Any, dimension: Dimension | None) -> float:
    if isinstance(value, float | int | np.floating | np.integer) and not isinstance(value, bool):
        number = float(value)
    else:
        quantity = try_quantity(value) if isinstance(value, str) else None
        if quantity is None:
            raise _wrong(name, f"{value!r} is no quantity", 'a number in SI, or "2 kg*m/s"')
        if dimension is not None and quantity.dimension not in (dimension, Dimension()):
            why = f"{name} = {value!r} is measured in {quantity.dimension}, not in {dimension}"
            raise _wrong(name, why, f"a quantity in {dimension}")
        number = quantity.value
    if not np.isfinite(number):
        raise _wrong(name, f"{name} = {value!r} is not finite", "a number")
    return number
