"""Models in which nothing is stored yet: the size of things is that of what is about to push.

A source that passes through zero when a mode begins pushes by what rounding of the time leaves of
it; a difference taken of nothing has no digit beside a source; and beside a body at rest a law that
jumps there says nothing. None of this may depend on the method of integration.
"""

from __future__ import annotations

import math

import pytest

import hybond as hb

SOLVERS = ("rk45", "radau", "auto", "qss2")
CHARGED = [("C", 2.49, "diode"), ("C", 171.0, "unilateral"), ("I", 5.41, "diode")]


def rectified(kind: str, w: float, law: str) -> hb.Model:
    """A sine that first blocks; from pi/w on it drives a lag of first order."""
    m = hb.Model("rectified")
    m.add(s=hb.Se(f"-2*sin({w}*time)"), r=hb.R(1.5))
    if kind == "C":
        m.add(d=hb.One(law=law), c=hb.C(0.4))
        m.bond("d -> c", "s -> d", "d -> r")
    else:  # behind a gyrator a mass is a capacitor: 1/m = C/k^2
        m.add(d=hb.One(law=law), g=hb.GY(2.0), v=hb.One(), c=hb.I(1.6))
        m.bond("s -> d", "d -> r", "d -> g.1", "g.2 -> v", "v -> c")
    return m


@pytest.mark.parametrize("solver", SOLVERS[:3])
@pytest.mark.parametrize(("kind", "w", "law"), CHARGED)
def test_a_source_through_zero_into_what_was_never_charged(
    kind: str, w: float, law: str, solver: str
) -> None:
    run = hb.simulate(rectified(kind, w, law), 1.5 * math.pi / w, solver=solver)
    lag = 0.6 * w  # R C w
    name, size = ("c.q", 0.4) if kind == "C" else ("c.p", 0.8)
    for part in (0.01, 0.1, 0.3, 0.49):
        x = math.pi * part
        left = math.sin(x) - lag * math.cos(x) + lag * math.exp(-x / lag)
        expected = size * 2.0 / (1.0 + lag**2) * left
        at = (1.0 + part) * math.pi / w
        assert run[name].at(at) == pytest.approx(expected, rel=1e-5)
    assert run[name].at(0.9 * math.pi / w) == 0.0


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("law", [{"e": "0.85*sign(f)"}, {"f": "0.85*sign(e)"}])
@pytest.mark.parametrize("beside", ["one", "two", "gyrator"])
def test_rest_where_a_law_jumps_is_rest(law: object, beside: str, solver: str) -> None:
    # by e = 0.85 sign(f) nothing flows at e = 0, and nothing says what does at e = 1e-8
    m = hb.Model("rest")
    m.add(c=hb.C(1.06), j=hb.Zero(), r=hb.R(law), g=hb.G(0.61))
    m.bond("j -> c", "r -> j", "j -> g")
    if beside == "two":
        m.add(i=hb.I(2.0), k=hb.Zero())
        m.bond("j -> i")
    elif beside == "gyrator":
        m.add(t=hb.GY(-0.5), v=hb.One(), i=hb.C(3.0, q=0.0), h=hb.R(2.0))
        m.bond("j -> t.1", "t.2 -> v", "v -> i", "v -> h")
    run = hb.simulate(m, 1.0, solver=solver)
    assert run.status == "ok"
    assert run["c.q"].at(1.0) == 0.0


@pytest.mark.parametrize("solver", SOLVERS[:3])
@pytest.mark.parametrize("size", [640.9, 1.0, 1e-6, 1e6])
def test_an_empty_storage_of_any_size_takes_what_a_timed_source_gives(
    size: float, solver: str
) -> None:
    m = hb.Model("taken")
    m.add(s=hb.Se("18.8*(if time >= 0.5 then 1 else 0.2)"), j=hb.Zero(), c=hb.C(size))
    m.add(r=hb.R([[101.0, 8.39], [8.39, 1.65]]), f=hb.Sf("-8.33*sin(1160.0*time)"))
    m.bond("j -> r.1", "f -> j", "j -> s", "r.2 -> j", "j -> c")
    run = hb.simulate(m, 0.1, solver=solver)
    assert run["c.q"].at(0.1) == pytest.approx(size * 0.2 * 18.8, rel=1e-12)
