"""ngspice as a second engine: a deck is run in a process of its own, its raw file is read."""

from __future__ import annotations

import re
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

NGSPICE = shutil.which("ngspice")
"""Where it is, None if it is not installed."""


@dataclass(frozen=True)
class Waves:
    """What ngspice computed: time, voltages by node and currents by ``source#branch``."""

    time: NDArray[np.float64]
    vectors: dict[str, NDArray[np.float64]]

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        if name == "0":
            return np.zeros_like(self.time)
        return self.vectors[name]

    def mean(self, values: NDArray[np.float64], begin: float, end: float) -> float:
        """Return a mean over time, the straight lines between points integrated exactly."""
        inside = (self.time > begin) & (self.time < end)
        t = np.concatenate([[begin], self.time[inside], [end]])
        return float(np.trapezoid(np.interp(t, self.time, values), t) / (end - begin))

    def crossings(
        self, values: NDArray[np.float64], level: float, *, up: bool
    ) -> NDArray[np.float64]:
        """Return the times at which values cross a level, on straight lines between points."""
        y = values - level if up else level - values
        k = np.flatnonzero((y[:-1] < 0) & (y[1:] >= 0))
        part = -y[k] / (y[k + 1] - y[k])
        return self.time[k] + part * (self.time[k + 1] - self.time[k])


def run(deck: Path, folder: Path, *, reltol: float = 1e-4) -> Waves:
    """Run the transient analysis of a deck.

    Parameters
    ----------
    deck : Path
    folder : Path
        Where the copy of the deck and the raw file go.
    reltol : float
        Relative tolerance of its solver.
    """
    assert NGSPICE is not None
    text = deck.read_text()
    # .print would choose what is kept
    text = re.sub(r"(?im)^\.(print|plot|probe|save|end)\b(?!s).*$", "", text)
    exact = f"method=gear reltol={reltol} abstol={1e-5 * reltol} vntol={1e-2 * reltol}"
    text += f".options {exact}\n.end\n"
    copy, raw = folder / deck.name, folder / f"{deck.stem}.raw"
    copy.write_text(text)
    done = subprocess.run(
        [NGSPICE, "-b", "-r", str(raw), str(copy)],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    if not raw.exists():
        raise RuntimeError(done.stdout + done.stderr)
    return read(raw.read_bytes())


def read(raw: bytes) -> Waves:
    """Read a binary raw file of a transient analysis."""
    head, _, body = raw.partition(b"Binary:\n")
    lines = head.decode("latin-1").splitlines()
    count = int(next(s for s in lines if s.startswith("No. Variables")).split(":")[1])
    points = int(next(s for s in lines if s.startswith("No. Points")).split(":")[1])
    at = lines.index("Variables:")
    names = [_plain(line.split()[1].lower()) for line in lines[at + 1 : at + 1 + count]]
    data = np.frombuffer(body, dtype="<f8", count=count * points).reshape(points, count)
    return Waves(data[:, 0], {n: data[:, k] for k, n in enumerate(names)})


def _plain(name: str) -> str:
    """Return ``out`` for ``v(out)``, ``l1#branch`` for ``i(l1)``."""
    inner = name[2:-1]
    return inner if name.startswith("v(") else f"{inner}#branch" if name.startswith("i(") else name
