"""Balls come to rest beside a relay that slides, and has nothing to do with them.

What a contact would carry at rest was asked of the modes around the surface with the laws as they
were in flight: no ball was put down, and where a second one came to rest the run ended.
"""

from __future__ import annotations

from typing import Literal

import pytest

import hybond as hb

Solver = Literal["auto", "rk45", "radau"]
PULL = 9.81


def balls(restitutions: list[float], first: bool) -> hb.Model:
    """Return balls thrown up from the floor, the k-th with 1 + k m/s, and a relay at its level."""
    m = hb.Model("balls", domain="translational")
    bonds = []

    def add_relay() -> None:
        m.add(n=hb.Zero(), X=hb.C(1.0, q=-0.05), rub=hb.R(1e3))
        bonds.extend(["n -> X", "n -> rub"])
        m.add(S=hb.Sf('0.2 - (if k.state == "p" then 1 else -1)'))
        bonds.append("S -> n")
        rules = ["p -> m when X.q < 0", "m -> p when X.q > 0"]
        m.machine("k", states={"p": [], "m": []}, start="m", rules=rules)

    if first:
        add_relay()
    for k, restitution in enumerate(restitutions):
        contact = hb.Zero(law="unilateral", gap=f"h{k}", restitution=restitution)
        m.add(**{f"M{k}": hb.I(1.0, p=1.0 + k), f"W{k}": hb.Se(-PULL), f"v{k}": hb.One()})
        m.add(**{f"c{k}": contact})
        bonds += [f"W{k} -> v{k} -> M{k}", f"c{k} -> v{k}"]
        m.signal(**{f"h{k}": hb.Integral(f"v{k}.f", start=0.0)})
    if not first:
        add_relay()
    m.bond(*bonds)
    return m


@pytest.mark.parametrize("first", [False, True], ids=["after", "before"])
@pytest.mark.parametrize("restitutions", [[0.3], [0.3, 0.5], [0.8, 0.8], [0.3, 0.5, 0.4]], ids=str)
@pytest.mark.parametrize("solver", ["auto", "rk45", "radau"])
def test_each_lands_when_it_would_alone(
    restitutions: list[float], solver: Solver, first: bool
) -> None:
    until = 2.5
    run = hb.simulate(balls(restitutions, first), until, solver=solver)
    assert run.status == "ok"
    ends = [2.0 * (1.0 + k) / (PULL * (1.0 - e)) for k, e in enumerate(restitutions)]
    landed = {a.machine: a.t for a in run.accumulations if a.landed}
    for k, end in enumerate(ends):
        if end < until:
            assert landed[f"c{k}"] == pytest.approx(end, rel=1e-9)
            assert run[f"v{k}.f"].at(until) == 0.0
    assert run["X.q"].at(until) == pytest.approx(0.0, abs=1e-9)
    assert run.audit().holds()


@pytest.mark.parametrize("solver", ["auto", "rk45", "radau"])
def test_what_has_landed_leaves_as_it_is_lifted(solver: Solver) -> None:
    m = balls([0.3, 0.5], False)
    m.elements["W0"] = hb.Se(f"if time < 1.2 then -{PULL} else 2")
    run = hb.simulate(m, 1.7, solver=solver)
    assert run["v0.f"].at(1.7) == pytest.approx(1.0, rel=1e-9)
    assert run["h0"].at(1.7) == pytest.approx(0.25, rel=1e-8)
    assert run["h1"].at(1.7) == pytest.approx(0.0, abs=1e-9)
