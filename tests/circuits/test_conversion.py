"""What becomes of cards: against closed forms, and against the same circuit written otherwise."""

import math
from itertools import pairwise

import numpy as np
import pytest

import hybond as hb

DIODE = ".model DX D(IS=1e-14 N=0.01)"


@pytest.fixture
def convert(tmp_path):
    def read(*rows, **options):
        path = tmp_path / "test.cir"
        path.write_text("\n".join(["Title", *rows, ".end"]))
        return hb.read_circuit(path, **options)

    return read


@pytest.fixture
def simulate(convert):
    def run(*rows, until=None, parameters=None, **options):
        return hb.simulate(convert(*rows, **options).model, until=until, parameters=parameters)

    return run


def printed(run, k=0):
    """The k-th signal of ``.print``."""
    return run[run.graph.experiment["plot"][k]]


def kinds(model):
    return sorted(part.kind for part in model.elements.values())


class TestStructure:
    def test_a_series_circuit_is_one_junction(self, convert):
        model = convert("V1 a 0 1", "R1 a b 1", "L1 b c 1", "C1 c 0 1", ".tran 1 1 uic").model
        assert kinds(model) == ["1", "C", "I", "R", "Se"]
        assert sorted(model.bonds) == ["V1 -> i_L1 -> R1", "i_L1 -> C1", "i_L1 -> L1"]

    def test_a_parallel_circuit_is_one_junction(self, convert):
        model = convert("I1 0 a 1", "R1 a 0 1", "L1 a 0 1", "C1 0 a 1", ".tran 1 1 uic").model
        assert kinds(model) == ["0", "C", "I", "R", "Sf"]
        assert sorted(model.bonds) == ["I1 -> a -> R1", "a -> C1", "a -> L1"]

    def test_a_buck_converter_is_that_of_the_textbook(self, convert):
        model = convert(
            "V1 in 0 24", "S1 in sw g 0 SX", "D1 0 sw DX", "L1 sw out 1m", "C1 out 0 1u",
            "R1 out 0 5", "Vg g 0 PULSE(0 5 0 1n 1n 5u 10u)", ".model SX SW(VT=2 RON=0)",
            ".model DX D(Ron=0 Vfwd=0)", ".tran 1u 1m uic",
        ).model  # fmt: skip
        bonds = {tuple(b.split(" -> ")) for b in model.bonds}
        pairs = {pair for b in bonds for pair in pairwise(b)}
        assert pairs == {
            ("V1", "S1"), ("S1", "sw"), ("D1", "sw"), ("sw", "i_L1"), ("i_L1", "L1"),
            ("i_L1", "out"), ("out", "C1"), ("out", "R1"),
        }  # fmt: skip
        assert model.elements["D1"].options == {"law": "diode"}

    def test_a_bridge_keeps_its_nodes(self, convert):
        model = convert(
            "V1 a 0 1", "R1 a b 1", "R2 a c 1", "R3 b c 1", "R4 b 0 1", "R5 c 0 1"
        ).model
        assert kinds(model).count("0") == 3
        assert {"b", "c"} <= set(model.elements)

    def test_names_are_those_of_the_netlist(self, convert):
        model = convert(
            ".param V1=3", "V1 1 0 {V1}", "X1 1 2 f", "R.a 2 0 1", ".subckt f p q", "R1 p m 1",
            "C1 m q 1", ".ends", ".tran 1 1 uic",
        ).model  # fmt: skip
        assert {"V1", "X1_R1", "X1_C1", "R_a"} <= set(model.elements)
        assert model.elements["V1"].value == "V1_value"
        assert model.parameters == {"V1_value": 3}

    def test_what_carries_no_current_is_left_out(self, convert):
        conversion = convert("V1 a 0 1", "R1 a 0 1", "R2 a b 1", "C2 b c 1u", "L3 c d 1m")
        assert {"R2", "C2", "L3"}.isdisjoint(conversion.model.elements)
        assert len(conversion.warnings) == 3

    def test_an_isolated_side_is_joined_without_its_reference_resistor(self, convert):
        rows = ["V1 a 0 SIN(0 10 50)", "R1 a b 1", "L1 b 0 1", "L2 s t 4", "R2 s t 100"]
        rows += ["K1 L1 L2 0.9", "Rref t 0 1meg", ".print tran v(s,t) v(s)", ".tran 1m 20m uic"]
        conversion = convert(*rows)
        assert "Rref" not in conversion.model.elements
        assert len(conversion.warnings) == 1
        # no current, so t is at ground; v(s,t) and v(s) are one signal
        assert len(conversion.model.experiment["plot"]) == 1


