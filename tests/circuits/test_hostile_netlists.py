"""Netlists that are wrong, unusual or large: a refusal with the line, or an answer in seconds."""

import pytest

import hybond as hb

DIODE = ".model DX D(IS=1e-14)\n"
SWITCH = ".model SX SW(VT=1)\n"
GOOD = "V1 a 0 1\nR1 a 0 1\n"

WRONG = {
    # text, code, line
    "too few nodes": ("R1 a\n", "HB-F130", 2),
    "no value": ("R1 a 0\n", "HB-F130", 2),
    "two values": ("R1 a 0 1 2\n", "HB-F130", 2),
    "no number": (GOOD + "R2 a 0 much\n", "HB-F134", 4),
    "not a number": (GOOD + "R2 a 0 4k7k\n", "HB-F131", 4),
    "an ampere or an attoampere": ("I1 0 a 1A\nR1 a 0 1\n", "HB-F131", 2),
    "a unit in an expression": (GOOD + "I1 0 a {2*1Amp}\n", "HB-F131", 4),
    "a power of a power": (GOOD + "R2 a 0 {2^3^2}\n", "HB-F131", 4),
    "a power of a power, written otherwise": (GOOD + "R2 a 0 {2**3**2}\n", "HB-F131", 4),
    "a power of a negative number": (GOOD + "R2 a 0 {9+(-2)^3}\n", "HB-F131", 4),
    "a parameter of the one who uses it": (
        GOOD + ".param r=3\n.subckt s p q\nR1 p q {r}\n.ends\n.subckt t p q r=1\nX1 p q s\n"
        ".ends\nX1 a 0 t r=5\n",
        "HB-F134",
        6,
    ),
    "a root of a negative number": (GOOD + "R2 a 0 {(-8)^(1/3)}\n", "HB-F131", 4),
    "a pulse as long as the run": (
        "V1 a 0 PULSE(0 5 0 1u 1u 0 1m)\nR1 a 0 1\n.tran 1u 5m\n",
        "HB-F140",
        2,
    ),
    "half an expression": (GOOD + "R2 a 0 {1+}\n", "HB-F131", 4),
    "an unknown function": (GOOD + "R2 a 0 {system(1)}\n", "HB-F131", 4),
    "a division by zero": (GOOD + "R2 a 0 {1/0}\n", "HB-F131", 4),
    "a number that is too large": (GOOD + "R2 a 0 1e999\n", "HB-F131", 4),
    "an overflow": (GOOD + "R2 a 0 {1e300*1e300}\n", "HB-F131", 4),
    "brackets without end": (GOOD + "R2 a 0 {" + "(" * 500 + "1" + ")" * 500 + "}\n", "HB-F131", 4),
    "an open brace": (GOOD + "R2 a 0 {1\n", "HB-F130", 4),
    "an open bracket": ("V1 a 0 SIN(0 1 50\nR1 a 0 1\n", "HB-F130", 2),
    "a lone continuation": ("+ 1\n" + GOOD, "HB-F130", 2),
    "a strange letter": (GOOD + "?1 a 0 1\n", "HB-F130", 4),
    "an unknown option": (GOOD + "R2 a 0 1 w=2\n", "HB-F130", 4),
    "PWL without pairs": ("V1 a 0 PWL(0 1 2)\nR1 a 0 1\n", "HB-F130", 2),
    "nothing but a title": ("", "HB-F130", 0),
    "ends without subckt": (GOOD + ".ends\n", "HB-F130", 4),
    "subckt without ends": (GOOD + ".subckt s a b\nR1 a b 1\n", "HB-F130", 4),
    "wrong number of nodes": (
        GOOD + ".subckt s a b\nR1 a b 1\n.ends\nX1 a s\n",
        "HB-F130",
        7,
    ),
    "a library without the section": (GOOD + ".include .\n", "HB-F132", 4),
    "a folder": (GOOD + ".include ../\n", "HB-F132", 4),
    "itself": (GOOD + ".include wrong.cir\n", "HB-F132", 4),
    "an element twice": (GOOD + "r1 a 0 1\n", "HB-F133", 4),
    "a model twice": (GOOD + DIODE + DIODE, "HB-F133", 5),
    "a subcircuit twice": (
        GOOD + ".subckt s a b\nR1 a b 1\n.ends\n.subckt s a b\nR1 a b 1\n.ends\n",
        "HB-F133",
        7,
    ),
    "a parameter twice": (GOOD + ".param x=1\n.param X=2\n", "HB-F133", 5),
    "two analyses": (GOOD + ".tran 1 2\n.tran 1 2\n", "HB-F133", 5),
    "an unknown parameter": (GOOD + "R2 a 0 {x}\n", "HB-F134", 4),
    "an unknown model": (GOOD + "D1 a 0 DY\n" + DIODE, "HB-F134", 4),
    "an unknown subcircuit": (GOOD + "X1 a 0 s\n", "HB-F134", 4),
    "an unknown coil": (GOOD + "K1 L1 L2 1\n", "HB-F134", 4),
    "an unknown source": (GOOD + "F1 a 0 V2 1\n", "HB-F134", 4),
    "a source that is none": (GOOD + "F1 a 0 R1 1\n", "HB-F134", 4),
    "an unknown node": (GOOD + "E1 b 0 q 0 1\nR2 b 0 1\n", "HB-F134", 4),
    "an unknown output": (GOOD + ".print tran v(q)\n", "HB-F134", 4),
    "a parameter of itself": (GOOD + ".param x={y} y={x}\n", "HB-F135", 4),
    "a subcircuit in itself": (
        GOOD + ".subckt s a b\nR1 a b 1\nX1 a b s\n.ends\nX1 a 0 s\n",
        "HB-F135",
        6,
    ),
    "each in the other": (
        GOOD + ".subckt s a b\nX1 a b t\n.ends\n.subckt t a b\nX1 a b s\n.ends\nX1 a 0 s\n",
        "HB-F135",
        8,
    ),
    "a transistor": (GOOD + "Q1 a b 0 QX\n", "HB-F136", 4),
    "a MOSFET": (GOOD + "M1 a b 0 0 MX\n", "HB-F136", 4),
    "a behavioural source": (GOOD + "B1 a 0 Q=v(a)*2\n", "HB-F130", 4),
    "a line": (GOOD + "T1 a 0 b 0 Z0=50\n", "HB-F136", 4),
    "a value of a node that is not there": (
        GOOD + "E1 b 0 VALUE={v(q)*2}\nR2 b 0 1\n",
        "HB-F134",
        4,
    ),
    "a switch as diode": (GOOD + SWITCH + "D1 a 0 SX\n", "HB-F136", 5),
    "a diode as switch": (GOOD + DIODE + "S1 a 0 a 0 DX\n", "HB-F136", 5),
    "noise": ("V1 a 0 TRNOISE(1 1 0 0)\nR1 a 0 1\n", "HB-F136", 2),
    "only AC": (GOOD + ".ac dec 10 1 1k\n", "HB-F137", 4),
    "an unknown command": (GOOD + ".wave a.wav 16 44k v(a)\n", "HB-F137", 4),
    "a temperature that is stepped": (GOOD + ".step temp 1 2 3\n", "HB-F137", 4),
    "a step without values": (GOOD + ".step param x 1 2 -3\n", "HB-F140", 4),
    "a function of itself": (GOOD + ".func f(x) {f(x)}\n", "HB-F135", 4),
    "a function with too little": (GOOD + ".func f(x,y) {x+y}\nR2 a 0 {f(1)}\n", "HB-F131", 5),
    "too many pulses": ("V1 a 0 PULSE(0 1 0 1u 1u 1u 4u 1e9)\nR1 a 0 1\n", "HB-F140", 2),
    "no ground": ("V1 a b 1\nR1 a b 1\n", "HB-F138", 0),
    "an island": (GOOD + "R2 b c 1\nC2 b c 1u\n", "HB-F139", 4),
    "a current without way back": (GOOD + "I1 a b 1\n", "HB-F139", 4),
    "times that decrease": ("V1 a 0 PWL(1 1 0 2)\nR1 a 0 1\n", "HB-F140", 2),
    "thresholds the wrong way round": (
        GOOD + ".model SX VSWITCH(VON=1 VOFF=2)\nS1 a 0 a 0 SX\n",
        "HB-F140",
        5,
    ),
    "no inductance": (GOOD + "L1 a 0 0\n", "HB-F140", 4),
    "a coupled coil without inductance": (
        GOOD + "L1 a 0 1\nL2 b 0 0\nR2 b 0 1\nK1 L1 L2 1\n",
        "HB-F140",
        5,
    ),
    "a coupling above one": (GOOD + "L1 a 0 1\nL2 b 0 1\nR2 b 0 1\nK1 L1 L2 1.1\n", "HB-F140", 7),
    "a time that is none": (GOOD + ".tran 0 0\n", "HB-F140", 4),
    "couplings that make energy": (
        GOOD + "L1 a 0 1\nL2 b 0 1\nL3 c 0 1\nR2 b 0 1\nR3 c 0 1\n"
        "K1 L1 L2 0.9\nK2 L2 L3 0.9\nK3 L1 L3 -0.9\n",
        "HB-F141",
        9,
    ),
    "capacitors in series at rest": (
        "V1 a 0 1\nC1 a b 1u\nC2 b 0 1u\n.tran 1u 1m\n",
        "HB-F143",
        3,
    ),
    "coils in parallel at rest": (
        "V1 a 0 1\nR1 a b 1\nL1 b 0 1m\nL2 b 0 1m\n.tran 1u 1m\n",
        "HB-F143",
        4,
    ),
    "more than a thousand at rest": (
        GOOD + "\n".join(f"C{k} a 0 1u" for k in range(1000)) + "\n.tran 1u 1m\n",
        "HB-F143",
        0,
    ),
    "a short-circuited source": (GOOD + "V2 a a 1\n", "HB-F146", 4),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_is_wrong_is_refused_with_its_line(tmp_path, name):
    text, code, line = WRONG[name]
    path = tmp_path / "wrong.cir"
    path.write_text(f"Title\n{text}.end\n")
    with pytest.raises(hb.FileError) as caught:
        hb.read_circuit(path)
    assert caught.value.code == code
    assert caught.value.where == (f"{path}:{line}" if line else str(path))
    assert caught.value.hint


def test_not_text(tmp_path):
    path = tmp_path / "x.cir"
    path.write_bytes(b"Title\n\xff\xfe\n")
    with pytest.raises(hb.FileError) as caught:
        hb.read_circuit(path)
    assert caught.value.code == "HB-F104"


def test_files_that_include_each_other(tmp_path):
    (tmp_path / "a.cir").write_text("Title\n.include b.lib\nV1 a 0 1\nR1 a 0 1\n.end\n")
    (tmp_path / "b.lib").write_text(".include c.lib\n")
    (tmp_path / "c.lib").write_text("* nothing\n\n.include b.lib\n")
    with pytest.raises(hb.FileError) as caught:
        hb.read_circuit(tmp_path / "a.cir")
    assert (caught.value.code, caught.value.where) == ("HB-F132", f"{tmp_path / 'c.lib'}:3")


def test_a_link_out_of_the_folder_is_not_followed(tmp_path):
    inside = tmp_path / "in"
    inside.mkdir()
    (tmp_path / "secret.lib").write_text("R9 a 0 1\n")
    (inside / "link.lib").symlink_to(tmp_path / "secret.lib")
    (inside / "a.cir").write_text("Title\n.include link.lib\nV1 a 0 1\n.end\n")
    with pytest.raises(hb.FileError) as caught:
        hb.read_circuit(inside / "a.cir")
    assert caught.value.code == "HB-F132"


@pytest.mark.slow
def test_a_bomb_of_subcircuits(tmp_path):
    rows = ["Title", "V1 a 0 1", "R1 a 0 1"]
    for k in range(30):
        rows += [f".subckt s{k} p q", f"X1 p q s{k + 1}", f"X2 p q s{k + 1}", ".ends"]
    rows += [".subckt s30 p q", "R1 p q 1", ".ends", "X1 a 0 s0", ".end"]
    path = tmp_path / "bomb.cir"
    path.write_text("\n".join(rows))
    with pytest.raises(hb.FileError) as caught:
        hb.read_circuit(path)
    assert caught.value.code == "HB-F142"


def test_a_bomb_of_parameters(tmp_path):
    rows = ["Title", "V1 a 0 1", "X1 a 0 s P0=2", ".subckt s p q P0=1"]
    rows += [f".param P{k + 1}={{P{k}+P{k}-P{k}}}" for k in range(60)]
    rows += ["R1 p q {P60}", ".ends", ".end"]
    path = tmp_path / "bomb.cir"
    path.write_text("\n".join(rows))
    model = hb.read_circuit(path).model
    assert model.elements["X1_R1"].value == "2 ohm"


@pytest.mark.slow
def test_a_hundred_thousand_lines(tmp_path):
    count = 50_000
    rows = ["A ladder", "V1 n0 0 10"]
    for k in range(count):
        rows += [f"R{k} n{k} n{k + 1} 1k", f"C{k} n{k + 1} 0 1n"]
    path = tmp_path / "ladder.cir"
    path.write_text("\n".join([*rows, ".tran 1u 1m uic", ".end"]))
    model = hb.read_circuit(path).model
    kinds = [part.kind for part in model.elements.values()]
    assert kinds.count("R") == kinds.count("C") == count
    assert kinds.count("1") == count
    assert kinds.count("0") == count - 1  # the last C is in series with its R


@pytest.mark.slow
def test_ten_thousand_in_series_and_in_parallel(tmp_path):
    rows = ["Title", "V1 a 0 1"]
    rows += [f"R{k} {f'm{k}' if k else 'a'} m{k + 1} 1" for k in range(10_000)]
    rows += [f"C{k} m10000 0 1u" for k in range(10_000)]
    path = tmp_path / "many.cir"
    path.write_text("\n".join([*rows, ".tran 1 1 uic", ".end"]))
    kinds = [part.kind for part in hb.read_circuit(path).model.elements.values()]
    assert (kinds.count("1"), kinds.count("0")) == (1, 1)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (GOOD + ".trans 1u 1m\n", "did you mean '.tran'"),
        (GOOD + "Q1 a b 0 N\nM1 a b 0 0 N\n", "2 cards are of such kinds: Q1, M1"),
        # a node that is written in two ways: no current flows at all
        ("V1 in 0 5\nR1 in ouut 1k\nC1 out 0 1u\n", "nothing else is joined to ouut"),
        ("V1 in 0 5\nR1 in ouut 1k\nC1 out 0 1u\n", "nothing of the netlist is left"),
    ],
)
def test_a_slip_of_the_pen_is_told_its_remedy(tmp_path, text, said):
    path = tmp_path / "slip.cir"
    path.write_text("A title\n" + text)
    with pytest.raises(hb.FileError) as caught:
        hb.read_circuit(path)
    assert said in str(caught.value)


