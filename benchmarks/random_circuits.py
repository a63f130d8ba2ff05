"""Random circuits in two engines: hybond after conversion, and ngspice, which knows no bond graphs.

``python benchmarks/random_circuits.py 1000 --first 0`` draws circuits of sources, resistors, coils,
capacitors, diodes and switches, connected at random; it compares the mean of every voltage over
the second half of the run and says what did not agree, was refused or took too long.
"""

from __future__ import annotations

import argparse
import multiprocessing
import random
import signal
import tempfile
import time
import types
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from ngspice import Waves, run

import hybond as hb

UNTIL = 4e-3
"""How long each circuit runs, s."""
PATIENCE = 30
"""Seconds that a run may take."""
TOLERANCE = 5e-3
"""How far means may be apart, of the largest value of the wave or a tenth of the largest voltage
of the circuit: a straight line stands for the logarithm of a diode, some millivolts away."""
CARDS = """\
.model dd D(IS=1e-12 N=0.003 RS=5m)
.model sw SW(VT=2.5 VH=0 RON=10m ROFF=1g)
"""


def circuit(seed: int) -> str:
    """Return a deck: every node has a resistor to ground, every coil and source one beside it."""
    draw = random.Random(seed)
    nodes = [f"n{k}" for k in range(1, draw.randint(3, 9))]
    lines = [f"* random circuit {seed}", *_sources(draw, nodes)]
    places = ["0", *nodes]
    count = Counter[str]()

    def name(letter: str) -> str:
        count[letter] += 1
        return f"{letter}{count[letter]}"

    for node in nodes:
        lines.append(f"{name('R')} {node} 0 {_value(draw, 100.0, 1e5)}")
    for _ in range(draw.randint(len(nodes), 3 * len(nodes))):
        a, b = draw.sample(places, 2)
        match draw.choice("RRLLCCCDDDDSSHKI"):
            case "R":
                lines.append(f"{name('R')} {a} {b} {_value(draw, 1.0, 1e3)}")
            case "L":
                if draw.random() < 0.3:
                    lines.append(f"{name('L')} {a} {b} {_value(draw, 1e-3, 1e-1)}")
                    continue
                inner = f"i{count['L'] + 1}"
                lines.append(f"{name('L')} {a} {inner} {_value(draw, 1e-4, 1e-1)}")
                lines.append(f"{name('R')} {inner} {b} {_value(draw, 0.5, 20.0)}")
            case "C":
                # at once, or behind a resistor: loops of capacitors are legal circuits
                if draw.random() < 0.5:
                    lines.append(f"{name('C')} {a} {b} {_value(draw, 1e-7, 1e-4)}")
                else:
                    inner = f"j{count['C'] + 1}"
                    lines.append(f"{name('C')} {a} {inner} {_value(draw, 1e-7, 1e-4)}")
                    lines.append(f"{name('R')} {inner} {b} {_value(draw, 0.1, 10.0)}")
            case "D":
                lines.append(f"{name('D')} {a} {b} dd")
            case "S":
                gate = draw.choice(["g", "h"])
                lines.append(f"{name('S')} {a} {b} {gate} 0 sw")
            case "H":
                # a leg of a bridge: complementary switches with their diodes
                middle = draw.choice(nodes)
                lines += [f"{name('S')} {a} {middle} g 0 sw", f"{name('S')} {middle} {b} h 0 sw"]
                lines += [f"{name('D')} {middle} {a} dd", f"{name('D')} {b} {middle} dd"]
            case "K":
                first, second = name("L"), name("L")
                c, d = draw.sample(places, 2)
                lines.append(f"{first} {a} k{count['L']} {_value(draw, 1e-3, 1e-1)}")
                lines.append(f"{name('R')} k{count['L']} {b} {_value(draw, 0.5, 20.0)}")
                lines.append(f"{second} {c} m{count['L']} {_value(draw, 1e-3, 1e-1)}")
                lines.append(f"{name('R')} m{count['L']} {d} {_value(draw, 0.5, 20.0)}")
                lines.append(f"{name('K')} {first} {second} {draw.choice([0.5, 0.9, 0.98])}")
            case "I":
                level = draw.choice(["DC 0.1", "SIN(0 0.2 1500)", "PULSE(0 0.3 0 1u 1u 100u 250u)"])
                lines.append(f"{name('I')} {a} {b} {level}")
    period = draw.choice([1e-4, 2e-4, 5e-4])
    on, late = draw.uniform(0.2, 0.8) * period, draw.choice([0.0, 0.0, 0.3]) * period
    lines.append(f"Vg g 0 PULSE(0 5 {late:.6g} 10n 10n {on:.6g} {period:.6g})")
    lines += ["Eh h x g 0 -1", "Vx x 0 5"]
    lines = _resisted(lines)
    return "\n".join([*lines, CARDS, f".tran {UNTIL / 2000:.6g} {UNTIL:.6g}", ".end", ""])


def _resisted(lines: list[str]) -> list[str]:
    """Give a coil a resistor in series that closes a loop of coils alone.

    At rest any current may go round there: the circuit would not say what it starts from.
    """
    stands_for: dict[str, str] = {}

    def root(node: str) -> str:
        while node in stands_for:
            node = stands_for[node]
        return node

    found = []
    for line in lines:
        if line[0] == "L":
            coil, a, b, value = line.split()
            if root(a) == root(b):
                found += [f"{coil} {a} o{coil} {value}", f"Ro{coil} o{coil} {b} 1"]
                continue
            stands_for[root(a)] = root(b)
        found.append(line)
    return found


