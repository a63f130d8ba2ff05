"""Runs of the studio: plots, events, cancelled, hanging, seen while they go on."""

from __future__ import annotations

import threading
import time
from typing import Any

import pytest
from studio.asking import asked, edit, eventually, finished

from hybond.studio.session import Session


def test_a_run_its_curves_and_its_instants() -> None:
    session = Session(None)
    asked(session, "open", example="diode_inductor")
    told = finished(session)
    assert (told["status"], told["events"]) == ("ok", 3)
    run = told["run"]
    seen = asked(session, "curves", run=run, names=["L.f"], t0=0, t1=0.25, width=200, strip=True)
    t, y = seen["curves"][0]["t"], seen["curves"][0]["y"]
    assert max(y) == pytest.approx(1 - 2.718281828459045**-5, rel=1e-6)
    assert t[0] == 0.0 and t[-1] == 0.25
    assert [s[2] for s in seen["strip"][1]["stays"]] == [0, 1, 0]
    event = asked(session, "events", run=run)["events"][1]
    assert [s["kind"] for s in event["steps"]] == ["mythical", "continuous"]
    mythical = asked(
        session, "cursor", run=run, t=event["t"], side="left", mode=event["steps"][0]["mode"]
    )
    assert mythical["strokes"]["nodes"]["L"]["derivative"]
    # before the instant the source gives all of its current to the coil
    assert mythical["values"]["0.0"]["f"] == pytest.approx(max(y), rel=1e-6)


def test_a_run_is_cancelled_and_keeps_what_it_has() -> None:
    session = Session(None)
    asked(session, "open", example="boost")
    told: list[dict[str, Any]] = []
    session.listen(told.append)
    asked(session, "run", until=1e4)
    eventually(lambda: any(m["tell"] == "progress" and m["events"] > 10 for m in told))
    asked(session, "cancel")
    done = eventually(lambda: [m for m in told if m["tell"] == "finished"])
    assert done[0]["status"] == "interrupted"
    assert 0.0 < done[0]["tEnd"] < 1e4
    # and editing goes on as ever
    assert "error" not in session.handle({"id": 1, "ask": "look"})


def test_a_run_is_seen_while_it_goes_on() -> None:
    session = Session(None)
    asked(session, "open", example="boost")
    told: list[dict[str, Any]] = []
    session.listen(told.append)
    run = asked(session, "run", until=1e4, names=["coil.current", "nonsense.e"])["run"]
    seen = eventually(lambda: [m for m in told if m["tell"] == "partial"])[0]
    asked(session, "cancel")
    eventually(lambda: [m for m in told if m["tell"] == "finished"])
    good, bad = seen["curves"]
    assert bad["error"]["code"] == "HB-S109"
    assert seen["run"] == run and seen["tEnd"] == 1e4 and seen["strip"][0]["states"]
    # what was seen is what the run is
    whole = session.runs.result(run)["coil.current"]
    for t, y in list(zip(good["t"], good["y"]))[5:-1:7]:
        assert min(abs(whole.at(t, side=side) - y) for side in ("left", "right")) < 1e-6


def test_a_run_that_hangs_is_left_behind(monkeypatch: pytest.MonkeyPatch) -> None:
    import hybond.studio.runs as runs

    stuck = threading.Event()
    real = runs.simulate
    monkeypatch.setattr(runs, "PATIENCE", 0.05)
    monkeypatch.setattr(runs, "simulate", lambda *a, **k: stuck.wait(20))
    session = Session(None)
    asked(session, "open", example="diode_inductor")
    told: list[dict[str, Any]] = []
    session.listen(told.append)
    asked(session, "run")
    asked(session, "cancel")
    left = eventually(lambda: [m for m in told if m["tell"] == "finished"])
    assert left[0]["error"]["code"] == "HB-W109"
    # edits and runs go on, and what the old one does at last is told nobody
    edit(session, do="set", path=["title"], value="still here")
    monkeypatch.setattr(runs, "simulate", real)
    asked(session, "run")
    eventually(lambda: len([m for m in told if m["tell"] == "finished"]) == 2)
    stuck.set()
    time.sleep(0.05)
    ends = [m for m in told if m["tell"] == "finished"]
    assert [m.get("status") for m in ends] == ["error", "ok"]


def test_no_spike_is_lost_between_pixels() -> None:
    session = Session(None)
    asked(session, "open", example="boost")
    run = finished(session)["run"]
    result = session.runs.result(run)
    seen = asked(session, "curves", run=run, names=["coil.current"], t0=0, t1=4e-3, width=64)
    y = seen["curves"][0]["y"]
    assert len(y) <= 4 * 64 + 2
    assert max(y) == result["coil.current"].y.max()
    assert min(y) == result["coil.current"].y.min()


def test_what_cannot_watch_is_refused_and_an_ensemble_has_no_watch() -> None:
    import hybond as hb

    m = hb.Model("rc", domain="electrical", parameters={"r": 1.0})
    m.add(c=hb.C("1 F", e="1 V"), r1=hb.R("r"), node=hb.Zero())
    m.bond("node -> c", "node -> r1")
    with pytest.raises(hb.UsageError, match="HB-S131"):
        hb.simulate(m, 1.0, watch=5)  # type: ignore[arg-type]
    with pytest.raises(hb.UsageError, match="HB-S115"):
        hb.ensemble(m, 1.0, sets={"r": [1.0, 2.0]}, watch=lambda run: None)


def test_a_run_ends_where_the_experiment_has_a_condition() -> None:
    session = Session(None)
    asked(session, "open", example="bouncing_ball")
    edit(session, do="set", path=["experiment", "until"], value=["height < 0.5 m", "3 s"])
    told = finished(session)
    # it falls from 3 m, under 9.81 m/s^2
    assert (told["status"], told["until"]) == ("ok", 3.0)
    assert told["tEnd"] == pytest.approx((2.0 * 2.5 / 9.81) ** 0.5, rel=1e-9)
    event = asked(session, "events", run=told["run"])["events"][-1]
    assert event["cause"] == "until"
    assert finished(session, until="height < 1 m")["status"] == "ok"
