"""Values, powers and energies of finished runs by the library: those of the reference."""

from __future__ import annotations

import numpy as np
import pytest
from engine.by_engine import EngineLook
from engine.looked_at import (
    CASES,
    OWN,
    QUICK,
    look_at,
    look_at_steps,
    model_of,
    reference,
    rows_of,
    segments_of,
    slid_in,
    stretches,
)

import hybond as hb
from hybond.engine.compiled.native import OK
from hybond.engine.compiled.points import Points, Steps, Within
from hybond.engine.engine import make_engine
from hybond.engine.looking import energies, look
from hybond.engine.outcome.polynomial import Polynomial
from hybond.engine.tables import answered
from hybond.modes.sliding.view import equations_of
from hybond.programs.combined import Combined
from hybond.trace import Segment


def read(
    look: EngineLook, run: hb.Result, segment: Segment, t: np.ndarray, names: list[str]
) -> dict[str, np.ndarray]:
    """Return signals at times of a segment as they follow from values of the library."""
    n = run.program.nx + run.program.ns
    y = np.array(segment.rows(t.tolist()))[:, :n]
    points = Points(t, y, accepted=np.isin(t, segment.t))
    size = run.program.slots.size
    found = {}
    equations = equations_of(run.program, segment)
    columns = list(look.values(points, np.arange(2 * size)).T)
    shares, values = look.parts(points, np.arange(2 * size))
    assert shares.sum(axis=1) == pytest.approx(1.0, abs=1e-9)
    for name in names:
        e = run.expression(name)
        f = run.program.compile_arrays(e)
        if isinstance(equations, Combined) and equations.switched(e):
            each = [np.broadcast_to(f(list(values[:, p].T)), t.shape) for p in range(len(shares.T))]
            found[name] = np.sum(shares * np.array(each).T, axis=1)
        else:
            found[name] = np.array(np.broadcast_to(f(columns), t.shape), dtype=float)
    return found


