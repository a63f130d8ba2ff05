"""The library by any compiler: no warning, and it runs."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import needs
import pytest

import hybond
from hybond.engine.compiled.build import compile_into
from hybond.engine.compiled.fresh import NAME, stamps
from hybond.engine.compiled.native import columns, library
from hybond.engine.compiled.sources import portable_paths

pytestmark = pytest.mark.usefixtures("native")

STRICT = ("-O0", "-Wall", "-Wextra", "-pedantic", "-Werror")
RUN = """
import hybond as hb
from hybond.engine.compiled.native import NativeModel, NativeRun
from hybond.engine.tables import tables_of
for name in ("boost", "cam_follower", "planar_puck"):
    graph = hb.load(f"{EXAMPLES}/{name}.toml").flatten()
    run = NativeRun(NativeModel(tables_of(graph)))
    instants = sum(len(rows.instant_time) for rows in run.slices())
    print(name, run.status, instants, *run.y)
"""
EXAMPLES = Path(__file__).parents[2] / "examples"


def said(library: str) -> list[list[str]]:
    """Return what runs by a library say, in a process of their own."""
    done = subprocess.run(
        [sys.executable, "-c", f"EXAMPLES = {str(EXAMPLES)!r}\n{RUN}"],
        env={**os.environ, "HYBOND_ENGINE": library},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return [line.split() for line in done.stdout.splitlines()]


@pytest.mark.slow
@pytest.mark.parametrize(
    "made_by", [pytest.param(c, marks=getattr(pytest.mark, c)) for c in needs.COMPILERS]
)
def test_any_compiler_makes_a_library_that_runs(
    made_by: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """gcc and clang without a warning; runs are those of the library that is installed."""
    command = needs.COMPILERS[made_by]
    assert command is not None
    monkeypatch.setenv("CC", " ".join(command))
    flags = STRICT if made_by in ("gcc", "clang") else ()
    assert compile_into(tmp_path / NAME, flags=flags) == ""
    for one, other in zip(said(str(tmp_path / NAME)), said(""), strict=True):
        assert one[:3] == other[:3]
        assert [float(x) for x in one[3:]] == pytest.approx([float(x) for x in other[3:]], rel=1e-9)


def test_a_gcc_that_cannot_work_in_parts_is_asked_for_all_at_once(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """An old one, or one whose linker lacks the plugin; what is asked is kept, nothing compiled."""
    gcc, asked = tmp_path / "gcc", tmp_path / "asked"
    gcc.write_text(
        f'#!/bin/sh\necho "$*" >> {asked}\n'
        'case "$*" in *-flto*) echo "no plugin" >&2; exit 1;; esac\n'
        'while [ "$1" != -o ]; do shift; done; : > "$2"\n'
    )
    gcc.chmod(0o755)
    monkeypatch.setenv("CC", str(gcc))
    monkeypatch.setattr("hybond.engine.compiled.build.library_text", str)
    assert compile_into(tmp_path / NAME) == ""
    calls = asked.read_text().splitlines()
    assert ["-flto=auto" in call for call in calls] == [True, False]


def test_a_library_of_other_sources_is_not_used(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = (
        "from hybond.engine.compiled import native\n"
        "native.is_of_these_sources = lambda made: made == 'of others'\n"
        "native.library()"
    )
    done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, check=False)
    assert "was built from other sources" in done.stderr


def test_the_columns_of_a_model_are_those_of_its_tables() -> None:
    found = columns()
    assert len(found) > 200
    assert found["until"] == "float" and found["code"] == "Ints" and found["row_value"] == "Floats"
    assert library().hybond_model_size() > 8 * 150


def test_every_file_that_is_printed_is_looked_at() -> None:
    """In rooms within rooms, too."""
    seen = {line.rsplit(" ", 2)[0] for line in stamps().splitlines()}
    assert {str(path) for path in portable_paths()} <= seen


@pytest.mark.slow
def test_sources_that_were_changed_are_seen(tmp_path: Path) -> None:
    """A copy of hybond with its library, in which bytecode is kept; one letter is changed in it."""
    package = Path(hybond.__file__).parent
    shutil.copytree(package, tmp_path / "hybond", ignore=shutil.ignore_patterns("page", "*.pyc"))
    env = {k: v for k, v in os.environ.items() if not k.startswith("PYTHON")}
    env |= {"PYTHONPATH": str(tmp_path), "PYTHONPYCACHEPREFIX": str(tmp_path / "kept")}
    text = (
        "import sys\n"
        "from hybond.engine.compiled import native\n"
        "native.library()\n"
        "print('hybond.engine.compiled.sources' in sys.modules)"
    )

    def begun() -> tuple[str, str]:
        run = [sys.executable, "-c", text]
        done = subprocess.run(run, env=env, capture_output=True, text=True, check=False)
        return done.stdout.strip(), done.stderr

    assert begun() == ("True", "")
    assert begun() == ("False", ""), "nothing was changed, and all is read again"
    source = tmp_path / "hybond/engine/run/motion.py"
    whole = source.read_text(encoding="utf-8")
    source.write_text(whole.replace("a", "b", 1), encoding="utf-8")
    assert "was built from other sources" in begun()[1]
    source.write_text(whole, encoding="utf-8")
    (tmp_path / "hybond/engine/run/another.py").write_text("", encoding="utf-8")
    assert "was built from other sources" in begun()[1]
