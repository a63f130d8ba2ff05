"""Words of ngspice and LTspice against closed forms."""

import math

import pytest

import hybond as hb
from hybond.circuits.fitting import fits
from hybond.circuits.measured import measure
from hybond.engine.outcome.signals import Signals
from hybond.units import parse_quantity

RC = ("R1 a b 1k", "C1 b 0 1u IC=0")
"""A time constant of 1 ms."""


@pytest.fixture
def measured(tmp_path):
    def run(*rows, name="test.net"):
        path = tmp_path / name
        path.write_text("\n".join(["Title", *rows, ".end"]))
        conversion = hb.read_circuit(path)
        result = hb.simulate(conversion.model)
        assert result.status == "ok"
        return measure(result, conversion.measures)

    return run


def test_measurements_of_a_charging_capacitor(measured):
    found = measured(
        "V1 a 0 1", *RC, ".tran 0 5m uic", ".meas tran mean AVG v(b) FROM=1m TO=3m",
        ".meas tran half WHEN v(b)=0.5", ".meas tran at FIND v(b) AT=2m",
        ".meas tran wide TRIG v(b) VAL=0.1 RISE=1 TARG v(b) VAL=0.9 RISE=1",
        ".meas tran sum INTEG v(b)", ".meas tran twice PARAM 2*at",
        ".meas tran slope DERIV v(b) AT=1m",
        ".meas tran never WHEN v(b)=2", ".meas tran size RMS v(a,b) FROM 0 TO 1m",
    )  # fmt: skip
    e = math.exp
    assert found.pop("never") is None
    assert found == pytest.approx(
        {
            "mean": 1 - (e(-1) - e(-3)) / 2, "half": 1e-3 * math.log(2), "at": 1 - e(-2),
            "wide": 1e-3 * math.log(9), "sum": 5e-3 - 1e-3 * (1 - e(-5)), "twice": 2 - 2 * e(-2),
            "slope": 1e3 * e(-1), "size": math.sqrt((1 - e(-2)) / 2),
        },
        rel=1e-6,
    )  # fmt: skip


@pytest.mark.sampled(3)
@pytest.mark.parametrize("start", ["2m", "{2*half}"])
@pytest.mark.parametrize(
    ("asked", "value"),
    [
        ("AVG v(a)", 0.75),
        ("INTEG v(a)", 1.5e-3),
        ("MIN v(a)", 0.5),
        ("AVG v(a) FROM=0", 0.5),
        ("AVG v(a) FROM=1m TO=3m", 0.5),
        ("WHEN v(a)=0.6", 2.4e-3),
        ("WHEN v(a)=0.4", None),
        ("WHEN v(b)=0.5 CROSS=1", 2.5e-3),
        ("TRIG v(b) VAL=0.5 RISE=1 TARG v(b) VAL=0.5 RISE=1 TD=3m", 1e-3),
        ("FIND v(a) AT=1m", 0.25),
    ],
)
def test_measurements_begin_where_the_output_begins(measured, start, asked, value):
    found = measured(
        "V1 a 0 PWL(0 0 4m 1)", "V2 b 0 PULSE(0 1 0 1m 1p 1p 1m)", "R1 a 0 1", "R2 b 0 1",
        ".param half=1m", f".tran 10u 4m {start} 1u", f".meas tran x {asked}",
    )  # fmt: skip
    assert found["x"] == (None if value is None else pytest.approx(value, rel=1e-6))


def test_the_analysis_of_a_control_section(measured):
    found = measured(
        "V1 a 0 1", *RC, ".control", "tran 1u 3m uic", "meas tran x FIND v(b) AT=1m", "plot v(b)",
        ".endc",
    )  # fmt: skip
    assert found["x"] == pytest.approx(1 - math.exp(-1), rel=1e-6)


def test_parasitics_on_a_card_are_parts(measured):
    found = measured(
        "V1 a 0 1 Rser=500", "R1 a b 300", "C1 b 0 1u Rser=200 IC=0", "R2 c 0 1k",
        "L1 a c 1 Rser=1k Rpar=1T", ".tran 0 1m uic", ".meas tran x FIND v(a) AT=0",
    )  # fmt: skip
    # at first the capacitor is a short circuit, and the coil carries nothing
    assert found["x"] == pytest.approx(0.5, rel=1e-6)