class TestSigns:
    @pytest.mark.parametrize("swap", ["", "R", "L", "C", "RL", "LC", "RLC"])
    def test_a_decay_whichever_way_its_elements_are_written(self, simulate, swap):
        def ends(kind, a, b):
            return f"{b} {a}" if kind in swap else f"{a} {b}"

        u, i = (-3 if "C" in swap else 3), (-0.5 if "L" in swap else 0.5)
        run = simulate(
            f"R1 {ends('R', 'a', 'b')} 2", f"L1 {ends('L', 'b', '0')} 1 ic={i}",
            f"C1 {ends('C', 'a', '0')} 0.1 ic={u}", ".print tran v(a) v(b)", ".tran 0.01 2 uic",
        )  # fmt: skip
        # C u' = -i, L i' = u - R i
        a = np.array([[0.0, -10.0], [1.0, -2.0]])
        values, vectors = np.linalg.eig(a)
        for t in (0.0, 0.4, 2.0):
            x = vectors @ (np.exp(values * t) * np.linalg.solve(vectors, [3.0, 0.5]))
            # v(a) and v(a) - v(b) = R i do not know how elements are written
            found = [printed(run).at(t), printed(run).at(t) - printed(run, 1).at(t)]
            assert found == pytest.approx([x[0].real, 2 * x[1].real], rel=1e-7)

    @pytest.mark.parametrize("ahead", [True, False])
    @pytest.mark.parametrize("series", ["R1 b 0 1", "R1 b m 0.5\nC9 m 0 1k\nR2 m 0 0.5"])
    def test_a_diode_conducts_from_its_anode(self, simulate, ahead, series):
        run = simulate(
            "V1 a 0 SIN(0 1 1)", f"D1 {'a b' if ahead else 'b a'} DX", *series.split("\n"),
            DIODE, ".print tran i(V1)", ".tran 0.01 1 uic",
        )  # fmt: skip
        sign = 1 if ahead else -1
        begin, end = (0.25, 0.75) if ahead else (0.75, 0.25)
        # i(V1) is counted into its plus: while the diode conducts, that is minus the load's
        assert -sign * printed(run).at(begin) > 0.4
        assert printed(run).at(end) == pytest.approx(0.0, abs=1e-9)

    def test_antiparallel_diodes_conduct_both_ways_and_antiseries_none(self, simulate):
        both = simulate("V1 a 0 SIN(0 1 1)", "D1 a b DX", "D2 b a DX", "R1 b 0 1", DIODE,
                        ".print tran i(V1)", ".tran 0.01 1 uic")  # fmt: skip
        assert -printed(both).at(0.25) == pytest.approx(0.99, abs=0.01)
        assert -printed(both).at(0.75) == pytest.approx(-0.99, abs=0.01)
        none = simulate("V1 a 0 SIN(0 1 1)", "D1 a m DX", "D2 b m DX", "R1 b 0 1", "R2 m 0 1k",
                        "R3 b m 1meg", DIODE, ".print tran v(b)", ".tran 0.01 1 uic")  # fmt: skip
        assert printed(none).at(0.25) == pytest.approx(0.0, abs=1e-4)

    @pytest.mark.sampled(3)
    @pytest.mark.parametrize("k", [0.8, 1])
    @pytest.mark.parametrize(
        "load", ["R2 b 0 100", "R2 b c 50\nR3 c 0 50", "R2 b 0 100\nC2 b 0 1u"]
    )
    @pytest.mark.parametrize("feed", ["R1 a p 5\nL1 p 0 10m", "R1 a 0 5\nL1 a 0 10m"])
    def test_a_coil_that_is_turned_has_the_opposite_coupling(self, convert, k, load, feed):
        def of(coil, sign):
            return convert(
                "V1 a 0 SIN(0 10 1k)", *feed.split("\n"), coil, f"K1 L1 L2 {sign * k}",
                *load.split("\n"), ".print tran v(b)", ".tran 1u 2m uic",
            ).model  # fmt: skip

        turned, straight = of("L2 0 b 40m", -1), of("L2 b 0 40m", 1)
        other = of("L2 0 b 40m", 1)
        t = np.linspace(0, 2e-3, 41)[1:-1].tolist()

        def wave(model):
            return np.asarray(hb.simulate(model)[model.experiment["plot"][0]].at(t))

        assert wave(turned) == pytest.approx(wave(straight), rel=1e-6, abs=1e-6)
        assert wave(other) == pytest.approx(-wave(straight), rel=1e-6, abs=1e-6)
        assert np.abs(wave(straight)).max() > 1

    @pytest.mark.parametrize("k", [0.8, 1])
    @pytest.mark.parametrize("feed", ["L1 a 0 10m", "R1 a p 5\nL1 p 0 10m"])
    @pytest.mark.parametrize("ends", ["b 0", "0 b"])
    def test_an_open_winding_shows_what_is_induced(self, simulate, k, feed, ends):
        run = simulate(
            "V1 a 0 SIN(0 10 1k)", *feed.split("\n"), f"L2 {ends} 40m", f"K1 L1 L2 {k}",
            ".print tran v(b) i(V1)", ".tran 1u 2m uic",
        )  # fmt: skip
        sign = 1 if ends == "b 0" else -1
        for t in np.linspace(0.1e-3, 1.9e-3, 11):
            drop = -5 * printed(run, 1).at(t) if "R1" in feed else 0.0
            induced = k * 2 * (10 * math.sin(2000 * math.pi * t) - drop)
            assert printed(run).at(t) == pytest.approx(sign * induced, rel=1e-6, abs=1e-6)

    def test_a_rigid_transformer_steps_voltage_up_by_its_turns(self, simulate):
        run = simulate("V1 a 0 SIN(0 10 1k)", "L1 a 0 1", "L2 b 0 9", "K1 L1 L2 1", "R2 b 0 90",
                       ".print tran v(b) i(V1)", ".tran 1u 1m uic")  # fmt: skip
        t = 0.25e-3
        assert printed(run).at(t) == pytest.approx(30.0, rel=1e-6)
        # load current 1/3 A, times 3, and what magnetises
        w = 2 * math.pi * 1000
        magnetising = 10 / w * (1 - math.cos(w * t))
        assert -printed(run, 1).at(t) == pytest.approx(1.0 + magnetising, rel=1e-6)


