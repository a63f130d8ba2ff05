"""Killed sweeps, full disks, damaged parts, edited models: the table of an undisturbed run.

What is held against each other are files, byte for byte.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import hybond as hb
from hybond.cli.main import main
from hybond.sweep.folder import Folder
from hybond.sweep.part import Part

ROOT = Path(__file__).parents[2]
BALL = """\
hybond = 1
domain = "translational"
[parameters]
e = 0.9
[elements]
weight = { Se = "-10 N" }
ball = { I = "1 kg" }
floor = { Sf = "-e*pre(v.f)" }
v = { junction = 1 }
contact = { junction = 0 }
[graph]
bonds = ["weight -> v -> ball", "contact -> v", "floor -> contact"]
[signals]
height = { integral = "v.f", start = "5 m" }
[machines.impact]
states = { away = [], hits = ["contact"] }
start = "away"
rules = ["away -> hits when height <= 0 and v.f < 0", "hits -> away when pre(v.f) >= 0"]
[experiment]
until = "3 s"
"""
MANY = 3000
SWEEP = (
    *(
        "sweep",
        "ball.toml",
        "--vary",
        "height.start=lin(4,6,3)",
        "--vary",
        "e=lin(-0.004,0.95,1000)",
    ),
    *("--collect", "final(height), count(events), first(impact.hits), sequence"),
)


def program(*words: str, **options: Any) -> subprocess.Popen[str]:
    """Start the command line in a process of its own, which leaves no byte code behind.

    Where files may not be long, Python writes that too, and does not find it cut short.
    """
    return subprocess.Popen(
        [sys.executable, "-m", "hybond", *words],
        env={**os.environ, "PYTHONPATH": str(ROOT / "src"), "PYTHONDONTWRITEBYTECODE": "1"},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        **options,
    )


def when(parts: Path, many: int, process: subprocess.Popen[str]) -> int:
    """Wait until so many parts are there; return how many there are."""
    end = time.monotonic() + 60.0
    while time.monotonic() < end:
        there = len(list(parts.glob("[0-9]*.npz")))
        if there >= many or process.poll() is not None:
            return there
        time.sleep(0.002)
    raise AssertionError("nothing was written")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "ball.toml").write_text(BALL, encoding="utf-8")
    return tmp_path


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="needs SIGKILL")
def test_a_sweep_that_is_killed_goes_on_where_it_was(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    running = program(*SWEEP, "--out", "killed", "--part", "50")
    there = when(folder / "killed" / "parts", 20, running)
    running.send_signal(signal.SIGKILL)
    running.wait()
    assert 20 <= there < MANY // 50
    assert not (folder / "killed" / "table.csv").exists()
    code = main([*SWEEP, "--out", "killed"])
    said = capsys.readouterr().out
    assert int(said.split(" members were there")[0].rpartition("\n")[2]) >= 20 * 50
    assert main([*SWEEP, "--out", "whole", "--workers", "1"]) == code == 3  # e < 0 fails
    killed, whole = (folder / name / "table.csv" for name in ("killed", "whole"))
    assert killed.read_bytes() == whole.read_bytes()
    assert whole.read_bytes().count(b"\n") == MANY + 1


def small(out: Path, model: hb.Model | None = None, **options: Any) -> Any:
    plan = hb.Plan({"e": "0.5:0.9:0.01"})
    asked = {"collect": "final(height), sequence", "part": 8, **options}
    return hb.sweep(model or hb.loads(BALL), plan, out=out, **asked)


def test_ctrl_c_keeps_what_is_done(folder: Path) -> None:
    def press(done: int, _: int) -> None:
        if done >= 16:
            raise KeyboardInterrupt

    table = small(folder / "s", progress=press)
    assert table.interrupted and 8 <= len(table) < 41
    assert not (folder / "s" / "table.csv").exists()
    again = small(folder / "s")
    assert again.how.startswith(f"{len(table)} members were there")
    small(folder / "whole")
    one, other = (folder / name / "table.csv" for name in ("s", "whole"))
    assert one.read_bytes() == other.read_bytes()


def test_a_damaged_part_is_run_again(folder: Path) -> None:
    small(folder / "s")
    before = (folder / "s" / "table.csv").read_bytes()
    parts = sorted((folder / "s" / "parts").iterdir())
    data = parts[1].read_bytes()
    parts[1].write_bytes(data[: len(data) // 2])
    at = parts[2].read_bytes().index(b"t_end.npy") + 200
    changed = bytearray(parts[2].read_bytes())
    changed[at] ^= 1
    parts[2].write_bytes(changed)
    table = small(folder / "s")
    assert [note.split(":")[0] for note in table.notes] == [
        "the part of members 8 to 15 is damaged",
        "the part of members 16 to 23 is damaged",
    ]
    assert (folder / "s" / "table.csv").read_bytes() == before


def test_a_part_that_lacks_a_column_is_run_again(folder: Path) -> None:
    """An archive that is whole, by somebody who edited what it says of its columns."""
    small(folder / "s")
    before = (folder / "s" / "table.csv").read_bytes()
    path = sorted((folder / "s" / "parts").iterdir())[1]
    key = json.loads((folder / "s" / "sweep.json").read_text())["key"]
    part = Part.from_bytes(path.read_bytes(), key)
    part.columns.pop("final(height)")
    path.write_bytes(part.to_bytes(key))
    table = small(folder / "s")
    assert table.notes == ("the part of members 8 to 15 is damaged: run again",)
    assert (folder / "s" / "table.csv").read_bytes() == before


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"model": hb.loads(BALL.replace("-10 N", "-9 N"))}, "'weight = { Se = \"-10 N\" }' is"),
        ({"collect": "final(height)"}, "other things are collected"),
        ({"until": 2.0}, "it ends at another time"),
        ({"rtol": 1e-6}, "the options are others"),
        ({"parameters": {"ball.I": 2.0}}, "other parameters are set"),
    ],
)
def test_a_folder_of_another_sweep_is_left_alone(
    folder: Path, options: dict[str, Any], said: str
) -> None:
    small(folder / "s")
    before = {p: p.read_bytes() for p in (folder / "s").rglob("*") if p.is_file()}
    with pytest.raises(hb.UsageError) as refused:
        small(folder / "s", **options)
    assert refused.value.code == "HB-P107" and said in refused.value.why
    assert {p: p.read_bytes() for p in (folder / "s").rglob("*") if p.is_file()} == before


def test_two_sweeps_in_one_folder(folder: Path) -> None:
    held = Folder(folder / "s")
    with pytest.raises(hb.UsageError) as refused:
        small(folder / "s")
    assert refused.value.code == "HB-P105"
    held.close()
    assert len(small(folder / "s")) == 41


def test_a_place_that_is_no_folder(folder: Path) -> None:
    (folder / "s").write_text("mine")
    with pytest.raises(hb.UsageError) as refused:
        small(folder / "s")
    assert refused.value.code == "HB-P106"
    assert (folder / "s").read_text() == "mine"


@pytest.mark.skipif(os.name == "nt", reason="needs a limit to the size of files")
def test_a_full_disk_loses_nothing(folder: Path) -> None:
    """A process that may write files of 10 kB only meets the end of the disk at its first part."""
    import resource

    def press(done: int, _: int) -> None:
        if done >= 16:
            raise KeyboardInterrupt

    def little() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (10_000, 10_000))

    model, collect = hb.load("ball.toml"), "curve(height, 200)"
    small(folder / "s", model, collect=collect, progress=press)
    parts = {p: p.read_bytes() for p in (folder / "s" / "parts").iterdir()}
    assert parts
    words = ("sweep", "ball.toml", "--vary", "e=0.5:0.9:0.01", "--collect", collect, "--out", "s")
    full = program(*words, preexec_fn=little)
    _, said = full.communicate()
    assert full.returncode == 1 and said.startswith("HB-P106") and "the disk is full" in said
    assert {p: p.read_bytes() for p in (folder / "s" / "parts").iterdir()} == parts
    again = small(folder / "s", model, collect=collect)
    whole = small(folder / "whole", model, collect=collect)
    np.testing.assert_array_equal(again[collect], whole[collect])


def test_files_of_others_stay_where_they_are(folder: Path) -> None:
    place = folder / "s"
    small(place, progress=lambda done, _: (_ for _ in ()).throw(KeyboardInterrupt))
    kept = [place / ".git", place / "parts" / ".keep", place / ".0123abcd.mine"]
    left = [place / ".0123abcd.table.csv", place / "parts" / ".0123abcd.000-008.npz"]
    for file in (*kept, *left):
        file.write_text("x")
    small(place)
    assert all(file.exists() for file in kept) and not any(file.exists() for file in left)
