"""Complementarity systems of random graphs: against the ports of the run, and against modes.

`PortEquations` is what a run decides with. The equations of a mode are a third derivation: there
each law is closed in one of its branches, and knows nothing of `l` and `w`.
"""

from __future__ import annotations

import numpy as np
import pytest
from dense_oracle import Net
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from law_nets import law_model, law_net
from scipy.linalg import null_space
from test_mixed_boolean import modes_of, point_of

import hybond as hb
from hybond.equations.complementarity_form import complementarity
from hybond.equations.linearised import start_values
from hybond.equations.ports import law_machines
from hybond.equations.tableau import build
from hybond.model.expressions import compile_expression

SETTINGS = settings(
    max_examples=75,
    derandomize=True,
    deadline=None,
    database=None,
    suppress_health_check=list(HealthCheck),
)
SEEDS = st.integers(0, 10**6)


def form_of(net: Net, seed: int, *, symbolic: bool):
    graph = law_model(net, seed).flatten()
    assume(law_machines(graph))
    rng = np.random.default_rng(seed)
    hand = {m.path: m.states[rng.integers(2)] for m in graph.machines if m.law is None}
    try:
        return complementarity(graph, hand, symbolic=symbolic)
    except hb.CausalityError as error:
        assert error.code in ("HB-C103", "HB-C104")
    except hb.EquationError as error:
        assert error.code == "HB-Q104"
    assume(False)
    raise AssertionError


def near(found, want, scale=1.0) -> None:
    found, want = np.asarray(found), np.asarray(want)
    size = scale + np.abs(want).max(initial=0.0)
    np.testing.assert_allclose(found, want, rtol=1e-8, atol=1e-8 * size)


def check_ports(form) -> None:
    ports, graph = form.ports, form.graph
    slots = ports.equations.slots
    v, _, _ = start_values(graph, form.mode, slots)
    m = form.numbers()
    rng = np.random.default_rng(0)
    x = rng.normal(size=len(graph.storages))
    free = null_space(form.constraint_rows) if len(form.constraint_rows) else np.eye(len(x))
    response = ports.response(v, free @ (free.T @ x))
    near(m["D"], response.D)
    near(m["E"], response.E)
    near(m["C"] @ m["E"], response.CE)
    # differences of states along which no constraint changes; sources drop out
    zero = ports.response(v, np.zeros(len(x)))
    for column in free.T:
        moved = ports.response(v, column)
        near(m["C"] @ column, moved.y - zero.y)
        near(m["A"] @ column, ports.equations.storage.rates_of(moved.bonds - zero.bonds))
    if len(response.D) and response.D.any():
        least = np.linalg.eigvalsh(response.D + response.D.T).min() / np.abs(response.D).max()
        if abs(least) > 1e-7:
            assert form.properties.semidefinite == (least > 0)
        else:
            assert form.properties.semidefinite
    if not form.nonlinear:
        # all elements of these nets store or dissipate
        assert form.properties.semidefinite and form.properties.passive


@pytest.mark.slow
@SETTINGS
@given(SEEDS, st.integers(1, 6), st.integers(0, 2))
def test_numbers_are_those_of_the_ports(seed: int, size: int, rings: int) -> None:
    check_ports(form_of(law_net(seed, size, rings), seed, symbolic=False))


@pytest.mark.slow
@SETTINGS
@given(SEEDS, st.integers(1, 5), st.integers(0, 1))
def test_symbols_have_the_numbers_of_the_ports(seed: int, size: int, rings: int) -> None:
    check_ports(form_of(law_net(seed, size, rings), seed, symbolic=True))


