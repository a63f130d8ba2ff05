"""``hybond sweep --collect``: what it prints, writes, estimates and refuses."""

from __future__ import annotations

import csv
import math
from pathlib import Path
from typing import Any

import pytest

WORDS = ("--vary", "m=1..3kg:3", "--vary", "mass.f=lin(2,4,2)", "--collect", "final(mass.f), ended")


def test_a_plan_is_run_once(shell: Any) -> None:
    done = shell("sweep", "spring.toml", *WORDS, "--out", "s")
    assert done.code == 0 and done.err == ""
    assert "6 members, grid of m, mass.f\n  6 ok\n" in done.out
    with Path("s/table.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        expected = float(row["mass.f"]) * math.cos(2.0 * math.sqrt(8.0 / float(row["m"])))
        assert float(row["final(mass.f)"]) == pytest.approx(expected, abs=1e-6)
    before = Path("s/table.csv").read_bytes()
    again = shell("sweep", "spring.toml", *WORDS, "--out", "s", "--json").json
    assert again["how"].startswith("6 members were there; 0 members")
    assert again["counts"] == {"ok": 6} and again["collected"]["final(mass.f)"]["none"] == 0
    assert Path("s/table.csv").read_bytes() == before


def test_settings_hold_for_all_members(shell: Any) -> None:
    words = ("--set", "k=2 N/m", "--vary", "m=1 kg, 2 kg", "--collect", "final(mass.f)", "--json")
    found = shell("sweep", "spring.toml", *words).json["collected"]["final(mass.f)"]
    ends = [3.0 * math.cos(2.0 * math.sqrt(2.0 / m)) for m in (1.0, 2.0)]
    assert [found["least"], found["most"]] == pytest.approx(sorted(ends), abs=1e-6)
    assert found["unit"] == "m/s"


def test_failures_are_told_and_counted(shell: Any) -> None:
    done = shell("sweep", "spring.toml", "--vary", "m=1,0,2", "--collect", "final(mass.f)")
    assert done.code == 2 and "2 ok\n  1 error (HB-M163)" in done.out
    assert done.err.startswith("member 1: HB-M163")


def test_an_estimate_runs_nothing_for_good(shell: Any, monkeypatch: Any) -> None:
    monkeypatch.setattr("hybond.sweep.estimating.PATIENCE", 0.05)
    words = ("--vary", "m=1:2:0.001", "--collect", "final(mass.f)", "--out", "s", "--estimate")
    done = shell("sweep", "spring.toml", *words)
    assert done.code == 0 and done.out.startswith("1001 members") and not Path("s").exists()
    assert shell("sweep", "spring.toml", *words, "--json").json["members"] == 1001


def test_levels_of_plans_in_a_sweep_as_ever(shell: Any) -> None:
    for text, expected in (
        ("m=1:2:0.5", [1.0, 1.5, 2.0]),
        ("m=log(1 kg, 4 kg, 3)", pytest.approx([1.0, 2.0, 4.0])),
    ):
        assert shell("sweep", "spring.toml", "--vary", text, "--json").json["parameters"] == {
            "m": expected
        }


def test_a_logarithm_is_no_range(shell: Any) -> None:
    for options in ([], ["--collect", "final(mass.f)"]):
        done = shell("sweep", "spring.toml", "--vary", "m=log(20),log(7)", *options, "--json").json
        record = done.get("final", done.get("collected"))[
            "mass.f" if not options else "final(mass.f)"
        ]
        found = record if not options else [record["least"], record["most"]]
        ends = [3.0 * math.cos(2.0 * math.sqrt(8.0 / math.log(x))) for x in (20.0, 7.0)]
        assert sorted(found) == pytest.approx(sorted(ends), abs=1e-6)


@pytest.mark.parametrize(
    ("words", "code"),
    [
        (["--sample", "lhs:3", "--vary", "m=1..2"], "HB-X101"),
        (["--seed", "0", "--vary", "m=1,2"], "HB-X101"),
        (["--part", "3", "--vary", "m=1,2"], "HB-X101"),
        (["--collect", "ended"], "HB-X103"),
        (["--collect", "ended", "--vary", "m"], "HB-X103"),
        (["--collect", "ended", "--vary", "m=1", "--vary", "m=2"], "HB-X103"),
        (["--collect", "ended", "--vary", "m=1,2", "--out", "t.csv"], "HB-X101"),
        (["--collect", "ended", "--vary", "m=1,2", "--signals", "mass.f"], "HB-X101"),
        (["--collect", "ended", "--vary", "m=normal(1,2)"], "HB-P102"),
        (["--vary", "m=normal(1,2)"], "HB-X103"),
        (["--collect", "endd", "--vary", "m=1,2"], "HB-P103"),
        (["--collect", "ended", "--vary", "m=1,2", "--runs", "csv", "--out", "s"], "HB-P108"),
        (["--collect", "ended", "--vary", "m=1,2", "--runs", "netcdf"], "HB-P108"),
        (["--collect", "ended", "--vary", "mm=1,2"], "HB-M107"),
    ],
)
def test_what_makes_no_sense_is_refused(shell: Any, words: list[str], code: str) -> None:
    done = shell("sweep", "spring.toml", *words)
    assert done.code in (1, 2) and done.out == ""
    assert done.err.startswith(code)
