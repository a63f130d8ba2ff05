"""Models as text that runs without hybond: C, Java and other languages.

The room itself can be called: ``hybond.export(model, to="c")`` is `targets.export`.
"""

from __future__ import annotations

import sys
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

from hybond.calls import called
from hybond.export.targets import TARGETS, export

if TYPE_CHECKING:
    from hybond.model.builder import Model

__all__ = ["TARGETS", "export"]


class _Room(ModuleType):
    @called('hb.export(model, to="c", path="ball.c")')
    def __call__(
        self, model: Model, *, to: str, path: str | Path | None = None, **options: Any
    ) -> str | bytes:
        """Return a model in another language; see `hybond.export.targets.export`."""
        return export(model, to=to, path=path, **options)


sys.modules[__name__].__class__ = _Room
