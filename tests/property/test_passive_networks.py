"""What must hold for every passive network of ideal diodes, and every row of masses.

Nothing here is told what the diodes do: conditions of complementarity, energy and its contraction,
momentum, and the order of free flights say what a right run looks like.
"""

from __future__ import annotations

import os
from itertools import pairwise

import numpy as np
import pytest
from engine.laws_put_back import laws_of
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from passive_nets import Row, network, row

import hybond as hb

MORE = bool(os.environ.get("HYBOND_FUZZ"))
END = 2.0


def some(count: int) -> settings:
    """Draw `count` seeds, many more when fuzzing; a smaller seed is no simpler network."""
    return settings(
        max_examples=20 * count if MORE else max(1, count // 2),
        phases=(Phase.explicit, Phase.generate),
        suppress_health_check=list(HealthCheck),
    )


SEEDS = st.integers(0, 10**6)


def steps(model: hb.Model, h: float, theta: float = 1.0) -> hb.Result:
    return hb.simulate(model, END, solver="moreau-jean", step=h, theta=theta)


def ends_of_steps(run: hb.Result, names: list[str]) -> dict[str, np.ndarray]:
    """Values at the ends of steps, the start left out."""
    table = run.table(names)
    t = np.asarray(table["t"])
    last = np.append(np.diff(t) != 0.0, True) & (t > 0.0)
    return {n: np.asarray(table[n])[last] for n in names}


def violation(run: hb.Result) -> float:
    """By how much the conditions of the diodes fail, as a part of the largest of their kind."""
    worst = 0.0
    for m in run.graph.machines:
        if m.law is None:
            continue
        names = [f"{m.path}.f", f"{m.path}.e"]
        if run.solver == "moreau-jean":
            found = ends_of_steps(run, names)
            f, e = (found[n] for n in names)
        else:
            f, e = (
                np.concatenate([y for _, y in run.pieces(n, points_per_segment=4)]) for n in names
            )
        f, e = f / max(1.0, np.abs(f).max()), e / max(1.0, np.abs(e).max())
        worst = max(worst, float(-f.min()), float(e.max()), float(np.abs(f * e).max()))
    return worst


def energies(run: hb.Result) -> np.ndarray:
    """What is stored, at every point and on both sides of every jump."""
    storage, nx = laws_of(run.graph), len(run.graph.storages)
    first = run.trace.events[:1]
    points = [e.before for e in first] + [y for s in run.segments for y in s.y]
    return np.array([storage.energy(y[:nx]) for y in points])


def growth(stored: np.ndarray) -> float:
    """The largest growth of an energy from one point to the next, as a part of its first value."""
    return float(np.diff(stored).max(initial=0.0)) / max(float(stored.max(initial=0.0)), 1e-12)


@pytest.mark.slow
@given(seed=SEEDS, sources=st.booleans())
@some(24)
def test_located_events_keep_every_condition(seed: int, sources: bool) -> None:
    run = hb.simulate(network(seed, sources=sources), END, rtol=1e-9)
    assert run.status == "ok"
    assert violation(run) < 1e-8
    if not sources:
        assert growth(energies(run)) < 1e-8
    for event in run.events:
        for step in event.steps:
            if step.energy is not None and step.kind != "mythical":
                assert step.energy.lost >= -1e-10 * max(1.0, step.energy.before)


@pytest.mark.slow
@given(seed=SEEDS, sources=st.booleans(), h=st.sampled_from((0.3, 0.03, 0.003)))
@some(20)
def test_steps_keep_every_condition_at_their_ends(seed: int, sources: bool, h: float) -> None:
    run = steps(network(seed, sources=sources), h)
    assert run.status == "ok"
    assert violation(run) < 1e-8
    if not sources:
        assert growth(energies(run)) < 1e-9


@pytest.mark.slow
@given(seed=SEEDS, sources=st.booleans())
@some(14)
def test_two_starts_never_part(seed: int, sources: bool) -> None:
    """The energy of the difference of two solutions never grows: diodes are monotone.

    It holds for networks with sources as well, through switching and through jumps, whichever the
    diodes that conduct in one of the two. (Brezis 1973; Camlibel & Schumacher 2016.)
    """
    runs = [
        hb.simulate(network(seed, sources=sources, starts=k), END, rtol=1e-10) for k in range(2)
    ]
    storage = laws_of(runs[0].graph)
    names = [s.path for s in runs[0].graph.storages]
    if not names:
        return
    times = np.linspace(0.0, END, 41)
    x = [np.array([run.sample(times, names)[n] for n in names]).T for run in runs]
    start = runs[0].trace.events[0].before - runs[1].trace.events[0].before
    apart = [storage.energy(start[: len(names)])] + [storage.energy(d) for d in x[0] - x[1]]
    assert growth(np.array(apart)) < 1e-7


@pytest.mark.slow
@given(seed=SEEDS, sources=st.booleans())
@some(12)
def test_engines_agree_as_the_step_is_halved(seed: int, sources: bool) -> None:
    found = hb.cross_check(network(seed, sources=sources), END, step=0.02, tolerance=0.02)
    assert found.verdict == "agree", str(found)
    assert not {"several solutions", "simultaneous impacts"} & {r.name for r in found.reasons}


@pytest.mark.parametrize(
    ("seed", "sources"), [(119, False), (14, True), (98, False), (115, True), (125, True)]
)
def test_laws_of_a_passive_circuit_have_one_answer_in_long_steps(seed: int, sources: bool) -> None:
    """With ``theta = 1/2`` they had three, or none at all, where something relaxed in a step."""
    model = network(seed, sources=sources)
    run = steps(model, 0.2, 0.5)
    assert not any("answers" in said for said in run.warnings)
    assert violation(run) < 1e-9
    names = [s.path for s in run.graph.storages]
    right = hb.simulate(model, END)
    times = np.linspace(0.0, END, 11)

    def off(found: hb.Result) -> float:
        x, y = ([r.sample(times, names)[n] for n in names] for r in (found, right))
        return max(np.abs(a - b).mean() for a, b in zip(x, y, strict=True))

    assert off(run) < 1.1 * off(steps(model, 0.2, 1.0)) < 0.5


def no_two_at_once(run: hb.Result, apart: float) -> bool:
    times = np.array([e.t for e in run.events])
    return bool((np.diff(times) > apart).all()) and not run.accumulations


@pytest.mark.slow
@given(seed=SEEDS)
@some(15)
def test_equal_elastic_masses_pass_their_flights_on(seed: int) -> None:
    """Equal masses exchange velocities: the places are those of free flights, put in order."""
    r = row(seed, equal=True)
    t = np.linspace(0.0, END, 81)[:-1] + 0.01
    flights = np.array([x + v * t for x, v in zip(r.place, r.speed, strict=True)])
    names = [f"x{k}" for k in range(len(r.mass))]
    located = hb.simulate(r.model(), END)
    exact = np.sort(flights, axis=0)
    found = located.sample(t, names)
    for k, name in enumerate(names):
        np.testing.assert_allclose(found[name], exact[k], rtol=0, atol=1e-9)
    if not no_two_at_once(located, 0.05):
        return
    h = 0.002
    stepped = hb.simulate(r.model(), END, solver="moreau-jean", step=h).sample(t, names)
    fastest = np.ptp(r.speed)
    for k, name in enumerate(names):
        # each impact is off by at most two steps of the relative motion
        bound = 2.0 * h * fastest * (len(located.events) + 1)
        assert np.abs(stepped[name] - exact[k]).max() < bound


def momentum(r: Row, run: hb.Result) -> np.ndarray:
    names = [f"m{k}.p" for k in range(len(r.mass))]
    return np.array([run.sample(np.linspace(0, END, 21), names)[n] for n in names]).sum(axis=0)


@pytest.mark.slow
@given(seed=SEEDS)
@some(10)
def test_free_masses_keep_their_momentum_and_never_pass(seed: int) -> None:
    r = row(seed)
    total = float(np.dot(r.mass, r.speed))
    for run in (
        hb.simulate(r.model(), END),
        hb.simulate(r.model(), END, solver="moreau-jean", step=0.01),
    ):
        np.testing.assert_allclose(momentum(r, run), total, rtol=0, atol=1e-10)
        assert growth(energies(run)) < 1e-10
    located = hb.simulate(r.model(), END)
    for k in range(len(r.mass) - 1):
        gap = np.concatenate([y for _, y in located.pieces(f"x{k + 1} - x{k}")])
        assert gap.min() > -1e-9


@pytest.mark.slow
@given(seed=SEEDS)
@some(6)
def test_rows_with_springs_agree_in_both_engines(seed: int) -> None:
    r = row(seed, springs=True)
    found = hb.cross_check(r.model(), 1.2, step=0.004, tolerance=0.03)
    if found.verdict != "agree":
        # only impacts that come together, or faster than the step, may part them
        assert found.verdict == "differ legitimately", str(found)
        assert {x.name for x in found.reasons} <= {
            "simultaneous impacts",
            "events closer than the step",
        }


@pytest.mark.parametrize("way", range(4))
def test_a_network_turned_round_is_the_same(way: int) -> None:
    """Every bond of a rectifier the other way, with the same physical diode."""
    m = hb.Model("turned", domain="electrical")
    m.add(u=hb.Se("5*sin(3*time)"), d=hb.One(law="diode"), n=hb.Zero(), r=hb.R(2.0))
    m.add(c=hb.C(0.5, e=-1.0 if way & 2 else 1.0))
    m.bond("u -> d -> n", *(("n -> c", "r -> n") if way & 1 else ("c -> n", "n -> r")))
    run = hb.simulate(m, END, rtol=1e-10)
    t = np.linspace(0.01, END, 50)
    # charged to the source while it is the higher, else discharged with the time constant 1 s
    v, exact = (-1.0 if way & 2 else 1.0), []
    fine = np.linspace(0.0, END, 40001)
    for a, b in pairwise(fine):
        v = max(v * np.exp(-(b - a)), 5 * np.sin(3 * b))
        exact.append(v)
    assert run.sample(t, ["c.e"])["c.e"] == pytest.approx(np.interp(t, fine[1:], exact), abs=1e-3)