class TestSources:
    @pytest.mark.parametrize(
        ("source", "value"),
        [
            ("SIN(1 2 50 5m 30 45)", None),
            ("PULSE(-1 3 1m 1m 2m 3m 10m)", None),
            ("EXP(1 -2 2m 1m 8m 3m)", None),
            ("PWL(1m 1 4m -2 4m 3 9m 0)", None),
            ("SFFM(1 2 100 3 20)", None),
            ("SFFM(1 2 100 3 20 30 60)", None),
            ("SFFM(1 2 100 3 20 0 -60)", None),
            ("DC 4 AC 1", None),
            ("PULSE(0 1 2m 1m)", None),
        ],
    )
    def test_functions_of_time(self, simulate, source, value):
        run = simulate(f"V1 a 0 {source}", "R1 a b 1", "C1 b 0 1", ".tran 1m 20m uic")
        deg = math.pi / 180

        def wanted(t):
            if source.startswith("SIN"):
                s = max(t - 5e-3, 0.0)
                return 1 + 2 * math.sin(2 * math.pi * 50 * s + 45 * deg) * math.exp(-30 * s)
            if source.startswith("PULSE(-1"):
                s = (t - 1e-3) % 10e-3 if t >= 1e-3 else 0.0
                return float(np.interp(s, [0, 1e-3, 4e-3, 6e-3, 10e-3], [-1, 3, 3, -1, -1]))
            if source.startswith("EXP"):
                v = 1.0
                if t > 2e-3:
                    v += -3 * (1 - math.exp(-(t - 2e-3) / 1e-3))
                if t > 8e-3:
                    v += 3 * (1 - math.exp(-(t - 8e-3) / 3e-3))
                return v
            if source.startswith("PWL"):
                if t < 4e-3:
                    return float(np.interp(t, [1e-3, 4e-3], [1, -2]))
                return float(np.interp(t, [4e-3, 9e-3], [3, 0]))
            if source.startswith("SFFM"):
                words = [float(x) for x in source[5:-1].split()]
                ahead, within = words[5:] or (0.0, 0.0)
                inner = 3 * math.sin(2 * math.pi * 20 * t + within * deg)
                return 1 + 2 * math.sin(2 * math.pi * 100 * t + ahead * deg + inner)
            if source.startswith("DC"):
                return 4.0
            return float(np.interp(t, [2e-3, 3e-3], [0, 1]))

        for t in np.linspace(0.1e-3, 19.9e-3, 57):
            assert run["V1.e"].at(float(t)) == pytest.approx(wanted(float(t)), abs=1e-9)

    def test_parameters_stay_parameters(self, convert):
        rows = [".param D=0.3 T=1m U={2*3}", "V1 a 0 PULSE(0 {U} 0 1u 1u {D*T} {T})", "R1 a b 1",
                "C1 b 0 1m", ".tran 1u 20m uic"]  # fmt: skip
        model = convert(*rows).model
        low = hb.simulate(model)["C1.e"].at(0.02)
        high = hb.simulate(model, parameters={"D": 0.6})["C1.e"].at(0.02)
        other = hb.simulate(convert(*[r.replace("D=0.3", "D=0.6") for r in rows]).model)
        assert high == pytest.approx(other["C1.e"].at(0.02), rel=1e-9)
        assert high > 1.5 * low
        assert hb.loads(hb.dumps(model)).parameters["U"] == "2*3"

    def test_subcircuits_take_parameters(self, simulate):
        run = simulate(
            ".param Rx=10", "V1 a 0 12", "X1 a b div R={Rx*2}", "X2 b 0 div", ".print tran v(b)",
            ".subckt div p q R=5", ".param half={R/2}", "R1 p m {half}", "X1 m q one R={half}",
            ".ends", ".subckt one p q R=1", "Rr p q {R}", ".ends", until=1,
        )  # fmt: skip
        assert printed(run).at(0.5) == pytest.approx(12 * 5 / 25)


