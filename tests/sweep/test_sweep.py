"""Sweeps against closed forms, and against ordinary runs of their members to the last bit."""

from __future__ import annotations

import csv
import math
from pathlib import Path

import numpy as np
import pytest

import hybond as hb

G, END = 10.0, 1.8


def ball() -> hb.Model:
    """A ball that falls from 5 m and gives back e of its speed."""
    m = hb.Model("ball", domain="translational", parameters={"e": 0.5})
    m.add(weight=hb.Se(f"-{G} N"), ball=hb.I("1 kg"), v=hb.One(), contact=hb.Zero())
    m.add(floor=hb.Sf("-e*pre(v.f)"))
    m.bond("weight -> v -> ball", "contact -> v", "floor -> contact")
    m.signal(height=hb.Integral("v.f", start="5 m"))
    m.machine(
        "impact",
        states={"away": [], "hits": ["contact"]},
        start="away",
        rules=["away -> hits when height <= 0 and v.f < 0", "hits -> away when pre(v.f) >= 0"],
    )
    m.experiment["until"] = END
    return m


def rc() -> hb.Model:
    m = hb.Model("rc", domain="electrical", parameters={"r": "1 kohm"})
    m.add(c=hb.C("1 mF", e="10 V"), r1=hb.R("r"), node=hb.Zero())
    m.bond("node -> c", "node -> r1")
    return m


WHAT = (
    "final(height), at(v.f, 0.5 s), curve(height, 6), count(events), count(impact), "
    "mode_time(impact.away), first(impact.hits), first(contact.on), ended, mode, sequence"
)


def test_elements_starts_and_parameters_vary() -> None:
    plan = hb.Plan(
        {"r": "0.5..2 kohm", "c.C": "uniform(1 mF, 2 mF)", "c.e": "5..10 V"},
        sample="sobol:16",
        seed=7,
    )
    table = hb.sweep(rc(), plan, until="1 s", collect=["final(c.e)", "at(c.e, 0.5 s)"])
    assert table.how == "16 members in 2 threads" or " in 1 thread" in table.how
    r, c, u = (plan.rows(0, 16)[p] for p in ("r", "c.C", "c.e"))
    np.testing.assert_allclose(table["final(c.e)"], u * np.exp(-1.0 / (r * c)), rtol=1e-7)
    np.testing.assert_allclose(table["at(c.e, 0.5 s)"], u * np.exp(-0.5 / (r * c)), rtol=1e-7)
    assert table.unit("c.C") == "F" and table.unit("final(c.e)") == "V"


def test_elements_within_submodels_vary() -> None:
    boost = hb.load(Path(__file__).parents[2] / "examples" / "boost.toml")
    sets = {"coil.l.I": [1e-3, 2e-3], "coil.l.f": [0.0, 1.0], "supply.U": [10.0, 12.0]}
    plan = hb.Plan(sets, together=True)
    table = hb.sweep(boost, plan, until="0.2 ms", collect="final(C.c.e), sequence")
    assert "ordinary" not in table.how
    for k in range(2):
        given = {path: values[k] for path, values in sets.items()}
        run = hb.simulate(boost, "0.2 ms", parameters=given)
        assert table["final(C.c.e)"][k] == run.final["C.c.e"]
        assert table["sequence"][k].endswith(", ".join(run.mode.values()))


def test_what_is_collected_of_a_ball() -> None:
    e = np.array([0.3, 0.5, 0.8])
    table = hb.sweep(ball(), {"e": e}, collect=WHAT)
    fall = math.sqrt(2.0 * 5.0 / G)
    np.testing.assert_allclose(table["first(impact.hits)"], fall, rtol=1e-9)
    np.testing.assert_array_equal(table["first(contact.on)"], table["first(impact.hits)"])
    np.testing.assert_allclose(table["at(v.f, 0.5 s)"], -0.5 * G, rtol=1e-9)
    bounces = [bounces_of(x) for x in e]
    assert [len(b) for b in bounces] == [3, 1, 1]
    assert table["count(impact)"].tolist() == [2.0 * len(b) for b in bounces]  # there and back
    assert table["count(events)"].tolist() == [1.0 + len(b) for b in bounces]  # and the start
    assert table["sequence"].tolist()[:2] == ["(away > hits) x3 > away", "away > hits > away"]
    np.testing.assert_allclose(table["mode_time(impact.away)"], END, rtol=1e-12)
    expected = [[height(t, x) for t in np.linspace(0.0, END, 6)] for x in e]
    np.testing.assert_allclose(table["curve(height, 6)"], expected, atol=1e-7)
    np.testing.assert_allclose(table["final(height)"], [row[-1] for row in expected], atol=1e-7)


def bounces_of(e: float) -> list[float]:
    """When the ball strikes: it falls for 1 s, then flies for 2 e s, 2 e^2 s, ..."""
    found, flight = [1.0], 2.0 * e
    while found[-1] + flight < END:
        found.append(found[-1] + flight)
        flight *= e
    return found


