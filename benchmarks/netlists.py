"""Netlists in two engines: hybond after conversion, and ngspice.

``python benchmarks/netlists.py`` prints the table of docs/circuits.md: how far means and switching
instants are apart with near-ideal diode cards (N = 0.01) and with ordinary ones (N = 1), which
hybond takes as a straight line.
"""

from __future__ import annotations

import math
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from ngspice import NGSPICE, Waves, run
from numpy.typing import NDArray

import hybond as hb
from hybond.circuits.ideal import THERMAL_VOLTAGE

PIECES = 250
"""Parts of the time over which a mean is taken."""
DECKS = Path(__file__).parents[1] / "examples" / "netlists"


@dataclass(frozen=True)
class Case:
    """A deck and what is compared.

    Parameters
    ----------
    name : str
        Of the deck.
    period : float
        Of its steady state, s.
    periods : int
        How many of the last periods are compared.
    means : mapping
        Signal of hybond to the vector of ngspice, or two whose difference it is.
    diodes : mapping
        Machine of hybond to the anode and cathode of the same diode in ngspice.
    reltol : float
        Of ngspice; its steps do not go on with less where N is 0.01 and six diodes commutate.
    """

    name: str
    period: float
    periods: int
    means: dict[str, tuple[str, ...]]
    diodes: dict[str, tuple[str, str]]
    reltol: float = 1e-4


SIX = {f"D{k}": (phase, "p") for k, phase in enumerate("abc", start=1)}
SIX |= {f"D{k}": ("n", phase) for k, phase in enumerate("abc", start=4)}

CASES = [
    Case("half_wave", 20e-3, 1, {"out.e": ("out",), "i_V1": ("v1#branch",)}, {"D1": ("a", "out")}),
    Case(
        "bridge",
        20e-3,
        1,
        {"out.e": ("out",), "L1.f": ("l1#branch",)},
        # D3 and D4 carry the microampere of the reference resistor in between
        {"D1": ("a", "p"), "D2": ("b", "p")},
    ),
    Case(
        "three_phase",
        20e-3,
        1,
        {"R1.e": ("o", "n"), "L1.f": ("l1#branch",)},
        SIX,
        reltol=1e-3,
    ),
    Case("doubler", 1e-3, 1, {"out.e": ("out",)}, {"D1": ("0", "x"), "D2": ("x", "out")}),
    Case(
        "cockcroft_walton",
        100e-6,
        5,
        {"out.e": ("out",)},
        {"X1_D1": ("0", "a1"), "X2_D2": ("a2", "b2")},
    ),
    Case("buck", 20e-6, 5, {"out.e": ("out",), "L1.f": ("l1#branch",)}, {"D1": ("0", "sw")}),
    Case("boost", 20e-6, 5, {"out.e": ("out",), "L1.f": ("l1#branch",)}, {"D1": ("sw", "out")}),
    Case("flyback", 20e-6, 5, {"out.e": ("out",)}, {"D1": ("s", "out")}),
    Case("cuk", 20e-6, 5, {"c.e": ("c",), "v_a_b": ("a", "b")}, {"D1": ("b", "0")}),
    Case("rlc", 500e-6, 1, {"C1.e": ("out",)}, {}),
    Case("coils", 500e-6, 1, {"b.e": ("b",), "i_L1.f": ("l1#branch",)}, {}),
    Case(
        "controlled",
        300e-6,
        1,
        {"f.e": ("f",), "k.e": ("k",), "m.e": ("m",), "C6.e": ("r",), "i_R3.f": ("vm#branch",)},
        {},
    ),
]


@dataclass(frozen=True)
class Comparison:
    """What two engines say about one deck.

    Parameters
    ----------
    means : dict
        Signal to its mean in hybond and in ngspice.
    instants : dict
        Diode to the instants at which it begins and ends to conduct, in both engines.
    """

    case: Case
    means: dict[str, tuple[float, float]]
    instants: dict[str, tuple[NDArray[np.float64], NDArray[np.float64]]]
    run: hb.Result
    waves: Waves

    def worst_mean(self) -> float:
        """Return the largest relative difference of two means."""
        return max((abs(a / b - 1.0) for a, b in self.means.values()), default=0.0)

    def worst_instant(self) -> float:
        """Return the largest difference of two instants, in periods."""
        return max(
            (float(np.abs(a - b).max()) / self.case.period for a, b in self.instants.values()),
            default=0.0,
        )


