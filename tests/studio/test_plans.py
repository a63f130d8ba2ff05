"""Sweeps of plans in the studio: places of what is wrong, views by closed forms, nothing lost."""

from __future__ import annotations

import math
import shlex
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from studio.asking import asked, edit, eventually

import hybond as hb
from hybond.cli.main import main
from hybond.studio.session import Session

BALL = Path(__file__).parents[2] / "examples" / "bouncing_ball.toml"
LINE = """\
hybond = 1
title = "q(1 s) = a + 2 b + c"
[parameters]
a = 1.0
b = 1.0
c = 0.0
[elements]
s = { Sf = "a + 2*b" }
n = { junction = 0 }
q = { C = 1.0, q = "c" }
[graph]
bonds = ["s -> n -> q"]
[experiment]
until = 1.0
"""
"""A flow a + 2 b into a store that starts with c."""


def plan(way: str = "grid", collect: str = "final(q.q)", **factors: str) -> dict[str, Any]:
    listed = [{"path": p.replace("__", "."), "values": v} for p, v in factors.items()]
    return {"factors": listed, "way": way, "collect": collect}


def line() -> Session:
    session = Session(None)
    asked(session, "replace", text=LINE)
    return session


def swept(session: Session, wanted: dict[str, Any]) -> int:
    number: int = asked(session, "plan begin", **wanted)["plan"]
    planned = session.plans.current
    assert planned is not None
    eventually(lambda: planned.state != "running")
    assert planned.state == "done"
    return number


def seen(session: Session, number: int, view: str, **more: Any) -> dict[str, Any]:
    return asked(session, "plan view", plan=number, view=view, **more)


def test_what_is_wrong_is_told_where_it_is() -> None:
    session = Session(None)
    asked(session, "open", example="falling_rod")
    words = asked(session, "plan words")
    assert words["values"]["J"] == "0.65 kg*m^2..2.6 kg*m^2:11"
    assert {"first(", "sequence", "w.f", "tip.stuck", "slip.on"} <= set(words["words"])
    right = plan(mu="0.2:0.3:0.05", J="1, 1.2", collect=words["collect"])
    found = asked(session, "plan look", **right)
    assert (found["members"], found["wrong"]) == (6, {})
    wrong = {
        **plan(mo="1", mu="1 kg", J="norml(1, 2)", collect="fnal(w.f)"),
        **{"until": "w.g > 0, 2 s", "seed": "x"},
    }
    places = asked(session, "plan look", **wrong)["wrong"]
    assert {place: said["code"] for place, said in places.items()} == {
        "path.0": "HB-M107",
        "values.1": "HB-U103",
        "values.2": "HB-P101",
        "collect": "HB-P104",
        "until": "HB-S136",
        "seed": "HB-P102",
    }
    assert places["collect"]["try"] == "did you mean 'final'?"
    twice = {"path": "mu", "values": "0.3"}
    for patch, place in (
        ({"way": "lhs", "count": "many"}, "way"),
        ({"way": "together"}, "way"),
        ({"way": "sobol", "count": "900000000"}, "way"),
        ({"factors": [*right["factors"], twice]}, "path.2"),
        ({"factors": [{"path": "mu", "values": "normal(0.3, 0.1)"}]}, "way"),
        ({"collect": "at(w.f, 3 s)"}, "collect"),
        ({"until": "0 s"}, "until"),
    ):
        assert list(asked(session, "plan look", **{**right, **patch})["wrong"]) == [place], patch
    refused = session.handle({"id": 1, "ask": "plan begin", **wrong})
    assert refused["error"]["code"] in {said["code"] for said in places.values()}
    assert session.plans.current is None


