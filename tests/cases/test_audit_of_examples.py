"""What must hold in every run, checked on every example through the names of its signals."""

import dataclasses
import functools
import itertools
import json

import numpy as np
import pytest
from example_runs import NAMES, RTOL, STOPPED, example, run_of

import hybond as hb

REPEATED = [
    "buck",
    "capacitors_joined",
    "clutch",
    "elevator_actuators",
    "newtons_cradle",
    "woodpecker",
]
"""Examples that are run twice."""
CREATES = ("impacting_stick",)
"""Examples whose law of impacts creates energy, as it is known for: the run warns."""
every_example = pytest.mark.parametrize("name", NAMES)


def one_ports(run: hb.Result):
    """Yield ``(name of the effort, name of the flow, sign of power inward)``."""
    for node in run.graph.nodes:
        if node.kind in ("C", "I", "R", "G", "Se", "Sf"):
            for end in node.ends:
                port = f".{end.port + 1}" if len(node.ends) > 1 else ""
                yield f"{node.path}{port}.e", f"{node.path}{port}.f", end.sign


def stored_energy(run: hb.Result, values) -> np.ndarray:
    """Stored energy of linear storages."""
    total = 0.0
    for s in run.graph.storages:
        co_energy = s.path[:-1] + ("e" if s.kind == "C" else "f")
        # the flow of a bond points along its arrow
        sign = s.sign if s.kind == "I" else 1
        total = total + 0.5 * sign * values[s.path] * values[co_energy]
    return total


@functools.cache
def pieces_of(run: hb.Result, name: str):
    return run.pieces(name, points_per_segment=0)


def at_points(run: hb.Result, k: int, names):
    """Values of `names` at the accepted points of segment `k`."""
    found = {n: pieces_of(run, n)[k][1] for n in names}
    assert all(len(v) == len(run.segments[k].t) for v in found.values())
    return found


@functools.cache
def energies_of(run: hb.Result) -> list[tuple[np.ndarray, np.ndarray]]:
    """What is stored, and what was supplied and dissipated, of each segment."""
    names = storage_names(run)
    return [
        (stored_energy(run, at_points(run, k, names)), run.energies(segment))
        for k, segment in enumerate(run.segments)
    ]


def largest_energy(run: hb.Result) -> float:
    """The largest energy that was stored, supplied or dissipated."""
    return max(max(np.abs(s).max(), np.abs(e).max()) for s, e in energies_of(run))


def storage_names(run: hb.Result) -> list[str]:
    names = [s.path for s in run.graph.storages]
    return names + [s.path[:-1] + ("e" if s.kind == "C" else "f") for s in run.graph.storages]


@every_example
def test_ends_as_expected(name):
    run = run_of(name)
    if name in STOPPED:
        assert run.status == "error"
        assert isinstance(run.error, hb.DivergenceOfTime)
    else:
        assert run.status == "ok", run.error
        assert run.t_end == run.until
    if name in CREATES:
        assert run.audit().created > 0.0
        assert any("creates" in w for w in run.warnings)
    else:
        assert run.audit().holds(1e-10)


@every_example
def test_power_balances(name):
    run = run_of(name)
    ports = list(one_ports(run))
    t = np.linspace(0.0, run.t_end, 50).tolist()
    values = run.sample(t, [n for e, f, _ in ports for n in (e, f)])
    power = np.array([sign * values[e] * values[f] for e, f, sign in ports])
    assert np.abs(power.sum(axis=0)).max() <= 1e-12 * max(np.abs(power).max(), 1e-300)
    size = np.abs(power).sum(axis=0)
    assert (np.abs(power.sum(axis=0)) <= 1e-12 * np.maximum(size, 1e-9 * size.max())).all()


@pytest.mark.sampled(3)
@every_example
def test_energy_balances_over_each_segment(name):
    run = run_of(name)
    scale = largest_energy(run)
    for stored, energies in energies_of(run):
        supplied, dissipated = energies.T
        balance = stored + dissipated - supplied
        assert np.ptp(balance) <= 1e-9 * scale
        assert (np.diff(dissipated) >= -1e-12 * scale).all()


