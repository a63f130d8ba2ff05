"""Measurements as text: in Python, on the command line, in model files."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import hybond as hb
from hybond.cli.main import main
from hybond.measures.asked import read_measure

RC = """hybond = 1
title  = "RC"
domain = "electrical"

[elements]
c = { C = "1 mF", e = "10 V" }
r = { R = "1 kohm" }
n = { junction = 0 }

[graph]
bonds = ["n -> c", "n -> r"]

[experiment]
until   = "2 s"
measure = ["mean(c.e)", "rms(r.f, start=1)"]
"""


@pytest.fixture
def rc(tmp_path: Path) -> str:
    path = tmp_path / "rc.toml"
    path.write_text(RC, encoding="utf-8")
    return str(path)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("mean(c.e)", 10 * (1 - math.exp(-3)) / 3),
        (" integral( max(c.e, 5) , start = 0, end=3 s) ", None),
        ("min_at(c.e)", 3.0),
        ("rms(c.e, period=1 Hz, periods=3)", 10 * math.sqrt((1 - math.exp(-6)) / 6)),
        ("rise_time(c.e, final=0 V)", math.log(9)),
        ("settling_time(c.e, final=0, band=0.1)", math.log(10)),
        ("overshoot(c.e, final=5)", (5 - 10 * math.exp(-3)) / 5),
        ("max(c.e, impulses=leave out)", 10.0),
        ('max("node -> c".e)', 10.0),
    ],
)
def test_in_python(discharge: hb.Result, text: str, value: float | None) -> None:
    found = discharge.measure(text)
    half = math.log(2)
    wanted = 10 - 5 + 5 * (3 - half) if value is None else value
    assert float(found) == pytest.approx(wanted, rel=1e-9)


def test_each_knows_the_window_that_it_is_of(discharge: hb.Result, waves: hb.Result) -> None:
    for text in ("mean(c.e, start=1)", "rise_time(c.e, start=1)", "settling_time(c.e, start=1)"):
        found = discharge.measure(text)
        assert (found.start, found.end) == (1.0, 3.0), text
    ripple = waves.measure("ripple(half, period=20 ms)")
    assert ripple.end - ripple.start == pytest.approx(0.02)


def test_waves_as_text(waves: hb.Result) -> None:
    texts = ("thd(square, 50 Hz)", "duty(pulse, 2, period=20 ms)", "frequency(half, level=0.5)")
    found = waves.measure(*texts, "ripple_rms(half, period=20 ms)", "peak_to_peak(half)")
    wanted = [math.sqrt(math.pi**2 / 8 - 1), 0.25, 50.0, math.sqrt(math.pi**2 / 4 - 1), 1.0]
    assert [float(v) for v in found.values()] == pytest.approx(wanted, rel=1e-8)
    assert list(found)[:3] == list(texts)


def test_the_value_at_a_time_and_at_the_end_is_a_measurement(discharge: hb.Result) -> None:
    found = discharge.measure("final(c.e)", "at(c.e, 500 ms)", "at(2*c.e, t=1, side=left)")
    wanted = [10 * math.exp(-3.0), 10 * math.exp(-0.5), 20 * math.exp(-1.0)]
    assert [float(v) for v in found.values()] == pytest.approx(wanted, rel=1e-7)
    assert [v.t for v in found.values()] == [3.0, 0.5, 1.0]
    assert [v.unit for v in found.values()] == ["V"] * 3


def test_a_jump_has_a_value_on_either_side() -> None:
    m = hb.Model("pulse", domain="electrical")
    m.add(V=hb.Se("u"), r=hb.R("1 ohm"), i=hb.One())
    m.bond("V -> i -> r")
    m.input(u=hb.Input(table=[(0, 0), (1, 5)]))
    run = hb.simulate(m, until=2.0)
    found = run.measure("at(u, 1)", "at(u, 1, side=left)")
    assert [(float(v), v.side) for v in found.values()] == [(5.0, ""), (0.0, "left")]


def test_functions_are_listed_without_a_model(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["measure", "--list"]) == 0
    assert capsys.readouterr().out.startswith("final ")


@pytest.mark.parametrize(
    ("text", "code", "hint"),
    [
        ("mean", "HB-R120", "mean(L.f)"),
        ("mean()", "HB-R120", "mean"),
        ("mean(c.e", "HB-R120", ""),
        ("mean(max(c.e, 1)", "HB-R120", ""),
        ("mean(c.e, 5)", "HB-R120", "periods"),
        ("mean(c.e, start=1, start=2)", "HB-R120", "once"),
        ("mean(c.e, tolerance=fine)", "HB-R120", "0.02"),
        ("meen(c.e)", "HB-R121", "'mean'"),
        ("mean(c.e, perod=1)", "HB-R121", "'period'"),
        ("mean(c.u)", "HB-S109", "c.e"),
        ("at(c.e)", "HB-R120", "at(c.e, 1 ms)"),
        ("at(c.e, 1 V)", "HB-R101", "'2 ms'"),
        ("at(c.e, 4 s)", "HB-S110", "within"),
        ("at(c.e, 1 s, side=up)", "HB-S110", "left or right"),
        ("final(c.e, 1)", "HB-R120", "final(L.f)"),
        ("final(c.e, t=1)", "HB-R121", "leave it out"),
        ("__import__('os')", "HB-R121", ""),
    ],
)
def test_texts_that_ask_for_nothing(discharge: hb.Result, text: str, code: str, hint: str) -> None:
    with pytest.raises(hb.UsageError) as refused:
        discharge.measure(text)
    assert refused.value.code == code and hint in refused.value.hint


def test_the_experiment_asks(rc: str, capsys: pytest.CaptureFixture[str]) -> None:
    run = hb.simulate(hb.load(rc), rtol=1e-11)
    found = run.measure()
    assert float(found["mean(c.e)"]) == pytest.approx(5 * (1 - math.exp(-2)), rel=1e-10)
    assert main(["run", rc]) == 0
    assert "mean(c.e)         = 4.32332 V" in capsys.readouterr().out
    assert main(["run", rc, "--json"]) == 0
    record = json.loads(capsys.readouterr().out)
    assert record["measures"]["mean(c.e)"]["value"] == pytest.approx(4.3233236, rel=1e-7)
    assert record["measures"]["mean(c.e)"]["unit"] == "V"
    assert main(["measure", rc]) == 0
    assert "rms(r.f, start=1) = " in capsys.readouterr().out


def test_a_file_that_asks_for_what_is_not_there(
    rc: str, capsys: pytest.CaptureFixture[str]
) -> None:
    Path(rc).write_text(RC.replace("mean(c.e)", "maen(c.e)"), encoding="utf-8")
    assert main(["run", rc]) == 2
    said = capsys.readouterr().err
    assert said.startswith("HB-R121 at ") and "rc.toml:15" in said and "'mean'" in said
    assert main(["check", rc]) == 2


def test_the_verb(rc: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["measure", rc, "max(c.e)", "--losses", "--set", "c.e=20 V"]) == 0
    said = capsys.readouterr().out
    assert "max(c.e) = 20 V" in said and "at t = 0 s" in said and "dissipated" in said
    assert main(["measure", rc, "mean(c.e)", "--json", "--losses", "--power"]) == 0
    record = json.loads(capsys.readouterr().out)
    lost = 0.05 * (1 - math.exp(-4))
    assert record["losses"]["total"]["dissipated"] == pytest.approx(lost / 2, rel=1e-7)
    assert record["losses"]["unit"] == "W"
    picture = tmp_path / "losses.svg"
    assert main(["measure", rc, "--losses", "--sankey", str(picture)]) == 0
    assert "<svg" in picture.read_text(encoding="utf-8")
    capsys.readouterr()
    assert main(["measure", rc, "--list"]) == 0
    assert "settling_time" in capsys.readouterr().out


def test_what_cannot_be_measured_is_said_and_the_rest_is_told(
    rc: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["measure", rc, "frequency(c.e)", "max(c.e)"]) == 1
    told = capsys.readouterr()
    assert "max(c.e)       = 10 V" in told.out and "HB-R107" in told.err
    assert main(["measure", rc, "mean(c.e)", "--period", "1 s"]) == 1
    assert "HB-X101" in capsys.readouterr().err
    Path(rc).write_text(RC.split("measure =")[0], encoding="utf-8")
    assert main(["measure", rc]) == 1
    assert "--list" in capsys.readouterr().err


def test_a_run_that_is_measured_ends_where_the_file_or_the_option_says(
    rc: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """A discharge, 10 V*exp(-t/1 s), whose end a condition gives: in the file, then by option."""
    until = 'until   = ["c.e < 5 [V]", "2 s"]'
    Path(rc).write_text(RC.replace('until   = "2 s"', until), encoding="utf-8")
    for options, end in (
        ([], math.log(2)),
        (["--until", "0.5 s"], 0.5),
        (["--until", "c.e < 8 [V]", "--until", "2 s"], math.log(10 / 8)),
    ):
        assert main(["measure", rc, "min(c.e)", "--json", *options]) == 0
        record = json.loads(capsys.readouterr().out)
        assert record["t_end"] == pytest.approx(end, rel=1e-7)
        assert record["measures"]["min(c.e)"]["value"] == pytest.approx(10 * math.exp(-end))


def test_a_measured_run_that_stops_where_events_accumulate_says_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Two tanks that lose 0.5 each and share 0.75: both are empty at 2/(1 - 0.75) s."""
    path = tmp_path / "tanks.toml"
    path.write_text(
        """hybond = 1
[elements]
one = { C = 1, e = 1 }
two = { C = 1, e = 1 }
a = { junction = 0 }
b = { junction = 0 }
fill_a = { Sf = 'if hose.state == "first" then 0.75 else 0' }
fill_b = { Sf = 'if hose.state == "second" then 0.75 else 0' }
out_a = { Sf = 0.5 }
out_b = { Sf = 0.5 }
[graph]
bonds = ["fill_a -> a -> one", "fill_b -> b -> two", "a -> out_a", "b -> out_b"]
[machines.hose]
states = { first = [], second = [] }
start = "first"
rules = ["first -> second when two.e <= 0", "second -> first when one.e <= 0"]
[experiment]
until = 10
""",
        encoding="utf-8",
    )
    assert main(["measure", str(path), "max(one.e)"]) == 3
    assert "events of hose accumulate at t = 8 s" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("given", "t"),
    [("1 s", 1.0), ("500 ms", 0.5), (1, 1.0), (["1 s", 0.5], [1.0, 0.5]), (["2 s"], [2.0])],
)
def test_values_at_times_with_units(discharge: hb.Result, given: Any, t: Any) -> None:
    assert np.array_equal(discharge["c.e"].at(given), discharge["c.e"].at(t))
    assert np.ndim(discharge["c.e"].at(given)) == np.ndim(t)
    assert np.array_equal(
        discharge.sample(given, ["c.e"])["c.e"],
        discharge.sample(t, ["c.e"])["c.e"],
    )


@pytest.mark.parametrize("given", ["1 V", "soon", ["1 s", "soon"], "1e9 s"])
def test_what_is_no_time_of_the_run_is_refused(discharge: hb.Result, given: Any) -> None:
    with pytest.raises(hb.UsageError, match="HB-S110"):
        discharge["c.e"].at(given)


def test_a_time_that_is_missing_is_told_before_the_run() -> None:
    with pytest.raises(hb.HybondError, match=r"at\(c.e\) does not say when") as told:
        read_measure("at(c.e)")
    assert told.value.code == "HB-R120" and told.value.hint == "at(c.e, 1 ms)"