def height(t: float, e: float) -> float:
    """Where the ball is."""
    since = [b for b in bounces_of(e) if b <= t]
    if not since:
        return 5.0 - 0.5 * G * t**2
    dt = t - since[-1]
    return float(e ** len(since) * G * dt - 0.5 * G * dt**2)


@pytest.mark.parametrize("extra", ["", ", mean(height)", ", duty(height, 1)"])
def test_rows_are_those_of_ordinary_runs(extra: str) -> None:
    plan = hb.Plan(
        {"e": "0.3..0.8", "ball.I": "1..2", "height.start": "4..6"}, sample="lhs:8", seed=1
    )
    table = hb.sweep(ball(), plan, collect=WHAT + extra)
    assert ("ordinary" in table.how) == ("duty" in extra)
    for k in (0, 5):
        run = table.run(k)
        assert table["final(height)"][k] == run.final["height"]
        assert table["at(v.f, 0.5 s)"][k] == run["v.f"].at(0.5)
        assert table["count(events)"][k] == len(run.events)
        there = run["height"].at(np.linspace(0.0, END, 6).tolist())
        np.testing.assert_array_equal(table["curve(height, 6)"][k], there)
        if "mean" in extra:
            assert table["mean(height)"][k] == pytest.approx(run["height"].mean(), rel=1e-14)
        if "duty" in extra:
            assert table["duty(height, 1)"][k] == run["height"].duty(level=1.0)
    whole = hb.sweep(ball(), plan, collect=WHAT, part=3, workers=1)
    for name in whole.columns:
        if name in table.columns:
            assert whole[name].tolist() == table[name].tolist() or "first" in name


def test_a_state_of_a_machine_varies() -> None:
    table = hb.sweep(ball(), {"impact.start": "away, hits", "e": [0.5]}, collect="mode, ended")
    assert table["mode"].tolist() == ["away", "away"]
    assert table["impact.start"].tolist() == ["away", "hits"]


def test_a_failing_run_is_a_row(tmp_path: Path) -> None:
    table = hb.sweep(
        rc(), {"c.C": "1 mF, 0 F, 2 mF"}, until=1.0, collect="final(c.e), ended", out=tmp_path / "s"
    )
    with (tmp_path / "s" / "table.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["status"] for row in rows] == ["ok", "error", "ok"]
    assert table["ended"].tolist() == ["time", "error", "time"]
    assert rows[1]["code"] == "HB-M163" and "size zero" in rows[1]["message"]
    assert rows[1]["final(c.e)"] == "nan"
    assert float(rows[2]["final(c.e)"]) == pytest.approx(10.0 * math.exp(-0.5), rel=1e-7)
    assert table.counts() == {"ok": 2, "error (HB-M163)": 1}


def test_members_end_where_a_condition_holds() -> None:
    table = hb.sweep(
        ball(),
        {"e": [0.5, 0.8], "height.start": [0.8, 5.0]},
        until=["v.f > 0.1", "0.9 s"],
        collect="ended, final(height), sequence, count(impact)",
    )
    # from 0.8 m it strikes after 0.4 s, and comes up at once; from 5 m it falls for 1 s
    assert table["ended"].tolist() == ["v.f > 0.1", "time"] * 2
    np.testing.assert_allclose(table["t_end"], [0.4, 0.9, 0.4, 0.9], rtol=1e-9)
    np.testing.assert_allclose(table["final(height)"][1::2], 5.0 - 0.5 * G * 0.9**2, rtol=1e-9)
    assert table["sequence"].tolist() == ["away > hits > away", "away"] * 2
    assert table["count(impact)"].tolist() == [2.0, 0.0] * 2


def test_a_measurement_that_there_is_not_says_so() -> None:
    table = hb.sweep(ball(), {"e": [0.5]}, collect="frequency(height, 4.9 m), max(height)")
    assert table["code"].tolist() == ["HB-R107"] and table["status"].tolist() == ["ok"]
    assert table["max(height)"].tolist() == [5.0]


@pytest.mark.parametrize(
    ("collect", "code"),
    [
        ("", "HB-P103"),
        ("final(height", "HB-P103"),
        ("final(height, 3)", "HB-P103"),
        ("curve(height, 1)", "HB-P103"),
        ("ended, ended", "HB-P103"),
        ("height", "HB-P103"),
        ("finl(height)", "HB-P104"),
        ("count(impct)", "HB-P104"),
        ("first(impact.hit)", "HB-P104"),
        ("final(heigt)", "HB-S109"),
        ("max(heigt)", "HB-S109"),
        ("max(height, strt=1)", "HB-R121"),
        ("at(height, 3 s)", "HB-S110"),
    ],
)
def test_what_cannot_be_collected_is_refused(collect: str, code: str) -> None:
    with pytest.raises(hb.UsageError) as refused:
        hb.sweep(ball(), {"e": [0.5, 0.6]}, collect=collect)
    assert refused.value.code == code and refused.value.hint


def test_a_path_that_leads_nowhere_is_refused() -> None:
    with pytest.raises(hb.ModelError) as refused:
        hb.sweep(ball(), {"ee": [0.5]}, collect="ended")
    assert refused.value.code == "HB-M107"
