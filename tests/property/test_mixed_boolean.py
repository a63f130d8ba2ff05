"""Mixed-Boolean equations against what elements say in a mode, by dense algebra, mode by mode.

The mixed-Boolean form knows only one form for all modes. At random points that satisfy what the
elements of a mode say, rates must satisfy the form, and be the only ones that do.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
import pytest
from dense_oracle import Net, random_net
from engine.laws_put_back import Laws, laws_of
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.linalg import null_space

import hybond as hb
from hybond.equations.derive import state_equations
from hybond.equations.state_form import StateEquations
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
    """Values that satisfy a mode, found from what its elements say by dense algebra."""

    x: np.ndarray
    z: np.ndarray
    u: dict[int, float]
    du: dict[int, float]
    w: np.ndarray
    rates: np.ndarray
    moved: np.ndarray


def values_in(graph, laws: Laws, mode) -> list[float]:
    """Return values of nothing but the mode."""
    v = [0.0] * (2 * laws.size)
    on = graph.on_nodes(mode)
    for n in graph.nodes:
        if n.controlled:
            v[laws.index[f"on:{n.index}"]] = float(n.index in on)
    for m, k in zip(graph.machines, mode, strict=True):
        v[laws.index[f"in:{m.index}:{k}"]] = 1.0
    return v


def linear_rows(graph, mode) -> tuple[np.ndarray, np.ndarray, list[int], np.ndarray, np.ndarray]:
    """Return what elements say as ``A (w, x) = B u``, the sources, and rates and z by (w, x)."""
    laws = laws_of(graph)
    v = values_in(graph, laws, mode)
    sources = [n for n in graph.nodes if n.kind in ("Se", "Sf")]
    # a source that follows what is stored or flows is a law like others
    given = [
        n.index
        for n in sources
        if not any(name[:2] in ("e:", "f:") for e in n.law.expressions for name in hb_names(e))
    ]
    off = graph.off_nodes(mode)

    def said(v) -> list[float]:
        found = laws.off(v, mode, apart=set(given))
        return [a for a, _ in found.values()]

    nb = len(graph.bonds)
    names = [f"{kind}:{b}" for kind in "ef" for b in range(nb)]
    names += [f"x:{s.index}" for s in graph.storages]
    zero, rates_0, z_0 = np.array(said(v)), laws.rates(v), co_energies(graph, laws, v)
    columns, rates, z = [], [], []
    for name in names:
        v[laws.index[name]] = 1.0
        columns.append(np.array(said(v)) - zero)
        rates.append(laws.rates(v) - rates_0)
        z.append(co_energies(graph, laws, v) - z_0)
        v[laws.index[name]] = 0.0
    assert not np.abs(zero).max(initial=0.0)
    A = np.array(columns).T.reshape(len(zero), len(names))
    extra = np.zeros((len(given), len(names)))
    B = np.zeros((len(zero) + len(given), len(given)))
    for k, node in enumerate(given):
        end = graph.nodes[node].ends[0]
        extra[k, end.bond + (nb if graph.nodes[node].kind == "Sf" else 0)] = 1.0
        B[len(zero) + k, k] = 0.0 if node in off else 1.0
    return np.vstack([A, extra]), B, given, np.array(rates).T, np.array(z).T


def co_energies(graph, laws: Laws, v) -> np.ndarray:
    return np.array([laws.laws[s.node][s.port](v) for s in graph.storages])


def point_of(graph, mode, rng) -> Point:
    A, B, given, Y, Z = linear_rows(graph, mode)
    nw, nx, nu = 2 * len(graph.bonds), len(graph.storages), len(given)
    Y, Z = Y[:nx, :nw], Z[:, nw:]
    silent = null_space(A[:, :nw].T, rcond=1e-10).T if nw else np.zeros((0, len(A)))
    # constraints L x = M u, and the same of rates; what is OFF drives nothing
    L, M = silent @ A[:, nw:], silent @ B
    off = graph.off_nodes(mode)
    null = np.eye(nu)[[k for k, n in enumerate(given) if n in off]]
    x, u, w, du = (slice(0, nx), slice(nx, nx + nu), slice(nx + nu, nx + nu + nw), slice(-nu, None))
    if not nu:
        du = slice(nx + nw, nx + nw)
    # what is the same at all times has no rate
    constant = [not any(hb_names(e) for e in graph.nodes[n].law.expressions) for n in given]
    still = np.eye(nu)[[k for k, n in enumerate(given) if n in off or constant[k]]]
    rows = np.zeros((len(A) + len(L) + len(null) + len(still), nx + 2 * nu + nw))
    first, second = len(A), len(A) + len(L)
    rows[:first, w], rows[:first, x], rows[:first, u] = A[:, :nw], A[:, nw:], -B
    rows[first:second, w], rows[first:second, du] = L @ Y, -M
    rows[second : second + len(null), u] = null
    rows[second + len(null) :, du] = still
    scale = np.abs(rows).max(axis=1, initial=0.0, keepdims=True)
    basis = null_space(rows / np.where(scale > 0.0, scale, 1.0), rcond=1e-10)
    point = basis @ (basis.T @ rng.normal(size=rows.shape[1]))
    loose = null_space(np.vstack([A[:, :nw], L @ Y]), rcond=1e-10)
    point[w] -= loose @ (loose.T @ point[w])  # of what is not determined, the least
    return Point(
        x=point[x],
        z=Z @ point[x],
        u=dict(zip(given, point[u])),
        du=dict(zip(given, point[du])),
        w=point[w],
        rates=Y @ point[w],
        moved=Y @ loose,
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


@pytest.mark.sampled(3)
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
    graph = run.graph
    laws = laws_of(graph)
    slots, v = laws.index, values_in(graph, laws, run.segments[-1].mode)
    t = run.t_end
    v[slots["time"]] = t
    for s in graph.storages:
        v[slots[f"x:{s.index}"]] = run[s.path].at(t)
    for bond in graph.bonds:
        for kind in "ef":
            v[slots[f"{kind}:{bond.index}"]] = run[f'"{bond.name}".{kind}'].at(t)
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
            for k, c in row.at(run.segments[-1].mode, eq.ring).items()
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
