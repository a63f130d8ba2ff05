"""The engine as Python: runs are those of the library, event for event, and all beside them."""

from __future__ import annotations

import copy
import functools
import math
import os
import platform
import signal
import sys
import threading
from pathlib import Path

import numpy as np
import pytest
from engine.switched_models import converter, striking
from engine.test_calls import controlled, driven
from engine.test_interrupts import long_run
from engines import assert_same_states
from example_runs import NAMES, STOPPED, example

import hybond as hb
from hybond.engine.compiled import native
from hybond.engine.compiled.sliced import RAISED
from hybond.engine.interpreted.look import PythonLook
from hybond.engine.interpreted.run import PythonModel, PythonRun
from hybond.engine.outcome import engines
from hybond.engine.outcome.engines import choose_engine
from hybond.engine.tables import tables_of

SLOW = {
    *("boost", "elevator_actuators", "ratchet", "rimless_wheel", "rope_and_disc", "three_tanks"),
    *("bouncing_rod", "cam_follower", "planar_puck", "weirs", "woodpecker"),
}
"""Examples that take Python more than a second; they are the library's in a tenth of that."""
BITS = platform.libc_ver()[0] == "glibc"
"""Whether Python and the library have the same sin, exp and pow: then nothing differs at all."""
LENGTHS = {"planar_puck"}
"""Examples that read a length: `math.hypot` of Python rounds in its own way since 3.10."""
CASES = [pytest.param(n, marks=[pytest.mark.slow] * (n in SLOW)) for n in NAMES]


def both(model: hb.Model, **options: object) -> tuple[hb.Result, hb.Result]:
    return (
        hb.simulate(model, engine="library", on_error="return", **options),  # type: ignore[arg-type]
        hb.simulate(model, engine="python", on_error="return", **options),  # type: ignore[arg-type]
    )


@functools.cache
def both_of(name: str) -> tuple[hb.Result, hb.Result]:
    """Return the runs of an example, made once."""
    return both(example(name))


def told(run: hb.Result) -> list[object]:
    """Return all that is told of events, but when they were."""
    return [
        (
            e.cause,
            [(s.mode, s.kind, [(f.machine, f.source, f.target) for f in s.fired]) for s in e.steps],
        )
        for e in run.events
    ]


def assert_alike(library: hb.Result, python: hb.Result, *, bits: bool = BITS) -> None:
    assert python.engine.startswith("the engine as Python") and library.engine == "the library"
    assert told(python) == told(library)
    assert python.status == library.status
    assert str(python.error) == str(library.error)
    assert python.warnings == library.warnings
    times = [[*(e.t for e in run.events), run.t_end] for run in (library, python)]
    if bits:
        assert times[1] == times[0]
        assert python.stats == library.stats
        for a, b in zip(library.segments, python.segments, strict=True):
            assert np.array_equal(a.t, b.t) and np.array_equal(a.y, b.y)
        return
    assert times[1] == pytest.approx(times[0], rel=1e-9, abs=1e-9 * library.t_end)
    assert_same_states(library, python, 1e-8)


@pytest.mark.sampled(8)
@pytest.mark.usefixtures("native")
@pytest.mark.parametrize("name", CASES)
def test_an_example_runs_as_by_the_library(name: str) -> None:
    library, python = both_of(name)
    assert_alike(library, python, bits=BITS and name not in LENGTHS)
    assert (python.error is not None) == (name in STOPPED)


@pytest.mark.usefixtures("native")
@pytest.mark.parametrize("name", ["sliding_clutch", "two_body_collision"])
def test_what_a_sliding_function_reads_is_no_switch_of_that_number(name: str) -> None:
    # bonds have larger numbers than switches: Python said so, C read what stands behind them
    assert_alike(*both_of(name))


@pytest.mark.usefixtures("native")
@pytest.mark.sampled(2)
@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("kind", [converter, striking])
def test_random_switched_models_run_alike(kind, seed: int) -> None:
    assert_alike(*both(kind(seed), until=1.0))


@pytest.mark.usefixtures("native")
@pytest.mark.parametrize("solver", ["radau", "exact", "rk4"])
def test_other_methods_run_alike(solver: str) -> None:
    step = {"step": "5 us"} if solver == "rk4" else {}
    assert_alike(*both(example("half_bridge"), solver=solver, **step))


@pytest.mark.usefixtures("native")
@pytest.mark.parametrize("name", ["mmc_arm", "stick_slip", "bouncing_ball_contact"])
def test_what_is_read_between_is_the_same(name: str) -> None:
    library, python = both_of(name)
    t = np.linspace(0.0, library.t_end, 60)
    stored = [x.path for x in (*library.graph.storages, *library.graph.integrals)]
    ports = [x.path.rpartition(".")[0] for x in library.graph.storages]
    for path in [*stored, *(f"{name}.{v}" for name in ports for v in "ef")]:
        one, other = (np.asarray(run[path].at(t.tolist())) for run in (library, python))
        assert np.array_equal(one, other) if BITS else np.allclose(one, other)
    for k, (a, b) in enumerate(zip(library.segments, python.segments, strict=True)):
        if k % 7 == 0:
            one, other = library.trace.signals.energies(a), python.trace.signals.energies(b)
            assert np.array_equal(one, other) if BITS else np.allclose(one, other)


