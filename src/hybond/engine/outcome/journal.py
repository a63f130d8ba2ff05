"""Events written to a file as they happen, so that a long run need not keep them."""

from __future__ import annotations

import contextlib
import io
import os

from hybond.errors import UsageError
from hybond.model.graph import FlatGraph, Mode


class EventFile:
    """A CSV file with a row for each event.

    Its columns are ``t`` (s), ``cause``, the states of the machines in which time goes on, and what
    is stored and integrated then, in SI units.

    Parameters
    ----------
    path : str or Path
        Replaced if it is there.

    Raises
    ------
    UsageError
        HB-S113 if it cannot be written, also by any method.
    """

    def __init__(self, path: str | os.PathLike[str], graph: FlatGraph) -> None:
        import csv

        self.graph = graph
        self.written = 0
        """Rows, one an event."""
        self._path = path
        try:
            self._file = open(path, "wb", buffering=0)
        except OSError as error:
            raise self._refusal(error, "name a file in a folder that is there") from None
        self._rows = io.StringIO()
        self._writer = csv.writer(self._rows, lineterminator="\n")
        stored = [s.path for s in graph.storages] + [i.path for i in graph.integrals]
        self._writer.writerow(["t", "cause", *(m.path for m in graph.machines), *stored])

    def flush(self) -> None:
        """Let others see what there is: whole rows, also where the disk is full."""
        data = self._rows.getvalue().encode("utf-8")
        self._rows.seek(0)
        self._rows.truncate()
        done = 0
        try:
            while done < len(data):
                done += self._file.write(data[done:]) or 0
        except OSError as error:
            torn = done - (data.rfind(b"\n", 0, done) + 1)
            with contextlib.suppress(OSError):  # a pipe has no end to be taken back
                self._file.truncate(self._file.tell() - torn)
            raise self._refusal(error, "make room, or name a file elsewhere") from None

    def close(self) -> None:
        """End the file."""
        try:
            self.flush()
        finally:
            self._file.close()

    def _refusal(self, error: OSError, hint: str) -> UsageError:
        why = f"the journal cannot be written: {error.strerror}"
        return UsageError(why, code="HB-S113", where=str(self._path), hint=hint)

    def row(self, t: float, cause: str, mode: Mode, stored: list[float]) -> None:
        """Write an event: the mode in which time goes on, and what is stored and integrated."""
        states = [m.states[k] for m, k in zip(self.graph.machines, mode, strict=True)]
        self._writer.writerow([repr(float(t)), cause, *states, *map(repr, stored)])
        self.written += 1
