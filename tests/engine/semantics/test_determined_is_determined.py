"""What laws determine is what Newton finds, what has no solution is refused."""

from __future__ import annotations

import math
from random import Random

import pytest
from scipy.optimize import brentq

import hybond as hb


def one_loop(source: object, domain: str = "electrical", **law: object) -> hb.Model:
    m = hb.Model("loop", domain=domain)
    m.add(S=source, D=hb.R(law), i=hb.One())
    m.bond("S -> i -> D")
    return m


def last(m: hb.Model, signal: str, until: str = "1 ms") -> float:
    run = hb.simulate(m, until=until)
    return float(run[signal].at(run.t_end))


def test_spring_drags_a_slider_that_gives_ten_newtons_at_most() -> None:
    m = hb.Model("slide", domain="translational")
    m.add(pull=hb.Sf("5 mm/s"), k=hb.C("1 mm/N"), n=hb.Zero())
    m.add(rub=hb.R({"e": "10 [N]*tanh(f/(1 [mm/s]))"}))
    m.bond("pull -> n -> k", "n -> rub")
    assert last(m, "k.e", "5 s") == pytest.approx(10 * math.tanh(5), rel=1e-5)


@pytest.mark.parametrize("scale", [1.0, 1e-2, 1e-4, 1e-6, 1e-9])
def test_velocity_of_saturating_friction_at_any_scale(scale: float) -> None:
    m = one_loop(hb.Se("0.6 N"), "translational", e=f"1 [N]*tanh(f/({scale} [m/s]))")
    assert last(m, "i.f") == pytest.approx(math.atanh(0.6) * scale, rel=1e-9)


@pytest.mark.parametrize("scale", [1.0, 1e-3, 1e-6])
def test_cubic_friction_at_any_scale(scale: float) -> None:
    u = f"(f/({scale} [m/s]))"
    m = one_loop(hb.Se("0.6 N"), "translational", e=f"1 [N]*({u} + {u}^3)")
    root = brentq(lambda x: x + x**3 - 0.6, 0, 1, xtol=1e-15)
    assert last(m, "i.f") == pytest.approx(root * scale, rel=1e-9)


FLAT = {
    "relief valve": (1e-3, "1e-9*max(e - 2e7, 0)", 2.1e7),
    "flat branch": (5e-3, "if e < 0.2 then e*0.05 else 0.01", 0.1),
    "saturating": (9.9e-3, "0.01*tanh(e/0.1)", 0.1 * math.atanh(0.99)),
    "dead zone": (1e-3, "if e < 3 then 0 else 0.1*(e - 3)", 3.01),
    "negative": (-1e-3, "1e-9*min(e + 2e7, 0)", -2.1e7),
}


@pytest.mark.parametrize("case", FLAT.values(), ids=FLAT.keys())
def test_source_into_a_law_that_is_flat_elsewhere(case: tuple[float, str, float]) -> None:
    flow, law, effort = case
    m = hb.Model("flat")
    m.add(J=hb.Sf(flow), T=hb.R({"f": law}), n=hb.Zero())
    m.bond("J -> n -> T")
    run = hb.simulate(m, until="1 ms")
    assert run["n.e"].at(run.t_end) == pytest.approx(effort, rel=1e-9)
    assert not run.warnings


def test_table_with_flat_ends() -> None:
    m = hb.Model("table")
    table = [[-0.3, -0.2, 0, 0.2, 0.3], [-0.01, -0.01, 0, 0.01, 0.01]]
    m.add(J=hb.Sf(5e-3), T=hb.R({"f": {"table": table, "extrapolate": "linear"}}), n=hb.Zero())
    m.bond("J -> n -> T")
    assert last(m, "n.e") == pytest.approx(0.1, rel=1e-9)


def test_closed_relief_valve_leaves_pressure_open() -> None:
    m = hb.Model("closed")
    m.add(J=hb.Sf(0), T=hb.R({"f": "1e-9*max(e - 2e7, 0)"}), n=hb.Zero())
    m.bond("J -> n -> T")
    run = hb.simulate(m, until="1 ms")
    assert run["n.e"].at(run.t_end) == 0.0
    assert any("open" in w for w in run.warnings)


