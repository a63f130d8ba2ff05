"""Mixed-Boolean state equations in their several forms: text, matrices, numbers, transfer."""

from pathlib import Path

import numpy as np
import pytest

import hybond as hb

EXAMPLES = Path(__file__).parents[2] / "examples"
LINEAR = ["bouncing_ball", "capacitors_joined", "clutch_rigid", "diagnosis_circuit", "half_bridge"]


def load(name: str) -> hb.Model:
    return hb.load(EXAMPLES / f"{name}.toml")


def modes(graph):
    return list(np.ndindex(*(len(m.states) for m in graph.machines)))


@pytest.mark.parametrize("name", LINEAR)
def test_matrices_agree_with_the_numbers_of_each_mode(name) -> None:
    eq = hb.state_equations(load(name))
    for mode in modes(eq.graph):
        d = eq.at(mode)
        for letter in "EABCD":
            matrix = getattr(eq, letter)
            np.testing.assert_allclose(matrix.at(mode), getattr(d, letter), rtol=1e-14)
            np.testing.assert_array_equal(matrix.sparse(mode).toarray(), matrix.at(mode))


@pytest.mark.parametrize("name", LINEAR)
def test_sympy_with_numbers_put_in_is_the_mode(name) -> None:
    sympy = pytest.importorskip("sympy")
    eq = hb.state_equations(load(name))
    found = eq.sympy()
    values = {
        sympy.Symbol(eq.display.name(atom), real=True): value for atom, value in eq.values.items()
    }
    for mode in modes(eq.graph):
        kappa = {
            sympy.Symbol(eq.display.kappa(k), real=True): int(b.at(mode))
            for k, b in enumerate(eq.naming.booleans)
        }
        d = eq.at(mode)
        for letter in "EAB":
            numbers = found[letter].subs(kappa).subs(values)
            assert not numbers.free_symbols
            got = np.array(numbers.tolist(), dtype=float).reshape(numbers.shape)
            np.testing.assert_allclose(got, getattr(d, letter), rtol=1e-12)


def test_joined_capacitors_by_hand() -> None:
    """x1' + x2' = 0 always; open: x1' = 0; closed: equal voltages."""
    eq = hb.state_equations(load("capacitors_joined"))
    assert eq.text().splitlines()[:2] == [
        "(1 - κ)*C1.q' = κ*(C1.q/C1.C - C2.q/C2.C)",
        "C2.q' + κ*C1.q' = 0",
    ]
    assert not eq.explicit
    closed = eq.at({"switch": "closed"})
    assert closed.E.tolist() == [[0.0, 0.0], [1.0, 1.0]]
    assert closed.A.tolist() == [[1.0, -0.5], [0.0, 0.0]]


def test_rigid_clutch_by_hand() -> None:
    """Closed, the two inertias share one velocity and their momenta add."""
    eq = hb.state_equations(load("clutch_rigid"), outputs=["grip.e"])
    closed = eq.at({"clutch": "closed"})
    ratio = eq.values["p:rotor.I"] / eq.values["p:load.I"]
    motion = np.array([ratio / (1 + ratio), 1 / (1 + ratio)])  # shares of the common momentum
    assert closed.E @ np.array([0.0, *motion]) == pytest.approx([0.0, 0.0, 1.0])
    assert closed.A[1] @ np.array([0.0, *motion]) == pytest.approx(0.0)
    # the clutch's torque reads the rate of what has become dependent
    assert closed.F.any() and not eq.at({"clutch": "open"}).F.any()


