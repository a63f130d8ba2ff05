"""Every element kind, its bonds drawn in both directions: the physics must not change.

Laws of C, I, R and G hold for power into the element; a source's value is its bond's effort or
flow whichever way the arrow points. The reference solutions are closed forms.
"""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from engine.laws_put_back import laws_of
from scipy.integrate import solve_ivp
from scipy.linalg import expm

import hybond as hb

T = np.linspace(0.0, 2.0, 21)
NEAR = {"rtol": 2e-7, "atol": 1e-9}


def arrow(junction: str, element: str, inward: bool) -> str:
    """A bond between a junction and an element, towards the element if `inward`."""
    return f"{junction} -> {element}" if inward else f"{element} -> {junction}"


def flips(n: int):
    return pytest.mark.parametrize(
        "way",
        list(itertools.product((True, False), repeat=n)),
        ids=lambda w: "".join("+" if a else "-" for a in w),
    )


def run(model: hb.Model, until: float = 2.0, **options) -> hb.Result:
    return hb.simulate(model, until=until, rtol=1e-10, **options)


def sign(inward: bool) -> float:
    return 1.0 if inward else -1.0


def audit(result: hb.Result) -> None:
    """Stored + dissipated - supplied is constant over each segment; bonds balance."""
    laws, nx = laws_of(result.graph), len(result.graph.storages)
    for segment in result.segments:
        metered = result.energies(segment)
        energy = [
            laws.energy(y[:nx]) + lost - given
            for y, (given, lost) in zip(segment.y, metered, strict=True)
        ]
        size = max(*(abs(e) for e in energy), float(np.abs(metered).max()), 1e-30)
        assert np.ptp(energy) <= 1e-8 * size


# -- one-ports -----------------------------------------------------------------------------------


@flips(2)
@pytest.mark.parametrize("law", ["R", "G", "e", "f", "table", "modulated"])
def test_discharge(way, law) -> None:
    r = {
        "R": hb.R("2"),
        "G": hb.G("0.5"),
        "e": hb.R({"e": "2*f"}),
        "f": hb.R({"f": "e/2"}),
        "table": hb.R({"e": {"table": [[-9.0, 0.0, 9.0], [-18.0, 0.0, 18.0]]}}),
        "modulated": hb.R("2 + 0*time"),
    }[law]
    m = hb.Model("rc")
    m.add(c=hb.C(0.4, e=3.0), r=r, n=hb.Zero())
    m.bond(arrow("n", "c", way[0]), arrow("n", "r", way[1]))
    result = run(m)
    want = 3.0 * np.exp(-T / 0.8)
    np.testing.assert_allclose(result["c.e"].at(T), want, **NEAR)
    np.testing.assert_allclose(result["c.q"].at(T), 0.4 * want, **NEAR)
    np.testing.assert_allclose(result["r.e"].at(T), want, **NEAR)
    np.testing.assert_allclose(result["r.f"].at(T), sign(way[1]) * want / 2, **NEAR)
    np.testing.assert_allclose(result["c.f"].at(T), -sign(way[0]) * want / 2, **NEAR)
    audit(result)
    lost = sum(result.energies(segment)[-1, 1] for segment in result.segments)
    assert math.isclose(lost, 0.2 * (9.0 - want[-1] ** 2), rel_tol=1e-7)


