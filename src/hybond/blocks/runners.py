"""What runs the blocks of a graph, with the consent of whoever runs it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Protocol

from hybond.errors import NumericsError, UsageError
from hybond.model.graph import FlatGraph

if TYPE_CHECKING:
    from hybond.blocks.unit_runner import UnitRunner


class Runner(Protocol):
    """What computes the outputs of a block, instant after instant."""

    def step(self, t: float, values: Sequence[float]) -> Sequence[float]:
        """Return the outputs at `t`, in SI, from the inputs of that instant."""

    def close(self) -> None:
        """Let go of what was needed for that."""


class FunctionRunner:
    """Calls a Python function with the inputs of a block by name."""

    def __init__(
        self,
        function: Callable[[float, dict[str, float]], Mapping[str, float]],
        inputs: Sequence[str],
        outputs: Sequence[str],
        name: str,
    ) -> None:
        self._function = function
        self._inputs = tuple(inputs)
        self._outputs = tuple(outputs)
        self._name = name

    def step(self, t: float, values: Sequence[float]) -> list[float]:
        """Return the outputs at `t`.

        Raises
        ------
        NumericsError
            HB-N306 if the function raises, or does not give its outputs.
        """
        try:
            given = self._function(t, dict(zip(self._inputs, values, strict=True)))
            return [float(given[name]) for name in self._outputs]
        except Exception as error:  # whatever the function may raise
            raise NumericsError(
                f"the function of the block failed at t = {t:.9g} s: "
                f"{type(error).__name__}: {error}",
                code="HB-N306",
                where=f"blocks.{self._name}",
                hint="it takes (t, u) and returns a dict with all of its outputs",
            ) from error

    def close(self) -> None:
        """Do nothing: a function needs no end."""


def runners_of(graph: FlatGraph, *, fmus: bool) -> dict[str, FunctionRunner | UnitRunner]:
    """Return what runs each block, by its path; `fmus` is the consent to run their code.

    Raises
    ------
    UsageError
        HB-S117 for an FMU without consent.
    """
    found: dict[str, FunctionRunner | UnitRunner] = {}
    for sample in graph.samples:
        block = sample.block
        if block is None:
            continue
        if block.function is not None:
            found[sample.path] = FunctionRunner(
                block.function, tuple(block.inputs), tuple(block.outputs), sample.path
            )
            continue
        if not fmus or block.description is None:
            raise UsageError(
                f"the block runs the code of {block.fmu!r}",
                code="HB-S117",
                where=f"blocks.{sample.path}",
                hint="if you trust that file: simulate(..., fmus=True), or hybond run --fmus",
            )
        from hybond.blocks.unit_runner import UnitRunner

        found[sample.path] = UnitRunner(
            block.description,
            tuple(block.inputs),
            tuple(block.outputs),
            sample.parameters,
            sample.path,
        )
    return found
