"""hybond as a process: Ctrl-C, closed pipes, what is imported."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

import hybond

SOURCE = Path(hybond.__file__).parents[1]
ENV = {**os.environ, "PYTHONPATH": str(SOURCE)}
# A test runner in the background of a shell ignores Ctrl-C, and so would its children.
HEAR = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)"
READY = "sys.stderr.write('ready\\n'); sys.stderr.flush()"
START = f"{HEAR}; import sys; from hybond.cli.main import main; {READY}; sys.exit(main())"


def start(folder: Path, *words: str) -> "subprocess.Popen[str]":
    return subprocess.Popen(
        [sys.executable, "-c", START, *words],
        cwd=folder,
        env=ENV,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        encoding="utf-8",
    )


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="Windows has no SIGINT for another process")
def test_ctrl_c_in_mid_run_keeps_what_there_is(shell: Any) -> None:
    words = ["--until", "1e7", "--at", "0.1,9e6", "--signals", "cap.e"]
    files = ["--out", "part.csv", "--plot", "part.png"]
    process = start(shell.folder, "run", "charger.toml", "--json", *words, *files)
    assert process.stderr is not None and process.stderr.readline() == "ready\n"
    time.sleep(1.0)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=120)
    assert process.returncode == 130, err
    assert "Traceback" not in err
    run = json.loads(out)
    assert run["status"] == "interrupted"
    if run["t_end"] > 0.1:  # a slow machine may have stopped before the first step
        assert run["samples"]["cap.e"][0] == pytest.approx(3.032, rel=1e-3)
        assert run["samples"]["cap.e"][1] is None
        assert (shell.folder / "part.csv").stat().st_size > 100
        assert (shell.folder / "part.png").stat().st_size > 1000


@pytest.mark.slow
def test_a_reader_that_has_seen_enough_is_no_error(shell: Any) -> None:
    process = start(shell.folder, "run", "charger.toml", "--until", "30", "--json")
    assert process.stdout is not None and process.stderr is not None
    process.stdout.close()
    assert process.stderr.read() == "ready\n"
    assert process.wait(timeout=120) == 0


@pytest.mark.slow
def test_a_run_imports_nothing_that_it_does_not_need(shell: Any) -> None:
    heavy = "{'typer', 'rich', 'matplotlib', 'pandas', 'tomlkit', 'scipy'}"
    code = "import sys; from hybond.cli.main import main; main(['run', 'charger.toml', '--json']);"
    code += f"print({heavy} & set(sys.modules), file=sys.stderr)"
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=shell.folder,
        env=ENV,
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stderr.strip() == "set()"
    assert json.loads(done.stdout)["status"] == "ok"


@pytest.mark.slow
def test_an_ascii_terminal_is_no_error(shell: Any) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "hybond", "explain", "ball.toml"],
        cwd=shell.folder,
        env={**ENV, "PYTHONIOENCODING": "ascii"},
        capture_output=True,
        check=True,
    )
    assert b"15 N?s ?" in done.stdout
