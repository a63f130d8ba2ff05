"""One signal of a run over another, as far as pixels tell points apart."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from hybond.errors import UsageError
from hybond.result import Result
from hybond.studio.curves import numbers

Vector = NDArray[np.float64]

PIXELS = 900
"""Of the longer side of the picture."""
POINTS = 20_000
"""Points of one picture; beyond, those that are nearer to each other are left out."""


def phase(run: Result, x: str, y: str, t0: float, t1: float) -> dict[str, Any]:
    """Return a trajectory in the plane of two signals between two times.

    Returns
    -------
    dict
        ``pieces``, pairs of lists, one per stay in a mode; from one to the next is a jump, which
        may be of no length. ``units`` and ``box`` (x least and greatest, y likewise).

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("lc", domain="electrical")
    >>> m.add(c=hb.C("1 F", e="1 V"), l=hb.I("1 H"), loop=hb.One())
    >>> m.bond("c -> loop", "loop -> l")
    >>> seen = phase(hb.simulate(m, until="7 s"), "l.f", "c.e", 0.0, 7.0)
    >>> len(seen["pieces"]), [round(v, 3) for v in seen["box"]]
    (1, [-1.0, 1.0, -1.0, 1.0])
    """
    if not t1 > t0:
        raise UsageError(
            f"no time between {t0!r} and {t1!r}",
            code="HB-W103",
            where="phase",
            hint="a stretch of the run: its begin, then its end",
        )
    pieces = []
    for (t, a), (_, b) in zip(run.pieces(x), run.pieces(y), strict=True):
        seen = (t >= t0) & (t <= t1) & np.isfinite(a) & np.isfinite(b)
        if seen.any():
            pieces.append((a[seen], b[seen]))
    if not pieces:
        box = [0.0, 1.0, 0.0, 1.0]
    else:
        box = [float(f(np.concatenate(p))) for p in zip(*pieces) for f in (np.min, np.max)]
    apart = 0.5 / PIXELS
    found = _thinned(pieces, box, apart)
    while sum(len(a) for a, _ in found) > POINTS and apart < 0.01:
        apart *= 2.0
        found = _thinned(pieces, box, apart)
    return {
        "pieces": [[numbers(a), numbers(b)] for a, b in found],
        "units": [run.unit(x), run.unit(y)],
        "box": box,
    }


def _thinned(
    pieces: list[tuple[Vector, Vector]], box: list[float], apart: float
) -> list[tuple[Vector, Vector]]:
    """Leave out points that are nearer to the last one kept than `apart` of the picture."""
    wide, high = box[1] - box[0] or 1.0, box[3] - box[2] or 1.0
    found = []
    for a, b in pieces:
        u, v = a / wide, b / high
        way = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(u), np.diff(v)))])
        cell = np.floor(way / apart)
        kept = np.concatenate([[True], cell[1:] != cell[:-1]])
        kept[-1] = True
        found.append((a[kept], b[kept]))
    return found
