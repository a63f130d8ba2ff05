"""Switched RC circuit for diagnosis (Yu, Wang & Luo 2014)."""

import numpy as np
import pytest

from hybond.engine.compiled.native import NativeModel
from hybond.engine.compiled.native_look import NativeLook
from hybond.engine.compiled.points import Points
from hybond.engine.tables import tables_of

V1, V2 = 9.0, 0.5
R1, R2, R3, R4, R5 = 670.0, 215.6, 67.5, 215.4, 509.0
C1, C2 = 1e-3, 4.7e-3
SEQUENCE = [(1, 0), (0, 0), (0, 1), (1, 1)]  # 5 s each
STATE = {0: "off", 1: "on"}


@pytest.mark.parametrize(
    ("switches", "equilibrium", "eigenvalues"),
    [
        ((0, 0), (9.000000, 9.000000), (-19.214595, -0.244846)),
        ((1, 0), (2.569332, 2.569332), (-23.267101, -0.830558)),
        ((0, 1), (4.875231, 4.459676), (-19.260205, -0.492949)),
        ((1, 1), (2.130501, 1.948901), (-23.297852, -1.093520)),
    ],
)
def test_mode(switches, equilibrium, eigenvalues, simulate):
    """The field of a mode is affine in the charges: three points give all of it."""
    graph = simulate("diagnosis_circuit", until=0.01).graph
    a1, a2 = switches
    mode = graph.mode_of({"S1": STATE[a1], "S2": STATE[a2]})
    look = NativeLook(NativeModel(tables_of(graph, until=1.0)))
    look.into(0.0, mode)
    assert [s.path for s in graph.storages] == ["C1.q", "C2.q"]
    flows = [look.model.tables.slots.index[f"f:{s.bond}"] for s in graph.storages]
    charges = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]
    rates = look.values(Points([0.0] * 3, charges), flows) * [s.sign for s in graph.storages]
    offset = rates[0]
    matrix = (rates[1:] - offset).T
    assert sorted(np.linalg.eigvals(matrix).real) == pytest.approx(eigenvalues, abs=6e-7)
    charges = np.linalg.solve(matrix, -offset)
    assert charges[0] / C1 == pytest.approx(equilibrium[0], abs=6e-7)
    assert charges[1] / C2 == pytest.approx(equilibrium[1], abs=6e-7)


def test_trajectory(simulate, solver):
    run = simulate("diagnosis_circuit", solver=solver)
    assert [e.t for e in run.events] == [0.0, 5.0, 10.0, 15.0]
    for t, de1, de2 in [
        (5.0, 2.538482, 2.527445),
        (10.0, 7.222821, 7.073148),
        (15.0, 5.082062, 4.680463),
        (20.0, 2.139514, 1.960979),
    ]:
        assert run["De1"].at(t) == pytest.approx(de1, abs=1.5e-6)
        assert run["De2"].at(t) == pytest.approx(de2, abs=1.5e-6)


def test_residuals_are_zero(simulate, solver):
    run = simulate("diagnosis_circuit", solver=solver)
    names = ["Df", "De1", "De2", "De3", "C1.f", "C2.f"]
    for k, (a1, a2) in enumerate(SEQUENCE):
        t = np.linspace(5.0 * k, 5.0 * (k + 1), 26)[:-1].tolist()
        df, de1, de2, de3, i1, i2 = run.sample(t, names).values()
        g1 = V1 - R1 * df - de1
        g2 = df + a1 / R2 * (V2 - de1) - i1 - (de1 - de2) / R3
        g3 = (de1 - de2) / R3 - i2 - a2 / R4 * (de2 - de3)
        g4 = a2 * ((de2 - de3) / R4 - de3 / R5)
        assert np.abs(g1).max() < 1e-12 * V1
        for residual in (g2, g3, g4):
            assert np.abs(residual).max() < 1e-14
        # the currents of the capacitors are the rates of the trajectory itself
        inner = np.array(t[1:])
        for name, i, c in (("De1", i1, C1), ("De2", i2, C2)):
            h = 1e-3
            ahead, behind = np.array(run[name].at(inner + h)), np.array(run[name].at(inner - h))
            assert c * (ahead - behind) / (2 * h) == pytest.approx(i[1:], rel=1e-3, abs=2e-8)
