"""A guard holds in a window about where something within it is zero, however narrow that is.

``x^8 < 1`` with x of a thousand at both ends of a step. Oracle: what is compared has its level at
distances that are known in closed form.
"""

from __future__ import annotations

import math

import pytest

import hybond as hb

SOLVERS = ["auto", "radau", "rk45", "exact"]
R = math.sqrt
FORMS: dict[str, list[float]] = {
    "{u}^8 < 1": [-1.0, 1.0],
    "1 - {u}^8 > 0": [-1.0, 1.0],
    "2^({u}^2) < 2": [-1.0, 1.0],
    "exp({u}^2) < 2": [-R(math.log(2.0)), R(math.log(2.0))],
    "exp(-{u}^2) > 0.5": [-R(math.log(2.0)), R(math.log(2.0))],
    "{u}^2*{u}^2 < 1": [-1.0, 1.0],
    "abs({u})^3 < 1": [-1.0, 1.0],
    "{u}^8 + {u}^2 < 2": [-1.0, 1.0],
    "cosh({u}) < cosh(1)": [-1.0, 1.0],
    "1/{u}^2 > 1": [-1.0, 1.0],
    "log10(1 + {u}^4) < log10(2)": [-1.0, 1.0],
    "max({u}, -3*{u})^6 < 1": [-1.0 / 3.0, 1.0],
    "abs(abs({u}) - 3) < 1": [-4.0, -2.0, 2.0, 4.0],
    "abs({u}^2 - 1) < 0.5": [-R(1.5), -R(0.5), R(0.5), R(1.5)],
    "abs({u} - 1)*abs({u} + 1) < 0.5": [-R(1.5), -R(0.5), R(0.5), R(1.5)],
    "exp({u}) > 0.5 and exp({u}) < 2": [-math.log(2.0), math.log(2.0)],
    "exp({u}) + exp(-{u}) < 2*cosh(1)": [-1.0, 1.0],
    "tanh({u} + 1) - tanh({u} - 1) > tanh(2)": [-1.0, 1.0],
}
"""Guards, and between which values of u they hold."""


def watched(guard: str) -> dict[str, object]:
    """Return the machine that is in the window or out of it."""
    rules = [f"out -> in when {guard}", f"in -> out when not ({guard})"]
    return {"states": {"out": [], "in": []}, "start": "out", "rules": rules}


def times(run: hb.Result) -> list[float]:
    return [event.t for event in run.events if event.t > 0.0]


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize(("at", "width"), [(3.1, 2e-2), (6.7, 1e-3)])
@pytest.mark.parametrize("form", list(FORMS))
@pytest.mark.sampled(3)
def test_a_window_that_a_ramp_goes_through_within_a_step(
    form: str, at: float, width: float, solver: str
) -> None:
    way = 1.0 if at < 5.0 else -1.0
    m = hb.Model("window", domain="electrical")
    m.add(S=hb.Sf(f"{way} A"), n=hb.Zero(), C=hb.C("1 F"))
    m.bond("S -> n -> C")
    m.machine("W", **watched(form.format(u=f"((C.e/(1 V) - {way * at})/{width})")))
    expected = sorted(at + way * width * u for u in FORMS[form])
    assert times(hb.simulate(m, until=10.0, solver=solver)) == pytest.approx(expected, abs=1e-7)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("form", ["{u}^8 < 1", "{u}^8 + {u}^2 < 2", "abs(abs({u}) - 3) < 1"])
def test_a_window_that_a_charge_passes_on_its_way_to_rest(form: str, solver: str) -> None:
    """What the power is from afar says nothing of whether it comes to rest in the window."""
    at, width = 0.979, 1e-4
    m = hb.Model("charge", domain="electrical")
    m.add(S=hb.Se("1 V"), j=hb.One(), R=hb.R("5 mohm"), C=hb.C("1 F"))
    m.bond("S -> j -> C", "j -> R")
    m.machine("W", **watched(form.format(u=f"((C.e/(1 V) - {at})/{width})")))
    expected = [-5e-3 * math.log(1.0 - at - width * u) for u in FORMS[form]]
    run = hb.simulate(m, until=0.04, solver=solver)
    assert times(run) == pytest.approx(expected, abs=4e-8)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", ["auto", "radau", "rk45"])
@pytest.mark.parametrize("translational", [False, True])
@pytest.mark.parametrize(
    "form", ["{u}^8 < 1", "2^({u}^2) < 2", "exp({u}) + exp(-{u}) < 2*cosh(1)", "1/{u}^2 > 1"]
)
def test_a_law_lets_through_what_its_window_is_wide(
    form: str, translational: bool, solver: str
) -> None:
    """One side of the comparison overflows on both sides of it."""
    width = 4e-3
    if translational:
        m = hb.Model("law", domain="translational")
        m.add(A=hb.I("1 kg", f="-4.3 m/s"), nA=hb.One(), SA=hb.Se("1 N"))
        m.add(B=hb.I("1 kg"), nB=hb.One())
        window = form.format(u=f"((A.f/(1 [m/s]))/{width})")
        m.add(SB=hb.Se(f"1 N*(if {window} then 1 else 0)"))
    else:
        m = hb.Model("law", domain="electrical")
        m.add(A=hb.C("1 F", e="-4.3 V"), nA=hb.Zero(), SA=hb.Sf("1 A"))
        m.add(B=hb.C("1 F"), nB=hb.Zero())
        window = form.format(u=f"((A.e/(1 V))/{width})")
        m.add(SB=hb.Sf(f"1 A*(if {window} then 1 else 0)"))
    m.bond("SA -> nA -> A", "SB -> nB -> B")
    run = hb.simulate(m, until=10.0, solver=solver)
    assert run.final["B.p" if translational else "B.q"] == pytest.approx(2.0 * width, rel=1e-6)
