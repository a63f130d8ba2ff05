"""Mixed-Boolean equations against the equations that a run solves, mode by mode.

The run's tableau eliminates each mode by itself; the mixed-Boolean form knows only one form for
all. At random points that satisfy a mode's constraints, the rates of the one must satisfy the
other, and be the only ones that do.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
import pytest
from dense_oracle import Net, random_net
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.linalg import null_space

import hybond as hb
from hybond.equations.derive import state_equations
from hybond.equations.mode import prepare
from hybond.equations.slots import slots_of
from hybond.equations.state_form import StateEquations
from hybond.equations.tableau import build
from hybond.model.expressions import compile_expression
from hybond.model.expressions import names as hb_names

SETTINGS = settings(
    max_examples=75,
    derandomize=True,
    deadline=None,
    database=None,
    suppress_health_check=list(HealthCheck),
)
TOLERANCE = 1e-8


def hybrid_model(net: Net, seed: int) -> hb.Model:
    """Return `net` with a machine per controlled junction, some switched elements and fields."""
    rng = np.random.default_rng(seed)
    m = hb.Model("net", parameters={"a": 1.25, "b": 0.75})
    names = list(net.nodes)
    for k in rng.permutation(len(names)):
        name = names[k]
        kind, value = net.nodes[name]
        if kind in ("R", "C", "I") and rng.random() < 0.3:
            value = f"{value!r}*a" if kind == "R" else f"b/{value!r}"
        written = isinstance(value, str)
        part = getattr(hb, kind)(value) if written else net._part(name, kind, value)
        m.add(**{name: part})
    m.bond(*(f"{a} -> {b}" for a, b in net.bonds))
    junctions = net.of("0", "1")
    for k in range(int(rng.integers(0, 3))):
        # a field between two junctions; a storage field must have an energy
        kind = ("R", "G", "C", "I")[rng.integers(4)]
        half = rng.uniform(-0.6, 0.6)
        other = half if kind in "CI" else rng.uniform(-0.6, 0.6)
        rows = [[round(rng.uniform(0.8, 2), 3), half], [other, round(rng.uniform(0.8, 2), 3)]]
        m.add(**{f"field{k}": getattr(hb, kind)(rows)})
        for port in (1, 2):
            a, b = junctions[rng.integers(len(junctions))], f"field{k}.{port}"
            m.bond(f"{a} -> {b}" if rng.random() < 0.5 else f"{b} -> {a}")
    free = list(net.controlled)
    if rng.random() < 0.5:
        free += [n for n in net.of("Se", "Sf", "TF", "GY", "R", "C") if rng.random() < 0.3]
    k = 0
    while free:
        name = free.pop()
        if free and rng.random() < 0.25:
            other = free.pop()
            states = {"none": [], "one": [name], "two": [other], "both": [name, other]}
        else:
            states = {"off": [], "on": [name]}
        m.machine(f"M{k}", states=states, start=next(iter(states)))
        k += 1
    return m


def modes_of(graph, rng):
    every = list(product(*(range(len(m.states)) for m in graph.machines)))
    if len(every) <= 6:
        return every
    return [every[k] for k in rng.choice(len(every), 6, replace=False)]


@dataclass
class Point:
    """Bond variables that satisfy a mode, as the run's own equations give them."""

    x: np.ndarray
    z: np.ndarray
    u: dict[int, float]
    du: dict[int, float]
    w: np.ndarray
    rates: np.ndarray
    moved: np.ndarray


def point_of(graph, mode, rng) -> Point:
    tableau = build(graph, mode, {})
    own = prepare(graph, mode, slots_of(graph), tableau)
    assert own.linear
    nz, nu = len(graph.storages), len(tableau.sources)
    base = tableau.unknowns
    off = graph.off_nodes(mode)
    null = [{base + nz + k: 1.0} for k, s in enumerate(tableau.sources) if s.node in off]
    given = tableau.constraints + tableau.agreements + null
    rows = np.array([[r.get(base + k, 0.0) for k in range(nz + nu)] for r in given])
    rows = rows.reshape(len(given), nz + nu)
    point = rng.normal(size=nz + nu)
    free = null_space(rows) if len(rows) else np.eye(nz + nu)
    point = free @ (free.T @ point)
    du = rng.normal(size=nu)
    # source values that contradict each other may not drift apart either
    fixed = tableau.agreements + null
    sources_only = np.array([[r.get(base + nz + k, 0.0) for k in range(nu)] for r in fixed])
    sources_only = sources_only.reshape(len(fixed), nu)
    if len(sources_only):
        basis = null_space(sources_only)
        du = basis @ (basis.T @ du)
    xi = np.concatenate([point, du])
    w = own.x2 @ xi
    if own.project is not None:
        w = own.project @ w
    freedom = own.freedom if own.freedom.shape[1] else np.zeros((len(w), 0))
    return Point(
        x=np.linalg.solve(own.storage.matrix.dense(), point[:nz]),
        z=point[:nz],
        u={s.node: point[nz + k] for k, s in enumerate(tableau.sources)},
        du={s.node: du[k] for k, s in enumerate(tableau.sources)},
        w=w,
        rates=own.storage.rates_of(w),
        moved=own.storage.rates_of(freedom),
    )