def times_of(segment: Segment) -> np.ndarray:
    """Return accepted points of a segment, and some between."""
    inner = segment.t[0] + np.array([0.1, 0.37, 0.5, 0.93]) * (segment.t[-1] - segment.t[0])
    return np.unique(np.concatenate([segment.t[:: max(1, len(segment.t) // 5)], inner]))


@pytest.mark.parametrize("name", CASES)
def test_values_are_those_of_the_reference(name: str) -> None:
    """At accepted points and between them: all signals by name, all bond variables."""
    run = reference(name)
    look = EngineLook(model_of(name))
    own = [b.name for b in run.graph.bonds if ".switch" not in b.name]
    names = [*run.names, *(f'"{b}".{kind}' for b in own for kind in "ef")]
    meant: dict[str, list[np.ndarray]] = {n: [] for n in names}
    found: dict[str, list[np.ndarray]] = {n: [] for n in names}
    for segment in segments_of(run):
        t = times_of(segment)
        look_at(look, run, segment)
        ours = read(look, run, segment, t, names)
        theirs = run._of_segment(segment, names, t)
        for n in names:
            meant[n].append(theirs[n])
            found[n].append(ours[n])
    for n in names:
        one, other = np.concatenate(found[n]), np.concatenate(meant[n])
        assert one == pytest.approx(other, rel=0, abs=1e-9 * (np.abs(other).max() + 1e-12)), n


def test_the_quick_examples_have_what_can_be_looked_into() -> None:
    runs = [reference(name) for name in (*OWN, *QUICK)]
    segments = [(run, s) for run in runs for s in segments_of(run)]
    assert any(s.landed for _, s in segments)
    parts = [equations_of(run.program, s) for run, s in segments]
    assert any(isinstance(p, Combined) and len(p.parts) > 2 for p in parts)
    assert any(p.tableau.constraints for p in parts)
    assert any(not p.linear for p in parts)


@pytest.mark.parametrize("name", CASES)
def test_powers_and_energies_are_those_of_the_reference(name: str) -> None:
    """Which integrates them with the state; here they are found from the state."""
    run = reference(name)
    look = EngineLook(model_of(name))
    n = run.program.nx + run.program.ns
    meant, found, powers = [], [], []
    for segment in segments_of(run):
        look_at(look, run, segment)
        rate = equations_of(run.program, segment)
        field = (
            rate.motion()
            if isinstance(rate, Combined)
            else run.program.field(rate, segment.interval)  # type: ignore[arg-type]
        )
        at = segment.t[:: max(1, len(segment.t) // 5)]
        rows = np.array(segment.rows(at.tolist()))
        ours = look.powers(Points(at, rows[:, :n], accepted=True))
        theirs = np.array([field(float(a), row)[n:] for a, row in zip(at, rows)])
        powers.append((ours, theirs))
        steps = steps_of(segment, n)
        if steps is not None:
            found.append(look.energies(steps))
            meant.append(np.diff(segment.y[:, n:], axis=0))
    ours, theirs = (np.concatenate(p) for p in zip(*powers))
    assert ours == pytest.approx(theirs, rel=0, abs=1e-9 * np.abs(theirs).max() + 1e-300)
    if found:
        here, there = np.concatenate(found), np.concatenate(meant)
        size = np.abs(there).sum()
        assert np.abs(here[:, :2] - there).sum() <= 1e-8 * size + 1e-300
        assert here[:, 2].sum() <= 1e-8 * size + 1e-300


def steps_of(segment: Segment, n: int) -> Steps | None:
    """Return the steps of a segment of the reference; None where they are no polynomials."""
    if not all(isinstance(p, Polynomial) for p in segment.interpolants):
        return None
    many = len(segment.interpolants)
    dense = np.zeros((many, 4, n))
    time = np.zeros((many, 3))
    state = np.zeros((many, 3, n))
    for k, p in enumerate(segment.interpolants):
        assert isinstance(p, Polynomial)
        if len(p.coefficients) > 4:
            return None
        dense[k, : len(p.coefficients)] = p.coefficients[:, :n]
        time[k] = p.t0, p.t1, segment.t[k + 1]
        state[k] = segment.y[k, :n], p.y1[:n], segment.y[k + 1, :n]
    return Steps(time, state, dense)


BALANCED = (
    *("bouncing_ball_newton", "boost", "stick_slip", "cockcroft_walton", "half_bridge", "weirs"),
    *("evaporator", "relay_feedback", *OWN),
)


@pytest.mark.parametrize("name", BALANCED)
def test_stored_energy_changes_by_what_is_supplied_and_dissipated(name: str) -> None:
    rows, largest = rows_of(name)
    look = EngineLook(model_of(name))
    program = reference(name).program
    off, passed = 0.0, 0.0
    for which in stretches(rows):
        look_at_steps(look, rows, which, largest)
        energies = look.energies(Steps.of(rows, which))
        x = rows.step_state[which][:, [0, 2], : program.nx]
        stored = np.array([[program.storage.energy(one) for one in ends] for ends in x])
        change = stored[:, 1] - stored[:, 0]
        off += np.abs(energies[:, 0] - energies[:, 1] - change).sum()
        passed += np.abs(energies[:, :2]).sum() + np.abs(change).sum()
    assert passed > 0.0
    assert off <= 1e-9 * passed


@pytest.mark.parametrize("name", ["boost", "weirs", "cockcroft_walton", "mmc_arm"])
def test_who_asks_for_little_gets_the_same_bits(name: str) -> None:
    """And so does who asks step by step, or with the states of the same points."""
    rows, largest = rows_of(name)
    look = EngineLook(model_of(name))
    slots = model_of(name).tables.slots.size
    for which in list(stretches(rows))[:6]:
        steps = Steps.of(rows, which)
        look_at_steps(look, rows, which, largest)
        t = np.linspace(steps.time[0, 0], steps.time[-1, 2], 7)
        every = look.values(Within(steps, t), np.arange(slots))
        x = model_of(name).tables.slots.x
        for some in ([0], [slots - 1, 1], list(range(x.start, slots, 3))):
            look_at_steps(look, rows, which, largest)
            assert np.array_equal(look.values(Within(steps, t), some), every[:, some])


def test_what_was_looked_into_before_does_not_matter() -> None:
    rows, largest = rows_of("cockcroft_walton")
    slots = np.arange(model_of("cockcroft_walton").tables.slots.size)
    one = EngineLook(model_of("cockcroft_walton"))
    found = list(stretches(rows))[:12]

    def seen(look: EngineLook, which: slice) -> np.ndarray:
        look_at_steps(look, rows, which, largest)
        steps = Steps.of(rows, which)
        return look.values(Within(steps, steps.time[:, :2].mean(axis=1).clip(max=t_end)), slots)

    t_end = float(rows.step_time[-1, 2])
    forth = [seen(one, w) for w in found]
    back = [seen(one, w) for w in reversed(found)][::-1]
    alone = [seen(EngineLook(model_of("cockcroft_walton")), w) for w in found]
    for a, b, c in zip(forth, back, alone):
        assert np.array_equal(a, b) and np.array_equal(a, c)


def test_shares_and_modes_are_those_of_the_result() -> None:
    """Of a relay: the switch is on for the part of the time that holds the surface."""
    for name in ("relay_feedback", "relays", "tank_overflow_sliding"):
        run = reference(name)
        look = EngineLook(model_of(name))
        sliding = [s for s in run.segments if s.sliding is not None]
        assert sliding
        for segment in sliding[:3]:
            look_at(look, run, segment)
            t = float(segment.t[:2].mean())
            y = segment.at(t)[: run.program.nx + run.program.ns]
            shares, _ = look.parts(Points([t], [y]), [0])
            modes = look.modes()
            for m in run.graph.machines:
                for k, state in enumerate(m.states):
                    meant = run.weight(m.path, state, t)
                    assert shares[0, modes[:, m.index] == k].sum() == pytest.approx(meant, abs=1e-9)


def test_the_same_text_looks_in_python() -> None:
    """The library is printed from modules that run as they stand, with the same result."""
    name = "relays"
    rows, largest = rows_of(name)
    tables = model_of(name).tables
    engine = make_engine(answered(tables))
    there = look.make_look(engine)
    meter = energies.make_meter()
    here = EngineLook(model_of(name))
    slots = list(range(2 * tables.slots.size))
    for which in stretches(rows):
        look_at_steps(here, rows, which, largest)
        place = rows.step_place[which.start]
        surfaces = list(slid_in(rows, which).surfaces)
        assert surfaces in ([], [0], [0, 1])
        slid = len(surfaces), surfaces, 0, 0, []
        told = (place[2:4].tolist(), place[4:].tolist(), *slid, largest)
        assert look.look_into(engine, there, rows.step_time[which.start, 0], *told) == OK
        motion = Steps.of(rows, which)
        points = Within(motion, motion.time[:3, :2].mean(axis=1).clip(max=motion.time[:3, 2]))
        flat = [a.ravel().tolist() for a in (motion.time, motion.state, motion.dense)]
        look.points_within(there, len(points.t), points.t.tolist(), points.step.tolist(), *flat)
        look.ask_for(there, len(slots), slots)
        out = [0.0] * (len(points.t) * len(slots))
        assert look.look_values(engine, there, out) == OK
        assert out == pytest.approx(here.values(points, slots).ravel(), rel=1e-12, abs=1e-14)
        out = [0.0] * (3 * len(points.t))
        ends = motion.time[points.step, 2].tolist()
        assert energies.look_energies(engine, there, meter, ends, out) == OK
        ours = here.energies(motion, points.t, ends)
        assert np.reshape(out, (-1, 3))[:, :2] == pytest.approx(ours[:, :2], rel=1e-9, abs=1e-14)
