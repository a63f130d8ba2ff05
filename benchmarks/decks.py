"""Decks as people have them, unedited, in two engines.

``python benchmarks/decks.py`` prints the table of docs/circuits.md; names after it choose decks of
``benchmarks/decks``. What a deck measures (``.meas``) is compared. ngspice runs the deck itself, or
where it does not read the dialect the same circuit in ``benchmarks/decks/equivalents``, written by
hand.
"""

from __future__ import annotations

import re
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from ngspice import NGSPICE

import hybond as hb
from hybond.circuits.measured import measure

DECKS = Path(__file__).parent / "decks"
SUFFIXES = (".cir", ".sp", ".net", ".ckt", ".asc")
_VALUE = re.compile(r"^(\w+)\s+=\s+([-+0-9.eE]+)\s*(?:$|\w+=)", re.MULTILINE)


@dataclass(frozen=True)
class Compared:
    """What both engines measure in one deck.

    Parameters
    ----------
    status : str
        How the run of hybond ended.
    values : dict
        Measurement to hybond's value and ngspice's.
    seconds : tuple of float
        What both took.
    equivalent : bool
        Whether ngspice ran the same circuit in other words.
    """

    status: str
    values: dict[str, tuple[float, float]]
    seconds: tuple[float, float]
    equivalent: bool

    @property
    def worst(self) -> float:
        """The largest relative difference."""
        return max(abs(a - b) / max(abs(a), abs(b)) for a, b in self.values.values())


def decks() -> list[Path]:
    """Return all decks."""
    return sorted(path for path in DECKS.iterdir() if path.suffix in SUFFIXES)


def compare(deck: Path, folder: Path) -> Compared:
    """Run a deck in both engines; a measurement that one of them lacks is an error."""
    clock = time.perf_counter()
    conversion = hb.read_circuit(deck)
    run = hb.simulate(conversion.model)
    ours = measure(run, conversion.measures)
    mine = time.perf_counter() - clock
    other = DECKS / "equivalents" / f"{deck.stem}.cir"
    equivalent = other.exists()
    theirs, seconds = of_ngspice(other if equivalent else deck, folder)
    if not ours or set(ours) != set(theirs) or None in ours.values():
        raise ValueError(f"hybond measures {ours}, ngspice {theirs}")
    values = {name: (float(value or 0.0), theirs[name]) for name, value in ours.items()}
    return Compared(run.status, values, (mine, seconds), equivalent)


def of_ngspice(deck: Path, folder: Path) -> tuple[dict[str, float], float]:
    """Return what ngspice measures, and how long it took."""
    assert NGSPICE is not None
    copy = folder / f"{deck.stem}.cir"
    copy.write_text(deck.read_text())
    clock = time.perf_counter()
    done = subprocess.run(
        [NGSPICE, "-b", copy.name],
        capture_output=True,
        text=True,
        timeout=300,
        cwd=folder,
        check=False,
    )
    found = {name.lower(): float(value) for name, value in _VALUE.findall(done.stdout)}
    return found, time.perf_counter() - clock


def main() -> None:
    """Print the table."""
    if NGSPICE is None:
        sys.exit("ngspice is not installed")
    print("| deck | largest difference | of | hybond | ngspice |")
    print("| --- | --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as folder:
        for deck in decks():
            if len(sys.argv) > 1 and deck.name not in sys.argv[1:]:
                continue
            try:
                seen = compare(deck, Path(folder))
            except (hb.HybondError, ValueError) as error:
                print(f"| `{deck.name}` | {str(error)[:300]} |", flush=True)
                continue

            def apart(name: str, seen: Compared = seen) -> float:
                a, b = seen.values[name]
                return abs(a - b) / max(abs(a), abs(b))

            worst = max(seen.values, key=apart)
            mark = " (equivalent)" if seen.equivalent else ""
            cells = (f"`{deck.name}`{mark}", f"{100 * seen.worst:.2g} %", worst)
            mine, theirs = seen.seconds
            print(f"| {' | '.join(cells)} | {mine:.2g} s | {theirs:.2g} s |", flush=True)


if __name__ == "__main__":
    main()