@flips(3)
@pytest.mark.parametrize("start", ["p", "f"])
def test_series_rl_with_source(way, start) -> None:
    # the source's value is its bond's effort: turned round, the same value pulls the other way
    m = hb.Model("rl")
    coil = hb.I(0.5, p=0.25) if start == "p" else hb.I(0.5, f=0.5)
    m.add(s=hb.Se(6.0), r=hb.R(2.0), l=coil, i=hb.One())
    m.bond(arrow("i", "s", way[0]), arrow("i", "r", way[1]), arrow("i", "l", way[2]))
    result = run(m)
    drive = -6.0 if way[0] else 6.0
    current = drive / 2.0 + (0.5 - drive / 2.0) * np.exp(-4.0 * T)
    want = {}
    # signed efforts add up to zero: 6 a + 2 f + c p' = 0 with f = c f_l, f_l the coil's own flow
    a, b, c = (sign(w) for w in way)
    f_l = lambda drive: drive / 2.0 + (0.5 - drive / 2.0) * np.exp(-4.0 * T)  # noqa: E731
    own = f_l(-a * c * 6.0)
    want["l.f"] = c * own
    want["r.f"] = c * own
    want["s.f"] = c * own
    want["r.e"] = b * c * 2.0 * own
    want["s.e"] = np.full_like(T, 6.0)
    for name, value in want.items():
        np.testing.assert_allclose(result[name].at(T), value, err_msg=name, **NEAR)
    np.testing.assert_allclose(result["l.p"].at(T), 0.5 * own, **NEAR)
    if c > 0:
        np.testing.assert_allclose(own, current, **NEAR)
    audit(result)


@flips(3)
def test_flow_source_into_parallel_cg(way) -> None:
    m = hb.Model("cg")
    m.add(s=hb.Sf(2.0), g=hb.G(0.5), c=hb.C(0.25), n=hb.Zero())
    m.bond(arrow("n", "s", way[0]), arrow("n", "g", way[1]), arrow("n", "c", way[2]))
    result = run(m)
    drive = -sign(way[0]) * 2.0
    e = drive / 0.5 * (1.0 - np.exp(-2.0 * T))
    np.testing.assert_allclose(result["c.e"].at(T), e, **NEAR)
    np.testing.assert_allclose(result["g.f"].at(T), sign(way[1]) * 0.5 * e, **NEAR)
    np.testing.assert_allclose(result["s.f"].at(T), np.full_like(T, 2.0), **NEAR)
    np.testing.assert_allclose(result["c.q"].at(T), 0.25 * e, **NEAR)
    audit(result)


@flips(3)
def test_damped_oscillator(way) -> None:
    m = hb.Model("mck")
    m.add(m=hb.I(2.0), k=hb.C(1 / 32.0, q=0.5), d=hb.R(0.8), v=hb.One())
    m.bond(arrow("v", "m", way[0]), arrow("v", "k", way[1]), arrow("v", "d", way[2]))
    result = run(m)
    zeta, w0 = 0.8 / 4.0, 4.0
    w = math.sqrt(w0**2 - zeta**2)
    x = 0.5 * np.exp(-zeta * T) * (np.cos(w * T) + zeta / w * np.sin(w * T))
    v = -0.5 * w0**2 / w * np.exp(-zeta * T) * np.sin(w * T)
    np.testing.assert_allclose(result["k.q"].at(T), x, rtol=1e-6, atol=1e-8)
    # displacement is positive for power into the spring: its rate is k.f times the arrow's sign
    np.testing.assert_allclose(sign(way[1]) * result["k.f"].at(T), v, rtol=1e-6, atol=1e-8)
    np.testing.assert_allclose(result["m.f"].at(T), sign(way[1]) * v, rtol=1e-6, atol=1e-8)
    np.testing.assert_allclose(
        result["m.p"].at(T), sign(way[0]) * sign(way[1]) * 2.0 * v, rtol=1e-6, atol=1e-8
    )
    np.testing.assert_allclose(
        result["d.e"].at(T), 0.8 * sign(way[2]) * result["v.f"].at(T), rtol=1e-9, atol=1e-12
    )
    audit(result)


@flips(2)
def test_lc(way) -> None:
    m = hb.Model("lc")
    m.add(l=hb.I(0.25), c=hb.C(0.25, e=1.0), n=hb.Zero())
    m.bond(arrow("n", "l", way[0]), arrow("n", "c", way[1]))
    result = run(m)
    np.testing.assert_allclose(result["c.e"].at(T), np.cos(4.0 * T), rtol=1e-6, atol=1e-8)
    np.testing.assert_allclose(result["l.p"].at(T), 0.25 * np.sin(4.0 * T), rtol=1e-6, atol=1e-8)
    np.testing.assert_allclose(
        result["l.f"].at(T), sign(way[0]) * np.sin(4.0 * T), rtol=1e-6, atol=1e-8
    )
    audit(result)


