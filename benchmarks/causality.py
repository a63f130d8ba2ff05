"""How causality scales: assignment, one switch, all dynamic bonds, from 100 to 100 000 elements.

    python benchmarks/causality.py --sizes 100 1000 10000
    python benchmarks/causality.py --plot docs/img/causality_scale.png

Times are of the processor, so that other work on the machine counts little.
"""

from __future__ import annotations

import argparse
import gc
import random
import statistics
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from time import process_time

import numpy as np
from networks import FAMILIES, two_supplies

from hybond.causality.arrays import compile_arrays
from hybond.causality.assign import assign
from hybond.causality.dynamics import dynamics
from hybond.causality.explain import describe_conflict
from hybond.causality.reference import reference_mode
from hybond.causality.strokes import Strokes
from hybond.model.graph import FlatGraph

MEASURED = ("assign", "strokes", "switch", "reference", "dynamics")


@dataclass(frozen=True)
class Row:
    family: str
    bonds: int
    switches: int
    derivative: int
    flatten: float
    seconds: dict[str, float]
    """By name of what was measured; of a switch the median."""
    slowest: float


def timed(work: Callable[[], object], *, repeat: int = 1) -> float:
    best = float("inf")
    for _ in range(repeat):
        start = process_time()
        work()
        best = min(best, process_time() - start)
    return best


def measure(family: str, size: int, *, switchings: int) -> Row:
    graphs: list[FlatGraph] = []
    flatten = timed(lambda: graphs.append(FAMILIES[family](size)))
    graph = graphs[0]
    gc.collect()
    gc.freeze()  # else the collector walks the model again and again, and its time is measured
    repeat = 3 if size <= 10_000 else 1
    arrays = compile_arrays(graph)
    reference = reference_mode(graph, arrays=arrays)
    strokes = Strokes(graph, reference.mode, arrays=arrays)
    draw = random.Random(1)
    switches = []
    for _ in range(switchings):
        m = draw.randrange(len(graph.machines))
        state = {m: (strokes.states[m] + 1) % len(graph.machines[m].states)}
        switches.append(timed(lambda state=state: strokes.turn(state)))
    seconds = {
        "assign": timed(lambda: assign(graph, reference.mode), repeat=repeat),
        "strokes": timed(lambda: Strokes(graph, reference.mode, arrays=arrays), repeat=repeat),
        "switch": statistics.median(switches),
        "reference": timed(lambda: reference_mode(graph, arrays=arrays), repeat=repeat),
        "dynamics": timed(lambda: dynamics(graph, reference, arrays=arrays), repeat=repeat),
    }
    gc.unfreeze()
    derivative = reference.storages - reference.integral
    return Row(
        family,
        len(graph.bonds),
        len(graph.machines),
        derivative,
        flatten,
        seconds,
        max(switches),
    )


def exponent(rows: list[Row], name: str) -> float:
    """Return the slope of time over bonds on logarithmic axes."""
    sizes = np.log([row.bonds for row in rows])
    return float(np.polyfit(sizes, np.log([row.seconds[name] for row in rows]), 1)[0])


def explain_conflict(size: int) -> str:
    graph = two_supplies(size)
    mode = (1,) * len(graph.machines)
    start = process_time()
    conflicts = assign(graph, mode).conflicts
    texts = [describe_conflict(graph, mode, conflict) for conflict in conflicts]
    spent = process_time() - start
    return (
        f"{len(graph.bonds)} bonds: {len(conflicts)} conflict(s) found and told "
        f"in {spent:.2f} s:\n  {texts[0]}"
    )


def plot(rows: list[Row], path: Path) -> None:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    shown = {"assign": "from scratch, with reasons", "switch": "one switch", "dynamics": "dynamics"}
    figure, axes = plt.subplots(1, 3, figsize=(9.6, 3.4), sharex=True, layout="constrained")
    for ax, (name, title) in zip(axes, shown.items(), strict=True):
        for family in dict.fromkeys(row.family for row in rows):
            own = [row for row in rows if row.family == family]
            sizes = [row.bonds for row in own]
            ax.loglog(sizes, [row.seconds[name] for row in own], "o-", ms=3, lw=1, label=family)
        ax.set(title=title, xlabel="bonds")
        ax.grid(which="major", lw=0.4, alpha=0.5)
    axes[0].set_ylabel("seconds")
    axes[0].legend(frameon=False, fontsize=8)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=160)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sizes", type=int, nargs="+", default=[100, 1000, 10_000, 100_000])
    parser.add_argument("--families", nargs="+", default=list(FAMILIES), choices=list(FAMILIES))
    parser.add_argument("--switchings", type=int, default=300)
    parser.add_argument("--plot", type=Path)
    options = parser.parse_args()
    rows: list[Row] = []
    print(
        f"{'family':<16}{'bonds':>8}{'switches':>9}{'deriv.':>7}{'flatten':>9}"
        + "".join(f"{name:>11}" for name in MEASURED)
        + f"{'slowest':>11}"
    )
    for family in options.families:
        own = []
        for size in options.sizes:
            row = measure(family, size, switchings=options.switchings)
            own.append(row)
            print(
                f"{family:<16}{row.bonds:>8}{row.switches:>9}{row.derivative:>7}"
                f"{row.flatten:>8.2f}s"
                + "".join(f"{1e3 * row.seconds[name]:>9.3f}ms" for name in MEASURED)
                + f"{1e3 * row.slowest:>9.2f}ms",
                flush=True,
            )
        if len(own) > 1:
            print(
                f"{'  exponent':<49}"
                + "".join(f"{exponent(own, name):>11.2f}" for name in MEASURED)
            )
        rows += own
    print(explain_conflict(10_000))
    if options.plot:
        plot(rows, options.plot)


if __name__ == "__main__":
    main()