def compare(case: Case, folder: Path, *, ordinary: bool = False) -> Comparison:
    """Run a deck in both engines."""
    source = DECKS / f"{case.name}.cir"
    deck = folder / source.name
    deck.write_text(deck_text(source, ordinary=ordinary))
    model = hb.read_circuit(deck).model
    found = hb.simulate(model)
    waves = run(deck, folder, reltol=case.reltol)
    end = float(found.t_end)
    begin = end - case.periods * case.period
    means = {}
    for signal, vectors in case.means.items():
        theirs = waves[vectors[0]] - (waves[vectors[1]] if len(vectors) > 1 else 0.0)
        means[signal] = (mean(found, signal, begin, end), waves.mean(theirs, begin, end))
    instants = {}
    # where the card carries 0.1 mA; its voltage tells that more sharply than its current
    level = (1.0 if ordinary else 0.01) * THERMAL_VOLTAGE * math.log(1e-4 / 1e-14)
    for diode, (anode, cathode) in case.diodes.items():
        ours = changes(found, diode, begin, end)
        voltage = waves[anode] - waves[cathode]
        up, down = (waves.crossings(voltage, level, up=u) for u in (True, False))
        theirs = np.sort(np.concatenate([up, down]))
        instants[diode] = (ours, theirs[(theirs > begin) & (theirs < end)])
    return Comparison(case, means, instants, found, waves)


def deck_text(deck: Path, *, ordinary: bool) -> str:
    """Return a deck, with near-ideal or with ordinary cards of diodes."""
    text = deck.read_text()
    return text.replace("N=0.01", "N=1") if ordinary else text


def mean(found: hb.Result, signal: str, begin: float, end: float) -> float:
    """Return the mean of a signal of hybond."""
    t, weights = on_pieces(found, begin, end)
    return float(weights @ np.asarray(found[signal].at(t.tolist())))


def on_pieces(
    found: hb.Result, begin: float, end: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return times and weights of a mean by Gauss; no stretch of the formula passes an event."""
    cuts = np.unique([*np.linspace(begin, end, PIECES + 1), *_inside(found, begin, end)])
    middle, half = 0.5 * (cuts[1:] + cuts[:-1]), 0.5 * np.diff(cuts)
    nodes, weights = np.polynomial.legendre.leggauss(4)
    t = middle[:, None] + half[:, None] * nodes
    return t.ravel(), (half[:, None] * weights).ravel() / (end - begin)


def _inside(found: hb.Result, begin: float, end: float) -> list[float]:
    return [e.t for e in found.events if begin < e.t < end]


def changes(found: hb.Result, machine: str, begin: float, end: float) -> NDArray[np.float64]:
    """Return when a machine changed its state for good."""
    index = next(m.index for m in found.graph.machines if m.path == machine)
    times, state = [], None
    for event in found.events:
        now = event.steps[-1].mode[index]
        if state is not None and now != state and begin < event.t < end:
            times.append(event.t)
        state = now
    return np.array(times)


def main() -> None:
    """Print the table."""
    if NGSPICE is None:
        sys.exit("ngspice is not installed")
    print("| netlist | means, N = 0.01 | instants, N = 0.01 | means, N = 1 | instants, N = 1 |")
    print("| --- | --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as folder:
        for case in CASES:
            if not case.diodes:
                continue
            cells = []
            for ordinary in (False, True):
                found = compare(case, Path(folder), ordinary=ordinary)
                same = all(len(a) == len(b) for a, b in found.instants.values())
                cells.append(f"{100 * found.worst_mean():.2g} %")
                late = f"{100 * found.worst_instant():.2g} % of a period" if same else "not paired"
                cells.append(late)
            print(f"| `{case.name}` | {' | '.join(cells)} |")


if __name__ == "__main__":
    main()
