"""The studio: a page in the browser or in a notebook in which bond graphs are drawn and run.

`session` speaks in plain messages and knows no web; `server` and `widget` carry them to a page.
What the page shows is made of the text of a model file, which alone is kept: `document` holds it,
`edits` change it, `view`, `strokes` and `problems` say what it means, `runs` simulates it.

The room itself can be called: ``hybond.studio(model)`` shows the page in a notebook.
"""

from __future__ import annotations

import sys
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

from hybond.calls import called

if TYPE_CHECKING:
    from hybond.model.builder import Model
    from hybond.studio.widget import Studio


class _Room(ModuleType):
    @called("hb.studio(model)")
    def __call__(self, model: Model | str | Path | None = None, *, height: int = 640) -> Studio:
        """Open the studio in a notebook; see `hybond.studio.widget.studio`."""
        from hybond.studio.widget import studio

        return studio(model, height=height)


sys.modules[__name__].__class__ = _Room
