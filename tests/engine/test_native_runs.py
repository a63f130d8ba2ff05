"""Every example by the compiled library: events, states, dense steps.

What happens in an example stands in `events/`, in the words of an exported program: it was written
down by another engine, of which not a line was shared, and to whose runs this one agreed. It did
not say which of several idle diodes conducts (cockcroft_walton, mmc_arm, the start of
parallel_resonant_converter): that is written down from an exported program. Of buck two lines are
gone: a diode that began to conduct and ended within one instant, at a current of 1e-16 A. Where the
current of parallel_resonant_converter runs through both its legs, they share it and end together:
six lines are later, those of the leg that had been given none.
"""

from __future__ import annotations

import threading
from pathlib import Path

import numpy as np
import pytest
from engine.by_engine import EngineModel, EngineRun
from example_runs import INTEGRATED, NAMES, STOPPED, example
from export.programs import Said, check, read_events

import hybond as hb
from hybond.engine.compiled.rows import Rows
from hybond.engine.compiled.sliced import OK, PAUSED, REFUSED
from hybond.engine.expressions.pairs import DEPTH
from hybond.engine.outcome.records import BROKEN
from hybond.engine.tables import ModelTables, tables_of
from hybond.model.planar_friction import kept_paths

CAUSES = ["start", "guard", "time", "input", "accumulation", "step", "sample"]
KINDS = ["mythical", "pinnacle", "continuous"]
EVENTS = Path(__file__).parent / "events"


def tables(name: str) -> ModelTables:
    return tables_of(example(name).flatten(), **INTEGRATED)


def written(name: str) -> Said:
    """Return what happens in an example."""
    return read_events((EVENTS / f"{name}.txt").read_text(encoding="utf-8"))


def said_by(run: EngineRun, rows: list[Rows]) -> Said:
    """Return what a run wrote down in the words of an exported program."""
    t = run.model.tables
    first = t.ints["state_first"]
    said = Said(end=run.t, stopped=run.fault.code if run.status == REFUSED else "")
    for part in rows:
        visit = fired = hit = 0
        for (when, *_), place in zip(part.instant_time, part.instant_place):
            if place[0] >= BROKEN:
                continue  # an instant that could not be settled is no event
            for kind, transitions, hits in part.visit[visit : visit + place[1], :3]:
                for machine, source, target in part.fired[fired : fired + transitions, :3]:
                    states = [
                        "sliding" if k < 0 else t.states[first[machine] + k]
                        for k in (source, target)
                    ]
                    names = (CAUSES[place[0]], t.machines[machine], *states, KINDS[kind])
                    said.transitions.append(names)
                if not transitions:
                    said.transitions.append((CAUSES[place[0]], "-", "-", "-", KINDS[kind]))
                said.times += [float(when)] * max(transitions, 1)
                for k in range(hit, hit + hits):
                    name = t.bonds[part.hit[k]]
                    said.impulses.append(
                        (float(when), KINDS[kind], name, float(part.hit_area[k, 0]))
                    )
                fired, hit = fired + transitions, hit + hits
            visit += place[1]
    own = kept_paths(t.graph)
    paths = [s.path for s in (*t.graph.storages, *t.graph.integrals)]
    said.states = {p: float(v) for p, v in zip(paths, run.y) if p not in own}
    return said


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", NAMES)
def test_an_example_does_what_is_written_of_it(name: str) -> None:
    run = EngineRun(EngineModel(tables(name)))
    rows = list(run.slices(steps=97))
    assert run.status == (REFUSED if name in STOPPED else OK)
    check(name, said_by(run, rows), written(name))


@pytest.mark.parametrize("name", ["bouncing_ball", "boost", "cam_follower", "planar_puck"])
def test_slices_change_nothing(name: str) -> None:
    model = EngineModel(tables(name))
    whole, sliced = EngineRun(model), EngineRun(model)
    (rows,) = whole.slices(steps=-1)
    parts = list(sliced.slices(steps=1))
    assert len(parts) > 10
    assert np.array_equal(whole.y, sliced.y)
    for column in Rows.__slots__:
        if column not in ("step_place",):
            joined = np.concatenate([getattr(part, column) for part in parts])
            np.testing.assert_array_equal(joined, getattr(rows, column), column)
    joined = np.concatenate([part.step_place for part in parts])
    assert np.array_equal(joined, rows.step_place)


@pytest.mark.parametrize("name", ["bouncing_ball", "boost", "stick_slip", "planar_puck", "weirs"])
def test_steps_join_and_their_polynomials_end_where_they_should(name: str) -> None:
    """By either method; what is put back on constraints moves by rounding only."""
    (rows,) = EngineRun(EngineModel(tables(name))).slices(steps=-1)
    t0, t1, t = rows.step_time.T
    y0, y1, y = (rows.step_state[:, k] for k in range(3))
    size = np.abs(y).max(axis=0) + 1e-300
    assert np.abs(y0 + rows.step_dense.sum(axis=1) - y1).max(axis=0) == pytest.approx(
        0.0 * size, abs=1e-9 * size.max()
    )
    assert (t0 < t1).all() and (t <= t1).all() and (t > t0).all()
    same = rows.step_place[1:, 0] == rows.step_place[:-1, 0]
    assert same.any()
    assert np.array_equal(t0[1:][same], t[:-1][same])
    assert np.array_equal(y0[1:][same], y[:-1][same])
    # the first step behind an instant begins with the state that it left
    for k in np.flatnonzero(~same) + 1:
        after = rows.instant_state[rows.step_place[k, 0] - 1, 1]
        assert np.array_equal(y0[k], after)


