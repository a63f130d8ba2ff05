"""Random models: what must hold of every run, and that the checks see what they are for."""

from __future__ import annotations

import math
import sys
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings

import hybond as hb
from hybond.testing import (
    WAYS,
    Bond,
    Curve,
    Part,
    Recipe,
    check_model,
    check_recipe,
    random_recipe,
    recipes,
    turned,
)
from hybond.testing import check as checking
from hybond.testing.check import (
    FURTHER_WAYS,
    POINTS,
    SAME,
    Finding,
    Outcome,
    _by_tolerance,
    _differ,
    _moves,
    _outcome,
    _sizes,
)
from hybond.testing.drawing import _Drawing, begins_in_conflict, with_resistances

SEEDS = range(150)
THOUSAND = range(1000)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("first", range(0, len(SEEDS), 10))
def test_nothing_is_found_in_any_way(first: int) -> None:
    checks = {s: check_recipe(random_recipe(s), seed=s) for s in SEEDS[first : first + 10]}
    assert not {seed: check for seed, check in checks.items() if not check.holds}


@pytest.mark.sampled(2)
@pytest.mark.parametrize("first", range(0, len(THOUSAND), 25))
def test_nothing_is_found_in_the_next_way(first: int) -> None:
    """Each in one way only, the next way for the next seed."""
    checks = {
        s: check_recipe(random_recipe(s), seed=s, ways=[WAYS[s % len(WAYS)]])
        for s in THOUSAND[first : first + 25]
    }
    assert not {seed: check for seed, check in checks.items() if not check.holds}


def test_all_kinds_are_drawn() -> None:
    parts = [p for seed in SEEDS for p in random_recipe(seed).parts]
    assert {p.kind for p in parts} == {*"CIRG01", "Se", "Sf", "TF", "GY"}
    laws = {dict(p.value).get("law") for p in parts if p.kind in "01"}
    assert laws == {None, "diode", "unilateral", "coulomb", "relay"}
    assert any(p.is_field for p in parts)
    assert sum(bool(random_recipe(seed).switches) for seed in SEEDS) > 15
    recipes_of_some = [random_recipe(seed) for seed in range(40)]
    words = [_outcome(r.model(), r.until, 5.0).word for r in recipes_of_some]
    assert words.count("ok") > 20 and len(set(words)) > 1


@given(recipes(size=3))
@settings(max_examples=15, deadline=None, derandomize=True, database=None)
def test_turning_twice_is_the_same_graph(recipe: Recipe) -> None:
    again = turned(turned(recipe, 5).recipe, 5).recipe
    assert again.bonds == recipe.bonds
    assert [p.start for p in again.parts] == [p.start for p in recipe.parts]


RING = Recipe(
    parts=(
        Part("v", "1"),
        Part("i", "I", Curve("linear", 1.0, 1.0), (1.0,)),
        Part("c", "C", Curve("cubic", 1.0, 1.0), (0.2,)),
        Part("r", "R", Curve("knee", 1.0, 0.5)),
    ),
    bonds=(Bond("v", "i"), Bond("v", "c"), Bond("v", "r")),
)


def test_a_law_that_is_not_mirrored_with_its_bond_is_found() -> None:
    assert check_recipe(RING).holds
    other = replace(RING, bonds=(Bond("v", "i"), Bond("v", "c"), Bond("r", "v")))
    runs = [_outcome(r.model(), 1.0, 5.0) for r in (RING, other)]
    same = {name: (name, 1.0) for name in RING.stored}
    (found,) = _differ("turned", *runs, same, SAME)
    assert found.kind == "turned"


def test_energy_from_nothing_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    audit = replace(hb.simulate(RING.model(), 1.0).audit(), created=0.1)
    monkeypatch.setattr(hb.Result, "audit", lambda _: audit)
    assert [f.kind for f in check_model(RING.model(), 1.0).findings] == ["audit"]


def test_another_exception_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    def breaks(*_: object, **__: object) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr("hybond.testing.check.simulate", breaks)
    check = check_model(RING.model(), 1.0)
    assert (check.outcome, check.findings[0].kind) == ("ZeroDivisionError", "traceback")


