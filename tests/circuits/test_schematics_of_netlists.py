"""A netlist is drawn as it is written: a symbol for each card, wired as its nodes say."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import pytest

import hybond as hb
from hybond.cli.main import main
from hybond.draw import Drawing, draw_schematic
from hybond.draw.scene import Line, Text
from hybond.errors import UsageError
from hybond.model.parts import SubmodelPart

NETLISTS = Path(__file__).parents[2] / "examples" / "netlists"
NAMES = ["boost", "bridge", "buck", "controlled", "doubler", "flyback", "half_wave", "rlc"]


def cards(path: Path) -> dict[str, tuple[str, str]]:
    """Return the two nodes of each card, read without hybond."""
    found = {}
    for line in path.read_text().splitlines()[1:]:
        words = line.split()
        if words and words[0][0].lower() in "rclvidsegfh":
            found[words[0]] = (words[1].lower(), words[2].lower())
    return found


@pytest.mark.parametrize("name", NAMES)
def test_each_card_is_a_part_between_its_nodes(name: str) -> None:
    path = NETLISTS / f"{name}.cir"
    model = hb.read_circuit(path).as_parts()
    wired: dict[str, str] = {}
    for bond in model.bonds:
        a, b = bond.split(" -> ")
        wired |= {end: node for end, node in ((a, b), (b, a)) if "." in end}
    own = cards(path)
    parts = {n for n in model.elements if f"{n}.plus" in wired}
    assert parts == set(own)
    # ports that have a node in common are the pins that have one
    node: dict[str, str] = {}
    for part, (a, b) in own.items():
        for port, key in (("plus", a), ("minus", b)):
            assert node.setdefault(key, wired[f"{part}.{port}"]) == wired[f"{part}.{port}"]
    assert len(set(node.values())) == len(node)


@pytest.mark.slow
def test_values_and_what_switches_stand_beside_the_parts() -> None:
    drawing = draw_schematic(hb.read_circuit(NETLISTS / "flyback.cir").as_parts())
    words = {m.text for g in drawing.scene.groups for m in g.marks if isinstance(m, Text)}
    assert {"200 µH, K1", "48 V", "SWI v(g,0)", "pulse", "10 Ω", "Lp", "out"} <= words


def test_gains_are_written_as_numbers_are(tmp_path: Path) -> None:
    text = "amp\nV1 in 0 1\nE1 out 0 in out 1e5\nR1 out 0 1k\n.tran 1u 1m\n.end\n"
    (tmp_path / "amp.cir").write_text(text)
    amp = hb.read_circuit(tmp_path / "amp.cir").as_parts().elements["E1"]
    assert isinstance(amp, SubmodelPart)
    assert list(amp.parameters.values()) == ["100000*v(in,out)"]


def test_what_is_in_subcircuits_is_drawn(tmp_path: Path) -> None:
    text = "two\n.subckt pair a b\nR1 a m 1\nR2 m b 2\n.ends\nV1 x 0 1\nX1 x 0 pair\nX2 x 0 pair\n"
    (tmp_path / "two.cir").write_text(text + ".tran 1u 1m\n.end\n")
    model = hb.read_circuit(tmp_path / "two.cir").as_parts()
    assert {"X1_R1", "X1_R2", "X2_R1", "X2_R2", "V1", "ground"} <= set(model.elements)
    assert len([n for n in model.elements if n.endswith("_m")]) == 2


def test_the_command_draws_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "buck.svg"
    assert main(["draw", str(NETLISTS / "buck.cir"), "--schematic", "--out", str(out)]) == 0
    assert ">D1<" in out.read_text()


def test_a_bond_graph_of_another_tool_has_none(tmp_path: Path) -> None:
    read = hb.read_circuit(NETLISTS / "rlc.cir")
    other = type(read)(read.model, (), {})
    with pytest.raises(UsageError) as refused:
        other.as_parts()
    assert refused.value.code == "HB-D110"


def test_coupled_coils_have_dots_where_their_voltages_agree(tmp_path: Path) -> None:
    rows = ["coils", "V1 a 0 1", "L1 a 0 1m", "L2 b 0 1m", "R2 b 0 1", "L3 c 0 1m", "R3 c 0 1"]
    rows += ["L4 d 0 1m", "R4 d 0 1", "K12 L1 L2 0.9", "K13 L1 L3 -0.9", "K23 L2 L3 -0.9"]
    path = tmp_path / "coils.cir"
    path.write_text("\n".join([*rows, ".tran 1u 1m uic", ".end"]))
    model = hb.read_circuit(path).as_parts()

    def dotted(name: str) -> str:
        """Return the port of a coil that is next to its dot."""
        part = model.elements[name]
        assert isinstance(part, SubmodelPart) and isinstance(part.model, str)
        symbol = model.models[part.model].symbol
        assert symbol is not None
        (dot,) = symbol.fills
        xs = [float(pair.partition(",")[0]) for pair in dot.split()]
        middle = (min(xs) + max(xs)) / 2
        return min(symbol.pins, key=lambda port: abs(symbol.pins[port][0] - middle))

    assert [dotted(name) for name in ("L1", "L2", "L3")] == ["plus", "plus", "minus"]
    assert getattr(model.elements["L4"], "model", "") == "electrical.inductor"
    said = [model.elements[name].parameters.values() for name in ("L1", "L2", "L3")]
    assert [list(values)[1] for values in said] == ["K12 K13", "K12 K23", "K13 K23"]


def on_wires(drawing: Drawing, roles: set[str]) -> tuple[int, list[str]]:
    """Return how many texts there are, and those that a wire passes through."""
    marks = [m for g in drawing.scene.groups for m in g.marks]
    lines = [m for m in marks if isinstance(m, Line) and m.role == "wire"]
    texts = [m for m in marks if isinstance(m, Text) and m.role in roles]
    found = []
    for text in texts:
        wide = 4.0 * len(text.text)  # less than any font takes
        left = text.x - {"start": 0.0, "middle": wide / 2, "end": wide}[text.anchor]
        for (ax, ay), (bx, by) in (ends for line in lines for ends in pairwise(line.points)):
            across = max(ax, bx) > left and min(ax, bx) < left + wide
            if across and max(ay, by) > text.y - 7.0 and min(ay, by) < text.y:
                found.append(text.text)
    return len(texts), found


@pytest.mark.parametrize("name", ["flyback"])
@pytest.mark.slow
def test_names_of_nodes_stand_on_no_wire(name: str) -> None:
    drawing = draw_schematic(hb.read_circuit(NETLISTS / f"{name}.cir").as_parts())
    many, found = on_wires(drawing, {"junctionname"})
    assert many > 2 and not found


@pytest.mark.slow
def test_no_wire_passes_through_the_name_of_a_source() -> None:
    relay = hb.load(NETLISTS.parent / "systems" / "relay_coil.toml")
    many, found = on_wires(draw_schematic(relay), {"name", "parameter"})
    assert many > 10 and not found


def test_an_analog_switch_is_drawn_as_a_switch(tmp_path: Path) -> None:
    """A card of a code model had no part and ended in a KeyError."""
    rows = ["aswitch", "V1 p 0 12", "V2 g 0 5", "A1 g (p a) sw", "R1 a 0 10"]
    rows += [".model sw aswitch(cntl_off=1 cntl_on=4 r_off=1e9 r_on=0.01)", ".tran 1u 1m", ".end"]
    path = tmp_path / "a.cir"
    path.write_text("\n".join(rows))
    model = hb.read_circuit(path).as_parts()
    assert getattr(model.elements["A1"], "model", "") == "electrical.switch"
    assert {"p -> A1.plus", "A1.minus -> a"} <= {str(b) for b in model.bonds}