def check_mode(eq: StateEquations, graph, mode, rng) -> None:
    point = point_of(graph, mode, rng)
    nz = len(graph.storages)
    rates, x, moved = point.rates, point.x, point.moved
    # the same point in the mixed-Boolean form
    d = eq.at(mode)
    columns = [eq.column(k) for k in eq.sources]
    u = np.array([point.u[c.index] for c in columns])
    udot = np.array([point.du[c.index] for c in columns])
    kept = len(d.states) - nz
    left = np.hstack([d.E[:, :nz], -d.A[:, nz:]])
    right = d.A[:, :nz] @ x + d.B @ u
    size = 1.0 + np.abs(right).max(initial=0.0) + np.abs(rates).max(initial=0.0)
    residual = right - d.E[:, :nz] @ rates
    if kept:
        s = np.linalg.lstsq(d.A[:, nz:], -residual, rcond=1e-11)[0]
        residual = residual + d.A[:, nz:] @ s
    assert np.abs(residual).max(initial=0.0) <= TOLERANCE * size, (mode, residual)
    # only these rates: with the derivatives of the rows that have none
    if not len(left):
        return
    silent = null_space(left.T)
    hidden = silent.T @ d.A[:, :nz]
    whole = np.vstack([left, np.hstack([hidden, np.zeros((len(hidden), kept))])])
    target = np.concatenate([right, -silent.T @ d.B @ udot])
    loose = null_space(whole, rcond=1e-9)
    assert np.linalg.matrix_rank(loose[:nz], tol=1e-7) == np.linalg.matrix_rank(moved, tol=1e-7)
    if not np.abs(loose[:nz]).max(initial=0.0) > 1e-7:
        found = np.linalg.lstsq(whole, target, rcond=1e-11)[0][:nz]
        np.testing.assert_allclose(found, rates, rtol=1e-6, atol=1e-6 * size)


def check_junctions(jsm, graph, mode, rng) -> None:
    """What elements give and receive at a point of the mode satisfies Q t = S g."""
    point = point_of(graph, mode, rng)
    bonds = len(graph.bonds)

    def port(own, gives: bool) -> float:
        end = next(e for e in graph.nodes[own.index].ends if e.port == own.port)
        effort = (jsm.imposes[own.index, own.port] == "e") == gives
        return point.w[end.bond] if effort else end.sign * point.w[bonds + end.bond]

    known, open_ = {}, []
    for k in range(jsm.form.rows.unknowns, jsm.form.rows.unknowns + len(jsm.form.rows.columns)):
        own = jsm.form.column(k)
        if own.kind == "rate":
            known[k] = point.rates[own.index]
        elif own.kind == "storage":
            known[k] = point.z[own.index]
        elif own.kind in ("resistor", "intake"):
            known[k] = port(own, own.kind == "resistor")
        elif own.kind == "source":
            known[k] = point.u[own.index]
    rows = [row.at(mode, jsm.form.ring) for row in jsm.rows]
    open_ = list(jsm.kept)
    residual = np.array(
        [sum(c * known[k] for k, c in row.items() if k not in open_) for row in rows]
    )
    size = 1.0 + np.abs(point.w).max(initial=0.0)
    if open_:
        a = np.array([[row.get(k, 0.0) for k in open_] for row in rows])
        residual = residual + a @ np.linalg.lstsq(a, -residual, rcond=1e-11)[0]
    assert np.abs(residual).max(initial=0.0) <= TOLERANCE * size


@pytest.mark.slow
@given(seed=st.integers(0, 10**6), size=st.integers(1, 8), rings=st.integers(0, 2))
@settings(SETTINGS, max_examples=80)
def test_junction_structure_matrix(seed, size, rings) -> None:
    net = random_net(seed, size, rings=rings, controlled=0.5, timed=1.0)
    if not net.bonds:
        return
    graph = hybrid_model(net, seed).flatten()
    rng = np.random.default_rng(seed)
    jsm = hb.junction_matrix(graph, symbolic=False)
    for mode in modes_of(graph, rng):
        check_junctions(jsm, graph, mode, rng)


def check(seed: int, size: int, rings: int, *, symbolic: bool) -> None:
    net = random_net(seed, size, rings=rings, controlled=0.5, timed=1.0)
    if not net.bonds:
        return
    graph = hybrid_model(net, seed).flatten()
    rng = np.random.default_rng(seed)
    reference = tuple(int(rng.integers(len(m.states))) for m in graph.machines)
    eq = state_equations(graph, reference=reference, symbolic=symbolic)
    for mode in modes_of(graph, rng):
        check_mode(eq, graph, mode, rng)


@pytest.mark.slow
@given(seed=st.integers(0, 10**6), size=st.integers(1, 8), rings=st.integers(0, 2))
@SETTINGS
def test_numbers(seed, size, rings) -> None:
    check(seed, size, rings, symbolic=False)


