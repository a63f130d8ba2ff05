"""Guards as they are while time passes: what a locator follows."""

from __future__ import annotations

from hybond.model.expressions import (
    Binary,
    Compare,
    Expr,
    Pre,
    comparisons,
    transform,
)


def seen_in_motion(asked: Expr) -> tuple[Expr, list[Expr]]:
    """Return a guard as it is while time passes, and the differences of its comparisons."""
    guard = transform(asked, _without_pre)
    compared = [c for c in comparisons(guard) if isinstance(c, Compare)]
    return guard, [Binary("-", c.left, c.right) for c in compared]


def _without_pre(e: Expr) -> Expr:
    return e.arg if isinstance(e, Pre) else e
