"""What is evaluated in a step, and what guards are measured by: what they read."""

from __future__ import annotations

import math

import numpy as np
import pytest
from portable_runs import portable

import hybond as hb
from hybond.engine.answers import value
from hybond.engine.expressions.paired import holds
from hybond.engine.guards.guard_values import atom_at, look
from hybond.engine.guards.locator import make_locator
from hybond.engine.guards.watching import watch
from hybond.engine.mode.digits.sizes import size_of
from hybond.engine.mode.solving import solve
from hybond.engine.surfaces.values import begin_field, field, set_state
from hybond.engine.words import some

RUNS = [
    ("diode_bridge", 1e-4),
    ("half_bridge", 1e-4),
    ("six_pulse_rectifier", 2e-3),
    ("boost", 1e-4),
    ("stick_slip", 2.0),
    ("bouncing_ball_air", 0.5),
    ("falling_rod", 0.2),
    ("three_tanks", 1.0),
    ("rlcd", 1e-3),
]


@pytest.fixture(params=RUNS, ids=[name for name, _ in RUNS])
def engine(request, monkeypatch):
    name, until = request.param
    return portable(hb.load(f"examples/{name}.toml"), monkeypatch, until=until).engine


def bonds_of(e) -> slice:
    return slice(e.model.bond_slot, e.model.bond_slot + 2 * e.model.bonds)


def forget(e) -> None:
    """Make all bond variables, and all that they are solved from, no numbers."""
    many = 2 * e.model.bonds
    e.v[bonds_of(e)] = [math.nan] * many
    e.work.w[:many] = [math.nan] * many
    e.work.xi[:] = [math.nan] * len(e.work.xi)


@pytest.mark.sampled(3)
def test_rates_need_no_more_than_is_evaluated(engine):
    e = engine
    begin_field(e, e.mode)
    forget(e)
    found = [0.0] * e.states
    assert field(e, e.mode, e.t, e.y, found) == 0
    set_state(e, e.mode, e.v, e.t, e.y)
    assert solve(e, e.mode, e.v) == 0
    m = e.model
    for k in range(m.storages):
        at = m.storage_bond[k] + (m.bonds if m.storage_kind[k] == 0 else 0)
        assert abs(found[k]) == abs(e.work.w[at])
    for k in range(m.integrals):
        assert found[m.storages + k] == value(m, m.integral_rate[k], e.v)


@pytest.mark.sampled(3)
def test_guards_need_no_more_than_is_evaluated(engine):
    e = engine
    g = make_locator(e)
    watch(e, g, e.state)
    begin_field(e, e.mode)
    forget(e)
    g.looked = math.nan
    look(e, g, e.t)
    atoms = [atom_at(e, g, a, e.t) for a in range(g.atoms)]
    lazily = list(e.v)
    assert solve(e, e.mode, e.v) == 0
    assert atoms == [value(e.model, e.model.atom_value[g.atom[a]], e.v) for a in range(g.atoms)]
    evaluated = [k for k in range(*bonds_of(e).indices(len(e.v))) if not math.isnan(lazily[k])]
    assert [lazily[k] for k in evaluated] == [e.v[k] for k in evaluated]


@pytest.mark.sampled(3)
def test_pairs_read_what_is_said_and_nothing_else(engine):
    e = engine
    m = e.model
    stack = e.work.stack
    rng = np.random.default_rng(7)
    v = list(rng.normal(size=2 * m.slots))
    stack.jump, stack.jumps, stack.was_first = [0.0] * m.slots, False, 0
    for rule in range(m.rule_first[m.machines]):
        read = m.read_slot[m.read_first[rule] : m.read_first[rule + 1]]
        told = []
        for other in (v, [x if k in read else math.nan for k, x in enumerate(v[: m.slots])]):
            stack.now = stack.was = list(other)
            stack.terms = [abs(x) for x in stack.now]
            stack.prior_terms = stack.terms
            told.append(holds(m, rule, stack))
            told.append(stack.refused)
            twice = [*stack.now[: m.slots], *stack.now[: m.slots]]
            told.append(value(m, m.rule_test[rule], twice))
            for a in range(m.atom_first[rule], m.atom_first[rule + 1]):
                told.append(value(m, m.atom_value[a], twice))
                told.append(value(m, m.atom_size[a], twice))
        half = len(told) // 2
        assert told[:half] == pytest.approx(told[half:], nan_ok=False)