@flips(2)
def test_direct_bond_without_junction(way) -> None:
    m = hb.Model("direct")
    m.add(c=hb.C(0.5, q=1.0), r=hb.R(1.0), l=hb.I(1.0, p=2.0), s=hb.Se(3.0))
    m.bond("c -> r" if way[0] else "r -> c", "s -> l" if way[1] else "l -> s")
    result = run(m)
    np.testing.assert_allclose(result["c.q"].at(T), np.exp(-2 * T), **NEAR)
    np.testing.assert_allclose(result["l.p"].at(T), 2.0 + 3.0 * T, **NEAR)
    audit(result)


# -- two-ports -----------------------------------------------------------------------------------


def two_port(tf: str, left: str, right: str, way: tuple[bool, bool]) -> list[str]:
    return [
        f"{left} -> {tf}.1" if way[0] else f"{tf}.1 -> {left}",
        f"{tf}.2 -> {right}" if way[1] else f"{right} -> {tf}.2",
    ]


@flips(2)
@pytest.mark.parametrize("modulus", [3.0, -0.5, "3 + 0*time", "0.5*cos(0*time)"])
def test_reflected_inertia(way, modulus) -> None:
    n = {3.0: 3.0, -0.5: -0.5, "3 + 0*time": 3.0, "0.5*cos(0*time)": 0.5}[modulus]
    m = hb.Model("gear")
    m.add(s=hb.Se(2.0), a=hb.I(1.0), b=hb.I(0.5), v=hb.One(), w=hb.One(), g=hb.TF(modulus))
    m.bond("s -> v", "v -> a", "w -> b", *two_port("g", "v", "w", way))
    result = run(m)
    # f1 counts into side 1, f2 out of side 2: the arrows of both bonds decide neither
    f1 = 2.0 * T / (1.0 + 0.5 * n * n)
    s1, s2 = (1.0 if way[0] else -1.0), (1.0 if way[1] else -1.0)
    np.testing.assert_allclose(result["a.f"].at(T), f1, **NEAR)
    np.testing.assert_allclose(result["b.f"].at(T), s1 * s2 * n * f1, **NEAR)
    audit(result)


@flips(2)
@pytest.mark.parametrize("modulus", [2.0, "2 + 0*time"])
def test_transformer_to_spring(way, modulus) -> None:
    m = hb.Model("lever")
    m.add(a=hb.I(1.0, f=1.0), k=hb.C(0.25), v=hb.One(), g=hb.TF(modulus))
    m.bond("v -> a", *two_port("g", "v", "k", way))
    result = run(m)
    # e1 = 2 e2, q2 = 2 x: stiffness 4 * 4 = 16, so 4 rad/s
    np.testing.assert_allclose(result["a.f"].at(T), np.cos(4.0 * T), rtol=1e-6, atol=1e-8)
    np.testing.assert_allclose(
        np.abs(result["k.q"].at(T)), np.abs(2 * np.sin(4 * T) / 4), atol=1e-8
    )
    # the spring's own sign follows its bond; its force on the mass may not
    np.testing.assert_allclose(
        result["g.1.e"].at(T), (1.0 if way[0] else -1.0) * 2 * np.sin(4 * T) * 2, atol=1e-7
    )
    audit(result)


@flips(2)
@pytest.mark.parametrize("modulus", [0.7, "0.7 + 0*time"])
def test_gyrator_motor(way, modulus) -> None:
    m = hb.Model("motor")
    m.add(
        s=hb.Se(5.0),
        l=hb.I(0.1),
        r=hb.R(1.0),
        j=hb.I(0.2),
        b=hb.R(0.05),
        i=hb.One(),
        w=hb.One(),
        g=hb.GY(modulus),
    )
    m.bond("s -> i", "i -> l", "i -> r", "w -> j", "w -> b", *two_port("g", "i", "w", way))
    result = run(m)
    s = sign(way[0]) * sign(way[1])
    a = np.array([[-10.0, -s * 7.0], [s * 3.5, -0.25]])
    rhs = np.array([50.0, 0.0])
    steady = -np.linalg.solve(a, rhs)
    want = np.array([steady - expm(a * t) @ steady for t in T])
    np.testing.assert_allclose(result["l.f"].at(T), want[:, 0], rtol=1e-6, atol=1e-8)
    np.testing.assert_allclose(result["j.f"].at(T), want[:, 1], rtol=1e-6, atol=1e-8)
    audit(result)


