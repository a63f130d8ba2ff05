"""Events written to a file as they happen, so that a long run need not keep them."""

from __future__ import annotations

import csv
from pathlib import Path

from hybond.model.graph import FlatGraph, Mode


class Journal:
    """A CSV file with a row for each event.

    Its columns are ``t`` (s), ``cause``, the states of the machines in which time goes on, and what
    is stored and integrated then, in SI units.

    Parameters
    ----------
    path : Path
        Replaced if it is there.
    """

    def __init__(self, path: Path, graph: FlatGraph) -> None:
        self.graph = graph
        self.written = 0
        """Rows, one an event."""
        self._file = path.open("w", newline="", encoding="utf-8")
        self._writer = csv.writer(self._file, lineterminator="\n")
        stored = [s.path for s in graph.storages] + [i.path for i in graph.integrals]
        self._writer.writerow(["t", "cause", *(m.path for m in graph.machines), *stored])

    def flush(self) -> None:
        """Let others see what there is."""
        self._file.flush()

    def close(self) -> None:
        """End the file."""
        self._file.close()

    def row(self, t: float, cause: str, mode: Mode, stored: list[float]) -> None:
        """Write an event: the mode in which time goes on, and what is stored and integrated."""
        states = [m.states[k] for m, k in zip(self.graph.machines, mode, strict=True)]
        self._writer.writerow([repr(float(t)), cause, *states, *map(repr, stored)])
        self.written += 1
