"""What rounding is measured by in rows eliminated twice: the lesser of what both have lost.

How much a coefficient may have lost is followed to first order, and each of two ways to it says so
much at the most. Rows that are solved for by how large bond variables are divide by what is small
beside others: their coefficients have more digits, and what they may have lost is far too much. No
guard and no law could be told by it. A coefficient that was lost on the one way is what it is on
the other.
"""

from __future__ import annotations

import math

from hybond.engine.algebra.blocks import Rows, fit_rows


def keep_sizes(rows: Rows, many: int, kept: Rows) -> None:
    """Keep the columns of so many rows, and what rounding of their coefficients is measured by."""
    fit_rows(kept, many, rows.first.at[many])
    for k in range(many + 1):
        kept.first.at[k] = rows.first.at[k]
    for i in range(rows.first.at[many]):
        kept.column.at[i] = rows.column.at[i]
        kept.size.at[i] = rows.size.at[i]


def take_lesser(rows: Rows, many: int, kept: Rows) -> None:
    """Measure rounding of coefficients by no more than was kept; columns are in order in both."""
    for k in range(many):
        at = kept.first.at[k]
        for i in range(rows.first.at[k], rows.first.at[k + 1]):
            own = math.fabs(rows.value.at[i])
            while at < kept.first.at[k + 1] and kept.column.at[at] < rows.column.at[i]:
                at += 1
            if at < kept.first.at[k + 1] and kept.column.at[at] == rows.column.at[i]:
                own = max(own, kept.size.at[at])
            rows.size.at[i] = min(rows.size.at[i], own)