def _sources(draw: random.Random, nodes: list[str]) -> list[str]:
    lines = []
    for k, node in enumerate(draw.sample(nodes, draw.randint(1, min(2, len(nodes)))), start=1):
        level = draw.choice([24, 48, 100, 325])
        hertz = draw.choice([500, 1000, 2500])
        wave = draw.choice(
            [
                f"DC {level}",
                f"SIN(0 {level} {hertz})",
                f"SIN({level} {level / 2} {hertz} 0 0 {draw.choice([0, 30, 90])})",
                f"PULSE({-level} {level} 0 1u 1u {0.4 / hertz:.6g} {1 / hertz:.6g})",
            ]
        )
        lines.append(f"V{k} s{k} 0 {wave}")
        lines.append(f"Rs{k} s{k} {node} {_value(draw, 5.0, 50.0)}")
    return lines


def _value(draw: random.Random, low: float, high: float) -> str:
    return f"{low * (high / low) ** draw.random():.4g}"


@dataclass(frozen=True)
class Verdict:
    """What came of a circuit: ``agrees``, ``differs``, ``refused`` and others, with the reason."""

    seed: int
    kind: str
    why: str = ""
    seconds: float = 0.0
    events: int = 0


def judge(seed: int) -> Verdict:
    """Draw a circuit and run it with both engines."""
    return judged(circuit(seed), seed)


def judged(text: str, seed: int = 0) -> Verdict:
    """Run a deck of `UNTIL` seconds with both engines."""

    def late(number: int, frame: types.FrameType | None) -> None:
        raise TimeoutError

    signal.signal(signal.SIGALRM, late)
    with tempfile.TemporaryDirectory() as folder:
        deck = Path(folder, f"random{seed}.cir")
        deck.write_text(text)
        begun = time.process_time()
        signal.alarm(PATIENCE)
        try:
            made = hb.simulate(hb.read_circuit(deck).model)
        except TimeoutError:
            return Verdict(seed, "late", f"more than {PATIENCE} s")
        except hb.HybondError as error:
            return Verdict(seed, "refused", str(error).splitlines()[0][:160])
        except Exception as error:
            return Verdict(seed, "crashed", repr(error)[:160])
        finally:
            signal.alarm(0)
        seconds = time.process_time() - begun
        if made.status != "ok":
            return Verdict(seed, made.status, "; ".join(made.warnings)[:160], seconds)
        try:
            waves = _waves(deck, Path(folder))
        except Exception as error:
            return Verdict(seed, "no ngspice", str(error)[-100:].replace("\n", " "), seconds)
    begin = UNTIL / 2
    t = np.linspace(begin, UNTIL, 20001)
    worst, where = 0.0, ""
    # a resistor that leads nowhere is no node of the bond graph
    junctions = {n.path for n in made.graph.nodes if n.kind == "0"}
    known = [n for n in waves.vectors if n in junctions]
    largest = max(np.abs(waves[n]).max() for n in (*known, "s1"))
    for n in known:
        ours = np.asarray(made[f"{n}.e"].at(t))
        theirs = waves[n]
        size = max(np.abs(theirs).max(), 0.1 * largest)
        away = abs(np.trapezoid(ours, t) / begin - waves.mean(theirs, begin, UNTIL)) / size
        if away > worst:
            worst, where = away, n
    kind = "agrees" if worst <= TOLERANCE else "differs"
    return Verdict(seed, kind, f"{where} by {100 * worst:.3g} %", seconds, len(made.events))


def _waves(deck: Path, folder: Path) -> Waves:
    """Return what ngspice makes of a deck, as exactly as it comes to the end."""
    for reltol in (1e-5, 1e-4, 1e-3):
        waves = run(deck, folder, reltol=reltol)
        if len(waves.time) and waves.time[-1] >= 0.999 * UNTIL:
            return waves
    raise RuntimeError("it stops early")


def main() -> None:
    """Judge as many circuits as asked for, and say what did not agree."""
    words = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    words.add_argument("number", type=int)
    words.add_argument("--first", type=int, default=0, help="seed of the first circuit")
    words.add_argument("--show", action="store_true", help="print the deck of the first and end")
    words.add_argument("--workers", type=int, default=1)
    given = words.parse_args()
    if given.show:
        print(circuit(given.first))
        return
    seeds = range(given.first, given.first + given.number)
    with multiprocessing.Pool(given.workers) as pool:
        found = []
        for verdict in pool.imap_unordered(judge, seeds):
            found.append(verdict)
            if verdict.kind not in ("agrees", "no ngspice"):
                print(f"{verdict.seed:6} {verdict.kind:10} {verdict.why}", flush=True)
    print(dict(Counter(v.kind for v in found)))
    ran = [v for v in found if v.events]
    if ran:
        cost = sum(v.seconds for v in ran) / sum(v.events for v in ran)
        print(f"{sum(v.events for v in ran)} events, {1e3 * cost:.3g} ms each")


if __name__ == "__main__":
    main()
