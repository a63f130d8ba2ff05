"""The event table: what happened, why, and what it did to the energy."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from typing import overload

import numpy as np
from numpy.typing import NDArray

from hybond.chronicle import Chronicle
from hybond.model.graph import FlatGraph
from hybond.names import html_table, in_columns
from hybond.runs.trace import Event, Fired, Visit
from hybond.units import format_quantity

SHOWN = 3
"""Impulses shown per step; all are in the record."""

WIDEST = 60
"""The widest column, in letters, and the longest mode: of many machines some are named."""


class EventTable(Sequence[Event]):
    """The events of a run; prints as a table.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("rc", domain="electrical")
    >>> m.add(c=hb.C("1 mF", e="10 V"), r=hb.R("1 kohm"), node=hb.Zero())
    >>> m.bond("node -> c", "node -> r")
    >>> print(hb.simulate(m, until="1 s").events)
    t = 0 s  start    (the only mode)  continuous  energy 50 mJ
    """

    def __init__(self, graph: FlatGraph, events: Sequence[Event]) -> None:
        self.graph = graph
        self.events = events

    @overload
    def __getitem__(self, k: int) -> Event: ...
    @overload
    def __getitem__(self, k: slice) -> tuple[Event, ...]: ...
    def __getitem__(self, k: int | slice) -> Event | tuple[Event, ...]:
        return tuple(self.events[k]) if isinstance(k, slice) else self.events[k]

    def __len__(self) -> int:
        return len(self.events)

    def __iter__(self) -> Iterator[Event]:
        return iter(self.events)

    @property
    def t(self) -> NDArray[np.float64]:
        """Their times, s, shape (events,), without making the records of any."""
        times = self.events.times if isinstance(self.events, Chronicle) else [e.t for e in self]
        return np.array(times, dtype=np.float64)

    def with_impulses(self) -> Iterator[Event]:
        """Return the events but for those of which is known that no impulse was written.

        Of those no records are made, which for many thousands of events takes its time.
        """
        events = self.events
        return events.telling() if isinstance(events, Chronicle) else iter(events)

    def rows(self) -> list[tuple[str, str, str, str, str]]:
        """Return time, cause, what, kind and details, one row per transition and mode."""
        rows: list[tuple[str, str, str, str, str]] = []
        for event in self.events:
            since = "" if event.t0 is None else f"{event.t0:.9g} .. "
            time = f"t = {since}{event.t:.9g} s"
            cause: str = f"{event.cause}: {event.label}" if event.label else event.cause
            focus = {f.machine for step in event.steps for f in step.fired}
            for k, step in enumerate(event.steps):
                for fired in step.fired:
                    what = f"{fired.machine}  {fired.source} -> {fired.target}"
                    rows.append((time, cause, what, "", fired_text(fired)))
                    time = cause = ""
                at_rest = event.landed and k + 1 == len(event.steps)
                kind = "landed" if at_rest else step.kind
                details = self._details(step, event)
                rows.append((time, cause, self._mode(step, focus), kind, details))
                time = cause = ""
        return rows

    def _mode(self, step: Visit, focus: Collection[str]) -> str:
        text = f"({self.graph.mode_text(step.mode, focus)})"
        if len(text) <= WIDEST:
            return text
        # too much for a line: what just switched, as far as there is room
        states = self.graph.mode_names(step.mode)
        told = sorted(states, key=lambda machine: machine not in focus)
        shown: list[str] = []
        for machine in told:
            words = [*shown, f"{machine} = {states[machine]}"]
            if shown and len(", ".join(words)) > WIDEST - len("(,  and 99 more)"):
                break
            shown = words
        return f"({', '.join(shown)} and {len(states) - len(shown)} more)"

    def _details(self, step: Visit, event: Event) -> str:
        parts = []
        for name, area in sorted(step.impulses.items(), key=self._rank)[:SHOWN]:
            mark = "in the step" if event.cause == "step" else "δ"
            parts.append(f"{name} = {self._area(name, area)} {mark}")
        if len(step.impulses) > SHOWN:
            parts[-1] += f" (and {len(step.impulses) - SHOWN} more)"
        energy = step.energy
        if energy is not None and step.kind != "mythical":
            text = f"energy {joule(energy.before)}"
            if energy.after != energy.before or step.impulses:
                text += f" -> {joule(energy.after)}"
            small = 1e-12 * max(abs(energy.before), abs(energy.after))
            if abs(energy.source) > small:
                text += f", supplied {joule(energy.source)}"
            if abs(energy.lost) > small:
                text += f", lost {joule(energy.lost)}"
            parts.append(text)
        return ";  ".join(parts)

    def _rank(self, item: tuple[str, float]) -> tuple[int, str]:
        """Junctions first, then one-ports, then the sides of two-ports."""
        node = self.graph.by_path.get(item[0].rsplit(".", 1)[0])
        if node is None:
            return (2, item[0])
        return (0 if self.graph.nodes[node].is_junction else 1, item[0])

    def _area(self, name: str, area: float) -> str:
        node = self.graph.by_path.get(name.rsplit(".", 1)[0])
        if node is None:
            node = self.graph.by_path.get(name.rsplit(".", 2)[0])
        domain = self.graph.nodes[node].domain if node is not None else None
        unit = (domain.effort_unit if name.endswith(".e") else domain.flow_unit) if domain else ""
        unit = unit.replace("*", "·")
        return f"{area:.6g} {unit}·s" if unit else f"{area:.6g} s"

    def __str__(self) -> str:
        rows = self.rows()
        if not rows:
            return "no events"
        return "\n".join(in_columns(rows, widest=WIDEST))

    def __repr__(self) -> str:
        return str(self)

    def _repr_html_(self) -> str:
        return html_table(self.rows(), ("time", "cause", "what", "kind", "details"))


def joule(value: float) -> str:
    """Return an energy with an engineering prefix."""
    return format_quantity(value, "J")


def fired_text(fired: Fired) -> str:
    """Return a guard with the values that made it true."""
    values = []
    for name, value in fired.values.items():
        impulse = fired.impulses.get(name)
        if impulse is None:
            values.append(f"{name} = {value:.6g}")
        else:
            values.append(f"{name} = {impulse:.6g} δ {'-' if value < 0 else '+'} {abs(value):.6g}")
    text = fired.guard + (f"   [{'; '.join(values)}]" if values else "")
    if fired.passed_over:
        text += f"   (also true, listed later: {'; '.join(fired.passed_over)})"
    return text