@pytest.mark.usefixtures("native")
def test_the_time_that_a_sliding_machine_spends_in_a_state_is_the_same() -> None:
    shares = []
    for run in both_of("tank_overflow_sliding"):
        slides = next(s for s in run.segments if s.sliding is not None)
        t = 0.5 * float(slides.t[0] + slides.t[-1])
        shares.append([run.trace.signals.weight(slides, t, 0, k) for k in (0, 1)])
    assert shares[1] == shares[0] if BITS else shares[1] == pytest.approx(shares[0])
    assert sum(shares[1]) == pytest.approx(1.0) and 0.0 < shares[1][0] < 1.0


@pytest.mark.usefixtures("native")
def test_functions_and_blocks_are_called_as_by_the_library() -> None:
    for make, until in ((controlled, 2.0), (lambda: driven(math.sin), 4.0)):
        # a controller remembers: each run has its own
        library = hb.simulate(make(), until, engine="library")
        assert_alike(library, hb.simulate(make(), until, engine="python"))


# -- what a run is asked for, without any library


def as_python(model: hb.Model, *more: object, **options: object) -> hb.Result:
    return hb.simulate(model, *more, engine="python", **options)  # type: ignore[arg-type]


def test_a_law_that_reads_the_second_input_of_a_model_without_machines() -> None:
    """It read the state of a machine that is not there: Python raised, the library read beyond."""
    m = hb.Model("ramp", domain="electrical")
    m.add(V=hb.Se("volts"), r=hb.R({"f": "e*hot"}))
    m.bond("V -> r")
    m.input(volts=hb.Input(table=[[0, 0], [1, 8]], linear=True), hot=hb.Input(constant=0.5))
    library, python = both(m, until=1)
    assert_alike(library, python)
    assert python["r.f"].at(0.5) == pytest.approx(2, rel=1e-12)


def test_progress_and_journal_follow_a_run(tmp_path: Path) -> None:
    seen: list[tuple[float, int]] = []
    run = as_python(
        example("bouncing_ball"),
        progress=lambda t, n: seen.append((t, n)),
        journal=tmp_path / "events.csv",
    )
    assert seen[-1] == (run.t_end, len(run.events))
    assert [t for t, _ in seen] == sorted(t for t, _ in seen)
    rows = (tmp_path / "events.csv").read_text().splitlines()
    assert len(rows) == 1 + len(run.events)


def test_a_run_keeps_the_last_of_its_events() -> None:
    whole = as_python(example("half_bridge"))
    kept = as_python(example("half_bridge"), keep=2)
    assert 2 <= len(kept.events) <= 4 < len(whole.events)
    assert kept.events[-1].t == whole.events[-1].t
    assert kept.stats["events"] == whole.stats["events"]


@pytest.mark.parametrize(
    ("limit", "code"), [({"max_events": 3}, "HB-N404"), ({"max_steps": 5}, "HB-N409")]
)
def test_limits_stop_a_run_with_what_there_is(limit: dict[str, int], code: str) -> None:
    with pytest.raises(hb.NumericsError) as caught:
        as_python(example("half_bridge"), solver="rk45", **limit)
    assert caught.value.code == code
    partial = as_python(example("half_bridge"), solver="rk45", on_error="return", **limit)
    assert partial.error is not None and partial.error.code == code
    assert partial.segments and partial.t_end < 1e-3


@pytest.mark.skipif(sys.platform == "win32", reason="no signals to a process itself")
def test_an_interrupt_keeps_what_there_is() -> None:
    timer = threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT))
    begun: list[float] = []

    def progress(t: float, events: int) -> None:
        if not begun:
            timer.start()
        begun.append(t)

    try:
        run = as_python(long_run(), 1e7, keep=1000, max_steps=10**9, progress=progress)
    finally:
        timer.cancel()
    assert run.status == "interrupted"
    assert 0.0 < run.t_end < 1e7
    # an LC circuit: its energy stays
    assert run["c.e"].at(run.t_end) ** 2 + run["l.f"].at(run.t_end) ** 2 == pytest.approx(1.0, 1e-4)


