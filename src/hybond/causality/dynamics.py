"""Dynamic causality: which strokes follow the mode, through what, and which never move.

Three answers per bond. *Invariant* is proved, by propagating only what holds in all modes.
*Dynamic* is seen: a switching flips the stroke (drawn dashed; R. Margetts and R. F. Ngwompo).
*Kept* is neither: no examined mode flips it. Examined are all states of each machine by itself,
from the reference mode, and all modes of small regions and of neighbours; then all modes of the
graph if they are few, else the first ones that its machines reach.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping
from typing import Literal

from hybond.causality.arrays import Arrays, compile_arrays
from hybond.causality.reachable import reachable
from hybond.causality.record import Causality
from hybond.causality.reference import Reference, reference_mode
from hybond.causality.strokes import Strokes
from hybond.model.graph import FlatGraph, Mode
from hybond.model.joined import Joined
from hybond.records import dataclass
from hybond.uncollected import uncollected

Kind = Literal["invariant", "dynamic", "kept"]

WHOLE = 16
"""Modes of one region up to which all of them are examined."""
FEW = 64
"""Modes of the graph up to which all of them are examined; so many reachable ones, if not."""


@dataclass(frozen=True, slots=True)
class Region:
    """Dynamic bonds that hang together, or are moved by the same switch."""

    bonds: tuple[int, ...]
    """The bonds, sorted."""
    switches: tuple[int, ...]
    """The controlled nodes that move them, sorted."""
    whole: bool
    """Whether all modes of its machines were examined, the others being in reference state."""


@dataclass(frozen=True, slots=True)
class Dynamics:
    """How the causality of a graph depends on its mode."""

    reference: Reference
    """The mode that the others were compared with."""
    kinds: tuple[Kind, ...]
    """Per bond: proved the same in every mode that has a causality; different in some examined
    mode; neither."""
    through: Mapping[int, tuple[int, ...]]
    """Dynamic bond to the controlled nodes whose switching flips it."""
    storages: tuple[int, ...]
    """Dynamic storages: integral in some examined mode and derivative in another."""
    regions: tuple[Region, ...]
    """The dynamic bonds, in connected groups."""
    without: tuple[tuple[int, int], ...] = ()
    """Machines and states that, entered from the reference mode, have no causality."""
    examined: int = 0
    """Modes that were examined besides the reference."""

    @property
    def invariant(self) -> tuple[int, ...]:
        """The bonds that are proved to keep their stroke in every mode."""
        return tuple(b for b, kind in enumerate(self.kinds) if kind == "invariant")

    @property
    def dynamic(self) -> tuple[int, ...]:
        """The bonds whose stroke changes in some examined mode."""
        return tuple(b for b, kind in enumerate(self.kinds) if kind == "dynamic")

    @property
    def kept(self) -> tuple[int, ...]:
        """The bonds that no examined mode flips, though nothing proves that none does."""
        return tuple(b for b, kind in enumerate(self.kinds) if kind == "kept")


@uncollected
def dynamics(
    graph: FlatGraph, reference: Reference | None = None, *, arrays: Arrays | None = None
) -> Dynamics:
    """Classify every bond of `graph` by how its stroke follows the mode.

    Parameters
    ----------
    reference : Reference, optional
        The mode to compare with; without it `reference_mode` finds it.
    arrays : Arrays, optional
        The compiled graph.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("chopper")
    >>> m.add(V=hb.Se(10), sw=hb.One(), j=hb.Zero(), r=hb.R(1), c=hb.C(1))
    >>> m.bond("V -> sw -> j -> c", "sw -> r")
    >>> m.machine("S", states={"closed": ["sw"], "open": []}, start="closed")
    >>> graph = m.flatten()
    >>> found = dynamics(graph)
    >>> found.kinds
    ('invariant', 'kept', 'kept', 'dynamic')
    >>> [[graph.nodes[n].path for n in found.through[b]] for b in found.dynamic]
    [['sw']]
    """
    arrays = arrays or compile_arrays(graph)
    reference = reference or reference_mode(graph, arrays=arrays)
    walk = _Walk(graph, reference.mode, arrays)
    for m, sets in enumerate(arrays.on):
        for k in range(len(sets)):
            if k != reference.mode[m] and sets[k] != sets[reference.mode[m]]:
                walk.visit({m: k})
    whole: set[frozenset[int]] = set()
    for machines in _together(arrays, walk):
        states = [range(len(arrays.on[m])) for m in machines]
        count = 1
        for each in states:
            count *= len(each)
        if count <= WHOLE:
            whole.add(frozenset(machines))
            modes = (
                {m: k for m, k in zip(machines, mode, strict=True) if k != reference.mode[m]}
                for mode in itertools.product(*states)
            )
            # Few changes first: a bond is then put down to the fewest switches that flip it.
            for mode in sorted((m for m in modes if len(m) > 1), key=len):
                walk.visit(mode)
    for mode in _further(graph, reference.mode, arrays):
        walk.visit(mode)
    kinds: list[Kind] = ["kept"] * arrays.bonds
    for bond, _ in unchanging(graph, arrays):
        kinds[bond] = "invariant"
    for bond in walk.through:
        kinds[bond] = "dynamic"
    regions = tuple(
        Region(bonds, switches, len(owners) == 1 or owners in whole)
        for bonds, switches in _regions(arrays, walk.through)
        for owners in (frozenset(walk.owner[v] for v in switches),)
    )
    return Dynamics(
        reference=reference,
        kinds=tuple(kinds),
        through={bond: tuple(sorted(walk.through[bond])) for bond in sorted(walk.through)},
        storages=tuple(sorted(walk.storages)),
        regions=regions,
        without=tuple(walk.without),
        examined=walk.examined,
    )


def causality_of(
    graph: FlatGraph,
    mode: Mode,
    *,
    reference: Reference | None = None,
    arrays: Arrays | None = None,
) -> Causality:
    """Return the causality of `mode` that differs little from that of the reference mode.

    Only paths from what switched are flipped, each the shortest there is. The result depends on
    the two modes only, not on any modes between them.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("clutch")
    >>> m.add(a=hb.I(1), v=hb.One(), clutch=hb.Zero(), w=hb.One(), b=hb.I(2))
    >>> m.bond("v -> a", "v -> clutch -> w -> b")
    >>> m.machine("S", states={"engaged": ["clutch"], "open": []}, start="open")
    >>> graph = m.flatten()
    >>> best = reference_mode(graph)
    >>> here = causality_of(graph, (0,), reference=best)
    >>> [b.name for b in graph.bonds if here.strokes[b.index] != best.causality.strokes[b.index]]
    ['v -> a', 'v -> clutch']
    """
    arrays = arrays or compile_arrays(graph)
    reference = reference or reference_mode(graph, arrays=arrays)
    strokes = Strokes(graph, reference.mode, arrays=arrays)
    strokes.switch(mode)
    return strokes.record()


def _further(graph: FlatGraph, start: Mode, arrays: Arrays) -> list[dict[int, int]]:
    """List modes by what differs from `start`, several machines in each, few changes first."""
    count = 1
    for sets in arrays.on:
        count *= len(sets)
        if count > FEW:
            break
    modes: Iterable[Mode]
    if count <= FEW:
        modes = itertools.product(*(range(len(sets)) for sets in arrays.on))
    elif len(arrays.on) <= FEW:
        modes = reachable(graph, limit=FEW).modes
    else:
        return []
    found = [{m: k for m, k in enumerate(mode) if k != start[m]} for mode in modes]
    return sorted((mode for mode in found if len(mode) > 1), key=len)


class _Walk:
    """Modes visited from the reference, one after another, each taken back at once."""

    def __init__(self, graph: FlatGraph, mode: Mode, arrays: Arrays) -> None:
        self.arrays = arrays
        self.strokes = Strokes(graph, mode, arrays=arrays)
        self.late = frozenset(self.strokes.derivative)
        self.through: dict[int, set[int]] = {}
        self.storages: set[int] = set()
        self.without: list[tuple[int, int]] = []
        self.examined = 0
        self.owner = {v: m for m, sets in enumerate(arrays.on) for on in sets for v in on}
        self.visited: set[frozenset[tuple[int, int]]] = set()

    def visit(self, states: Mapping[int, int]) -> None:
        """Put some machines into other states, note what flips, and go back."""
        strokes, sets = self.strokes, self.arrays.on
        if frozenset(states.items()) in self.visited:
            return
        self.visited.add(frozenset(states.items()))
        toggled: set[int] = set()
        for m, k in states.items():
            toggled |= sets[m][k] ^ sets[m][strokes.states[m]]
        flipped = strokes.turn(states)
        self.examined += 1
        if strokes.conflict:
            if len(states) == 1:
                self.without += states.items()
        else:
            for bond in flipped:
                if len(states) == 1:
                    self.through.setdefault(bond, set()).update(toggled)
                elif bond not in self.through:
                    self.through[bond] = set(toggled)
                if bond in self.arrays.stored:
                    self.storages.update(
                        k
                        for k in self.arrays.stored[bond]
                        if (k in self.late) != strokes.is_derivative(k)
                    )
        strokes.undo()


def unchanging(graph: FlatGraph, arrays: Arrays | None = None) -> list[tuple[int, int]]:
    """List the bonds whose stroke is forced in every mode, with that stroke.

    Sources, fixed laws and pins; what they force through junctions that are not controlled; and
    through a controlled junction only what both its settings force: once it is known that it
    has its cause, that its other bonds are none.
    """
    arrays = arrays or compile_arrays(graph)
    always = [bool(near) for near in arrays.near[: arrays.nodes]]
    found: dict[int, int] = {}
    for v in arrays.off:
        always[v] = False
    for sets in arrays.on:
        for v in frozenset(sets[0]).intersection(*sets):
            always[v] = True
    ever = frozenset().union(*(on for sets in arrays.on for on in sets))
    for bond, stroke in arrays.fixed + sorted(graph.pins.items()):
        found.setdefault(bond, stroke)
    for v, given in arrays.off.items():
        if v not in ever:
            for bond, stroke in given:
                found.setdefault(bond, stroke)
    ends = [graph.nodes[v].ends for v in range(arrays.nodes)]
    unknown = [len(e) for e in ends]
    caused = [False] * arrays.nodes
    queue = list(found)
    for bond in queue:
        for v in (arrays.tail[bond], arrays.head[bond]):
            if not arrays.near[v] or (v in arrays.off and v not in ever):
                continue
            unknown[v] -= 1
            cause = arrays.cause_stroke(bond, v) == found[bond]
            if cause:
                caused[v] = True
            if not cause and (unknown[v] != 1 or caused[v]):
                continue
            when_off = None if always[v] else dict(arrays.off[v])
            for end in ends[v]:
                if end.bond not in found:
                    own = arrays.cause_stroke(end.bond, v)
                    stroke = 1 - own if cause else own
                    if when_off is None or when_off[end.bond] == stroke:
                        found[end.bond] = stroke
                        queue.append(end.bond)
    return sorted(found.items())


def _together(arrays: Arrays, walk: _Walk) -> list[tuple[int, ...]]:
    """List the machines of each region, and of each two regions that a bond joins."""
    groups: list[set[int]] = []
    region: dict[int, int] = {}
    for bonds, switches in _regions(arrays, walk.through):
        for bond in bonds:
            for v in (arrays.tail[bond], arrays.head[bond]):
                region[v] = len(groups)
        groups.append({walk.owner[v] for v in switches})
    joined: dict[tuple[int, ...], None] = {}
    for group in groups:
        if len(group) > 1:
            joined[tuple(sorted(group))] = None
    for a, b in zip(arrays.tail, arrays.head, strict=True):
        if a in region and b in region and region[a] != region[b]:
            joined[tuple(sorted(groups[region[a]] | groups[region[b]]))] = None
    return list(joined)


def _regions(
    arrays: Arrays, through: Mapping[int, set[int]]
) -> list[tuple[tuple[int, ...], tuple[int, ...]]]:
    """Group dynamic bonds that share a node or a switch; bonds and switches of each group."""
    joined: Joined[int] = Joined()
    for bond, switches in through.items():
        joined.join((arrays.tail[bond], arrays.head[bond], *switches))
    bonds: dict[int, list[int]] = {}
    moved: dict[int, set[int]] = {}
    for bond in sorted(through):
        root = joined.root(arrays.tail[bond])
        bonds.setdefault(root, []).append(bond)
        moved.setdefault(root, set()).update(through[bond])
    return [(tuple(bonds[root]), tuple(sorted(moved[root]))) for root in bonds]
