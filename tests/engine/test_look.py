"""Values, powers and energies of finished runs by the library: those of `Result`, and balances."""

from __future__ import annotations

import functools
from collections.abc import Iterator
from itertools import pairwise

import numpy as np
import pytest
from example_runs import NAMES, RTOL, example, integrated

import hybond as hb
from hybond.engine.native import NativeModel, NativeRun, Rows
from hybond.engine.native_look import NativeLook
from hybond.engine.points import Points, Steps, Within
from hybond.export.tables import tables_of
from hybond.modes.sliding.view import equations_of
from hybond.programs.combined import Combined
from hybond.solvers.dense import Polynomial
from hybond.trace import Segment

QUICK = (
    *("relay_feedback", "sliding_clutch", "tank_overflow_sliding"),
    *("capacitors_joined", "stick_slip", "cockcroft_walton", "weirs", "falling_rod"),
    *("half_bridge", "planar_puck", "mmc_arm", "evaporator"),
)
"""Sliding, constraints, hidden ones, friction, diodes, laws that bend, tables in time."""


def balls() -> hb.Model:
    """Return two balls over a floor, one of which a growing pull takes off again."""
    m = hb.Model("balls", domain="translational")
    for k, (eps, height) in enumerate([(0.3, 0.6), (0.5, 0.4)], 1):
        parts = {"w": hb.Se(f"-9.81*{k}"), "b": hb.I(k), "v": hb.One(), "c": hb.Zero()}
        parts |= {"r": hb.Sf(f"-{eps}*pre(v{k}.f)"), "d": hb.R(0.1)}
        m.add(**{f"{name}{k}": part for name, part in parts.items()})
        m.bond(f"w{k} -> v{k} -> b{k}", f"c{k} -> v{k} -> d{k}", f"r{k} -> c{k}")
        m.signal(**{f"h{k}": hb.Integral(f"v{k}.f", start=height)})
        rules = [
            f"away -> impact when h{k} <= 0 and v{k}.f < 0",
            f"impact -> away when pre(b{k}.p) >= 0",
        ]
        m.machine(f"F{k}", states={"away": [], "impact": [f"c{k}"]}, start="away", rules=rules)
    m.add(pull=hb.Se("5*time*1 [N/s]"))
    m.bond("pull -> v1")
    return m


def relays() -> hb.Model:
    """Return two capacitors that relays hold at zero; the second is met while the first slides."""
    m = hb.Model("relays", domain="electrical")
    for k, (flow, start) in enumerate([("-2*r1 + 0.5 - 0.3*r2", -0.5), ("-1.5*r2 + r1/5", 2)], 1):
        for j in (1, 2):
            flow = flow.replace(f"r{j}", f'(if R{j}.state == "above" then 1 else -1)')
        m.add(**{f"c{k}": hb.C(1, e=start), f"z{k}": hb.Zero(), f"d{k}": hb.R(3)})
        m.add(
            **{f"s{k}": hb.Sf(f"({flow})*1 [A]"), f"q{k}": hb.Sf(f"sin({k}*time*1 [1/s])*1 [A]/2")}
        )
        m.bond(f"s{k} -> z{k} -> c{k}", f"q{k} -> z{k} -> d{k}")
        rules = [f"below -> above when c{k}.q > 0", f"above -> below when c{k}.q < 0"]
        start_state = "above" if start > 0 else "below"
        states: dict[str, list[str]] = {"below": [], "above": []}
        m.machine(f"R{k}", states=states, start=start_state, rules=rules)
    return m


OWN = {
    "balls": (balls, {"until": 3.0}),
    "relays": (relays, {"until": 4.0}),
    "stick_slip by radau": (lambda: example("stick_slip"), {"solver": "radau"}),
    "relays by radau": (relays, {"until": 4.0, "solver": "radau"}),
}
CASES = [*OWN, *(n if n in QUICK else pytest.param(n, marks=pytest.mark.slow) for n in NAMES)]
ENDS = 40
"""Segments of a run that are looked into, spread over all."""


