"""What a functional mock-up unit shows of a model, whatever the version of the standard."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from hybond.model.graph import FlatGraph
from hybond.model.inputs import Constant
from hybond.units import Dimension, parse_unit

SECOND = parse_unit("s")[1]


@dataclass(frozen=True, slots=True)
class Shown:
    """A variable of the unit."""

    name: str
    dimension: Dimension | None = None
    """None if the model does not say."""
    start: float = 0.0
    """In SI."""
    about: str = ""
    follows: bool = False
    """Of a parameter: whether it is made of others."""

    @property
    def unit(self) -> str:
        """The unit's name, empty if there is none."""
        return "" if self.dimension is None else str(self.dimension)


@dataclass(frozen=True, slots=True)
class Interface:
    """The variables of a unit, and what an importer should know of it.

    Value references count the variables in this order: time (0), parameters, inputs, outputs,
    states, derivatives of the states.
    """

    name: str
    title: str
    identifier: str
    """What the C functions and the library are called by."""
    token: str
    """A digest of all else: it changes with the model."""
    parameters: tuple[Shown, ...]
    inputs: tuple[Shown, ...]
    outputs: tuple[Shown, ...]
    states: tuple[Shown, ...]
    indicators: int
    """Event indicators."""
    until: float
    rtol: float
    """`until` and `rtol`: the default experiment."""

    def first(self, group: str) -> int:
        """Return the value reference of the first variable of a group."""
        found = 1
        for name in ("parameters", "inputs", "outputs", "states", "derivatives"):
            if name == group:
                return found
            found += len(getattr(self, name))
        raise KeyError(group)

    @property
    def derivatives(self) -> tuple[Shown, ...]:
        """The time derivatives of the states."""
        return tuple(
            Shown(f"der({s.name})", None if s.dimension is None else s.dimension / SECOND)
            for s in self.states
        )

    @property
    def dimensions(self) -> dict[str, Dimension]:
        """The units that variables have, by name."""
        groups = (self.parameters, self.inputs, self.outputs, self.states, self.derivatives)
        found = {v.unit: v.dimension for group in groups for v in group if v.dimension is not None}
        return {"s": SECOND, **{k: v for k, v in found.items() if v}}

    def numbered(self, group: str) -> Iterator[tuple[int, Shown]]:
        """Yield the variables of a group with their value references."""
        yield from enumerate(getattr(self, group), self.first(group))


def free_inputs(graph: FlatGraph) -> tuple[int, ...]:
    """Return the inputs that the surroundings of a unit set: those that are constants."""
    return tuple(i.index for i in graph.inputs if isinstance(i.waveform, Constant))


def interface_of(
    graph: FlatGraph,
    *,
    outputs: Sequence[str],
    text: str,
    parameters: Sequence[Shown] = (),
    indicators: int,
    until: float,
    rtol: float,
) -> Interface:
    """Return the interface of a model.

    Parameters
    ----------
    outputs : sequence of str
        Names of signals, as in results.
    text : str
        The program: the token is made of it.
    """
    shown_inputs = []
    for k in free_inputs(graph):
        i = graph.inputs[k]
        assert isinstance(i.waveform, Constant)
        shown_inputs.append(Shown(i.path, i.dimension, i.waveform.level))
    states = [
        Shown(s.path, graph.dimensions.get(f"x:{s.index}"), 0.0, "stored") for s in graph.storages
    ]
    states += [
        Shown(s.path, graph.dimensions.get(f"s:{s.index}"), s.start) for s in graph.integrals
    ]
    own = {s.name for s in (*states, *parameters)}
    return Interface(
        name=graph.name,
        title=graph.title,
        identifier=identifier_of(graph.name),
        token="{" + hashlib.sha256(text.encode()).hexdigest()[:32] + "}",
        parameters=tuple(parameters),
        inputs=tuple(shown_inputs),
        outputs=tuple(
            # a state or parameter that is an output keeps its own name
            Shown(f"{name}.out" if name in own else name, _dimension(graph, name))
            for name in outputs
        ),
        states=tuple(states),
        indicators=indicators,
        until=until,
        rtol=rtol,
    )


def identifier_of(name: str) -> str:
    """Return a name as a name of C.

    Examples
    --------
    >>> identifier_of("half bridge"), identifier_of("3-phase")
    ('half_bridge', 'm_3_phase')
    """
    word = re.sub(r"\W", "_", name, flags=re.ASCII)
    return word if re.match(r"[A-Za-z]", word) else f"m_{word}"


def _dimension(graph: FlatGraph, name: str) -> Dimension | None:
    from hybond.model.expressions import Name

    if name in graph.dimensions:
        return graph.dimensions[name]
    assert graph.read is not None
    tree = graph.read(name)
    return graph.dimensions.get(tree.path) if isinstance(tree, Name) else None
