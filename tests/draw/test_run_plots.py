"""Plots of runs: jumps, impulses, the strip of modes, prefixes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import hybond as hb
from hybond.draw.impulses import impulses_of
from hybond.draw.mode_strip import stays
from hybond.draw.plots import plot_run
from hybond.draw.scales import axis_scale
from hybond.draw.traces import trace_of
from hybond.errors import UsageError
from hybond.export.latex.plots import plots
from hybond.runs.trace import Violation


def lines(ax: Any, marker: str) -> list[Any]:
    return [line for line in ax.lines if line.get_marker() == marker]


@pytest.mark.slow
def test_line_is_broken_at_a_jump_with_both_limits(bouncing: Any, tmp_path: Path) -> None:
    run = bouncing(4, 0.5)
    figure = plot_run(run, ["v.f"], path=tmp_path / "run.png")
    ax = figure.axes[0]
    (curve,) = lines(ax, "None")[:1]
    assert int(np.isnan(curve.get_ydata()).sum()) == 3
    before, after = lines(ax, "o")
    assert before.get_markerfacecolor() == "white"
    # Restitution 0.5: after = -0.5 * before at each impact.
    assert after.get_ydata() == pytest.approx(-0.5 * before.get_ydata())
    assert (tmp_path / "run.png").stat().st_size > 1000


def test_continuous_signal_is_one_unbroken_line(bouncing: Any) -> None:
    trace = trace_of(bouncing(6).pieces("height"))
    assert not np.isnan(trace.y).any()
    assert len(trace.jumps) == 0


def test_signals_of_one_unit_share_axes_and_the_strip_is_last(switched: Any) -> None:
    figure = plot_run(switched(3), ["i2", "L.f", "_node$.e"], path=None)
    labels = [ax.get_ylabel() for ax in figure.axes]
    assert labels[:2] == ["V", "L.f [mA]"]
    assert [t.get_text() for t in figure.axes[0].get_legend().get_texts()] == ["i2", "_node$.e"]
    assert [t.get_text() for t in figure.axes[-1].get_yticklabels()] == ["pwm", "idle", "half"]
    assert figure.axes[-1].get_xlabel() == "time [µs]"


def test_states_are_named_in_their_blocks(switched: Any) -> None:
    strip = plot_run(switched(3), ["L.f"]).axes[-1]
    assert {"high", "low", "rest", "first", "second"} <= {t.get_text() for t in strip.texts}


def test_impulses_are_arrows_with_areas(bouncing: Any) -> None:
    run = bouncing(3, 0.5)
    # The ball leaves at 5 m/s and comes back at 5 m/s: m (v + v/2) = 7.5 N·s, then half of it.
    assert impulses_of(run, "contact.e")[:, 1] == pytest.approx([7.5, 3.75])
    ax = plot_run(run, ["contact.e"]).axes[0]
    assert "7.5 N·s" in [t.get_text() for t in ax.texts]
    assert sum(len(line.get_xdata()) for line in lines(ax, "^")) == 2


def test_arrows_stay_inside_the_axes(run_of: Any) -> None:
    t, y = [0.0, 1.0], [0.0, 0.0]
    run = run_of({"e": ("V", [(t, y), ([1.0, 2.0], y)])}, [(), ()], impulses=[{}, {"e": -3e-3}])
    ax = plot_run(run, ["e"]).axes[0]
    (tip,) = [line.get_ydata()[0] for line in lines(ax, "v") if len(line.get_ydata())]
    assert ax.get_ylim()[0] < tip < 0


def test_mythical_steps_write_no_impulse(run_of: Any) -> None:
    run = run_of({"e": ("V", [([0.0, 1.0], [0.0, 0.0])])}, [()], impulses=[{"e": 0.0}])
    assert len(impulses_of(run, "e")) == 0


@pytest.mark.slow
def test_thousands_of_events_are_drawn_without_circles(switched: Any, tmp_path: Path) -> None:
    figure = plot_run(switched(2000), ["_node$.e"], path=tmp_path / "dense.png")
    ax = figure.axes[0]
    # The last jump has room on its right, but not on its left.
    assert sum(len(line.get_xdata()) for line in lines(ax, "o")) == 0
    assert len(ax.lines) < 10
    strip = figure.axes[-1]
    assert {"low", "high"} <= {t.get_text() for t in strip.texts}  # named beside the lane


def test_stays_join_segments_of_one_state(switched: Any) -> None:
    run = switched(4)
    assert [s[2] for s in stays(run, 0)] == [1, 0] * 4
    assert [s[2] for s in stays(run, 2)] == [1, 0]


def test_units_that_differ_cannot_share_given_axes(bouncing: Any) -> None:
    from matplotlib.figure import Figure

    ax = Figure().add_subplot()
    with pytest.raises(UsageError, match="HB-D104"):
        plot_run(bouncing(3), ["height", "v.f"], ax=ax)
    assert plot_run(bouncing(3), ["height"], ax=ax) is ax.figure
    assert ax.get_ylabel() == "height [m]"


def test_nothing_to_plot_is_refused(bouncing: Any) -> None:
    with pytest.raises(UsageError, match="HB-D103"):
        plot_run(bouncing(2), [])


def test_only_ten_machines_are_shown_and_the_rest_counted(run_of: Any, tmp_path: Path) -> None:
    names = {f"m{k}": ("off", "on") for k in range(60)}
    modes = [tuple(int(k == 40 + i) for k in range(60)) for i in range(2)]
    pieces = [([0.0, 1.0], [0.0, 1.0]), ([1.0, 2.0], [1.0, 0.0])]
    figure = plot_run(
        run_of({"x": ("", pieces)}, modes, machines=names), ["x"], path=tmp_path / "x.png"
    )
    shown = [t.get_text() for t in figure.axes[-1].get_yticklabels()]
    assert len(shown) == 10 and {"m40", "m41"} <= set(shown)
    assert "and 50 machines more" in [t.get_text() for t in figure.texts]


def test_values_that_are_not_finite_do_not_break_the_plot(run_of: Any, tmp_path: Path) -> None:
    pieces = [([0.0, 1.0, 2.0], [0.0, np.inf, np.nan])]
    plot_run(run_of({"x": ("m", pieces)}, [()]), ["x"], path=tmp_path / "x.png")


@pytest.mark.parametrize(
    ("unit", "largest", "expected"),
    [
        ("V", 12.0, (1.0, "V")),
        ("V", 0.7, (1.0, "V")),
        ("V", 24e3, (1e-3, "kV")),
        ("A", 2e-6, (1e6, "µA")),
        ("kg", 1e-5, (1e6, "10⁻⁶ kg")),
        ("m^2", 1e-6, (1e6, "10⁻⁶ m²")),
        ("1/s", 1e5, (1.0, "1/s")),
        ("", 1e5, (1.0, "")),
        ("V", 0.0, (1.0, "V")),
    ],
)
def test_axis_prefix(unit: str, largest: float, expected: tuple[float, str]) -> None:
    assert axis_scale(unit, largest) == expected


@pytest.mark.slow
def test_names_beside_the_strip_were_cut_at_the_edge_of_the_figure(tmp_path):
    m = hb.Model("blink", domain="electrical")
    m.add(V=hb.Se("1 V"), s=hb.One(), R=hb.R("1 ohm"))
    m.bond("V -> s -> R")
    m.input(u=hb.Input(pwm={"period": "1 ms", "duty": 0.5}))
    m.machine(
        "contact",
        states={"conducting_current": ["s"], "blocking_the_current": []},
        start="conducting_current",
        rules=[
            "conducting_current -> blocking_the_current when u < 0.5",
            "blocking_the_current -> conducting_current when u > 0.5",
        ],
    )
    figure = hb.simulate(m, until="50 ms").plot("R.f", path=tmp_path / "blink.png")
    figure.canvas.draw()
    texts = [t for ax in figure.axes for t in ax.texts if "current" in t.get_text()]
    assert len(texts) == 2
    for text in texts:
        assert text.get_window_extent().x1 <= figure.bbox.x1


def overlapping(figure: Any) -> list[tuple[str, str]]:
    """Return pairs of texts of a figure that lie on each other, as it is drawn."""
    figure.canvas.draw()
    found = []
    texts = [t for t in figure.texts]
    for ax in figure.axes:
        texts += [*ax.texts, ax.yaxis.label, ax.xaxis.label, ax.yaxis.get_offset_text()]
        low, high = ax.get_ylim()
        texts += [t for t in ax.get_yticklabels() if low <= t.get_position()[1] <= high]
        texts += ax.get_legend().get_texts() if ax.get_legend() else []
    shown = [(t.get_text(), t.get_window_extent()) for t in texts if t.get_text()]
    for k, (one, a) in enumerate(shown):
        found += [(one, other) for other, b in shown[:k] if a.padded(-1).overlaps(b.padded(-1))]
    return found


@pytest.mark.slow
def test_long_names_and_values_of_all_sizes_do_not_lie_on_each_other(run_of: Any) -> None:
    t = np.linspace(0.0, 1.0, 50)
    units = ["V", "A", "V", "N*m", "Pa", "m", "K", "m^3/s", "W", "V", "A", "N"]
    sizes = [1.0, 1e-12, 1e12, 3e5, 1e-3, 2e-9, 300.0, 1e-12, 1e6, 24.0, 12.0, 5.0]
    signals = {
        f"subsystem.part.variable_with_a_very_long_name_{k}.e": (u, [(t, s * np.sin((k + 2) * t))])
        for k, (u, s) in enumerate(zip(units, sizes, strict=True))
    }
    figure = plot_run(run_of(signals, [(0,)]), list(signals))
    assert not overlapping(figure)
    said = {t.get_text() for ax in figure.axes for t in ax.texts}
    assert "subsystem.part.variable_with_a_very_long_name_7.e" in said
    assert "[10⁻¹² m³/s]" in {ax.get_ylabel() for ax in figure.axes}


def test_what_is_far_below_the_largest_of_its_unit_has_axes_of_its_own(run_of: Any) -> None:
    t = np.linspace(0.0, 1.0, 20)
    signals = {f"n{k}.e": ("V", [(t, 10.0 ** (k - 6) * np.cos(t))]) for k in range(12)}
    figure = plot_run(run_of(signals, [(0,)]), list(signals))
    assert len(figure.axes) == 3  # twelve values a decade apart, four in each
    for ax in figure.axes:
        low, high = ax.get_ylim()
        for line in ax.lines:
            assert np.ptp(line.get_ydata()) > 2e-4 * (high - low)


def test_small_changes_of_a_large_value_are_counted_from_a_round_number(run_of: Any) -> None:
    t = np.linspace(0.0, 1.0, 20)
    run = run_of({"p.e": ("Pa", [(t, 1e12 + 1e3 * np.sin(6 * t))])}, [(0,)])
    (ax,) = plot_run(run, ["p.e"]).axes
    assert ax.get_ylabel() == "p.e [Pa from 1 TPa]"
    assert max(ax.lines[0].get_ydata()) == pytest.approx(1e3, rel=0.02)
    assert not ax.yaxis.get_offset_text().get_text()


def test_a_run_whose_laws_do_not_hold_shows_it_in_its_plots(tmp_path: Path) -> None:
    """From where they were seen not to hold: a line, a shade, and words; of sound runs nothing."""
    m = hb.Model("rc", domain="electrical")
    m.add(c=hb.C("1 mF", e="10 V"), r=hb.R("1 kohm"), node=hb.Zero())
    m.bond("node -> c", "node -> r")
    run = hb.simulate(m, until="2 s")
    sound = run.plot("c.e")
    run.trace.unsound.append(Violation(0.5, "r", 1.0, 2.0, "R 1 kohm", ""))
    shown = run.plot("c.e")
    dashed = [x.get_xdata()[0] for x in shown.axes[0].lines if x.get_linestyle() == "--"]
    assert dashed == [0.5] and not [x for x in sound.axes[0].lines if x.get_linestyle() == "--"]
    (shade,) = shown.axes[0].patches
    assert shade.get_x() == 0.5 and shade.get_width() == 1.5 and not sound.axes[0].patches
    said = "the laws do not hold from t = 0.5 s on (r)"
    assert any(said in t.get_text() for t in shown.texts)
    assert not any(said in t.get_text() for t in sound.texts)
    run.plot("c.e", path=tmp_path / "c.svg")
    assert "stroke: #a05000" in (tmp_path / "c.svg").read_text()
    assert "hbdoubt, dashed] (3.25,0)" in "\n".join(plots(run, ["c.e"]))