@pytest.mark.sampled(19)
@every_example
def test_energy_balances_over_each_jump(name):
    run = run_of(name)
    scale = max(largest_energy(run), 1e-300)
    nx = len(run.graph.storages)
    laws = any(m.law is not None for m in run.graph.machines)
    largest = np.max([np.abs(s.y[:, :nx]).max(axis=0) for s in run.segments], axis=0)
    for event in run.events:
        writes = [s for s in event.steps if s.kind != "mythical" and s.energy is not None]
        for step in writes:
            e = step.energy
            assert e.after == pytest.approx(e.before + e.source - e.lost, abs=1e-12 * scale)
            assert e.lost >= -1e-12 * scale or name in CREATES
        for one, two in itertools.pairwise(writes):
            assert two.energy.before == pytest.approx(one.energy.after, abs=1e-12 * scale)
        if event.t0 is None and not any(s.impulses for s in writes):
            # what is left of a velocity at rest is rounding, and is swept up without an impulse
            # (1e-11 of what the energy of the run would make of it); a landing ends a velocity that
            # is no more than 1e-7 of the largest one
            dust = 1e-12 * np.maximum(np.abs(event.before[:nx]).max(), largest)
            if laws:
                dust = (1e-7 if event.cause == "accumulation" else 1e-10) * largest
            assert (np.abs(event.after[:nx] - event.before[:nx]) <= dust).all()


@every_example
def test_events_are_in_order(name):
    run = run_of(name)
    assert [s.t[0] for s in run.segments] == sorted(s.t[0] for s in run.segments)
    times = [e.t for e in run.events]
    assert times == sorted(times)
    landings = {e.t for e in run.events if e.cause == "accumulation"}
    for event in run.events:
        kinds = [s.kind for s in event.steps]
        assert kinds[-1] == "continuous"
        assert "continuous" not in kinds[:-1]
        # who enters a mode says by which guard; only a start, or an input, needs none
        for before, step in zip(event.steps, event.steps[1:], strict=False):
            assert step.fired
            assert before.mode != step.mode
        if event.cause == "guard":
            assert event.steps[0].fired
    for one, two in zip(run.segments, run.segments[1:], strict=False):
        # impacts that accumulate are left out between the last one that was made and their limit
        assert one.t[-1] == two.t[0] or two.t[0] in landings
        assert (np.diff(one.t) > 0.0).all()


@pytest.mark.sampled(3)
@every_example
def test_no_value_is_missing(name):
    run = run_of(name)
    for segment in run.segments:
        assert np.isfinite(segment.t).all()
        assert np.isfinite(segment.y).all()
    for signal in run.names:
        assert np.isfinite(run[signal].y).all(), signal
    assert all(np.isfinite(v) for v in run.final.values())


@every_example
def test_events_can_be_written_as_json(name):
    run = run_of(name)
    for event in run.events:
        text = json.dumps(dataclasses.asdict(event), default=lambda a: a.tolist(), allow_nan=False)
        assert json.loads(text)["t"] == event.t


@every_example
def test_the_state_before_and_after_is_that_of_the_segments(name):
    run = run_of(name)
    starts = {float(s.t[0]): s for s in run.segments}
    ends = {float(s.t[-1]): s for s in run.segments}
    n = len(run.graph.storages) + len(run.graph.integrals)
    for event in run.events:
        if event.t in starts:
            assert np.array_equal(starts[event.t].y[0, :n], event.after)
            assert starts[event.t].mode == event.steps[-1].mode
        if event.t in ends and event.t > 0.0:
            assert np.array_equal(ends[event.t].y[-1, :n], event.before)


@pytest.mark.parametrize("name", REPEATED)
def test_a_run_can_be_repeated(name):
    one = run_of(name)
    two = hb.simulate(example(name), rtol=RTOL, on_error="return")
    assert [e.t for e in one.events] == [e.t for e in two.events]
    assert np.array_equal(one.segments[-1].y, two.segments[-1].y)
