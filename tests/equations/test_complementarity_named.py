"""Complementarity systems of known devices, and the mode equations of models with laws."""

from __future__ import annotations

import numpy as np
import pytest

import hybond as hb


def rectifier() -> hb.Model:
    m = hb.Model("rectifier", domain="electrical")
    m.add(V=hb.Se("10"), d=hb.One(law="diode"), n=hb.Zero(), c=hb.C("2 F"), r=hb.R("4 ohm"))
    m.bond("V -> d -> n", "n -> c", "n -> r")
    return m


def ball(**options: object) -> hb.Model:
    m = hb.Model("ball", parameters={"M": "2 kg", "eps": 0.5}, domain="translational")
    m.add(i=hb.I("M"), w=hb.Se("-10 N"), v=hb.One(), c=hb.Zero(law="unilateral", **options))
    m.bond("w -> v -> i", "c -> v")
    m.signal(h=hb.Integral("v.f", start="1 m"))
    return m


# -- known systems


def test_a_ball() -> None:
    form = hb.complementarity(ball(gap="h", restitution="eps"))
    assert form.text().splitlines()[:4] == [
        "i.p' = w + l1",
        "w1 = i.p/M",
        "0 <= l1 ⟂ w1 >= 0 where h <= 0; elsewhere l1 = 0",
        "  in an impact 0 <= l1 ⟂ w1 + eps*pre(w1) >= 0",
    ]
    assert "  h' = w.f" in form.text() or "  h' = i.f" in form.text()
    n = form.numbers()
    assert [n[k].tolist() for k in "ABECDF"] == [[[0]], [[1]], [[1]], [[0.5]], [[0]], [[0]]]
    assert form.properties.passive and form.properties.degrees == (1,)


def test_the_diode_circuit_of_heemels_and_others() -> None:
    # L, C and R in a ring with a diode (Heemels, Schumacher and Weiland 2000, example 2.1 in other
    # letters): x1 charge, x2 flux linkage; x1' = x2/L; x2' = -x1/C - R x2/L + ..., diode in series
    m = hb.Model("lcr", domain="electrical")
    m.add(d=hb.One(law="diode"), c=hb.C("0.5 F"), i=hb.I("2 H"), r=hb.R("3 ohm"))
    m.bond("d -> c", "d -> i", "d -> r")
    form = hb.complementarity(m)
    n = form.numbers()
    np.testing.assert_allclose(n["A"], [[0, 0.5], [-2, -1.5]])
    np.testing.assert_allclose(n["E"], [[0], [1]])
    np.testing.assert_allclose(n["C"], [[0, 0.5]])
    assert form.A["i.p", "c.q"] == "-1/c.C" and form.A["i.p", "i.p"] == "-r.R/i.I"
    assert form.properties.degrees == (1,) and form.properties.passive


@pytest.mark.parametrize("value", [2.0, 3.0])
def test_values_of_parameters_can_be_put_in(value: float) -> None:
    form = hb.complementarity(ball())
    np.testing.assert_allclose(form.numbers({"p:M": value})["C"], [[1 / value]])


def test_friction_is_a_box() -> None:
    m = hb.Model("block", parameters={"mu": 0.5, "N": "10 N"}, domain="translational")
    m.add(F=hb.Se("4 N"), v=hb.One(law="coulomb", limit="mu*N", breakaway="8 N"), i=hb.I("2 kg"))
    m.bond("F -> v -> i")
    form = hb.complementarity(m)
    lines = form.text().splitlines()
    assert lines[:4] == [
        "i.p' = F + l1",
        "w1 = i.p/i.I",
        "-(mu*N) <= l1 <= mu*N, l1 = -(mu*N) where w1 > 0, mu*N where w1 < 0",
        "  at rest (w1 = 0) |l1| <= 8",
    ]
    assert form.laws[0].bounded == "given"
    # the friction force acts against the motion: l1 = -net is what it adds to the momentum's rate
    run = hb.simulate(m, until=1)
    assert run.final["i.p"] == 0.0


