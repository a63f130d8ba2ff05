"""Exported programs: compiled, run, and what they print as events and states."""

from __future__ import annotations

import subprocess
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import needs
import numpy as np
import pytest
from example_runs import STOPPED

STRICT = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic"]

needs_c = pytest.mark.c
needs_java = pytest.mark.java


KEPT = {"slip_x.heading", "slip_x.slow"}


@dataclass
class Said:
    """What ``--events`` prints."""

    transitions: list[tuple[str, ...]] = field(default_factory=list)
    """Cause, machine, from, to, kind."""
    times: list[float] = field(default_factory=list)
    states: dict[str, float] = field(default_factory=dict)
    impulses: list[tuple[float, str, str, float]] = field(default_factory=list)
    """Time, kind of the mode, bond variable, area."""
    sizes: dict[str, float] = field(default_factory=dict)
    """Of each state: the largest that one of its kind was; known of runs in hybond."""
    end: float = float("nan")
    stopped: str = ""


def read_events(text: str) -> Said:
    """Read what ``--events`` prints, and sizes; names may contain blanks, words do not."""
    said = Said()
    for line in text.splitlines():
        words = line.split(" ")
        if words[0] == "final":
            said.end = float(words[1])
        elif words[0] in ("state", "size"):
            column = said.states if words[0] == "state" else said.sizes
            column[" ".join(words[1:-1])] = float(words[-1])
        elif words[0] == "#":
            said.stopped = line
        elif words[0] == "impulse":
            said.impulses.append((float(words[1]), words[3], " ".join(words[4:]), float(words[2])))
        else:
            left, right = (part.split(" ") for part in line.split(" -> "))
            said.times.append(float(left[0]))
            said.transitions.append((left[1], " ".join(left[2:-1]), left[-1], right[0], right[-1]))
    return said


def expected(run) -> Said:
    """Return the same of a run in hybond."""
    said = Said(end=run.t_end)
    bonds = run.graph.bonds
    stored = {s.path.rpartition(".")[0]: f'"{bonds[s.bond].name}"' for s in run.graph.storages}
    for event in run.events:
        for step in event.steps:
            fired = [(f.machine, f.source, f.target) for f in step.fired] or [("-", "-", "-")]
            said.times += [event.t] * len(fired)
            said.transitions += [(event.cause, *f, step.kind) for f in fired]
            for path, bond in stored.items():
                said.impulses += [
                    (event.t, step.kind, f"{bond}.{x}", step.impulses[f"{path}.{x}"])
                    for x in "ef"
                    if f"{path}.{x}" in step.impulses
                ]
    kinds = {s.path: s.kind for s in run.graph.storages}
    kinds |= {i.path: i.path for i in run.graph.integrals}
    said.states = {path: float(run[path].at([run.t_end])[0]) for path in kinds}
    most: dict[str, float] = {}
    for path, kind in kinds.items():
        values = run[path].at(np.linspace(0.0, run.t_end, 101).tolist())
        most[kind] = max(most.get(kind, 0.0), float(np.abs(values).max()))
    said.sizes = {path: most[kind] for path, kind in kinds.items()}
    return said


def compile_c(
    text: str,
    folder: Path,
    name: str,
    flags: Sequence[str] = ("-O0",),
    compiler: Sequence[str] | None = None,
) -> Path:
    """Compile a program without a warning, with gcc or clang; return it."""
    command = compiler or needs.STRICT
    assert command is not None, "the test lacks the mark `strict`"
    source, program = folder / f"{name}.c", folder / name
    source.write_text(text, encoding="utf-8")
    subprocess.run([*command, *STRICT, *flags, "-o", program, source, "-lm"], check=True)
    return program


def check_c(source: Path) -> None:
    """Have gcc or clang read a program, and say nothing; it makes none, which takes ten times."""
    assert needs.STRICT is not None, "the test lacks the mark `strict`"
    subprocess.run([*needs.STRICT, *STRICT, "-fsyntax-only", source], check=True)


def compile_quickly(text: str, folder: Path, name: str) -> Path:
    """Compile a program with the compiler that takes least time; return it."""
    assert needs.QUICK is not None, "the test lacks the mark `c`"
    if needs.QUICK == needs.STRICT:
        return compile_c(text, folder, name)
    source, program = folder / f"{name}.c", folder / name
    source.write_text(text, encoding="utf-8")
    subprocess.run([*needs.QUICK, "-o", program, source, "-lm"], check=True)
    return program


def ask(*command: str | Path, code: int = 0) -> str:
    """Run a program that ends with this code and complains of nothing; return what it printed."""
    done = subprocess.run([*map(str, command)], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (code, "")
    return done.stdout


def check(name: str, said: Said, run: Said) -> None:
    """Hold what a program said of an example against a run of hybond."""
    span = run.end
    assert said.end == pytest.approx(span, rel=1e-9)
    assert bool(said.stopped) == (name in STOPPED)
    assert said.transitions == run.transitions
    assert said.times == pytest.approx(run.times, abs=1e-9 * span)
    check_impulses(said, run)
    # hybond keeps more of a friction in the plane: how the slip turns
    assert set(said.states) == {path for path in run.states if path not in KEPT}
    for path, value in said.states.items():
        # what is smaller than its kind by 1e-4 is made of differences
        size = max(abs(value), 1e-4 * run.sizes[path])
        assert value == pytest.approx(run.states[path], abs=1e-9 * size), path


def check_impulses(said: Said, run: Said) -> None:
    """Those on storage, whose bonds are known by name; of one step in any order."""
    bonds = {bond for _, _, bond, _ in run.impulses}
    found = sorted(i[1:] for i in said.impulses if i[2] in bonds)
    meant = sorted(i[1:] for i in run.impulses)
    assert [i[:2] for i in found] == [i[:2] for i in meant]
    assert [i[2] for i in found] == pytest.approx([i[2] for i in meant], rel=1e-8)