@functools.cache
def model_of(name: str) -> NativeModel:
    if name in OWN:
        make, options = OWN[name]
        return NativeModel(tables_of(make().flatten(), rtol=RTOL, **options))
    return NativeModel(tables_of(example(name).flatten(), **integrated(name)))


@functools.cache
def reference(name: str) -> hb.Result:
    if name in OWN:
        make, options = OWN[name]
        return hb.simulate(make(), rtol=RTOL, engine="reference", **options)  # type: ignore[arg-type]
    options = integrated(name)
    return hb.simulate(example(name), engine="reference", on_error="return", **options)


def look_at(look: NativeLook, run: hb.Result, segment: Segment) -> None:
    """Look into a segment of a run of the reference."""
    ints = look.model.tables.ints
    surfaces = []
    equations = equations_of(run.program, segment)
    for s in equations.surfaces if isinstance(equations, Combined) else ():
        sides = zip(ints["surface_machine"], ints["surface_below"], ints["surface_above"])
        surfaces.append(list(sides).index((s.machine, s.below, s.above)))
    landed = [m.path in segment.landed for m in run.graph.machines]
    energy = run.trace.energy
    look.into(segment.t[0], segment.mode, landed=landed, surfaces=surfaces, energy=energy)


def segments_of(run: hb.Result) -> Iterator[Segment]:
    many = len(run.segments)
    for k in sorted({*(k * many // ENDS for k in range(ENDS)), many - 1}):
        if run.segments[k].t[-1] > run.segments[k].t[0]:
            yield run.segments[k]


def read(
    look: NativeLook, run: hb.Result, segment: Segment, t: np.ndarray, names: list[str]
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
    look = NativeLook(model_of(name))
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
    look = NativeLook(model_of(name))
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


# -- runs of the library itself


def stretches(rows: Rows) -> Iterator[slice]:
    """Return the steps between two instants, stretch by stretch."""
    changes = np.flatnonzero((np.diff(rows.step_place, axis=0) != 0).any(axis=1)) + 1
    ends = [0, *changes.tolist(), len(rows.step_time)]
    return (slice(a, b) for a, b in pairwise(ends) if b > a)


def look_at_steps(look: NativeLook, rows: Rows, which: slice, energy: float) -> None:
    place = rows.step_place[which.start]
    machines = (len(place) - 2) // 2
    look.into(
        rows.step_time[which.start, 0],
        place[2 : 2 + machines],
        landed=place[2 + machines :],
        energy=energy,
    )


@functools.cache
def rows_of(name: str) -> tuple[Rows, float]:
    run = NativeRun(model_of(name))
    (rows,) = run.slices(steps=-1)
    return rows, run._seen.energy


BALANCED = ("bouncing_ball_newton", "boost", "stick_slip", "cockcroft_walton", "half_bridge")


@pytest.mark.parametrize("name", BALANCED)
def test_stored_energy_changes_by_what_is_supplied_and_dissipated(name: str) -> None:
    rows, largest = rows_of(name)
    look = NativeLook(model_of(name))
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
    look = NativeLook(model_of(name))
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
    one = NativeLook(model_of("cockcroft_walton"))
    found = list(stretches(rows))[:12]

    def seen(look: NativeLook, which: slice) -> np.ndarray:
        look_at_steps(look, rows, which, largest)
        steps = Steps.of(rows, which)
        return look.values(Within(steps, steps.time[:, :2].mean(axis=1).clip(max=t_end)), slots)

    t_end = float(rows.step_time[-1, 2])
    forth = [seen(one, w) for w in found]
    back = [seen(one, w) for w in reversed(found)][::-1]
    alone = [seen(NativeLook(model_of("cockcroft_walton")), w) for w in found]
    for a, b, c in zip(forth, back, alone):
        assert np.array_equal(a, b) and np.array_equal(a, c)


def test_shares_and_modes_are_those_of_the_result() -> None:
    """Of a relay: the switch is on for the part of the time that holds the surface."""
    for name in ("relay_feedback", "relays", "tank_overflow_sliding"):
        run = reference(name)
        look = NativeLook(model_of(name))
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


# -- closed forms


def source_into(law: str) -> hb.Model:
    """Return a model of a flow of ``kink - time`` through a resistor."""
    m = hb.Model("kink", domain="electrical", parameters={"kink": "0.5 s"})
    m.add(
        s=hb.Sf("(kink - time)*1 [A/s]"),
        i=hb.One(),
        r=hb.R({"e": law}),
        c=hb.C(1),
        z=hb.Zero(),
        d=hb.R(1),
    )
    m.bond("s -> i -> r", "c -> z -> d")
    return m


STEP = Steps([[0.0, 1.0, 1.0]], np.zeros((1, 3, 1)), np.zeros((1, 4, 1)))


@pytest.mark.parametrize("kink", [0.5, 1.0 / 3.0, 0.3, 0.013, 0.9, 0.0, 1.0, 1.0 - 1e-12])
def test_a_kink_of_a_law_does_not_fool_energies(kink: float) -> None:
    """A resistor that takes force one way only: the energy is the integral of (kink - t)^2."""
    graph = source_into("max(f, 0 [A])*1 [ohm]").flatten(parameters={"kink": kink})
    look = NativeLook(NativeModel(tables_of(graph, until=1.0)))
    look.into(0.0, [])
    ((supplied, dissipated, wrong),) = look.energies(STEP)
    assert dissipated == pytest.approx(kink**3 / 3.0, rel=1e-9, abs=1e-12)
    assert supplied == pytest.approx(dissipated, rel=1e-12)
    assert wrong <= 1e-9 * kink**3 + 1e-12


@pytest.mark.parametrize("kink", [0.5, 1.0 / 3.0, 0.013, 0.9])
def test_nor_does_a_jump(kink: float) -> None:
    """A resistor that turns into its opposite: the energy is the integral of (kink - t)^2."""
    graph = source_into("sign(f + 0.25 [A])*f*1 [ohm]").flatten(parameters={"kink": kink})
    look = NativeLook(NativeModel(tables_of(graph, until=1.0)))
    look.into(0.0, [])
    ((_, dissipated, wrong),) = look.energies(STEP)
    there = min(kink + 0.25, 1.0)
    meant = (kink**3 - 2.0 * (kink - there) ** 3 + (kink - 1.0) ** 3) / 3.0
    assert dissipated == pytest.approx(meant, abs=1e-9)
    assert wrong <= 1e-9


def test_a_law_that_has_many_kinks_ends_with_what_it_may_be_wrong_by() -> None:
    graph = source_into("f*abs(sin(4000 [1/A]*f))*1 [ohm]").flatten()
    look = NativeLook(NativeModel(tables_of(graph, until=1.0)))
    look.into(0.0, [])
    ((_, dissipated, wrong),) = look.energies(STEP)
    # the mean of abs(sin) is 2/pi; the integral of f^2 is 1/12
    assert dissipated == pytest.approx(2.0 / np.pi / 12.0, rel=0.05)
    assert wrong > 1e-6


def test_energies_of_a_capacitor_that_empties() -> None:
    """From 2 V by 1 ohm: dissipated is 2 (1 - exp(-2 t)) J, in all and in parts of steps."""
    m = hb.Model("rc", domain="electrical")
    m.add(c=hb.C("1 F", e="2 V"), r=hb.R("1 ohm"), node=hb.Zero())
    m.bond("node -> c", "node -> r")
    model = NativeModel(tables_of(m.flatten(), until="1 s", rtol=1e-11, atol=1e-14))
    (rows,) = NativeRun(model).slices(steps=-1)
    look = NativeLook(model)
    look.into(0.0, [], energy=2.0)
    steps = Steps.of(rows)
    whole = look.energies(steps)
    assert whole[:, 1].sum() == pytest.approx(2.0 * (1.0 - np.exp(-2.0)), rel=1e-10)
    assert not whole[:, 0].any()
    a, b = steps.time[:, 0], steps.time[:, 2]
    middle = 0.5 * (a + b)
    half = look.energies(steps, middle, b)
    assert half[:, 1] == pytest.approx(2.0 * (np.exp(-2.0 * middle) - np.exp(-2.0 * b)), rel=1e-8)
    assert not look.energies(steps, b, b).any()


# -- what is refused


def test_what_is_out_of_range_is_refused() -> None:
    model = model_of("relay_feedback")
    look = NativeLook(model)
    n = model.record.storages + model.record.integrals
    machines, slots = model.record.machines, model.record.slots
    point = Points([0.0], np.zeros((1, n)))
    with pytest.raises(ValueError, match="nothing is looked into"):
        look.values(point, [0])
    start = model.tables.ints["start"]
    for t in (-1.0, np.nan, np.inf, 1e9):
        with pytest.raises(ValueError, match="run from 0"):
            look.into(t, start)
    for state in ([-1] * machines, [99] * machines, [0] * (machines + 1), [0.5] * machines):
        with pytest.raises(ValueError, match="state"):
            look.into(0.0, state)
    with pytest.raises(ValueError, match="landed"):
        look.into(0.0, start, landed=True)
    for surfaces in ([-1], [model.record.surfaces], [0, 0], [2**40], [[0]]):
        with pytest.raises(ValueError, match="surface"):
            look.into(0.0, start, surfaces=surfaces)
    for energy in (-1.0, np.nan, np.inf):
        with pytest.raises(ValueError, match="energy"):
            look.into(0.0, start, energy=energy)
    look.into(0.0, start)
    for slot in ([-1], [2 * slots], [2**31], [0.5], [[0]]):
        with pytest.raises(ValueError, match="slots"):
            look.values(point, slot)
        with pytest.raises(ValueError, match="slots"):
            look.parts(point, slot)
    other = Points([0.0], np.zeros((1, n + 1)))
    for ask in (look.powers, lambda p: look.values(p, [0])):
        with pytest.raises(ValueError, match="states"):
            ask(other)


def test_points_and_steps_that_are_none_are_refused() -> None:
    time, state, dense = [[0.0, 1.0, 0.9]], np.zeros((1, 3, 2)), np.zeros((1, 4, 2))
    steps = Steps(time, state, dense)
    for wrong in ([[0.0, 1.0]], [[0.0, 1.0, 1.1]], [[1.0, 1.0, 1.0]], [[0.0, np.nan, 1.0]]):
        with pytest.raises(ValueError):
            Steps(wrong, state, dense)
    for y, d in ((state[:, :2], dense), (state, dense[:, :3]), (state, dense[:, :, :1])):
        with pytest.raises(ValueError, match="belong"):
            Steps(time, y, d)
    for t in ([-0.1], [0.95], [np.nan], 0.5):
        with pytest.raises(ValueError):
            Within(steps, t)
    for step in ([1], [-1], [0, 0], [0.0], [2**32]):
        with pytest.raises(ValueError, match="step"):
            Within(steps, [0.5], step)
    for t, y in (([0.0], np.zeros(2)), ([0.0, 1.0], np.zeros((1, 2))), ([0.0], [[np.inf]])):
        with pytest.raises(ValueError):
            Points(t, y)
    with pytest.raises(ValueError, match="broadcast"):
        Points([0.0], [[0.0]], accepted=[True, False])


def test_a_law_without_a_value_is_named() -> None:
    m = hb.Model("root", domain="electrical")
    m.add(l=hb.I(1, f=1), i=hb.One(), r=hb.R({"e": "sqrt(f/1 [A])*1 [V]"}))
    m.bond("i -> l", "i -> r")
    look = NativeLook(NativeModel(tables_of(m.flatten(), until=1.0)))
    look.into(0.0, [])
    assert look.powers(Points([0.0], [[4.0]])).tolist() == [[0.0, 8.0]]
    with pytest.raises(hb.NumericsError) as caught:
        look.powers(Points([0.0, 0.25], [[4.0], [-1.0]]))
    assert (caught.value.code, caught.value.where) == ("HB-N302", "r")
    assert "0.25" in caught.value.why
    # and looking goes on
    assert look.powers(Points([0.0], [[4.0]])).tolist() == [[0.0, 8.0]]