def least_leakage_sizes(e, mode, rows):
    """The sizes of the terms of ``(1 - b2 t2)(1 - b1 t1) rows``, where that is not zero."""
    n, p = 2 * e.model.bonds, mode.leakage
    b1 = np.array(p.basis.at[: n * p.first]).reshape(n, p.first)
    t1 = np.array(p.taken.at[: n * p.first]).reshape(p.first, n)
    b2 = np.array(p.basis2.at[: n * p.second]).reshape(n, p.second)
    t2 = np.array(p.taken2.at[: n * p.second]).reshape(p.second, n)
    a1 = np.abs(t1) @ rows
    a2 = np.abs(t2) @ rows + np.abs(t2 @ b1) @ a1
    sizes = np.zeros((n, len(e.work.xi)))
    terms = rows + np.abs(b1) @ a1 + np.abs(b2) @ a2
    for k in range(n):
        same = mode.same[k]
        for i in range(mode.direct.first.at[same], mode.direct.first.at[same + 1]):
            sizes[k, mode.direct.column.at[i]] = terms[same, mode.direct.column.at[i]]
    return sizes


@pytest.mark.sampled(3)
def test_sizes_are_those_of_the_terms(engine):
    e = engine
    n = 2 * e.model.bonds
    for mode in [some(e.modes[k]) for k in range(e.modes_made)]:
        if mode.dynamics > 0:
            continue
        rng = np.random.default_rng(3)
        xi = list(rng.normal(size=len(e.work.xi)))
        v = list(rng.normal(size=len(e.v)))
        w = np.abs(v[bonds_of(e)])
        by_known = np.zeros((n, mode.knowns))
        for k in range(n):
            first, stop = mode.finite.first.at[mode.same[k]], mode.finite.first.at[mode.same[k] + 1]
            for i in range(first, stop):
                assert mode.finite.size.at[i] >= abs(mode.finite.value.at[i])
                by_known[k, mode.finite.column.at[i]] = mode.finite.size.at[i]
        frees = mode.finite_frees
        free = np.array(mode.finite_free.at[: n * frees]).reshape(n, frees)
        size = np.abs(by_known) @ np.abs(xi[: mode.knowns])
        size += np.abs(free) @ w[mode.free_column[:frees]]
        if mode.leakage.stages > 0:
            size = np.maximum(size, least_leakage_sizes(e, mode, by_known) @ np.abs(xi))
        found = [size_of(e, mode, b, xi, v) for b in range(n)]
        assert found == pytest.approx(np.maximum(size, w), rel=1e-12)


@pytest.mark.parametrize(("above", "switches"), [(0.0, False), (1e-15, False), (1e-9, True)])
def test_a_difference_that_is_rounding_of_its_terms_is_zero(above, switches, monkeypatch):
    """Three capacitors in a loop: 0.1 V + 0.2 V - 0.3 V is not zero, yet nothing but rounding."""
    m = hb.Model("doubt", domain="electrical")
    m.add(a=hb.C(1, e=0.1), b=hb.C(1, e=0.2), c=hb.C(1, e=0.3 - above), j=hb.One(), R=hb.R(1e-3))
    m.add(quiet=hb.C(1, e=1), s=hb.One(), n=hb.Zero(), r=hb.R(1))
    m.bond("a -> j", "b -> j", "j -> c", "j -> R", "quiet -> n -> s -> r")
    rules = ["low -> high when R.e > 0"]
    m.machine("watch", states={"low": [], "high": ["s"]}, start="low", rules=rules)
    run = portable(m, monkeypatch, until=1e-6)
    fired = [f for _, _, steps in run.events for _, own in steps for f in own]
    assert bool(fired) is switches
