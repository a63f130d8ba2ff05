"""What a run calls in Python: inputs that are functions, and blocks.

The engine in Python calls `Calls` itself. The library asks through a `Question` that both
sides see: a callback has one number as its argument, and no result that could get lost.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Generator, Mapping
from dataclasses import replace
from typing import Any

from hybond.blocks.runners import Runner, runners_of
from hybond.engine.tables import ModelTables
from hybond.engine.tables.calls import blocks_of
from hybond.model.inputs import Called

VALUE, RATE, BLOCK, OUTSIDE = range(4)
"""What is asked."""


class Onlooker:
    """Whoever is to look on within a slice, which may be long; nobody by default."""

    asked: Callable[[], object] | None = None
    """Called now and then; what it raises ends the run."""

    def look(self) -> None:
        """Let it look on."""
        if self.asked is not None:
            self.asked()


class Calls:
    """What one run calls: nothing of it is shared with another run.

    Parameters
    ----------
    tables : ModelTables
        Made with ``calling=True``.
    runners : mapping of str to Runner
        What runs each block, by its path; by default the functions of the model, and its units if
        there is consent.
    fmus : bool
        The consent to run the code of functional mock-up units.
    looking : bool
        Whether a finished run is looked into: blocks have set their signals, and are not called.

    Raises
    ------
    UsageError
        HB-S117 for an FMU without consent.

    Examples
    --------
    >>> import hybond as hb
    >>> from hybond.engine.tables import tables_of
    >>> m = hb.Model("rc", domain="electrical")
    >>> m.add(V=hb.Se("u"), R=hb.R("1 ohm"), C=hb.C("1 F"), i=hb.One())
    >>> m.bond("V -> i -> R", "i -> C")
    >>> m.input(u=lambda t: 2.0 * t)
    >>> calls = Calls(tables_of(m.flatten(), calling=True, until=1.0))
    >>> calls.value(0, 3.0, 0)
    6.0
    """

    def __init__(
        self,
        tables: ModelTables,
        runners: Mapping[str, Runner] | None = None,
        *,
        fmus: bool = False,
        looking: bool = False,
    ) -> None:
        graph = tables.graph
        end = float(tables.numbers["until"])
        waves = [i.waveform for i in graph.inputs]
        self._waveforms = [replace(w, end=end) if isinstance(w, Called) else w for w in waves]
        blocks = [] if looking else blocks_of(graph)
        own: Mapping[str, Runner] = runners_of(graph, fmus=fmus) if runners is None else runners
        self._runners = [own[s.path] for s in blocks]
        self._read = [len(s.values) for s in blocks]
        self._set = [len(s.signals) for s in blocks]

    def value(self, i: int, t: float, piece: int) -> float:
        """Return input i at t, from inside a piece."""
        return self._waveforms[i].value(t, piece)

    def rate(self, i: int, t: float, piece: int) -> float:
        """Return the time derivative of input i at t within a piece."""
        return self._waveforms[i].rate(t, piece)

    def block(self, block: int, t: float, values: Any) -> None:
        """Let a block compute at t from its inputs, in `values`; put its outputs there."""
        outputs = self._runners[block].step(t, values[: self._read[block]])
        # a longer answer would go beyond the room there is for it
        for k, value in zip(range(self._set[block]), outputs, strict=True):
            values[k] = value

    def close(self) -> None:
        """Let the blocks go."""
        for runner in self._runners:
            runner.close()


class Question(ctypes.Structure):
    """What the library asks: as `HybondQuestion` in ``library.c``."""

    _fields_ = (
        ("t", ctypes.c_double),
        ("answer", ctypes.c_double),
        ("values", ctypes.POINTER(ctypes.c_double)),
        *((name, ctypes.c_int) for name in ("what", "piece", "answered")),
    )


CALLBACK = ctypes.CFUNCTYPE(None, ctypes.c_int)


class Answering:
    """Answers the questions of one run by the library, and keeps what is raised meanwhile.

    Parameters
    ----------
    calls : Calls or None
        None for a run that calls neither inputs nor blocks.
    onlooker : Onlooker
        Whoever looks on; nobody by default.
    """

    def __init__(self, calls: Calls | None, onlooker: Onlooker | None = None) -> None:
        self.question = Question()
        self._raised: list[BaseException] = []
        answers = _answers(calls, onlooker or Onlooker(), self.question, self._raised)
        next(answers)
        self.callback = CALLBACK(answers.send)

    def of(self, library: ctypes.CDLL, handle: ctypes.c_void_p) -> None:
        """Answer what a run or a look asks."""
        library.hybond_ask(handle, ctypes.byref(self.question), self.callback)

    def taken(self) -> BaseException:
        """Return what a call raised, and forget it."""
        error = self._raised[0] if self._raised else KeyboardInterrupt()
        self._raised.clear()
        return error

    @property
    def error(self) -> BaseException | None:
        """What a call raised first, or what came from outside while it ran."""
        return self._raised[0] if self._raised else None


def _answers(
    calls: Calls | None, onlooker: Onlooker, question: Question, raised: list[BaseException]
) -> Generator[None, int, None]:
    """Answer a question for each number that is sent, none any more where something was raised.

    An interrupt that came while the library ran is raised at the first instruction of what is
    called back. Of a function that stands before any `try`, and the interrupt would be lost; a
    generator goes on inside one.
    """
    while True:
        try:
            while True:
                k = yield
                if raised:
                    continue
                if question.what == OUTSIDE or calls is None:
                    onlooker.look()
                elif question.what == VALUE:
                    question.answer = calls.value(k, question.t, question.piece)
                elif question.what == RATE:
                    question.answer = calls.rate(k, question.t, question.piece)
                else:
                    calls.block(k, question.t, question.values)
                question.answered = 1
        except GeneratorExit:
            return
        except BaseException as error:  # whatever a function or a user raises
            raised.append(error)
