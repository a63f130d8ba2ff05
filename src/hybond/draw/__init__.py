"""Bond graphs and results as pictures: layout, SVG, plots."""

from hybond.draw.drawing import Drawing, draw, draw_mode
from hybond.draw.layout import layout

__all__ = ["Drawing", "draw", "draw_mode", "layout"]
