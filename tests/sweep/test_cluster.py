"""Sweeps on other machines: executors, and a scheduler of Dask with workers that are killed."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import hybond as hb
from hybond.cli.main import main
from hybond.sweep.cluster import run_part

ROOT = Path(__file__).parents[2]
MODEL = """\
hybond = 1
domain = "electrical"
[parameters]
r = "1 kohm"
[elements]
c = { C = "1 mF", e = "10 V" }
r1 = { R = "r" }
node = { junction = 0 }
[graph]
bonds = ["node -> c", "node -> r1"]
[experiment]
until = "1 s"
"""
COLLECT = "final(c.e), mean(c.e)"


class Flaky(Executor):
    """Runs what it is given at once; some of it dies on the way."""

    def __init__(self, dies: Any) -> None:
        self.given: list[tuple[int, int]] = []
        self._dies = dies

    def submit(self, fn: Any, /, *args: Any, **_: Any) -> Future[Any]:  # type: ignore[override]
        future: Future[Any] = Future()
        error = self._dies(args[-2], self.given.count(args[-2:]))
        self.given.append(args[-2:])
        try:
            if error is not None:
                raise error
            future.set_result(fn(*args))
        except Exception as failed:
            future.set_exception(failed)
        return future


def swept(out: Path, **options: Any) -> Any:
    plan = {"r": "100:1900:100", "c.C": "1 mF, 2 mF"}
    return hb.sweep(hb.loads(MODEL), plan, collect=COLLECT, out=out, part=5, **options)


def test_an_executor_gives_the_same_table(tmp_path: Path) -> None:
    swept(tmp_path / "here", workers=1)
    with ThreadPoolExecutor(2) as pool:
        table = swept(tmp_path / "there", executor=pool)
    assert table.how == "38 members by ThreadPoolExecutor"
    flaky = Flaky(lambda first, tries: OSError("lost") if first == 10 and tries < 2 else None)
    again = swept(tmp_path / "again", executor=flaky)
    assert again.how.endswith("2 parts again") and flaky.given.count((10, 15)) == 3
    assert "members 10 to 14 are run again: OSError: lost" in again.notes
    tables = [(tmp_path / n / "table.csv").read_bytes() for n in ("here", "there", "again")]
    assert tables[0] == tables[1] == tables[2]


def test_who_dies_again_and_again_ends_the_sweep_and_loses_nothing(tmp_path: Path) -> None:
    for error in (OSError("lost"), BrokenProcessPool("all died")):
        dies = Flaky(lambda first, _, error=error: error if first >= 20 else None)
        with pytest.raises(hb.NumericsError) as refused:
            swept(tmp_path / "s", executor=dies)
        assert refused.value.code == "HB-P111" and str(error) in refused.value.why
    assert swept(tmp_path / "s").how.startswith("20 members were there; 18 members")


@pytest.mark.slow
def test_full_runs_come_back_as_files(tmp_path: Path) -> None:
    """Those of a worker that died are there once, too; each is the discharge of its member."""
    xarray = pytest.importorskip("xarray", reason="xarray is not installed")
    flaky = Flaky(lambda first, tries: OSError("lost") if first == 2 and tries < 1 else None)
    plan = {"r": "500, 1000, 2000", "c.C": "1 mF, 2 mF"}
    asked = {"collect": "final(c.e)", "part": 2, "runs": "netcdf", "out": tmp_path / "s"}
    table = hb.sweep(hb.loads(MODEL), plan, executor=flaky, **asked)
    assert table.how == "6 members by Flaky, 1 parts again"
    files = sorted((tmp_path / "s/runs").iterdir())
    assert [f.name for f in files] == [f"{k:09}.nc" for k in range(6)]
    for k, file in enumerate(files):
        with xarray.open_dataset(file) as run:
            t, e = run["t"].values, run["c.e"].values
            fall = t / (table["r"][k] * table["c.C"][k])
            np.testing.assert_allclose(e, 10.0 * np.exp(-fall), rtol=1e-7)
            assert t[-1] == 1.0 and run.attrs["member"] == k


def test_another_version_is_refused() -> None:
    with pytest.raises(hb.UsageError) as refused:
        run_part({"hybond": "0.0.1"}, "key", 0, 1)
    assert refused.value.code == "HB-P112"


@pytest.mark.parametrize("executor", ["tcp://127.0.0.1:9", 3])
def test_a_cluster_that_is_not_there(
    executor: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("distributed", reason="Dask's distributed is not installed")
    monkeypatch.setattr("hybond.sweep.cluster.PATIENCE", 0.2)
    with pytest.raises(hb.UsageError) as refused:
        swept(tmp_path / "s", executor=executor)
    assert refused.value.code == "HB-P110"


class Cluster:
    """A scheduler and two workers, each a process of its own, on this machine only."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.processes: list[subprocess.Popen[Any]] = []
        scheduler = self.start("scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard")
        log = folder / "scheduler.log"
        self.address = self.wait(log, r"Scheduler at:\s+(tcp://127\.0\.0\.1:\d+)", scheduler)
        self.workers = [self.worker(f"w{k}") for k in range(2)]

    def start(self, *words: str, name: str = "scheduler") -> subprocess.Popen[Any]:
        with (self.folder / f"{name}.log").open("w") as log:
            found = subprocess.Popen(
                [sys.executable, "-m", "dask", *words],
                cwd=self.folder,
                stdout=log,
                stderr=log,
                env={**os.environ, "PYTHONPATH": str(ROOT / "src")},
            )
        self.processes.append(found)
        return found

    def worker(self, name: str) -> subprocess.Popen[Any]:
        words = ("--host", "127.0.0.1", "--nthreads", "1", "--no-nanny", "--no-dashboard")
        return self.start("worker", self.address, *words, name=name)

    def wait(self, log: Path, pattern: str, process: subprocess.Popen[Any]) -> str:
        end = time.monotonic() + 60.0
        while time.monotonic() < end and process.poll() is None:
            found = re.search(pattern, log.read_text())
            if found:
                return found[1]
            time.sleep(0.05)
        raise AssertionError(log.read_text())

    def close(self) -> None:
        for process in self.processes:
            process.kill()
            process.wait()


