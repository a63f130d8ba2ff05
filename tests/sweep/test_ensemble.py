"""Ensembles: closed forms over members, members that fail, order, threads, refusals."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import hybond as hb

GRAVITY = 9.81


def capacitor() -> hb.Model:
    m = hb.Model("rc", domain="electrical", parameters={"r": "1 kohm", "c": "1 mF"})
    m.add(c1=hb.C("c", e="10 V"), r1=hb.R("r"), node=hb.Zero())
    m.bond("node -> c1", "node -> r1")
    return m


def ball() -> hb.Model:
    m = hb.Model("ball", domain="translational", parameters={"restitution": 0.9, "drop": "2 m"})
    m.add(weight=hb.Se(-GRAVITY), ball=hb.I(1.0), v=hb.One(), contact=hb.Zero())
    m.add(rebound=hb.Sf("-restitution*pre(v.f)"))
    m.bond("weight -> v -> ball", "contact -> v", "rebound -> contact")
    m.signal(height=hb.Integral("v.f", start="drop"))
    m.machine(
        "floor",
        states={"away": [], "impact": ["contact"]},
        start="away",
        rules=[
            "away -> impact when height <= 0 and v.f < 0",
            "impact -> away when pre(ball.p) >= 0",
        ],
    )
    return m


def bounces(restitution: float, drop: float, end: float) -> list[float]:
    t = fall = math.sqrt(2.0 * drop / GRAVITY)
    found, flight = [], 2.0 * fall
    while t < end:
        found.append(t)
        flight *= restitution
        t += flight
    return found


SETS = {"restitution": np.linspace(0.7, 0.9, 12), "drop": np.linspace(1.0, 3.0, 12)}


def same(a: hb.Ensemble, b: hb.Ensemble) -> None:
    """Hold all that two ensembles have computed against each other, bit for bit."""
    for one, other in ((a.final, b.final), (a.samples, b.samples)):
        assert list(one) == list(other)
        for name in one:
            assert one[name].tobytes() == other[name].tobytes(), name
    assert [t.tobytes() for t in a.events] == [t.tobytes() for t in b.events]
    assert a.t_end.tobytes() == b.t_end.tobytes()
    assert a.status.tolist() == b.status.tolist() and a.counts.tolist() == b.counts.tolist()
    assert {k: str(e) for k, e in a.errors.items()} == {k: str(e) for k, e in b.errors.items()}
    assert a.warnings == b.warnings


def test_capacitors_discharge_with_their_time_constants() -> None:
    r, c = np.linspace(500.0, 2000.0, 7), np.linspace(1e-3, 2e-3, 7)
    many = hb.ensemble(capacitor(), "2 s", sets={"r": r, "c": c}, outputs=["c1.e"], samples=21)
    assert many.t.tolist() == np.linspace(0.0, 2.0, 21).tolist()
    expected = 10.0 * np.exp(-many.t[None, :] / (r * c)[:, None])
    np.testing.assert_allclose(many.samples["c1.e"], expected, rtol=1e-7)
    np.testing.assert_allclose(many.final["c1.e"], expected[:, -1], rtol=1e-7)
    assert many.units == {"c1.e": "V"}
    assert many.status.tolist() == ["ok"] * 7 and many.t_end.tolist() == [2.0] * 7


def test_balls_bounce_when_their_restitution_says() -> None:
    many = hb.ensemble(ball(), 2.0, sets=SETS, events=True)
    for k in range(len(many)):
        expected = bounces(SETS["restitution"][k], SETS["drop"][k], 2.0)
        np.testing.assert_allclose(many.events[k], [0.0, *expected], atol=1e-9)
        assert many.counts[k] == 1 + len(expected)


def test_a_member_is_the_ordinary_run_bit_for_bit() -> None:
    many = hb.ensemble(ball(), 2.0, sets=SETS, samples=[0.3, 1.7])
    for k in (0, 7):
        given = {path: float(column[k]) for path, column in SETS.items()}
        run = hb.simulate(ball(), 2.0, parameters=given)
        assert {n: v[k] for n, v in many.final.items()} == run.final
        values = run.sample([0.3, 1.7], list(many.samples))
        assert all(many.samples[n][k].tolist() == v.tolist() for n, v in values.items())
        assert many.run(k).final == run.final


def test_rows_and_columns_are_the_same_sets() -> None:
    rows = [{"r": 1000.0, "c": "1 mF"}, {"c": "2 mF", "r": "500 ohm"}]
    columns = {"r": [1000.0, "500 ohm"], "c": ("1 mF", "2 mF")}
    a, b = (hb.ensemble(capacitor(), 1.0, sets=sets) for sets in (rows, columns))
    same(a, b)
    for many in (a, b):
        assert many.parameters["r"].tolist() == [1000.0, 500.0]
        assert many.parameters["c"].tolist() == [1e-3, 2e-3]
    assert a.sets["r"] == (1000.0, "500 ohm")


@pytest.mark.sampled(1)
@pytest.mark.parametrize("workers", [2, 3])
def test_what_comes_out_does_not_depend_on_the_threads(workers: int) -> None:
    # member 4 weighs nothing, and has no meaning
    m = ball()
    m.parameter(mass="1 kg")
    m.elements["ball"] = hb.I("mass")
    sets = {**SETS, "mass": [1.0] * 4 + [0.0] + [2.0] * 7}
    alone, together = (
        hb.ensemble(m, 2.0, sets=sets, samples=20, events=True, workers=w) for w in (1, workers)
    )
    same(alone, together)
    assert alone.failed.tolist() == [4]
    assert together.how == f"11 members in {workers} threads, 1 member one after the other"


def test_a_member_without_a_meaning_does_not_stop_the_others() -> None:
    many = hb.ensemble(capacitor(), 1.0, sets={"c": [0.0, 1e-3, 0.0, 2e-3]})
    assert many.status.tolist() == ["error", "ok", "error", "ok"]
    assert many.failed.tolist() == [0, 2] == list(many.errors)
    assert {e.code for e in many.errors.values()} == {"HB-M163"}
    assert np.isnan(many.final["c1.e"]).tolist() == [True, False, True, False]
    assert many.final["c1.e"][3] == pytest.approx(10.0 * math.exp(-0.5))
    first, why, *_ = repr(many).splitlines()
    assert first == "<Ensemble 'rc': 4 members, until 1 s, 2 error, 2 ok>"
    assert why.startswith("member 0: HB-M163")
    with pytest.raises(hb.ModelError, match="size zero"):
        many.run(0)


def test_what_was_computed_before_an_error_is_kept() -> None:
    # what grows as tan is gone at pi/2, and the run stops at the latest when it overflows
    m = hb.Model("tan", parameters={"a": 1.0})
    m.add(c=hb.C(1.0), s=hb.Sf("a + a*c.q^2"), n=hb.Zero())
    m.bond("s -> n -> c")
    many = hb.ensemble(m, 2.0, sets={"a": [0.5, 1.0]}, samples=[0.5, 1.0, 2.0], outputs=["c.q"])
    assert many.status.tolist() == ["ok", "error"]
    np.testing.assert_allclose(many.samples["c.q"][0], np.tan([0.25, 0.5, 1.0]), rtol=1e-6)
    np.testing.assert_allclose(many.samples["c.q"][1, :2], np.tan([0.5, 1.0]), rtol=1e-6)
    assert np.isnan(many.samples["c.q"][1, 2])
    assert many.t_end[1] == pytest.approx(0.5 * math.pi, abs=1e-3)
    assert many.run(1).error is not None


def test_all_members_may_fail() -> None:
    many = hb.ensemble(capacitor(), 1.0, sets={"c": [0.0, 0.0]}, outputs=["c1.e"], samples=3)
    assert many.failed.tolist() == [0, 1]
    assert many.samples["c1.e"].shape == (2, 3) and np.isnan(many.samples["c1.e"]).all()


def test_options_hold_for_all_members() -> None:
    # one step of Euler: q = q0 (1 - h/(R C))
    many = hb.ensemble(
        capacitor(), 0.1, sets={"r": [500.0, 1000.0]}, solver="euler", step=0.1, outputs=["c1.e"]
    )
    np.testing.assert_allclose(many.final["c1.e"], [8.0, 9.0], rtol=1e-12)


def test_events_are_counted_also_where_few_are_kept() -> None:
    one, few = (hb.ensemble(ball(), 2.0, sets=SETS, keep=keep) for keep in (None, 1))
    assert one.counts.tolist() == few.counts.tolist()


@pytest.mark.slow
def test_progress_is_told_and_ends_with_all() -> None:
    for workers in (1, 2):
        told: list[tuple[int, int]] = []
        hb.ensemble(
            capacitor(),
            1.0,
            sets={"r": np.linspace(1.0, 2.0, 9)},
            workers=workers,
            progress=lambda done, total, told=told: told.append((done, total)),
        )
        assert told == sorted(told) and told[-1] == (9, 9)


def test_an_input_from_python_makes_ordinary_runs() -> None:
    m = hb.Model("charged", parameters={"c": 1.0})
    m.add(c1=hb.C("c"), s=hb.Sf("i"), n=hb.Zero())
    m.bond("s -> n -> c1")
    m.input(i=lambda t: 2.0 * t)
    many = hb.ensemble(m, 1.0, sets={"c": [1.0, 2.0, 4.0]}, workers=2, outputs=["c1.e"])
    np.testing.assert_allclose(many.final["c1.e"], [1.0, 0.5, 0.25], rtol=1e-8)
    assert many.how == "3 members one after the other"


def test_another_solver_makes_ordinary_runs() -> None:
    sets = {"r": [500.0, 1000.0]}
    options = {"solver": "moreau-jean", "step": "1 ms"}
    many = hb.ensemble(capacitor(), 1.0, sets=sets, outputs=["c1.e"], **options)
    np.testing.assert_allclose(many.final["c1.e"], 10.0 * np.exp([-2.0, -1.0]), rtol=1e-6)
    assert many.how == "2 members one after the other: solver 'moreau-jean'"


@pytest.mark.slow
def test_ctrl_c_keeps_the_members_that_are_done() -> None:
    for workers in (1, 2):

        def pressed(done: int, total: int) -> None:
            if done >= 3:
                raise KeyboardInterrupt

        sets = {"r": np.linspace(500.0, 2000.0, 5000)}
        many = hb.ensemble(
            capacitor(), 1.0, sets=sets, outputs=["c1.e"], workers=workers, progress=pressed
        )
        assert many.interrupted and many.how.startswith("interrupted after ")
        there = many.status == "ok"
        assert 3 <= there.sum() < 5000 and set(many.status[~there]) == {"interrupted"}
        expected = 10.0 * np.exp(-1.0 / (sets["r"] * 1e-3))
        np.testing.assert_allclose(many.final["c1.e"][there], expected[there], rtol=1e-7)
        assert np.isnan(many.final["c1.e"][~there]).all()


def test_tables_have_a_row_for_each_member(tmp_path: Path) -> None:
    many = hb.ensemble(
        capacitor(), 1.0, sets={"r": ["1 kohm", "2 kohm"]}, outputs=["c1.e", "r"], samples=3
    )
    assert list(many.table()) == ["member", "r", "status", "t_end", "events", "c1.e", "r_"]
    many.to_csv(tmp_path / "many.csv")
    lines = (tmp_path / "many.csv").read_text(encoding="utf-8").splitlines()
    assert lines[0] == "member,r,status,t_end,events,c1.e,r_" and len(lines) == 3
    assert float(lines[1].split(",")[5]) == many.final["c1.e"][0]
    many.to_npz(tmp_path / "many.npz")
    with np.load(tmp_path / "many.npz", allow_pickle=False) as stored:
        assert stored["samples:c1.e"].tolist() == many.samples["c1.e"].tolist()
    pd = pytest.importorskip("pandas")
    frame = many.to_pandas()
    assert isinstance(frame, pd.DataFrame) and frame["c1.e"].tolist() == list(many.final["c1.e"])


def test_a_dataset_has_members_and_times() -> None:
    pytest.importorskip("xarray")
    many = hb.ensemble(capacitor(), 1.0, sets={"r": [1e3, 2e3]}, outputs=["c1.e"], samples=3)
    data = many.to_xarray()
    assert data["c1.e"].dims == ("member", "t") and data["c1.e"].attrs == {"units": "V"}
    assert data["r"].values.tolist() == [1e3, 2e3]


@pytest.mark.parametrize(
    ("sets", "code"),
    [
        ([], "HB-S114"),
        ({}, "HB-S114"),
        ({"r": []}, "HB-S114"),
        ({"r": 1.0}, "HB-S114"),
        ({"r": "1 ohm"}, "HB-S114"),
        ({"r": [1.0, 2.0], "c": [1.0]}, "HB-S114"),
        ({"r": np.ones((2, 2))}, "HB-S114"),
        ([{"r": 1.0}, {"c": 1.0}], "HB-S114"),
        ([{"r": 1.0}, 2.0], "HB-S114"),
        (3.0, "HB-S114"),
        ("r", "HB-S114"),
        ({"q": [1.0]}, "HB-M107"),
    ],
)
def test_sets_that_do_not_fit_are_refused(sets: Any, code: str) -> None:
    with pytest.raises(hb.HybondError) as caught:
        hb.ensemble(capacitor(), 1.0, sets=sets)
    assert caught.value.code == code


@pytest.mark.parametrize(
    ("options", "code"),
    [
        ({"parameters": {"r": 1.0}}, "HB-S115"),
        ({"on_error": "return"}, "HB-S115"),
        ({"journal": "x.csv"}, "HB-S115"),
        ({"sovler": "radau"}, "HB-S115"),
        ({"workers": 0}, "HB-S115"),
        ({"workers": True}, "HB-S115"),
        ({"samples": 1}, "HB-S115"),
        ({"samples": "all"}, "HB-S115"),
        ({"samples": [0.5, 1.5]}, "HB-S110"),
        ({"until": -1.0}, "HB-S106"),
        ({"solver": "radua"}, "HB-S101"),
        ({"rtol": 2.0}, "HB-S107"),
        ({"outputs": ["c2.e"]}, "HB-S109"),
    ],
)
def test_calls_that_are_wrong_are_refused(options: dict[str, Any], code: str) -> None:
    given = {"until": 1.0, "sets": {"r": [1.0, 2.0]}, **options}
    with pytest.raises(hb.HybondError) as caught:
        hb.ensemble(capacitor(), **given)
    assert caught.value.code == code


@pytest.mark.parametrize("group", ["final", "samples"])
@pytest.mark.parametrize("name", ["c1.q", "c2.e", "C1.e"])
def test_outputs_that_were_not_read_are_refused_with_the_nearest(group: str, name: str) -> None:
    many = hb.ensemble(capacitor(), 1.0, sets={"r": [1.0]}, outputs=["c1.e"], samples=[0, 1])
    with pytest.raises(hb.UsageError, match="did you mean 'c") as caught:
        getattr(many, group)[name]
    assert caught.value.code == "HB-S109"
    assert name not in getattr(many, group)


def test_a_flat_graph_has_no_parameters_left() -> None:
    with pytest.raises(hb.UsageError, match="FlatGraph"):
        hb.ensemble(capacitor().flatten(), 1.0, sets={"r": [1.0]})  # type: ignore[arg-type]


def test_one_output_may_be_a_name():
    many = hb.ensemble(capacitor(), "1 s", sets={"r": [1e3, 2e3]}, outputs="c1.e", workers=1)
    assert list(many.final) == ["c1.e"]
