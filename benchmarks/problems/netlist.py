"""P13: converters as netlists, in hybond and in ngspice, which reads the same deck."""

from __future__ import annotations

import re
import tempfile
import time
from functools import cache
from pathlib import Path

import numpy as np
from measuring.problem import Outcome, Problem, points
from netlists import on_pieces
from ngspice import NGSPICE, Waves, run

import hybond as hb

DECKS = Path(__file__).parents[2] / "examples" / "netlists"
SPICE = "ngspice"
STAGE = """.subckt stage ain bin aout bout
C1 ain aout 1u
C2 bin bout 1u
D1 bin aout DI
D2 aout bout DI
.ends
.model DI D(IS=1e-14 N=0.01 RS=1)
.tran 0.5u 5m 0 0.1u uic
.end
"""


def flyback() -> str:
    """Return the flyback converter of the examples."""
    return (DECKS / "flyback.cir").read_text(encoding="utf-8")


def ladder(stages: int) -> str:
    """Return a Cockcroft-Walton multiplier of so many stages, two diodes each."""
    cells = [f"X{k} a{k - 1} b{k - 1} a{k} b{k} stage" for k in range(1, stages + 1)]
    top = f"R1 b{stages} 0 1meg\nVb b0 0 0\nV1 a0 0 SIN(0 100 10k)\n"
    return "multiplier\n" + top + "\n".join(cells) + "\n" + STAGE


@cache
def folder() -> tempfile.TemporaryDirectory[str]:
    """Return where decks and raw files go; it is gone with the process."""
    return tempfile.TemporaryDirectory()


def deck(name: str, text: str, end: float) -> Path:
    """Write a deck that ends then."""
    path = Path(folder().name) / f"{name}.cir"
    path.write_text(re.sub(r"(?m)^(\.tran \S+) \S+", rf"\g<1> {end:.9g}", text), encoding="utf-8")
    return path


def problem(name: str, title: str, text: str, node: str, period: float, full: bool) -> Problem:
    """Return the problem: what it finds is the mean of a voltage over the last cycle.

    Tolerances are those that each has by itself for such decks; the mean is told from one of
    ngspice that is far smaller.
    """
    lengths, longest = (50.0, 250.0), 250.0
    if full:
        lengths, longest = (200.0, 1000.0), 1000.0

    def spice(cycles: float, reltol: float = 1e-4) -> Outcome | None:
        if NGSPICE is None:
            return None
        path = deck(name, text, cycles * period)
        start = time.perf_counter()
        waves: Waves = run(path, Path(folder().name), reltol=reltol)
        seconds = time.perf_counter() - start
        mean = waves.mean(waves[node], (cycles - 1.0) * period, cycles * period)
        return Outcome(seconds, (mean,))

    def ours(cycles: float) -> Outcome:
        end = cycles * period
        path = deck(name, text, end)
        start = time.perf_counter()
        found = hb.simulate(hb.read_circuit(path).model, until=end)
        found.sample(np.linspace(0.0, end, points(cycles, longest)), [f"{node}.e"])
        seconds = time.perf_counter() - start
        t, weights = on_pieces(found, end - period, end)
        mean = float(weights @ np.asarray(found[f"{node}.e"].at(t.tolist())))
        return Outcome(seconds, (mean,), len(found.events))

    def true(cycles: float) -> tuple[float, ...]:
        found = spice(cycles, 1e-6)
        return found.found if found else (float("nan"),)

    tools = {SPICE: spice, "hybond": ours}
    return Problem("P13", title, "cycle", lengths, lengths, tools, true, base=SPICE)


def problems(full: bool) -> list[Problem]:
    """Return the problems."""
    return [
        problem("flyback", "flyback converter, netlist", flyback(), "out", 20e-6, full),
        *(
            problem(
                f"ladder{n}", f"ladder of {2 * n} diodes, netlist", ladder(n), f"b{n}", 1e-4, full
            )
            for n in (3, 10)
        ),
    ]
