"""What netlists of people who never saw hybond ran into, against closed forms."""

import math

import pytest

import hybond as hb
from hybond.circuits.measured import measure


@pytest.fixture
def read(tmp_path):
    def made(*rows):
        path = tmp_path / "test.cir"
        path.write_text("\n".join(["Title", *rows, ".end"]))
        return hb.read_circuit(path)

    return made


@pytest.fixture
def measured(read):
    def run(*rows):
        conversion = read(*rows)
        result = hb.simulate(conversion.model)
        assert result.status == "ok"
        return measure(result, conversion.measures)

    return run


@pytest.mark.parametrize(
    ("law", "value"),
    [
        ("V = {k}*V(a) - {m}", 2 * 3 - 7),
        ("V = {k*2}*abs(V(a)-{m})/10", 4 * 4 / 10),
        ("V = min(max(-{m}, {k}*V(a)*100), {m})", 7),
        ("V = {k+m}", 9),
        ("V={{k}*V(a)}", 6),
        ("V = V(a) > {k} ? {m} : -{m}", 7),
        ("V = V(a) > (V(a) > 5 ? 4 : 2) ? {m} : -{m}", 7),
        ("V = (V(a) > 2 ? 1 : 8) >= V(a) ? {m} : -{m}", -7),
        ("V = (V(a) > 2 && V(a) < 4) < V(a) ? {m} : -{m}", 7),
    ],
)
def test_parameters_in_braces_within_an_expression(measured, law, value):
    found = measured(
        ".param k=2 m=7", "V1 a 0 3", "R0 a 0 1k", f"B1 b 0 {law}", "R1 b 0 1",
        ".tran 0 1m", ".meas tran x AVG v(b)",
    )  # fmt: skip
    assert found["x"] == pytest.approx(value, rel=1e-12)


def test_a_brace_that_is_not_closed_is_refused(read):
    with pytest.raises(hb.FileError, match="is missing"):
        read("V1 a 0 3", "B1 b 0 V = {2*V(a)", "R1 b 0 1", ".tran 0 1m")


def test_the_rest_of_a_circuit_whose_values_are_parameters(measured):
    found = measured(
        ".param R=2k C={tau/R} tau=1m k=3", "V1 a 0 PULSE(6 0 0 1p 1p 1 2)", "R1 a b {R}",
        "R2 b 0 {2*R}", "C1 b 0 {C}", "X1 b c buffer gain={k}", "C2 c d {C}", "R3 d 0 {R}",
        ".subckt buffer i o gain=1", "E1 o 0 i 0 {gain}", ".ends",
        ".tran 0 2m", ".meas tran begin FIND v(b) AT=1n", ".meas tran later FIND v(b) AT=1m",
    )  # fmt: skip
    assert found["begin"] == pytest.approx(4.0, rel=1e-5)
    # discharged through R and 2R side by side
    assert found["later"] == pytest.approx(4.0 * math.exp(-1.5), rel=1e-6)


def test_a_step_whose_start_is_a_rest_says_with_which_values(read):
    rows = ("R1 a b 1k", "R2 b 0 {R}", "C1 b 0 1u", ".param R=1k", ".step param R list 1k 2k")
    said = read("V1 a 0 1", *rows, ".tran 0 1m").warnings
    assert any("all runs of the steps begin there" in str(w) for w in said)
    assert not read("V1 a 0 1", *rows, ".tran 0 1m uic").warnings


@pytest.mark.parametrize("tc", ["tc=0.001,2e-6", "tc=1m 2u", "tc1=1m tc2=2u", "tc=0.001, 0 "])
def test_coefficients_of_temperature(measured, tc):
    found = measured(
        "V1 a 0 10", f"R1 a b 1k {tc}", "R2 b 0 4k", ".tran 0 1m", ".meas tran x AVG v(b)"
    )
    assert found["x"] == pytest.approx(8.0, rel=1e-12)


