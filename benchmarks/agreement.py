"""The same answer twice, in numbers: located events against time-stepping as the step is halved.

    python benchmarks/agreement.py [--ladders 4 20 50] [--loaded 4 20 50] [--arms 4 8 16]
                                   [--periods 2] [--steps 200] [--halvings 3] [--theta 0.5]

Three kinds of networks: Cockcroft-Walton ladders of ideal diodes and capacitors, the same with a
load at every second node, and arms of a modular multilevel converter with N half-bridge submodules.
The two engines share the graph and its equations, nothing else: the one locates each event and
settles the mode there, the other solves the laws of all junctions over steps of fixed length.

For each step the table has the largest difference of any state at any instant (each millisecond of
a ladder, each tenth of one of an arm), and its mean over them, both relative to the largest state
of its kind; the order, from one step to the next; and the largest difference that is left after
Richardson's extrapolation with the nearest whole order.

Which order is to be expected? Ideal diodes and capacitors alone have no time of their own: a step
is exact but for the peaks of the source that it misses, so it is compared both with steps that hit
them (one fourth of a period is a number of steps) and, with ``--skew``, with steps that do not:
a peak missed by part of a step costs the square of it. With resistors and inductors the order is
two between events (theta = 1/2) and one where a diode changes its branch within a step.
"""

from __future__ import annotations

import argparse
import itertools
import math
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from ladders import PERIOD, ladder
from numpy.typing import NDArray

import hybond as hb
from hybond.model.graph import FlatGraph

SUBMODULE = 15.0
"""Share of the source of each submodule of an arm, V."""


@dataclass(frozen=True)
class Row:
    """One step: its length, differences, what the run cost."""

    step: float
    largest: float
    mean: float
    end: float
    events: int
    seconds: float
    states: NDArray[np.float64]


@dataclass(frozen=True)
class Agreement:
    """Located events against time-stepping.

    `rows` are the steps from long to short, `orders` those of the mean difference between them,
    `extrapolated` the largest difference after Richardson's extrapolation, one fewer.
    """

    events: int
    seconds: float
    rows: tuple[Row, ...]
    orders: tuple[float, ...]
    extrapolated: tuple[float, ...]


def loaded(diodes: int) -> FlatGraph:
    """Return a ladder with 1 Mohm from every second node to ground, and a source of 1 kohm."""
    m = hb.Model("loaded", domain="electrical")
    m.add(V=hb.Se(f"100*sin({2.0 * math.pi / PERIOD}*time)"), out=hb.One(), Rs=hb.R("1 kohm"))
    m.add(source=hb.Zero())
    m.bond("V -> out -> source", "out -> Rs")
    for k in range(1, diodes + 1):
        m.add(**{f"n{k}": hb.Zero(), f"C{k}": hb.C("1 uF"), f"d{k}": hb.One(law="diode")})
        m.bond(f"n{k - 1} -> d{k} -> n{k}" if k > 1 else "d1 -> n1")
        if k % 2 == 0:
            m.add(**{f"R{k}": hb.R("1 Mohm")})
            m.bond(f"n{k} -> R{k}")
        if k == 2:
            m.bond("n2 -> C2")
            continue
        below = "source" if k == 1 else f"n{k - 2}"
        m.add(**{f"c{k}": hb.One()})
        m.bond(f"n{k} -> c{k} -> {below}", f"c{k} -> C{k}")
    return m.flatten()


def arm(submodules: int, *, blocked: float = 9.6e-3) -> FlatGraph:
    """Return an arm of half bridges on a source, as in examples/mmc_arm.toml.

    Each inserts its capacitor for six tenths of a millisecond, one after the other; from `blocked`
    on all transistors are off and only diodes are left.
    """
    m = hb.Model("arm", domain="electrical")
    m.add(source=hb.Se(SUBMODULE * submodules), i=hb.One(), L=hb.I("1 mH"), R=hb.R("0.5 ohm"))
    m.bond("source -> i -> L", "i -> R")
    for k in range(1, submodules + 1):
        a, p, u, w, du, dl = (f"{n}{k}" for n in ("a", "p", "up", "low", "dup", "dlow"))
        m.add(**{a: hb.Zero(), p: hb.Zero(), f"C{k}": hb.C("1 mF", e="20 V")})
        m.add(**{u: hb.One(), w: hb.One(), du: hb.One(law="diode"), dl: hb.One(law="diode")})
        m.bond(f"i -> {a}", f"{p} -> {u} -> {a}", f"{a} -> {du} -> {p}", f"{p} -> C{k}")
        m.bond(f"{a} -> {w}", f"{dl} -> {a}")
        phase = 1e-3 * (k - 1) / submodules
        m.input(**{f"g{k}": hb.Input(pwm={"period": 1e-3, "duty": 0.6, "phase": phase})})
        m.machine(
            f"leg{k}",
            states={"blocked": [], "inserted": [u], "bypassed": [w]},
            start="blocked",
            rules=[
                f"blocked -> inserted when g{k} > 0.5 and time < {blocked}",
                f"blocked -> bypassed when g{k} < 0.5 and time < {blocked}",
                f"inserted -> blocked when time >= {blocked}",
                f"bypassed -> blocked when time >= {blocked}",
                f"inserted -> bypassed when g{k} < 0.5",
                f"bypassed -> inserted when g{k} > 0.5",
            ],
        )
    return m.flatten()


