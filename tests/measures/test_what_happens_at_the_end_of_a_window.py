"""A jump where a window or a run ends belongs to it: extremes, crossings, tables, sweeps."""

from __future__ import annotations

import csv
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import hybond as hb
from hybond.errors import UsageError


def joined(*, turned: bool = False, a: float = 2.0, b: float = 3.0, late: float = 1.0) -> hb.Model:
    """A charged capacitor that another one is joined to at a time."""
    m = hb.Model("joined", domain="electrical", parameters={"U": "10 V"})
    parts = {"A": hb.C(a, e="U"), "na": hb.Zero(), "S": hb.One(), "nb": hb.Zero(), "B": hb.C(b)}
    m.add(**dict(reversed(parts.items()) if turned else parts.items()))
    m.bond("na -> A", "nb -> B", "nb -> S -> na" if turned else "na -> S -> nb")
    rules = [f"open -> closed when time >= {late}"]
    m.machine("M", states={"open": [], "closed": ["S"]}, start="open", rules=rules)
    return m


SIZES = [(2.0, 3.0, 1.0), (1e-6, 4e-6, 3e-4), (5.0, 0.1, 7.0)]


@pytest.mark.parametrize("solver", ["auto", "radau", "rk45"])
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(("a", "b", "late"), SIZES)
def test_the_last_jump_is_seen_as_the_final_value_is(
    a: float, b: float, late: float, turned: bool, solver: str
) -> None:
    run = hb.simulate(joined(turned=turned, a=a, b=b, late=late), late, solver=solver)
    end = 10.0 * a / (a + b)
    assert run.final["A.e"] == pytest.approx(end, rel=1e-12)
    low = run["A.e"].min()
    assert float(low) == pytest.approx(end, rel=1e-12)
    assert (low.t, low.side) == (late, "right")
    assert float(run["B.e"].max()) == pytest.approx(end, rel=1e-12)
    assert float(run["A.e"].max()) == pytest.approx(10.0)
    assert float(run["A.e"].peak_to_peak()) == pytest.approx(10.0 - end, rel=1e-12)
    middle = 0.5 * (10.0 + end)
    (crossing,) = run["A.e"].crossings(middle)
    assert (crossing.t, crossing.edge, crossing.jump) == (late, "fall", True)
    assert run["A.e"].crossings(middle, edge="rise") == ()
    assert run["A.e"].t[-2:].tolist() == [late, late]
    assert run["A.e"].y[-2:].tolist() == pytest.approx([10.0, end], rel=1e-12)