@pytest.mark.parametrize("kind", ["TF", "GY"])
def test_plain_two_port_equals_numbered(kind) -> None:
    def model(*bonds: str) -> hb.Model:
        m = hb.Model("two")
        part = hb.TF(1.5) if kind == "TF" else hb.GY(1.5)
        m.add(a=hb.I(1.0, f=1.0), b=hb.C(0.5, q=0.3), x=part, r=hb.R(0.2), v=hb.One(), n=hb.Zero())
        m.bond("v -> a", "v -> r", "n -> b", *bonds)
        return m

    one = run(model("v -> x -> n"))["a.f"].at(T)
    two = run(model("v -> x.1", "x.2 -> n"))["a.f"].at(T)
    np.testing.assert_array_equal(one, two)
    # swapped: side 1 is where the arrow enters
    three = run(model("n -> x -> v"))["a.f"].at(T)
    four = run(model("n -> x.1", "x.2 -> v"))["a.f"].at(T)
    np.testing.assert_array_equal(three, four)
    if kind == "TF":
        assert np.abs(one - three).max() > 1e-3


# -- fields --------------------------------------------------------------------------------------


@flips(2)
def test_coupled_coils(way) -> None:
    l = np.array([[0.5, 0.2], [0.2, 0.3]])
    m = hb.Model("coils")
    m.add(k=hb.I(l.tolist(), f=[2.0, -1.0]), r1=hb.R(1.0), r2=hb.R(0.5))
    m.bond("k.1 -> r1" if not way[0] else "r1 -> k.1", "k.2 -> r2" if not way[1] else "r2 -> k.2")
    result = run(m)
    r = np.diag([1.0, 0.5])
    want = np.array([expm(-r @ np.linalg.inv(l) * t) @ (l @ [2.0, -1.0]) for t in T])
    np.testing.assert_allclose(result["k.1.p"].at(T), want[:, 0], rtol=1e-6, atol=1e-8)
    np.testing.assert_allclose(result["k.2.p"].at(T), want[:, 1], rtol=1e-6, atol=1e-8)
    own = want @ np.linalg.inv(l)
    np.testing.assert_allclose(
        result["k.1.f"].at(T), sign(way[0]) * own[:, 0], rtol=1e-6, atol=1e-8
    )
    np.testing.assert_allclose(
        result["k.2.f"].at(T), sign(way[1]) * own[:, 1], rtol=1e-6, atol=1e-8
    )
    audit(result)


@flips(2)
@pytest.mark.parametrize("form", ["matrix", "law"])
def test_c_field(way, form) -> None:
    c = np.array([[0.5, 0.1], [0.1, 0.25]])
    k = np.linalg.inv(c)
    if form == "matrix":
        part = hb.C(c.tolist(), q=[0.3, -0.2])
    else:
        rows = [" + ".join(f"({a!r})*q{j + 1}" for j, a in enumerate(row)) for row in k.tolist()]
        part = hb.C({"e": rows}, q=[0.3, -0.2])
    m = hb.Model("cfield")
    m.add(k=part, m1=hb.I(1.0), m2=hb.I(2.0))
    m.bond(arrow("m1", "k.1", way[0]), arrow("m2", "k.2", way[1]))
    result = run(m)
    # q' = f into k; a direct bond m -> k has p' = -+e so p = sign * own momentum
    minv = np.diag([1.0, 0.5])
    a = np.block([[np.zeros((2, 2)), minv], [-k, np.zeros((2, 2))]])
    want = np.array([expm(a * t) @ [0.3, -0.2, 0.0, 0.0] for t in T])
    np.testing.assert_allclose(result["k.1.q"].at(T), want[:, 0], rtol=1e-6, atol=1e-8)
    np.testing.assert_allclose(result["k.2.q"].at(T), want[:, 1], rtol=1e-6, atol=1e-8)
    audit(result)


