"""Random bond graphs some of whose junctions have laws."""

from __future__ import annotations

import numpy as np
from dense_oracle import Net, random_net

import hybond as hb


def law_net(seed: int, size: int, rings: int = 1, *, nonlinear: float = 0.0) -> Net:
    """Return a random net with controlled junctions."""
    return random_net(seed, size, rings=rings, controlled=0.6, nonlinear=nonlinear)


def law_model(net: Net, seed: int) -> hb.Model:
    """Return `net` with laws on its controlled junctions; some are left to a machine."""
    rng = np.random.default_rng(seed)
    m = hb.Model("net", parameters={"a": 1.25, "L": 0.5})
    for name, (kind, value) in net.nodes.items():
        if kind not in ("0", "1"):
            if kind in ("R", "C", "I") and not isinstance(value, tuple) and rng.random() < 0.3:
                m.add(**{name: getattr(hb, kind)(f"{value!r}*a")})
            else:
                m.add(**{name: net._part(name, kind, value)})
            continue
        junction = hb.Zero if kind == "0" else hb.One
        if name not in net.controlled:
            m.add(**{name: junction()})
        elif rng.random() < 0.2:
            m.add(**{name: junction()})
            m.machine(f"M_{name}", states={"off": [], "on": [name]}, start="off")
        else:
            m.add(**{name: _with_law(junction, rng)})
    m.bond(*(f"{a} -> {b}" for a, b in net.bonds))
    return m


def _with_law(junction, rng):
    match int(rng.integers(4)):
        case 0:
            return junction(law="diode")
        case 1:
            return junction(law="coulomb", limit="2*L", breakaway="3*L")
        case 2:
            return junction(law="unilateral", restitution=0.5)
        case _:
            return junction(law="relay", limit="L")
