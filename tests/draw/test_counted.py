"""Every example and circuit drawn, and what the pictures do wrong counted on their marks."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[1]))

import drawn
from drawn import Counts, counts, read

import hybond as hb
from hybond.draw.geometry import Box
from hybond.draw.scene import Group, Line, Scene, Text

CIRCUITS = [*drawn.NETLISTS, *drawn.CONVERTERS]
SPARE = 2
"""Crossings more than a drawing of this graph needs."""
NEEDED = {"converters/six_pulse_rectifier": 1, "converters/twelve_pulse_rectifier": 2}
"""Crossings that a graph needs that has no drawing without. Each bridge has phases that are joined
in a ring and to both rails, and rails that are joined: K5, whose crossing number is 1."""
UNMET = {"converters/twelve_pulse_rectifier"}
NAME_ON_BOND = {"examples/woodpecker"}
"""Where a name has found no place beside all bonds."""
LONG = {
    *("mmc_arm", "woodpecker", "cockcroft_walton", "three_phase", "bridge_rectifier"),
    *("dual_active_bridge", "full_bridge_isolated", "h_bridge_inverter", "parallel_resonant"),
    *("six_pulse_rectifier", "twelve_pulse_rectifier", "push_pull", "vienna_leg"),
    *("three_phase_inverter", "thyristor_bridge", "rectifier_dc_machine", "automatic_gearbox"),
    *("half_bridge_isolated", "parallel_resonant_converter", "series_resonant"),
}
"""What takes about a second or more, and is drawn with --all."""


def checked(path: Path) -> None:
    found = counts(read(path).draw().scene)
    name = f"{path.parent.name}/{path.stem}"
    wrong = {k: getattr(found, k) for k in ("through", "on_node", "on_label", "along")}
    assert found.on_bond <= (name in NAME_ON_BOND)
    assert wrong == dict.fromkeys(wrong, 0)
    if name not in UNMET:
        assert found.crossings <= NEEDED.get(name, 0) + SPARE


def cases(paths):
    return [
        pytest.param(p, marks=[pytest.mark.slow] if p.stem in LONG else [], id=p.stem)
        for p in paths
    ]


@pytest.mark.sampled(3)
@pytest.mark.parametrize("path", cases(drawn.EXAMPLES))
def test_examples_are_drawn_without_a_flaw(path: Path) -> None:
    checked(path)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("path", cases(CIRCUITS))
def test_circuits_are_drawn_without_a_flaw(path: Path) -> None:
    checked(path)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("path", cases(drawn.DECKS)[::4])
def test_decks_are_drawn_without_a_flaw(path: Path) -> None:
    checked(path)


def test_there_are_57_models_and_more_than_30_circuits() -> None:
    assert len(drawn.EXAMPLES) >= 57
    assert len(CIRCUITS) >= 30


def scene(*groups: Group) -> Scene:
    return Scene(400.0, 400.0, groups)


def node(key: str, x: float, y: float, *, name: bool = True) -> Group:
    texts = (Text("name", key, x, y + 24.0),) if name else ()
    return Group("node", key, "", (Text("node", "R", x, y + 7.0), *texts))


def bond(*points: tuple[float, float]) -> Group:
    return Group("bond", "", "", (Line("bond", points),))


def test_the_counter_finds_each_kind_of_flaw() -> None:
    a, b = node("a", 50.0, 50.0), node("b", 250.0, 50.0)
    clear = counts(scene(a, b, bond((70.0, 50.0), (230.0, 50.0))))
    assert clear == Counts(2, 1, *[0] * 8)
    over = counts(scene(a, b, node("c", 150.0, 50.0), bond((70.0, 50.0), (230.0, 50.0))))
    assert (over.through, over.on_node) == (1, 0)
    assert counts(scene(a, b, bond((70.0, 66.0), (0.0, 72.0)))).on_bond == 1
    near = counts(scene(a, node("b", 56.0, 80.0)))
    assert (near.on_node, near.on_label) == (1, 0)
    both = counts(
        scene(
            a,
            Group(
                "node", "b", "", (*node("b", 250.0, 9.0).marks[:1], Text("name", "b", 52.0, 74.0))
            ),
        )
    )
    assert (both.on_node, both.on_label) == (0, 1)
    crossed = counts(
        scene(bond((0.0, 0.0), (0.0, 90.0), (90.0, 90.0)), bond((-30.0, 50.0), (60.0, 55.0)))
    )
    assert (crossed.crossings, crossed.bends, crossed.askew, crossed.along) == (1, 1, 1, 0)
    shared = counts(scene(bond((0.0, 0.0), (90.0, 0.0)), bond((40.0, 0.0), (120.0, 0.0))))
    assert (shared.crossings, shared.along) == (0, 1)
    askew = counts(scene(bond((0.0, 0.0), (90.0, 90.0)), bond((40.0, 40.0), (120.0, 120.0))))
    assert askew.along == 1
    assert Box(0, 0, 1, 1).overlaps(Box(0.5, 0.5, 2, 2))


def test_the_legs_of_a_converter_are_drawn_alike_and_in_a_row() -> None:
    path = next(p for p in drawn.CONVERTERS if p.stem == "interleaved_boost")
    at = read(path).draw().positions
    pairs = [("D1", "D2"), ("S1", "S2"), ("L1", "L2"), ("a", "b"), ("D1_R", "D2_R")]
    apart = {(at[q][0] - at[p][0], at[q][1] - at[p][1]) for p, q in pairs}
    assert len(apart) == 1
    assert 0.0 in apart.pop()


def test_diodes_that_all_block_are_no_conflict() -> None:
    for name in ("charge_pump", "two_switch_forward"):
        svg = read(next(p for p in drawn.CONVERTERS if p.stem == name)).draw().svg()
        assert "conflict" not in svg.split("</style>")[-1]


def test_two_sources_at_one_node_are_a_conflict_still() -> None:
    m = hb.Model("two_sources")
    m.add(V=hb.Se(10), W=hb.Se(12), node=hb.Zero())
    m.bond("V -> node", "W -> node")
    assert "causal conflict" in m.draw().svg()


def crowded(count: int) -> hb.Model:
    m = hb.Model("crowded")
    m.add(s=hb.Se(1.0), j=hb.One(), t=hb.TF(2.0), o=hb.Zero(), r=hb.R(1.0), c=hb.C(1.0))
    m.bond("s -> j -> t -> o", "o -> r", "o -> c")
    for k in range(count):
        m.add(**{f"x{k}": (hb.I, hb.R, hb.C)[k % 3](1.0)})
        m.bond(f"j -> x{k}")
    return m


@pytest.mark.slow
def test_bonds_of_a_crowded_junction_do_not_lie_on_each_other() -> None:
    """Eleven bonds and more: three ran along others, which reads as bonds that branch."""
    found = counts(crowded(12).draw().scene)
    assert (found.through, found.along, found.on_node, found.on_label) == (0, 0, 0, 0)
    assert found.crossings == 0


def test_sources_are_at_the_left_of_a_bridge() -> None:
    """The bridge of Wheatstone was drawn from right to left."""
    m = hb.Model("wheatstone")
    m.add(u=hb.Se(10.0), gnd=hb.R(1.0), rg=hb.R(1.0), g=hb.One())
    m.add(top=hb.Zero(), left=hb.Zero(), right=hb.Zero(), low=hb.Zero())
    for n, a, b in (("a", "top", "left"), ("b", "top", "right"), ("c", "left", "low")):
        m.add(**{n: hb.One(), f"r{n}": hb.R(1.0)})
        m.bond(f"{a} -> {n} -> {b}", f"{n} -> r{n}")
    m.add(d=hb.One(), rd=hb.R(1.0))
    m.bond(
        "right -> d -> low", "d -> rd", "u -> top", "low -> gnd", "left -> g -> right", "g -> rg"
    )
    at = m.draw().positions
    assert at["u"][0] < sum(x for x, _ in at.values()) / len(at)
    assert at["u"][0] < at["gnd"][0]
