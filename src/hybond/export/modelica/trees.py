"""What depends on the mode, as choices between the states of the machines that matter."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from math import prod

from hybond.errors import ModelError
from hybond.model.graph import FlatGraph, Mode

MOST = 1024
"""Combinations of states that are written out for one formula."""

Leaf = Callable[[Mode], str | None]


@dataclass
class Trees:
    """Writes formulas that depend on the mode."""

    graph: FlatGraph
    state: Callable[[int, int], str]
    """Machine and state to the text of the condition that the machine is in it."""
    gaps: dict[tuple[tuple[int, int], ...], str] = field(default_factory=dict)
    """Combinations (machine, state) that a formula was asked for and has none, to its name."""

    def text(self, name: str, machines: Sequence[int], leaf: Leaf) -> str | None:
        """Return a formula; None if no mode has one.

        Parameters
        ----------
        name : str
            What the formula is of.
        machines : sequence of int
            The machines that it may depend on.
        leaf : callable
            The formula in one mode; None where there is none.
        """
        order = sorted(machines)
        check_count(self.graph, order, name)
        return self._branch(name, order, list(self.graph.start_mode), (), leaf)

    def _branch(
        self,
        name: str,
        order: list[int],
        mode: list[int],
        path: tuple[tuple[int, int], ...],
        leaf: Leaf,
    ) -> str | None:
        if not order:
            found = leaf(tuple(mode))
            if found is None:
                self.gaps.setdefault(path, name)
            return found
        machine, rest = order[0], order[1:]
        groups: dict[str, list[int]] = {}
        for k in range(len(self.graph.machines[machine].states)):
            mode[machine] = k
            found = self._branch(name, rest, mode, (*path, (machine, k)), leaf)
            if found is not None:
                groups.setdefault(found, []).append(k)
        mode[machine] = self.graph.machines[machine].start
        if len(groups) <= 1:
            return next(iter(groups), None)
        # the formula that most states share comes last, where it needs no condition
        last = max(groups, key=lambda text: (len(groups[text]), -groups[text][0]))
        parts = [
            f"if {' or '.join(self.state(machine, k) for k in states)} then {text}"
            for text, states in groups.items()
            if text != last
        ]
        return f"({' else'.join(parts)} else {last})"


def check_count(graph: FlatGraph, machines: Sequence[int], name: str) -> None:
    """Refuse what would be written out for too many modes."""
    count = prod(len(graph.machines[m].states) for m in machines)
    if count > MOST:
        raise ModelError(
            f"{name} has a formula of its own in each of {count} combinations of "
            f"{len(machines)} machines",
            code="HB-E684",
            where=graph.name,
            hint="Modelica cannot say it shorter; export C or an FMU",
        )


def unbracketed(text: str) -> str:
    """Return a text without brackets around the whole."""
    if not (text.startswith("(") and text.endswith(")")):
        return text
    depth = 0
    for k, c in enumerate(text):
        depth += (c == "(") - (c == ")")
        if depth == 0 and k < len(text) - 1:
            return text
    return text[1:-1]