@flips(2)
@pytest.mark.parametrize("form", ["R", "G", "law"])
def test_r_field(way, form) -> None:
    r = np.array([[1.0, 0.3], [-0.6, 0.8]])  # not symmetric: part of it gyrates
    part = {
        "R": lambda: hb.R(r.tolist()),
        "G": lambda: hb.G(np.linalg.inv(r).tolist()),
        "law": lambda: hb.R({"e": ["1.0*f1 + 0.3*f2", "-0.6*f1 + 0.8*f2"]}),
    }[form]()
    m = hb.Model("rfield")
    m.add(r=part, a=hb.C(0.5, e=1.0), b=hb.C(0.2, e=-2.0))
    m.bond(arrow("a", "r.1", way[0]), arrow("b", "r.2", way[1]))
    result = run(m)
    a = -np.linalg.inv(r) @ np.diag([2.0, 5.0])
    want = np.array([expm(a * t) @ [0.5, -0.4] for t in T])
    np.testing.assert_allclose(result["a.q"].at(T), want[:, 0], rtol=1e-6, atol=1e-8)
    np.testing.assert_allclose(result["b.q"].at(T), want[:, 1], rtol=1e-6, atol=1e-8)
    audit(result)


# -- nonlinear laws and tables ---------------------------------------------------------------------


@flips(2)
@pytest.mark.parametrize("law", ["{}*f*abs(f)", "if f < 0 then -{}*f^2 else {}*f^2"])
def test_quadratic_drag(way, law) -> None:
    m = hb.Model("drag")
    m.add(m=hb.I(2.0, f=3.0), d=hb.R({"e": law.replace("{}", "1.6")}), v=hb.One())
    m.bond(arrow("v", "m", way[0]), arrow("v", "d", way[1]))
    result = run(m)
    v = 3.0 / (1.0 + 1.6 * 3.0 * T / 2.0)
    np.testing.assert_allclose(result["m.p"].at(T), 2 * v, **NEAR)
    np.testing.assert_allclose(
        result["d.e"].at(T), sign(way[0]) * sign(way[1]) * 1.6 * v * v, **NEAR
    )
    audit(result)


@flips(2)
@pytest.mark.parametrize("kind", ["C", "I"])
def test_nonlinear_storage(way, kind) -> None:
    # a hardening spring against a mass, and its dual
    m = hb.Model("duffing")
    if kind == "C":
        m.add(k=hb.C({"e": "q + 4*q^3"}, q=0.9), m=hb.I(1.0), v=hb.One())
    else:
        m.add(k=hb.I({"f": "p + 4*p^3"}, p=0.9), m=hb.C(1.0), v=hb.Zero())
    m.bond(arrow("v", "k", way[0]), arrow("v", "m", way[1]))
    result = run(m)
    sol = solve_ivp(
        lambda t, y: [y[1], -(y[0] + 4 * y[0] ** 3)],
        (0, 2),
        [0.9, 0.0],
        rtol=1e-12,
        atol=1e-13,
        t_eval=T,
        method="DOP853",
    )
    name = "k.q" if kind == "C" else "k.p"
    np.testing.assert_allclose(result[name].at(T), sol.y[0], rtol=1e-6, atol=1e-8)
    other = "m.p" if kind == "C" else "m.q"
    # on a 0-junction no arrow matters to what is stored
    s = sign(way[0]) * sign(way[1]) if kind == "C" else 1.0
    np.testing.assert_allclose(result[other].at(T), s * sol.y[1], rtol=1e-6, atol=1e-8)
    audit(result)


