"""The report as a person and a program read it."""

from __future__ import annotations

import json

import pytest

import hybond as hb
from hybond.analysis.structure.report import CAVEAT, HEADER
from hybond.analysis.structure.structure import structure


def clutch() -> hb.Model:
    """Two inertias; torque on the first; a clutch joins them, a brake locks the second."""
    m = hb.Model("clutch", domain="rotational")
    m.add(M=hb.Se(1), v=hb.One(), a=hb.I(1), ra=hb.R(1), clutch=hb.Zero(), w=hb.One(), b=hb.I(2))
    m.bond("M -> v -> a", "v -> ra", "v -> clutch -> w -> b")
    m.machine(
        "S",
        states={"engaged": [], "open": ["clutch"]},
        start="open",
        rules=["open -> engaged when time >= 1", "engaged -> open when time >= 2"],
    )
    return m


@pytest.fixture(scope="module")
def report():
    # the clutch is a 0-junction: ON it is a joint without torque balance, OFF it opens
    return structure(clutch(), outputs=["b.f"])


@pytest.mark.slow
def test_all_forms_tell_the_same(report) -> None:
    table = report.table()
    assert table.splitlines()[0].split() == list(HEADER)
    for text in (str(report), report.to_markdown(), report._repr_html_()):
        assert CAVEAT in text
        for row in report.rows:
            assert row.text in text
        for note in report.notes():
            assert note in text
    frame = report.to_pandas()
    assert list(frame.columns) == list(HEADER) and len(frame) == len(report.rows)
    assert frame["order"].tolist() == [str(r.order) for r in report.rows]


def test_the_record_is_json(report) -> None:
    record = json.loads(json.dumps(report.record(), allow_nan=False))
    assert record["caveat"] == CAVEAT
    assert [m["mode"] for m in record["modes"]] == [list(r.mode) for r in report.rows]
    assert record["modes"][0]["states_of_machines"] == {"S": "open"}
    assert record["summary"]["solvable"] == {"in each mode": True, "in some mode": True}


def test_marks_can_be_drawn(report) -> None:
    from hybond.draw import draw

    for row in report.rows:
        marks = report.marks(row.mode)
        assert set(marks) <= {n.path for n in report.graph.nodes}
        svg = draw(report.graph, mode=row.mode, marks=marks).svg()
        assert all(word in svg for word in marks.values())


def test_storage_in_derivative_causality_is_marked() -> None:
    m = hb.Model("two")
    m.add(J=hb.Sf(1), c1=hb.C(1), c2=hb.C(2), node=hb.Zero())
    m.bond("J -> node -> c1", "node -> c2")
    assert structure(m).marks(()) == {"c2": "derivative"}


def test_an_algebraic_loop_is_named_by_the_bond_that_cuts_it() -> None:
    m = hb.Model("loop")
    m.add(
        V=hb.Se(1),
        n=hb.One(),
        r1=hb.R(1),
        k=hb.Zero(),
        r2=hb.R(2),
        i=hb.One(),
        r3=hb.R(3),
        L=hb.I(1),
    )
    m.bond("V -> n -> r1", "n -> k -> r2", "k -> i -> r3", "i -> L")
    row = structure(m).rows[0]
    assert row.order == 1
    assert row.poles == pytest.approx([-(3 + 1 * 2 / 3)])
    assert len(row.loops) == 1


def test_the_selection_says_so_when_it_is_one() -> None:
    m = hb.Model("many")
    m.add(V=hb.Se(1), n0=hb.Zero())
    m.bond("V -> n0")
    for k in range(8):
        m.add(**{f"s{k}": hb.One(), f"r{k}": hb.R(1), f"c{k}": hb.C(1 + k)})
        m.bond(f"n0 -> s{k} -> r{k}", f"s{k} -> c{k}")
        m.machine(
            f"S{k}",
            states={"on": [f"s{k}"], "off": []},
            start="on",
            rules=["on -> off when time >= 1", "off -> on when time >= 2"],
        )
    report = structure(m, limit=5)
    assert len(report.rows) == 5 and len({r.text for r in report.rows}) == 5
    assert report.rows[0].text == "as at the start"
    assert "a selection: the 5 modes nearest to the start mode, of at most 256" in str(report)


