"""The kernel builds, is clean, and is not needed."""

import os
import shlex
import subprocess
import sys
from pathlib import Path

import needs
import pytest

import hybond as hb
from hybond.engine.compiled import compiler
from hybond.kernel import build
from hybond.kernel.library import library

ROOT = Path(__file__).parents[2]
RUNS = """
import hybond as hb, pathlib, sys
for name in ("rope_and_disc", "buck", "friction_oscillator", "bouncing_rod", "end_stops",
             "half_bridge", "cockcroft_walton", "bouncing_ball_air", "diode_bridge"):
    for solver in ("rk45", "radau", "exact"):
        file = pathlib.Path(sys.argv[1]) / f"{name}.toml"
        run = hb.simulate(hb.load(file), on_error="return", solver=solver, kernel=True)
        print(name, run.kernel)
"""
ONE_RUN = """
import hybond as hb, pathlib, sys
file = pathlib.Path(sys.argv[1]) / "rope_and_disc.toml"
print("rope_and_disc", hb.simulate(hb.load(file), kernel=True).kernel)
"""


def python(code: str, *, env: dict[str, str]) -> subprocess.CompletedProcess[str]:
    """Run some code in a process of its own."""
    return subprocess.run(
        [sys.executable, "-c", code, str(ROOT / "examples")],
        env={**os.environ, "PYTHONPATH": str(ROOT / "src"), **env},
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )


@pytest.fixture(scope="module")
def checked(tmp_path_factory) -> tuple[Path, str]:
    """Return the kernel with its sanitizers, and the runtime library of the address sanitizer."""
    command = build.compiler()
    target = tmp_path_factory.mktemp("kernel") / build.NAME
    flags = ("-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
    why = build.compile_into(target, flags=flags)
    if why:
        pytest.skip(f"no sanitizers: {why.splitlines()[-1]}")
    asked = subprocess.run(
        [*command, "-print-file-name=libasan.so"], capture_output=True, text=True, check=False
    )
    runtime = asked.stdout.strip()
    if not Path(runtime).is_file():
        pytest.skip("the address sanitizer has no shared runtime here")
    return target, runtime


@pytest.mark.slow
@pytest.mark.parametrize(
    "compiler", [pytest.param(c, marks=getattr(pytest.mark, c)) for c in ("gcc", "clang")]
)
def test_the_kernel_compiles_without_a_warning(compiler, monkeypatch, tmp_path):
    monkeypatch.setenv("CC", shlex.join(needs.COMPILERS[compiler]))
    flags = ("-Wall", "-Wextra", "-Werror")
    assert build.compile_into(tmp_path / build.NAME, flags=flags) == ""


@pytest.mark.parametrize(
    "compiler", [pytest.param(c, marks=getattr(pytest.mark, c)) for c in needs.COMPILERS]
)
def test_any_compiler_makes_a_kernel_that_runs(compiler, monkeypatch, tmp_path):
    monkeypatch.setenv("CC", shlex.join(needs.COMPILERS[compiler]))
    target = tmp_path / build.NAME
    assert build.compile_into(target) == ""
    code = """
import hybond as hb, sys
run = hb.simulate(hb.load(sys.argv[1] + "/half_bridge.toml"), solver="rk45", kernel=True)
print(run.stats["steps"], run.stats["marched"], run.final["L.p"])
"""
    done = python(code, env={"HYBOND_KERNEL": str(target)})
    assert done.returncode == 0, done.stderr
    steps, marched, flux = done.stdout.split()
    assert float(steps) == float(marched) > 100  # all of them in the kernel
    model = hb.load(ROOT / "examples" / "half_bridge.toml")
    reference = hb.simulate(model, solver="rk45", kernel=False)
    assert float(flux) == pytest.approx(reference.final["L.p"], rel=1e-12)


@pytest.mark.slow
@pytest.mark.strict
def test_runs_are_clean_under_sanitizers(checked):
    target, runtime = checked
    env = {"LD_PRELOAD": runtime, "ASAN_OPTIONS": "detect_leaks=0", "HYBOND_KERNEL": str(target)}
    done = python(RUNS, env=env)
    assert done.returncode == 0, done.stderr[-3000:]
    assert "runtime error" not in done.stderr
    assert done.stdout.count(" steps") == 27 and "not used" not in done.stdout
    assert done.stdout.count(" events") >= 10


@pytest.mark.slow
@pytest.mark.strict
def test_the_sanitizers_would_have_seen_a_wrong_index(checked, tmp_path):
    # what cannot fail proves nothing
    target, runtime = checked
    wrong = """
import ctypes, os, numpy as np
kernel = ctypes.CDLL(os.environ["HYBOND_KERNEL"])
code, v = np.array([2, 1 << 24, 0], dtype=np.int32), np.zeros(4)
kernel.hb_evaluate(*(a.ctypes.data_as(ctypes.c_void_p) for a in (code, v, v)))
"""
    env = {"LD_PRELOAD": runtime, "ASAN_OPTIONS": "detect_leaks=0", "HYBOND_KERNEL": str(target)}
    assert python(wrong, env=env).returncode != 0


def test_without_a_kernel_the_reference_runs_and_says_so():
    done = python(ONE_RUN, env={"HYBOND_KERNEL": "off"})
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[0] == "rope_and_disc not used: HYBOND_KERNEL is off"


@pytest.mark.slow
@pytest.mark.c
def test_a_kernel_from_other_sources_is_not_used(kernel, tmp_path):
    old = tmp_path / build.NAME
    flags = ("-O0", "-UHYBOND_SOURCE", '-DHYBOND_SOURCE="old"')
    assert build.compile_into(old, flags=flags) == ""
    done = python(ONE_RUN, env={"HYBOND_KERNEL": str(old)})
    assert "built from other sources" in done.stdout


def test_a_machine_without_a_compiler_builds_no_kernel(monkeypatch, tmp_path):
    monkeypatch.setenv("HYBOND_NO_COMPILER", "1")
    assert build.compile_into(tmp_path / build.NAME) == "there is no C compiler"
    assert not compiler.wants_zig()
    monkeypatch.delenv("HYBOND_NO_COMPILER")
    monkeypatch.setenv("CC", "no-such-compiler")
    assert "no-such-compiler" in build.compile_into(tmp_path / build.NAME)
    monkeypatch.delenv("CC")
    monkeypatch.setattr(compiler.shutil, "which", lambda name: None)
    monkeypatch.setattr(compiler.importlib.util, "find_spec", lambda name: None)
    assert compiler.wants_zig()


def test_a_result_says_how_much_the_kernel_did(kernel):
    assert not isinstance(library(), str)
    run = hb.simulate(hb.load(ROOT / "examples" / "rope_and_disc.toml"))
    steps = int(run.stats["steps"])
    assert run.kernel == f"{steps} of {steps} steps, 0 of 1 events"
    assert run.stats["marched"] == steps