@pytest.mark.slow
@given(seed=st.integers(0, 10**6), size=st.integers(1, 6), rings=st.integers(0, 1))
@SETTINGS
def test_symbols(seed, size, rings) -> None:
    check(seed, size, rings, symbolic=True)


@pytest.mark.sampled(9)
@pytest.mark.parametrize("seed", range(20))
def test_symbols_and_numbers_agree(seed) -> None:
    net = random_net(seed, 6, rings=1, controlled=0.5)
    graph = hybrid_model(net, seed).flatten()
    a = state_equations(graph, reference=graph.start_mode, symbolic=True)
    b = state_equations(graph, reference=graph.start_mode, symbolic=False)
    rng = np.random.default_rng(seed)
    for mode in modes_of(graph, rng):
        try:
            one = a.at(mode).poles()
        except hb.EquationError:
            with pytest.raises(hb.EquationError):
                b.at(mode).poles()
            continue
        two = b.at(mode).poles()
        assert len(one) == len(two)
        np.testing.assert_allclose(np.poly(two), np.poly(one), rtol=1e-6, atol=1e-9)


def nonlinear_net(seed: int, size: int) -> Net:
    return random_net(seed, size, rings=1, controlled=0.4, nonlinear=0.6, timed=1.0)


@pytest.mark.slow
@given(seed=st.integers(0, 10**6), size=st.integers(1, 6))
@settings(SETTINGS, max_examples=60)
def test_nonlinear_laws(seed, size) -> None:
    """At a state that a run visits, each row holds with the laws' values put in."""
    net = nonlinear_net(seed, size)
    if not net.bonds:
        return
    model = net.model()
    try:
        run = hb.simulate(model, until=0.2, rtol=1e-10)
    except hb.CausalityError as error:
        assert error.code in ("HB-C101", "HB-C104")
        return
    segment = run.segments[-1]
    t = float(segment.t[-1])
    y = segment.at(t)
    equations = run.program.equations(segment.mode, segment.interval, t)
    v = run.program.evaluate(t, y, segment.interval, equations)
    slots = run.program.slots.index
    graph = run.graph
    eq = state_equations(graph, reference=graph.start_mode, symbolic=bool(seed % 2))
    values = {name: v[k] for name, k in slots.items()}
    bonds = len(graph.bonds)

    def number(e) -> float:
        known = {**eq.values, **values}
        order = sorted(hb_names(e))
        index = {name: k for k, name in enumerate(order)}
        return compile_expression(e, index, pre_offset=0)([known[n] for n in order])

    def column(k: int) -> float:
        kind, j = eq.place[k]
        if kind in ("rate", "state") and j < len(graph.storages):
            s = graph.storages[j]
            if kind == "state":
                return v[slots[f"x:{j}"]]
            return v[slots[f"f:{s.bond}"]] * s.sign if s.kind == "C" else v[slots[f"e:{s.bond}"]]
        if kind == "state":
            return switch_value(k)
        own = eq.column(k)
        return number(eq.storage_law(own.index) if own.kind == "storage" else own.formula)

    def switch_value(k: int) -> float:
        own = eq.form.column(k)
        if own is None:
            return v[slots[f"{'e' if k < bonds else 'f'}:{k % bonds}"]]
        node = graph.nodes[own.index]
        on = node.index in graph.on_nodes(eq.reference)
        common, net_ = ("e", "f") if node.kind == "0" else ("f", "e")
        if not on:
            return v[slots[f"{common}:{node.ends[0].bond}"]]
        return sum(end.sign * v[slots[f"{net_}:{end.bond}"]] for end in node.ends)

    for row in eq.rows:
        terms = [
            (c.evaluate(eq.values) if hasattr(c, "evaluate") else c) * column(k)
            for k, c in row.at(segment.mode, eq.ring).items()
        ]
        assert abs(sum(terms)) <= 1e-8 * (1.0 + sum(abs(x) for x in terms))


@pytest.mark.slow
@given(seed=st.integers(0, 10**6), size=st.integers(2, 7))
@settings(SETTINGS, max_examples=40)
def test_order_of_elements_does_not_matter(seed, size) -> None:
    """Poles of each solvable mode, whatever order elements and bonds were added in."""
    net = random_net(seed, size, rings=1, controlled=0.5)
    if not net.bonds:
        return
    first, second = (net.model(order).flatten() for order in (None, seed + 1))
    assert first.machines == () or first.machines[0].states == second.machines[0].states
    one, two = (state_equations(g, symbolic=False) for g in (first, second))
    for k in range(len(first.machines[0].states) if first.machines else 1):
        mode = (k,) if first.machines else ()
        try:
            a = one.at(mode).poles()
        except hb.EquationError:
            with pytest.raises(hb.EquationError):
                two.at(mode).poles()
            continue
        b = two.at(mode).poles()
        assert len(a) == len(b)
        # a cluster of poles is as sharp as rounding lets it be
        np.testing.assert_allclose(np.poly(b), np.poly(a), rtol=1e-5, atol=1e-6)
