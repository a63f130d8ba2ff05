"""Plots of many signals and of very many switches stay readable and true."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.colors import to_rgb

import hybond as hb
from hybond.draw.mode_strip import _COLOURS
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


def test_a_lane_of_very_many_stays_has_the_colours_mixed_by_their_time() -> None:
    m = hb.Model("chopper", domain="electrical", parameters={"T": "1 ms", "d": 0.25})
    m.add(V=hb.Se("1 V"), s=hb.One(), n=hb.Zero(), r=hb.R("1 ohm"))
    m.bond("V -> s -> n -> r")
    m.machine(
        "leg",
        states={"on": ["s"], "off": []},
        start="on",
        rules=["on -> off when mod(time, T)/T >= d", "off -> on when mod(time, T)/T < d"],
    )
    run = hb.simulate(m, until="1 s")
    figure = plot_run(run, ["r.e"], path=None)
    strip = figure.axes[-1]
    (image,) = strip.get_images()
    shown = np.asarray(image.get_array())[0]
    on, off = np.array(to_rgb(_COLOURS[0])), np.array(to_rgb(_COLOURS[1]))
    np.testing.assert_allclose(shown.mean(axis=0), 0.25 * on + 0.75 * off, atol=1e-6)
    # no pixel shows one of the states alone
    assert np.abs(shown - on).max(axis=1).min() > 0.1
    assert image.get_extent()[:2] == pytest.approx([0.0, 1.0])
