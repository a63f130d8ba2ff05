"""What `reachable` found: modes, what leads from one to the next, whether time always goes on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from pathlib import Path

    from hybond.draw.drawing import Drawing

Known = Literal["seen", "possible", "not excluded"]
"""Fired in the run of the experiment; fired from a state that is said; or neither."""
Verdict = Literal["proved", "possible", "not decided"]

WORDS: Mapping[Verdict, str] = {
    "proved": "proved: time always goes on",
    "possible": "possible: time stops",
    "not decided": "not decided: whether time always goes on",
}


@dataclass(frozen=True, slots=True)
class ModeNode:
    """A mode that was met."""

    mode: str
    """The states of the machines, as a run says them."""
    kinds: tuple[str, ...]
    """Of ``start``, ``continuous``, ``pinnacle`` and ``mythical``: what it was met as."""


@dataclass(frozen=True, slots=True)
class Fires:
    """A rule that fires on an edge."""

    machine: str
    source: str
    target: str
    guard: str

    def __str__(self) -> str:
        return f"{self.machine}: {self.source} -> {self.target} when {self.guard}"


@dataclass(frozen=True, slots=True)
class Edge:
    """One mode after another."""

    source: str
    target: str
    fires: tuple[Fires, ...]
    known: Known
    begin: str = ""
    """The mode in which time was before the instant."""
    witness: Mapping[str, float] = field(default_factory=dict)
    """Stored quantities, integrated signals and surroundings at the instant, SI."""


@dataclass(frozen=True, slots=True)
class Transition:
    """A rule of a machine, and whether it can fire."""

    machine: str
    source: str
    target: str
    guard: str
    known: Literal["seen", "possible", "not excluded", "never"]

    def __str__(self) -> str:
        return f"{self.machine}: {self.source} -> {self.target} when {self.guard}"


@dataclass(frozen=True, slots=True)
class Gap:
    """States from which no mode holds."""

    begin: str
    """The mode in which time was before."""
    states: tuple[str, ...]
    """Conditions that describe them; empty if only `witness` is known."""
    modes: tuple[str, ...]
    """The modes that are tried; of a cycle, the last is one of those before."""
    why: str
    cycle: bool
    """Whether the modes follow each other for ever; else none can be entered."""
    witness: Mapping[str, float]
    confirmed: bool
    """Whether a run that starts at the witness stops there with a refusal."""

    def __str__(self) -> str:
        return " and ".join(self.states) or _values(self.witness)


@dataclass(frozen=True, slots=True)
class ModeGraph:
    """The modes that can follow each other; made by `reachable`."""

    title: str
    start: str
    nodes: tuple[ModeNode, ...]
    edges: tuple[Edge, ...]
    transitions: tuple[Transition, ...]
    unreachable: tuple[str, ...]
    """States of machines in no mode that can be reached: ``machine.state``."""
    gaps: tuple[Gap, ...]
    time: Verdict
    """Whether time always goes on."""
    why: str
    exact: bool
    """Whether all states of all modes were looked at, not samples of them."""
    where: tuple[str, ...] = ()
    """What was assumed of the states."""
    left_out: tuple[str, ...] = ()

    @property
    def never(self) -> tuple[Transition, ...]:
        """The rules that can never fire."""
        return tuple(t for t in self.transitions if t.known == "never")

    def to_data(self) -> dict[str, Any]:
        """Return everything as plain data that JSON can hold."""
        return asdict(self)

    def draw(self, path: str | Path | None = None) -> Drawing:
        """Draw the modes as a state diagram; write it to a file too: SVG, PNG, PDF, TikZ.

        Raises
        ------
        UsageError
            HB-D101 for another kind of file, HB-A602 for more modes than a drawing can show.
        """
        from hybond.draw.mode_graph import draw_mode_graph

        drawing = draw_mode_graph(self)
        if path is not None:
            drawing.save(path)
        return drawing

    def __str__(self) -> str:
        return "\n".join(_lines(self))


def _values(values: Mapping[str, float]) -> str:
    return ", ".join(f"{name} = {value:.6g}" for name, value in values.items())


def _lines(found: ModeGraph) -> list[str]:
    how = "all states of each mode" if found.exact else "samples of states, and a run"
    lines = [f"{len(found.nodes)} modes from ({found.start}), by {how}"]
    if found.where:
        lines.append(f"assumed: {' and '.join(found.where)}")
    lines += [f"  ({n.mode})  {', '.join(n.kinds)}" for n in found.nodes]
    for e in found.edges:
        lines.append(f"  ({e.source}) -> ({e.target})  {e.known}")
        lines += [f"    {fires}" for fires in e.fires]
        if e.known == "possible" and e.witness:
            lines.append(f"    from ({e.begin}) at {_values(e.witness)}")
    lines += [f"no run reaches {state}" for state in found.unreachable]
    lines += [f"never fires: {t}" for t in found.never]
    open_rules = [t for t in found.transitions if t.known == "not excluded"]
    lines += [f"not seen, not excluded: {t}" for t in open_rules]
    for gap in found.gaps:
        lines.append(f"no mode holds from ({gap.begin}) where {gap}")
        lines.append("    " + " -> ".join(f"({m})" for m in gap.modes) + ": " + gap.why)
        if gap.states:
            said = "a run from there stops" if gap.confirmed else "not confirmed by a run"
            lines.append(f"    such as {_values(gap.witness)}: {said}")
    lines.append(f"{WORDS[found.time]}{'; ' if found.why else ''}{found.why}")
    lines += [f"left out: {text}" for text in found.left_out]
    return lines