@pytest.mark.parametrize("name", ["diagnosis_circuit", "clutch_rigid", "half_bridge"])
def test_transfer_functions_are_those_of_the_matrices(name) -> None:
    outputs = {"diagnosis_circuit": ["De1", "De3"], "clutch_rigid": ["load.f"]}.get(name, ["L.f"])
    for symbolic in (True, False):
        eq = hb.state_equations(load(name), outputs=outputs, symbolic=symbolic)
        for mode in modes(eq.graph):
            found = eq.transfer(mode)
            d = eq.at(mode)
            for s in (0.3 + 1.7j, -0.1 + 20j):
                want = d.response(s)
                for i, output in enumerate(eq.output_names):
                    for j, source in enumerate(eq.inputs):
                        got = found.response(output, source, s)
                        assert got == pytest.approx(want[i, j], rel=1e-10, abs=1e-14)


def test_transfer_function_of_a_filter() -> None:
    m = hb.Model("rlc", parameters={"R": "2 ohm", "L": "3 H", "C": "5 F"})
    m.add(V=hb.Se(1), j=hb.One(), r=hb.R("R"), i=hb.I("L"), c=hb.C("C"))
    m.bond("V -> j -> r", "j -> i", "j -> c")
    eq = hb.state_equations(m, outputs=["c.e", "i.f"])
    found = eq.transfer()
    assert found["c.e", "V"] == "1/(L*C*s^2 + R*C*s + 1)"
    assert found["i.f", "V"] == "C*s/(L*C*s^2 + R*C*s + 1)"
    poles = eq.at(()).poles()
    np.testing.assert_allclose(poles, np.sort_complex(np.roots([15.0, 10.0, 1.0])), rtol=1e-12)


def test_modulated_ratio_stays_a_formula() -> None:
    eq = hb.state_equations(load("rope_and_disc"))
    assert eq.text().splitlines()[0] == "mass.p' = -rope.q/rope.C + m*g"
    with pytest.raises(hb.HybondError) as caught:
        eq.at(())
    assert caught.value.code == "HB-Q101"
    assert eq.at((), values={"s:0": 0.3}).A.shape == (3, 3)


def test_nonlinear_law_has_a_name_and_no_matrix() -> None:
    m = hb.Model("tank", parameters={"k": 2.0})
    m.add(inflow=hb.Sf(1), tank=hb.C(3), level=hb.Zero(), valve=hb.Zero(), out=hb.R({"f": "k*e^3"}))
    m.bond("inflow -> level -> tank", "level -> valve -> out")
    eq = hb.state_equations(m)
    assert eq.text().splitlines() == [
        "tank.q' = -out.f + inflow",
        "where",
        "  out.f = k*out.e^3",
        "  out.e = tank.q/tank.C",
        "  inflow = 1",
    ]
    with pytest.raises(hb.HybondError) as caught:
        eq.at(())
    assert caught.value.code == "HB-Q103"


def test_nonlinear_law_behind_a_switch() -> None:
    """The law gives a flow that the shut valve forbids: the valve's effort follows from it."""
    m = hb.Model("tank", parameters={"k": 2.0})
    m.add(inflow=hb.Sf(1), tank=hb.C(3), level=hb.Zero(), valve=hb.One(), out=hb.R({"f": "k*e^3"}))
    m.bond("inflow -> level -> tank", "level -> valve -> out")
    m.machine("S", states={"shut": [], "open": ["valve"]}, start="shut")
    eq = hb.state_equations(m)
    assert eq.states == ("tank.q", "valve.e")
    assert eq.text({"S": "shut"}).splitlines()[1] == "0 = -out.f"
    assert eq.text({"S": "open"}).splitlines()[1] == "0 = -valve.e"