def test_runs_beside_each_other_are_those_alone() -> None:
    """In threads, on the same tables and on others."""
    models = [EngineModel(tables(n)) for n in ("cam_follower", "boost", "cam_follower", "weirs")]
    alone = []
    for model in models:
        run = EngineRun(model)
        list(run.slices())
        alone.append(run.y)
    runs = [EngineRun(model) for model in models]
    threads = [threading.Thread(target=lambda r=r: list(r.slices(steps=50))) for r in runs]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for run, y in zip(runs, alone):
        assert np.array_equal(run.y, y)


def test_a_run_that_is_left_and_taken_up_again_writes_nothing_twice() -> None:
    model = EngineModel(tables("boost"))
    (whole,) = EngineRun(model).slices(steps=-1)
    run, steps, instants = EngineRun(model), 0, 0
    while run.status == PAUSED:
        for rows in run.slices(steps=40):
            steps, instants = steps + len(rows.step_time), instants + len(rows.instant_time)
            break
    assert (steps, instants) == (len(whole.step_time), len(whole.instant_time))


@pytest.mark.parametrize("steps", [0, -2, 2**31, 2**32])
def test_a_slice_of_no_steps_is_refused(steps: int) -> None:
    with pytest.raises(ValueError, match="slice"):
        next(EngineRun(EngineModel(tables("boost"))).slices(steps=steps))


@pytest.mark.parametrize("n", [DEPTH, DEPTH + 1])
@pytest.mark.sampled(1)
@pytest.mark.slow
def test_a_guard_as_deep_as_the_stack_runs_and_a_deeper_one_is_refused(n: int) -> None:
    """A current grows as 1 - exp(-t), and a sum of n such is compared with n/2."""
    m = hb.Model("deep", domain="electrical")
    m.add(v=hb.Se(1), i=hb.One(), r=hb.R(1), l=hb.I(1))
    m.add(c=hb.C(1, e=1), q=hb.Zero(), s=hb.One(), load=hb.R(0.3))
    m.bond("v -> i -> r", "i -> l", "c -> q -> s -> load")
    m.signal(s1="l.f")
    for k in range(2, n + 1):
        m.signal(**{f"s{k}": f"l.f + s{k - 1}"})
    rules = [f"a -> b when s{n} > {0.5 * n} [A]"]
    m.machine("w", states={"a": [], "b": ["s"]}, start="a", rules=rules)
    if n > DEPTH:
        with pytest.raises(hb.ModelError) as caught:
            tables_of(m.flatten(), until=2.0)
        assert caught.value.code == "HB-E636"
        return
    run = EngineRun(EngineModel(tables_of(m.flatten(), until=2.0)))
    instants = [t for rows in run.slices() for t, *_ in rows.instant_time]
    assert instants == [0.0, pytest.approx(np.log(2.0), rel=1e-8)]


def test_a_run_can_be_left_between_two_slices() -> None:
    run = EngineRun(EngineModel(tables("boost")))
    seen = []

    def stop(t: float) -> None:
        seen.append(t)
        if len(seen) == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        list(run.slices(steps=20, between=stop))
    assert run.status == PAUSED
    assert seen == sorted(seen) and 0.0 < run.t < 0.004
    list(run.slices())
    whole = EngineRun(EngineModel(tables("boost")))
    list(whole.slices())
    assert np.array_equal(run.y, whole.y)


def test_why_a_run_stopped_is_told() -> None:
    run = EngineRun(EngineModel(tables("diode_inductor_no_mode")))
    list(run.slices())
    code, why = run.fault.code, run.fault.why
    assert (run.status, code) == (REFUSED, "HB-N401")
    assert why


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="no /proc")
@pytest.mark.slow
def test_memory_is_given_back() -> None:
    """Such a run takes about a third of a megabyte, and more when it is kept than when it ends."""
    options = {**INTEGRATED, "until": 0.1}
    model = EngineModel(tables_of(example("planar_puck").flatten(), **options))

    def resident() -> float:
        return 4096e-6 * int(Path("/proc/self/statm").read_text().split()[1])

    def made() -> EngineRun:
        run = EngineRun(model)
        list(run.slices())
        return run

    for _ in range(50):
        made()
    before = resident()
    for _ in range(200):
        made()
    ended = resident() - before
    # many, for some fit into what tests before have left free
    kept = [made() for _ in range(1000)]
    assert len(kept) == 1000
    assert resident() - before > 20.0  # MB: what is measured can be seen
    assert ended < 4.0


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", NAMES)
def test_an_example_does_the_same_at_its_own_tolerance(name: str) -> None:
    """Steps are long there: touches are decided between few points."""
    run = EngineRun(EngineModel(tables_of(example(name).flatten())))
    said, meant = said_by(run, list(run.slices())), written(name)
    assert said.transitions == meant.transitions
    assert said.times == pytest.approx(meant.times, abs=1e-6 * meant.end)
    for path, value in meant.states.items():
        assert said.states[path] == pytest.approx(value, abs=1e-4 * meant.sizes[path]), path


def test_impacts_come_when_the_closed_form_says() -> None:
    """A ball falls from h0; each flight takes eps times the one before."""
    graph = example("bouncing_ball_newton").flatten(parameters={"eps": 0.8})
    run = EngineRun(EngineModel(tables_of(graph, until="4 s")))
    impacts = [t for rows in run.slices() for t, *_ in rows.instant_time[1:]]
    fall = np.sqrt(2.0 * 3.0 / 9.81)
    meant = [fall * (1.0 + 2.0 * sum(0.8**j for j in range(1, k + 1))) for k in range(len(impacts))]
    assert len(impacts) == sum(t <= 4.0 for t in meant) >= 4
    assert impacts == pytest.approx(meant, rel=1e-9)
