"""`spread_of`: a curve of many runs, ready to be drawn: some of them, and bands of quantiles."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hybond.draw.of_sweeps import Spread

if TYPE_CHECKING:
    from hybond.sweep.table import SweepTable

SHOWN = 40
"""Members that are drawn."""


def spread_of(table: SweepTable, curve: str) -> Spread:
    """Return a curve, ``curve(x, 101)`` as it was collected, of members spread over all of them.

    Raises
    ------
    UsageError
        HB-P113 for what is no curve.
    """
    t, bands = table.quantiles(curve)
    many = len(table)
    shown = np.unique(np.linspace(0, max(many - 1, 0), min(SHOWN, many)).astype(np.intp))
    rows = [np.zeros((0, len(t)))]
    for part in table.parts():
        own = shown[(shown >= part.first) & (shown < part.last)]
        rows.append(part.columns[curve][own - part.first])
    signal = next(c for c in table.collectors if c.text == curve)
    return Spread(signal.signal, signal.unit, t, bands, shown, np.concatenate(rows))