def test_a_switched_element_has_a_bond_that_is_not_in_the_text() -> None:
    m = hb.loads("""
hybond = 1
[elements]
s = { Se = 1.0 }
v = { junction = 1 }
c = { C = 1.0 }
r = { R = 1.0 }
[machines.shutter]
states = { open = ["r"], shut = [] }
start = "open"
rules = ["open -> shut when time > 0.5 s"]
[graph]
bonds = ["s -> v -> c", "v -> r"]
""")
    assert any(n.hidden for n in m.flatten().nodes)
    assert check_model(m, 1.0).findings == ()


def test_without_hypothesis_only_the_strategy_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "hypothesis", None)
    assert random_recipe(3).parts
    with pytest.raises(hb.UsageError) as caught:
        recipes()
    assert caught.value.code == "HB-S121"


def test_rounding_in_what_a_mode_holds_at_zero_is_no_difference() -> None:
    """What would hold the energy is known of a store by its law, not by what it happens to hold."""
    run = hb.simulate(RING.model(), 1.0)
    held = dict(zip(RING.stored, _sizes(run, RING.stored), strict=True))
    # 0.5 p²/1 and 0.5 q² + 0.25 q⁴ hold what the run begins with, or what the start is
    assert held["i.p"] == pytest.approx((2.0 * run.trace.energy) ** 0.5, rel=1e-12)
    steepest = 1.0 + 3.0 * max(abs(run["c.q"].at(t)) for t in np.linspace(0, 1, POINTS)) ** 2
    assert held["c.q"] == pytest.approx((2.0 * run.trace.energy / steepest) ** 0.5, rel=1e-6)


def test_a_motion_that_forgets_its_start_is_not_held_against_another_run() -> None:
    """A mass that a source throws against a hard spring: numbers moved by 1e-7 move it by all.

    And a ring, whose motion does not, is.
    """
    wall = Recipe(
        parts=(
            Part("v", "1"),
            Part("u", "0"),
            Part("mass", "I", Curve("linear", 1.0, 1.0), (1.0,)),
            Part("soft", "C", Curve("linear", 1.0, 10.0), (0.5,)),
            Part("hard", "C", Curve("sinh", 0.00176, 0.00704), (0.005,)),
            Part("drive", "Sf", "-50.0*sin(46.0*time)"),
        ),
        bonds=(
            Bond("v", "mass"),
            Bond("u", "v"),
            Bond("v", "soft"),
            Bond("u", "hard"),
            Bond("drive", "u"),
        ),
        until=6.0,
    )
    assert _moves(wall, 1, 5.0) > 1e-2
    assert 0.0 < _moves(RING, 1, 5.0) < 1e-6


def test_sources_with_a_resistance_of_their_own_do_not_conflict() -> None:
    drawn = [_Drawing(seed, 6).recipe() for seed in range(80)]
    bare = [r for r in drawn if begins_in_conflict(r)]
    assert len(bare) > 10 and sum(random_recipe(s) in bare for s in range(80)) > 1
    words = [_outcome(with_resistances(r).model(), r.until, 5.0).word for r in bare]
    assert "HB-C101" not in words and words.count("ok") > 0.8 * len(words)


@pytest.mark.parametrize("seed", [142425, 142794])
def test_a_valve_that_shares_what_is_open_stays_within_its_law(seed: int) -> None:
    """Where least leakage ends at the corner of a law, it ended beyond by 1e-10: HB-N411."""
    recipe = random_recipe(seed)
    assert check_recipe(recipe, seed=seed).holds


@pytest.mark.parametrize("seed", [147403, 150643, 153825, 160921, 162240, 166391, 201081])
def test_where_nothing_moves_yet_rounding_of_a_moment_later_is_no_broken_law(seed: int) -> None:
    """``k*e*abs(e)`` has no slope at zero: Newton ends at the rounding of its beginning."""
    found = check_recipe(random_recipe(seed), seed=seed, ways=("order",))
    assert found.outcome == "ok"
    assert found.holds


@pytest.mark.parametrize("seed", [169307, 176623])
def test_order_does_not_decide(seed: int) -> None:
    """Friction that comes to rest beside masses that bend; storages that share a junction."""
    assert check_recipe(random_recipe(seed), seed=seed).holds


