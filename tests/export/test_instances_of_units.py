"""Any number of units in one process: apart from each other, and without a trace when they end."""

from __future__ import annotations

import shlex
import subprocess
import threading
import zipfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import needs
import pytest

import hybond as hb

fmpy = pytest.importorskip("fmpy")
pytestmark = pytest.mark.c
EXAMPLES = Path(__file__).parents[2] / "examples"
HARNESS = Path(__file__).with_name("memory.c")
LOADING = threading.Lock()
"""FMPy changes the working directory of the process while it loads a library."""
STEPS = 40
RUNS: Sequence[dict[str, float]] = ({}, {"g": 7.0, "eps": 0.7}, {"eps": 0.5})


@pytest.fixture(scope="module", params=["2.0", "3.0"])
def unit(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> tuple[str, Any, str]:
    """A ball with impacts: the folder of the unit, what it says of itself, and the version."""
    folder = tmp_path_factory.mktemp("instances")
    path = folder / "ball.fmu"
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("CC", shlex.join(needs.QUICK or []))
        model = hb.load(EXAMPLES / "bouncing_ball_newton.toml")
        hb.export(model, to="fmu", path=path, fmi=request.param)
    place = fmpy.extract(str(path), unzipdir=str(folder / "unit"))
    return place, fmpy.read_model_description(str(path)), request.param


class Instance:
    """A unit that is stepped, and what it shows after each step."""

    def __init__(self, unit: tuple[str, Any, str], values: dict[str, float]) -> None:
        place, about, self.version = unit
        with LOADING:
            self.fmu = fmpy.instantiate_fmu(place, about, fmi_type="CoSimulation")
        reference = {v.name: v.valueReference for v in about.modelVariables}
        self.shown = [v.valueReference for v in about.modelVariables if v.causality != "parameter"]
        if self.version == "3.0":
            self.shown = [r for r in self.shown if r < len(about.modelVariables)]
        self.seen: list[list[float]] = []
        self.t = 0.0
        for name, value in values.items():
            self.put([reference[name]], [value])
        if self.version == "2.0":
            self.fmu.setupExperiment(startTime=0.0)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def put(self, references: list[int], values: list[float]) -> None:
        (self.fmu.setReal if self.version == "2.0" else self.fmu.setFloat64)(references, values)

    def step(self) -> None:
        self.fmu.doStep(currentCommunicationPoint=self.t, communicationStepSize=0.05)
        self.t += 0.05
        get = self.fmu.getReal if self.version == "2.0" else self.fmu.getFloat64
        self.seen.append(list(get(self.shown)))

    def end(self) -> list[list[float]]:
        self.fmu.terminate()
        self.fmu.freeInstance()
        return self.seen


def alone(unit: tuple[str, Any, str], values: dict[str, float]) -> list[list[float]]:
    one = Instance(unit, values)
    for _ in range(STEPS):
        one.step()
    return one.end()


def test_instances_in_turn_are_as_each_alone(unit: tuple[str, Any, str]) -> None:
    """To the bit, whichever was made, set and stepped first."""
    expected = [alone(unit, values) for values in RUNS]
    assert expected[0] != expected[1] != expected[2]
    together = [Instance(unit, values) for values in RUNS]
    for _ in range(STEPS):
        for one in together:
            one.step()
    assert [one.end() for one in together] == expected


def test_instances_in_threads_are_as_each_alone(unit: tuple[str, Any, str]) -> None:
    expected = [alone(unit, values) for values in RUNS]
    found: dict[int, list[list[list[float]]]] = {}

    def work(k: int) -> None:
        found[k] = [alone(unit, RUNS[k]) for _ in range(5)]

    threads = [threading.Thread(target=work, args=(k,)) for k in range(len(RUNS))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [found[k] for k in range(len(RUNS))] == [[run] * 5 for run in expected]


def test_a_unit_says_that_there_may_be_many(unit: tuple[str, Any, str]) -> None:
    about = unit[1]
    assert not about.coSimulation.canBeInstantiatedOnlyOncePerProcess
    assert not about.modelExchange.canBeInstantiatedOnlyOncePerProcess


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="no /proc")
def test_instances_leave_no_memory_behind(unit: tuple[str, Any, str]) -> None:
    def resident() -> int:
        return int(Path("/proc/self/statm").read_text().split()[1]) * 4096

    def live() -> None:
        one = Instance(unit, RUNS[1])
        one.step()
        one.fmu.reset()
        one.end()

    for _ in range(100):
        live()
    before = resident()
    for _ in range(1000):
        live()
    # an instance takes 160 kB
    assert resident() - before < 8e6


@pytest.mark.slow
@pytest.mark.strict
@pytest.mark.parametrize("fmi", ["2.0", "3.0"])
def test_the_end_of_memory_is_told(fmi: str, tmp_path: Path) -> None:
    """Wherever it comes; another unit runs on; and all is given back, as the sanitizers see it."""
    path = tmp_path / "ball.fmu"
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("CC", shlex.join(needs.QUICK or []))
        model = hb.load(EXAMPLES / "bouncing_ball_newton.toml")
        hb.export(model, to="fmu", path=path, fmi=fmi)
    with zipfile.ZipFile(path) as archive:
        (name,) = (n for n in archive.namelist() if n.endswith(".c"))
        (tmp_path / "unit.c").write_bytes(archive.read(name))
    flags = ["-std=c99", "-O1", "-Wall", "-Wextra", "-Werror", *needs.sanitizers()]
    flags += [f"-DFMI_VERSION={fmi[0]}", f'-DUNIT_FILE="{tmp_path / "unit.c"}"']
    program = tmp_path / "memory"
    subprocess.run([*(needs.STRICT or []), *flags, "-o", program, HARNESS, "-lm"], check=True)
    done = subprocess.run([program], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, ""), done.stdout
