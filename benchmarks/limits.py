"""How far hybond is from hand-written C.

    python benchmarks/limits.py [--bounces 200 1000] [--masses 100 1000]

Each problem is an ordinary model beside a C program that does the same job with the same method
(`benchmarks/limit/`): Dormand and Prince at rtol 1e-8, guards watched on the dense output, events
stored. Times are the slopes between two lengths of run, so that neither loading nor the start of a
run counts; both are run by turns, and medians are shown. The last column is the error of
the last bounce, or how far the two states lie apart.
"""

from __future__ import annotations

import argparse
import math
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import hybond as hb
from hybond.kernel.build import compiler
from hybond.model.graph import FlatGraph

LIMIT = Path(__file__).parent / "limit"
TURNS = 5


def ball() -> FlatGraph:
    """Return a ball with Newton's restitution of 0.999 by a machine."""
    m = hb.Model("ball", domain="translational")
    m.add(weight=hb.Se("-9.81"), ball=hb.I(1.0), v=hb.One(), contact=hb.Zero())
    m.add(rebound=hb.Sf("-0.999*pre(v.f)"))
    m.bond("weight -> v -> ball", "contact -> v", "rebound -> contact")
    m.signal(height=hb.Integral("v.f", start=3.0))
    m.machine(
        "floor",
        states={"away": [], "impact": ["contact"]},
        start="away",
        rules=[
            "away -> impact when height <= 0 and v.f < 0",
            "impact -> away when pre(ball.p) >= 0",
        ],
    )
    return m.flatten()


def chain(masses: int, cubic: float) -> FlatGraph:
    """Return masses with springs and dampers between them, each pulled by 1 N."""
    m = hb.Model("chain", domain="translational")
    spring = {"e": f"1000*q + {cubic}*q^3"} if cubic else 0.001
    for k in range(1, masses + 1):
        m.add(
            **{
                f"v{k}": hb.One(),
                f"m{k}": hb.I(1.0),
                f"F{k}": hb.Se(1.0),
                f"d{k}": hb.Zero(),
                f"link{k}": hb.One(),
                f"k{k}": hb.C(spring),
                f"b{k}": hb.R(1.0),
            }
        )
        m.bond(
            f"F{k} -> v{k} -> m{k}", f"v{k} -> d{k}", f"d{k} -> link{k} -> k{k}", f"link{k} -> b{k}"
        )
        if k > 1:
            m.bond(f"d{k} -> v{k - 1}")
    return m.flatten()


def compiled(name: str, into: Path) -> Path:
    """Compile one limit program for this very machine."""
    command = compiler()
    if command is None:
        print("there is no C compiler")
        sys.exit(0)
    target = into / name
    flags = ["-std=c11", "-O3", "-march=native", "-D_POSIX_C_SOURCE=199309L"]
    subprocess.run([*command, *flags, "-o", target, LIMIT / f"{name}.c", "-lm"], check=True)
    return target


def in_c(program: Path, *given: float) -> tuple[float, float]:
    """Return seconds, and what came out."""
    words = [str(program), *(f"{a:.17g}" for a in given)]
    out = subprocess.run(words, check=True, capture_output=True, text=True).stdout.split()
    return float(out[0]), float(out[1])


def timed(graph: FlatGraph, until: float, kernel: bool) -> tuple[float, hb.Result]:
    start = time.perf_counter()
    run = hb.simulate(graph, until=until, kernel=kernel)
    return time.perf_counter() - start, run


def line(name: str, limit: float, ours: float, reference: float, apart: float) -> None:
    print(
        f"{name:34}{1e3 * limit:>11.4f}{1e3 * ours:>11.3f}{ours / limit:>9.1f}"
        f"{reference / limit:>11.0f}{apart:>11.1e}"
    )


def bounces(program: Path, few: int, many: int) -> None:
    """The ball, per 1,000 bounces."""
    graph = ball()
    until = {n: in_c(program, n)[1] * (1.0 + 1e-9) for n in (few, many)}
    slopes: dict[str, list[float]] = {"c": [], "kernel": [], "reference": []}
    apart = 0.0
    for turn in range(TURNS):
        again = 500
        c = [sum(in_c(program, n)[0] for _ in range(9)) / 9 for n in (again * few, again * many)]
        slopes["c"].append((c[1] - c[0]) / again)
        pair = [timed(graph, until[n], True) for n in (few, many)]
        slopes["kernel"].append(pair[1][0] - pair[0][0])
        at = [e.t for e in pair[1][1].events if len(e.steps) > 1]
        fall = math.sqrt(2.0 * 3.0 / 9.81)
        apart = abs(
            at[many - 1] / (fall * (1.0 + 2.0 * sum(0.999**k for k in range(1, many)))) - 1.0
        )
        if turn == 0:
            slow = [timed(graph, until[n], False)[0] for n in (few, many)]
            slopes["reference"].append(slow[1] - slow[0])
    c, ours, ref = (statistics.median(slopes[k]) * 1e3 / (many - few) for k in slopes)
    line("ball, per 1,000 bounces", c, ours, ref, apart)


def masses(program: Path, count: int, cubic: float, name: str) -> None:
    """The chain, per second of motion."""
    graph = chain(count, cubic)
    short, long = (2.0, 10.0) if count <= 100 else (0.5, 2.0)
    slopes: dict[str, list[float]] = {"c": [], "kernel": [], "reference": []}
    apart = 0.0
    for turn in range(TURNS):
        c = [in_c(program, count, t, cubic) for t in (short, long)]
        slopes["c"].append(c[1][0] - c[0][0])
        pair = [timed(graph, t, True) for t in (short, long)]
        slopes["kernel"].append(pair[1][0] - pair[0][0])
        apart = abs(float(pair[1][1]["k1.q"].at(long)) / c[1][1] - 1.0)
        if turn == 0:
            slow = [timed(graph, t, False)[0] for t in (short, long)]
            slopes["reference"].append(slow[1] - slow[0])
    c_, ours, ref = (statistics.median(slopes[k]) / (long - short) for k in slopes)
    line(name, c_, ours, ref, apart)


def main() -> None:
    """Measure, and print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bounces", type=int, nargs=2, default=[50, 250])
    parser.add_argument("--masses", type=int, nargs="+", default=[100])
    options = parser.parse_args()
    print(f"{'':34}{'C':>11}{'hybond':>11}{'':>9}{'reference':>11}")
    print(f"{'problem':34}{'ms':>11}{'ms':>11}{'ratio':>9}{'ratio':>11}{'apart':>11}")
    with tempfile.TemporaryDirectory() as folder:
        programs = {name: compiled(name, Path(folder)) for name in ("ball", "chain")}
        bounces(programs["ball"], *options.bounces)
        for count in options.masses:
            masses(programs["chain"], count, 0.0, f"chain of {count}, linear, per s")
            masses(programs["chain"], count, 1e5, f"chain of {count}, stiffening, per s")


if __name__ == "__main__":
    main()