def test_large_resistor_network_has_no_short_formula() -> None:
    m = hb.Model("ladder")
    parts, bonds, before = {"V": hb.Se(1)}, [], "V"
    for k in range(20):
        parts |= {f"s{k}": hb.One(), f"r{k}": hb.R(1), f"z{k}": hb.Zero(), f"g{k}": hb.R(1)}
        bonds += [f"{before} -> s{k} -> z{k} -> g{k}", f"s{k} -> r{k}"]
        before = f"z{k}"
    m.add(**parts, c=hb.C(1))
    m.bond(*bonds, f"{before} -> c")
    with pytest.raises(hb.HybondError) as caught:
        hb.state_equations(m)
    assert caught.value.code == "HB-Q104"
    # the same in numbers: a ladder of equal ohms ends in ratios of Fibonacci numbers
    eq = hb.state_equations(m, symbolic=False)
    fibonacci = [1, 1]
    while len(fibonacci) < 43:
        fibonacci.append(fibonacci[-1] + fibonacci[-2])
    conductance = fibonacci[40] / fibonacci[39]
    assert eq.at(()).A[0, 0] == pytest.approx(-conductance, rel=1e-9)


def test_a_floating_circuit_has_its_transfer_function() -> None:
    """No node is ground: efforts float, what is stored does not."""
    m = hb.Model("floating")
    m.add(a=hb.Zero(), b=hb.Zero(), i=hb.One(), j=hb.One(), V=hb.Se(5), c=hb.C(1), r=hb.R(2))
    m.bond("b -> i -> a", "V -> i", "i -> r", "a -> j -> b", "j -> c")
    eq = hb.state_equations(m, outputs=["c.e"])
    assert eq.at(()).poles().tolist() == pytest.approx([-0.5])
    assert eq.transfer()["c.e", "V"] == "1/(c.C*r.R*s + 1)"
    row = hb.structure(m).rows[0]
    assert row.solvable and row.order == 1
    floating = hb.state_equations(m, outputs=["a.e"])
    assert floating.at(()).undetermined == ("a.e",)
    with pytest.raises(hb.EquationError) as caught:
        floating.transfer()
    assert caught.value.code == "HB-Q105"


def test_crank_at_dead_centre() -> None:
    """A modulus that passes through zero is multiplied out: J' = T, and the piston stands."""
    m = hb.Model("crank", parameters={"r": 0.1})
    m.add(T=hb.Se(5), w=hb.One(), J=hb.I(0.5), x=hb.TF("-r*sin(th)"), v=hb.One(), M=hb.I(2))
    m.signal(th=hb.Integral("w.f", start=0))
    m.bond("T -> w -> J", "w -> x.1", "x.2 -> v -> M")
    eq = hb.state_equations(m)
    assert "  th' = J.p/J.I" in eq.text().splitlines()
    d = eq.at((), values={"s:0": 0.0})
    # rows up to scale: J' = T; 0 = M.p
    j = d.E[:, 0] != 0.0
    assert d.B[j, 0] / d.E[j, 0] == pytest.approx([1.0]) and not d.E[j, 1].any()
    assert d.A[~j, 0] == [0.0] and d.A[~j, 1] != [0.0] and not d.E[~j].any()


def test_names_of_parameters_are_not_mistaken_for_ours() -> None:
    sympy = pytest.importorskip("sympy")
    m = hb.Model("rc", parameters={"s": 2.0, "κ": 3.0})
    m.add(V=hb.Se(1), j=hb.One(), r=hb.R("s"), c=hb.C("κ"))
    m.bond("V -> j -> r", "j -> c")
    m.machine("S", states={"on": ["j"], "off": []}, start="on")
    eq = hb.state_equations(m, outputs=["c.e"])
    assert eq.text().splitlines()[0] == "c.q' = λ*(V/s - c.q/(s*κ))"
    assert eq.transfer()["c.e", "V"] == "1/(s*κ*p + 1)"
    found = eq.transfer().sympy("c.e", "V")
    assert found.subs(sympy.Symbol("p", real=True), 0) == 1