@pytest.mark.parametrize(
    ("wave", "mean"),
    [
        ("PULSE(0 1 0 1u 1u 8u 20u 2)", 18 / 100),  # two pulses of 9 us
        ("PULSE(0 1 0 2u 2u 30u 10u)", 0.9),  # each is cut off by the next
        ("PWL(0 0 5u 1 10u 0) r=0", 0.5),
        ("PWL REPEAT FOREVER (0 0 +5u 1 +5u 0) ENDREPEAT", 0.5),
        ("PWL(0 0 50u 1) td=50u", 0.25),
        ("SINE(1 1 10k 0 0 90 0)", 1.0),
        # 25 us into its period of 200 us when the run begins
        ("SIN(0 1 5k -25u)", math.sqrt(2) / math.pi),
    ],
)
def test_waves(measured, wave, mean):
    found = measured(f"V1 a 0 {wave}", "R1 a 0 1", ".tran 0 100u", ".meas tran x AVG v(a)")
    assert found["x"] == pytest.approx(mean, rel=1e-6, abs=1e-9)


def test_a_burst_of_sines_ends(measured):
    found = measured(
        "V1 a 0 SINE(1 2 10k 100u 0 0 3)", "R1 a 0 1", ".tran 0 1m",
        ".meas tran inside MAX v(a) FROM 100u TO 400u", ".meas tran after PP v(a) FROM 401u TO 1m",
        ".meas tran size INTEG (v(a)-1)*(v(a)-1)",
    )  # fmt: skip
    assert found["inside"] == pytest.approx(3.0, rel=1e-9)
    assert found["after"] == 0.0
    assert found["size"] == pytest.approx(2 * 300e-6, rel=1e-4)


def test_a_comparison_is_located(measured):
    rows = ("V1 a 0 PULSE(0 1 0 10u 1p 1p 10u)", "B1 b 0 V=if(V(a)>0.3,5,0)", "R1 b 0 1")
    found = measured(*rows, ".tran 0 100u", ".meas tran x AVG v(b)", ".meas tran t WHEN v(b)=2")
    assert found["x"] == pytest.approx(3.5, rel=1e-6)
    assert found["t"] == pytest.approx(3e-6, rel=1e-6)


@pytest.mark.parametrize(
    ("card", "value"),
    [
        ("E1 b 0 POLY(1) a 0 1 2 3", 1 + 2 * 3 + 3 * 9),
        ("E1 b 0 POLY(1) a 0 4", 12),
        ("E1 b 0 POLY(2) a 0 c 0 1 2 3", 1 + 6 + 6),
        ("E1 b 0 VALUE={V(a)*V(c) + limit(V(a),0,1)}", 7),
        ("E1 b 0 vol='V(a,c)*2'", 2),
        ("G1 0 b VALUE {V(a)**2 + u(-V(a))}", 9),
        ("B1 b 0 V = V(a) > V(c) && !(V(a) > 10) ? min(V(a),V(c)) : 7", 2),
        ("B1 b 0 V = if(V(a) > V(c) & !(V(a) > 10) | V(c) < 0, min(V(a),V(c)), 7)", 2),
        ("B1 b 0 V = V(c) < 0 | V(a) > 10 & V(a) > V(c) ? 1 : 7", 7),
        ("B1 b 0 V = (V(a)-2.6) & (V(a)>1) ? 1 : 7", 7),
        ("B1 b 0 V = (V(a)-2.6) && (V(a)>1) ? 1 : 7", 1),
        ("B1 b 0 V = (V(a)-2.4) | (V(a)<1)", 1),
        ("B1 0 b I = -I(V1)", 0.003),
        ("F1 0 b POLY(1) V1 1 1000", -2),
        ("B1 b 0 V = f(V(a), k)", 3 + 2 * 4),
        ("B1 b 0 V = time*1k", 2),
    ],
)
def test_sources_that_compute(measured, card, value):
    found = measured(
        "V1 a 0 3", "V2 c 0 2", "Ra a 0 1k", card, "R1 b 0 1", ".func f(x,y) {x+2*g(y)}",
        ".func g(y) {y*2}", ".param k=2", ".tran 0 2m", ".meas tran x FIND v(b) AT=2m",
    )  # fmt: skip
    assert found["x"] == pytest.approx(value, rel=1e-9)


def test_sources_come_up_after_startup(measured):
    found = measured(
        "V1 a 0 10", "R1 a 0 1", "I1 0 b 2", "R2 b 0 1", ".tran 0 40u startup",
        ".meas tran a FIND v(a) AT=5u", ".meas tran b FIND v(b) AT=30u", ".meas tran c AVG v(a)",
    )  # fmt: skip
    assert found == pytest.approx({"a": 2.5, "b": 2.0, "c": 7.5}, rel=1e-9)


def test_currents_of_coils_at_the_start(measured):
    found = measured(
        "L1 a 0 1m", "R1 a 0 1", ".ic i(L1)=2", ".tran 0 5m uic", ".meas tran x FIND I(L1) AT=1m"
    )
    assert found["x"] == pytest.approx(2 * math.exp(-1), rel=1e-6)


