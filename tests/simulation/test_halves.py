"""Two halves of a run are the whole: the same events, and the same state at the end."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import hybond as hb
from hybond.runs.times import end_of

EXAMPLES = Path(__file__).parents[2] / "examples"
NAMES = sorted(p.stem for p in EXAMPLES.glob("*.toml"))
IDLE = (".heading", ".slow")
"""What friction in the plane keeps of its direction: at rest it means nothing."""
SAME = 1e-12


def outcome(run: hb.Result) -> list[tuple[str, tuple[int, ...], tuple[str, ...]]]:
    return [(e.cause, e.steps[-1].mode, e.landed) for e in run.events]


def sizes(run: hb.Result) -> dict[str, float]:
    """Return the largest value of what is stored or integrated, by name."""
    paths = [s.path for s in run.graph.storages] + [i.path for i in run.graph.integrals]
    rows = np.vstack([np.abs(s.y[:, : len(paths)]) for s in run.segments]).max(axis=0)
    return {p: size or 1.0 for p, size in zip(paths, rows.tolist()) if not p.endswith(IDLE)}


def values(state: hb.State) -> dict[str, float]:
    return {**state.stored, **state.signals}


def growth(model: hb.Model, whole: hb.Result, end: float) -> float:
    """Return by how much the run makes errors at its start larger: impacts make them grow."""
    begin = whole.state(0.0)
    moved = 1e-9
    stored = {k: v * (1.0 + moved) for k, v in begin.stored.items()}
    signals = {k: v * (1.0 + moved) for k, v in begin.signals.items()}
    start = {**stored, **signals, **begin.machines}
    other = hb.simulate(model, end, start=start, on_error="return")
    if outcome(other)[1:] != outcome(whole)[1:]:
        return math.inf
    a, b, size = values(whole.state()), values(other.state()), sizes(whole)
    return max([1.0, *(abs(a[k] - b[k]) / (moved * size[k]) for k in size)])


def hold(name: str, cuts: list[float]) -> None:
    model = hb.load(EXAMPLES / f"{name}.toml")
    whole = hb.simulate(model, on_error="return")
    end = end_of(None, model.experiment)
    size = sizes(whole)
    for t in cuts:
        first = hb.simulate(model, t, on_error="return")
        if first.error is not None:
            assert outcome(first) == outcome(whole)
            assert first.t_end == pytest.approx(whole.t_end, rel=SAME)
            continue
        second = hb.simulate(model, end, start=first, on_error="return")
        assert second.t_begin == t
        assert second.status == whole.status
        assert second.t_end == pytest.approx(whole.t_end, rel=SAME)
        assert outcome(first) + outcome(second) == outcome(whole), t
        times = np.array([e.t for run in (first, second) for e in run.events])
        np.testing.assert_allclose(times, whole.events.t, rtol=0.0, atol=1e-9 * end)
        a, b = values(whole.state()), values(second.state())
        off = max([0.0, *(abs(a[k] - b[k]) / size[k] for k in size)])
        if off > SAME:
            # each located instant is known to within `event_tol`, 1e-12 of the run
            assert off <= SAME * len(whole.events) * growth(model, whole, end), (name, t, off)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", NAMES)
def test_halves_are_the_whole(name: str) -> None:
    end = end_of(None, hb.load(EXAMPLES / f"{name}.toml").experiment)
    hold(name, [0.137 * end, 0.731 * end])


@pytest.mark.parametrize(
    ("name", "t"),
    [
        ("bouncing_ball_newton", 9.0),  # at rest, where its impacts have accumulated
        ("bouncing_ball_newton", 3.5),  # while they accumulate
        ("tank_overflow_sliding", 438.0),  # while it slides
        ("sliding_clutch", 0.5),
        ("weirs", 1.0214623009342059),  # in an instant
        ("newtons_cradle", 2.5),  # balls touch, and nothing happens
    ],
)
def test_halves_where_it_is_difficult(name: str, t: float) -> None:
    end = end_of(None, hb.load(EXAMPLES / f"{name}.toml").experiment)
    hold(name, [min(t, 0.9 * end)])


def sampled_computer() -> hb.Model:
    m = hb.Model("loop", domain="electrical")
    m.add(u=hb.Se("held"), r=hb.R("1 kohm"), c=hb.C("1 mF", e="1 V"), i=hb.One())
    m.bond("u -> i -> r", "i -> c")
    m.signal(held=hb.Sampled("-0.7*c.e", every="100 ms"))
    return m


@pytest.mark.parametrize("t", [0.3, 0.35, 1.0])
def test_a_sampled_computer_goes_on(t: float) -> None:
    # between instants c.e goes to u = -0.7 c.e(k), so that each period multiplies it by the same
    m = sampled_computer()
    first = hb.simulate(m, t)
    second = hb.simulate(m, "2 s", start=first)
    factor = (1.0 + 0.7) * math.exp(-0.1) - 0.7
    assert second.final["c.e"] == pytest.approx(factor**20, rel=1e-11)


def test_fixed_steps_go_on_in_the_same_grid() -> None:
    # Euler: each step of 0.1 multiplies by 1 - 0.1; a cut within a step must not add another one
    m = hb.Model("rc", domain="electrical")
    m.add(c=hb.C("1 F", e="1 V"), r=hb.R("1 ohm"), n=hb.Zero())
    m.bond("n -> c", "n -> r")
    for t in (0.2, 0.25):
        first = hb.simulate(m, t, solver="euler", step=0.1)
        second = hb.simulate(m, 1.0, solver="euler", step=0.1, start=first)
        assert second.final["c.e"] == pytest.approx(0.9**10, rel=1e-14)


def test_the_engine_as_python_goes_on_as_well() -> None:
    model = hb.load(EXAMPLES / "bouncing_ball_newton.toml")
    first = hb.simulate(model, "1 s", engine="python")
    own = hb.simulate(model, "2 s", start=first, engine="python")
    other = hb.simulate(model, "2 s", start=first, engine=None)
    assert outcome(own) == outcome(other)
    assert own.final == pytest.approx(other.final, rel=1e-13, abs=1e-15)


def test_a_shorter_run_is_the_beginning_of_the_longer_one() -> None:
    # of an experiment: its thresholds of time are parts of what that lasts
    model = hb.load(EXAMPLES / "bouncing_ball.toml")
    whole, part = hb.simulate(model), hb.simulate(model, "1.5 s")
    n = len(part.segments) - 1
    for a, b in zip(whole.segments[:n], part.segments[:n], strict=True):
        assert np.array_equal(a.t, b.t)
        assert np.array_equal(a.y, b.y)