def test_output_that_reads_its_input_has_one_transfer_function() -> None:
    """pw = 2 e - 3 f + u + q with u = f + e (1 ohm): (2 + C - 3 C s)/(C s + 1) + 1."""
    m = hb.Model("rc", parameters={"C": 2.0})
    m.add(V=hb.Se("u"), j=hb.One(), r=hb.R(1), c=hb.C("C"))
    m.input(u=hb.Input(constant=3.0))
    m.signal(pw="2*c.e - 3*r.f + u + c.q")
    m.bond("V -> j -> r", "j -> c")
    found = hb.state_equations(m, outputs=["pw"]).transfer()
    assert found.inputs == ("V",)
    s = 0.7j
    want = (2 + 2.0 - 3 * 2.0 * s) / (2.0 * s + 1) + 1
    assert found.response("pw", "V", s) == pytest.approx(want, rel=1e-14)


def test_state_feedback_belongs_to_the_states() -> None:
    m = hb.Model("fed", parameters={"k": 3.0})
    m.add(V=hb.Se("-k*c.q"), j=hb.One(), r=hb.R(2.0), c=hb.C(5.0))
    m.bond("V -> j -> r", "j -> c")
    eq = hb.state_equations(m)
    assert eq.inputs == ()
    assert eq.at(()).A[0, 0] == pytest.approx(-(3.0 + 1 / 5.0) / 2.0)


def test_booleans_keep_their_names() -> None:
    m = hb.Model("law")
    m.add(V=hb.Se(1), n=hb.Zero(), j=hb.One(), k=hb.One(), r1=hb.R(1), c=hb.C(1), c2=hb.C(1))
    m.add(r2=hb.R('if M.state == "b" then 5 else 2'))
    m.bond("V -> n -> j -> r1", "j -> c", "n -> k -> r2", "k -> c2")
    m.machine("M", states={"a": ["j"], "b": [], "d": []}, start="a")
    eq = hb.state_equations(m)
    first = str(eq)
    assert first == str(eq)
    assert all(eq.display.kappa(k) in first for k in range(len(eq.naming.booleans)))


def test_parameter_that_is_zero_is_named() -> None:
    m = hb.Model("z", parameters={"R": 0.0})
    m.add(V=hb.Se(1), j=hb.One(), r=hb.R("R"), c=hb.C(1), l=hb.I(1))
    m.bond("V -> j -> r", "j -> c", "j -> l")
    eq = hb.state_equations(m)
    assert eq.text().splitlines()[-1] == "# zero in this model, and left out: R"
    with pytest.raises(hb.EquationError) as caught:
        eq.at((), values={"p:R": 2.0})
    assert caught.value.code == "HB-Q108"


def test_flows_in_the_junction_matrix_are_those_along_the_arrows() -> None:
    m = hb.Model("away")
    m.add(V=hb.Se(1), j=hb.One(), l=hb.I(1), c=hb.C(1), r=hb.R(1))
    m.bond("V -> j -> c", "l -> j", "r -> j")
    jsm = hb.junction_matrix(m)
    assert jsm.S["c.q'", "l.f"] == "1" and jsm.S["r.f", "l.f"] == "1"
    eq = hb.state_equations(m, outputs=["l.f", "r.e"])
    assert eq.C["l.f", "l.p"] == "-1/l.I" and eq.A["c.q", "l.p"] == "-1/l.I"


