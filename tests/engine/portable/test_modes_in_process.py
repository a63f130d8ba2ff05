"""The engine as Python against the library: events, kinds of modes, final state."""

from __future__ import annotations

import contextlib
import io
import math

import numpy as np
import pytest
from engine.switched_models import converter, striking

import hybond as hb
from hybond.engine.engine import make_engine
from hybond.engine.run.report import make_report
from hybond.engine.run.run import run_program
from hybond.engine.tables import answered, tables_of

TOLERANCE = 1e-9


def portable(graph, *, events=True, until=None):
    """Run the portable runtime; return its exit code and what it printed."""
    given = {} if until is None else {"until": until}
    engine = make_engine(answered(tables_of(graph, **given)))
    report = make_report(engine)
    report.events = events
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        code = run_program(engine, report)
    return code, printed.getvalue().splitlines()


def transitions(run):
    """Return the transitions of a run as the program prints them."""
    found = []
    for event in run.events:
        for step in event.steps:
            named = [(f.machine, f.source, f.target) for f in step.fired] or [("-", "-", "-")]
            found += [(event.t, event.cause, *names, step.kind) for names in named]
    return found


def compared(name, until=None):
    """Hold one example against the library; return the exit code and the library's run."""
    graph = hb.load(f"examples/{name}.toml").flatten()
    code, lines = portable(graph, until=until)
    run = hb.simulate(graph, until=until, on_error="return")
    told, state = [], {}
    for line in lines:
        words = line.split()
        if words[0] == "state":
            state[words[1]] = float(words[2])
        elif words[0] == "final":
            assert float(words[1]) == pytest.approx(run.t_end, rel=TOLERANCE)
        elif words[0] not in ("#", "impulse"):
            told.append((float(words[0]), *words[1:4], words[5], words[6]))
    wanted = transitions(run)
    assert [t[1:] for t in told] == [t[1:] for t in wanted]
    for (t, *_), (s, *_) in zip(told, wanted, strict=True):
        assert math.isclose(t, s, rel_tol=TOLERANCE, abs_tol=TOLERANCE)
    for path, value in state.items():
        meant = run[path]
        size = max(abs(float(meant.at(t))) for t in np.linspace(0.0, run.t_end, 21))
        assert abs(value - float(meant.at(run.t_end))) <= TOLERANCE * max(size, 1e-3), path
    return code, run


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    "name",
    [
        "bouncing_ball",
        "bouncing_ball_air",
        "bouncing_ball_margetts",
        "bouncing_ball_newton",
        "bouncing_ball_two_junctions",
        "bullet_and_wood",
        "capacitors_joined",
        "clutch",
        "clutch_rigid",
        "diagnosis_circuit",
        "diode_inductor",
        "falling_rod",
        "half_bridge",
        "rope_and_disc",
        "two_body_collision",
    ],
)
def test_events_and_final_state_are_those_of_the_library(name):
    code, run = compared(name)
    assert code == 0
    assert run.status == "ok"


@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    ("name", "until"),
    [
        ("evaporator", "30 s"),
        ("relay_fast_switches", "1 s"),
        ("relay_feedback", "6 s"),
        ("sliding_clutch", None),
        ("tank_overflow_sliding", None),
        ("weirs", "2.5"),
    ],
)
def test_motion_slides_along_the_surfaces_of_the_library(name, until):
    code, run = compared(name, until)
    assert code == 0
    # the other two cross their surfaces again and again
    slides = name not in ("evaporator", "relay_fast_switches", "weirs")
    assert bool(run.trace.slidings) == slides


@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    "name", ["falling_rod_threshold", "diode_inductor_no_mode", "bouncing_ball_no_mode"]
)
def test_a_cycle_of_modes_ends_the_run_where_the_library_ends_it(name):
    code, run = compared(name)
    assert code == 3
    assert run.error.code == "HB-N401"


def test_the_table_has_both_limits_of_an_event():
    graph = hb.load("examples/capacitors_joined.toml").flatten()
    _, lines = portable(graph, events=False)
    assert lines[0] == "time,C1.e,C2.e,join.f"
    rows = [[float(a) for a in line.split(",")] for line in lines[1:]]
    left, right = [r for r in rows if r[0] == 1.0]
    # 10 C and 8 C on 3 F: 6 V, from charge alone
    assert left[1:3] == [10.0, 4.0]
    assert right[1:3] == pytest.approx([6.0, 6.0], rel=1e-15)
    assert rows[0][0] == 0.0
    assert rows[-1][0] == 2.0
    assert len(rows) == 502


@pytest.mark.sampled(3)
@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("kind", [converter, striking])
def test_random_switched_models_run_alike(kind, seed):
    graph = kind(seed).flatten()
    code, lines = portable(graph, until=1.0)
    run = hb.simulate(graph, until=1.0, on_error="return")
    told = [
        line.split() for line in lines if line.split()[0] not in ("state", "final", "#", "impulse")
    ]
    wanted = transitions(run)
    assert (code == 0) == (run.error is None)
    assert [(w[1], w[2], w[3], w[5], w[6]) for w in told] == [t[1:] for t in wanted]
    assert [float(w[0]) for w in told] == pytest.approx([t[0] for t in wanted], abs=1e-8)
