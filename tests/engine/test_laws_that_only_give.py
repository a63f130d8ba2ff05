"""Laws that read what is known, and give a flow or an effort that no other law reads.

Within steps they are evaluated, and put back into themselves now and then: nothing is solved for.
Each run beside SciPy, and with the numbers of the model in other units, so that other terms round.
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

LAWS = {
    "root": ("sign(e)*sqrt(abs(e))", lambda e: np.sign(e) * np.sqrt(np.abs(e))),
    "cube": ("e + e^3", lambda e: e + e**3),
    "saturates": ("tanh(e)", np.tanh),
    "one way": ("if e > 0 then e^2 else 0.1*e", lambda e: np.where(e > 0, e**2, 0.1 * e)),
    "clipped": ("max(-0.2, min(0.3, e))", lambda e: np.clip(e, -0.2, 0.3)),
}


def row(law, n, *, turned=False, scale=1.0):
    """Capacitances in a row, charged by turns; each is joined to the next by a resistor."""
    m = hb.Model("row")
    for k in range(n):
        m.add(**{f"c{k}": hb.C(1.0 / scale, e=scale * (k % 3)), f"n{k}": hb.Zero()})
        m.bond(f"n{k} -> c{k}")
    for k in range(n - 1):
        inner = law.replace("e", f"(e/{scale})") if scale != 1.0 else law
        m.add(**{f"r{k}": hb.R({"f": inner}), f"j{k}": hb.One()})
        ends = (k + 1, k) if turned else (k, k + 1)
        m.bond(f"n{ends[0]} -> j{k} -> n{ends[1]}", f"j{k} -> r{k}")
    return m


def by_scipy(function, n, until, turned):
    def rates(_, e):
        drop = e[1:] - e[:-1] if turned else e[:-1] - e[1:]
        flow = function(drop) * (-1.0 if turned else 1.0)
        return np.append(-flow, 0.0) + np.append(0.0, flow)

    start = np.arange(n) % 3.0
    return solve_ivp(rates, (0, until), start, method="LSODA", rtol=1e-11, atol=1e-13).y[:, -1]


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("solver", ["rk45", "radau"])
@pytest.mark.parametrize("name", LAWS)
def test_rows_of_laws(name, solver, turned):
    law, function = LAWS[name]
    n, until = 9, 1.5
    run = hb.simulate(row(law, n, turned=turned), until=until, solver=solver)
    assert run.status == "ok" and run.audit().holds()
    efforts = [run[f"c{k}.e"].at(until) for k in range(n)]
    assert efforts == pytest.approx(by_scipy(function, n, until, turned), abs=3e-7)
    flows = [run[f"r{k}.f"].at(until) for k in range(n - 1)]
    drops = [run[f"r{k}.e"].at(until) for k in range(n - 1)]
    assert flows == pytest.approx(function(np.array(drops)), rel=1e-12, abs=1e-15)


@pytest.mark.parametrize("solver", ["rk45", "radau"])
def test_in_other_units(solver):
    """Of a flow that is linear in its scale: the same charges, whatever the efforts are called."""
    law, _ = LAWS["cube"]
    one = hb.simulate(row(law, 7), until=1.0, solver=solver)
    other = hb.simulate(row(law, 7, scale=1e6), until=1.0, solver=solver)
    for k in range(7):
        a, b = one[f"c{k}.q"].at(1.0), other[f"c{k}.q"].at(1.0)
        assert b == pytest.approx(a, rel=1e-7)


def test_a_law_that_gives_beside_one_that_is_solved_for():
    """The flow of a root is known; through the other one the effort is what a square leaves."""
    m = hb.Model("two")
    m.add(c=hb.C(2.0, e=3.0), n=hb.Zero(), V=hb.Se(1.0), i=hb.One())
    m.add(known=hb.R({"f": "e*sqrt(abs(e))"}), a=hb.R({"e": "f*abs(f)"}), b=hb.R(0.5))
    m.bond("n -> c", "n -> known", "n -> i", "i -> a", "i -> b", "i -> V")
    run = hb.simulate(m, until=1.0)

    def rates(_, y):
        e = y[0]
        drop = e - 1.0  # f^2 + f/2 = drop, where that is not negative
        f = (-0.5 + np.sqrt(0.25 + 4.0 * drop)) / 2.0
        return [(-e * np.sqrt(e) - f) / 2.0]

    end = solve_ivp(rates, (0, 1.0), [3.0], rtol=1e-11, atol=1e-13).y[0, -1]
    assert run["c.e"].at(1.0) == pytest.approx(end, rel=1e-8)


def test_within_steps_they_are_put_back_only_now_and_then(monkeypatch):
    asked, solved = [], []
    from hybond.engine.mode.nonlinear import solved_apart
    from hybond.engine.surfaces import values

    put_back, in_step = solved_apart.put_back, values.solve_in_step
    monkeypatch.setattr(solved_apart, "put_back", lambda *a: (asked.append(1), put_back(*a))[1])
    monkeypatch.setattr(values, "solve_in_step", lambda *a: (solved.append(1), in_step(*a))[1])
    run = hb.simulate(row(LAWS["cube"][0], 4), until=1.0, engine="python", solver="rk45")
    assert run.status == "ok" and len(solved) > 100
    assert len(solved) / 32 < len(asked) < len(solved) / 4
