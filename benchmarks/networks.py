"""Networks of any size for the benchmarks, built as a modeller would build them."""

from __future__ import annotations

from collections.abc import Callable

import hybond as hb
from hybond.model.graph import FlatGraph


def rc_ladder(elements: int) -> FlatGraph:
    """A ladder of resistors and capacitors; every fifth rung has a switch in series.

    Another fifth has a switch in the resistor's branch: a tenth of all nodes are controlled.
    """
    m = hb.Model("rc_ladder")
    rungs = max(elements // 4, 5)
    m.add(V=hb.Se(1))
    last = "V"
    for k in range(rungs):
        m.add(**{f"j{k}": hb.One(), f"r{k}": hb.R(1), f"n{k}": hb.Zero(), f"c{k}": hb.C(1)})
        m.bond(f"{last} -> j{k} -> n{k}", f"j{k} -> r{k}")
        if k % 5 == 4:
            m.add(**{f"s{k}": hb.One()})
            m.bond(f"n{k} -> s{k} -> c{k}")
            _switch(m, f"s{k}")
        else:
            m.bond(f"n{k} -> c{k}")
        if k % 5 == 2:
            _switch(m, f"j{k}")
        last = f"n{k}"
    return m.flatten()


def grid(elements: int) -> FlatGraph:
    """A square grid of nodes with a capacitor each, joined by resistors and by ideal switches.

    Every fourth branch is a bare switch: where it closes, it ties two capacitors together.
    """
    m = hb.Model("grid")
    _grid(m, elements)
    return m.flatten()


def _grid(m: hb.Model, elements: int) -> None:
    side = max(round((elements / 6.0) ** 0.5), 2)
    for k in range(side * side):
        m.add(**{f"n{k}": hb.Zero()})
        if k % 3:
            m.add(**{f"c{k}": hb.C(1)})
            m.bond(f"n{k} -> c{k}")
        else:
            m.add(**{f"g{k}": hb.R(1)})
            m.bond(f"n{k} -> g{k}")
    for branch, (k, other) in enumerate(_neighbours(side)):
        name = f"b{k}_{other}"
        m.add(**{name: hb.One()})
        m.bond(f"n{k} -> {name} -> n{other}")
        if branch % 4 == 3:
            _switch(m, name)
        else:
            m.add(**{f"r{k}_{other}": hb.R(1)})
            m.bond(f"{name} -> r{k}_{other}")


def _neighbours(side: int) -> list[tuple[int, int]]:
    """List the pairs of neighbours on a square grid."""
    found = []
    for k in range(side * side):
        if (k + 1) % side:
            found.append((k, k + 1))
        if k + side < side * side:
            found.append((k, k + side))
    return found


def clutches(elements: int) -> FlatGraph:
    """A chain of masses; every third joint is a clutch, the others are springs."""
    m = hb.Model("clutches")
    masses = max(elements // 4, 4)
    for k in range(masses):
        m.add(**{f"v{k}": hb.One(), f"m{k}": hb.I(1)})
        m.bond(f"v{k} -> m{k}")
        if k:
            m.add(**{f"z{k}": hb.Zero()})
            m.bond(f"v{k - 1} -> z{k} -> v{k}")
            if k % 3 == 0:
                _switch(m, f"z{k}")
            else:
                m.add(**{f"c{k}": hb.C(1)})
                m.bond(f"z{k} -> c{k}")
    return m.flatten()


def gears(elements: int) -> FlatGraph:
    """A chain of transformers and gyrators with masses, brakes and clutches between them."""
    m = hb.Model("gears")
    stages = max(elements // 5, 4)
    m.add(V=hb.Se(1), v0=hb.One(), r0=hb.R(1))
    m.bond("V -> v0 -> r0")
    for k in range(1, stages):
        m.add(**{f"t{k}": hb.GY(2) if k % 4 == 0 else hb.TF(2), f"v{k}": hb.One()})
        m.add(**{f"m{k}": hb.I(1), f"z{k}": hb.Zero()})
        m.bond(f"v{k - 1} -> z{k} -> t{k} -> v{k} -> m{k}")
        m.add(**{f"c{k}": hb.C(1) if k % 2 else hb.R(1)})
        m.bond(f"z{k} -> c{k}")
        if k % 2 == 0:
            _switch(m, f"z{k}")
    return m.flatten()


def capacitors(elements: int) -> FlatGraph:
    """A square mesh of ideal capacitors: of each loop one is in derivative causality.

    Every fifth branch is switched. Nothing here can give way, so most searches fail.
    """
    m = hb.Model("capacitors")
    side = max(round((elements / 5.0) ** 0.5), 2)
    for k in range(side * side):
        m.add(**{f"n{k}": hb.Zero()})
    for branch, (k, other) in enumerate(_neighbours(side)):
        name = f"b{k}_{other}"
        m.add(**{name: hb.One(), f"c{k}_{other}": hb.C(1)})
        m.bond(f"n{k} -> {name} -> n{other}", f"{name} -> c{k}_{other}")
        if branch % 5 == 4 or side == 2:
            _switch(m, name)
    return m.flatten()


def two_supplies(elements: int) -> FlatGraph:
    """A grid, and somewhere in it two supplies on one node, both behind switches."""
    m = hb.Model("two_supplies")
    _grid(m, elements)
    m.add(V=hb.Se(12), W=hb.Se(24), p=hb.One(), q=hb.One(), rail=hb.Zero(), feed=hb.One())
    m.add(feeder=hb.R(1))
    m.bond("V -> p -> rail", "W -> q -> rail", "rail -> feed -> n5", "feed -> feeder")
    _switch(m, "p")
    _switch(m, "q")
    return m.flatten()


FAMILIES: dict[str, Callable[[int], FlatGraph]] = {
    "RC ladder": rc_ladder,
    "grid": grid,
    "clutches": clutches,
    "gears": gears,
    "capacitors": capacitors,
}


def _switch(m: hb.Model, junction: str) -> None:
    m.machine(f"S_{junction}", states={"open": [], "closed": [junction]}, start="open")
