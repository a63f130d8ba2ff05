"""Plots of many signals and of very many switches stay readable and true."""

from __future__ import annotations

import hybond as hb
from hybond.draw.plots import plot_run


def ladder(n: int) -> hb.Model:
    m = hb.Model("layers", domain="thermal_pseudo", parameters={"n": n})
    m.add({"layer_of_the_wall[1..n]": hb.C("1 kJ/K", e="(270 + i) [K]")})
    m.add({"between[1..n-1]": hb.One(), "r[1..n-1]": hb.R("1 K/W"), "node[1..n]": hb.Zero()})
    m.bond(
        "node[1..n] -> layer_of_the_wall[1..n]",
        "node[1..n-1] -> between[1..n-1] -> node[2..n]",
        "between[1..n-1] -> r[1..n-1]",
    )
    return m


def test_the_legend_of_many_signals_stays_within_the_picture_and_below_the_title() -> None:
    run = hb.simulate(ladder(16), until="24 h")
    figure = plot_run(run, [f"layer_of_the_wall[{k}].e" for k in range(1, 17)], path=None)
    figure.draw_without_rendering()
    (panel,) = figure.axes
    legend = panel.get_legend()
    assert legend is not None
    box, whole = legend.get_window_extent(), figure.bbox
    assert box.x0 >= whole.x0 and box.x1 <= whole.x1
    assert box.y1 <= min(t.get_window_extent().y0 for t in figure.texts)
    looks = {(h.get_color(), h.get_linestyle()) for h in legend.get_lines()}
    assert len(looks) > 7  # more than there are colours: dashes tell the others apart
    assert panel.get_xlabel() == "time [h]"