def states(run: hb.Result, until: float, instants: int) -> NDArray[np.float64]:
    """Return all stored quantities, one a row, at some instants."""
    names = [s.path for s in run.graph.storages]
    t = np.linspace(0.0, until, instants + 1)[1:]
    found = run.sample(t.tolist(), names)
    return np.array([found[n] for n in names])


def agreement(
    graph: FlatGraph,
    until: float,
    steps: float,
    *,
    instants: int = 20,
    halvings: int = 3,
    theta: float = 0.5,
) -> Agreement:
    """Return how far time-stepping is from located events, `steps` being those of the longest.

    Examples
    --------
    >>> found = agreement(ladder(4), 0.02, 100, halvings=1, theta=1.0)
    >>> found.rows[-1].largest < 1e-6
    True
    """
    start = time.perf_counter()
    located = hb.simulate(graph, until=until, rtol=1e-9)
    seconds = time.perf_counter() - start
    exact = states(located, until, instants)
    kinds = np.array([s.kind for s in graph.storages])
    unit = np.array([np.abs(exact[kinds == k]).max() for k in kinds])[:, None]
    rows = []
    for k in range(halvings + 1):
        h = until / (steps * 2**k)
        start = time.perf_counter()
        run = hb.simulate(graph, until=until, solver="moreau-jean", step=h, theta=theta)
        spent = time.perf_counter() - start
        found = states(run, until, instants)
        apart = np.abs(found - exact) / unit
        end, mean = float(apart[:, -1].max()), float(apart.mean(axis=1).max())
        rows.append(Row(h, float(apart.max()), mean, end, len(run.events), spent, found))
    orders = [
        math.log2(max(a.mean, 1e-300) / max(b.mean, 1e-300)) for a, b in itertools.pairwise(rows)
    ]
    extrapolated = []
    for order, (a, b) in zip(orders, itertools.pairwise(rows), strict=True):
        more = 2.0 ** min(max(round(order), 1), 2)
        best = (more * b.states - a.states) / (more - 1.0)
        extrapolated.append(float((np.abs(best - exact) / unit).max()))
    return Agreement(len(located.events), seconds, tuple(rows), tuple(orders), tuple(extrapolated))


def show(name: str, found: Agreement) -> None:
    """Print the table of one network."""
    print(f"\n{name}: located {found.events} events in {found.seconds:.2f} s")
    names = ("step", "largest", "mean", "at end", "order", "extrap.", "events", "run")
    print("".join(f"{n:>11}" for n in names))
    for k, row in enumerate(found.rows):
        order = f"{found.orders[k - 1]:.2f}" if k else ""
        beyond = f"{found.extrapolated[k - 1]:.2e}" if k else ""
        cells = (f"{row.step:.3g} s", f"{row.largest:.2e}", f"{row.mean:.2e}", f"{row.end:.2e}",
                 order, beyond, str(row.events), f"{row.seconds:.2f} s")  # fmt: skip
        print("".join(f"{c:>11}" for c in cells), flush=True)


def main() -> None:
    """Run both engines on all networks asked for, and print a table for each."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--ladders", type=int, nargs="*", default=[4, 20, 50])
    parser.add_argument("--loaded", type=int, nargs="*", default=[4, 20, 50])
    parser.add_argument("--arms", type=int, nargs="*", default=[4, 8, 16])
    parser.add_argument("--periods", type=float, default=2.0)
    parser.add_argument("--steps", type=int, default=200, help="in a period of the source, or 1 ms")
    parser.add_argument("--skew", action="store_true", help="steps that miss the peaks")
    parser.add_argument("--halvings", type=int, default=3)
    parser.add_argument("--theta", type=float, default=0.5)
    options = parser.parse_args()
    per_period = options.steps * (0.5 * (1.0 + 5.0**0.5) if options.skew else 1.0)
    kinds: list[tuple[str, Callable[[int], FlatGraph], list[int]]] = [
        ("ladder of {} diodes", ladder, options.ladders),
        ("loaded ladder of {} diodes", loaded, options.loaded),
    ]
    given = {"halvings": options.halvings, "theta": options.theta}
    for name, make, sizes in kinds:
        for n in sizes:
            until = options.periods * PERIOD
            steps = options.periods * per_period
            instants = round(1e3 * until)
            show(name.format(n), agreement(make(n), until, steps, instants=instants, **given))
    for n in options.arms:
        found = agreement(arm(n), 9.9e-3, 9.9 * per_period / 2.0, instants=99, **given)
        show(f"arm of {n} submodules, {2 * n} diodes", found)


if __name__ == "__main__":
    main()