def test_a_limit_that_follows_a_contact() -> None:
    m = hb.Model("slider", parameters={"mu": 0.5}, domain="translational")
    m.add(c=hb.Zero(law="unilateral"), my=hb.I("1 kg"), vy=hb.One(), w=hb.Se("-10 N"))
    m.add(v=hb.One(law="coulomb", limit="mu*c.e"), mx=hb.I("1 kg", f="2 m/s"))
    m.bond("w -> vy -> my", "c -> vy", "v -> mx")
    text = hb.complementarity(m).text()
    assert "mu*c.e" in text and "l1 = c.e, force of c" in text


def test_a_constraint_and_the_rate_of_a_source() -> None:
    m = hb.Model("tied", domain="electrical")
    m.add(V=hb.Se("3 V*time/(1 s)"), n=hb.Zero(), c=hb.C("2 F"), d=hb.One(law="diode"))
    m.add(k=hb.C("1 F"), j=hb.Zero())
    m.bond("V -> n -> c", "n -> d -> j -> k")
    form = hb.complementarity(m)
    assert form.constraints == ("0 = V - c.q/c.C",)
    # c follows the source; k takes what the diode lets through
    assert form.inputs == ("V", "V'")
    assert form.B["c.q", "V'"] == "c.C" and form.E["k.q", "l1"] == "1"
    np.testing.assert_allclose(form.numbers()["E"], [[0], [1]])
    assert form.properties.passive


def test_an_active_source_is_not_passive() -> None:
    m = hb.Model("active")
    m.add(a=hb.C(1), n=hb.Zero(), f=hb.Sf("3*a.q"), d=hb.One(law="diode"), r=hb.R(1))
    m.bond("n -> a", "f -> n", "n -> d -> r")
    assert not hb.complementarity(m).properties.passive
    m = hb.Model("negative")
    m.add(a=hb.C(1), n=hb.Zero(), d=hb.One(law="diode"), r=hb.R(-1))
    m.bond("n -> a", "n -> d -> r")
    assert not hb.complementarity(m).properties.semidefinite


def test_a_nonlinear_graph_says_what_is_not_linear() -> None:
    m = hb.Model("cubic")
    m.add(V=hb.Se(1), d=hb.One(law="diode"), n=hb.Zero(), c=hb.C({"e": "q + q^3"}, q=2))
    m.add(r=hb.R(4))
    m.bond("V -> d -> n", "n -> c", "n -> r")
    form = hb.complementarity(m)
    assert form.nonlinear == ("the law of C c",) and form.point == {"c.q": 2.0}
    # slope of q + q^3 at 2: 13, value 10
    n = form.numbers()
    np.testing.assert_allclose(n["A"], [[-13 / 4]], rtol=1e-8)
    np.testing.assert_allclose(n["C"], [[13.0]], rtol=1e-8)
    np.testing.assert_allclose(n["c"], [[10 - 26 - 1]], rtol=1e-7)
    assert "# not linear: the law of C c\n# linearised at the start, t = 0, c.q = 2" in form.text()


def test_names_of_the_model_are_not_taken() -> None:
    m = rectifier()
    m.add(l1=hb.R(1))
    m.bond("n -> l1")
    assert hb.complementarity(m).given == ("λ1",)
    assert r"\lambda_{1}" in hb.complementarity(m).latex()


def test_a_machine_stays_in_the_mode_given() -> None:
    m = rectifier()
    m.add(k=hb.One(), s=hb.R("1 ohm"))
    m.bond("n -> k -> s")
    m.machine("S", states={"off": [], "on": ["k"]}, start="off")
    off = hb.complementarity(m).numbers()["A"]
    on = hb.complementarity(m, {"S": "on"}).numbers()["A"]
    np.testing.assert_allclose([off[0, 0], on[0, 0]], [-1 / 8, -1 / 8 - 1 / 2])


def test_sympy() -> None:
    sympy = pytest.importorskip("sympy")
    found = hb.complementarity(rectifier()).sympy()
    c, r = (s for s in sorted(found["A"].free_symbols, key=str))
    assert sympy.simplify(found["A"][0, 0] + 1 / (c * r)) == 0


# -- equations of modes: those of a machine written by hand