INSIDE = ("X1 a b part", ".subckt part i o", "V1 i m 0", "R1 m o 3k", ".ends")


@pytest.mark.parametrize(
    "current",
    ["i(X1.V1)", "i(v.x1.v1)", "v.x1.v1#branch", "@r.x1.r1[i]", "-i(V1)", "-v1#branch", "@r2[i]"],
)
def test_currents_as_ngspice_calls_them(measured, current):
    found = measured(
        "V1 a 0 8", *INSIDE, "R2 b 0 1k", ".tran 0 1m", f".meas tran x AVG par('2*{current}')",
        f".print tran v(b) {current.lstrip('-')}",
    )  # fmt: skip
    assert found["x"] == pytest.approx(4e-3, rel=1e-12)


def test_a_source_that_drives_nothing_can_be_looked_at_after_the_run(read):
    deck = read(
        "V1 a 0 SIN(0 2 1k)", "R1 a 0 1k", "B1 w 0 V = V(a)*V(a)", "E1 d 0 a 0 3",
        "B2 c 0 V = V(a) > 1 ? 5 : 0", ".tran 0 2m",
    )  # fmt: skip
    run = hb.simulate(deck.model)
    assert run[deck.signal("v(w)")].mean() == pytest.approx(2.0, rel=1e-6)
    assert run[deck.signal("v(d)")].at(0.25e-3) == pytest.approx(6.0, rel=1e-6)
    # the third of a period in which a sine is above one half
    assert run[deck.signal("v(c)")].mean() == pytest.approx(5 / 3, rel=1e-6)


@pytest.mark.parametrize(
    ("law", "value"),
    [
        ("int(V(a)/4) - 10*int(-V(a)/4)", 1 + 10),
        ("nint(V(a)/4) + round(V(a)/2.9)", 2 + 2),
        ("stp(V(a)-1) + 2*stp(1-V(a))", 1),
        ("pwrs(-V(a), 1.5) + pwrs(V(a), 2)", 49 - 7**1.5),
        ("buf(V(a)) + 2*inv(V(a))", 1),
        ("asinh(V(a)) - asinh(-V(a))", 2 * math.asinh(7)),
        ("acosh(V(a)) + atanh(V(a)/10)", math.acosh(7) + math.atanh(0.7)),
        ("arcsin(V(a)/10) + arccos(V(a)/10)", math.pi / 2),
    ],
)
def test_functions_of_other_simulators(measured, law, value):
    found = measured(
        "V1 a 0 7", "R0 a 0 1k", f"B1 b 0 V = {law}", "R1 b 0 1", ".tran 0 1m",
        ".meas tran x AVG v(b)",
    )  # fmt: skip
    assert found["x"] == pytest.approx(value, rel=1e-12)


def test_a_function_that_simulators_disagree_on_is_refused(read):
    with pytest.raises(hb.FileError, match=r"pwrs\(x, y\)"):
        read("V1 a 0 7", "B1 b 0 V = pwr(V(a), 2)", "R1 b 0 1", ".tran 0 1m")


@pytest.mark.parametrize("nothing", ["0A", "0.0a", "-0Amps", "{0A}", "0e3A"])
def test_nothing_is_nothing_with_a_unit_that_may_be_a_factor(measured, nothing):
    found = measured(
        "V1 a 0 4", "R1 a b 2", f"L1 b 0 1m IC={nothing}", f"I1 0 b {nothing}", ".tran 0 2m uic",
        ".meas tran x FIND i(L1) AT=0.5m",
    )  # fmt: skip
    assert found["x"] == pytest.approx(2 * (1 - math.exp(-1)), rel=1e-6)


