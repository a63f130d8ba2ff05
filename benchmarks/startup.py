"""Cold start: what `import hybond` and a first simulation cost next to `import numpy`.

Whole processes, timed from outside, the three commands interleaved so that a busy machine slows
all of them alike. The table shows medians; `out/startup.json` keeps every sample.

    python benchmarks/startup.py --repeats 15
"""

import argparse
import json
import os
import platform
import statistics
import subprocess
import sys
import time
from pathlib import Path

try:
    import resource
except ImportError:  # Windows: wall time only
    resource = None

ROOT = Path(__file__).resolve().parents[1]
BASE = "import numpy"


def console_script() -> list[str]:
    """Return the command `hybond` of this environment."""
    name = "hybond.exe" if os.name == "nt" else "hybond"
    script = Path(sys.executable).with_name(name)
    return [str(script)] if script.exists() else [sys.executable, "-m", "hybond"]


def children_cpu() -> float | None:
    """Return the processor seconds of all children that have ended, or None if not known."""
    if resource is None:
        return None
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def sample(command: list[str]) -> tuple[float, float | None]:
    """Run one process; return its wall time and processor time in seconds."""
    cpu = children_cpu()
    start = time.perf_counter()
    done = subprocess.run(command, cwd=ROOT, stdin=subprocess.DEVNULL, capture_output=True)
    wall = time.perf_counter() - start
    if done.returncode:
        sys.exit(
            f"{' '.join(command)} ended with exit code {done.returncode}\n"
            f"{done.stderr.decode(errors='replace')}"
        )
    after = children_cpu()
    return wall, None if cpu is None or after is None else after - cpu


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeats", type=int, default=7)
    parser.add_argument("--example", default="examples/bouncing_ball.toml")
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "startup.json")
    options = parser.parse_args()

    python = sys.executable
    commands = {
        BASE: [python, "-c", "import numpy"],
        "import hybond": [python, "-c", "import hybond"],
        f"hybond run {options.example}": [*console_script(), "run", options.example],
    }
    targets = dict(zip(commands, (None, 1.6, 6.0), strict=True))

    for command in commands.values():  # byte code and disk cache: not what is measured
        sample(command)
    samples: dict[str, list[tuple[float, float | None]]] = {name: [] for name in commands}
    for _ in range(options.repeats):
        for name, command in commands.items():
            samples[name].append(sample(command))

    rows = {}
    for name, pairs in samples.items():
        cpu = [value for _, value in pairs if value is not None]
        rows[name] = {
            "wall_s": statistics.median(wall for wall, _ in pairs),
            "cpu_s": statistics.median(cpu) if cpu else None,
            "target": targets[name],
            "wall_samples_s": [wall for wall, _ in pairs],
            "cpu_samples_s": cpu,
        }
    for row in rows.values():
        row["ratio"] = row["wall_s"] / rows[BASE]["wall_s"]
        row["cpu_ratio"] = row["cpu_s"] / rows[BASE]["cpu_s"] if row["cpu_s"] else None

    width = max(map(len, rows))
    print(f"{'':{width}}  wall ms   cpu ms  ratio  target   (median of {options.repeats})")
    for name, row in rows.items():
        cpu_ms = f"{1e3 * row['cpu_s']:8.1f}" if row["cpu_s"] is not None else f"{'-':>8}"
        verdict = ""
        if row["target"]:
            verdict = (
                f"  {row['target']:5.1f}x  {'met' if row['ratio'] <= row['target'] else 'MISSED'}"
            )
        print(f"{name:{width}} {1e3 * row['wall_s']:8.1f} {cpu_ms} {row['ratio']:5.2f}x{verdict}")

    options.out.parent.mkdir(parents=True, exist_ok=True)
    record = {
        "benchmark": "startup",
        "python": platform.python_version(),
        "machine": platform.platform(),
        "repeats": options.repeats,
        "commands": rows,
    }
    options.out.write_text(json.dumps(record, indent=2) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