@flips(2)
def test_start_of_nonlinear_storage_from_co_energy(way) -> None:
    m = hb.Model("start")
    m.add(k=hb.C({"e": "q + 4*q^3"}, e=5.0), r=hb.R(1.0), n=hb.Zero())
    m.bond(arrow("n", "k", way[0]), arrow("n", "r", way[1]))
    result = run(m, until=0.1)
    assert math.isclose(result["k.q"].at(0.0), 1.0, rel_tol=1e-12)


@flips(2)
@pytest.mark.parametrize("kind", ["R", "C"])
def test_table_law(way, kind) -> None:
    table = {"table": [[-4.0, -1.0, 0.0, 1.0, 4.0], [-13.0, -1.0, 0.0, 1.0, 13.0]]}
    m = hb.Model("table")
    if kind == "R":
        # slope 4 above 1, 1 below: two exponentials
        m.add(x=hb.I(1.0, f=2.0), r=hb.R({"e": table}), j=hb.One())
    else:
        m.add(x=hb.C({"e": table}, q=2.0), r=hb.R(1.0), j=hb.Zero())
    m.bond(arrow("j", "x", way[0]), arrow("j", "r", way[1]))
    result = run(m)
    # y' = -(4 y - 3) until y = 1, then y' = -y
    t1 = math.log(5.0) / 4.0
    want = np.where(t1 > T, 0.75 + 1.25 * np.exp(-4 * T), np.exp(-(T - t1)))
    name = "x.p" if kind == "R" else "x.q"
    np.testing.assert_allclose(result[name].at(T), want, rtol=3e-6, atol=1e-8)


# -- modulated elements ----------------------------------------------------------------------------


@flips(2)
@pytest.mark.parametrize("kind", ["R", "G"])
def test_modulated_resistor(way, kind) -> None:
    m = hb.Model("mr")
    part = hb.R("1/(1 + time)") if kind == "R" else hb.G("1 + time")
    m.add(c=hb.C(1.0, e=2.0), r=part, n=hb.Zero())
    m.bond(arrow("n", "c", way[0]), arrow("n", "r", way[1]))
    result = run(m)
    np.testing.assert_allclose(result["c.q"].at(T), 2.0 * np.exp(-T - T * T / 2), **NEAR)
    audit(result)


@flips(2)
def test_modulated_sources(way) -> None:
    m = hb.Model("ms")
    m.add(
        e=hb.Se("3*cos(2*time)"),
        l=hb.I(0.5),
        f=hb.Sf("sin(1*time)"),
        c=hb.C(0.25),
    )
    m.bond(arrow("e", "l", way[0]), arrow("f", "c", way[1]))
    result = run(m)
    np.testing.assert_allclose(result["l.p"].at(T), 1.5 * np.sin(2 * T), rtol=1e-6, atol=1e-8)
    np.testing.assert_allclose(
        result["c.q"].at(T), sign(way[1]) * (1 - np.cos(T)), rtol=1e-6, atol=1e-8
    )
    audit(result)


@flips(2)
def test_source_that_reads_a_state(way) -> None:
    # a spring made of a controlled source: Se = -9 x with x the integrated common flow
    m = hb.Model("controlled")
    m.add(m=hb.I(1.0, f=1.0), s=hb.Se("-9*x" if not way[1] else "9*x"), v=hb.One())
    m.signal(x=hb.Integral("v.f"))
    m.bond(arrow("v", "m", way[0]), arrow("v", "s", way[1]))
    result = run(m)
    f0 = sign(way[0])
    np.testing.assert_allclose(result["v.f"].at(T), f0 * np.cos(3 * T), rtol=1e-6, atol=1e-8)


@flips(2)
def test_source_that_reads_a_bond(way) -> None:
    # Se = 2 * (mass.f) used as a damper: the effort of the bond, flipped with it
    m = hb.Model("controlled")
    s = "2*v.f" if way[1] else "-2*v.f"
    m.add(m=hb.I(1.0, f=1.0), s=hb.Se(s), v=hb.One())
    m.bond(arrow("v", "m", way[0]), arrow("v", "s", way[1]))
    result = run(m)
    np.testing.assert_allclose(result["m.p"].at(T), np.exp(-2 * T), **NEAR)


