"""What an event costs in ladders of ideal diodes and capacitors.

    python benchmarks/ladders.py [--sizes 4 20 50 100 200] [--periods 2 8]

A Cockcroft-Walton ladder has nothing but diodes, capacitors and a source: at each event the
branches of all diodes are decided together. The cost of one event is the slope between two run
lengths, so that flattening and the start do not count; it contains the integration from one event
to the next, and the equations of modes that are met for the first time. Then its growth with the
number of diodes.
"""

from __future__ import annotations

import argparse
import math
import time

import numpy as np

import hybond as hb
from hybond.model.graph import FlatGraph

PERIOD = 0.02


def ladder(diodes: int) -> FlatGraph:
    """Return a half-wave ladder of 1 uF capacitors on a sine of 100 V and 50 Hz."""
    m = hb.Model("ladder", domain="electrical")
    m.add(V=hb.Se(f"100*sin({2.0 * math.pi / PERIOD}*time)"), source=hb.Zero())
    m.bond("V -> source")
    for k in range(1, diodes + 1):
        m.add(**{f"n{k}": hb.Zero(), f"C{k}": hb.C("1 uF"), f"d{k}": hb.One(law="diode")})
        m.bond(f"n{k - 1} -> d{k} -> n{k}" if k > 1 else "d1 -> n1")
        if k == 2:
            m.bond("n2 -> C2")
            continue
        below = "source" if k == 1 else f"n{k - 2}"
        m.add(**{f"c{k}": hb.One()})
        m.bond(f"n{k} -> c{k} -> {below}", f"c{k} -> C{k}")
    return m.flatten()


def run(graph: FlatGraph, periods: float) -> tuple[float, int]:
    """Return the time that a run takes, s, and its events."""
    start = time.perf_counter()
    result = hb.simulate(graph, until=periods * PERIOD)
    return time.perf_counter() - start, len(result.events)


def main() -> None:
    """Measure, and print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sizes", type=int, nargs="+", default=[4, 20, 50, 100, 200])
    parser.add_argument("--periods", type=float, nargs=2, default=[2.0, 8.0])
    options = parser.parse_args()
    run(ladder(4), 0.5)  # what is loaded once
    sizes, costs = [], []
    print(f"{'diodes':>7}{'events':>8}{'run':>12}{'per event':>14}")
    for n in options.sizes:
        graph = ladder(n)
        short, few = run(graph, options.periods[0])
        long, many = run(graph, options.periods[1])
        if many <= few or long <= short:
            print(f"{n:>7}{many:>8}{long:>10.2f} s   too short to tell")
            continue
        cost = (long - short) / (many - few)
        sizes.append(n)
        costs.append(cost)
        print(f"{n:>7}{many:>8}{long:>10.2f} s{1e3 * cost:>11.2f} ms")
    if len(sizes) > 1:
        slope = np.polyfit(np.log(sizes), np.log(costs), 1)[0]
        print(f"growth exponent {slope:.2f}")


if __name__ == "__main__":
    main()