def test_the_map_of_sequences_is_the_boundary_of_the_paper() -> None:
    """J/(m l^2) = sin(theta) cos(theta)/mu - sin(theta)^2: beyond it the rod sticks."""
    session = Session(None)
    asked(session, "open", example="falling_rod")
    wanted = plan(mu="0.2:0.4:0.02", J="0.61:1.81:0.1", collect="sequence, first(tip.stuck)")
    number = swept(session, {**wanted, "until": "0.45 s"})
    found = seen(session, number, "map", x="mu", y="J", value="sequence")
    theta = 0.85
    mu, inertia = np.meshgrid(found["across"], found["up"])
    sticks = inertia > math.sin(theta) * math.cos(theta) / mu - math.sin(theta) ** 2
    named = [found["names"][int(k)].startswith("free > stuck") for k in found["number"]]
    assert 30 < sticks.sum() < sticks.size - 30
    assert named == sticks.ravel().tolist()
    assert (found["x"]["unit"], found["y"]["unit"]) == ("", "kg*m^2")  # as the model has them
    assert found["x"]["edges"] == pytest.approx(np.linspace(0.19, 0.41, 12))
    when = seen(session, number, "map", x="mu", y="J", value="first(tip.stuck)")["number"]
    assert [v is not None for v in when] == sticks.ravel().tolist()


def test_views_have_the_numbers_of_closed_forms() -> None:
    session = line()
    cube = swept(session, plan(a="0:1:0.5", b="0:1:0.25", c="-1, 3", collect="final(q.q)"))
    slice_ = seen(session, cube, "map", x="a", y="b", value="final(q.q)", at={"c": 1})
    a, b = np.meshgrid([0.0, 0.5, 1.0], [0.0, 0.25, 0.5, 0.75, 1.0])
    assert slice_["number"] == pytest.approx((a + 2.0 * b + 3.0).ravel())
    points = seen(session, cube, "scatter", x="c", y="final(q.q)", value="status")
    assert points["all"] == 30 and points["names"] == ["ok"] and points["x"]["edges"] is None
    row = asked(session, "plan member", plan=cube, member=29)
    assert row["sets"] == {"a": 1.0, "b": 1.0, "c": 3.0}
    assert row["row"]["final(q.q)"] == pytest.approx(6.0)
    rows = seen(session, cube, "table", first=28)
    assert [r[0] for r in rows["rows"]] == [28, 29] and rows["columns"][1]["name"] == "a"

    curves = swept(session, plan("lhs", "curve(q.q, 3)", c="0..1") | {"count": "101"})
    family = seen(session, curves, "family", curve="curve(q.q, 3)")
    starts = np.sort([row[0] for row in family["curves"]])
    assert len(starts) == 40 and starts[0] > 0.0 and starts[-1] < 1.0
    for band, rise in zip(np.transpose(family["bands"]), (0.0, 1.5, 3.0)):
        assert band - rise == pytest.approx([0.05, 0.25, 0.5, 0.75, 0.95], abs=0.011)

    ends = swept(session, plan("ends", a="0..2", b="0..2", c="normal(0, 1)"))
    tornado = seen(session, ends, "tornado", value="final(q.q)")
    z = 1.6448536269514722  # of the normal distribution, at 95 %
    assert [r["path"] for r in tornado["rows"]] == ["b", "c", "a"]
    assert tornado["middle"] == pytest.approx(3.0)
    assert tornado["rows"][0]["outcomes"] == pytest.approx([1.2, 4.8])
    assert tornado["rows"][1]["ends"] == pytest.approx([-z, z])
    for r in tornado["rows"]:  # the members behind the bars are those runs
        for k, outcome in zip(r["members"], r["outcomes"]):
            own = asked(session, "plan member", plan=ends, member=k)["row"]["final(q.q)"]
            assert own == outcome

    wide = plan("saltelli", a="0..1", b="0..1", c="normal(0, 1)") | {"count": "512", "seed": "3"}
    indices = seen(session, swept(session, wide), "sobol", value="final(q.q)")
    parts = {r["path"]: r["first"][0] for r in indices["rows"]}
    assert parts == pytest.approx({"a": 1 / 17, "b": 4 / 17, "c": 12 / 17}, abs=0.02)
    refused = session.handle({"id": 1, "ask": "plan view", "plan": ends, "view": "tornado"})
    assert refused["error"]["code"] == "HB-W103"  # that sweep is gone


