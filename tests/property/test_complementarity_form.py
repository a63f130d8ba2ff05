"""Complementarity systems of random graphs, against what elements say in each branch of the laws.

There each law is closed in one of its branches, and knows nothing of `l` and `w`.
"""

from __future__ import annotations

import numpy as np
import pytest
from dense_oracle import Net
from engine.laws_put_back import laws_of
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from law_nets import law_model, law_net
from scipy.linalg import null_space
from scipy.optimize import least_squares
from test_mixed_boolean import linear_rows, modes_of, point_of, values_in

import hybond as hb
from hybond.analysis.complementarity.form import complementarity

SETTINGS = settings(
    max_examples=75,
    derandomize=True,
    deadline=None,
    database=None,
    suppress_health_check=list(HealthCheck),
)
SEEDS = st.integers(0, 10**6)
TIGHT = {"xtol": 1e-15, "ftol": 1e-15, "gtol": 1e-15}


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


@pytest.mark.slow
@SETTINGS
@given(SEEDS, st.integers(1, 5), st.integers(0, 1), st.booleans())
def test_every_branch_satisfies_the_form(seed: int, size: int, rings: int, symbolic: bool) -> None:
    form = form_of(law_net(seed, size, rings), seed, symbolic=symbolic)
    assume(not form.nonlinear)
    graph, laws = form.graph, laws_of(form.graph)
    rng = np.random.default_rng(seed)
    m = form.numbers()
    # all elements of these nets store or dissipate
    assert form.properties.semidefinite and form.properties.passive
    seen = 0
    for mode in modes_of(graph, rng):
        if any(m_.law is None and mode[m_.index] != form.mode[m_.index] for m_ in graph.machines):
            continue
        if any(graph.machines[k].states[mode[k]] == "impact" for k in law_machines(graph)):
            continue
        if contradicts(graph, mode):
            continue
        point = point_of(graph, mode, rng)
        v = values_in(graph, laws, mode)
        put_bonds(laws, v, point.w)
        given_, answer = pairs_at(form, laws, v)
        u = [
            point.du.get(graph.by_path[n[:-1]], 0.0)
            if n.endswith("'")
            else point.u[graph.by_path[n]]
            for n in form.inputs
        ]
        scale = max(np.abs(point.w).max(), 1e-3)  # rounding may be all that satisfies a mode
        near(m["A"] @ point.x + m["B"] @ u + m["E"] @ given_, point.rates, scale)
        near(m["C"] @ point.x + m["F"] @ u + m["D"] @ given_, answer, scale)
        seen += 1
    assume(seen)


def law_machines(graph) -> list[int]:
    return [m.index for m in graph.machines if m.law is not None]


def contradicts(graph, mode) -> bool:
    """Whether sources contradict each other: rows of them alone, whatever is stored."""
    A, B, given, _, _ = linear_rows(graph, mode)
    if not given:
        return False
    silent = null_space(A.T, rcond=1e-10).T
    return bool(np.abs(silent @ B).max(initial=0.0) > 1e-9)


def put_bonds(laws, v: list[float], w: np.ndarray) -> None:
    first = laws.index["e:0"]
    v[first : first + len(w)] = w.tolist()


def pairs_at(form, laws, v) -> tuple[list[float], list[float]]:
    """Return l and w of all laws at values."""
    given, answer = [], []
    own = laws_by_path(form.graph)
    for p in form.laws:
        common, net = (laws.closure(e)(v) for e in (own[p.path].common, own[p.path].net))
        given.append(common if p.orientation == "common" else -net)
        answer.append(-net if p.orientation == "common" else common)
    return given, answer


def laws_by_path(graph):
    return {graph.nodes[m.law.node].path: m.law for m in graph.machines if m.law is not None}


@pytest.mark.slow
@SETTINGS
@given(SEEDS, st.integers(1, 4))
def test_a_nonlinear_graph_is_linearised_at_its_start(seed: int, size: int) -> None:
    """Rates and answers near the start are those of the graph itself, and so are their slopes."""
    form = form_of(law_net(seed, size, nonlinear=0.7), seed, symbolic=True)
    assume(form.nonlinear and form.point and not form.constraints)
    graph, laws = form.graph, laws_of(form.graph)
    m = form.numbers()
    x = np.array([form.point[n] for n in form.states])

    def at(x: np.ndarray, l: np.ndarray) -> np.ndarray | None:
        """Return rates and answers with all l given, by Newton on what elements say."""
        v = values_in(graph, laws, form.mode)
        for s, a in zip(graph.storages, x):
            v[laws.index[f"x:{s.index}"]] = a
        own = {law.node for law in laws_by_path(graph).values()}

        def said(w: np.ndarray) -> np.ndarray:
            put_bonds(laws, v, w)
            rows = [a for a, _ in laws.off(v, form.mode, apart=own).values()]
            # of junctions with laws no more is known than that all bonds have the common variable
            shared = [sum(r) for k in own for r in laws._junction(v, graph.nodes[k], True)[:-1]]
            return np.array([*rows, *shared, *(np.array(pairs_at(form, laws, v)[0]) - l)])

        found = least_squares(said, np.zeros(2 * len(graph.bonds)), **TIGHT)
        if np.abs(said(found.x)).max() > 1e-9 or np.linalg.matrix_rank(found.jac) < len(found.x):
            return None
        return np.array([*laws.rates(v), *pairs_at(form, laws, v)[1]])

    nothing = np.zeros(len(form.laws))
    here = at(x, nothing)
    assume(here is not None)
    near(m["A"] @ x + m["a"][:, 0], here[: len(x)])
    near(m["C"] @ x + m["c"][:, 0], here[len(x) :])
    rng = np.random.default_rng(seed)
    step = 1e-5
    dx, dl = rng.normal(size=len(x)), rng.normal(size=len(nothing))
    ahead, back = at(x + step * dx, step * dl), at(x - step * dx, -step * dl)
    assume(ahead is not None and back is not None)
    slope = np.concatenate([m["A"] @ dx + m["E"] @ dl, m["C"] @ dx + m["D"] @ dl])
    found = (ahead - back) / (2 * step)
    np.testing.assert_allclose(slope, found, rtol=0, atol=1e-6 * (1 + np.abs(found).max()))


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
