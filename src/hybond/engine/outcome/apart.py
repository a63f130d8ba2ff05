"""A model asked apart from any run: how an instant is settled from a state that somebody says."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hybond.engine.outcome.beginnings import beginning_at
from hybond.engine.outcome.engine_run import EngineRun
from hybond.engine.outcome.engines import Prepared, choose_engine, prepared
from hybond.engine.outcome.explain import Explaining
from hybond.engine.outcome.signals import Signals
from hybond.engine.tables.options import settings_of
from hybond.model.graph import FlatGraph, Mode
from hybond.runs.policies import Limits
from hybond.runs.trace import Event, Trace

Vector = NDArray[np.float64]
MANY = 1_000_000


@dataclass(frozen=True)
class Apart:
    """A model at t = 0, in any state and mode.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("relay")
    >>> m.add(c=hb.C(1), n=hb.Zero(), f=hb.Sf(0), s=hb.One(), r=hb.R(1))
    >>> m.bond("f -> n -> c", "n -> s -> r")
    >>> m.machine("m", states={"off": [], "on": ["s"]}, start="off",
    ...           rules=["off -> on when c.e > 1"])
    >>> at = Apart(m.flatten())
    >>> at.start, at.settled(np.array([2.0]), (0,)).steps[-1].mode
    (array([0.]), (1,))
    >>> at.leaving(np.array([2.0]), (0,), (0,))
    {'m': ['c.e > 1']}
    """

    graph: FlatGraph

    @cached_property
    def _prepared(self) -> Prepared:
        own = {k: v for k, v in self.graph.experiment.items() if k in ("impact", "max_writes")}
        limits = Limits(events=MANY, steps=MANY)
        settings, _ = settings_of(own, 1.0, solver="rk45", sliding="refuse", limits=limits)
        return prepared(self.graph, settings, choose_engine())

    @cached_property
    def _words(self) -> Explaining:
        return Explaining(self._prepared.tables)

    @property
    def start(self) -> Vector:
        """What is stored and integrated at the start of a run, before it is settled."""
        floats = self._prepared.tables.floats
        return np.array([*floats["storage_start"], *floats["integral_start"]], dtype=float)

    @cached_property
    def signals(self) -> Signals:
        """What reads signals in states that are given."""
        return Signals(self._prepared, Trace())

    def settled(self, y: Vector, mode: Mode) -> Event:
        """Return how the start is settled from a state and a mode.

        Raises
        ------
        HybondError
            As a run that begins there.
        """
        run = self._run(y, mode)
        run.begin()
        return run.trace.events[0]

    def after(self, y: Vector, mode: Mode) -> Vector:
        """Return the state that it is settled to.

        Raises
        ------
        HybondError
            As a run that begins there.
        """
        return np.array(self._run(y, mode).begun())

    def leaving(self, y: Vector, mode: Mode, tried: Mode) -> dict[str, list[str]]:
        """Return the rules that leave a mode at once if it is entered, by machine.

        Parameters
        ----------
        y : array, shape (states,)
        mode : Mode
            In which time was before, with the state `y`.
        tried : Mode
            The mode that is entered.

        Raises
        ------
        HybondError
            If it cannot be entered, or a guard has no truth there.
        """
        tables = self._prepared.tables
        hold = self._started(y, mode).tried(tried)
        first = tables.ints["rule_first"]
        return {
            m.path: [tables.rules[k] for k in range(first[m.index], first[m.index + 1]) if hold[k]]
            for m in self.graph.machines
        }

    def begun(self, y: Vector, mode: Mode) -> FlatGraph:
        """Return the model with another start, for a run from there."""
        graph, values = self.graph, np.asarray(y, dtype=float).tolist()
        nx = len(graph.storages)
        return replace(
            graph,
            storages=tuple(
                replace(s, start=a, start_is="stored") for s, a in zip(graph.storages, values)
            ),
            integrals=tuple(replace(i, start=a) for i, a in zip(graph.integrals, values[nx:])),
            machines=tuple(replace(m, start=k) for m, k in zip(graph.machines, mode, strict=True)),
        )

    def _run(self, y: Vector, mode: Mode) -> EngineRun:
        """Return a run that begins there; what was prepared is the same for all."""
        return EngineRun(
            self._prepared,
            begin=beginning_at(0.0, y.tolist(), mode, self._prepared.tables),
            explain=self._words,
        )

    def _started(self, y: Vector, mode: Mode) -> EngineRun:
        """Return a run whose model starts there: the same tables with another start."""
        tables, values, nx = self._prepared.tables, y.tolist(), len(self.graph.storages)
        start = {"storage_start": values[:nx], "integral_start": values[nx:]}
        own = replace(
            tables,
            graph=self.begun(y, mode),
            floats={**tables.floats, **start},
            ints={**tables.ints, "start": list(mode)},
        )
        return EngineRun(choose_engine().prepare(own))
