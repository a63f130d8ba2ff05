"""Folders that others own, file systems that are full or read-only: refused, and nothing is lost.

They are real ones: another user, and a file system in memory that only the test sees.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import hybond as hb

ROOT = Path(__file__).parents[2]
NOBODY = 65534
MODEL = """\
hybond = 1
domain = "electrical"
[elements]
c = { C = "1 mF", e = "10 V" }
r = { R = "1 kohm" }
n = { junction = 0 }
[graph]
bonds = ["n -> c", "n -> r"]
[experiment]
until = "1 s"
"""
WORDS = ["sweep", "rc.toml", "--vary", "r.R=lin(500, 2000, 48)", "--collect", "curve(c.e, 200)"]
WORDS += ["--part", "8", "--out"]
ENV = {**os.environ, "PYTHONPATH": str(ROOT / "src"), "HOME": "/"}

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="needs users and mounts of Linux")


def as_another(*words: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    """Run a command as somebody who may write nothing of ours."""
    command = [sys.executable, *words]
    if os.geteuid() == 0:
        if shutil.which("setpriv") is None:
            pytest.skip("no setpriv here to be another user")
        user = [f"--reuid={NOBODY}", f"--regid={NOBODY}", "--clear-groups"]
        command = ["setpriv", *user, *command]
    return subprocess.run(command, cwd=cwd, env=ENV, capture_output=True, text=True)


@pytest.fixture
def place(tmp_path: Path) -> Path:
    (tmp_path / "rc.toml").write_text(MODEL, encoding="utf-8")
    for folder in (tmp_path, *tmp_path.parents[:2]):
        if folder.stat().st_uid == os.geteuid():
            folder.chmod(0o755)
    if as_another("-c", "import hybond", cwd=tmp_path).returncode:
        pytest.skip("another user cannot run this Python")
    return tmp_path


def files(folder: Path) -> dict[str, bytes]:
    """Return what lies in a folder."""
    return {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


@pytest.mark.slow
def test_a_folder_of_somebody_else(place: Path) -> None:
    before = files(place)
    if os.geteuid() != 0:
        place.chmod(0o555)
    new = as_another("-m", "hybond", *WORDS, "new", cwd=place)
    place.chmod(0o755)
    assert new.returncode == 1 and new.stderr.startswith("HB-P106 at new: Permission denied")
    assert "yours to write" in new.stderr and files(place) == before

    def stop(done: int, _: int) -> None:
        if done >= 16:
            raise KeyboardInterrupt

    model = hb.load(place / "rc.toml")
    asked = {"collect": "curve(c.e, 200)", "part": 8, "workers": 1}
    plan = {"r.R": "lin(500, 2000, 48)"}
    assert len(hb.sweep(model, plan, out=place / "s", progress=stop, **asked)) < 48
    before = files(place / "s")
    mine = [p for p in (place / "s", *(place / "s").rglob("*")) if os.geteuid() != 0]
    for path in mine:
        path.chmod(0o555 if path.is_dir() else 0o444)
    begun = as_another("-m", "hybond", *WORDS, "s", cwd=place)
    for path in mine:
        path.chmod(0o755)
    assert begun.returncode == 1 and begun.stderr.startswith("HB-P106 at s/lock: Permission")
    assert files(place / "s") == before
    hb.sweep(model, plan, out=place / "s", **asked)
    hb.sweep(model, plan, out=place / "whole", **asked)
    assert (place / "s/table.csv").read_bytes() == (place / "whole/table.csv").read_bytes()


def test_where_even_root_makes_no_folder(tmp_path: Path) -> None:
    (tmp_path / "rc.toml").write_text(MODEL, encoding="utf-8")
    with pytest.raises(hb.UsageError) as refused:
        hb.sweep(
            *(hb.load(tmp_path / "rc.toml"), {"r.R": "500, 1000"}),
            **{"collect": "final(c.e)", "out": "/proc/a_sweep"},
        )
    assert refused.value.code == "HB-P106" and "/proc/a_sweep" in refused.value.where


SCRIPT = """
set -u
mount -t tmpfs -o size=72k none disk
cd disk
"$0" -m hybond {words} s > /dev/null 2> ../full; echo $? >> ../full
ls s/parts > ../parts; ls -A s > ../beside; sha256sum s/parts/* > ../sums
mount -o remount,ro,size=72k none .
"$0" -m hybond {words} s > /dev/null 2> ../still; echo $? >> ../still
mount -o remount,rw,size=8m none .
sha256sum -c ../sums > ../checked || echo changed >> ../checked
"$0" -m hybond {words} s > /dev/null 2> ../again; echo $? >> ../again
cp -r s ../s
"""


@pytest.mark.slow
def test_a_disk_that_is_full_then_read_only_then_large_enough(tmp_path: Path) -> None:
    if shutil.which("unshare") is None:
        pytest.skip("no unshare here to mount a small disk")
    trial = ["unshare", "-rm", "sh", "-c", "mount -t tmpfs -o size=72k none ."]
    if subprocess.run(trial, cwd=tmp_path, capture_output=True).returncode:
        pytest.skip("a file system of one's own may not be mounted here")
    (tmp_path / "disk").mkdir()
    (tmp_path / "rc.toml").write_text(MODEL, encoding="utf-8")
    words = " ".join(f"'{word}'" for word in WORDS).replace("rc.toml", "../rc.toml")
    script = SCRIPT.replace("{words}", words)
    subprocess.run(["unshare", "-rm", "sh", "-c", script, sys.executable], cwd=tmp_path, env=ENV)
    read = {n: (tmp_path / n).read_text() for n in ("full", "still", "again", "parts", "checked")}
    assert read["full"].startswith("HB-P106 at s/parts/") and "the disk is full" in read["full"]
    assert read["full"].splitlines()[-1] == "1"
    assert 1 <= len(read["parts"].split()) < 6 and "." not in read["parts"][:1]
    assert read["still"].startswith("HB-P106 at s/lock: Read-only file system")
    assert "changed" not in read["checked"] and read["again"].splitlines()[-1] == "0"
    model = hb.load(tmp_path / "rc.toml")
    plan = {"r.R": "lin(500, 2000, 48)"}
    hb.sweep(model, plan, collect="curve(c.e, 200)", part=8, out=tmp_path / "whole")
    same = [n for n in files(tmp_path / "whole") if not n.startswith("sweep.json")]
    assert {n: files(tmp_path / "s")[n] for n in same} == {
        n: files(tmp_path / "whole")[n] for n in same
    }