@flips(2)
@pytest.mark.parametrize("kind", ["TF", "GY"])
def test_two_port_modulated_by_time(way, kind) -> None:
    # a source through a modulated two-port into an inertia (or capacity) in integral causality
    m = hb.Model("mtf")
    part = hb.TF("2 + sin(1*time)") if kind == "TF" else hb.GY("2 + sin(1*time)")
    load = hb.I(1.0) if kind == "TF" else hb.C(1.0)
    m.add(s=hb.Se(3.0), x=part, load=load)
    # TF: side 2 has the source, e1 = m e2; GY: f2 = e1 / r
    if kind == "TF":
        m.bond("load -> x.1" if way[0] else "x.1 -> load", arrow("s", "x.2", not way[1]))
        rate = 3.0 * (2 * T + 1 - np.cos(T))
        result = run(m)
        np.testing.assert_allclose(result["load.p"].at(T), rate, **NEAR)
    else:
        m.bond(arrow("s", "x.1", way[0]), arrow("load", "x.2", not way[1]))
        from scipy.integrate import quad

        rate = np.array([quad(lambda u: 3.0 / (2 + math.sin(u)), 0, t, epsabs=1e-13)[0] for t in T])
        # f2 counts out of side 2
        result = run(m)
        np.testing.assert_allclose(np.abs(result["load.q"].at(T)), rate, **NEAR)
        # whichever way: power leaves the two-port into the store
        assert np.all(result["load.e"].at(T[1:]) * result["load.q"].at(T[1:]) > 0)
    audit(result)


# -- switched elements ----------------------------------------------------------------------------


def switched(m: hb.Model, name: str, *, at: float = 1.0, start: str = "on") -> None:
    other = "off" if start == "on" else "on"
    m.machine(
        "sw",
        states={"on": [name], "off": []},
        start=start,
        rules=[f"{start} -> {other} when time >= {at}"],
    )


@flips(2)
def test_switched_c(way) -> None:
    # OFF: no effort, and what was stored is lost
    m = hb.Model("swc")
    m.add(k=hb.C(0.25, q=0.5), r=hb.I(1.0), v=hb.One())
    m.bond(arrow("v", "k", way[0]), arrow("v", "r", way[1]))
    switched(m, "k")
    result = run(m)
    before, after = T[T < 1.0], T[T > 1.0]
    np.testing.assert_allclose(result["k.q"].at(before), 0.5 * np.cos(2 * before), atol=1e-8)
    np.testing.assert_allclose(result["k.q"].at(after), 0.0, atol=1e-12)
    s = sign(way[0]) * sign(way[1])
    np.testing.assert_allclose(result["r.f"].at(after), -sign(way[1]) * s * np.sin(2.0), rtol=1e-7)
    lost = [st.energy.lost for e in result.events for st in e.steps if st.energy]
    assert math.isclose(max(lost), 0.5 * 4 * (0.5 * math.cos(2.0)) ** 2, rel_tol=1e-7)


@flips(2)
def test_switched_i(way) -> None:
    m = hb.Model("swi")
    m.add(l=hb.I(0.5, f=1.0), r=hb.C(0.5), n=hb.Zero())
    m.bond(arrow("n", "l", way[0]), arrow("n", "r", way[1]))
    switched(m, "l")
    result = run(m)
    after = T[T > 1.0]
    np.testing.assert_allclose(result["l.p"].at(after), 0.0, atol=1e-12)
    np.testing.assert_allclose(np.abs(result["r.q"].at(after)), 0.5 * abs(np.sin(2.0)), rtol=1e-7)


