"""The same graph declared in many orders: elements and bonds, drawn by seeds."""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence

import hybond as hb


def in_orders(parts: Mapping[str, object], bonds: Sequence[str], many: int = 8) -> list[hb.Model]:
    """The model declared in so many orders."""
    made = []
    for seed in range(many):
        draw = random.Random(seed)
        m = hb.Model("ordered")
        for name in draw.sample(sorted(parts), len(parts)):
            m.add(**{name: parts[name]})
        m.bond(*draw.sample(bonds, len(bonds)))
        made.append(m)
    return made
