"""Pins and the reference mode: kept in files, in the flat graph, and in every assignment."""

import pytest

import hybond as hb
from hybond.causality.assign import assign
from hybond.causality.explain import conflict_error, describe_conflict
from hybond.causality.report import causality
from hybond.errors import ModelError
from hybond.model.graph import FlatGraph
from hybond.model.pins import pin_names

DIVIDER = """\
hybond = 1
[elements]
V = { Se = 12 }
r = { R = 1 }
s = { R = 2 }
node = { junction = 1 }
[graph]
bonds = ["V -> node -> r", "low: node -> s"]
"""


def divider(*pins: tuple[str, str]) -> FlatGraph:
    model = hb.loads(DIVIDER)
    for bond, at in pins:
        model.pin(bond, at=at)
    return model.flatten()


@pytest.mark.parametrize("bond", ["node -> s", "low", "low: node -> s", "node->s"])
@pytest.mark.parametrize("at", ["node", "s"])
def test_a_pin_names_a_bond_or_its_label_and_is_obeyed(bond: str, at: str) -> None:
    graph = divider((bond, at))
    assert graph.pins == {2: 0 if at == "node" else 1}
    strokes = assign(graph, ())
    assert graph.nodes[strokes.stroke_at(2)].path == at
    # One of the two resistors gives the flow: the stroke at s means that s does.
    other = graph.nodes[strokes.stroke_at(1)].path
    assert other == ("r" if at == "node" else "node")
    assert strokes.reasons[2].origin.rule == "pin"
    assert not strokes.conflicts
    assert assign(graph, (), pins={}).strokes == assign(divider(), ()).strokes


@pytest.mark.parametrize(
    ("bond", "at", "code", "hint"),
    [
        ("node -> q", "node", "HB-M180", "did you mean 'node -> r'"),
        ("lwo", "node", "HB-M180", "low: node -> s"),
        ("node -> r", "s", "HB-M181", "'node' or at 'r'"),
        ("node -> r", "nodes", "HB-M181", "'node' or at 'r'"),
    ],
)
def test_bad_pins_are_refused(bond: str, at: str, code: str, hint: str) -> None:
    with pytest.raises(ModelError) as refused:
        divider((bond, at))
    assert refused.value.code == code
    assert hint in refused.value.hint
    assert f"causality.pins.{bond!r}" in refused.value.where


def test_one_bond_cannot_be_pinned_at_both_ends_nor_an_ambiguous_one() -> None:
    with pytest.raises(ModelError, match="HB-M181"):
        divider(("node -> s", "node"), ("low", "s"))
    assert divider(("node -> s", "s"), ("low", "s")).pins == {2: 1}
    m = hb.Model("twice")
    m.add(V=hb.Se(1), a=hb.One(), b=hb.Zero(), r=hb.R(1))
    m.bond("V -> a", "a -> b", "a -> b", "b -> r")
    m.pin("a -> b", at="a")
    with pytest.raises(ModelError, match="HB-M121"):
        m.flatten()


def test_a_pin_against_a_source_is_a_conflict_that_says_so() -> None:
    graph = divider(("V -> node", "V"))
    (conflict,) = assign(graph, ()).conflicts
    assert describe_conflict(graph, (), conflict) == (
        "Se V puts the stroke of 'V -> node' at 1-junction node, and it is pinned at Se V."
    )
    error = conflict_error(graph, (), conflict)
    assert (error.code, error.hint) == ("HB-C101", "take the pin of 'V -> node' away")


def test_two_pins_that_leave_a_junction_without_flow_are_named() -> None:
    graph = divider(("node -> r", "node"), ("low", "node"))
    (conflict,) = assign(graph, ()).conflicts
    assert "pin" in conflict_error(graph, (), conflict).hint


