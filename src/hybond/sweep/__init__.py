"""Many runs of one model, each with other parameters.

The room itself can be called: ``hybond.sweep(model, plan, collect=...)`` is `sweeping.sweep`.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

from hybond.calls import called

if TYPE_CHECKING:
    from hybond.model.builder import Model
    from hybond.progress import Asked
    from hybond.runs.ends import Until
    from hybond.sweep.plan import Plan
    from hybond.sweep.table import SweepTable


class _Room(ModuleType):
    @called('hb.sweep(model, plan, collect="final(ball.p)", out="sweep")')
    def __call__(
        self,
        model: Model,
        plan: Plan | Mapping[str, Any],
        *,
        collect: str | Sequence[str],
        until: Until = None,
        parameters: Mapping[str, Any] | None = None,
        out: str | Path | None = None,
        runs: str = "",
        workers: int | None = None,
        executor: Any = None,
        part: int | None = None,
        progress: Asked = None,
        **options: Any,
    ) -> SweepTable:
        """Run all members of a plan; see `hybond.sweep.sweeping.sweep`."""
        from hybond.sweep.sweeping import sweep

        return sweep(
            model,
            plan,
            collect=collect,
            until=until,
            parameters=parameters,
            out=out,
            runs=runs,
            workers=workers,
            executor=executor,
            part=part,
            progress=progress,
            **options,
        )

    def estimate(self, *args: Any, **options: Any) -> Any:
        """Return what a sweep takes; see `hybond.sweep.estimating.estimate`."""
        from hybond.sweep.estimating import estimate

        return estimate(*args, **options)


sys.modules[__name__].__class__ = _Room
