"""Valves by ISO 6358, in absolute pressures as engineers write them, where nothing flows."""

import re

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb
from hybond.model.expressions import parse
from hybond.model.expressions.level_sides import joins

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


def written(text: str, **names: str) -> str:
    """Return a law with other names in it."""
    for name, other in names.items():
        text = re.sub(rf"\b{name}\b", other, text)
    return text


def beside_a_supply(law: str, supply: str) -> hb.Model:
    """A chamber that a supply fills, with a valve to nothing that a machine opens for a while."""
    m = hb.Model("chamber", domain="generic_pseudo")
    m.add(
        sup=hb.Se("1e6"),
        nS=hb.Zero(),
        fill=hb.One(),
        E=hb.R({"f": supply}),
        n=hb.Zero(),
        C=hb.C("1.8e-9", e="2.8e5"),
        j=hb.One(),
        V=hb.R({"f": law}),
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
    assert joins(parse(written(text, a="p", b="(p - e)")), parse("p - (p - e)"))


@pytest.mark.parametrize(
    "text",
    [
        "sign(a - b)*sqrt(1.1 - a/b)",
        "if a > b then a else b + 1",
        "sign(2*a - 2*b)*k",
        "k*mod(a - b, 1)",
        "sign(a - b)*max(a, b)*(if min(a, b) < 2*max(a, b) then 1 else 0)",
    ],
)
def test_what_jumps_where_pressures_are_equal_is_told_from_that(text: str) -> None:
    assert not joins(parse(text), parse("a - b"))


def cylinder_beside_a_chamber(start: str) -> hb.Model:
    """A piston on a shut chamber and a valve to the air, beside a chamber level with the air."""
    out = written(WRITTEN["as two"], k="5.11e-08", a="e1", b="e2")
    level = written(WRITTEN["by a sign"], k="6.25e-09", a="n2.e", b="nA.e")
    m = hb.Model("cylinder", domain="generic_pseudo")
    m.add(
        atm=hb.Se(f"{ATM}"),
        nA=hb.Zero(),
        v=hb.One(domain="translational"),
        mass=hb.I("0.4778 kg"),
        stop=hb.C({"e": "4.6e6*(max(0, q - 0.3) + min(0, q))"}, q="0 m"),
        F=hb.Se(f"n0.e*{A} - n1.e*{B} - {ATM * (A - B)!r}", domain="translational"),
        n0=hb.Zero(),
        S0=hb.Se("p0"),
        n1=hb.Zero(),
        S1=hb.Se("p1"),
        out=hb.R({"f": [out, f"-({out})"]}),
        n2=hb.Zero(),
        C=hb.C({"e": f"q*{ROOM}/1.0907168807104528e-05"}, q=start),
        j=hb.One(),
        E=hb.Sf(level),
        n3=hb.Zero(),
        tank=hb.C({"e": f"{ROOM}*q/1.976e-4"}, q="2.38e-4"),
    )
    m.bond("atm -> nA", "v -> mass", "v -> stop", "F -> v", "n0 -> S0", "n1 -> S1")
    m.bond("n1 -> out.1", "nA -> out.2", "n2 -> C", "n2 -> j -> nA", "E -> j", "n3 -> tank")
    volume = f"({DEAD} + {A}*stop.q)"
    m.signal(
        p0=hb.Integral(f"(1.4*{ROOM}*S0.f - 1.4*p0*{A}*mass.f)/{volume}", start="1.5e5"),
        m1=hb.Integral("S1.f", start="4.29e-3"),
        p1=f"m1*{ROOM}/(2e-5 + {B}*({STROKE} - stop.q))",
    )
    return m


def moved(until: float) -> np.ndarray:
    """Return place, momentum and mass of the piston's other chamber, by SciPy."""

    def rate(_: float, y: np.ndarray) -> list[float]:
        x, p, m1 = y
        shut = 1.5e5 * (DEAD / (DEAD + A * x)) ** 1.4
        other = m1 * RT / (2e-5 + B * (STROKE - x))
        high, low = max(other, ATM), min(other, ATM)
        flow = 5.11e-8 * high * np.sqrt(max(0, 1 - (max(0, low / high - 0.3) / 0.7) ** 2))
        force = shut * A - other * B - ATM * (A - B) - 4.6e6 * (max(0, x - 0.3) + min(0, x))
        return [p / 0.4778, force, -flow if other > ATM else flow]

    return solve_ivp(rate, (0, until), [0, 0, 4.29e-3], method="DOP853", rtol=1e-11, atol=1e-15).y[
        :, -1
    ]


@pytest.mark.sampled(1)
@pytest.mark.parametrize("method", ["auto", "radau"])
def test_a_chamber_that_begins_level_with_the_air_stays_so(method: str) -> None:
    # one digit of the last place above it
    run = hb.simulate(
        cylinder_beside_a_chamber("1.3135809810414053e-05"), until=0.004, solver=method
    )
    assert run["C.e"].at(run["C.e"].t) == pytest.approx(ATM, rel=1e-15)
    for name, wanted in zip(("stop.q", "mass.p", "m1"), moved(0.004), strict=True):
        largest = np.abs(run[name].at(run[name].t)).max()
        assert float(run[name].at(0.004)) == pytest.approx(wanted, abs=1e-6 * largest)
    assert run.status == "ok" and not run.warnings
