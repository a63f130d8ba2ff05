"""How the cost of mixed-Boolean equations grows with the size of a graph.

    python benchmarks/equations.py [--sizes 100 1000 10000 100000] [--plot equations_scale.png]

For each family of networks: state equations in numbers (`symbolic=False`) and their growth
exponent; then an RC ladder of 100 capacitors from model file to symbolic state equations, beside
BondGraphTools if that is installed.
"""

from __future__ import annotations

import argparse
import statistics
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from networks import FAMILIES

import hybond as hb
from hybond.causality.reference import reference_mode

REPEATS = 3
HARD = {"capacitors": 1000}
"""Families whose equations are full by nature (every capacitor depends on all), and their limit."""


def timed(work: Callable[[], object], repeats: int = REPEATS) -> float:
    """Return the median time of `work`, s."""
    found = []
    for _ in range(repeats):
        start = time.perf_counter()
        work()
        found.append(time.perf_counter() - start)
    return statistics.median(found)


def exponent(sizes: list[int], times: list[float]) -> float:
    """Return the slope of log time over log size, the smallest sizes left out."""
    half = max(len(sizes) // 2 - 1, 0)
    return float(np.polyfit(np.log(sizes[half:]), np.log(times[half:]), 1)[0])


def scale(sizes: list[int]) -> dict[str, tuple[list[int], list[float]]]:
    """Measure all families."""
    found = {}
    print(f"{'family':<12}{'elements':>10}{'switches':>10}{'equations':>12}")
    for name, build in FAMILIES.items():
        counts, times = [], []
        for size in (s for s in sizes if s <= HARD.get(name, s)):
            graph = build(size)
            reference = reference_mode(graph).mode

            def derive(graph=graph, reference=reference) -> object:  # type: ignore[no-untyped-def]
                return hb.state_equations(graph, reference=reference, symbolic=False)

            t = timed(derive, REPEATS if size <= 10_000 else 1)
            counts.append(len(graph.nodes))
            times.append(t)
            print(f"{name:<12}{len(graph.nodes):>10}{len(graph.machines):>10}{t:>10.3f} s")
        print(f"{name:<12}growth exponent {exponent(counts, times):.2f}")
        found[name] = (counts, times)
    return found


def ladder_file(rungs: int, folder: Path) -> Path:
    """Write a ladder of resistors and capacitors as a model file."""
    m = hb.Model("ladder")
    parts: dict[str, object] = {"V": hb.Se(1)}
    bonds, before = [], "V"
    for k in range(rungs):
        parts |= {f"s{k}": hb.One(), f"r{k}": hb.R("1 kohm"), f"z{k}": hb.Zero()}
        parts[f"c{k}"] = hb.C("1 uF")
        bonds += [f"{before} -> s{k} -> z{k} -> c{k}", f"s{k} -> r{k}"]
        before = f"z{k}"
    m.add(**parts)  # type: ignore[arg-type]
    m.bond(*bonds)
    path = folder / "ladder.toml"
    hb.save(m, path)
    return path


def ladder(rungs: int = 100) -> None:
    """File to state equations, beside a peer."""
    with tempfile.TemporaryDirectory() as folder:
        path = ladder_file(rungs, Path(folder))
        ours = timed(lambda: hb.state_equations(hb.load(path)).text())
    print(f"RC ladder, {rungs} capacitors, file to symbolic state equations: {ours:.3f} s")
    try:
        import BondGraphTools as peer
    except ImportError:
        print("BondGraphTools is not installed")
        return
    for few in (5, 10, 20):
        start = time.perf_counter()
        model = peer.new(name="ladder")
        source = peer.new("Se", value=1)
        peer.add(model, source)
        before = source
        for k in range(few):
            one, zero = peer.new("1"), peer.new("0")
            r, c = peer.new("R", value=1000, name=f"r{k}"), peer.new("C", value=1e-6, name=f"c{k}")
            peer.add(model, one, zero, r, c)
            for a, b in ((before, one), (one, r), (one, zero), (zero, c)):
                peer.connect(a, b)
            before = zero
        _ = model.constitutive_relations
        print(f"BondGraphTools, {few} capacitors: {time.perf_counter() - start:.2f} s")


def plot(found: dict[str, tuple[list[int], list[float]]], target: str) -> None:
    """Draw times over sizes."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
    for name, (counts, times) in found.items():
        axes.loglog(counts, times, "o-", label=f"{name}: exponent {exponent(counts, times):.2f}")
    axes.set(xlabel="elements", ylabel="mixed-Boolean equations, s")
    axes.legend(frameon=False)
    axes.grid(alpha=0.3)
    figure.savefig(target, dpi=150)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sizes", type=int, nargs="+", default=[100, 1000, 10_000, 100_000])
    parser.add_argument("--plot", metavar="FILE")
    given = parser.parse_args()
    results = scale(given.sizes)
    ladder()
    if given.plot:
        plot(results, given.plot)
