"""How a `CrossCheck` shows itself: plain text."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hybond.names import in_columns
from hybond.units import format_quantity

if TYPE_CHECKING:
    from hybond.analysis.cross.check import CrossCheck

SHOWN = 6
"""Quantities listed, the worst first."""


def cross_text(found: CrossCheck) -> str:
    """Return a cross-check in words: the levels, the worst quantities, events, the verdict."""
    lines = [
        f"{found.engines[0]} and {found.engines[1]}, up to {format_quantity(found.until, 's')} "
        f"({found.chosen})"
    ]
    unit = "s" if found.refined == "step" else ""
    rows = [("  " + found.refined, "mean difference", "of", "order")]
    for level in found.levels:
        rows.append(
            (
                "  " + format_quantity(level.value, unit).strip(),
                f"{level.mean:.3g}",
                level.name or "nothing",
                "" if level.order is None or found.refined == "rtol" else f"{level.order:.2f}",
            )
        )
    lines += in_columns(rows)
    shown = found.differences[:SHOWN]
    if shown:
        rows = [("  worst at the last", "mean", "largest", "at t, s")]
        for d in shown:
            name = d.quantity.name
            if d.quantity.kind in ("common", "net"):
                name = f"integral of {name}"
            rows.append((f"  {name}", f"{d.mean:.3g}", f"{d.largest:.3g}", f"{d.time:.6g}"))
        lines += in_columns(rows)
    lines.append(_events(found))
    if found.shares:
        shares = ", ".join(f"{d.quantity.name} {d.mean:.2g}" for d in found.shares)
        lines.append(f"  need not be unique, do not count: integrals of {shares}")
    for reason in found.reasons:
        lines.append(f"  may differ from t = {reason.since:.6g} s on: {reason.name}: {reason.text}")
    lines.append(f"{found.verdict}: {found.why}")
    return "\n".join(lines)


def _events(found: CrossCheck) -> str:
    e = found.events
    if not e.first and not e.second:
        return "  no machine switches in either run"
    text = f"  {e.first} and {e.second} events of machines, {e.paired} alike and in order"
    if e.paired:
        apart = format_quantity(e.apart, "s")
        if found.refined == "step":
            apart = f"{e.apart / found.levels[-1].value:.2g} steps"
        text += f", at most {apart} apart" if e.apart else ", each within the step of the other"
    if e.parted is not None:
        text += f"; they part at t = {e.parted:.6g} s ({e.machine}: {' -> '.join(e.states)})"
    return text
