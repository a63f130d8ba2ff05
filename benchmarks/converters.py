"""Converters of power electronics in two engines: hybond after conversion, and ngspice.

``python benchmarks/converters.py`` prints the table of docs/circuits.md; names after it choose
decks of ``benchmarks/converters``. Each deck is what ngspice takes, with near-ideal cards of diodes
(``N = 0.01``, whose curve hybond's straight line is). Compared are means and root mean squares over
the last periods, as parts of the larger root mean square.
"""

from __future__ import annotations

import math
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from netlists import on_pieces
from ngspice import NGSPICE, Waves, run

import hybond as hb

DECKS = Path(__file__).parent / "converters"


@dataclass(frozen=True)
class Converter:
    """A deck and what is compared.

    Parameters
    ----------
    name : str
        Of the deck.
    period : float
        Of its steady state, s.
    signals : tuple of str
        Nodes and capacitors, whose voltages, and coils, whose currents are compared.
    periods : int
        How many of the last periods.
    reltol : float
        Of ngspice; with less its steps do not go on in some decks.
    """

    name: str
    period: float
    signals: tuple[str, ...]
    periods: int = 5
    reltol: float = 1e-4


CONVERTERS = [
    Converter("buck", 20e-6, ("out", "L1")),
    Converter("synchronous_buck", 20e-6, ("out", "L1")),
    Converter("boost", 20e-6, ("out", "L1")),
    Converter("interleaved_boost", 20e-6, ("out", "L1", "L2")),
    Converter("buck_boost", 20e-6, ("out", "L1")),
    Converter("four_switch_buck_boost", 20e-6, ("out", "L1")),
    Converter("cuk", 20e-6, ("out", "L1", "L2")),
    Converter("sepic", 20e-6, ("out", "L1")),
    Converter("zeta", 20e-6, ("out", "L2")),
    Converter("flyback", 20e-6, ("out",)),
    Converter("flyback_leakage", 20e-6, ("out", "Lk")),
    Converter("forward", 20e-6, ("out", "L1")),
    Converter("two_switch_forward", 20e-6, ("out", "L1")),
    Converter("push_pull", 20e-6, ("out", "Lo")),
    Converter("half_bridge_isolated", 20e-6, ("out", "Lo")),
    Converter("full_bridge_isolated", 20e-6, ("out", "Lo"), reltol=1e-3),
    Converter("dual_active_bridge", 20e-6, ("out", "L1")),
    Converter("series_resonant", 25e-6, ("out", "L1")),
    Converter("parallel_resonant", 25e-6, ("out", "L1", "Lo")),
    Converter("charge_pump", 20e-6, ("out",)),
    Converter("doubler", 1e-3, ("out",)),
    Converter("cockcroft_walton", 100e-6, ("out",)),
    Converter("half_wave_freewheel", 20e-3, ("L1",), 1),
    Converter("bridge_rectifier", 20e-3, ("L1", "C1"), 1, reltol=1e-3),
    Converter("six_pulse_rectifier", 20e-3, ("L1", "La"), 1),
    Converter("twelve_pulse_rectifier", 20e-3, ("L1", "La", "Ld"), 1),
    Converter("pfc_boost", 20e-3, ("out", "L1"), 1),
    Converter("vienna_leg", 20e-3, ("L1", "C1", "C2"), 1),
    Converter("dimmer", 20e-3, ("L1",), 1),
    Converter("thyristor_bridge", 20e-3, ("L1",), 1, reltol=1e-3),
    Converter("h_bridge_inverter", 1e-3, ("L1",)),
    Converter("three_phase_inverter", 20e-3, ("La", "Lb", "Lc"), 1),
    Converter("npc_leg", 4e-3, ("L1",), 2),
    Converter("chopper_motor", 200e-6, ("L1",)),
]


@dataclass(frozen=True)
class Seen:
    """What both engines make of one deck.

    Parameters
    ----------
    apart : dict
        Signal to how far its means and root mean squares are apart, as a part of the latter.
    events : int
        Instants at which something switched in hybond.
    seconds : tuple of float
        What hybond and ngspice took, conversion and start of the process included.
    values : dict
        Signal to mean and root mean square, hybond's before ngspice's.
    status : str
        How the run of hybond ended.
    """

    apart: dict[str, float]
    events: int
    seconds: tuple[float, float]
    values: dict[str, tuple[float, float, float, float]]
    status: str

    @property
    def worst(self) -> float:
        """The largest difference."""
        return max(self.apart.values())