def test_modes_can_be_named() -> None:
    report = structure(clutch(), modes=[{"S": "engaged"}])
    assert [r.mode for r in report.rows] == [(0,)]
    assert len(structure(clutch(), modes="start").rows) == 1
    with pytest.raises(hb.UsageError) as refusal:
        report.row({"S": "open"})
    assert refusal.value.code == "HB-A102"


@pytest.mark.parametrize(
    "wrong",
    [
        {"inputs": ["a"]},
        {"inputs": ["nothing"]},
        {"modes": "some"},
        {"modes": [(2,)]},
        {"modes": [(0, 0)]},
    ],
)
def test_wrong_questions(wrong) -> None:
    with pytest.raises(hb.HybondError) as refusal:
        structure(clutch(), **wrong)
    no_mode = isinstance(wrong.get("modes"), list)
    assert refusal.value.code == ("HB-M144" if no_mode else "HB-A102") and refusal.value.hint


def test_a_source_that_is_no_input_does_not_count() -> None:
    m = hb.Model("two sources")
    m.add(F=hb.Se(1), G=hb.Se(-9.81), v=hb.One(), m1=hb.I(1), w=hb.One(), m2=hb.I(2))
    m.bond("F -> v -> m1", "G -> w -> m2")
    both, one = structure(m).rows[0], structure(m, inputs=["F"]).rows[0]
    assert both.controllable is not None and both.controllable.finite
    assert one.controllable is not None and not one.controllable.finite
    assert one.controllable.storages == one.controllable.unreached == ("m2.p",)


def test_a_nonlinear_mode_is_refused_and_the_others_are_not() -> None:
    m = hb.Model("contact")
    m.add(F=hb.Se(-1), v=hb.One(), ball=hb.I(1), hit=hb.Zero(), pad=hb.R({"e": "f + f^3"}))
    m.bond("F -> v -> ball", "v -> hit -> pad")
    m.machine(
        "S",
        states={"away": [], "touching": ["hit"]},
        start="away",
        rules=["away -> touching when time >= 1"],
    )
    report = structure(m)
    away, touching = report.row({"S": "away"}), report.row({"S": "touching"})
    assert away.refused is None and away.order == 1
    assert touching.refused is not None and touching.refused["code"] == "HB-A101"
    assert report.summary["solvable"] == (None, True)
    with pytest.raises(hb.ModelError) as refusal:
        structure(m, modes=[{"S": "touching"}])
    assert refusal.value.code == "HB-A101" and refusal.value.where == "pad"


def test_sources_in_conflict_make_a_mode_unsolvable() -> None:
    m = hb.Model("conflict")
    m.add(V1=hb.Se(1), V2=hb.Se(2), a=hb.One(), b=hb.One(), n=hb.Zero(), r=hb.R(1), c=hb.C(1))
    m.add(i=hb.One())
    m.bond("V1 -> a -> n", "V2 -> b -> n", "n -> i -> c", "i -> r")
    for name, node in (("A", "a"), ("B", "b")):
        m.machine(
            name, states={"on": [node], "off": []}, start="off", rules=["off -> on when time >= 1"]
        )
    report = structure(m)
    both = report.row({"A": "on", "B": "on"})
    assert both.conflicts and both.solvable is False and both.order is None
    assert report.summary["solvable"] == (False, True)


def test_equal_parameters_are_told_from_equal_values() -> None:
    """Two branches that share one parameter are still separated: nearly all values."""
    m = hb.Model("shared", parameters={"tau": 2.0})
    m.add(V=hb.Se(1), n=hb.Zero())
    m.bond("V -> n")
    for k in "12":
        m.add(**{f"i{k}": hb.One(), f"r{k}": hb.R("tau"), f"c{k}": hb.C(1)})
        m.bond(f"n -> i{k} -> r{k}", f"i{k} -> c{k}")
    has = structure(m).rows[0].controllable
    assert has is not None and has.lost == ("finite",) and has.by_paths is True