def test_orifice_at_rest_is_not_open() -> None:
    run = hb.simulate(one_loop(hb.Se(0), e="1 [V/A^2]*f*abs(f)"), until="1 ms")
    assert run["i.f"].at(run.t_end) == 0.0
    assert not run.warnings


@pytest.mark.parametrize(
    ("effort", "law"),
    [
        (-5, "1 [V/A^2]*f^2"),
        (2, "1 [V]*tanh(f/(1 [A]))"),
        (-2, "1 [V]*tanh(f/(1 [A]))"),
        (-1, "1 [V]*exp(f/(1 [A]))"),
        (-5, "0.5 [ohm]*(f + f*f/sqrt(f*f + 1e-40 [A^2]))"),
    ],
)
def test_laws_without_solution_are_refused(effort: float, law: str) -> None:
    with pytest.raises(hb.NumericsError, match="HB-N301"):
        hb.simulate(one_loop(hb.Se(f"{effort} V"), e=law), until="1 ms")


def test_orifices_in_a_row_from_rest() -> None:
    m = hb.Model("orifices")
    law = "1e-3*sqrt(max(e, 0))"
    m.add(p=hb.Se(9), a=hb.R({"f": law}), b=hb.R({"f": law}), n=hb.Zero(), i=hb.One())
    m.bond("p -> i -> a", "i -> n -> b")
    assert last(m, "i.f") == pytest.approx(1e-3 * math.sqrt(4.5), rel=1e-9)


def test_tank_drains_to_empty() -> None:
    m = hb.Model("tank", domain="hydraulic")
    m.add(t=hb.C("1e-4 m^3/Pa", e="5 kPa"), n=hb.Zero())
    m.add(o=hb.R({"f": "1e-4 [m^3/(s*Pa^0.5)]*sqrt(max(e, 0))"}))
    m.bond("n -> t", "n -> o")
    run = hb.simulate(m, until="600 s")
    # sqrt(p) falls by t/2
    assert run["t.e"].at(100) == pytest.approx((math.sqrt(5000) - 50) ** 2, rel=1e-6)
    assert abs(run["t.e"].at(600)) < 5000 * 1e-6


def test_diodes_without_series_resistance() -> None:
    m = hb.Model("diodes")
    law = "1e-12*(exp(e/0.025) - 1)"
    m.add(V=hb.Se(1.2), a=hb.R({"f": law}), b=hb.R({"f": law}), i=hb.One())
    m.bond("V -> i -> a", "i -> b")
    assert last(m, "i.f") == pytest.approx(1e-12 * math.expm1(24), rel=1e-9)


TWO_CORNERS = """
hybond = 1
domain = "translational"
[elements]
mx = {{ I = 1 }}
vx = {{ junction = 1 }}
my = {{ I = 1 }}
weight = {{ Se = -9.81 }}
vy = {{ junction = 1 }}
rot = {{ I = 0.2, domain = "rotational" }}
w = {{ junction = 1, domain = "rotational" }}
c1 = {{ junction = 0, law = "unilateral" }}
c2 = {{ junction = 0, law = "unilateral" }}
a1 = {{ TF = "-{a}*cos(theta) + {b}*sin(theta)" }}
a2 = {{ TF = "{c}*cos(theta) + {b}*sin(theta)" }}
s1 = {{ junction = 1, law = "coulomb", limit = "0.3*c1.e" }}
s2 = {{ junction = 1, law = "coulomb", limit = "0.3*c2.e" }}
f1 = {{ junction = 0 }}
f2 = {{ junction = 0 }}
t1 = {{ TF = "{b}*cos(theta) + {a}*sin(theta)" }}
t2 = {{ TF = "{b}*cos(theta) - {c}*sin(theta)" }}
[graph]
bonds = ["vx -> mx", "weight -> vy -> my", "w -> rot", "c1 -> vy", "c1 -> a1.2", "a1.1 -> w",
  "c2 -> vy", "c2 -> a2.2", "a2.1 -> w", "vx -> f1 -> s1", "w -> t1 -> f1", "vx -> f2 -> s2",
  "w -> t2 -> f2"]
[signals]
theta = {{ integral = "w.f" }}
[experiment]
until = "0.1 s"
"""
"""A block at rest on two corners that stick: who carries what along the floor is open."""


