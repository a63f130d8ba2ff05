"""Marginal cost: the slope between two lengths of run, tools taking turns."""

from __future__ import annotations

import statistics
from dataclasses import dataclass, field

from measuring.problem import C, Outcome, Problem, apart

TURNS = 5
PATIENCE = 6.0
"""Seconds after which a pair of runs is not repeated in the turns that follow."""


@dataclass
class Cost:
    """What a tool costs on a problem."""

    problem: Problem
    tool: str
    slopes: list[float] = field(default_factory=list)
    fixed: list[float] = field(default_factory=list)
    per_event: list[float] = field(default_factory=list)
    error: float = float("nan")
    ratio: float = float("nan")
    tired: bool = False

    @property
    def each(self) -> float:
        """Seconds for one unit of length."""
        return statistics.median(self.slopes)

    @property
    def start(self) -> float:
        """Seconds that a run takes beside its length."""
        return statistics.median(self.fixed)

    def add(self, lengths: tuple[float, float], short: Outcome, long: Outcome) -> None:
        """Take in one pair of runs."""
        slope = (long.seconds - short.seconds) / (lengths[1] - lengths[0])
        self.slopes.append(slope)
        self.fixed.append(short.seconds - slope * lengths[0])
        if long.events > short.events:
            self.per_event.append((long.seconds - short.seconds) / (long.events - short.events))
        self.tired = short.seconds + long.seconds > PATIENCE


def measured(problem: Problem, full: bool, turns: int, only: list[str] | None) -> list[Cost]:
    """Run all tools of a problem by turns.

    The load of a machine changes slowly: tools that take turns see the same of it.
    """
    lengths = problem.full if full else problem.lengths
    costs = {name: Cost(problem, name) for name in problem.tools if not only or name in only}
    true = problem.true(lengths[1]) if problem.true else None
    for _ in range(turns):
        for name, cost in list(costs.items()):
            if cost.tired:
                continue
            tool = problem.tools[name]
            short, long = tool(lengths[0]), tool(lengths[1])
            if short is None or long is None:
                del costs[name]
                continue
            cost.add(lengths, short, long)
            if true is not None:
                cost.error = apart(long.found, true)
    if C in costs:
        for cost in costs.values():
            cost.ratio = cost.each / costs[C].each
    return list(costs.values())
