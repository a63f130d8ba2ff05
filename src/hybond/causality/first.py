"""A first matching: storages, then whatever has one way left; paths do the rest.

Taking first what has one way left is nearly always best (R. M. Karp and M. Sipser, *Maximum
matchings in sparse random graphs*, Foundations of Computer Science 1981).
"""

from __future__ import annotations

from heapq import heapify, heappop, heappush

from hybond.causality.arrays import BARE, LEAF, MIDDLE, Arrays
from hybond.causality.matching import EXPOSED, Matching


def first_matching(m: Matching) -> list[int]:
    """Match what is easy to match, and set the strokes; return the vertices without a cause.

    Leaves are matched only for storages that want it and for resistors; optional vertices not.
    """
    _storages(m)
    near, mate, free = m.arrays.near, m.mate, m.free
    must = [v for v in range(len(near)) if mate[v] == EXPOSED and near[v] and not m.optional[v]]
    ways = {v: 0 for v in must}
    for v in must:
        ways[v] = sum(
            1
            for bond, w in near[v]
            if free[bond] and mate[w] == EXPOSED and (w in ways or _is_resistor(m.arrays, w))
        )
    tight = [v for v in must if ways[v] == 1]
    heapify(tight)
    rest = iter(must)
    while (v := heappop(tight) if tight else next(rest, -1)) >= 0:
        if mate[v] != EXPOSED:
            continue
        bond, w = _partner(m, ways, v)
        if w < 0:
            continue
        _match(m, v, w, bond)
        for x in (v, w):
            for bond, y in near[x]:
                if free[bond] and y in ways and mate[y] == EXPOSED:
                    ways[y] -= 1
                    if ways[y] == 1:
                        heappush(tight, y)
    _set_strokes(m)
    return [v for v in must if mate[v] == EXPOSED]


def _storages(m: Matching) -> None:
    """Match the storages that are the cause of their junction in integral causality, in order."""
    arrays = m.arrays
    for bond, want in arrays.stores:
        if arrays.form[bond] == LEAF and m.free[bond]:
            leaf = arrays.nodes + bond
            ((_, v),) = arrays.near[leaf]
            if m.mate[v] == EXPOSED and arrays.cause_stroke(bond, v) == want:
                _match(m, v, leaf, bond)


def _match(m: Matching, v: int, w: int, bond: int) -> None:
    m.mate[v], m.mate[w] = w, v
    m.via[v] = m.via[w] = bond


def _is_resistor(arrays: Arrays, v: int) -> bool:
    """Whether `v` is the leaf of a resistor, which can be matched at no price."""
    return v >= arrays.nodes and arrays.law[v - arrays.nodes] >= 0


def _partner(m: Matching, ways: dict[int, int], v: int) -> tuple[int, int]:
    """Return a bond and the vertex to match `v` with: another that needs it, or a resistor."""
    arrays, mate, free = m.arrays, m.mate, m.free
    found = (-1, -1)
    for bond, w in arrays.near[v]:
        if not free[bond] or mate[w] != EXPOSED:
            continue
        if w in ways:
            return bond, w
        if _is_resistor(arrays, w) and (
            found[1] < 0 or arrays.law[bond] == arrays.cause_stroke(bond, v)
        ):
            found = bond, w
    return found


def _set_strokes(m: Matching) -> None:
    """Give each free bond the stroke that the matching says, or that its elements prefer."""
    arrays, mate, via, stroke = m.arrays, m.mate, m.via, m.stroke
    nodes, tail, head = arrays.nodes, arrays.tail, arrays.head
    at_tail, at_head, form = arrays.at_tail, arrays.at_head, arrays.form
    for bond in range(arrays.bonds):
        if not m.free[bond]:
            continue
        if form[bond] == BARE:
            wish = arrays.wish[bond]
            stroke[bond] = wish if wish >= 0 else max(arrays.law[bond], 0)
        elif form[bond] == MIDDLE:
            stroke[bond] = (at_tail if mate[nodes + bond] == tail[bond] else at_head)[bond]
        else:
            at_a_vertex = at_tail[bond] >= 0
            v = (tail if at_a_vertex else head)[bond]
            cause = (at_tail if at_a_vertex else at_head)[bond]
            stroke[bond] = cause if mate[v] >= 0 and via[v] == bond else 1 - cause
