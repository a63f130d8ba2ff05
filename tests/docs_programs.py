"""Programs in processes of their own that begin where hybond is imported already."""

from __future__ import annotations

import multiprocessing
import multiprocessing.context
import os
import sys
import traceback
from pathlib import Path

LONGEST = 120.0
"""Seconds that a program may take."""
PRELOADED = ["docs_preloaded"]


def run_program(text: str, folder: Path) -> tuple[int | None, str, str]:
    """Run a program in a folder; return its exit code, and what it wrote to both streams."""
    os.environ.setdefault("MPLBACKEND", "Agg")
    method = "forkserver" if "forkserver" in multiprocessing.get_all_start_methods() else "spawn"
    context = multiprocessing.get_context(method)
    if method == "forkserver":
        begin_server(context)
    said = [folder / "program.out", folder / "program.err"]
    process = context.Process(target=_program, args=(text, folder, *said))
    process.start()
    process.join(LONGEST)
    if process.is_alive():
        process.kill()
        process.join()
    return (process.exitcode, *(path.read_text(encoding="utf-8") for path in said))


def begin_server(context: multiprocessing.context.BaseContext) -> None:
    """Start the process that programs are forked from, which finds what is beside this file.

    Before Python 3.13 it looks for what is imported ahead on its own path only.
    """
    from multiprocessing import forkserver  # not every system has one

    context.set_forkserver_preload(PRELOADED)
    path = os.environ.get("PYTHONPATH")
    os.environ["PYTHONPATH"] = os.pathsep.join([str(Path(__file__).parent), *filter(None, [path])])
    try:
        forkserver.ensure_running()
    finally:
        if path is None:
            del os.environ["PYTHONPATH"]
        else:
            os.environ["PYTHONPATH"] = path


def _program(text: str, folder: Path, out: Path, err: Path) -> None:
    """Be the program: `__main__`, in its folder, with streams of its own."""
    os.chdir(folder)
    for path, number in ((out, 1), (err, 2)):
        os.dup2(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC), number)
    sys.stdout = open(1, "w", encoding="utf-8", closefd=False)  # noqa: SIM115
    sys.stderr = open(2, "w", encoding="utf-8", closefd=False)  # noqa: SIM115
    sys.argv = ["-c"]
    code = 0
    try:
        main = {"__name__": "__main__"}
        exec(compile(text, "<page>", "exec"), main)
    except BaseException:
        traceback.print_exc()
        code = 1
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)
