"""Which way: causal strokes for one mode, and their change from one mode to the next.

The room itself can be called: ``hybond.causality(model)`` is `report.causality`. A room and a
function of one name would hide each other, whichever is imported later.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from types import ModuleType
from typing import TYPE_CHECKING

from hybond.calls import called

if TYPE_CHECKING:
    from hybond.causality.report import CausalityReport
    from hybond.model.builder import Model
    from hybond.model.graph import FlatGraph, Mode


class _Room(ModuleType):
    @called("hb.causality(model)")
    def __call__(
        self, model: Model | FlatGraph, mode: Mapping[str, str] | Mode | None = None
    ) -> CausalityReport:
        """Return the causality of a model; see `hybond.causality.report.causality`."""
        from hybond.causality.report import causality

        return causality(model, mode)


sys.modules[__name__].__class__ = _Room
