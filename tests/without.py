"""Runs a command as on a machine that lacks some programs.

    python3 tests/without.py gcc clang java -- python3 dev.py test

The command finds programs through links to all the others.
"""

import os
import re
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

PROGRAMS = {
    "gcc": r"(.*-)?(gcc|g\+\+|c89|c99)(-.*)?",
    "clang": r"clang(\+\+|-cl|-\d+)*",
    "tcc": r"(.*-)?tcc",
    "java": r"java|javac",
    "ngspice": r"ngspice",
    "latex": r"(pdf|lua|xe)?latex|(pdf|lua|xe)?tex",
}


def links(folder: Path, lacking: list[str]) -> None:
    """Link all programs but those, by whatever name they go: ``cc`` is one of gcc, clang, tcc."""
    hidden = re.compile("|".join(PROGRAMS[name] for name in lacking))
    for place in os.get_exec_path():
        for program in sorted(Path(place).glob("*")):
            names = (program.name, program.resolve().name)
            link = folder / program.name
            if os.path.lexists(link) or any(hidden.fullmatch(name) for name in names):
                continue
            if program.name.startswith("python"):
                # a virtual environment remembers where its Python lies: not among these links
                link.write_text(f'#!/bin/sh\nexec {shlex.quote(str(program.absolute()))} "$@"\n')
                link.chmod(0o755)
            else:
                link.symlink_to(program.absolute())
    # where tcc is the only compiler, Debian calls it cc, too
    if not (folder / "cc").exists() and (folder / "tcc").exists():
        (folder / "cc").symlink_to("tcc")


def main() -> int:
    at = sys.argv.index("--") if "--" in sys.argv else len(sys.argv)
    lacking, command = sys.argv[1:at], sys.argv[at + 1 :]
    if not (lacking and command and PROGRAMS.keys() >= set(lacking)):
        sys.exit(f"usage: without.py {{{'|'.join(PROGRAMS)}}}... -- COMMAND")
    with tempfile.TemporaryDirectory() as folder:
        links(Path(folder), lacking)
        env = {**os.environ, "PATH": folder}
        env.pop("CC", None)  # it may name one of them
        return subprocess.run(command, env=env).returncode


if __name__ == "__main__":
    sys.exit(main())
