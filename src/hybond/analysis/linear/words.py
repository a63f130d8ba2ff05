"""Units of quotients, matrices as tables of a page."""

from __future__ import annotations

import html
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray


def unit_over(above: str, below: str) -> str:
    """Return the unit of a quotient, empty where it has none."""
    if above == below:
        return ""
    bottom = f"({below})" if any(c in below for c in "*/") else below
    return f"{above or '1'}/{bottom}" if below else above


def table_of(name: str, m: NDArray[np.float64], rows: Sequence[str], columns: Sequence[str]) -> str:
    """Return a matrix with names of rows and columns in HTML, nothing if it has no entry."""
    if not m.size:
        return ""
    head = "".join(f"<th>{html.escape(c)}</th>" for c in columns)
    body = "".join(
        f"<tr><th>{html.escape(r)}</th>" + "".join(f"<td>{v:.6g}</td>" for v in row) + "</tr>"
        for r, row in zip(rows, m.tolist(), strict=True)
    )
    return f"<table><tr><th>{name}</th>{head}</tr>{body}</table>"