def by_hand(m: hb.Model, junction: str, states: dict[str, list[str]]) -> hb.Model:
    """Return the model with a machine in place of the law of a junction."""
    part = m.elements[junction]
    m.elements[junction] = hb.One() if part.kind == "1" else hb.Zero()
    m.machine("S", states=states, start=next(iter(states)))
    return m


@pytest.mark.parametrize("symbolic", [True, False])
def test_mode_equations_of_a_law_are_those_of_a_machine(symbolic: bool) -> None:
    law = hb.state_equations(rectifier(), symbolic=symbolic)
    hand = hb.state_equations(
        by_hand(rectifier(), "d", {"blocks": [], "conducts": ["d"]}), symbolic=symbolic
    )
    assert str(law).replace("d is", "S is") == str(hand)
    for mode in ((0,), (1,)):
        a, b = law.at(mode), hand.at(mode)
        for name in "EAB":
            np.testing.assert_allclose(getattr(a, name), getattr(b, name))


def test_an_impact_has_the_equation_of_a_rebound_written_by_hand() -> None:
    law = hb.state_equations(ball(gap="h", restitution="eps"))
    m = ball()
    m.elements["c"] = hb.Zero()
    rules = ["open -> impact when h <= 0", "impact -> open when pre(v.f) >= 0"]
    m.machine("S", states={"open": [], "impact": ["c"]}, start="open", rules=rules)
    m.add(rebound=hb.Sf("eps*pre(-v.f)"))
    m.bond("rebound -> c")
    hand = hb.state_equations(m)
    a, b = law.at({"c": "impact"}), hand.at({"S": "impact"})
    # a row without a rate: 0 = i.p/M - ..., of either sign
    np.testing.assert_allclose([a.E, np.abs(a.A)], [b.E, np.abs(b.A)])
    assert a.E[0, 0] == 0.0 and a.A[0, 0] == 0.5
    assert "eps*max(0, pre(-v.f))" in law.text({"c": "impact"})
    # and closed is no impact
    np.testing.assert_allclose(np.abs(law.at({"c": "closed"}).A), [[0.5]])
    assert "pre" not in law.text({"c": "closed"})


@pytest.mark.parametrize("make", [rectifier, lambda: ball(gap="h", restitution="eps")])
def test_other_views_take_models_with_laws(make) -> None:
    m = make()
    assert hb.junction_matrix(m).text()
    assert "reference mode" in str(hb.causality(m))
    found = str(hb.structure(m))
    assert "solvable" in found
    for text in (str(hb.state_equations(m)), hb.state_equations(m).latex()):
        assert text


def test_the_limit_of_friction_is_a_formula_of_parameters_in_mode_equations() -> None:
    m = hb.Model("block", parameters={"mu": 0.5, "N": 10.0})
    m.add(F=hb.Se(4), v=hb.One(law="coulomb", limit="mu*N"), i=hb.I(2))
    m.bond("F -> v -> i")
    text = hb.state_equations(m).text({"v": "forward"})
    assert "mu*N" in text and text.startswith("i.p' = F - ")
    descriptor = hb.state_equations(m).at({"v": "sticks"})
    # at rest nothing moves: 0 = i.p
    assert descriptor.E[0, 0] == 0.0


# -- limits that follow a force that they act on: no property of D says that there is an answer


def rod(mu: float) -> hb.Model:
    """A rod that stands on a rough floor and slides (Painleve)."""
    m = hb.Model("rod", domain="translational")
    m.add(mx=hb.I(1.0, f=1.0), my=hb.I(1.0), vx=hb.One(), vy=hb.One(), weight=hb.Se(-9.81))
    m.add(rotor=hb.I(1.0 / 12.0, domain="rotational"), w=hb.One(domain="rotational"))
    m.add(arm_n=hb.TF(-0.27), arm_t=hb.TF(0.42), tangent=hb.Zero())
    m.add(contact=hb.Zero(law="unilateral"), slip=hb.One(law="coulomb", limit=f"{mu}*contact.e"))
    m.bond("vx -> mx", "weight -> vy -> my", "w -> rotor", "contact -> vy", "contact -> arm_n.2")
    m.bond("arm_n.1 -> w", "vx -> tangent -> slip", "w -> arm_t -> tangent")
    return m


