"""Equal parts of a graph: phases, legs, cells, wheels, which are drawn alike and in a row.

Nodes are told apart by their kinds and, again and again, by their neighbours (the colour refinement
of B. Weisfeiler and A. Leman, 1968). What is left when the nodes that are like no other are taken
out falls into pieces; pieces of one colouring that hang on the same nodes in the same way are legs.
"""

from __future__ import annotations

from collections.abc import Sequence

Leg = tuple[int, ...]
"""Its nodes, in an order that is the same for every leg of a group."""

_EFFORT = 4000
"""Nodes that may be tried in comparing two pieces."""


def legs_of(kinds: Sequence[str], bonds: Sequence[tuple[int, int]]) -> list[list[Leg]]:
    """Return groups of equal pieces of a connected graph, the largest pieces first.

    A piece has at least two nodes: one-ports at one junction are no legs. Where bonds have the
    same directions there may be legs in a ring, each joined to the next. Else the direction does
    not count, as for the two legs of a bridge, which lie between the same two nodes.

    Examples
    --------
    A junction with two branches, a resistor and a coil in each:

    >>> kinds = ["0", "1", "R", "I", "1", "R", "I", "C"]
    >>> legs_of(kinds, [(0, 1), (1, 2), (1, 3), (0, 4), (4, 5), (4, 6), (0, 7)])
    [[(1, 2, 3), (4, 5, 6)]]
    """
    groups = _groups(kinds, _ways(len(kinds), bonds, (1, 2)), hubs=0)
    if not groups:
        groups = _groups(kinds, _ways(len(kinds), bonds, (1, 1)), hubs=2)
    groups.sort(key=lambda g: -len(g[0]))
    return groups


def _ways(
    size: int, bonds: Sequence[tuple[int, int]], marks: tuple[int, int]
) -> list[dict[int, int]]:
    """Return the neighbours of each node, with a mark for bonds that leave and that come."""
    ways: list[dict[int, int]] = [{} for _ in range(size)]
    for tail, head in bonds:
        ways[tail][head] = ways[tail].get(head, 0) | marks[0]
        ways[head][tail] = ways[head].get(tail, 0) | marks[1]
    return ways


def _groups(kinds: Sequence[str], ways: Sequence[dict[int, int]], *, hubs: int) -> list[list[Leg]]:
    """Return groups of legs that hang on at least so many nodes which are like no other."""
    size = len(kinds)
    colours = _colours(kinds, ways)
    count: dict[int, int] = {}
    for c in colours:
        count[c] = count.get(c, 0) + 1
    unique = {n for n in range(size) if count[colours[n]] == 1}
    pieces = _pieces(ways, set(range(size)) - unique)
    groups = []
    for alike in _alike(pieces, colours):
        group = _matched(alike, ways, colours, unique)
        if len(group) > 1:
            groups.append(group)
            continue
        for piece in alike:
            ring = _ring(piece, ways, colours, unique)
            if ring:
                groups.append(ring)
    return [g for g in groups if len({m for n in g[0] for m in ways[n]} & unique) >= hubs]


def _alike(pieces: Sequence[Sequence[int]], colours: Sequence[int]) -> list[list[Sequence[int]]]:
    """Return pieces of more than one node, those of the same colours together."""
    found: dict[tuple[int, ...], list[Sequence[int]]] = {}
    for piece in pieces:
        if len(piece) > 1:
            found.setdefault(tuple(sorted(colours[n] for n in piece)), []).append(piece)
    return list(found.values())


def _matched(
    alike: Sequence[Sequence[int]],
    ways: Sequence[dict[int, int]],
    colours: Sequence[int],
    unique: set[int],
) -> list[Leg]:
    first = _order(alike[0], ways)
    group = [tuple(first)]
    for other in alike[1:]:
        match = _match(first, set(other), ways, colours, unique)
        if match is not None:
            group.append(match)
    return group


