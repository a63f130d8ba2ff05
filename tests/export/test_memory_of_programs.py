"""Memory of exported programs: it does not grow with a run, and its end is told."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import needs
import pytest
from export.programs import compile_c, compile_quickly, needs_c

import hybond as hb

EXAMPLES = Path(__file__).parents[2] / "examples"
COUNTED = """\
#include <stdio.h>
#include <stdlib.h>

static long taken = 0;

static void say(void)
{
    fprintf(stderr, "%ld\\n", taken);
}

/* Memory, as many blocks as the environment allows; how many were taken is said at the end. */
static void *counted(size_t n, size_t size)
{
    const char *most = getenv("BLOCKS");
    if (taken++ == 0) {
        atexit(say);
    }
    return most != NULL && taken > atol(most) ? NULL : calloc(n, size);
}
#define calloc counted
"""


def circle(count: int) -> hb.Model:
    """A machine that goes round through its states, two in a period."""
    m = hb.Model("circle", domain="electrical")
    m.add(v=hb.Se("5 V"), i=hb.One(), r=hb.R("1 ohm"), l=hb.I("1 mH"))
    m.bond("v -> i -> r", "i -> l")
    m.machine(
        "m",
        states={f"s{k}": [] for k in range(count)},
        start="s0",
        rules=[
            f"s{k} -> s{(k + 1) % count} when mod(time, 2e-4) {('>=', '<')[k % 2]} 1e-4"
            for k in range(count)
        ],
    )
    m.experiment["until"] = "20 ms"
    return m


def blocks(program: Path, until: float) -> tuple[int, int]:
    """Return how many lines a run prints, and how many blocks of memory it took."""
    command = [program, "--events", "--until", repr(until)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return done.stdout.count("\n"), int(done.stderr)


@needs_c
@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    ("name", "times"),
    [
        ("half_bridge", (0.003, 0.5)),
        ("woodpecker", (5.0, 20.0)),  # lands again and again
        # more modes than are kept; in the first rounds their steps grow
        ("circle", (0.1, 0.5)),
    ],
)
@pytest.mark.slow
def test_memory_does_not_grow_with_events(
    name: str, times: tuple[float, float], tmp_path: Path
) -> None:
    model = circle(100) if name == "circle" else hb.load(EXAMPLES / f"{name}.toml")
    program = compile_quickly(COUNTED + hb.export(model, to="c"), tmp_path, name)
    (lines, some), (more_lines, more) = (blocks(program, t) for t in times)
    assert more_lines > 3 * lines > 300 * (name == "circle")
    assert more == some


@pytest.mark.slow
@pytest.mark.strict
def test_the_end_of_memory_is_told(tmp_path: Path) -> None:
    """With code 3, wherever it comes; what there was is given back."""
    model = hb.load(EXAMPLES / "half_bridge.toml")
    program = compile_c(COUNTED + hb.export(model, to="c"), tmp_path, "scarce", needs.sanitizers())
    _, whole = blocks(program, 0.003)
    for count in (0, 1, 20, whole // 2, whole - 1, whole):
        done = subprocess.run(
            [program],
            env={**os.environ, "BLOCKS": str(count)},
            capture_output=True,
            text=True,
            check=False,
        )
        said = done.stderr.splitlines()[0]
        expected = (0, str(whole)) if count == whole else (3, "out of memory")
        assert (done.returncode, said) == expected, count


def test_nothing_of_the_runtime_ends_the_process_or_changes_what_all_share() -> None:
    text = str(hb.export(hb.load(EXAMPLES / "buck.toml"), to="c"))
    runtime = text[: text.index("/* What --set knows")]
    assert "exit(" not in runtime
    changed = [
        line
        for line in runtime.splitlines()
        if line.startswith("static ") and "(" not in line and "const " not in line
    ]
    assert changed == []