def test_the_last_row_of_a_table_is_the_final_value(tmp_path: Path) -> None:
    run = hb.simulate(joined(), 1.0)
    table = run.table(["A.e", "A.q"])
    assert table["side"][-2:].tolist() == ["left", "right"]
    assert table["A.e"][-2:].tolist() == pytest.approx([10.0, 4.0])
    assert table["A.q"][-1] == run.final["A.q"]
    run.to_csv(tmp_path / "joined.csv", ["A.e"])
    with open(tmp_path / "joined.csv", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    assert [row[1] for row in rows[-2:]] == ["left", "right"]
    assert float(rows[-1][2]) == run.final["A.e"]


def test_a_run_that_ends_without_a_switch_has_no_row_more() -> None:
    run = hb.simulate(joined(), 0.5)
    assert run.table(["A.e"])["side"].tolist()[-1] == ""
    assert len(np.unique(run["A.e"].t)) == len(run["A.e"].t)
    by_condition = hb.simulate(joined(), ["A.e < 5 V", "3 s"])
    assert by_condition.ended_by == "A.e < 5 V"
    assert by_condition.table(["A.e"])["A.e"][-1] == pytest.approx(4.0)


def leg() -> hb.Model:
    """A load that is on for the first 0.3 s of each second, but for the first."""
    m = hb.Model("leg", domain="electrical")
    m.add(V=hb.Se("5 V"), s=hb.One(), r=hb.R(2.0))
    m.bond("V -> s -> r")
    on = "mod(time, 1 [s]) < 0.3 [s] and time > 0.5 [s]"
    rules = [f"off -> on when {on}", f"on -> off when not ({on})"]
    m.machine("S", states={"off": [], "on": ["s"]}, start="off", rules=rules)
    return m


def test_edges_of_windows_that_follow_each_other_add_up() -> None:
    run = hb.simulate(leg(), 4.0)
    current = run["V.f"]
    ends = [0.0, 1.0, 1.3, 2.0, 2.15, 3.0, 3.3, 4.0]
    parts = [current.crossings(1.0, start=a, end=b) for a, b in pairwise(ends)]
    edges = [(round(c.t, 9), c.edge) for part in parts for c in part]
    assert edges == [
        (1.0, "rise"), (1.3, "fall"), (2.0, "rise"), (2.3, "fall"), (3.0, "rise"), (3.3, "fall"),
        (4.0, "rise"),
    ]  # fmt: skip
    assert edges == [(round(c.t, 9), c.edge) for c in current.crossings(1.0)]
    # the edges of two periods, of which the last is where the window ends
    assert float(current.period(1.0, start=2.0, end=4.0)) == pytest.approx(1.0)
    with pytest.raises(UsageError, match="HB-R107"):
        current.period(1.0, start=3.0, end=4.0)
    # of extremes the limit from the right belongs to the window that begins there, if one can
    assert float(current.max(start=0.5, end=1.0)) == 0.0
    assert float(current.max(start=1.0, end=1.1)) == 2.5
    top = current.max(start=3.5)
    assert (float(top), top.t, top.side) == (2.5, 4.0, "right")


@pytest.mark.parametrize("until", [1.0, 2.0])
def test_a_sweep_measures_what_runs_do(until: float) -> None:
    asked = [
        "min(A.e)", "max(B.e)", "min_at(A.e)", "peak_to_peak(B.e)", "max(B.e, end=1)",
        "max_at(B.e, end=1)", "min(A.e, start=1)", "max(A.e + 2*B.e)", "mean(A.e)",
    ]  # fmt: skip
    table = hb.sweep(joined(), {"U": "10,20"}, until=until, collect=asked)
    for k, start in enumerate((10.0, 20.0)):
        run = hb.simulate(joined(), until, parameters={"U": start})
        for text in asked:
            if text == "min(A.e, start=1)" and until == 1.0:
                continue  # an empty window
            assert table[text][k] == pytest.approx(float(run.measure(text)), rel=1e-12), text
        assert table["min(A.e)"][k] == pytest.approx(0.4 * start)
        if until == 1.0:
            assert table["max(B.e, end=1)"][k] == pytest.approx(0.4 * start)
        assert table["max(A.e + 2*B.e)"][k] == pytest.approx(1.2 * start)


def ramp(*, turned: bool = False, slope: float = 10.0, late: float = 1.0) -> hb.Model:
    """A source that rises from zero and is taken away at a time."""
    m = hb.Model("ramp", domain="electrical")
    m.add(V=hb.Se(f"{slope}*time"), s=hb.One(), r=hb.R(2.0))
    m.bond("s -> r", "V -> s") if turned else m.bond("V -> s -> r")
    rules = [f"on -> off when time >= {late}"]
    m.machine("S", states={"on": ["s"], "off": []}, start="on", rules=rules)
    return m


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(("slope", "late"), [(10.0, 1.0), (-3.0, 0.3), (1e4, 7e-4)])
def test_the_side_of_an_extreme_at_the_end_of_a_run_is_told_as_within_it(
    slope: float, late: float, turned: bool
) -> None:
    for until in (late, 2.0 * late):
        run = hb.simulate(ramp(turned=turned, slope=slope, late=late), until)
        current = run["r.f"]
        far = current.max() if slope > 0.0 else current.min()
        assert float(far) == pytest.approx(0.5 * slope * late, rel=1e-9)
        assert (far.t, far.side) == (pytest.approx(late), "left")
        assert run["V.e"].max(start=0.5 * late, end=0.75 * late).side == ""
    smooth = hb.simulate(ramp(slope=slope, late=late), 0.5 * late)["r.f"]
    assert (smooth.max().side, smooth.min().side) == ("", "")
