"""``hybond bifurcation``: what is printed, written and refused."""

import json
from pathlib import Path

import pytest

from hybond.cli.main import main

BUCK = str(Path(__file__).parents[2] / "examples" / "bifurcation" / "current_mode_buck.toml")
ASKED = ["bifurcation", BUCK, "--vary", "Iref=1..1.4 A:3", "--period", "T", "--of", "L.f"]


def test_windows_are_printed_and_files_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table, plot = tmp_path / "d.csv", tmp_path / "d.png"
    files = ["--out", str(table), "--plot", str(plot)]
    assert main([*ASKED, "--settle", "60", "--keep", "8", *files]) == 0
    said = capsys.readouterr().out
    assert "period 1" in said and "period 2" in said and "border collision" in said
    assert len(table.read_text().splitlines()) == 25
    assert plot.read_bytes().startswith(b"\x89PNG")


def test_one_object_of_json_with_windows_that_were_followed(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main([*ASKED, "--settle", "60", "--keep", "16", "--windows", "1 mA", "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["branches"][0]["periods"] == [1, 1, 2]
    # where the map of the current is as steep down as it is long: tests/sweep/test_bifurcation.py
    assert data["windows"][0]["high"] == pytest.approx(1.2249, abs=2e-3)


def test_a_call_that_makes_no_sense_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*ASKED, "--at", "latch.on"]) == 1
    assert "HB-P132" in capsys.readouterr().err
    assert main([*ASKED, "--direction", "left"]) == 1
    assert "HB-P131" in capsys.readouterr().err
    assert main([*ASKED, "--plot", "d.gif"]) == 1
    assert "HB-X102" in capsys.readouterr().err