@flips(2)
@pytest.mark.parametrize("kind", ["R", "G"])
def test_switched_resistor(way, kind) -> None:
    # R OFF is a short (no effort), G OFF is open (no flow)
    m = hb.Model("swr")
    if kind == "R":
        m.add(x=hb.I(1.0, f=2.0), r=hb.R(1.0), j=hb.One())
    else:
        m.add(x=hb.C(1.0, e=2.0), r=hb.G(1.0), j=hb.Zero())
    m.bond(arrow("j", "x", way[0]), arrow("j", "r", way[1]))
    switched(m, "r")
    result = run(m)
    name = "x.p" if kind == "R" else "x.q"
    np.testing.assert_allclose(result[name].at(T), 2.0 * np.exp(-np.minimum(T, 1.0)), **NEAR)


@flips(2)
@pytest.mark.parametrize("kind", ["Se", "Sf"])
def test_switched_source(way, kind) -> None:
    m = hb.Model("sws")
    if kind == "Se":
        m.add(x=hb.I(1.0), s=hb.Se(2.0), j=hb.One())
    else:
        m.add(x=hb.C(1.0), s=hb.Sf(2.0), j=hb.Zero())
    m.bond(arrow("j", "x", way[0]), arrow("j", "s", way[1]))
    switched(m, "s")
    result = run(m)
    s = -sign(way[0]) * sign(way[1]) if kind == "Se" else -sign(way[1])
    name = "x.p" if kind == "Se" else "x.q"
    np.testing.assert_allclose(result[name].at(T), s * 2.0 * np.minimum(T, 1.0), **NEAR)


@flips(2)
@pytest.mark.parametrize("modulus", [2.0, "2 + 0*time"])
def test_switched_tf_with_resistor(way, modulus) -> None:
    # OFF: modulus 0: side 1 feels no effort, side 2 no flow
    m = hb.Model("swtf")
    m.add(a=hb.I(1.0, f=1.0), g=hb.TF(modulus), r=hb.R(0.5), v=hb.One())
    m.bond("v -> a", *two_port("g", "v", "r", way))
    switched(m, "g")
    result = run(m)
    np.testing.assert_allclose(result["a.f"].at(T), np.exp(-2.0 * np.minimum(T, 1.0)), **NEAR)
    assert abs(result["r.f"].at(1.5)) < 1e-12


@flips(2)
def test_switched_tf_takes_momentum_of_side_two(way) -> None:
    # side 2 opens: an inertia there stops, as against an OFF 1-junction
    m = hb.Model("swtf")
    m.add(a=hb.I(1.0, f=1.0), b=hb.I(1.0), g=hb.TF(2.0), v=hb.One(), w=hb.One())
    m.bond("v -> a", "w -> b", *two_port("g", "v", "w", way))
    switched(m, "g")
    result = run(m)
    assert math.isclose(result["a.f"].at(0.5), 0.2, rel_tol=1e-12)
    assert math.isclose(result["a.f"].at(1.5), 0.2, rel_tol=1e-12)
    assert abs(result["b.f"].at(1.5)) < 1e-15


@flips(2)
@pytest.mark.parametrize("kind", ["0", "1"])
def test_controlled_junction_off(way, kind) -> None:
    # OFF 1-junction: no flow on any bond; OFF 0-junction: no effort on any bond
    m = hb.Model("off")
    if kind == "1":
        m.add(c=hb.C(1.0, e=3.0), s=hb.Se(5.0), j=hb.One(), r=hb.R(1.0))
    else:
        m.add(c=hb.I(1.0, f=3.0), s=hb.Sf(5.0), j=hb.Zero(), r=hb.R(1.0))
    m.bond(arrow("j", "c", way[0]), arrow("j", "s", way[1]), "j -> r")
    m.machine("m", states={"off": [], "on": ["j"]}, start="off")
    result = run(m)
    # own frame of c: what is stored stays
    name = "c.q" if kind == "1" else "c.p"
    np.testing.assert_allclose(result[name].at(T), 3.0, rtol=1e-14)
    net = result["j.e" if kind == "1" else "j.f"].at(1.0)
    # the net counts in minus out; the effort of an I on a 0-junction is its own, its flow turns
    own = sign(way[0]) * 3.0 if kind == "1" else 3.0
    want = -(own + sign(way[1]) * 5.0)
    assert math.isclose(net, want, rel_tol=1e-12)