@pytest.mark.parametrize(
    ("text", "values"),
    [
        (".step param R list 1 2 5", (1, 2, 5)),
        (".step param R 1 2 0.1", tuple(1 + k / 10 for k in range(11))),
        (".step dec param R 1 100 1", (1, 10, 100)),
        (".step oct param R 1 8 1", (1, 2, 4, 8)),
    ],
)
def test_steps(tmp_path, text, values):
    path = tmp_path / "s.net"
    path.write_text(f"T\nV1 a 0 1\nR1 a 0 {{R}}\n{text}\n.tran 1m\n.end\n")
    ((name, found),) = hb.read_circuit(path).steps
    assert name == "R"
    assert found == pytest.approx(values)


def test_a_library_that_is_not_here_is_said_and_left_out(tmp_path):
    path = tmp_path / "a.net"
    path.write_text("T\nV1 a 0 1\nR1 a 0 1\n.lib C:\\lib\\standard.dio\n.tran 1m\n.end\n")
    (warning,) = hb.read_circuit(path).warnings
    assert "left out" in str(warning) and ":4:" in str(warning)
    path.write_text("T\nV1 a 0 1\nD1 a 0 X\n.lib C:\\lib\\standard.dio\n.tran 1m\n.end\n")
    with pytest.raises(hb.FileError, match="HB-F134"):
        hb.read_circuit(path)


@pytest.mark.parametrize("current", [1e-2, 1.0])
def test_a_diode_that_carries_another_current_is_told(tmp_path, current):
    path = tmp_path / "d.cir"
    path.write_text("T\nI1 0 a 10m\nD1 a 0 X\n.model X D(IS=1e-14)\n.tran 1u 1m\n.end\n")
    conversion = hb.read_circuit(path, diode_current=current)
    found = fits(hb.simulate(conversion.model), conversion.diodes)
    assert len(found) == (1 if current == 1.0 else 0)
    for fit in found:
        curve = 0.02586493 * math.log(1e-2 / 1e-14)
        drop = parse_quantity(conversion.model.elements["D1_drop"].value).value
        assert drop + 0.02586493 * 1e-2 - curve == pytest.approx(fit.apart, rel=1e-3)


def test_diodes_are_read_in_one_go_however_many(tmp_path, monkeypatch):
    """Twelve half waves: of a sine of peak I the mean weighted with the charge is pi/4 I."""
    rows = [f"D{k} a b{k} X\nR{k} b{k} 0 {k}\n" for k in range(1, 13)]
    card = ".model X D(IS=1e-14 N=0.02)\n.tran 50u 40m\n.end\n"
    path = tmp_path / "d.cir"
    path.write_text("T\nV1 a 0 SIN(0 100 50)\n" + "".join(rows) + card)
    conversion = hb.read_circuit(path)
    run = hb.simulate(conversion.model)
    read, of_points = [], Signals.of_points

    def counted(self, segments, which, t, expressions):
        read.append(len(t))
        return of_points(self, segments, which, t, expressions)

    monkeypatch.setattr(Signals, "of_points", counted)
    found = {fit.tangent.name: fit.carried for fit in fits(run, conversion.diodes)}
    assert found == pytest.approx({f"D{k}": math.pi / 4 * 100 / k for k in range(1, 13)}, rel=1e-3)
    for_all = sum(read)
    fits(run, conversion.diodes[:1])
    assert sum(read) == 2 * for_all


@pytest.mark.parametrize("leak", ["1k", "1meg"])
def test_a_clamp_that_carries_one_surge_early_in_the_run_is_taken_there(tmp_path, leak):
    """10 A for 50 ns of 200: ``N Vt ln(1 + i/IS) + RS i`` above the rail, and a little after."""
    path = tmp_path / "esd.cir"
    cards = "I1 0 x PULSE(0 10 10n 1n 1n 50n 1)", "D1 x r DI", "V1 r 0 3.3", "V2 q 0 3.5"
    rest = f"R1 q x {leak}", ".model DI D(IS=1e-14 N=0.5 RS=10m)", ".tran 1n 200n"
    path.write_text("\n".join(["esd", *cards, *rest, ".end", ""]))
    run = hb.simulate(hb.read_circuit(path, diode_current="auto").model)
    drop = 0.5 * 0.025864186 * math.log(1e15) + 0.1
    assert float(run["x.e"].at(4e-8)) == pytest.approx(3.3 + drop, abs=1e-3)


