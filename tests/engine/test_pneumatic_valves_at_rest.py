"""Valves by ISO 6358, in absolute pressures as engineers write them, where nothing flows."""

import numpy as np
import pytest

import hybond as hb
from hybond.model.expressions import parse
from hybond.model.expressions.level_sides import joins
from scipy.integrate import solve_ivp

ROOM = "287*293.15"
RT = 287 * 293.15
ATM = 101325.0
A, B = 0.0032676, 0.0029438
"""Areas of a piston on its two sides."""
DEAD, STROKE = 1e-5, 0.3

WRITTEN = {
    "as two": "if a >= b then k*a*(if b/a <= 0.3 then 1 else sqrt(1 - ((b/a - 0.3)/0.7)^2))"
    " else -k*b*(if a/b <= 0.3 then 1 else sqrt(1 - ((a/b - 0.3)/0.7)^2))",
    "by a sign": "sign(a - b)*k*max(a, b)"
    "*sqrt(1 - (max(0, min(a, b)/max(a, b) - 0.35)/(1 - 0.35))^2)",
    "cut off": "k*sign(b - a)*max(a, b)*(if min(a, b) < 0.5*max(a, b) then 1"
    " else sqrt(max(0, 1 - ((min(a, b)/max(a, b) - 0.5)/(1 - 0.5))^2)))",
    "as a nozzle": "sign(a - b)*k*max(a, b)*sqrt(7*max(0, max(min(a, b)/max(a, b), 0.528)^(2/1.4)"
    " - max(min(a, b)/max(a, b), 0.528)^(2.4/1.4)))",
}
"""Flow from a pressure a to another b."""


def beside_a_supply(law: str, supply: str) -> hb.Model:
    """A chamber that a supply fills, with a valve to nothing that a machine opens for a while."""
    m = hb.Model("chamber", domain="generic_pseudo", parameters={"k": 5.8e-9})
    m.add(
        sup=hb.Se("1e6"),
        nS=hb.Zero(),
        fill=hb.One(),
        E=hb.R({"f": supply}),
        n=hb.Zero(),
        C=hb.C("1.8e-9", e="2.8e5"),
        j=hb.One(),
        V=hb.R({"f": law.replace("a", "n.e").replace("b", "(n.e-e)")}),
    )
    m.bond("sup -> nS -> fill -> n -> C", "fill -> E", "n -> j -> V")
    m.machine(
        "M",
        states={"shut": [], "open": ["j"], "done": []},
        start="shut",
        rules=["shut -> open when time >= 0.02", "open -> done when time >= 0.04"],
    )
    return m


@pytest.mark.parametrize("method", ["auto", "radau"])
@pytest.mark.parametrize("supply", ["1e-11*nS.e", "1e-11*max(nS.e, n.e)", "1e-5"])
def test_a_shut_check_valve_of_absolute_pressures_beside_another_valve(
    supply: str, method: str
) -> None:
    law = "5.8e-9*n.e*sqrt(1 - (max(0, min(1, (n.e - e)/n.e) - 0.528)/(1 - 0.528))^2)"
    run = hb.simulate(beside_a_supply(law, supply), until=0.05, solver=method)
    # choked both ways: a straight line, an exponential, a straight line
    shut = 2.8e5 + 1e-5 * 0.02 / 1.8e-9
    rest, fast = 1e-5 / 5.8e-9, 5.8e-9 / 1.8e-9
    opened = rest + (shut - rest) * np.exp(-fast * 0.02)
    last = opened + 1e-5 * 0.01 / 1.8e-9
    assert run["C.e"].at([0.02, 0.04, 0.05]) == pytest.approx([shut, opened, last], rel=1e-7)
    assert run["V.f"].at(0.045) == 0.0
    assert run.status == "ok" and not run.warnings and run.audit().holds()


@pytest.mark.parametrize("text", WRITTEN.values(), ids=WRITTEN)
def test_a_valve_has_one_value_where_its_pressures_are_equal(text: str) -> None:
    law = parse(text)
    assert joins(law, parse("a - b"))
    assert joins(law, parse("b - a"))
    own = parse(text.replace("a", "p").replace("mpx", "max").replace("b", "(p - e)"))
    assert "as two" not in text and (joins(own, parse("p - (p - e)")) or joins(own, parse("e")))


@pytest.mark.parametrize(
    "text", ["sign(a - b)*sqrt(1.1 - a/b)", "if a > b then a else b + 1", "sign(a - b)*k"]
)
def test_what_jumps_where_pressures_are_equal_is_told_from_that(text: str) -> None:
    assert not joins(parse(text), parse("a - b"))
