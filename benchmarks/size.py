"""How long a large model takes from its text to its result, and how much memory.

    python benchmarks/size.py [--cells 100 1000] [--until 1.4]

Each size in a process of its own: the cells of P14, ten elements and a machine each, whose own
voltages turn them. The memory is the most that the process had, all of Python within.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import time

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from problems.cells import RTOL, model

import hybond as hb


def one(cells: int, until: float) -> None:
    """Run one size and print its row."""
    start = time.process_time()
    graph = model(cells).flatten()
    flat = time.process_time() - start
    run = hb.simulate(graph, until=until, rtol=RTOL)
    took = time.process_time() - start - flat
    run.sample([0.5 * until, until], ["n1.e"])
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    steps, events = int(run.stats["steps"]), len(run.events)
    print(f"{cells:>7}{10 * cells:>10}{flat:>10.2f}{took:>8.2f}{steps:>8}{events:>8}{most:>9.0f}")


def main() -> None:
    """Measure, and print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cells", type=int, nargs="+", default=[100, 1000])
    parser.add_argument("--until", type=float, default=1.4, help="s; they switch from 1.1 s on")
    parser.add_argument("--one", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.one:
        one(options.cells[0], options.until)
        return
    print("  cells  elements  flatten     run   steps  events       MB")
    for cells in options.cells:
        own = [sys.executable, __file__, "--one", "--cells", str(cells)]
        subprocess.run([*own, "--until", str(options.until)], check=True)


if __name__ == "__main__":
    main()
