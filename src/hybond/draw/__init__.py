"""Bond graphs and results as pictures: layout, SVG, TikZ, plots.

The room itself can be called: ``hybond.draw(graph)`` is `drawing.draw`. A room and a function of
one name would hide each other, whichever is imported later.
"""

from __future__ import annotations

import sys
from types import ModuleType
from typing import TYPE_CHECKING, Any

from hybond.calls import called
from hybond.draw.arrange import layout
from hybond.draw.badges import Badge
from hybond.draw.drawing import Drawing, draw, draw_mode
from hybond.draw.hybrid import draw_hybrid, draw_modes
from hybond.draw.schematic import draw_schematic

if TYPE_CHECKING:
    from hybond.model.builder import Model
    from hybond.model.graph import FlatGraph

__all__ = [
    "Badge",
    "Drawing",
    "draw",
    "draw_hybrid",
    "draw_mode",
    "draw_modes",
    "draw_schematic",
    "layout",
]


class _Room(ModuleType):
    @called("hb.draw(model)")
    def __call__(self, graph: Model | FlatGraph, **options: Any) -> Drawing:
        """Draw a bond graph; see `hybond.draw.drawing.draw`."""
        return draw(graph, **options)


sys.modules[__name__].__class__ = _Room
