"""Laws in which something is beyond all numbers though they are not: soft pluses, sigmoids, powers.

Oracles are SciPy's, with forms that do not overflow, and what a law gives once nothing moves.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import hybond as hb
from hybond.model.expressions import differentiate, parse

LAWS: dict[str, Callable[[float], float]] = {
    "log(1 + exp(100*(e - 0.5)))/100": lambda v: float(np.logaddexp(0.0, 100 * (v - 0.5))) / 100,
    "log(exp(1000*(e - 0.5)) + 1)/1000": lambda v: float(np.logaddexp(0.0, 1e3 * (v - 0.5))) / 1e3,
    "1/(1 + exp(-100*(e - 0.5)))": lambda v: 0.5 * (1.0 + math.tanh(50 * (v - 0.5))),
    "log(cosh(100*e))/100": lambda v: abs(v) + (math.log1p(math.exp(-200 * abs(v))) - LOG_2) / 100,
}
LOG_2 = math.log(2.0)


def filled(law: str, peak: float, series: float, back: bool) -> hb.Model:
    """A capacitor, behind a law and perhaps a resistor, that leaks."""
    m = hb.Model("filled")
    m.add(v=hb.Se(f"{peak}*sin(2*pi*time)"), d=hb.R({"f": law}), s=hb.One(), n=hb.Zero())
    m.add(c=hb.C(1.0), leak=hb.R(10.0))
    m.bond("v -> s -> n", "d -> s" if back else "s -> d", "n -> c", "n -> leak")
    if series:
        m.add(rs=hb.R(series))
        m.bond("s -> rs")
    return m


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize(("peak", "back"), [(3.0, False), (100.0, True)])
def test_a_law_has_its_value_where_it_is_a_number(law: str, peak: float, back: bool) -> None:
    way = -1.0 if back else 1.0
    meant = solve_ivp(
        lambda t, v: [way * LAWS[law](way * (peak * math.sin(2 * math.pi * t) - v[0])) - v[0] / 10],
        (0.0, 1.0),
        [0.0],
        rtol=1e-9,
        atol=1e-12,
        max_step=0.02,
        method="LSODA",
    ).y[0, -1]
    run = hb.simulate(filled(law, peak, 0.0, back), 1.0, max_steps=5000)
    assert run["c.e"].at(1.0) == pytest.approx(meant, rel=2e-6, abs=1e-7)


@pytest.mark.parametrize("back", [False, True])
@pytest.mark.parametrize(
    ("law", "of"),
    [
        (
            "log(1 + exp(100*(e - 0.5)))/100",
            lambda v: float(np.logaddexp(0, 100 * (v - 0.5))) / 100,
        ),
        ("1e-6*sinh(20*e)", lambda v: 1e-6 * math.sinh(20 * v)),
        ("1e-12*(exp(40*e) - 1)", lambda v: 1e-12 * math.expm1(40 * v)),
        ("1e-3*sign(e)*abs(e)^25", lambda v: 1e-3 * math.copysign(abs(v) ** 25, v)),
    ],
)
def test_a_resistor_beside_it_leaves_what_both_give(
    law: str, of: Callable[[float], float], back: bool
) -> None:
    """At the first instant: ``v - 0.1 i`` is what the law has ``i`` of."""
    m = filled(law, 0.0, 0.1, back)
    m.add(w=hb.Se(-17.0 if back else 17.0))
    m.bond("w -> s")
    run = hb.simulate(m, 1e-9)
    e = brentq(lambda e: 17.0 - 0.1 * of(e) - e, 0.0, 17.0 if "exp(100" in law else 4.0, xtol=1e-14)
    assert abs(run["rs.f"].at(0.0)) == pytest.approx(of(e), rel=1e-9)


@pytest.mark.parametrize("law", LAWS)
def test_slopes_have_values_far_out(law: str) -> None:
    slope = differentiate(parse(law), "e")
    for v in (-60.0, 0.49, 0.51, 60.0):
        h = 1e-6 if abs(v) < 1.0 else 1e-3
        meant = (LAWS[law](v + h) - LAWS[law](v - h)) / (2.0 * h)
        assert hb_value(slope, v) == pytest.approx(meant, rel=1e-5, abs=1e-12)


def hb_value(e: object, v: float) -> float:
    """Return an expression of one name at a value of it."""
    from hybond.model.expressions import compile_expression

    return float(compile_expression(e, {"e": 0}, pre_offset=0)((v,)))


@pytest.mark.parametrize("back", [False, True])
@pytest.mark.parametrize("law", [{"f": "1e-3*e^3"}, {"e": "10*sign(f)*abs(f)^0.3333333333333333"}])
def test_a_varistor_behind_a_coil(law: dict[str, str], back: bool) -> None:
    """``l f' = v - 10 f^(1/3)``, from nothing and through nothing."""
    m = hb.Model("varistor")
    m.add(v=hb.Se("3*sin(2*pi*time)"), d=hb.R(law), j=hb.One(), l=hb.I(0.1))
    m.bond("v -> j -> l", "d -> j" if back else "j -> d")
    meant = solve_ivp(
        lambda t, f: [10 * (3 * math.sin(2 * math.pi * t) - 10 * f[0] ** (1 / 3))],
        (0.02, 0.4),
        [1e-3 * (3 * math.sin(0.04 * math.pi)) ** 3],
        method="LSODA",
        rtol=1e-9,
        atol=1e-13,
        dense_output=True,
    ).sol
    run = hb.simulate(m, 0.9, max_steps=5000)
    for t in (0.1, 0.25, 0.4):
        assert run["l.f"].at(t) == pytest.approx(meant(t)[0], rel=1e-5)
        assert run["l.f"].at(t + 0.5) == pytest.approx(-meant(t)[0], rel=1e-5)


def test_flat_ends_are_read_where_the_exponential_has_no_number() -> None:
    """A sigmoid behind a coil has two flat ends: constraints in modes of their own."""
    m = hb.Model("limited")
    m.add(v=hb.Se(20.0), d=hb.R({"f": "1/(1 + exp(-1000*(e - 0.5)))"}), j=hb.One(), l=hb.I(0.1))
    m.bond("v -> j -> d", "j -> l")
    assert list(m.flatten().machines[0].states) == ["low", "follows", "high"]
