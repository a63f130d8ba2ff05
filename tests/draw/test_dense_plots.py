"""Plots of very many points and of fast switching: nothing that stands out is lost."""

import io
import time
from typing import Any

import numpy as np
import pytest

from hybond.draw.plots import COLOURS, event_lines, plot_run
from hybond.draw.traces import thinned, trace_of


def pixels(figure: Any) -> np.ndarray:
    """Return the colours of a figure as shape (rows, columns, 3), 0 to 255."""
    import matplotlib.image

    file = io.BytesIO()
    figure.savefig(file, format="png", dpi=100)
    file.seek(0)
    return np.round(255 * matplotlib.image.imread(file)[:, :, :3]).astype(int)


def inked(picture: np.ndarray) -> np.ndarray:
    """Return which pixels have the colour of the first curve."""
    rgb = [int(COLOURS[0][k : k + 2], 16) for k in (1, 3, 5)]
    found: np.ndarray = np.abs(picture - rgb).max(axis=2) < 40
    return found


def rows_of(figure: Any, ax: Any, value: float) -> int:
    """Return the row of pixels at which a value is drawn on axes."""
    high = figure.get_size_inches()[1] * 100
    scale = 100 / figure.dpi
    return round(high - scale * float(ax.transData.transform((0.0, value))[1]))


def test_a_spike_of_one_point_in_a_million_is_drawn(run_of: Any) -> None:
    t = np.linspace(0.0, 1.0, 1_000_001)
    y = 0.1 * np.sin(5000.0 * t)
    y[654_321] = 7.0
    run = run_of({"x": ("V", [(t, y)])}, [()])
    begun = time.process_time()
    figure = plot_run(run, ["x"], path=io_path())
    took = time.process_time() - begun
    ax = figure.axes[0]
    assert ax.lines[0].get_ydata().max() == 7.0
    assert len(ax.lines[0].get_ydata()) < 8000
    ink = inked(pixels(figure))
    assert ink[rows_of(figure, ax, 6.8) - 2 : rows_of(figure, ax, 6.8) + 3].any()
    assert took < 5.0  # a tenth of it where nothing else runs; without thinning it is far more


def io_path() -> Any:
    """Return where a figure goes that is looked at only."""
    import tempfile
    from pathlib import Path

    return Path(tempfile.mkdtemp()) / "x.png"


@pytest.mark.parametrize("cycles", [60, 5000])
@pytest.mark.sampled(1)
def test_fast_switching_shows_its_edges(switched: Any, cycles: int) -> None:
    figure = plot_run(switched(cycles), ["_node$.e"], path=io_path())
    ink = inked(pixels(figure))
    # halfway between the levels 0 and 24 there are edges alone: two for each period, or all of it
    row = ink[rows_of(figure, figure.axes[0], 12.0)]
    runs = int(np.sum(np.diff(row.astype(int)) == 1))
    if cycles == 60:
        assert runs == pytest.approx(2 * cycles, abs=4)
    else:
        across = figure.axes[0].get_position().width * figure.get_size_inches()[0] * 100
        assert row.sum() > 0.97 * across / 1.02  # the axes are 2 % wider than the time


def test_what_is_left_out_lies_between_what_is_drawn() -> None:
    rng = np.random.default_rng(1)
    t = np.sort(rng.uniform(0.0, 1.0, 200_000))
    y = np.cumsum(rng.normal(size=t.size))
    cuts = np.sort(rng.choice(t.size, 50, replace=False))
    pieces = list(zip(np.split(t, cuts), np.split(y, cuts), strict=True))
    thin = thinned(trace_of(pieces), 0.0, 1.0, columns=300)
    column = np.minimum((t * 300).astype(int), 299)
    drawn = np.isfinite(thin.y)
    kept = np.minimum((thin.t[drawn] * 300).astype(int), 299)
    for k in range(300):
        here, there = y[column == k], thin.y[drawn][kept == k]
        assert (there.min(), there.max()) == (here.min(), here.max())
        assert (there[0], there[-1]) == (here[0], here[-1])


def test_few_points_stay_as_they_are() -> None:
    t = np.linspace(0.0, 1.0, 50)
    trace = trace_of([(t, t), (t + 1.0, -t)])
    assert thinned(trace, 0.0, 2.0, columns=100) is trace


def test_shares_of_a_fast_machine_are_those_of_its_stays(switched: Any) -> None:
    strip = plot_run(switched(2000), ["_node$.e"], path=io_path()).axes[-1]
    low, high = strip.patches[:2]  # of the first lane: low for the second half of each period
    for patch, between in ((low, (-0.4, 0.0)), (high, (0.0, 0.4))):
        data = patch.get_data()
        assert data.baseline == pytest.approx(np.full_like(data.values, between[0]), abs=0.35)
        assert np.mean(data.values - data.baseline) == pytest.approx(0.4, abs=1e-3)


@pytest.mark.parametrize("count", [2, 7, 20])
def test_names_of_curves_stay_inside_the_figure_and_off_the_axes(run_of: Any, count: int) -> None:
    t = np.array([0.0, 1.0])
    names = {f"branch_{k}.capacitor_voltage": ("V", [(t, t + k)]) for k in range(count)}
    run = run_of(names, [(0,)], machines={"m": ("off", "on")})
    figure = plot_run(run, list(names), path=io_path())
    figure.canvas.draw()
    box = figure.axes[0].get_legend().get_window_extent()
    assert box.x1 <= figure.bbox.x1 + 1.0 and box.y1 <= figure.bbox.y1 + 1.0
    axes = figure.axes[0].get_window_extent()
    inside = min(box.x1, axes.x1) > max(box.x0, axes.x0) + 1
    assert not (inside and min(box.y1, axes.y1) > max(box.y0, axes.y0) + 8)


def test_a_notebook_is_given_one_picture(run_of: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    from matplotlib import pyplot

    run = run_of({"x": ("V", [([0.0, 1.0], [0.0, 1.0])])}, [()])
    monkeypatch.setattr(
        "matplotlib.get_backend", lambda: "module://matplotlib_inline.backend_inline"
    )
    before = pyplot.get_fignums()
    figure = plot_run(run, ["x"])
    assert pyplot.get_fignums() == before  # pyplot would show it once more
    assert figure._repr_png_().startswith(b"\x89PNG")


def test_of_events_in_one_pixel_one_has_its_line() -> None:
    from matplotlib.figure import Figure

    ax = Figure().add_subplot()
    event_lines(ax, np.array([3.0, 3.0001, 7.0]), 10.0)
    assert [line.get_xdata()[0] for line in ax.lines] == [3.0, 7.0]