def wait_for(parts: Path, many: int, process: subprocess.Popen[Any]) -> int:
    end = time.monotonic() + 120.0
    while time.monotonic() < end and process.poll() is None:
        there = len(list(parts.glob("[0-9]*.npz")))
        if there >= many:
            return there
        time.sleep(0.01)
    raise AssertionError("the sweep has ended, or nothing was written")


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="needs SIGKILL")
def test_a_worker_and_the_client_are_killed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("distributed", reason="Dask's distributed is not installed")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rc.toml").write_text(MODEL, encoding="utf-8")
    words = ("sweep", "rc.toml", "--vary", "r=100:2099:1", "--collect", COLLECT)
    cluster = Cluster(tmp_path)
    try:
        options = ("--out", "killed", "--part", "20", "--cluster", cluster.address)
        client = subprocess.Popen(
            [sys.executable, "-m", "hybond", *words, *options],
            env={**os.environ, "PYTHONPATH": str(ROOT / "src")},
        )
        parts = tmp_path / "killed" / "parts"
        wait_for(parts, 6, client)
        cluster.workers[0].send_signal(signal.SIGKILL)
        there = wait_for(parts, 14, client)
        told = tmp_path / "killed" / "notes.txt"
        while not told.exists() and client.poll() is None:
            time.sleep(0.01)
        assert re.fullmatch(r"worker tcp://127\.0\.0\.1:\d+ is gone; .*\n", told.read_text())
        there = wait_for(parts, there, client)
        client.send_signal(signal.SIGKILL)
        client.wait()
        assert there < 100 and not (tmp_path / "killed" / "table.csv").exists()
        assert main([*words, *options]) == 0
    finally:
        cluster.close()
    assert "members were there" in capsys.readouterr().out
    assert main([*words, "--out", "whole"]) == 0
    killed, whole = (tmp_path / name / "table.csv" for name in ("killed", "whole"))
    assert killed.read_bytes() == whole.read_bytes()
    assert whole.read_bytes().count(b"\n") == 2001
