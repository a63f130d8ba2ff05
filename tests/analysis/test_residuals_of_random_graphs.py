"""Residuals against what elements say, by dense algebra, on random graphs with switches.

Mode by mode that gives every consistent point and its derivatives. There all
residuals vanish; with another value of a parameter, a machine in another state or something added
to a sensor or source, exactly those are not zero that the signature matrix names.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.linalg import null_space

import hybond as hb
from hybond.analysis.residuals.residuals import Residuals, residuals
from hybond.equations.element_parts import parameter_values
from hybond.model.expressions import Number, names, simplify, substitute
from hybond.model.laws import Law

sys.path.insert(0, str(Path(__file__).parents[1] / "property"))
from dense_oracle import random_net
from test_mixed_boolean import hybrid_model, linear_rows, modes_of

SETTINGS = settings(
    max_examples=30,
    derandomize=True,
    deadline=None,
    database=None,
    suppress_health_check=list(HealthCheck),
)
TOLERANCE = 1e-8
ORDERS = 8


class Jets:
    """Derivatives of all sensors and sources at a random consistent point of one mode.

    What elements say of bond variables w and of what is stored is ``A (w, x) = B u``; left null
    vectors of the columns of w give constraints on x and u, whose derivatives give rates.
    """

    def __init__(self, graph, mode, rng, sensors) -> None:
        A, B, given, Y, _ = linear_rows(graph, mode)
        bonds, nz, nu = len(graph.bonds), len(graph.storages), len(given)
        nw = 2 * bonds
        A_w, A_x, Y = A[:, :nw], A[:, nw:], Y[:nz, :nw]
        silent = _exactly(null_space(A_w.T, rcond=1e-10)).T
        L, M = _exactly(silent @ A_x), _exactly(silent @ B)
        whole = np.vstack([A_w, L @ Y])
        self.free = null_space(whole, rcond=1e-10).shape[1] > 0
        # rows among sources alone: agreements, and what is OFF gives nothing
        off = graph.off_nodes(mode)
        null = [np.eye(nu)[k] for k, n in enumerate(given) if n in off]
        alone = null_space(L.T, rcond=1e-10).T @ M if len(L) else np.zeros((0, nu))
        among = np.vstack([_exactly(alone), *null])
        inside = null_space(among, rcond=1e-10) if len(among) else np.eye(nu)
        u = [inside @ (inside.T @ rng.normal(size=nu)) for _ in range(ORDERS + 2)]
        x = rng.normal(size=nz)
        if len(L):
            x -= np.linalg.lstsq(L, L @ x - M @ u[0], rcond=1e-10)[0]
            assert np.abs(L @ x - M @ u[0]).max(initial=0.0) < 1e-9
        self.data: dict[str, list[float]] = {}
        for order in range(ORDERS + 1):
            right = np.concatenate([B @ u[order] - A_x @ x, M @ u[order + 1]])
            w = np.linalg.lstsq(whole, right, rcond=1e-10)[0]
            if np.abs(whole @ w - right).max(initial=0.0) > 1e-9 * (1.0 + np.abs(right).max()):
                raise TooHigh
            prime = "'" * order
            for name, (kind, k) in sensors.items():
                at = {"e": w[:bonds], "f": w[bonds:], "x": x}[kind]
                self.data[name + prime] = at[k]
            for k, node in enumerate(given):
                # what an OFF source would give, it does not
                value = rng.normal() if node in off else u[order][k]
                self.data[graph.nodes[node].path + prime] = value
            x = Y @ w


class TooHigh(Exception):
    """One derivative of the constraints is not enough."""


def _exactly(m):
    return np.where(np.abs(m) <= 1e-12, 0.0, m)


def sensors_of(graph, rng) -> dict[str, tuple[str, int]]:
    """Return some signals: common variables of junctions, a bond, a stored quantity."""
    found = {}
    for node in graph.nodes:
        if node.is_junction and not node.hidden and node.ends and rng.random() < 0.6:
            kind = "e" if node.kind == "0" else "f"
            found[f"{node.path}.{kind}"] = (kind, node.ends[0].bond)
    for s in graph.storages:
        if rng.random() < 0.2:
            found[s.path] = ("x", s.index)
    named = [b for b in graph.bonds if not any(graph.nodes[n].hidden for n in (b.tail, b.head))]
    bond = named[int(rng.integers(len(named)))] if named else graph.bonds[0]
    kind = "ef"[int(rng.integers(2))]
    found[f'"{bond.name}".{kind}'] = (kind, bond.index)
    return found


def made(seed: int, size: int, rings: int):
    net = random_net(seed, size, rings=rings, controlled=0.5, timed=1.0)
    if not net.bonds:
        return None
    rng = np.random.default_rng([seed, 7])
    graph = hybrid_model(net, seed).flatten()
    sensors = sensors_of(graph, rng)
    try:
        found = residuals(graph, sensors=list(sensors))
    except hb.HybondError as error:
        assert error.code in ("HB-A304", "HB-Q104"), error
        return None
    return graph, sensors, found, rng


def jets(graph, mode, rng, sensors):
    try:
        return Jets(graph, mode, rng, sensors)
    except TooHigh:
        return None


def worst(found: Residuals, mode, data) -> dict[str, float]:
    values = found.evaluate(data, mode=mode)
    return {r.name: float(abs(values[r.name][0]) / (1.0 + values.sizes[r.name][0])) for r in found}


@pytest.mark.slow
@given(seed=st.integers(0, 10**6), size=st.integers(1, 8), rings=st.integers(0, 2))
@SETTINGS
def test_they_vanish_at_every_consistent_point(seed, size, rings) -> None:
    case = made(seed, size, rings)
    if case is None:
        return
    graph, sensors, found, rng = case
    for mode in modes_of(graph, rng):
        point = jets(graph, mode, rng, sensors)
        if point is None:
            continue
        for name, size_ in worst(found, mode, point.data).items():
            assert size_ <= TOLERANCE, (mode, name, found[name].text(mode))


def faulty_graph(graph, key: str):
    """Return the plant with another value of one parameter."""
    values = parameter_values(graph)
    values[key] *= 1.7
    numbers = {name: Number(v) for name, v in values.items()}

    def put(e):
        return simplify(substitute(e, {n: numbers[n] for n in names(e) if n in numbers}))

    nodes = []
    for node in graph.nodes:
        if node.law is not None and not node.is_junction:
            law = graph.parametric(node.index)
            matrix = law.matrix and tuple(tuple(put(e).value for e in row) for row in law.matrix)
            node = replace(node, law=Law(node.law.output, tuple(map(put, law.expressions)), matrix))
        nodes.append(node)
    return replace(graph, nodes=tuple(nodes))


@pytest.mark.slow
@given(seed=st.integers(0, 10**6), size=st.integers(1, 5), rings=st.integers(0, 1))
@SETTINGS
def test_they_react_to_what_the_signatures_say(seed, size, rings) -> None:
    case = made(seed, size, rings)
    if case is None:
        return
    graph, sensors, found, rng = case
    modes = modes_of(graph, rng)[:3]
    signatures = found.signatures(modes=modes)
    for m, mode in enumerate(modes):
        for k, fault in enumerate(signatures.faults):
            if not signatures.applies[m, k]:
                continue
            plant, plant_mode = graph, mode
            if fault.kind == "parameter":
                plant = faulty_graph(graph, fault.key)
            elif fault.kind == "switch":
                plant_mode = (*mode[: fault.machine], fault.state, *mode[fault.machine + 1 :])
            point = jets(plant, plant_mode, rng, sensors)
            if point is None:
                continue
            if fault.kind in ("sensor", "source"):
                for order in range(ORDERS + 1):
                    name = fault.name + "'" * order
                    if name in point.data:
                        point.data[name] += rng.normal()
            for j, (name, size_) in enumerate(worst(found, mode, point.data).items()):
                what = (mode, fault.name, name, found[name].text(mode))
                if not signatures.reacts[m, k, j]:
                    assert size_ <= TOLERANCE, what
                elif found.complete and not point.free:
                    assert size_ > 100 * TOLERANCE, what


@pytest.mark.slow
@given(seed=st.integers(0, 10**6), size=st.integers(1, 5), rings=st.integers(0, 1))
@settings(SETTINGS, max_examples=40)
def test_nothing_that_holds_is_missing(seed, size, rings) -> None:
    """Points span all that residuals and their derivatives allow, in values and derivatives."""
    case = made(seed, size, rings)
    if case is None:
        return
    graph, sensors, found, rng = case
    if not found.complete:
        return
    order = max(r.order for r in found)
    most = ORDERS + 1
    for mode in modes_of(graph, rng)[:3]:
        first = jets(graph, mode, rng, sensors)
        if first is None or first.free:
            continue
        own = [r.at(mode) for r in found]
        off = {graph.nodes[k].path for k in graph.off_nodes(mode)}
        known = [n for n in first.data if "'" not in n and n not in off]
        low = [n + "'" * k for n in known for k in range(order + 1)]
        count = len(low) + 2
        points = [jets(graph, mode, rng, sensors).data for _ in range(count)]
        cloud = [[point[n] for n in low] for point in points]
        # what residuals and their derivatives say about the low orders alone
        every = low + [n + "'" * k for n in known for k in range(order + 1, most + order)]
        at = {n: k for k, n in enumerate(every)}
        rows = []
        for row in own:
            for shift in range(most):
                if any(n.split("'")[0] in off for n in row):
                    raise AssertionError("an OFF source is read")
                line = np.zeros(len(every))
                for n, c in row.items():
                    line[at[n + "'" * shift]] = c
                if row:
                    rows.append(line / np.abs(line).max())
        whole = np.array(rows).reshape(len(rows), len(every))
        mix = null_space(whole[:, len(low) :].T) if len(whole) else np.zeros((0, 0))
        said = mix.T @ whole[:, : len(low)] if len(whole) else np.zeros((0, len(low)))
        relations = np.linalg.matrix_rank(said, tol=1e-8) if said.size else 0
        scaled = np.array(cloud) / np.abs(cloud).max(axis=0).clip(min=1e-3)
        assert np.linalg.matrix_rank(scaled, tol=1e-9) + relations == len(low), mode