def test_the_node_at_which_a_part_hangs_loose_is_named(tmp_path):
    path = tmp_path / "loose.cir"
    path.write_text("A title\n" + GOOD + "R2 a lost 1\n.tran 1m 1 uic\n")
    (warning,) = hb.read_circuit(path).warnings
    assert str(warning).endswith(
        "R2 is left out: no current can pass it, nothing else is joined to lost"
    )


@pytest.mark.parametrize(
    ("parts", "named", "pair"),
    [
        ("R1 a b 1\nL1 b 0 1m\nL2 b 0 3m\n", "L1, L2", ("L1.f", "L2.f", 3.0)),
        ("L1 b 0 1m\nR1 a b 1\nL2 0 b 3m\n", "L1, L2", ("L1.f", "L2.f", 3.0)),
        ("C1 a b 1u\nC2 b 0 3u\n", "C1, C2", ("C1.e", "C2.e", 3.0)),
    ],
)
def test_what_is_to_be_written_for_a_start_is_said_and_serves(tmp_path, parts, named, pair):
    """From nothing they share by their sizes: the remedy is the line as it has to be."""
    path = tmp_path / "x.cir"
    path.write_text(f"Title\nV1 a 0 1\n{parts}.tran 1u 1m\n.end\n")
    with pytest.raises(hb.FileError) as caught:
        hb.read_circuit(path)
    line = 3 + parts.count("\n")
    assert f".tran 1u 1m uic in line {line}," in caught.value.hint
    assert f"IC= behind those of {named} that" in caught.value.hint
    path.write_text(path.read_text().replace(".tran 1u 1m", ".tran 1u 1m uic"))
    run = hb.simulate(hb.read_circuit(path).model)
    first, second, ratio = pair
    assert run[first].at(1e-3) == pytest.approx(ratio * run[second].at(1e-3), rel=1e-9)
    assert run[first].at(1e-3) != 0.0