def test_buck_converter_has_one_compact_form() -> None:
    """Both switches ON short the source: that mode has no equations, the other three share one."""
    m = hb.Model("buck")
    m.add(V=hb.Se(24), T=hb.One(), node=hb.Zero(), D=hb.One(), ground=hb.Se(0), i=hb.One())
    m.add(L=hb.I(2), out=hb.Zero(), C=hb.C(3), load=hb.R(5))
    m.bond("V -> T -> node -> i -> L", "ground -> D -> node", "i -> out -> C", "out -> load")
    m.machine("t", states={"off": [], "on": ["T"]}, start="off")
    m.machine("d", states={"off": [], "on": ["D"]}, start="off")
    eq = hb.state_equations(m)
    assert eq.kept == ()
    lines = eq.text().splitlines()
    assert lines[0] == (
        "κ_T*L.p' + κ_D*L.p' = κ_T*(V - C.q/C.C) - κ_D*C.q/C.C + (1 - κ_T)*(1 - κ_D)*L.p/L.I"
    )
    assert lines[-1] == "# not where κ_T*κ_D is 1: sources contradict each other"
    positions = (("on", "off"), ("off", "on"), ("off", "off"))
    on, wheel, idle = (eq.at({"t": t, "d": d}) for t, d in positions)
    for mode, supply in ((on, 1.0), (wheel, 0.0)):
        assert mode.E.tolist() == [[1.0, 0.0], [0.0, 1.0]]
        assert pytest.approx(np.array([[0.0, -1 / 3], [0.5, -1 / 15]])) == mode.A
        assert mode.B[:, 0] == pytest.approx([supply, 0.0])
    assert idle.E[0].tolist() == [0.0, 0.0] and idle.A[0].tolist() == [0.5, 0.0]
    both = {"t": "on", "d": "on"}
    with pytest.raises(hb.EquationError) as caught:
        eq.A.at(both)
    assert caught.value.code == "HB-Q106"
    with pytest.raises(hb.EquationError) as caught:
        eq.at(both).poles()
    assert caught.value.code == "HB-Q105"


def test_rows_that_close_kept_variables_are_no_values() -> None:
    """A row of the junction matrix that has no left-hand side is called 0."""
    m = hb.Model("buck")
    m.add(V=hb.Se(24), T=hb.One(), node=hb.Zero(), D=hb.One(), ground=hb.Se(0), L=hb.I(2))
    m.bond("V -> T -> node -> L", "ground -> D -> node")
    m.machine("t", states={"off": [], "on": ["T"]}, start="off")
    m.machine("d", states={"off": [], "on": ["D"]}, start="off")
    jsm = hb.junction_matrix(m)
    assert jsm.kept and jsm.outputs == ("L.p'", *["0"] * len(jsm.kept))
    assert not any(i >= 1 for i, _ in jsm.Q.entries)
    # transistor on, diode off: 0 = V + D.e - ..., L.p' is the node's effort, the source's
    on = jsm.S.at({"t": "on"})
    kept = on[1:, len(jsm.inputs) - len(jsm.kept) :]
    values = np.linalg.solve(kept, -on[1:, jsm.inputs.index("V")])
    whole = on[0, jsm.inputs.index("V")] + on[0, -len(jsm.kept) :] @ values
    assert whole == pytest.approx(1.0)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("turned", range(32))
def test_bonds_either_way_with_a_switch_that_closes_at_the_start(turned) -> None:
    """Closed: L C s^2 + (L/R) s + 1; open: s + 1/(R C). Which way arrows point says nothing."""
    bonds = ["V -> sw", "sw -> n", "n -> c", "sw -> l", "n -> r"]
    m = hb.Model("rlc")
    m.add(V=hb.Se(3), sw=hb.One(), n=hb.Zero(), c=hb.C(2.0, q=1.0), l=hb.I(0.5), r=hb.R(4.0))
    for k, bond in enumerate(bonds):
        a, b = bond.split(" -> ")
        m.bond(f"{b} -> {a}" if turned >> k & 1 else bond)
    rules = ["off -> on when time >= 0"]
    m.machine("S", states={"off": [], "on": ["sw"]}, start="off", rules=rules)
    eq = hb.state_equations(m)
    np.testing.assert_allclose(np.poly(eq.at({"S": "on"}).poles()), [1, 1 / 8, 1], rtol=1e-12)
    np.testing.assert_allclose(eq.at({"S": "off"}).poles(), [-1 / 8], rtol=1e-12)
    assert eq.at({"S": "off"}).E.tolist() != eq.at({"S": "on"}).E.tolist()
    run = hb.simulate(m, until=0.1)
    assert [e.t for e in run.events] == [0.0] and run.mode == {"S": "on"}


PLAIN = {"f": "50 Hz", "e": "2 V", "q": 3.0, "p": 2.0, "e1": 4.0, "f2": 5.0}


