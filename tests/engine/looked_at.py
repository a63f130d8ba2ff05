"""Runs that are looked into, and how: those of examples, and of models of our own."""

from __future__ import annotations

import functools
from collections.abc import Iterator
from itertools import pairwise

import numpy as np
import pytest
from engine.by_engine import EngineLook, EngineModel, EngineRun
from engine.laws_put_back import Laws
from example_runs import INTEGRATED, NAMES, RTOL, example
from timed import next_timed

import hybond as hb
from hybond.engine.compiled.rows import Rows
from hybond.engine.outcome.combinations import ALONE, Combination, combinations
from hybond.engine.tables import tables_of
from hybond.model.graph import FlatGraph

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


@functools.cache
def model_of(name: str) -> EngineModel:
    if name in OWN:
        make, options = OWN[name]
        return EngineModel(tables_of(make().flatten(), rtol=RTOL, **options))
    # what is looked at are slopes where steps end; those of fitted polynomials are others
    solver = example(name).experiment.get("solver", "rk45")
    return EngineModel(tables_of(example(name).flatten(), **INTEGRATED, solver=solver))


@functools.cache
def laws_of(name: str) -> Laws:
    tables = model_of(name).tables
    return Laws(tables.graph, tables.slots.index, tables.slots.size)


def stretches(rows: Rows) -> Iterator[slice]:
    """Return the steps between two instants, stretch by stretch."""
    changes = np.flatnonzero((np.diff(rows.step_place, axis=0) != 0).any(axis=1)) + 1
    ends = [0, *changes.tolist(), len(rows.step_time)]
    return (slice(a, b) for a, b in pairwise(ends) if b > a)


def in_intervals(graph: FlatGraph, rows: Rows) -> Iterator[slice]:
    """Return stretches, cut where an input breaks with nothing happening."""
    for which in stretches(rows):
        begins = rows.step_time[which, 0]
        first = 0
        while first < len(begins):
            end = next_timed(graph, float(begins[first]))
            last = max(first + 1, int(np.searchsorted(begins, end)))
            yield slice(which.start + first, which.start + last)
            first = last


def look_at_steps(look: EngineLook, rows: Rows, which: slice, energy: float) -> None:
    place = rows.step_place[which.start]
    machines = (len(place) - 2) // 2
    assert place[1] == (rows.instant_place[place[0] - 1, 2])
    made = slid_in(rows, which)
    look.into(
        rows.step_time[which.start, 0],
        place[2 : 2 + machines],
        landed=place[2 + machines :],
        surfaces=made.surfaces,
        product=made.product,
        modes=made.modes,
        energy=energy,
    )


def slid_in(rows: Rows, which: slice) -> Combination:
    """Return what some steps slid in."""
    place = rows.step_place[which.start]
    made = [ALONE, *(c for _, c in combinations(rows, (len(place) - 2) // 2))]
    return made[place[1]]


@functools.cache
def rows_of(name: str) -> tuple[Rows, float]:
    run = EngineRun(model_of(name))
    (rows,) = run.slices(steps=-1)
    return rows, run._seen.energy