@pytest.mark.parametrize(("a", "b", "c"), [(0.25, 0.75, 0.25), (0.1, 0.5, 0.3), (1, 0.2, 0.5)])
def test_weight_on_two_corners_is_determined(a: float, b: float, c: float) -> None:
    run = hb.simulate(hb.loads(TWO_CORNERS.format(a=a, b=b, c=c)))
    assert run["c1.e"].at(0.05) == pytest.approx(9.81 * c / (a + c), rel=1e-12)
    assert run["c2.e"].at(0.05) == pytest.approx(9.81 * a / (a + c), rel=1e-12)


LAWS = {
    "tanh": (lambda x, a, b: a * math.tanh(x / b), "{a}*tanh({x}/{b})"),
    "cubic": (lambda x, a, b: a * (x / b + (x / b) ** 3), "{a}*({x}/{b} + ({x}/{b})^3)"),
    "exp": (lambda x, a, b: a * math.expm1(x / b), "{a}*(exp({x}/{b}) - 1)"),
    "kinked": (lambda x, a, b: a * max(x - b, 0.0), "{a}*max({x} - {b}, 0)"),
    "linear": (lambda x, a, b: a * x / b, "{a}*{x}/{b}"),
}


@pytest.mark.sampled(10)
@pytest.mark.parametrize("seed", range(30))
def test_random_monotone_laws_in_parallel(seed: int) -> None:
    """A source of flow into laws side by side: the common effort is the root of their sum."""
    random = Random(seed)
    m = hb.Model("parallel")
    chosen = [random.choice(sorted(LAWS)) for _ in range(random.randint(1, 3))]
    # one that grows without bound makes the root unique
    chosen.append(random.choice(["cubic", "linear"]))
    sizes = [(10 ** random.uniform(-4, 2), 10 ** random.uniform(-4, 3)) for _ in chosen]
    flow = 10 ** random.uniform(-4, 2)
    m.add(J=hb.Sf(flow), n=hb.Zero())
    m.bond("J -> n")
    for k, (name, (a, b)) in enumerate(zip(chosen, sizes, strict=True)):
        m.add(**{f"r{k}": hb.R({"f": LAWS[name][1].format(x="e", a=repr(a), b=repr(b))})})
        m.bond(f"n -> r{k}")

    def rest(x: float) -> float:
        try:
            return sum(LAWS[n][0](x, *s) for n, s in zip(chosen, sizes, strict=True)) - flow
        except OverflowError:
            return math.inf

    high = 1e-9
    while rest(high) < 0:
        high *= 2
    root = brentq(lambda x: max(min(rest(x), 1e30), -1e30), 0, high, xtol=1e-300, rtol=1e-14)
    assert last(m, "n.e") == pytest.approx(root, rel=1e-8)


# -- laws near their limit: small residuals are no solutions ---------------------------------------


LIMITED = {
    "1 [V]*tanh(f/(1 [A]))": math.atanh,
    "2/pi*1 [V]*atan(f/(1 [A]))": lambda v: math.tan(0.5 * math.pi * v),
    "1 [V]*(f/(1 [A]))/sqrt(1 + (f/(1 [A]))^2)": lambda v: v / math.sqrt((1.0 - v) * (1.0 + v)),
    "1 [V]*(1 - exp(-f/(1 [A])))": lambda v: -math.log1p(-v),
}
"""Laws that give less than 1 V, and the current at a part of it."""


@pytest.mark.parametrize("law", LIMITED)
@pytest.mark.parametrize("below", [1e-3, 1e-6, 1e-9, 1e-12])
def test_a_law_is_followed_close_to_its_limit(law: str, below: float) -> None:
    volts = 1.0 - below
    m = one_loop(hb.Se(volts), "electrical", e=law)
    # rounding of the law, by what is left to its limit
    assert last(m, "D.f") == pytest.approx(LIMITED[law](volts), rel=1e-8 + 4e-15 / below)


@pytest.mark.parametrize("law", LIMITED)
@pytest.mark.parametrize("above", [1e-12, 1e-10, 1e-7, 1e-3, 1.0])
def test_a_law_is_not_solved_beyond_its_limit(law: str, above: float) -> None:
    m = one_loop(hb.Se(1.0 + above), "electrical", e=law)
    with pytest.raises(hb.NumericsError, match="HB-N301"):
        hb.simulate(m, until=1.0)
