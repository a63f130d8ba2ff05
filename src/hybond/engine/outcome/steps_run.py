"""A run of time-stepping: the run itself, and how good its step was."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager
from dataclasses import replace

from hybond.blocks.runners import Runner
from hybond.engine.outcome.beginnings import Beginning
from hybond.engine.outcome.engine_run import EngineRun
from hybond.engine.outcome.engines import EngineChoice, Prepared, prepared
from hybond.engine.outcome.step_error import BAD, StepError, compare
from hybond.engine.tables.options import Settings
from hybond.errors import HybondError
from hybond.model.expressions import Number
from hybond.model.graph import FlatGraph
from hybond.units import format_quantity

FEW = 20
"""With fewer steps a run is warned about: the comparison with longer steps says nothing then."""
INCOMMENSURATE = 0.5 * (1.0 + 5.0**0.5)
"""A run is compared with one of steps longer by the ratio that no fraction comes close to. With
steps twice as long events of a source whose period is a multiple of both would fall to the same
places of either grid, and the two runs be wrong alike."""

NO_END = "HB-N310"
"""What ends a run whose steps do not converge, as where something grows faster than in one."""
MUCH_SHORTER = 10.0
"""Times that a step is shorter which is advised where nothing was estimated."""


class StepsRun:
    """One run by time-stepping; `trace` holds what it did.

    Parameters
    ----------
    runners : mapping
        What runs each block, by its path: a block may run once only, so that the error of such a
        run is not estimated.
    """

    def __init__(
        self,
        graph: FlatGraph,
        settings: Settings,
        maker: EngineChoice,
        *,
        progress: Callable[[float, int], object] | None = None,
        runners: Mapping[str, Runner] | None = None,
        begin: Beginning | None = None,
        until: float | None = None,
        shown: Prepared | None = None,
    ) -> None:
        self.graph = graph
        self.begin = begin
        self.settings = settings
        self.progress = progress
        self._maker = maker
        own = prepared(graph, settings, maker)
        self._fine = EngineRun(
            own, progress=progress, runners=runners, begin=begin, until=until, shown=shown
        )
        self.trace = self._fine.trace
        assert settings.step is not None
        self.step = settings.step
        # with two steps in all there is nothing to compare
        lasts = (until or settings.until) - self.trace.begin
        # what ends the run would end the other one elsewhere
        self._compares = lasts > 4.0 * self.step and not runners and graph.ends < 0
        self._until = until
        self._refused = ""

    def run(self) -> str:
        """Run to the end, and once more with a longer step; return ``"ok"``.

        Raises
        ------
        HybondError
            What stopped the run. `trace` is complete up to there.
        KeyboardInterrupt
            Likewise.
        """
        self._warn_of_friction()
        status = self._fine.run()
        if self._compares:
            self._compare()
        if self.trace.stats["steps"] < FEW:
            self._warn_of_few_steps()
        return status

    def so_far(self) -> AbstractContextManager[None]:
        """Have all that was computed in `trace`, as long as one looks at it between two slices."""
        return self._fine.so_far()

    def _compare(self) -> None:
        """Run with a longer step, and note what the difference says."""
        error = self._apart()
        if error is None and self._refused == NO_END:
            self.trace.warn(
                f"the error of step = {format_quantity(self.step, 's')} cannot be estimated: "
                f"steps 1.6 times as long do not converge ({NO_END}); try step = "
                f"{format_quantity(self.step / MUCH_SHORTER, 's')} or less"
            )
        if error is not None:
            self.trace.stats["step_error"] = max(error.end, error.mean)
            self.trace.stats["step_advised"] = error.advised
            if max(error.end, error.mean) > BAD:
                self.trace.warn(error.text())

    def _apart(self) -> StepError | None:
        """Return what a run with longer steps says of the error of this one, if it can be made."""
        longer = replace(self.settings, step=INCOMMENSURATE * self.step)
        coarse = EngineRun(
            prepared(self.graph, longer, self._maker),
            begin=self.begin,
            until=self._until,
            # so that a run can be interrupted here as well
            progress=None if self.progress is None else self._progress_at_end,
        )
        try:
            coarse.run()
        except HybondError as refused:
            self._refused = refused.code
            return None
        except KeyboardInterrupt:
            return None
        return compare(self.graph, self.step, INCOMMENSURATE, self.trace, coarse.trace)

    def _progress_at_end(self, _: float, __: int) -> None:
        if self.progress is not None:
            self.progress(self.settings.until, self.trace.events.total)

    def _warn_of_few_steps(self) -> None:
        """Say that the step is coarse, and whether anything was estimated."""
        estimate = "error estimate means little" if self._compares else "error cannot be estimated"
        steps = int(self.trace.stats["steps"])
        count = f"{steps} step" + "s" * (steps != 1)
        self.trace.warn(
            f"step = {format_quantity(self.step, 's')} is coarse: the run has only {count}, and "
            f"its {estimate}; try step = {format_quantity(self.settings.until / 1000.0, 's')} or "
            "less"
        )

    def _warn_of_friction(self) -> None:
        """Say where this scheme means something else than an impact without friction."""
        laws = [(m.path, m.law) for m in self.graph.machines if m.law is not None]
        paths = [
            path
            for path, law in laws
            if law.limit is not None and not isinstance(law.limit, Number)
        ]
        if paths and any(law.gap is not None for _, law in laws):
            self.trace.warn(
                f"time-stepping lets the friction of {', '.join(paths)} act during impacts as well"
            )