class TestStarts:
    def test_node_voltages_of_ic_start_capacitors(self, simulate):
        run = simulate("R1 a 0 1k", "C1 a b 1u", "C2 0 b 1u", "R2 b 0 1k", ".ic V(a)=5 V(b)=2",
                       ".print tran v(a) v(b)", ".tran 1u 1m uic")  # fmt: skip
        first, second = run.graph.experiment["plot"]
        assert run[first].at(0.0) == pytest.approx(5.0)
        assert run[second].at(0.0) == pytest.approx(2.0)

    def test_without_uic_the_nodes_of_ic_are_held_until_the_start(self, simulate):
        run = simulate("V1 a 0 10", "R1 a b 1k", "C1 b 0 1u", ".ic V(b)=4", ".tran 1u 5m")
        assert run["C1.e"].at(1e-3) == pytest.approx(10 - 6 * math.exp(-1), rel=1e-6)

    def test_the_operating_point_is_at_rest(self, simulate):
        run = simulate("V1 a 0 10", "R1 a b 2", "L1 b c 1m", "R2 c 0 3", "C1 c 0 1u", ".tran 1u 1m")
        for t in (0.0, 5e-4, 1e-3):
            assert run["L1.f"].at(t) == pytest.approx(2.0)
            assert run["C1.e"].at(t) == pytest.approx(6.0)