@pytest.mark.slow
@SETTINGS
@given(SEEDS, st.integers(1, 5), st.integers(0, 1), st.booleans())
def test_every_branch_satisfies_the_form(seed: int, size: int, rings: int, symbolic: bool) -> None:
    form = form_of(law_net(seed, size, rings), seed, symbolic=symbolic)
    assume(not form.nonlinear)
    graph = form.graph
    rng = np.random.default_rng(seed)
    m = form.numbers()
    seen = 0
    for mode in modes_of(graph, rng):
        if any(m_.law is None and mode[m_.index] != form.mode[m_.index] for m_ in graph.machines):
            continue
        if any(graph.machines[k].states[mode[k]] == "impact" for k in law_machines(graph)):
            continue
        if build(graph, mode, {}).agreements:
            continue  # sources contradict each other in this branch
        point = point_of(graph, mode, rng)
        slots = form.ports.equations.slots
        v = [0.0] * (2 * slots.size)
        v[slots.w] = point.w.tolist()

        def value(e, v=v, slots=slots):
            return compile_expression(e, slots.index, pre_offset=slots.size)(v)

        given_, answer = [], []
        for p in form.ports.ports:
            common, net = value(p.law.common), value(p.law.net)
            given_.append(common if p.given == "common" else -net)
            answer.append(-net if p.given == "common" else common)
        u = [
            point.du.get(graph.by_path[n[:-1]], 0.0)
            if n.endswith("'")
            else point.u[graph.by_path[n]]
            for n in form.inputs
        ]
        scale = np.abs(point.w).max()
        near(m["A"] @ point.x + m["B"] @ u + m["E"] @ given_, point.rates, scale)
        near(m["C"] @ point.x + m["F"] @ u + m["D"] @ given_, answer, scale)
        seen += 1
    assume(seen)


@pytest.mark.slow
@SETTINGS
@given(SEEDS, st.integers(1, 4))
def test_a_nonlinear_graph_is_linearised_at_its_start(seed: int, size: int) -> None:
    form = form_of(law_net(seed, size, nonlinear=0.7), seed, symbolic=True)
    assume(form.nonlinear and form.point)
    ports, slots = form.ports, form.ports.equations.slots
    v, x, _ = start_values(form.graph, form.mode, slots)
    response = ports.response(v, x)
    m = form.numbers()
    near(m["D"], response.D)
    near(m["E"], response.E)
    # the tangent touches at the point
    near(m["C"] @ x + m["c"][:, 0], response.y)
    near(m["A"] @ x + m["a"][:, 0], ports.equations.storage.rates_of(response.bonds))
    # and what it leaves out is of second order: a step ten times shorter, a rest a hundredth
    rng = np.random.default_rng(seed)
    way = rng.normal(size=len(x))
    rests = []
    for h in (1e-2, 1e-3):
        moved = x + h * way
        v[slots.x] = moved.tolist()
        bonds = ports.solve(v, moved, np.zeros(len(ports.ports)))
        rests.append(
            np.abs(ports.equations.storage.rates_of(bonds) - m["A"] @ moved - m["a"][:, 0]).max()
        )
    assert rests[1] <= 0.05 * rests[0] + 1e-8


def test_the_seeds_reach_what_they_are_for() -> None:
    kinds = {"constraints": 0, "linear": 0, "several": 0, "feedthrough": 0}
    for seed in range(60):
        graph = law_model(law_net(seed, 4), seed).flatten()
        if not law_machines(graph):
            continue
        try:
            form = complementarity(graph, symbolic=False)
        except hb.CausalityError:
            continue
        kinds["constraints"] += bool(form.constraints)
        kinds["linear"] += not form.nonlinear
        kinds["several"] += len(form.laws) > 1
        kinds["feedthrough"] += bool(form.D.entries)
    assert min(kinds.values()) >= 5, kinds


def test_a_model_without_laws_is_refused() -> None:
    m = hb.Model()
    m.add(c=hb.C(1), r=hb.R(1))
    m.bond("c -> r")
    with pytest.raises(hb.EquationError) as caught:
        complementarity(m)
    assert caught.value.code == "HB-Q109"


def test_friction_in_two_directions_is_no_linear_complementarity_system() -> None:
    m = hb.Model("block", domain="translational")
    m.add(x=hb.One(law="coulomb", limit=1), y=hb.One(law="coulomb", pair="x"))
    m.add(m_x=hb.I(1), m_y=hb.I(1))
    m.bond("x -> m_x", "y -> m_y")
    with pytest.raises(hb.EquationError) as caught:
        complementarity(m)
    assert caught.value.code == "HB-Q110" and caught.value.where == "x"