B, C, TORQUE = 0.4, 0.2, 3.0


def shoe(mu: float) -> hb.Model:
    """A lever that a torque presses on a drum: N*b = torque + mu*N*c, if the drum turns into it."""
    m = hb.Model("shoe", domain="translational")
    m.add(push=hb.Se(-TORQUE, domain="rotational"), w=hb.One(domain="rotational"))
    m.add(lever=hb.I(0.1, domain="rotational"), arm=hb.TF(B), side=hb.TF(C), drum=hb.Sf(1.0))
    m.add(contact=hb.Zero(law="unilateral"), tangent=hb.Zero())
    m.add(slip=hb.One(law="coulomb", limit=f"{mu}*contact.e"))
    m.bond("push -> w -> lever", "contact -> arm.2", "arm.1 -> w")
    m.bond("drum -> tangent -> slip", "w -> side -> tangent")
    return m


def wedge(mu: float) -> hb.Model:
    """A load on a slope that a diode of force presses, and whose friction lifts it."""
    m = hb.Model("wedge", domain="translational")
    m.add(mx=hb.I(1.0, f=1.0), my=hb.I(1.0), vx=hb.One(), vy=hb.One(), weight=hb.Se(-9.81))
    m.add(floor=hb.Zero(law="unilateral"), lift=hb.TF(0.5), along=hb.Zero())
    m.add(slip=hb.One(law="coulomb", limit=f"{mu}*floor.e"))
    m.bond("vx -> mx", "weight -> vy -> my", "floor -> vy")
    m.bond("vx -> along -> slip", "vy -> lift -> along")
    return m


@pytest.mark.parametrize("make", [rod, shoe, wedge])
def test_a_limit_that_follows_a_force_it_acts_on_is_told_with_the_properties(make) -> None:
    form = hb.complementarity(make(0.3))
    text = form.text()
    assert len(form.properties.follow) == 1
    assert "the limit of" in text and "no answer, or several" in text and "e-12" not in text
    constant = hb.complementarity(make(0.0)).text()
    assert "no answer, or several" not in constant


@pytest.mark.parametrize("mu", [0.2, 1.0, 1.8])
def test_a_shoe_that_its_friction_presses_on_the_drum(mu: float) -> None:
    run = hb.simulate(shoe(mu), 0.1)
    assert float(run["contact.e"].at(0.05)) == pytest.approx(TORQUE / (B - mu * C), rel=1e-9)


def test_a_shoe_that_locks_has_no_answer() -> None:
    # beyond mu = b/c no force holds the lever away from the drum
    with pytest.raises(hb.NumericsError, match="HB-J110"):
        hb.simulate(shoe(1.2 * B / C), 0.1)


@pytest.mark.parametrize("symbolic", [True, False])
@pytest.mark.parametrize(
    ("law", "held"),
    [
        ("g", {"constant": "2 S"}),
        ("exp(g/(1 [S]))*1 [S]", {"constant": np.log(2.0)}),
        ("g", {"table": [[0, 2], [1, 3]]}),
        ("if time < 1 [s] then 2*g else g", {"constant": 1}),
    ],
)
def test_coefficients_that_read_inputs_have_the_numbers_of_the_start(
    law: str, held: dict[str, object], symbolic: bool
) -> None:
    """A tap as an input, behind a diode, ended in a KeyError; one that time turns in HB-Q101."""
    m = hb.Model("tap", domain="electrical")
    m.add(I=hb.Sf("1 A"), a=hb.C("1 F"), n=hb.Zero(), d=hb.One(law="diode"), z=hb.Zero())
    m.add(b=hb.C("4 F"), tap=hb.G(law))
    m.bond("I -> n -> d -> z", "a -> n", "z -> b", "tap -> z" if symbolic else "z -> tap")
    m.input(g=hb.Input(**held))
    form = hb.complementarity(m, symbolic=symbolic)
    at = form.states.index("b.q")
    assert form.numbers()["A"][at, at] == pytest.approx(-2.0 / 4.0)
    assert form.properties.passive
    if symbolic:
        said = "linearised at the start" if "if" in law else "# numbers are those with g = "
        assert said in form.text()