class TestSwitches:
    def test_a_switch_that_starts_closed_stays_within_its_hysteresis(self, simulate):
        rows = ["V1 a 0 10", "S1 a b c 0 SX {}", "R1 b 0 9", "Vc c 0 PWL(0 2 1 2 2 0.5 3 4)"]
        rows += [".model SX SW(VT=2 VH=1 RON=1 ROFF=1e9)", ".print tran v(b)", ".tran 1m 4 uic"]
        for state, first in (("ON", 9.0), ("OFF", 0.0)):
            run = simulate(rows[0], rows[1].format(state), *rows[2:])
            assert printed(run).at(0.5) == pytest.approx(first)
            assert printed(run).at(1.9) == pytest.approx(0.0)
            assert printed(run).at(3.5) == pytest.approx(9.0)
        closes = [e.t for e in run.events[1:]]
        assert closes[-1] == pytest.approx(2 + 2.5 / 3.5)

    @pytest.mark.parametrize("ends", ["a b", "b a"])
    @pytest.mark.parametrize("state", ["", "ON", "OFF"])
    def test_a_switch_with_ron_above_roff_opens_where_others_close(self, simulate, ends, state):
        run = simulate(
            "V1 a 0 10", f"S1 {ends} c 0 SX {state}", "R1 b 0 9",
            "Vc c 0 PWL(0 2 1 2 2 0.5 3 4)", ".model SX SW(VT=2 VH=1 RON=1e9 ROFF=1)",
            ".print tran v(b)", ".tran 1m 4 uic",
        )  # fmt: skip
        # within the hysteresis it is as it began, and ON is RON
        assert printed(run).at(0.5) == pytest.approx(0.0 if state == "ON" else 9.0)
        assert printed(run).at(1.9) == pytest.approx(9.0)
        assert printed(run).at(3.5) == pytest.approx(0.0)
        assert run.events[-1].t == pytest.approx(2 + 2.5 / 3.5)

    def test_an_inverted_switch_keeps_the_resistance_beside_it(self, simulate):
        run = simulate(
            "V1 a 0 10", "S1 a b c 0 SX", "R1 b 0 1k", "Vc c 0 PULSE(0 1 1 1m 1m 5)",
            ".model SX SW(VT=0.5 RON=9k ROFF=1k)", ".print tran v(b)", ".tran 1m 2 uic",
        )  # fmt: skip
        assert printed(run).at(0.5) == pytest.approx(5.0)
        assert printed(run).at(1.5) == pytest.approx(1.0)

    def test_an_inverted_switch_follows_a_current(self, simulate):
        run = simulate("V1 a 0 PWL(0 0 1 1)", "Vm a m 0", "R1 m 0 1", "V2 p 0 5", "W1 p q Vm WX",
                       "R2 q 0 4", ".model WX CSW(IT=0.25 RON=1e12 ROFF=1)", ".print tran v(q)",
                       ".tran 1m 1 uic")  # fmt: skip
        assert [e.t for e in run.events[1:]] == pytest.approx([0.25])
        assert printed(run).at(0.1) == pytest.approx(4.0)
        assert printed(run).at(0.9) == pytest.approx(0.0)

    @pytest.mark.parametrize("values", ["RON=2 ROFF=2", "RON=1k ROFF=-1", "RON=-1 ROFF=1k"])
    def test_resistances_that_cannot_be_those_of_a_switch_are_refused(self, convert, values):
        with pytest.raises(hb.FileError) as caught:
            convert("V1 a 0 10", "S1 a b a 0 SX", "R1 b 0 9", f".model SX SW({values})")
        assert caught.value.code == "HB-F140"

    def test_a_resistance_beside_a_switch_that_is_not_large_stays(self, simulate):
        run = simulate(
            "V1 a 0 10", "S1 a b c 0 SX", "R1 b 0 1k", "Vc c 0 PULSE(0 1 1 1m 1m 5)",
            ".model SX SW(VT=0.5 RON=1k ROFF=9k)", ".print tran v(b)", ".tran 1m 2 uic",
        )  # fmt: skip
        assert printed(run).at(0.5) == pytest.approx(1.0)
        assert printed(run).at(1.5) == pytest.approx(5.0)

    def test_a_switch_follows_a_current(self, simulate):
        run = simulate("V1 a 0 PWL(0 0 1 1)", "Vm a m 0", "R1 m 0 1", "V2 p 0 5", "W1 p q Vm WX",
                       "R2 q 0 4", ".model WX CSW(IT=0.25 RON=1)", ".print tran v(q)",
                       ".tran 1m 1 uic")  # fmt: skip
        assert [e.t for e in run.events[1:]] == pytest.approx([0.25])
        assert printed(run).at(0.9) == pytest.approx(4.0)