def plain(part, *, turned) -> hb.Model:
    """Parameters that have the names of an element's own variables."""
    m = hb.Model("plain", domain="electrical", parameters=PLAIN)
    m.add(V=hb.Se("e*sin(2*pi*f*time)"), i=hb.One(), L=hb.I("1 H"), x=part, j=hb.One(), C=hb.C(1))
    far = "x.1 -> i" if turned else "i -> x.1"
    m.bond("V -> i -> L", far, "x.2 -> j" if not turned else "j -> x.2", "j -> C")
    return m


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(
    ("part", "gains"),
    [
        # of L.p' by C.q, and of C.q' by L.p: turning both bonds of the transformer turns neither
        (hb.TF("q"), (-3.0, 3.0)),
        (hb.TF("p*q"), (-6.0, 6.0)),
        (hb.TF("e1"), (-4.0, 4.0)),
    ],
)
def test_a_plain_value_may_read_parameters_named_like_own_variables(part, gains, turned) -> None:
    m = plain(part, turned=turned)
    a = hb.state_equations(m).at(()).A
    np.testing.assert_allclose([a[0, 1], a[1, 0]], gains, rtol=1e-15)
    np.testing.assert_array_equal(a, hb.state_equations(m, symbolic=False).at(()).A)
    text = str(hb.state_equations(m))
    assert "V = e*sin(6.283185307179586*f*time)" in text
    assert "law:" not in text and "V.e" not in text


def test_values_of_a_field_may_read_parameters_named_like_own_variables() -> None:
    m = hb.Model("coils", domain="electrical", parameters=PLAIN)
    m.add(a=hb.R([["e1", "f2/10"], ["f2/10", "p"]]), j=hb.One(), k=hb.One(), L=hb.I(1), M=hb.I("q"))
    m.bond("j -> a.1", "j -> L", "k -> a.2", "k -> M")
    a = hb.state_equations(m).at(()).A
    np.testing.assert_allclose(a, [[-4, -0.5 / 3], [-0.5, -2 / 3]], rtol=1e-15)


def test_a_formula_reads_its_own_variables_all_the_same() -> None:
    m = hb.Model("own", domain="electrical", parameters=PLAIN)
    m.add(r=hb.R({"e": "p*f"}), j=hb.One(), L=hb.I(1))
    m.bond("j -> r", "j -> L")
    assert hb.state_equations(m).at(()).A.tolist() == [[-2.0]]


@pytest.mark.parametrize(
    ("kind", "letter", "bonds"),
    [
        ("I", "W", ("i -> field.1", "j -> field.2")),
        ("I", "W", ("field.1 -> i", "j -> field.2")),
        ("C", "K", ("i -> field.1", "field.2 -> j")),
        ("R", "", ("i -> field.1", "j -> field.2")),
    ],
)
def test_the_inverse_of_a_field_is_told_where_rates_read_it(kind, letter, bonds) -> None:
    """Its entries are numbers that the model does not say: the text has to."""
    m = hb.Model("field")
    matrix = [[1.0, 0.5], [0.5, 2.0]]
    m.add(field=getattr(hb, kind)(matrix), i=hb.One(), j=hb.One(), a=hb.R(1), b=hb.R(2))
    m.add(c=hb.C(1))
    m.bond(*bonds, "i -> a", "j -> b", "i -> c")
    text = str(hb.state_equations(m))
    note = f"# field.{letter} is the inverse of field.{kind}"
    assert (note in text.splitlines()) == bool(letter)
    if letter:
        inverse = np.linalg.inv(matrix)
        values = hb.state_equations(m).values
        found = [values[f"p:field.{letter}{k}"] for k in ("11", "12", "22")]
        assert found == pytest.approx([inverse[0, 0], inverse[0, 1], inverse[1, 1]])
        assert f"field.{letter}12" in text and f"% {note[2:]}" in hb.state_equations(m).latex()
