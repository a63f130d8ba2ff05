"""Water in pipes with turbulent losses: each flow is stored, and its loss said by it.

The loss ``k f |f|`` is flat where the flow is zero, and would be a root if it were read backwards.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb
from hybond.engine.engine import Engine
from hybond.engine.mode import solving
from hybond.engine.mode.mode_records import Mode
from hybond.engine.words import Floats

MASS, LOSS, CAPACITY, LEAK = 50.0, 2e3, 1e-4, 1e4


def pipe(sections: int, *, turned: bool, reverse: bool) -> hb.Model:
    """Return sections in a row behind a pressure that falls to nothing at 0.2 s."""
    m = hb.Model("pipe")
    elements = {"s": hb.Se("if time < 0.2 then 1e3 else 0"), "out": hb.R(LEAK)}
    bonds = []
    before = "s"
    for k in range(sections):
        elements |= {
            f"a{k}": hb.One(),
            f"i{k}": hb.I(MASS),
            f"r{k}": hb.R({"e": f"{LOSS}*f*abs(f)"}),
        }
        elements |= {f"n{k}": hb.Zero(), f"c{k}": hb.C(CAPACITY)}
        bonds += [f"{before} -> a{k}", f"r{k} -> a{k}" if turned else f"a{k} -> r{k}"]
        bonds += [f"a{k} -> i{k}", f"a{k} -> n{k}", f"n{k} -> c{k}"]
        before = f"n{k}"
    bonds.append(f"{before} -> out")
    m.add(**dict(reversed(elements.items())) if reverse else elements)
    m.bond(*(reversed(bonds) if reverse else bonds))
    return m


def expected(sections: int, until: float) -> np.ndarray:
    """Return the momenta, then what is stored, at the end."""

    def rates(_: float, y: np.ndarray, pressure: float) -> np.ndarray:
        f, e = y[:sections] / MASS, y[sections:] / CAPACITY
        push = np.append(pressure, e[:-1]) - LOSS * f * np.abs(f) - e
        return np.append(push, f - np.append(f[1:], e[-1] / LEAK))

    y = np.zeros(2 * sections)
    for begin, end, pressure in ((0.0, 0.2, 1e3), (0.2, until, 0.0)):
        found = solve_ivp(
            lambda t, y, p=pressure: rates(t, y, p),
            *((begin, end), y, "DOP853"),
            rtol=1e-12,
            atol=1e-15,
            max_step=1e-3,
        )
        y = found.y[:, -1]
    return y


@pytest.mark.parametrize("solver", ["auto", "rk45", "radau"])
@pytest.mark.parametrize(("turned", "reverse"), [(False, False), (True, False), (False, True)])
@pytest.mark.parametrize("sections", [1, 4, 12])
def test_flows_go_to_and_fro_as_they_do(
    sections: int, turned: bool, reverse: bool, solver: str
) -> None:
    run = hb.simulate(pipe(sections, turned=turned, reverse=reverse), 0.7, solver=solver)
    y = expected(sections, 0.7)
    names = [f"i{k}.p" for k in range(sections)] + [f"c{k}.q" for k in range(sections)]
    found = np.array([run.final[name] for name in names])
    sizes = np.repeat([np.abs(y[:sections]).max(), np.abs(y[sections:]).max()], sections)
    assert np.abs((found - y) / sizes).max() < 1e-7
    assert run.audit().holds()


def test_where_a_flow_turns_is_asked_without_solving_for_losses(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """At nine points of a step, and more where it turns, all losses were solved for."""
    solved = 0
    by_newton = solving.by_newton

    def counted(e: Engine, mode: Mode, v: Floats) -> int:
        nonlocal solved
        solved += 1
        return by_newton(e, mode, v)

    monkeypatch.setattr(solving, "by_newton", counted)
    run = hb.simulate(pipe(3, turned=False, reverse=False), 0.02, engine="python")
    assert solved < 9.0 * run.stats["steps"]