SCHEMATIC = """Version 4
SHEET 1 0 0
FLAG 0 0 in
FLAG 0 200 0
FLAG 64 200 0
WIRE 0 0 0 {top}
WIRE 0 {bottom} 0 200
WIRE 0 0 64 0
WIRE 64 0 64 {first}
WIRE 64 {second} 64 200
SYMBOL voltage {x} {y} {turn}
SYMATTR InstName V1
SYMATTR Value 2
SYMBOL res {rx} {ry} {rturn}
SYMATTR InstName R1
SYMATTR Value 4
TEXT 0 0 Left 2 !.tran 1m\\n.meas tran v FIND v(in) AT=0\\n.meas tran i FIND i(R1) AT=0
"""


@pytest.mark.parametrize(("turn", "x", "y", "sign"), [("R0", 0, 0, 1), ("R180", 0, 112, -1)])
@pytest.mark.parametrize(
    ("rturn", "rx", "ry", "way"),
    [("R0", 48, 0, 1), ("M0", 80, 0, 1), ("R180", 80, 112, -1), ("M180", 48, 112, -1)],
)
def test_pins_of_turned_symbols(tmp_path, turn, x, y, sign, rturn, rx, ry, way):
    path = tmp_path / "s.asc"
    path.write_text(
        SCHEMATIC.format(
            top=16, bottom=96, first=16, second=96, x=x, y=y, turn=turn, rx=rx, ry=ry, rturn=rturn
        )
    )
    conversion = hb.read_circuit(path)
    found = measure(hb.simulate(conversion.model), conversion.measures)
    assert found == pytest.approx({"v": 2 * sign, "i": 0.5 * sign * way})


def test_a_symbol_that_is_not_known(tmp_path):
    path = tmp_path / "s.asc"
    path.write_text("Version 4\nSYMBOL nmos 0 0 R0\nSYMATTR InstName M1\n")
    with pytest.raises(hb.FileError, match=r"HB-F136(.|\n)*nmos"):
        hb.read_circuit(path)


def test_parts_beside_each_other_are_counted_by_m(tmp_path):
    """The option m was not understood; counted or written one by one they are the same."""
    path = tmp_path / "m.cir"
    rows = ["m", ".param k=3", "V1 a 0 10", "R1 a b 1k {m}", "C1 b 0 1u IC=2 {n}", "L1 b c 1 {m}"]
    rows += ["R2 c 0 1k", "D1 c 0 DM {m}", ".model DM D(RON=10 VFWD=1)", ".tran 1u 5m uic", ".end"]
    path.write_text("\n".join(rows).format(m="m={k-1}", n="m=k") + "\n")
    counted = hb.simulate(hb.read_circuit(path).model)
    beside = [rows[3], rows[3].replace("R1", "R9"), *(f"C{i}{rows[4][2:]}" for i in range(3))]
    beside += [rows[5], rows[5].replace("L1", "L9"), *rows[6:8], "D9 c 0 DM", *rows[8:]]
    path.write_text("\n".join([*rows[:3], *beside]).format(m="", n="") + "\n")
    single = hb.read_circuit(path)
    run = hb.simulate(single.model)
    for name in ("v(b)", "v(c)"):
        for t in (1e-4, 1e-3, 4e-3):
            one = run[single.signal(name)].at(t)
            assert counted[single.signal(name)].at(t) == pytest.approx(one, rel=1e-6)


@pytest.mark.parametrize("row", ["L1 a 0 1m IC=1 m=2", "C1 a 0 1u Rser=1 m=2"])
def test_parts_that_m_does_not_just_multiply_are_refused(tmp_path, row):
    path = tmp_path / "m.cir"
    path.write_text(f"m\nV1 a 0 10\n{row}\n.tran 1u 5m uic\n.end\n")
    with pytest.raises(hb.FileError, match="HB-F130"):
        hb.read_circuit(path)


def test_a_resistance_that_reads_a_voltage_is_told_the_source_that_stands_for_it(tmp_path):
    path = tmp_path / "r.cir"
    rows = ["r", "V1 a 0 10", "R1 a b R='1k*(1+V(b)/10)'", "C1 b 0 1u", ".tran 1u 5m uic", ".end"]
    path.write_text("\n".join(rows) + "\n")
    with pytest.raises(hb.FileError, match="HB-F136") as caught:
        hb.read_circuit(path)
    rows[2] = caught.value.hint.removeprefix("write ")
    path.write_text("\n".join(rows) + "\n")
    found = hb.read_circuit(path)
    v = hb.simulate(found.model)[found.signal("v(b)")].at(5e-3)
    # dv/dt = (10 - v)/(1 + v/10) in ms: 20 ln(10/(10 - v)) - v = 10 t
    assert 20.0 * math.log(10.0 / (10.0 - v)) - v == pytest.approx(50.0, rel=1e-5)
