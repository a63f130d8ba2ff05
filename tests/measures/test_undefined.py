"""Signals that have no value in parts of a run: said with their name, when, and why."""

from __future__ import annotations

import csv
import json
import math
from pathlib import Path

import numpy as np
import pytest

import hybond as hb
from hybond.cli.main import main

ALPHA = "signal a has no value from t = 0.693147 s on: it is the root of less than zero"


def emptied(**signals: str) -> hb.Model:
    """A charge that is ``exp(-t)``, a source that is ``max(0, t - 1)``, and signals of them."""
    m = hb.Model("emptied")
    m.add(c=hb.C(1.0, e=1.0), r=hb.R(1.0), n=hb.Zero())
    m.add(s=hb.Se("max(0, time - 1 [s])/1 [s]"), k=hb.R(1.0), j=hb.One())
    m.bond("n -> c", "n -> r", "s -> j -> k")
    m.signal(**signals)
    return m


@pytest.mark.parametrize(
    ("text", "when", "why"),
    [
        ("sqrt(c.e - 0.5)", f"from t = {math.log(2.0):.6g} s on", "the root of less than zero"),
        ("(c.e - 0.5)^0.5", f"from t = {math.log(2.0):.6g} s on", "-"),
        ("log(-c.e)", "from t = 0 s on", "the log of -1"),
        ("s.e*s.f/(k.e*k.f)", "from t = 0 s to 1 s", "0/0"),
        ("1/s.e", "from t = 0 s to 1 s", "divided by zero"),
        ("asin(2*c.e)", f"from t = 0 s to {math.log(2.0):.6g} s", "the asin of 2"),
    ],
)
def test_it_is_said_when_and_why(text: str, when: str, why: str) -> None:
    run = hb.simulate(emptied(a=text), 3.0)
    assert run.status == "ok"
    [told] = run.warnings
    assert told.startswith(f"signal a has no value {when}: it is {why}")


def test_what_has_values_is_not_told_of() -> None:
    """A condition that asks first, a quotient whose divisor stays, roots from zero on."""
    run = hb.simulate(
        emptied(
            a="if s.e > 0 then s.f/s.e else 0", b="1/c.e", d="sqrt(s.e)", f="log(c.e)", g="c.e^0.5"
        ),
        3.0,
    )
    assert run.warnings == ()
    assert run["a"].at(0.5) == 0.0


def test_values_on_both_sides_of_a_gap() -> None:
    """``|sin|`` less a half has its root where ``sin(t)`` is beyond a half: two gaps up to 4 s."""
    m = emptied(a="sqrt(abs(sin(time/1 [s])) - 0.5)")
    run = hb.simulate(m, 4.0)
    assert run.warnings == (
        f"signal a has no value from t = 0 s to {math.pi / 6.0:.6g} s and 1 time after that: "
        "it is the root of less than zero",
    )
    assert np.isnan(run["a"].at(0.5))
    assert run["a"].at(1.0) == pytest.approx(math.sqrt(math.sin(1.0) - 0.5))


@pytest.mark.parametrize("engine", ["python", None])
def test_a_guard_that_compares_it_is_refused(engine: str | None) -> None:
    m = emptied(a="sqrt(c.e - 0.5)")
    m.machine("g", states={"x": [], "y": []}, start="x", rules=["x -> y when a > 0.9"])
    run = hb.simulate(m, 3.0, engine=engine, on_error="return")
    assert run.error is not None
    assert (run.error.code, run.error.where) == ("HB-N302", "g")
    assert "the guard 'a > 0.9' compares what is not a number" in str(run.error)
    assert 0.0 < run.t_end <= math.log(2.0)


def test_a_guard_that_asks_before_it_is_not() -> None:
    """``s.e`` is zero up to 1 s, where ``s.f/s.e`` has no value; after that it is 1."""
    m = emptied(a="s.f/s.e")
    rule = "x -> y when s.e > 0.25 and a > 0.5"
    m.machine("g", states={"x": [], "y": []}, start="x", rules=[rule])
    run = hb.simulate(m, 3.0)
    assert run.events.t[1] == pytest.approx(1.25, abs=1e-9)
    assert run.warnings == ("signal a has no value from t = 0 s to 1 s: it is 0/0",)


def test_a_law_that_reads_it_is_refused() -> None:
    m = emptied(a="sqrt(c.e - 0.5)")
    m.add(t=hb.Sf("-0.1*a"))
    m.bond("t -> n")
    run = hb.simulate(m, 3.0, on_error="return")
    assert run.error is not None
    assert run.error.code in ("HB-N302", "HB-N202")


def test_the_command_line_and_its_files_say_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "model.toml"
    file.write_text(
        "hybond = 1\n[elements]\nC = { C = 1, e = 1 }\nR = { R = 1 }\nn = { junction = 0 }\n"
        '[graph]\nbonds = ["n -> C", "n -> R"]\n[signals]\na = "sqrt(C.e - 0.5)"\n'
        '[experiment]\nuntil = "2 s"\n'
    )
    out = tmp_path / "run.csv"
    assert main(["run", str(file), "--out", str(out)]) == 0
    assert f"warning: {ALPHA}" in "".join(capsys.readouterr())
    rows = list(csv.DictReader(out.read_text().splitlines()))
    assert rows[-1]["a"] == "nan"
    assert float(rows[0]["a"]) == pytest.approx(math.sqrt(0.5))
    assert main(["run", str(file), "--json", "--at", "0,2", "--signals", "a"]) == 0
    record = json.loads(capsys.readouterr().out)
    assert ALPHA in record["warnings"]
    assert record["samples"]["a"] == [pytest.approx(math.sqrt(0.5)), None]
