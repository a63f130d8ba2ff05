"""Random passive networks with ideal diodes, and random rows of masses that knock together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import hybond as hb

BRANCHES = ("R", "C", "L", "LC", "D", "D", "DR", "S")
"""What a branch is made of in series; diodes twice as often, S an ideal switch with a schedule."""
DRIVEN = ("UR", "JR")
"""A voltage source with a resistor; constant or a sine."""


def network(seed: int, *, sources: bool, starts: int = 0) -> hb.Model:
    """Return a network with 2 to 4 nodes besides ground.

    Every bond may point either way, and stored quantities start anywhere: also where the diodes and
    the network do not let them stay. `starts` gives other starts to the same network.
    """
    rng = np.random.default_rng(seed)
    other = np.random.default_rng([seed, starts])
    nodes = int(rng.integers(2, 5))
    branches = int(rng.integers(nodes + 1, 2 * nodes + 4))
    m = hb.Model("net", domain="electrical")
    m.add(**{f"n{k}": hb.Zero() for k in range(1, nodes + 1)})

    def size() -> float:
        return float(np.round(10.0 ** rng.uniform(-0.5, 0.5), 3))

    for j in range(branches):
        if j < nodes:
            ends = [int(rng.integers(0, j + 1)), j + 1]
        else:
            ends = [int(k) for k in rng.choice(nodes + 1, 2, replace=False)]
        if rng.random() < 0.5:
            ends.reverse()
        kind = str(rng.choice(BRANCHES + DRIVEN if sources else BRANCHES))
        junction = f"b{j}"
        m.add(**{junction: hb.One(law="diode") if "D" in kind else hb.One()})
        path = [f"n{ends[0]}" if ends[0] else "", junction, f"n{ends[1]}" if ends[1] else ""]
        m.bond(" -> ".join(p for p in path if p))
        for letter in kind:
            name = f"{letter}{j}"
            if letter == "R":
                part = hb.R(size())
            elif letter == "C":
                part = hb.C(size(), e=float(np.round(other.uniform(-2, 2), 2)))
            elif letter == "L":
                part = hb.I(size(), f=float(np.round(other.uniform(-2, 2), 2)))
            elif letter == "U":
                part = hb.Se(size())
            elif letter == "J":
                part = hb.Se(f"{size()}*sin({3 * size()}*time + {size()})")
            else:
                continue
            m.add(**{name: part})
            m.bond(f"{junction} -> {name}" if rng.random() < 0.7 else f"{name} -> {junction}")
        if kind == "S":
            on = float(np.round(rng.uniform(0.2, 1.5), 2))
            off = float(np.round(on + rng.uniform(0.2, 1.5), 2))
            m.machine(
                f"S{j}",
                states={"open": [], "closed": [junction]},
                start="open" if rng.random() < 0.5 else "closed",
                rules=[
                    f"open -> closed when time >= {on} and time < {off}",
                    f"closed -> open when time < {on} or time >= {off}",
                ],
            )
    return m


@dataclass(frozen=True)
class Row:
    """Masses on a line, in order, with contacts between neighbours.

    Springs, if any, join a mass to a wall of its own; `stiffness` is zero where there is none.
    """

    mass: tuple[float, ...]
    place: tuple[float, ...]
    speed: tuple[float, ...]
    stiffness: tuple[float, ...]
    restitution: float

    def model(self) -> hb.Model:
        """Return the bond graph."""
        m = hb.Model("row", domain="translational")
        for k, (mass, x, v, stiff) in enumerate(
            zip(self.mass, self.place, self.speed, self.stiffness, strict=True)
        ):
            m.add(**{f"m{k}": hb.I(mass, f=v), f"v{k}": hb.One()})
            m.bond(f"v{k} -> m{k}")
            m.signal(**{f"x{k}": hb.Integral(f"v{k}.f", start=x)})
            if stiff:
                m.add(**{f"s{k}": hb.C(1.0 / stiff)})
                m.bond(f"v{k} -> s{k}")
        for k in range(len(self.mass) - 1):
            law = hb.Zero(law="unilateral", gap=f"x{k + 1} - x{k}", restitution=self.restitution)
            m.add(**{f"c{k}": law})
            m.bond(f"v{k} -> c{k} -> v{k + 1}")
        return m


def row(seed: int, *, equal: bool = False, springs: bool = False) -> Row:
    """Return a random row of 2 to 4 masses with gaps of at least 0.2 m."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 5))

    def draw(low: float, high: float) -> tuple[float, ...]:
        return tuple(float(a) for a in np.round(rng.uniform(low, high, n), 3))

    return Row(
        (1.0,) * n if equal else draw(0.3, 3.0),
        tuple(float(a) for a in np.round(np.cumsum(rng.uniform(0.2, 1.0, n)), 3)),
        draw(-2.0, 2.0),
        tuple(float(a) if springs else 0.0 for a in np.round(rng.uniform(2.0, 20.0, n), 2)),
        1.0 if equal else float(np.round(rng.uniform(0.0, 1.0), 2)),
    )