@pytest.mark.parametrize("seed", [302974, 304197, 306301, 300441, 302183])
def test_a_jump_leaves_no_rounding_of_what_was_before_it(seed: int) -> None:
    """Heavy masses are stopped beside light ones: 1e-9 of what is left was rounding of before."""
    found = check_recipe(random_recipe(seed), seed=seed, ways=("order",))
    assert found.outcome == "ok"
    assert found.holds


@pytest.mark.slow
def test_errors_that_fall_with_the_tolerance_are_no_finding_and_others_are() -> None:
    """A mass on a hard spring: two thousand steps of 1e-8 add up. An offset does not fall."""
    recipe = _Drawing(114065, 6).recipe()
    model = recipe.model()
    first = _outcome(model, recipe.until, 20.0)
    other = _outcome(model, recipe.until, 20.0, solver="radau")
    same = {name: (name, 1.0) for name in recipe.stored}
    [finding] = _differ("radau", first, other, same, 1e-5)
    assert 1e-5 < finding.apart < 1e-2
    assert _by_tolerance(finding, model, recipe.until, 20.0)
    assert not _by_tolerance(replace(finding, apart=0.02), model, recipe.until, 20.0)


@pytest.mark.slow
def test_what_errs_by_little_from_the_beginning_need_not_fall() -> None:
    """Of two runs of 200 swings one errs by 5e-3, which falls; the other by 1e-5, which halves."""
    m = hb.Model("swings")
    m.add(j=hb.One(), i=hb.I(0.000845771144278607, p=0.132))
    m.add(c=hb.C({"e": "0.00492*sinh(q/0.00821)"}, q=-0.00258))
    m.bond("j -> i", "j -> c")
    first, other = _outcome(m, 0.64, 20.0), _outcome(m, 0.64, 20.0, **checking.METHODS["radau"])
    same = {name: (name, 1.0) for name in ("i.p", "c.q")}
    [finding] = _differ("radau", first, other, same, 1e-5)
    assert 1e-3 < finding.apart < 1e-2
    assert _by_tolerance(finding, m, 0.64, 20.0)


@pytest.mark.slow
def test_sizes_are_those_of_all_times_not_only_of_those_compared() -> None:
    """Near events nothing is compared. What was large there and dies out is known by that size."""

    def dies_out(rate: str) -> Outcome:
        m = hb.Model("dies out", parameters={"rate": rate})
        m.add(c=hb.C(1.0, q=1.0), r=hb.G("rate"), node=hb.Zero())
        m.bond("node -> c", "node -> r")
        rules = [
            "a -> b when sin(2e4*time) > 0 and time < 0.95",
            "b -> a when sin(2e4*time) < 0",
        ]
        m.machine("ticks", states={"a": [], "b": []}, start="a", rules=rules)
        return _outcome(m, 1.0, 20.0)

    one, two = dies_out("9"), dies_out("9.01")
    assert one.run is not None
    assert len(one.run.trace.events) > 4000
    same = {"c.q": ("c.q", 1.0)}
    [finding] = _differ("radau", one, two, same, 0.0)
    assert 1e-7 < finding.apart < 1e-5  # 1e-2 of what is left at the end


def test_an_error_that_stays_is_a_finding(monkeypatch: pytest.MonkeyPatch) -> None:
    """Another method that is off by 1e-4 at every tolerance: its own parameter is off."""
    m = hb.Model("rc", parameters={"ohms": 2.0})
    m.add(c=hb.C(1.0, q=1.0), r=hb.R("ohms"), node=hb.Zero())
    m.bond("node -> c", "node -> r")
    monkeypatch.setitem(
        checking.METHODS, "rk45", {"solver": "rk45", "parameters": {"ohms": 2.0002}}
    )
    assert not _by_tolerance(Finding("rk45", "", 4e-5), m, 1.0, 20.0)
    assert _by_tolerance(Finding("radau", "", 1e-6), m, 1.0, 20.0)


