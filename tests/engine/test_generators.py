"""Sources as sums of what a matrix lets grow: generators."""

import math
from itertools import product

import numpy as np
import pytest
from scipy.linalg import expm

import hybond as hb
from hybond.engine.tables.generators import generators, of_name, terms_of
from hybond.model.expressions import compile_expression, parse


@pytest.mark.parametrize(
    "text",
    [
        "3",
        "2*time - 1",
        "time^3/7",
        "5*sin(3*time + 0.4)",
        "cos(2*time)*sin(5*time)^2",
        "exp(-2*time)*(1 + time*cos(time))",
        "exp(3*(time - 1000))",
        "sinh(time) - 2*cosh(time/3)",
        "a*time*sin(time) + a^2",
        "if 2 > 1 then sin(time) else sqrt(time)",
        "sqrt(2)*min(1, 3)*time",
    ],
)
def test_generators_are_what_they_stand_for(text):
    e = parse(text)
    terms = terms_of(e, of_name)
    assert isinstance(terms, dict)
    made = generators(terms, lambda name: "da" if name == "a" else None)
    row = np.zeros(len(made.expressions))
    for k, factor in made.row(terms).items():
        row[k] = factor
    index = {"time": 0, "a": 1, "da": 2}
    value = compile_expression(e, index, pre_offset=3)
    each = [compile_expression(g, index, pre_offset=3) for g in made.expressions]

    def at(t):
        v = [t, 0.5 - 2.0 * t, -2.0, 0.0, 0.0, 0.0]
        return value(v), np.array([g(v) for g in each])

    t, h = 0.7, 0.9
    before, g = at(t)
    after, then = at(t + h)
    assert row @ g == pytest.approx(before, rel=1e-12)
    assert expm(made.matrix * h) @ g == pytest.approx(then, rel=1e-11, abs=1e-300)
    assert row @ expm(made.matrix * h) @ g == pytest.approx(after, rel=1e-11)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("sqrt(time)", "sqrt of what varies"),
        ("1/time", "a division by what varies"),
        ("time^0.5", "a power that is no small whole number"),
        ("2^time", "a power of what varies"),
        ("sin(time^2)", "sin of what is no line in time"),
        ("if time > 1 then 1 else 2", "a condition that varies"),
        ("max(time, 1)", "max of what varies"),
        ("pre(a)", "an a priori value"),
        ("exp(1000)*exp(1000)*time", "a value that overflows"),
    ],
)
def test_what_has_no_generators_says_why(text, reason):
    assert terms_of(parse(text), of_name) == reason


@pytest.mark.parametrize(
    "text",
    [
        "if a then 2 else exp(60 - time)",
        "if not a then exp(60 - time) else sin(time)",
        "if a then (if b then time else 3) else exp(60 - 3*time)*cos(time)",
        "if a and b and c then 1 else exp(60 - time)",
        "if a or b or not c then 1 + time else exp(60 - time)",
        "if not (a and (b or not c)) then exp(60 - time) else 1",
        "(if a then 1 else exp(60 - time))*(if a then exp(60 - time) else 1)",
        "if (if a then b else c) then 3 else time^2",
    ],
)
def test_comparisons_of_time_and_their_opposites_are_factors_of_generators(text):
    e = parse(text)
    terms = terms_of(e, lambda n: of_name(n if n == "time" else f"at:{n}"))
    made = generators(terms, lambda name: None)
    row = np.zeros(len(made.expressions))
    for k, factor in made.row(terms).items():
        row[k] = factor
    named = {"time": 0, "a": 1, "b": 2, "c": 3}
    value = compile_expression(e, named, pre_offset=4)
    slots = {n if n == "time" else f"at:{n}": k for n, k in named.items()}
    each = [compile_expression(g, slots, pre_offset=4) for g in made.expressions]
    for truths in product([0.0, 1.0], repeat=3):
        v = [0.7, *truths, *[0.0] * 4]
        g = np.array([one(v) for one in each])
        assert (row * g).sum() == pytest.approx(value(v), rel=1e-13)
        later = row @ expm(made.matrix * 0.9) @ g
        assert later == pytest.approx(value([1.6, *v[1:]]), rel=1e-11)


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("tau", [60e-6, 20e-6, 1.5e-6, 1e-9])
@pytest.mark.parametrize(
    "wave",
    [
        "if time < 2 ms then V0 else V0*exp(-(time - 2 ms)/tau)",
        "if time >= 2 ms then V0*exp(-(time - 2 ms)/tau) else V0",
        "if not (time >= 1 ms and time >= 2 ms) then V0 else V0*exp(-(time - 2 ms)/tau)",
    ],
)
def test_a_source_that_dies_away_later_is_not_felt_before(wave, tau, turned):
    """It was taken off itself before: of e^33 that left 3 mV of rounding, and nobody told."""
    m = hb.Model("later", domain="electrical", parameters={"tau": f"{tau} s", "V0": "1 V"})
    m.add(V=hb.Se(wave), R=hb.R("1 kohm"), C=hb.C("100 nF"), i=hb.One())
    m.bonds = ["i -> V", "i -> R", "i -> C"] if turned else ["V -> i", "i -> R", "i -> C"]
    run = hb.simulate(m, until="4 ms")
    rc, sign = 1e-4, -1.0 if turned else 1.0

    def meant(t: float) -> float:
        if t <= 2e-3:
            return 1.0 - math.exp(-t / rc)
        s, a, b = t - 2e-3, 1.0 / rc, 1.0 / tau
        free = (1.0 - math.exp(-2e-3 / rc)) * math.exp(-a * s)
        return free + a / (a - b) * (math.exp(-b * s) - math.exp(-a * s))

    for t in (1e-5, 1e-3, 1.9e-3, 2e-3, 2.001e-3, 2.05e-3, 2.3e-3, 4e-3):
        assert sign * float(run["C.e"].at(t)) == pytest.approx(meant(t), abs=2e-7)