def test_pins_and_reference_survive_files() -> None:
    model = hb.loads(DIVIDER)
    model.machine("m", states={"a": ["node"], "b": []}, start="a")
    model.pin("low", at="s")
    model.reference(m="b")
    for format in ("toml", "json"):
        again = hb.loads(hb.dumps(model, format=format), format=format)
        assert (again.pins, again.reference_states) == ({"low": "s"}, {"m": "b"})
        graph = again.flatten()
        assert (graph.pins, graph.reference) == ({2: 1}, (1,))
        assert pin_names(graph) == {"low: node -> s": "s"}
    assert divider().reference is None and divider().pins == {}


def test_a_saved_file_keeps_its_comments(tmp_path) -> None:
    path = tmp_path / "divider.toml"
    path.write_text(DIVIDER + '[causality]\npins = { low = "s" }  # measured\n', encoding="utf-8")
    model = hb.load(path)
    model.pin("node -> r", at="node")
    hb.save(model, path)
    assert hb.load(path).pins == {"low": "s", "node -> r": "node"}
    assert "# measured" in path.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("pins = { low = 1 }", "HB-F112"),
        ('pin = { low = "s" }', "HB-F109"),
        ('pins = ["low"]', "HB-F112"),
        ('reference = { m = ["b"] }', "HB-F112"),
    ],
)
def test_files_with_other_shapes_are_refused(text: str, code: str) -> None:
    with pytest.raises(ModelError, match=code):
        hb.loads(f"{DIVIDER}[causality]\n{text}\n")


def test_submodels_bring_their_pins_and_references() -> None:
    cell = hb.Model("cell")
    cell.add(V=hb.Se(12), r=hb.R(1), s=hb.R(2), node=hb.One())
    cell.bond("V -> node -> r", "low: node -> s")
    cell.machine("m", states={"a": ["node"], "b": []}, start="a")
    cell.pin("low", at="s")
    cell.reference(m="b")
    cell.port(out="node")
    m = hb.Model("two")
    m.add(x=hb.Submodel(cell), y=hb.Submodel(cell), rail=hb.Zero(), load=hb.R(1))
    m.bond("x.out -> rail", "y.out -> rail", "rail -> load")
    m.pin("x.out -> rail", at="x.out")  # a port is a name of the node behind it
    m.pin("y.low", at="y.s")
    graph = m.flatten()
    assert pin_names(graph) == {
        "x.out -> rail": "x.node",
        "x.low: node -> s": "x.s",
        "y.low: node -> s": "y.s",
    }
    assert graph.reference == (1, 1)
    m.reference(**{"y.m": "a"})
    assert m.flatten().reference == (1, 0)
    m.reference(**{"y.m": "c"})
    with pytest.raises(ModelError, match="HB-M144"):
        m.flatten()


def test_a_switched_element_is_a_node_that_a_pin_can_name() -> None:
    m = hb.Model("switched")
    m.add(V=hb.Se(1), j=hb.One(), r=hb.R(1), q=hb.R(2))
    m.bond("V -> j -> r", "j -> q")
    m.machine("m", states={"on": ["r"], "off": []}, start="on")
    m.pin("j -> r", at="r")
    graph = m.flatten()
    assert pin_names(graph) == {"j -> r": "r.switch"}
    assert not assign(graph, (0,)).conflicts


def test_the_reference_given_is_the_one_reported() -> None:
    m = hb.Model("clutch")
    m.add(a=hb.I(1), v=hb.One(), grip=hb.Zero(), w=hb.One(), b=hb.I(2))
    m.bond("v -> a", "v -> grip -> w -> b")
    m.machine("S", states={"engaged": ["grip"], "open": []}, start="open")
    assert causality(m).mode == (1,)
    m.reference(S="engaged")
    m.pin("grip -> w", at="w")
    report = causality(m)
    assert report.mode == (0,)
    assert "pinned: 'grip -> w' at w" in str(report)
    assert report.to_data()["pins"] == {"grip -> w": "w"}
    # w is told the torque, so it tells the grip its speed, and v is told that speed: a follows.
    assert report.bonds[2].at == "w" and report.derivative == ("a.p",)
    assert report.dynamics.reference.how == "given by the user"
