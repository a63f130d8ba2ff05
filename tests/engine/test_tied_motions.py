"""Storages that constraints tie to sources of time: known at any instant, by closed forms."""

import math

import numpy as np
import pytest

import hybond as hb

W = math.tau
WAVES = {
    "sine": ("100*sin(W*time)", lambda t: 100.0 * np.sin(W * t), math.asin(0.5) / W),
    "pulse": (
        "100/cosh(40*(time - 1.3))^2",
        lambda t: 100.0 / np.cosh(40.0 * (t - 1.3)) ** 2,
        1.3 - math.acosh(math.sqrt(2.0)) / 40.0,
    ),
    "ramp": ("40*time", lambda t: 40.0 * t, 1.25),
}
COARSE = 1e-2
"""A tolerance of steps that says nothing about what is tied."""


def tied(wave: str, flow: bool, towards: bool, shared: bool) -> hb.Model:
    """Return a storage X of 0.5 whose signal `x` is a source's; `shared` with Y of 1.5, a quarter.

    A machine follows `x` over half of the peak.
    """
    m = hb.Model("tied", parameters={"W": W})
    source, storage = (hb.Sf, hb.I) if flow else (hb.Se, hb.C)
    m.add(S=source(wave), j=hb.One() if flow != shared else hb.Zero(), Y=storage(0.5))
    m.bond("S -> j" if towards else "j -> S", "j -> Y")
    if shared:
        m.add(X=storage(1.5))
        m.bond("j -> X")
    sign = 1.0 if towards or not shared else -1.0
    own = "X" if shared else "Y"
    m.signal(x=f"{sign * (4.0 if shared else 1.0)}*{own}.{'f' if flow else 'e'}")
    m.machine("M", states={"low": [], "high": []}, start="low", rules=["low -> high when x > 50"])
    return m


@pytest.mark.parametrize("shared", [False, True])
@pytest.mark.parametrize("towards", [True, False])
@pytest.mark.parametrize("flow", [True, False])
@pytest.mark.parametrize("wave", WAVES)
def test_what_sources_lead_is_where_they_are(
    wave: str, flow: bool, towards: bool, shared: bool
) -> None:
    """However coarse the steps: at the guard, between, and in its own digits where it is alone."""
    text, law, there = WAVES[wave]
    run = hb.simulate(tied(text, flow, towards, shared), until=3.0, rtol=COARSE)
    found = [e.t for e in run.events if e.cause != "start"]
    assert found == pytest.approx([there], rel=1e-12)
    at = np.linspace(0.0, 3.0, 97)
    assert run["x"].at(at) == pytest.approx(law(at), abs=1e-12)
    stored = float(run.final["Y.p" if flow else "Y.q"])
    if shared:
        assert abs(stored) == pytest.approx(abs(float(law(3.0))) * 0.375, abs=1e-12)
    else:
        assert stored == pytest.approx(0.5 * float(law(3.0)), rel=1e-15)


@pytest.mark.parametrize("towards", [True, False])
@pytest.mark.parametrize("beside", ["a resistor", "a current", "a second source"])
def test_what_flows_beside_it_counts(beside: str, towards: bool) -> None:
    """Two capacitors in series on a sine; their node is fed as well, or the other end moves."""
    m = hb.Model("fed", parameters={"W": W})
    m.add(S=hb.Se("100*sin(W*time)"), a=hb.Zero(), i=hb.One(), n=hb.Zero())
    m.add(X=hb.C(0.5), Y=hb.C(1.5))
    m.bond("S -> a -> i -> n" if towards else "S -> a", "i -> X", "n -> Y")
    if not towards:
        m.bond("n -> i -> a")
    if beside == "a resistor":
        m.add(R=hb.R(0.25))
        m.bond("n -> R")
    elif beside == "a current":
        m.add(F=hb.Sf(3.0))
        m.bond("F -> n")
    else:
        m.add(F=hb.Sf("3*cos(W*time)"))
        m.bond("F -> n")
    m.machine("M", states={"u": [], "o": []}, start="u", rules=["u -> o when n.e > 20"])
    run = hb.simulate(m, until=3.0, rtol=1e-9, atol=1e-12)

    def node(t: float) -> float:
        # (0.5 + 1.5) n' = 0.5 V' + what is fed
        if beside == "a current":
            return 25.0 * math.sin(W * t) + 1.5 * t
        if beside == "a second source":
            return (25.0 + 1.5 / W) * math.sin(W * t)
        lag = 2.0  # 1/(R (0.5 + 1.5))
        steady = 25.0 * W / (lag**2 + W**2)
        return steady * (lag * math.cos(W * t) + W * math.sin(W * t) - lag * math.exp(-lag * t))

    found = [e.t for e in run.events if e.cause != "start"]
    assert len(found) == 1 and node(found[0]) == pytest.approx(20.0, abs=1e-6)
    assert node(found[0] - 1e-3) < 20.0
    assert float(run["n.e"].at(3.0)) == pytest.approx(node(3.0), abs=1e-6)