def test_what_a_function_raises_ends_a_run_that_keeps_its_rows() -> None:
    def u(t: float) -> float:
        if t > 2.0:
            raise ValueError("no input beyond 2 s")
        return 1.0

    run = PythonRun(PythonModel(tables_of(driven(u).flatten(), calling=True, until=9.0)))
    kept = []
    with pytest.raises(ValueError, match="no input beyond"):
        for rows in run.slices(steps=7):
            kept.append(rows)
    assert run.status == RAISED and 1.0 < kept[-1].step_time[-1, 2] == run.t <= 2.0
    assert run.y == pytest.approx([1.0 - math.exp(-run.t)], rel=1e-7)


def test_an_interrupt_within_a_slice_ends_the_run_without_its_rows(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """As a second one does: rows may be half written then."""
    from hybond.engine.run import noted

    model = PythonModel(tables_of(example("bouncing_ball").flatten()))
    run, written = PythonRun(model), noted.report_step

    def interrupted(e, r) -> None:
        written(e, r)
        if e.t > 0.5:
            r.steps += 1
            raise KeyboardInterrupt

    monkeypatch.setattr(noted, "report_step", interrupted)
    kept = []
    with pytest.raises(KeyboardInterrupt):
        for rows in run.slices(steps=3):
            kept.append(rows)
    assert run.status == RAISED
    times = np.concatenate([rows.step_time[:, 2] for rows in kept])
    assert (np.diff(times) >= 0.0).all() and 0.0 < times[-1] <= 0.5


def test_runs_in_threads_are_those_alone() -> None:
    names = ("half_bridge", "clutch", "half_bridge", "relay_feedback")
    model = {n: PythonModel(tables_of(example(n).flatten())) for n in names}
    alone = {}
    for n in names:
        run = PythonRun(model[n])
        list(run.slices())
        alone[n] = run.y
    runs = [PythonRun(model[n]) for n in names]
    threads = [threading.Thread(target=lambda r=r: list(r.slices(steps=20))) for r in runs]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for n, run in zip(names, runs):
        assert np.array_equal(run.y, alone[n])


def test_a_copy_reads_by_itself() -> None:
    run = as_python(example("bouncing_ball"))
    other = copy.deepcopy(run)
    assert other["ball.p"].at(0.5) == run["ball.p"].at(0.5)


def test_a_look_that_was_interrupted_looks_again(monkeypatch: pytest.MonkeyPatch) -> None:
    from hybond.engine.compiled.points import Points

    asked = []

    def u(t: float) -> float:
        asked.append(t)
        if len(asked) == broken:
            raise KeyboardInterrupt
        return 2.0 * t

    broken = -1
    model = PythonModel(tables_of(driven(u).flatten(), calling=True, until=9.0))
    look = PythonLook(model)
    look.into(0.0, [])
    first = model.tables.slots.w.start
    at = Points([1.0, 2.0], [[0.5], [0.25]], accepted=True)
    slots = list(range(first, first + 4))
    meant = look.values(at, slots)
    assert len(set(meant.ravel().tolist())) > 2
    broken = len(asked) + 2
    with pytest.raises(KeyboardInterrupt):
        look.values(at, slots)
    assert np.array_equal(look.values(at, slots), meant)


# -- which engine it is


def test_without_a_library_runs_are_made_by_python(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("HYBOND_ENGINE", str(tmp_path / "absent.so"))
    # looked for anew, though it may be loaded
    monkeypatch.setattr(engines, "library", native.library.__wrapped__)
    run = hb.simulate(example("capacitors_joined"))
    assert run.engine == "the engine as Python (absent.so was not built)"
    with pytest.raises(hb.UsageError, match=r"absent.so was not built") as caught:
        hb.simulate(example("capacitors_joined"), engine="library")
    assert caught.value.code == "HB-S119"


def test_what_kept_the_library_from_being_built_is_said(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Of what a failed installation notes, as `hatch_build.compiled` writes it."""
    monkeypatch.delenv("HYBOND_ENGINE", raising=False)
    monkeypatch.setattr(native, "HERE", str(tmp_path))
    monkeypatch.setattr(engines, "library", native.library.__wrapped__)
    said = choose_engine().said
    assert said == f"the engine as Python ({native.NAME} was not built)"
    (tmp_path / native.WHY).write_text("gcc: fatal error\n  no space left\n", encoding="utf-8")
    noted = f"{native.NAME} was not built: gcc: fatal error no space left"
    assert choose_engine().said == f"the engine as Python ({noted})"
    run = hb.simulate(example("capacitors_joined"))
    assert run.engine == f"the engine as Python ({noted})"


@pytest.mark.usefixtures("native")
def test_with_a_library_python_is_what_is_asked_for() -> None:
    assert hb.simulate(example("capacitors_joined")).engine == "the library"
    run = as_python(example("capacitors_joined"))
    assert run.engine == "the engine as Python (as asked)"


def test_no_other_engine_is_known() -> None:
    with pytest.raises(hb.UsageError, match="engine = 'fortran'") as caught:
        choose_engine("fortran")  # type: ignore[arg-type]
    assert caught.value.code == "HB-S119"