def _ring(
    piece: Sequence[int],
    ways: Sequence[dict[int, int]],
    colours: Sequence[int],
    unique: set[int],
) -> list[Leg]:
    """Return the legs into which a piece falls without the nodes of one colour, the largest."""
    best: list[Leg] = []
    for colour in dict.fromkeys(colours[n] for n in piece if len(ways[n]) > 1):
        links = {n for n in piece if colours[n] == colour}
        rest = _alike(_pieces(ways, set(piece) - links), colours)
        for alike in rest:
            if len(alike) < 2 or 2 * sum(map(len, alike)) < len(piece):
                continue
            group = _matched(alike, ways, colours, unique)
            if len(group) > 1 and len(group) * len(group[0]) > sum(map(len, best)):
                best = group
    return best


def _colours(kinds: Sequence[str], ways: Sequence[dict[int, int]]) -> list[int]:
    """Return a number for each node, the same for nodes that look the same from everywhere."""
    names = {k: n for n, k in enumerate(sorted(set(kinds)))}
    colours = [names[k] for k in kinds]
    amount = len(set(colours))
    while True:
        seen = [
            (colours[n], tuple(sorted((way, colours[m]) for m, way in ways[n].items())))
            for n in range(len(kinds))
        ]
        numbers = {key: n for n, key in enumerate(sorted(set(seen)))}
        colours = [numbers[key] for key in seen]
        if len(numbers) == amount:
            return colours
        amount = len(numbers)


def _pieces(ways: Sequence[dict[int, int]], within: set[int]) -> list[list[int]]:
    """Return the connected pieces of the nodes `within`."""
    left = set(within)
    found = []
    for start in sorted(within):
        if start not in left:
            continue
        left.discard(start)
        piece, new = [start], [start]
        while new:
            node = new.pop()
            for m in ways[node]:
                if m in left:
                    left.discard(m)
                    piece.append(m)
                    new.append(m)
        found.append(sorted(piece))
    return found


def _order(piece: Sequence[int], ways: Sequence[dict[int, int]]) -> list[int]:
    """Return the nodes so that each but the first is joined to one before it."""
    inside = set(piece)
    start = min(piece, key=lambda n: (-len(ways[n]), n))
    order, seen = [start], {start}
    for node in order:
        for m in sorted(ways[node], key=lambda m: (-len(ways[m]), m)):
            if m in inside and m not in seen:
                seen.add(m)
                order.append(m)
    return order


def _match(
    first: Sequence[int],
    other: set[int],
    ways: Sequence[dict[int, int]],
    colours: Sequence[int],
    unique: set[int],
) -> Leg | None:
    """Return the nodes of `other` in the order of `first`, None if they are joined otherwise.

    Of what is outside of both only the nodes count that are like no other.
    """
    place = {n: k for k, n in enumerate(first)}
    before = [
        [(place[m], w) for m, w in ways[n].items() if place.get(m, k) < k]
        for k, n in enumerate(first)
    ]
    outside = [{m: w for m, w in ways[n].items() if m in unique} for n in first]
    inner = [sum(m in place for m in ways[n]) for n in first]
    chosen: list[int] = []
    tried: list[list[int]] = []
    effort = _EFFORT

    def fits(k: int, m: int) -> bool:
        if m not in other or m in chosen or colours[m] != colours[first[k]]:
            return False
        out = {o: w for o, w in ways[m].items() if o in unique}
        if out != outside[k] or sum(o in other for o in ways[m]) != inner[k]:
            return False
        return all(ways[m].get(chosen[j]) == w for j, w in before[k])

    def options(k: int) -> list[int]:
        near = ways[chosen[before[k][0][0]]] if before[k] else other
        return [m for m in sorted(near, reverse=True) if fits(k, m)]

    tried.append(options(0))
    while tried and effort:
        effort -= 1
        if not tried[-1]:
            tried.pop()
            if chosen:
                chosen.pop()
            continue
        chosen.append(tried[-1].pop())
        if len(chosen) == len(first):
            return tuple(chosen)
        tried.append(options(len(chosen)))
    return None
