"""Residuals against the equations that a run solves, on random graphs with switches.

The run's tableau gives, mode by mode, every consistent point and its derivatives. There all
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
from hybond.equations.mode import prepare
from hybond.equations.parameters import parameter_values
from hybond.equations.slots import slots_of
from hybond.equations.tableau import build
from hybond.model.expressions import Number, names, simplify, substitute
from hybond.model.laws import Law

sys.path.insert(0, str(Path(__file__).parents[1] / "property"))
from dense_oracle import random_net
from test_mixed_boolean import hybrid_model, modes_of

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
    """Derivatives of all sensors and sources at a random consistent point of one mode."""

    def __init__(self, graph, mode, rng, sensors) -> None:
        tableau = build(graph, mode, {})
        own = prepare(graph, mode, slots_of(graph), tableau)
        assert own.linear
        self.free = own.freedom.shape[1] > 0
        bonds, nz, nu = len(graph.bonds), len(graph.storages), len(tableau.sources)
        base = tableau.unknowns
        off = graph.off_nodes(mode)
        null = [{base + nz + k: 1.0} for k, s in enumerate(tableau.sources) if s.node in off]
        among = _matrix(tableau.agreements + null, base, nz + nu)
        inside = null_space(among[:, nz:]) if len(among) else np.eye(nu)
        u = [inside @ (inside.T @ rng.normal(size=nu)) for _ in range(ORDERS + 2)]
        # stored quantities that fit the first values of the sources
        rows = _matrix(tableau.constraints, base, nz + nu)
        z = rng.normal(size=nz)
        if len(rows):
            z -= np.linalg.lstsq(rows[:, :nz], rows[:, :nz] @ z + rows[:, nz:] @ u[0], rcond=None)[
                0
            ]
            assert np.abs(rows @ np.concatenate([z, u[0]])).max() < 1e-9
        self.data: dict[str, list[float]] = {}
        x = np.linalg.solve(own.storage.matrix.dense(), z) if nz else z
        for order in range(ORDERS + 1):
            w = own.x2 @ np.concatenate([z, u[order], u[order + 1]])
            if own.project is not None:
                w = own.project @ w
            prime = "'" * order
            for name, (kind, k) in sensors.items():
                at = {"e": w[:bonds], "f": w[bonds:], "x": x}[kind]
                self.data[name + prime] = at[k]
            for k, s in enumerate(tableau.sources):
                # what an OFF source would give, it does not
                value = rng.normal() if s.node in off else u[order][k]
                self.data[graph.nodes[s.node].path + prime] = value
            x = own.storage.rates_of(w)
            z = own.storage.matrix.times(x)


def _matrix(rows, base, width):
    return np.array([[r.get(base + k, 0.0) for k in range(width)] for r in rows]).reshape(
        len(rows), width
    )


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
    except hb.HybondError as error:
        assert error.code == "HB-C103", error
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
