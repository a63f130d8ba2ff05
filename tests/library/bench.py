"""A bench for ready parts: one circuit, its ports joined by bonds in every direction.

A port is a junction, and what it shares with a node of the model around it does not depend on where
the half arrow of the bond between them points. `every_way` draws these bonds both ways.
"""

import copy
from itertools import product

import hybond as hb

ALL_UP_TO = 4
"""Bonds up to which all combinations of directions are drawn."""


def every_way(model: hb.Model, *joints: str) -> list[hb.Model]:
    """Return copies of a model that differ in the directions of some bonds.

    Parameters
    ----------
    model : hb.Model
        All but those bonds. At least one end of each should be a junction whose other bonds are
        there, so that no source's flow changes its sign with the bond.
    *joints : str
        The bonds, without a direction: ``"n - load.plus"``.

    Returns
    -------
    list of hb.Model
        All combinations of up to four bonds; of more, all forward, all backward, and each bond
        alone against the others. The name of a model says how its bonds are drawn.

    Examples
    --------
    >>> m = hb.Model("divider", domain="electrical")
    >>> m.add(n=hb.Zero(), load=hb.Submodel("electrical.resistor"))
    >>> [way.name for way in every_way(m, "n - load.plus")]
    ['n -> load.plus', 'load.plus -> n']
    """
    ends = [[end.strip() for end in joint.split(" - ")] for joint in joints]
    found = []
    for turned in _ways(len(joints)):
        way = copy.deepcopy(model)
        bonds = [f"{b} -> {a}" if turn else f"{a} -> {b}" for (a, b), turn in zip(ends, turned)]
        way.bond(*bonds)
        way.name = ", ".join(bonds)
        found.append(way)
    return found


def _ways(number: int) -> list[tuple[bool, ...]]:
    if number <= ALL_UP_TO:
        return list(product((False, True), repeat=number))
    alone = [tuple(k == turned for k in range(number)) for turned in range(number)]
    return [(False,) * number, (True,) * number, *alone]
