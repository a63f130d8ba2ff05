"""Samples of states, and the states of a run: what is seen where cells have no straight edges."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from hybond.analysis.modes.asked import Asked
from hybond.analysis.modes.records import Gap
from hybond.analysis.modes.steps import Met, name_of
from hybond.errors import DivergenceOfTime, HybondError
from hybond.model.graph import Mode

Vector = NDArray[np.float64]

OWN = 20
"""States of a run in each mode that are taken as they are."""
GAPS = 2
"""States without a mode that are told, per mode."""


@dataclass
class Samples:
    """Instants settled from sampled states.

    Parameters
    ----------
    asked : Asked
    project : Asked
        The same model without rules: puts a state on what its mode allows.
    names : sequence of str
    scale : array, shape (states,)
    pool : dict of Mode to list of array
        States of a run, by the mode in which it had them.
    met : Met
    many : int
        States per mode.
    limit : int
        Modes looked at.
    """

    asked: Asked
    project: Asked
    names: tuple[str, ...]
    scale: Vector
    pool: dict[Mode, list[Vector]]
    met: Met
    many: int
    limit: int
    left_out: list[str] = field(default_factory=list)

    def explore(self, first: Iterable[Mode]) -> None:
        """Settle instants from states of all modes that are met, breadth first."""
        queue = deque(dict.fromkeys(first))
        done = set(queue)
        looked = 0
        while queue and looked < self.limit:
            mode = queue.popleft()
            looked += 1
            gaps = 0
            for y in self._states(mode):
                got = self.asked.settled(y, mode)
                named = {n: float(v) for n, v in zip(self.names, y, strict=True)}
                if isinstance(got, DivergenceOfTime):
                    gaps += 1
                    if gaps <= GAPS:
                        self._gap(mode, y, named, got)
                elif not isinstance(got, HybondError):
                    last = self.asked.note(self.met, got, mode, "possible", witness=named)
                    if last not in done:
                        done.add(last)
                        queue.append(last)
        if queue:
            self.left_out.append(f"after samples of {looked} modes: what follows {len(queue)} more")

    def _states(self, mode: Mode) -> Iterator[Vector]:
        """Yield states of a mode: of a run, then near them and far from them."""
        own = self.pool.get(mode, [])[:OWN]
        yield from own
        # the same states every time
        rng = np.random.default_rng(list(mode))
        every = own or [y for some in self.pool.values() for y in some[:3]]
        every = every or [np.zeros(len(self.scale))]
        for k in range(max(self.many - len(own), 0)):
            base = every[k % len(every)]
            size = (0.1, 1.0, 3.0)[k % 3]
            moved = base + size * self.scale * rng.normal(size=len(self.scale))
            # some of them as they were, some at rest: few conditions hold far from both
            keep = rng.uniform(size=len(self.scale))
            y = np.where(keep < 0.3, base, np.where(keep > 0.85, 0.0, moved))
            put = self.project.after(np.append(y, np.zeros(self._terms)), mode)
            if put is not None:
                yield put[: len(y)]

    @property
    def _terms(self) -> int:
        own, lifted = self.asked.graph, self.project.graph
        return len(lifted.integrals) - len(own.integrals)

    def _gap(self, mode: Mode, y: Vector, named: dict[str, float], error: DivergenceOfTime) -> None:
        text = name_of(self.asked.graph, mode)
        self.met.gaps.append(
            Gap(
                begin=text,
                states=(),
                modes=(text,),
                why=error.why.partition(": ")[2] or error.why,
                cycle=True,
                witness=named,
                confirmed=self.asked.stops(y, mode, "HB-N401"),
            )
        )
