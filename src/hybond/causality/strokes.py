"""The live causality of a mode: changed from one mode to the next by flipping a few paths."""

from __future__ import annotations

from collections.abc import Mapping

from hybond.causality.account import account
from hybond.causality.arrays import Arrays, compile_arrays
from hybond.causality.assign import assign
from hybond.causality.live import LiveAssignment
from hybond.causality.record import Causality
from hybond.model.graph import FlatGraph, Mode


class Strokes:
    """The causality of one mode, which follows the model from mode to mode.

    Parameters
    ----------
    graph : FlatGraph
        The graph.
    mode : tuple of int
        The first mode.
    pins : mapping, optional
        Bond index to `TAIL` or `HEAD`: strokes that must hold in every mode. Without it those
        of the graph.
    arrays : Arrays, optional
        The compiled graph, if it was compiled before.

    Examples
    --------
    A clutch between two masses. Engaged, one of them follows the other.

    >>> import hybond as hb
    >>> m = hb.Model("clutch")
    >>> m.add(a=hb.I(1), v=hb.One(), clutch=hb.Zero(), w=hb.One(), b=hb.I(2))
    >>> m.bond("v -> a", "v -> clutch -> w -> b")
    >>> m.machine("S", states={"engaged": ["clutch"], "open": []}, start="open")
    >>> strokes = Strokes(m.flatten(), (1,))
    >>> strokes.derivative
    ()
    >>> strokes.switch((0,))
    (0, 1)
    >>> strokes.derivative
    (0,)
    """

    def __init__(
        self,
        graph: FlatGraph,
        mode: Mode,
        *,
        pins: Mapping[int, int] | None = None,
        arrays: Arrays | None = None,
    ) -> None:
        self.graph = graph
        self.arrays = arrays or compile_arrays(graph)
        self.pins = dict(graph.pins if pins is None else pins)
        self.states = list(mode)
        """The state of each machine; to be read only."""
        self._last: list[tuple[int, int]] = []
        off = set(self.arrays.off)
        for on, state in zip(self.arrays.on, mode, strict=True):
            off -= on[state]
        self._assignment = LiveAssignment(self.arrays, off=off, pins=self.pins)

    @property
    def mode(self) -> Mode:
        """The state of each machine."""
        return tuple(self.states)

    @property
    def strokes(self) -> list[int]:
        """`TAIL` or `HEAD` per bond; to be read only."""
        return self._assignment.matching.stroke

    @property
    def derivative(self) -> tuple[int, ...]:
        """The storages in derivative causality."""
        return tuple(sorted(self._assignment.derivative))

    @property
    def dependent(self) -> int:
        """How many storages are in derivative causality."""
        return len(self._assignment.derivative)

    def is_derivative(self, storage: int) -> bool:
        """Whether a storage is in derivative causality."""
        return storage in self._assignment.derivative

    @property
    def conflict(self) -> bool:
        """Whether the mode has no causality."""
        return self.broken > 0

    @property
    def broken(self) -> int:
        """How many junctions lack a cause or have too many."""
        return self._assignment.broken

    def switch(self, mode: Mode) -> tuple[int, ...]:
        """Go to another mode; return the bonds whose stroke changed."""
        return self.turn({m: k for m, k in enumerate(mode) if k != self.states[m]})

    def turn(self, states: Mapping[int, int]) -> tuple[int, ...]:
        """Put some machines into other states; return the bonds whose stroke changed.

        Parameters
        ----------
        states : mapping
            Machine to state, by index. The cost does not depend on the machines left out.
        """
        work = self._assignment
        work.begin()
        self._last = []
        on: set[int] = set()
        off: set[int] = set()
        for m, k in sorted(states.items()):
            here = self.states[m]
            self._last.append((m, here))
            self.states[m] = k
            before, after = self.arrays.on[m][here], self.arrays.on[m][k]
            on |= after - before
            off |= before - after
        # First what lets go, then what takes hold: fewer bonds are fixed on the way.
        for v in sorted(on):
            work.turn(v, on=True)
        for v in sorted(off):
            work.turn(v, on=False)
        work.settle()
        return work.changed()

    def undo(self) -> None:
        """Take back the last `switch` or `turn`, bit for bit; only once."""
        self._assignment.undo()
        for m, k in self._last:
            self.states[m] = k
        self._last = []

    def record(self) -> Causality:
        """Return the full record: reasons and, where the mode has none, the conflicts."""
        if self.conflict:
            # Told as from scratch: what a conflict is blamed on must not depend on the past.
            return assign(self.graph, self.mode, pins=self.pins)
        off = self.graph.off_nodes(self.mode)
        return account(self.graph, self._assignment, off=off, pins=self.pins)
