"""Rows of tanks with check valves between them, through pipes that are rough: each valve a law.

The oracle integrates the levels with the flow of each pipe in closed form. What ports do is asked
of many at once where they act on nothing together, so that its cost does not grow with the square
of the row.
"""

import cProfile
import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

AREA, ROUGH, LAMINAR, OUTLET = 1e-4, 1e9, 1e6, 1e7
UNTIL = 40.0


def levels(many: int) -> list[float]:
    """Return the pressures at the start: some valves are open at first, some shut."""
    return [5e3 + 4e3 * math.sin(2.3 * k) for k in range(many)]


def row(many: int, order: str) -> hb.Model:
    """Return a row of tanks that is filled at one end and drained at the other."""
    m = hb.Model("row", domain="hydraulic")
    start = levels(many)
    tanks = range(many) if order != "backwards" else range(many - 1, -1, -1)
    for k in tanks:
        m.add(**{f"z{k}": hb.Zero(), f"c{k}": hb.C(AREA, e=start[k])})
        m.bond(f"z{k} -> c{k}")
    for k in tanks:
        if k == 0:
            continue
        pipe = hb.R({"e": f"{ROUGH}*f*abs(f) + {LAMINAR}*f"})
        m.add(**{f"d{k}": hb.One(law="diode"), f"r{k}": pipe})
        m.bond(f"z{k - 1} -> d{k} -> z{k}", f"d{k} -> r{k}")
    pump = "1e-3*(1 + sin(time/(10 s)))"
    m.add(pump=hb.Sf(f"-{pump}" if order == "turned" else pump), out=hb.R(OUTLET))
    m.bond("z0 -> pump" if order == "turned" else "pump -> z0", f"z{many - 1} -> out")
    return m


def oracle(many: int) -> np.ndarray:
    """Return the pressures at the end."""

    def rates(t: float, p: np.ndarray) -> np.ndarray:
        head = np.maximum(p[:-1] - p[1:], 0.0)
        flow = (np.sqrt(LAMINAR**2 + 4.0 * ROUGH * head) - LAMINAR) / (2.0 * ROUGH)
        into = np.r_[1e-3 * (1.0 + math.sin(t / 10.0)), flow]
        return np.asarray((into - np.r_[flow, p[-1] / OUTLET]) / AREA)

    found = solve_ivp(rates, (0.0, UNTIL), levels(many), method="LSODA", rtol=1e-11, atol=1e-7)
    return np.asarray(found.y[:, -1])


@pytest.mark.parametrize("solver", ["auto", "radau", "rk45"])
@pytest.mark.parametrize("order", ["along", "backwards", "turned"])
@pytest.mark.parametrize("many", [3, 9, 24])
def test_valves_open_and_shut_as_levels_say(many: int, order: str, solver: str) -> None:
    run = hb.simulate(row(many, order), UNTIL, solver=solver)
    assert run.status == "ok"
    assert run.audit().holds()
    found = [run.final[f"c{k}.e"] for k in range(many)]
    assert found == pytest.approx(oracle(many).tolist(), rel=2e-7)


def test_two_rows_beside_each_other_are_as_one_alone() -> None:
    m = hb.Model("rows", domain="hydraulic")
    for name in ("a", "b"):
        m.add(**{name: hb.Submodel(row(8, "along"))})
    run = hb.simulate(m, UNTIL)
    expected = oracle(8).tolist()
    for name in ("a", "b"):
        found = [run.final[f"{name}.c{k}.e"] for k in range(8)]
        assert found == pytest.approx(expected, rel=2e-7)


def test_twice_as_many_valves_are_not_tried_twice_as_often() -> None:
    few, many = (_tried_at_the_start(n) for n in (6, 12))
    assert many <= few + 4


def _tried_at_the_start(many: int) -> int:
    """Return how often the open graph of a row at rest was solved for."""
    graph = row(many, "along").flatten()
    with cProfile.Profile() as profile:
        hb.simulate(graph, 1e-9, engine="python")
    return sum(
        entry.callcount
        for entry in profile.getstats()
        if not isinstance(entry.code, str) and entry.code.co_name == "solve_with"
    )