@pytest.mark.slow
def test_energy_that_tolerances_do_not_resolve_is_no_finding_and_lost_energy_is(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """What begins with a thousand times of what it holds later has a thousandth of its digits."""
    m = hb.Model("followed")
    table = [[-0.0033, -0.00165, 0.0, 0.00165, 0.00495], [-1185.0, -395.0, 0.0, 395.0, 592.5]]
    m.add(i=hb.I({"f": {"table": table, "extrapolate": "linear"}}, p=0.000919), v=hb.Zero())
    m.add(t=hb.GY(-51.3), g=hb.G(27555.55555555556), s=hb.Se("31.6*sin(2600.0*time)"), j=hb.One())
    m.add(r=hb.R(0.00052))
    m.bond("i -> v", "v -> t.2", "j -> s", "j -> g", "j -> t.1", "r -> j")
    audit = hb.simulate(m, 0.006).audit()
    assert audit.beyond > 0.0 and audit.energy < 1e-7 and audit.power < 1e-15
    assert check_model(m, 0.006).findings == ()
    # an imbalance that a tenth of the tolerance leaves as it is, and no step accounts for
    lost = replace(audit, energy=1e-3, beyond=math.inf)
    monkeypatch.setattr(hb.Result, "audit", lambda _: lost)
    assert [f.kind for f in check_model(m, 0.001).findings] == ["audit"]


CONTROLLED = range(100, 130)


def test_controllers_add_what_they_are_to_add() -> None:
    recipes = [random_recipe(seed, controlled=True) for seed in range(400)]
    options = [dict(p.value) for r in recipes for p in r.parts if p.kind in ("0", "1")]
    assert {"thyristor", "unilateral", "coulomb"} <= {o.get("law") for o in options}
    assert sum("gap" in o for o in options) > 5
    assert {c.is_pulse for r in recipes for c in r.clocked} == {True, False}
    assert sum(".e}" in s.closes or ".f}" in s.closes for r in recipes for s in r.switches) > 20
    sizes = [p.value.width for r in recipes for p in r.parts if isinstance(p.value, Curve)]
    assert min(sizes) < 1e-9


@pytest.mark.sampled(1)
@pytest.mark.parametrize("first", range(0, 30, 10))
def test_models_with_controllers_run_alike_in_every_way(first: int) -> None:
    checks = {
        s: check_recipe(random_recipe(s, controlled=True), seed=s)
        for s in CONTROLLED[first : first + 10]
    }
    assert {s: c.findings for s, c in checks.items() if c.findings} == {}


def test_what_rests_is_measured_by_the_energy_that_a_run_comes_to() -> None:
    # nothing is stored at the instants of the run, and 36 J while it goes on: p stays rounding
    m = hb.Model("filled")
    m.add(j=hb.One(), i=hb.I(2.0), a=hb.Se(12.0), c=hb.C(0.5), r=hb.R(1e-3))
    m.bond("a -> j", "j -> i", "j -> c", "j -> r")
    run = hb.simulate(m, until=20.0, rtol=1e-9)
    assert run.trace.energy == 0.0
    # at a quarter of its period as much as the source has given less what the condenser holds
    most = max(
        0.25 * run["i.p"].at(t) ** 2 + run["c.q"].at(t) ** 2 for t in np.linspace(0, 20, 400)
    )
    sizes = _sizes(run, ["i.p", "c.q"])
    assert sizes == pytest.approx([2.0 * most**0.5, most**0.5], rel=0.02)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("controlled", [False, True])
def test_nothing_is_found_in_further_ways(controlled: bool) -> None:
    for seed in range(4):
        recipe = random_recipe(seed, controlled=controlled)
        assert check_recipe(recipe, seed=seed, ways=FURTHER_WAYS).holds


def test_a_run_that_goes_on_from_elsewhere_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    def elsewhere(model: hb.Model, until: float, patience: float, **options: Any) -> Outcome:
        if "start" in options:
            options["start"] = {"c.q": 0.5}
        return _outcome(model, until, patience, **options)

    recipe = Recipe(
        (
            Part("c", "C", Curve("linear", 1.0, 1.0), (1.0,)),
            Part("r", "R", Curve("linear", 1.0, 1.0)),
        )
        + (Part("j", "0"),),
        (Bond("j", "c"), Bond("j", "r")),
    )
    assert check_recipe(recipe, ways=["halves"]).holds
    monkeypatch.setattr(checking, "_outcome", elsewhere)
    assert [f.kind for f in check_recipe(recipe, ways=["halves"]).findings] == ["halves"]