def see(case: Converter, folder: Path) -> Seen:
    """Run a deck in both engines."""
    source = DECKS / f"{case.name}.cir"
    ends = ends_of_capacitors(source)
    deck = folder / source.name
    asked = [printed(signal, ends) for signal in case.signals]
    # hybond's signals of what is printed have the signs of SPICE
    deck.write_text(source.read_text().replace(".end\n", f".print tran {' '.join(asked)}\n.end\n"))
    clock = time.perf_counter()
    model = hb.read_circuit(deck).model
    found = hb.simulate(model)
    mine = time.perf_counter() - clock
    clock = time.perf_counter()
    waves = run(deck, folder, reltol=case.reltol)
    theirs = time.perf_counter() - clock
    end = float(found.t_end)
    begin = end - case.periods * case.period
    values, apart = {}, {}
    for signal, path in zip(case.signals, model.experiment["plot"], strict=True):
        a = of_hybond(found, path, begin, end)
        b = of_ngspice(waves, ends, signal, begin, end)
        values[signal] = (*a, *b)
        apart[signal] = max(abs(a[0] - b[0]), abs(a[1] - b[1])) / max(a[1], b[1])
    return Seen(apart, len(found.events), (mine, theirs), values, found.status)


def printed(signal: str, ends: dict[str, tuple[str, str]]) -> str:
    """Return how a netlist asks for a signal."""
    if signal in ends:
        return f"v({','.join(n for n in ends[signal])})"
    return f"i({signal})" if signal[0] == "L" else f"v({signal})"


def of_hybond(found: hb.Result, path: str, begin: float, end: float) -> tuple[float, float]:
    """Return mean and root mean square of a signal."""
    t, weights = on_pieces(found, begin, end)
    y = np.asarray(found[path].at(t.tolist()))
    return float(weights @ y), math.sqrt(float(weights @ y**2))


def ends_of_capacitors(deck: Path) -> dict[str, tuple[str, str]]:
    """Return the nodes of each capacitor."""
    cards = [line.split() for line in deck.read_text().splitlines()[1:]]
    return {c[0]: (c[1].lower(), c[2].lower()) for c in cards if c and c[0][0] == "C"}


def of_ngspice(
    waves: Waves, ends: dict[str, tuple[str, str]], signal: str, begin: float, end: float
) -> tuple[float, float]:
    """Return the same of ngspice, straight lines between its points integrated exactly."""
    name = signal.lower()
    if signal in ends:
        plus, minus = ends[signal]
        values = waves[plus] - waves[minus]
    else:
        values = waves[name if name in waves.vectors else f"{name}#branch"]
    mean = waves.mean(values, begin, end)
    inside = (waves.time > begin) & (waves.time < end)
    t = np.concatenate([[begin], waves.time[inside], [end]])
    y = np.interp(t, waves.time, values)
    squares = (y[1:] ** 2 + y[1:] * y[:-1] + y[:-1] ** 2) / 3.0
    return mean, math.sqrt(float(np.diff(t) @ squares) / (end - begin))


def main() -> None:
    """Print the table."""
    if NGSPICE is None:
        sys.exit("ngspice is not installed")
    chosen = [c for c in CONVERTERS if len(sys.argv) == 1 or c.name in sys.argv[1:]]
    print("| converter | events | largest difference | of | hybond | ngspice |")
    print("| --- | --- | --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as folder:
        for case in chosen:
            try:
                seen = see(case, Path(folder))
            except (hb.HybondError, RuntimeError, ValueError) as error:
                print(f"| `{case.name}` | {str(error)[:100]} |")
                continue
            worst = max(seen.apart, key=lambda signal: seen.apart[signal])
            mine, theirs = seen.seconds
            cells = (f"`{case.name}`", str(seen.events), f"{100 * seen.worst:.2g} %", worst)
            print(f"| {' | '.join(cells)} | {mine:.2g} s | {theirs:.2g} s |", flush=True)


if __name__ == "__main__":
    main()