@pytest.mark.slow
def test_the_command_to_copy_makes_the_table_of_the_page(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HYBOND_STATE", str(tmp_path / "state"))
    file = tmp_path / "a line.toml"
    file.write_text(LINE)
    session = Session(file)
    wanted = plan("lhs", "final(q.q), ended, count(events)", a="1, 2", q__C="uniform(1, 2)")
    wanted |= {"count": "40", "seed": "9", "until": "q.q > 2, 0.9"}
    table = asked(session, "plan csv", plan=swept(session, wanted))
    words = shlex.split(asked(session, "plan look", **wanted)["command"])
    assert words[0] == "hybond"
    assert main(words[1:]) == 0
    assert (tmp_path / "a line_sweep" / "table.csv").read_text() == table["text"]
    assert table["name"] == "a line_sweep.csv"
    session.close()


@pytest.mark.slow
def test_a_cancel_keeps_the_runs_that_were_done() -> None:
    session = line()
    told: list[dict[str, Any]] = []
    session.listen(told.append)
    number = asked(session, "plan begin", **plan(a="0:1:0.00001", b="0"))["plan"]
    # what is there is looked at while it goes on
    eventually(lambda: [m for m in told if m["tell"] == "planning" and m["kept"]])
    first = seen(session, number, "scatter", x="a", y="final(q.q)", value="status")
    assert first["kept"] > 0 and first["up"] == pytest.approx(first["across"])
    asked(session, "plan cancel")
    last = eventually(
        lambda: [m for m in told if m["tell"] == "planning" and m["state"] == "cancelled"]
    )[0]
    assert 0 < last["kept"] < last["members"] == 100_001 and last["done"] == last["kept"]
    assert [m["left"] for m in told[:-1] if m["tell"] == "planning"][-1] > 0.0
    rows = asked(session, "plan csv", plan=number)["text"].splitlines()[1:]
    assert len(rows) == last["kept"]
    a, q = np.array([[float(r.split(",")[1]), float(r.split(",")[-1])] for r in rows]).T
    assert q == pytest.approx(a)
    # one that would take for ever stops, too
    asked(session, "open", example="boost")
    endless = {**plan(V="10 V, 12 V", collect="max(coil.current)"), "until": "1e6"}
    asked(session, "plan begin", **endless)
    asked(session, "plan cancel")
    planned = session.plans.current
    assert planned is not None
    eventually(lambda: planned.state == "cancelled")
    assert asked(session, "plan state")["now"]["kept"] == 0


def test_a_member_is_opened_as_the_run_that_its_row_tells_of() -> None:
    session = Session(None)
    asked(session, "open", example="bouncing_ball")
    wanted = plan("random", "final(height), max(height)", m="0..1 kg", pad__C="1e-4..1e-2 m/N")
    number = swept(session, {**wanted, "count": "5", "until": "1.2 s"})
    edit(session, do="set", path=["parameters", "m"], value="7 kg")  # the sweep stays what it was
    told: list[dict[str, Any]] = []
    session.listen(told.append)
    row = asked(session, "plan member", plan=number, member=3)
    asked(session, "plan open", plan=number, member=3)
    done = eventually(lambda: [m for m in told if m["tell"] == "finished"])[0]
    assert done["own"] and done["title"].startswith("run 3 of the sweep: m = 0.")
    run = session.runs.result(done["run"])
    assert float(run.sample(run.t_end, ["height"])["height"][0]) == row["row"]["final(height)"]
    # and that of a model with these values written into it
    again = hb.simulate(hb.load(BALL), "1.2 s", parameters=row["sets"])
    assert again["height"].at(1.2) == pytest.approx(row["row"]["final(height)"], rel=1e-12)
    refused = session.handle({"id": 1, "ask": "plan open", "plan": number, "member": 5})
    assert refused["error"]["code"] == "HB-P109"


def test_runs_that_fail_are_rows_with_a_reason() -> None:
    session = Session(None)
    asked(session, "open", example="bouncing_ball")
    number = swept(session, {**plan(m="0 kg, 1 kg", collect="final(height)"), "until": "0.1 s"})
    found = seen(session, number, "scatter", x="m", y="final(height)", value="status")
    assert found["names"] == ["error", "ok"] and found["up"][0] is None
    assert asked(session, "plan member", plan=number, member=0)["row"]["code"].startswith("HB-")
    # it falls 9.81/2 m/s^2 * (0.1 s)^2 from 3 m
    assert found["up"][1] == pytest.approx(3.0 - 0.5 * 9.81 * 0.01, rel=1e-9)
