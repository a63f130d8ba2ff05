"""Rows of tanks that run out through holes half way up come to rest there, all at once.

A state one last place above the hole has a flow of 1e-9, and one below it no root: the oracle is
what is stored, which is what was above the level and has flown out, and nothing else.
"""

from __future__ import annotations

import random

import pytest

import hybond as hb

HOLES = (
    "{k}*sqrt(e - {h})",
    "{k}*(e - {h})^0.5",
    "{k}*sqrt(2*(e - {h})/2)",
    "if e > {h} then {k}*sqrt(e - {h}) else 0",
)
PIPES = (
    "{k}*sign(e)*sqrt(abs(e))",
    "if e > 0 then {k}*sqrt(e) else -{k}*sqrt(-e)",
    "{k}*e",
)


def row(seed: int, hole: str, level: float, pipes: tuple[str, ...]) -> tuple[hb.Model, float]:
    """Return a row of two to four tanks, a hole in the last one, and what will have flown out."""
    chance = random.Random(seed)
    n = chance.randint(2, 4)
    m = hb.Model("row")
    above = 0.0
    bonds = []
    for i in range(n):
        area, e = 10.0 ** chance.uniform(-1.0, 0.5), level + chance.uniform(0.1, 3.0)
        above += area * (e - level)
        m.add(**{f"t{i}": hb.C(area, e=e), f"n{i}": hb.Zero()})
        bonds.append(f"n{i} -> t{i}")
        if i > 0:
            law = chance.choice(pipes).format(k=chance.uniform(0.1, 0.5))
            m.add(**{f"s{i}": hb.One(), f"p{i}": hb.R({"f": law})})
            turned = chance.random() < 0.5
            bonds.append(f"n{i} -> s{i} -> n{i - 1}" if turned else f"n{i - 1} -> s{i} -> n{i}")
            bonds.append(f"s{i} -> p{i}")
    m.add(hole=hb.R({"f": hole.format(k=chance.uniform(0.1, 0.3), h=level)}))
    m.signal(out=hb.Integral("hole.f"))
    m.bond(*bonds, f"n{n - 1} -> hole")
    return m, above


@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.parametrize("level", [0.25, 0.1, 1.7])
@pytest.mark.parametrize("hole", HOLES)
@pytest.mark.parametrize("seed", range(5))
@pytest.mark.sampled(3)
def test_what_was_above_the_hole_flows_out(seed: int, hole: str, level: float, solver: str) -> None:
    m, above = row(seed, hole, level, PIPES[:2])
    run = hb.simulate(m, "400 s", solver=solver)
    assert run.status == "ok"
    assert run["out"].at(400.0) == pytest.approx(above, rel=1e-7)
    for name in run.names:
        if name.endswith(".e") and name.startswith("t"):
            assert run[name].at(400.0) == pytest.approx(level, abs=1e-7)
    assert run.stats["steps"] < 3000


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.parametrize("hole", [*HOLES, "{k}*sqrt(e)"])
@pytest.mark.parametrize("seed", range(100, 104))
def test_what_runs_down_through_straight_pipes_does_so_for_ever(
    seed: int, hole: str, solver: str
) -> None:
    """It becomes ever less, exponentially, and what is under the root that of its square."""
    level = 0.0 if hole == "{k}*sqrt(e)" else 0.25
    m, above = row(seed, hole, level, PIPES)
    run = hb.simulate(m, "100 s", solver=solver)
    assert run.status == "ok"
    stored = sum(run[name].at(100.0) for name in run.names if name.endswith(".q"))
    first = sum(run[name].at(0.0) for name in run.names if name.endswith(".q"))
    assert first - stored == pytest.approx(run["out"].at(100.0), rel=1e-7)
    assert run["out"].at(100.0) < above * (1.0 + 1e-7)


def test_a_guard_reads_a_root_at_rest() -> None:
    """At an instant, too, a root of what is below nothing by rounding is nothing."""
    for seed in range(8):
        m, _ = row(seed, HOLES[0], 0.25, PIPES[:2])
        m.add(late=hb.Se(1.0), r=hb.R(2.0), sw=hb.One())
        m.bond("late -> sw -> r")
        m.machine(
            "late_on",
            states={"on": ["sw"], "off": []},
            start="off",
            rules=["off -> on when time > 300 and sqrt(hole.e - 0.25) < 1e-3"],
        )
        run = hb.simulate(m, "310 s")
        assert run["r.f"].at(305.0) == pytest.approx(0.5)


@pytest.mark.parametrize("bound", ["min({}, 1e15)", "if e < 1e3 then {} else 1e15"])
def test_a_bound_far_away_hides_no_root_of_what_is_below(bound: str) -> None:
    """It is no term of what it bounds: a level below the hole is refused, as without it."""
    m = hb.Model("hole")
    m.add(n=hb.Zero(), t=hb.C(1.0, e=0.2), hole=hb.R({"f": f"sqrt({bound.format('e - 0.25')})"}))
    m.bond("n -> t", "n -> hole")
    with pytest.raises(hb.NumericsError) as refused:
        hb.simulate(m, 1)
    assert refused.value.code == "HB-N302"


@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.parametrize(("inflow", "k"), [(1e-5, 1.0), (3e-6, 1.0), (1e-3, 10.0)])
def test_nothing_is_lost_of_what_trickles_in(inflow: float, k: float, solver: str) -> None:
    """The level stays above the hole by ``(inflow/k)^2``, less than the error of a step."""
    m = hb.Model("trickle")
    m.add(i=hb.Sf(inflow), n=hb.Zero(), t=hb.C(1.0, e=0.5), hole=hb.R({"f": f"{k}*sqrt(e - 0.25)"}))
    m.bond("i -> n", "n -> t", "n -> hole")
    m.signal(out=hb.Integral("hole.f"), inn=hb.Integral("i.f"))
    run = hb.simulate(m, 1000, solver=solver)
    lost = run["t.q"].at(1000.0) - 0.5 + run["out"].at(1000.0) - run["inn"].at(1000.0)
    assert abs(lost) < 1e-12
    assert run.stats["steps"] < 400
