"""Masses with springs and dampers between them, hung on a wall, each pulled by 1 N."""

from __future__ import annotations

import numpy as np
from measuring.restarts import Vector

import hybond as hb

STIFF, DAMPED, PULL = 1000.0, 1.0, 1.0


def chain(masses: int, cubic: float = 0.0) -> hb.Model:
    """Return the chain; junction ``v3`` has the velocity of the third mass."""
    m = hb.Model("chain", domain="translational")
    spring = {"e": f"{STIFF}*q + {cubic}*q^3"} if cubic else 1.0 / STIFF
    for k in range(1, masses + 1):
        m.add(
            **{
                f"v{k}": hb.One(),
                f"m{k}": hb.I(1.0),
                f"F{k}": hb.Se(PULL),
                f"d{k}": hb.Zero(),
                f"link{k}": hb.One(),
                f"k{k}": hb.C(spring),
                f"b{k}": hb.R(DAMPED),
            }
        )
        m.bond(f"F{k} -> v{k} -> m{k}", f"v{k} -> d{k}", f"d{k} -> link{k} -> k{k}")
        m.bond(f"link{k} -> b{k}")
        if k > 1:
            m.bond(f"d{k} -> v{k - 1}")
    return m


def links(q: Vector, v: Vector, cubic: float = 0.0) -> tuple[Vector, Vector]:
    """Return the rates of stretches and velocities."""
    stretch = np.diff(v, prepend=0.0)
    pull = STIFF * q + cubic * q**3 + DAMPED * stretch
    return stretch, PULL + np.append(pull[1:], 0.0) - pull
