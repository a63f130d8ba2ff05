"""Values, powers and energies of finished runs by the library: what the model says of them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from engine.by_engine import EngineLook
from engine.laws_put_back import Laws
from engine.looked_at import (
    CASES,
    OWN,
    QUICK,
    in_intervals,
    laws_of,
    look_at_steps,
    model_of,
    rows_of,
    slid_in,
    stretches,
)

from hybond.engine.compiled.points import Points, Steps, Within
from hybond.engine.compiled.rows import Rows
from hybond.engine.compiled.sliced import OK
from hybond.engine.engine import make_engine
from hybond.engine.looking import energies, look
from hybond.engine.method_numbers import RADAU
from hybond.engine.tables import answered

SOME = 12
"""Stretches of a run that are looked into, spread over all."""


def some_of(laws: Laws, rows: Rows) -> Iterator[slice]:
    """Return some stretches of a run."""
    found = list(in_intervals(laws.graph, rows))
    for k in sorted({*(k * len(found) // SOME for k in range(SOME)), len(found) - 1}):
        yield found[k]


def points_of(steps: Steps) -> Within:
    """Return ends of steps and points between."""
    first, last = steps.time[0, 0], steps.time[-1, 2]
    inner = first + np.array([0.1, 0.37, 0.5, 0.93]) * (last - first)
    ends = steps.time[:: max(1, len(steps.time) // 5), 2]
    return Within(steps, np.unique([first, *ends, *inner]))


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", CASES)
def test_values_are_what_all_elements_say(name: str) -> None:
    """Junctions, laws of elements and of storage, in each of the modes that are combined."""
    rows, largest = rows_of(name)
    look, laws = EngineLook(model_of(name)), laws_of(name)
    slots = np.arange(2 * laws.size)
    wrong: dict[str, float] = {}
    size: dict[str, float] = {}
    for which in some_of(laws, rows):
        steps = Steps.of(rows, which)
        look_at_steps(look, rows, which, largest)
        shares, values = look.parts(points_of(steps), slots)
        assert shares.sum(axis=1) == pytest.approx(1.0, abs=1e-9)
        modes = look.modes()
        values[..., laws.size :] = 0.0  # nothing was before while time passes
        switched = laws.switched(modes)
        for part, mode in enumerate(modes):
            for v in values[:, part].tolist():
                for row, (off, terms) in laws.off(v, mode, apart=switched).items():
                    wrong[row] = max(wrong.get(row, 0.0), abs(off))
                    size[row] = max(size.get(row, 0.0), terms)
    kinds = max(size.values())
    for row, off in wrong.items():
        assert off <= 1e-9 * (size[row] + 1e-6 * kinds), row


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", CASES)
def test_what_flows_in_is_stored_and_powers_are_what_elements_take(name: str) -> None:
    """The state moves by what storage takes, and by the rates of integrals; powers add up."""
    rows, largest = rows_of(name)
    look, laws = EngineLook(model_of(name)), laws_of(name)
    slots = np.arange(2 * laws.size)
    # by radau, and where a slip in the plane ends, polynomials have other slopes at their ends
    explicit = model_of(name).tables.numbers["method"] != RADAU and name != "planar_puck"
    moved, meant, found, powers, many = [], [], [], [], 0
    for which in some_of(laws, rows):
        steps = Steps.of(rows, which)
        look_at_steps(look, rows, which, largest)
        span = np.diff(steps.time[:, :2])
        end = np.arange(1, 5) @ steps.dense / span
        whole = steps.time[:, 1] == steps.time[:, 2]
        many += whole.sum()
        ends = Points(steps.time[whole, 2], steps.state[whole, 2], accepted=True)
        shares, values = look.parts(ends, slots)
        for weights, each in zip(shares, values.tolist()):
            meant.append(weights @ np.array([laws.rates(v) for v in each]))
            powers.append(weights @ np.array([laws.powers(v) for v in each]))
        moved += list(end[whole])
        found.append(look.powers(ends))
    ours, theirs = np.concatenate(found), np.array(powers)
    assert ours == pytest.approx(theirs, rel=0, abs=1e-9 * np.abs(theirs).max() + 1e-300)
    if explicit:
        assert many > 0
        off = np.abs(np.array(moved) - meant).max(axis=0)
        assert (off <= 1e-8 * np.abs(meant).max(axis=0) + 1e-12 * np.abs(meant).max()).all()


def test_the_quick_examples_have_what_can_be_looked_into() -> None:
    all_rows = [rows_of(name)[0] for name in (*OWN, *QUICK)]
    assert any(rows.step_place[:, 2:].any() for rows in all_rows)
    slid = [slid_in(rows, w) for rows in all_rows for w in stretches(rows)]
    assert any(len(made.surfaces) > 1 for made in slid)


BALANCED = (
    *("bouncing_ball_newton", "boost", "stick_slip", "cockcroft_walton", "half_bridge", "weirs"),
    *("evaporator", "relay_feedback", *OWN),
)


@pytest.mark.parametrize("name", BALANCED)
def test_stored_energy_changes_by_what_is_supplied_and_dissipated(name: str) -> None:
    rows, largest = rows_of(name)
    look = EngineLook(model_of(name))
    laws = laws_of(name)
    off, passed = 0.0, 0.0
    for which in stretches(rows):
        look_at_steps(look, rows, which, largest)
        energies = look.energies(Steps.of(rows, which))
        x = rows.step_state[which][:, [0, 2], : len(laws.graph.storages)]
        stored = np.array([[laws.energy(one) for one in ends] for ends in x])
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
        return look.values(Within(steps, steps.time[:, ::2].mean(axis=1).clip(max=t_end)), slots)

    t_end = float(rows.step_time[-1, 2])
    forth = [seen(one, w) for w in found]
    back = [seen(one, w) for w in reversed(found)][::-1]
    alone = [seen(EngineLook(model_of("cockcroft_walton")), w) for w in found]
    for a, b, c in zip(forth, back, alone):
        assert np.array_equal(a, b) and np.array_equal(a, c)


@pytest.mark.parametrize("name", ["relay_feedback", "relays", "tank_overflow_sliding"])
def test_shares_hold_the_surface(name: str) -> None:
    """Of relays: each is on for the part of the time in which its function stays zero."""
    rows, largest = rows_of(name)
    look, laws = EngineLook(model_of(name)), laws_of(name)
    tables = model_of(name).tables
    slid = [w for w in stretches(rows) if slid_in(rows, w).surfaces]
    assert slid
    for which in slid[:3]:
        look_at_steps(look, rows, which, largest)
        steps = Steps.of(rows, which)
        points = Within(steps, steps.time[:, :2].mean(axis=1))
        _, values = look.parts(points, np.arange(2 * laws.size))
        for k in slid_in(rows, which).surfaces:
            g = laws.closure(tables.values.all[tables.ints["surface_value"][k]])
            size = np.abs(values[:, 0]).max()
            assert max(abs(g(v)) for v in values[:, 0].tolist()) <= 1e-9 * size


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
