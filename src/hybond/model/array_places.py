"""Where the members of arrays are drawn: in a row from where the array is put, or evenly between.

``"cell[1..n]" = [0, 0]`` puts the first member there and the others to its right. Where single
members are put, ``"cell[1]" = [0, 0]`` and ``"cell[n]" = [9, 3]``, those between two of them stand
evenly between.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import pairwise

from hybond.model.arrays import base_of
from hybond.model.indices import one, spread
from hybond.model.scope import Scope

PLACES = 200_000
"""Members that get a place."""
Place = tuple[float, float]
APART = 2.0
"""Cells from one member of a row to the next, beside what a submodel is wide."""


def places_of(
    layout: Mapping[str, Place], scope: Scope, width: Callable[[str], float]
) -> dict[str, Place]:
    """Return a layout with arrays member by member.

    Parameters
    ----------
    layout : mapping
        As written.
    width : callable
        From the name of an array to how many cells one of its members is wide.

    Examples
    --------
    >>> import hybond as hb
    >>> scope = Scope("", hb.Model())
    >>> places_of({"c[1..3]": (0, 1)}, scope, lambda name: 0.0)
    {'c[1]': (0.0, 1), 'c[2]': (2.0, 1), 'c[3]': (4.0, 1)}
    >>> places_of({"c[1]": (0, 0), "c[3]": (3, 4)}, scope, lambda name: 0.0)["c[2]"]
    (1.5, 2.0)
    """
    if not any("[" in key for key in layout):
        return dict(layout)
    found: dict[str, Place] = {}
    single: dict[str, dict[int, Place]] = {}
    where = "layout"
    for key, (x, y) in layout.items():
        if len(found) > PLACES:
            break  # of what nobody sees
        if ".." in key:
            step = APART + width(base_of(key))
            for k, name in enumerate(spread(key, scope, where)):
                found.setdefault(name, (x + k * step, y))
        elif "[" in key:
            name = one(key, scope, where)
            found[name] = (x, y)
            if name.endswith("]"):
                base, _, index = name.rpartition("[")
                single.setdefault(base, {})[int(index[:-1])] = (x, y)
        else:
            found[key] = (x, y)
    rows = {base_of(key) for key in layout if ".." in key}
    for base, at in single.items():
        for a, b in pairwise(sorted(at)) if base not in rows else ():
            (xa, ya), (xb, yb) = at[a], at[b]
            for k in range(a + 1, b):
                part = (k - a) / (b - a)
                found[f"{base}[{k}]"] = (xa + part * (xb - xa), ya + part * (yb - ya))
    return found