class TestDiodes:
    def test_the_tangent_of_the_characteristic(self, convert):
        rows = ["V1 a 0 1", "D1 a b DX 2", "R1 b 0 1", ".model DX D(IS=1e-12 N=1.5 RS=0.4)"]
        model = convert(*rows, diode_current="20 mA").model
        vt, s, i = 1.380649e-23 * 300.15 / 1.602176634e-19, 2e-12, 0.02
        slope = 1.5 * vt / (i + s)
        drop = 1.5 * vt * math.log(1 + i / s) - slope * i
        read = hb.simulate(model, until=1)
        assert read["D1_drop.e"].at(0) == pytest.approx(drop, rel=1e-4)
        found = read["D1_R.e"].at(0) / read["D1_R.f"].at(0)
        assert found == pytest.approx(slope + 0.2, rel=1e-4)

    def test_what_is_left_out_is_said(self, convert):
        conversion = convert("V1 a 0 1", "D1 a b DX", "R1 b 0 1",
                             ".model DX D(IS=1e-14 CJO=1p BV=100)", ".options reltol=1e-3",
                             ".four 1k v(b)")  # fmt: skip
        text = "\n".join(map(str, conversion.warnings))
        assert "CJO" in text.upper() and "backward" in text
        assert ":5:" in text and ":6:" in text and ":7:" in text

    @pytest.mark.parametrize(
        ("card", "line"),
        [
            # BV + NBV Vt ln(i/IBV) + RS i, of which 1e-3 Vt is nothing
            ("D(IS=1e-14 N=1 BV=10 IBV=10m NBV=1e-3 RS=2)", (10.0, 2.0)),
            ("D(Ron=0.1 Vfwd=0.5 Vrev=10 Rrev=2)", (10.0, 2.0)),
            ("D(Ron=2 Vfwd=0.5 Vrev=10)", (10.0, 2.0)),
        ],
    )
    def test_a_zener_diode_holds_its_voltage(self, convert, card, line):
        rows = ["V1 in 0 SIN(15 5 100)", "R1 in o 100", "D1 0 o DZ", "RL o 0 500",
                f".model DZ {card}", ".tran 10u 20m", ".print tran i(D1)"]  # fmt: skip
        conversion = convert(*rows)
        run = hb.simulate(conversion.model)
        drop, resistance = line
        for t in (0.0, 2.5e-3, 6e-3):
            source = 15.0 + 5.0 * math.sin(200.0 * math.pi * t)
            v = (source / 100.0 + drop / resistance) / (1 / 100.0 + 1 / 500.0 + 1 / resistance)
            current = (source - v) / 100.0 - v / 500.0
            assert run["o.e"].at(t) == pytest.approx(v, rel=1e-3)
            assert run["i_D1"].at(t) == pytest.approx(-current, rel=2e-2)
        assert run["o.e"].max() == pytest.approx(run["o.e"].at(2.5e-3), rel=1e-9)

    @pytest.mark.parametrize(
        "current", ["auto", {"D1": "10 mA", "x1.d1": 10, "D2_back": 0.02, "D2": 0.02}]
    )
    def test_each_diode_at_its_own_current(self, convert, current):
        rows = ["I1 0 a 10m", "D1 a 0 DX", "I2 0 b 10", "X1 b 0 sub", "I3 0 c 20m", "D2 0 c DX",
                ".subckt sub p m", "D1 p m DX", ".ends",
                ".model DX D(IS=1e-12 N=1.2 RS=0.01 BV=5.1 IBV=5m)", ".tran 1m 1"]  # fmt: skip
        conversion = convert(*rows, diode_current=current)
        run = hb.simulate(conversion.model)
        vt = 1.380649e-23 * 300.15 / 1.602176634e-19
        for node, i in {"a": 0.01, "b": 10.0}.items():
            v = 1.2 * vt * math.log1p(i / 1e-12) + 0.01 * i
            assert run[f"{node}.e"].at(1) == pytest.approx(v, rel=1e-4)
        back = 5.1 + 1.2 * vt * math.log(0.02 / 5e-3) + 0.01 * 0.02
        assert run["c.e"].at(1) == pytest.approx(back, rel=1e-4)

    @pytest.mark.parametrize("current", [{"D9": 1}, {"D1": 0}, {"D1": "x"}])
    def test_currents_of_diodes_that_cannot_be(self, convert, current):
        with pytest.raises(hb.UsageError, match="HB-F140"):
            convert("I1 0 a 1", "D1 a 0 DX", ".model DX D(IS=1e-14)", diode_current=current)

    def test_breakdown_clamps_a_coil(self, convert):
        # 24 V against the coil: its current ends after L I/24 s, and all of its energy is gone
        rows = ["I1 0 a PWL(0 1 1m 1 1.000001m 0)", "L1 a b 24m", "R0 b 0 1n", "Ra a 0 1meg",
                "D1 a 0 DZ", ".model DZ D(N=1e-3 IS=1e-14 BV=24 IBV=1 RS=0)",
                ".tran 1u 3m"]  # fmt: skip
        run = hb.simulate(convert(*rows).model)
        assert run["L1.f"].at(1.5e-3) == pytest.approx(0.5, abs=3e-3)
        assert run["L1.f"].at(2.5e-3) == pytest.approx(0.0, abs=1e-3)

    def test_the_current_of_a_part_has_that_of_its_leak(self, convert):
        rows = ["V1 a 0 -1", "D1 a b DX", "V2 b 0 0", "S1 a 0 g 0 SW", "Vg g 0 0",
                ".model DX D(Ron=1 Roff=1k)", ".model SW SW(VT=1 RON=1 ROFF=2k)",
                ".tran 1m 1", ".print tran i(D1) i(V1)"]  # fmt: skip
        run = hb.simulate(convert(*rows).model)
        assert run["i_D1"].at(0.5) == pytest.approx(-1e-3)
        assert run["i_V1"].at(0.5) == pytest.approx(1.5e-3)

    def test_a_breakdown_that_cannot_be(self, convert):
        with pytest.raises(hb.FileError, match="HB-F140"):
            convert("V1 a 0 1", "D1 a b DX", "R1 b 0 1", ".model DX D(BV=-10)")
        with pytest.raises(hb.FileError, match="HB-F140"):
            convert("V1 a 0 1", "D1 a b DX", "R1 b 0 1", ".model DX D(Ron=1 Vrev=-10)")

    @pytest.mark.parametrize("current", [0, -1, "1 V*", "nothing"])
    def test_a_current_that_cannot_be(self, convert, current):
        with pytest.raises(hb.UsageError):
            convert("V1 a 0 1", "R1 a 0 1", diode_current=current)


class TestFiles:
    def test_libraries_beside_the_netlist(self, tmp_path):
        (tmp_path / "parts").mkdir()
        (tmp_path / "parts" / "d.lib").write_text(
            "* diodes\n.lib fast\n.model DX D(N=2)\n.endl\n.lib slow\n.model DX D(N=0.01)\n.endl\n"
        )
        (tmp_path / "a.inc").write_text("R1 b 0 1\n* a comment\n")
        path = tmp_path / "a.cir"
        path.write_text(
            "Title\nV1 a 0 SIN( 0\n* in between\n+ 1 50 ) ; the mains\nD1 a b DX\n"
            '.lib "parts/d.lib" slow\n.include a.inc\n.tran 1m 20m uic\n.end\nnonsense\n'
        )
        conversion = hb.read_circuit(path)
        assert conversion.origins["R1"] == "a.inc:1: R1 b 0 1"
        assert any("d.lib:6" in str(w) for w in conversion.warnings)

    def test_windows_line_ends_and_no_end(self, tmp_path):
        path = tmp_path / "a.cir"
        path.write_bytes(b"Title\r\nV1 a 0 1\r\nR1 a 0\r\n+ 5\r\n")
        assert hb.read_circuit(path).model.elements["R1"].value == "5 ohm"
