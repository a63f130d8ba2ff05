"""Marginal cost: the slope between two lengths of run, tools taking turns."""

from __future__ import annotations

import statistics
from dataclasses import dataclass, field

from measuring.problem import C, Outcome, Problem, apart

TURNS = 5
QUICK, PATIENCE = 0.4, 6.0
"""Seconds of a turn up to which pairs of runs are repeated, and beyond which a tool has had it."""


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
    warm: bool = False
    tired: bool = False

    @property
    def each(self) -> float:
        """Seconds for one unit of length."""
        return statistics.median(self.slopes)

    @property
    def start(self) -> float:
        """Seconds that a run takes beside its length."""
        return statistics.median(self.fixed)

    @property
    def event(self) -> float:
        """Seconds for one event; nan where events were not counted."""
        return statistics.median(self.per_event) if self.per_event else float("nan")

    def add(self, lengths: tuple[float, float], short: Outcome, long: Outcome) -> None:
        """Take in one pair of runs."""
        slope = (long.seconds - short.seconds) / (lengths[1] - lengths[0])
        self.slopes.append(slope)
        self.fixed.append(short.seconds - slope * lengths[0])
        if long.events > short.events:
            self.per_event.append((long.seconds - short.seconds) / (long.events - short.events))

    def forget(self) -> None:
        """Begin anew: what was measured contains what is loaded once."""
        for kept in (self.slopes, self.fixed, self.per_event):
            kept.clear()


def turn(cost: Cost, lengths: tuple[float, float], true: tuple[float, ...] | None) -> bool:
    """Run one tool; return whether it can do the problem here."""
    tool = cost.problem.tools[cost.tool]
    spent = 0.0
    while spent < QUICK:
        short, long = tool(lengths[0]), tool(lengths[1])
        if short is None or long is None:
            return False
        cost.add(lengths, short, long)
        if true is not None:
            cost.error = apart(long.found, true)
        pair = short.seconds + long.seconds
        if cost.tool == C:  # its runs are long enough, each being many
            break
        cost.tired = pair > PATIENCE
        if cost.warm or cost.tired:
            spent += max(pair, 1e-3)
        else:
            cost.forget()
        cost.warm = True
    return True


def measured(problem: Problem, full: bool, turns: int, only: list[str] | None) -> list[Cost]:
    """Run all tools of a problem by turns.

    The load of a machine changes slowly: tools that take turns see the same of it.
    """
    lengths = problem.full if full else problem.lengths
    costs = {name: Cost(problem, name) for name in problem.tools if not only or name in only}
    true = problem.true(lengths[1]) if problem.true else None
    for _ in range(turns):
        for name, cost in list(costs.items()):
            if not cost.tired and not turn(cost, lengths, true):
                del costs[name]
    if problem.base in costs:
        for cost in costs.values():
            cost.ratio = cost.each / costs[problem.base].each
    return list(costs.values())
