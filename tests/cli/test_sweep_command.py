"""``hybond sweep``: what it varies, prints, writes and returns."""

import csv
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest


def spring(m: float, k: float) -> float:
    """Return the velocity after 2 s of a mass that begins with 3 m/s."""
    return 3.0 * math.cos(2.0 * math.sqrt(k / m))


def test_all_combinations_the_last_fastest(shell: Any) -> None:
    done = shell(
        *("sweep", "spring.toml", "--vary", "m=1..3kg:3", "--vary", "k=8 N/m, 2 N/m"),
        *("--signals", "mass.f", "--out", "table.csv"),
    )
    assert done.code == 0 and done.err == ""
    with (shell.folder / "table.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [float(r["m"]) for r in rows] == [1.0, 1.0, 2.0, 2.0, 3.0, 3.0]
    assert [float(r["k"]) for r in rows] == [8.0, 2.0] * 3
    for row in rows:
        expected = spring(float(row["m"]), float(row["k"]))
        assert float(row["mass.f"]) == pytest.approx(expected, abs=1e-6)
    head = done.out.splitlines()[2].split()
    assert head == ["member", "m", "k", "status", "t_end", "[s]", "events", "mass.f", "[m/s]"]


def test_together_there_is_no_grid(shell: Any) -> None:
    words = ("--vary", "m=1,2", "--vary", "k=3,4", "--together", "--json")
    record = shell("sweep", "spring.toml", *words).json
    assert record["parameters"] == {"m": [1.0, 2.0], "k": [3.0, 4.0]}
    found = record["final"]["mass.f"]
    assert found == pytest.approx([spring(1.0, 3.0), spring(2.0, 4.0)], abs=1e-6)
    assert record["units"]["mass.f"] == "m/s" and record["members"] == 2


def test_a_range_takes_its_unit_from_either_end(shell: Any) -> None:
    for text in ("m=1..2000 g:2", "m=1 g..2000:2", "m=1 g..2 kg:2", "m=0.001..2:2"):
        record = shell("sweep", "spring.toml", "--vary", text, "--json").json
        assert record["parameters"]["m"] == [0.001, 2.0]


def test_settings_and_options_hold_for_all_members(shell: Any) -> None:
    # one step of Euler in 1 ms: the velocity changes by a millionth of what the spring pulls
    words = ("--set", "k=2 N/m", "--set", "spring.q=1 m", "--until", "1 ms", "--solver", "euler")
    done = shell("sweep", "spring.toml", "--vary", "m=1,2", *words, "--step", "1 ms", "--json")
    expected = [3.0 - 1e-3 * 2.0 / m for m in (1.0, 2.0)]
    assert done.json["final"]["mass.f"] == pytest.approx(expected, rel=1e-12)


def test_members_that_fail_stop_no_other(shell: Any) -> None:
    done = shell("sweep", "spring.toml", "--vary", "m=1,0,2", "--json")
    assert done.code == 2
    assert done.json["status"] == ["ok", "error", "ok"]
    assert done.json["errors"][0]["member"] == 1
    assert done.json["final"]["mass.f"][1] is None
    assert done.err.startswith("member 1: HB-M163")


def test_tables_are_written_in_three_forms(shell: Any) -> None:
    for name in ("a.csv", "a.npz", "a.json"):
        assert shell("sweep", "ball.toml", "--vary", "e=0.2..0.8:4", "--out", name).code == 0
        assert Path(name).exists()
    with np.load("a.npz", allow_pickle=False) as stored:
        # up from the floor at 1 s with e times 10 m/s, for half a second
        expected = 10.0 * stored["e"] * 0.5 - 5.0 * 0.25
        later = stored["e"] > 0.25  # else it is back on the floor before that
        np.testing.assert_allclose(stored["height"][later], expected[later], rtol=1e-7)


@pytest.mark.parametrize(
    ("words", "code"),
    [
        ([], "HB-X103"),
        (["--vary", "m"], "HB-X103"),
        (["--vary", "m=1..2"], "HB-X103"),
        (["--vary", "m=1..2:1"], "HB-X103"),
        (["--vary", "m=1 kg..2 s:3"], "HB-X103"),
        (["--vary", "m=1,2", "--vary", "m=3,4"], "HB-X103"),
        (["--vary", "m=1,2", "--vary", "k=1,2,3", "--together"], "HB-S114"),
        (["--vary", "mass.C=1,2"], "HB-M107"),
        (["--vary", "m=1,2", "--signals", "mass.x"], "HB-S109"),
        (["--vary", "m=1,2", "--out", "x.txt"], "HB-X102"),
        (["--vary", "m=1,2", "--workers", "0"], "HB-S115"),
    ],
)
def test_what_makes_no_sense_is_refused(shell: Any, words: list[str], code: str) -> None:
    done = shell("sweep", "spring.toml", *words)
    assert done.code in (1, 2) and done.out == ""
    assert done.err.startswith(code)