@pytest.mark.parametrize(
    ("card", "value"),
    [
        ("V1 a 0 dc=6", 6),
        ("V1 a 0 DC = {k} AC = 1", 6),
        ("V1 a 0 AC=1 DC=6", 6),
        ("V1 a 0 dc=1 PULSE(6 6 0 1u 1u 1 2)", 6),
        ("I1 0 a dc = 6m", 6),
    ],
)
def test_sources_with_an_equals_sign_before_their_value(measured, card, value):
    found = measured(card, "R1 a 0 1k", ".param k=6", ".tran 0 1m", ".meas tran x AVG v(a)")
    assert found["x"] == pytest.approx(value, rel=1e-9)


@pytest.mark.parametrize(
    ("command", "said"),
    [
        (".backanno", None),
        (".nodeset v(a)=1", ".nodeset is left out"),
        (".width out=80", "the width of what is printed is left out"),
    ],
)
def test_what_is_left_out_is_named(read, command, said):
    warnings = [str(w) for w in read("V1 a 0 1", "R1 a 0 1", command, ".tran 0 1m").warnings]
    assert len(warnings) == (said is not None)
    assert all(f":4: {said}" in w for w in warnings)


@pytest.mark.parametrize(
    ("couplings", "remedy"),
    [
        (("K1 L1 L2 .99", "K2 L1 L3 .99", "K3 L2 L3 .5"), "raise the smallest K"),
        (("K1 L1 L2 .9", "K2 L1 L3 .9"), "a K that is not written is a coupling of 0"),
        (("K1 L1 L2 1", "K2 L1 L3 .9"), "couple L3 and L2 by 0.9"),
        (("K1 L1 L2 -1", "K2 L1 L3 .9", "K3 L2 L3 .9"), "couple L3 and L2 by -0.9"),
        (("K1 L1 L2 .8", "K2 L1 L3 .6"), "make one K less"),
    ],
)
def test_couplings_that_no_coils_have_are_told_their_remedy(read, couplings, remedy):
    coils = ("L1 a 0 1m", "L2 b 0 1m", "R2 b 0 1", "L3 c 0 1m", "R3 c 0 1")
    with pytest.raises(hb.FileError, match=f"HB-F141(.|\n)*of L1, L2, L3(.|\n)*{remedy}"):
        read("V1 a 0 SIN(0 1 1k)", *coils, *couplings, ".tran 0 1m")


@pytest.mark.parametrize(
    "rows",
    [
        ("Bh h 0 V={5-V(q)}", "S2 x 0 h 0 SW", "L1 x o 1m", "R1 o 0 5"),
        ("Eh h 5 0 q 1", "V5 5 0 5", "S2 x 0 h 0 SW", "L1 x o 1m", "R1 o 0 5"),
        ("Bh h 0 V={5-V(q)}", "S2 x 0 h 0 SW", "R1 x o 10", "C1 o 0 1u"),
        ("S2 y 0 q 0 SW", "L2 in y 1m", "L1 x o 1m", "R1 o 0 5", "R2 x 0 100"),
    ],
    ids=["inverse", "inverse by E", "capacitor", "same gate"],
)
def test_switches_that_cross_at_one_gate_are_not_told_to_slide(read, rows):
    found = read(
        "V1 in 0 10", "Vt t 0 PULSE(0 5 0 1n 1n 40u 100u)", "Rt t tt 1k", "Ct tt 0 1n",
        "Vcc cc 0 5", "Sc cc q tt 0 SX", "Rq q 0 1k", "S1 in x q 0 SW", *rows,
        ".model SX SW(VT=2.5 VH=1 RON=1 ROFF=1g)", ".model SW SW(VT=2.5 VH=0 RON=10m ROFF=1g)",
        ".tran 1u 0.5m",
    )  # fmt: skip
    run = hb.simulate(found.model)
    assert len(run.events) > 8
    assert not run.sliding
    assert not run.warnings


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("card", "value"),
    [
        ("B1 b 0 V=V(a)+2", 2.0),
        ("E1 b 0 POLY(1) a 0 2 1", 2.0),
        ("B1 0 b I=2*cos(6*time)*exp(V(a))", 2.0),
        ("B1 0 b I={k}", 2.0),
        ("V2 b 0 SFFM(1 2 1k 2 100 30 0)", 2.0),  # 1 + 2 sin 30
        ("B1 b 0 V=2/(1+V(c)/2)", math.sqrt(5.0) - 1.0),  # v (1 + v/2) = 2
        ("B1 b 0 V=log(V(a))+2", None),
        ("B1 0 b I=V(b)/2", 0.0),  # nothing drives it
    ],
)
@pytest.mark.parametrize("side", ["c 0", "0 c"])
def test_sources_that_compute_count_in_the_rest_a_circuit_starts_from(read, card, value, side):
    """The sine is zero at the start, and the capacitor began with nothing."""
    rows = ["V1 a 0 SIN(0 1 1k)", card, "R1 b 0 1", "R2 b c 1", f"C1 {side} 1u", ".param k=2"]
    rows += [".tran 1u 2u"]
    if value is None:
        with pytest.raises(hb.HybondError):
            read(*rows)
        return
    conversion = read(*rows)
    start = float(hb.simulate(conversion.model)[conversion.signal("v(c)")].at(0.0))
    assert start == pytest.approx(value, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize(
    ("law", "value"),
    [
        ("V(a) >= 0 ? 3 : 1", 3),
        ("V(a) <= 0 ? 3 : 1", 3),
        ("V(a) > 0 ? 3 : 1", 1),
        ("V(a) < 0 ? 3 : 1", 1),
        ("3*!(V(a) < 0)", 3),
        ("0 >= V(0,a) ? 3 : 1", 3),
    ],
)
def test_what_is_equal_at_rest_is_compared_as_it_is_written(read, law, value):
    conversion = read(
        "V1 a 0 SIN(0 1 1k)", f"B1 b 0 V={law}", "R2 b c 1", "C1 c 0 1u", ".tran 1u 1m"
    )
    start = float(hb.simulate(conversion.model)[conversion.signal("v(c)")].at(0.0))
    assert start == pytest.approx(value)


def test_rows_that_are_chosen_are_told_what_to_write(read):
    with pytest.raises(hb.FileError, match=r"test.cir:3: rows that .if chooses") as told:
        read("V1 a 0 3", ".if (sel == 1)", "R1 a 0 1", ".endif", ".tran 0 1m")
    assert "write out the rows" in told.value.hint


PLAIN = ".model plain SW(VT=1 RON=1)"
HYSTERESIS = ".model hy SW(VT=5 VH=3 RON=1 ROFF=1g)"


@pytest.mark.parametrize(
    ("rows", "closed"),
    [
        # 4 V is between both thresholds; at 1.5 ms it dies away, and was e^37 times as much before
        (["B1 c 0 V=(time<1.5m) ? 4 : 4*exp(-(time-1.5m)/40u)"], False),
        (["B1 c 0 V=V(a)>1 ? 4 : 10"], False),
        (["B1 c 0 V=V(a)>1 ? 10 : 4"], True),
        (["B1 c 0 V=!(V(a)>1) ? 4 : 0", "R3 c 0 1"], False),
        (["V3 p 0 10", "R3 p c 1k", "S2 c d a 0 plain", "R4 d 0 666", PLAIN], False),
        (["S2 a d a 0 plain", "R4 d 0 1k", "B1 c 0 V=10-V(d)", PLAIN], False),
    ],
)
def test_a_hysteresis_is_not_latched_by_what_a_comparison_is_before_it_looks(read, rows, closed):
    """Comparisons began as not true, whatever they compare, and switches as open."""
    rows = ["V1 a 0 5", "V2 s 0 1", *rows, "S1 s x c 0 hy", "R1 x 0 999", HYSTERESIS]
    conversion = read(*rows, ".tran 10u 1m uic")
    start = float(hb.simulate(conversion.model)[conversion.signal("v(x)")].at(1e-4))
    assert start == pytest.approx(0.999 if closed else 0.0)


@pytest.mark.parametrize("model", ["VT=5.5 VH=3 RON=1 ROFF=1g", "VT=5.5 VH=3 RON=1g ROFF=1"])
def test_a_switch_begins_as_it_is_at_rest(read, model):
    """It is closed with 5 V, between its thresholds; open it had 10 V.

    It began open from 5 V on, went up to 8.5 V and fell.
    """
    conversion = read(
        "V1 a 0 10", "R1 a x 1k", "S1 x y x 0 hy", "R2 y 0 999", "C1 x 0 1u",
        f".model hy SW({model})", ".tran 10u 5m",
    )  # fmt: skip
    x = hb.simulate(conversion.model)[conversion.signal("v(x)")]
    assert [float(x.at(t)) for t in (0.0, 1e-3, 5e-3)] == pytest.approx([5.0] * 3)


@pytest.mark.parametrize(
    ("law", "low", "high", "first"),
    [
        ("V(c)<V(p) ? 5 : -5", -2.5, 2.5, -5.0),
        ("V(p)>V(c) ? 5 : -5", -2.5, 2.5, -5.0),
        ("V(c)<V(p)+1 ? 5 : -3", -0.5, 3.5, -3.0),
    ],
)
def test_an_oscillator_without_a_rest_starts_from_zero(read, law, low, high, first):
    rows = f"B1 o 0 V={law}\nR1 o p 10k\nR2 p 0 10k\nR3 o c 10k\nC1 c 0 100n\n.tran 1u 9m\n"
    deck = read(rows)
    (warning,) = (str(w) for w in deck.warnings if "rest" in str(w))
    assert "the start is that of uic" in warning
    # the whole reason: it was cut in the middle
    assert "time cannot advance at t = 0 s: the modes (" in warning and "..." not in warning
    assert warning.endswith("follow each other without end")
    run = hb.simulate(deck.model)
    # each side in its turn until the capacitor is at the divider's threshold
    times, at, level, levels = [], 0.0, 0.0, (-3.0 if "+1" in law else -5.0, 5.0)
    to = first
    while len(times) < 5:
        end = high if to > 0 else low
        at += 1e-3 * math.log((to - level) / (to - end))
        times.append(at)
        level, to = end, levels[0] if to > 0 else levels[1]
    assert [e.t for e in run.events if e.t > 0][:5] == pytest.approx(times, rel=1e-6)


@pytest.mark.parametrize(
    ("card", "said", "law"),
    [
        ("C2 out 0 C='1u*(1+0.1*V(out))'", "a capacitance that reads V(out)", "C = { e = '...' }"),
        ("C2 out 0 {1u + 1n*V(in)}", "a capacitance that reads V(in)", "C = { e = '...' }"),
        ("C2 out 0 Q='1u*x+0.1u*x^2'", "the law q=", "C = { e = '...' }, e of its charge q"),
        ("L2 out 0 Flux=1m*tanh(x)", "the law flux=", "I = { f = '...' }, f of its flux p"),
        ("l2 out 0 '1m/(1+I(V1)*I(V1))'", "an inductance that reads I(V1)", "I = { f = '...' }"),
    ],
)
def test_storage_that_bends_is_named_with_its_law(card, said, law, tmp_path) -> None:
    text = f"bent\nV1 in 0 SIN(0 5 1k)\nR1 in out 1k\n{card}\n.tran 1u 5m\n.end\n"
    (tmp_path / "bent.cir").write_text(text, encoding="utf-8")
    with pytest.raises(hb.ModelError) as refused:
        hb.read_circuit(tmp_path / "bent.cir")
    assert refused.value.code == "HB-F136"
    assert said in str(refused.value)
    assert law in str(refused.value)
    assert f"give {card.split()[0]} a law" in str(refused.value)
