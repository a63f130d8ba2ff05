"""A choice of strokes that is mended when a few vertices switch, not made again."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence

from hybond.causality.arrays import EDGE, LEAF, MIDDLE, Arrays
from hybond.causality.assignment import Assignment
from hybond.causality.forest import Forest
from hybond.causality.matching import EXPOSED, SETTLED


class LiveAssignment(Assignment):
    """An assignment that follows its vertices when they are switched ON or OFF.

    Parameters
    ----------
    arrays, off, pins, either
        As for `Assignment`.

    Notes
    -----
    A change is `begin`, any number of `turn` and `decide`, then `settle`. After it as many
    storages are in integral causality as from scratch; the choice itself is the nearest found.
    """

    def __init__(
        self,
        arrays: Arrays,
        *,
        off: Collection[int] = (),
        pins: Mapping[int, int] | None = None,
        either: Sequence[int] = (),
    ) -> None:
        super().__init__(arrays, off=off, pins=pins, either=either)
        self._loose: list[int] = []
        """Vertices that may have lost their cause."""
        self._slow: list[int] = []
        """Storages that may be in derivative causality without need."""
        self._eased: list[int] = []
        """Vertices that no fixed bond is the cause of any more."""
        self._kept = set(self.exposed)

    def begin(self) -> None:
        """Start a change that `undo` takes back; what was done before stays."""
        self.soft.trim()
        self.hard.trim()
        self._forget()
        self._kept = set(self.exposed)

    def undo(self) -> None:
        """Take back, bit for bit, all that was done since `begin`."""
        m = self.matching
        for place, index, value in reversed(m.log):
            place[index] = value
        for bond, stroke in m.before.items():
            m.stroke[bond] = stroke
        for bond in m.before:
            self._status(bond)
        self.exposed = self._kept
        self._forget()

    def changed(self) -> tuple[int, ...]:
        """Return the bonds whose stroke differs from what it was at `begin`."""
        m = self.matching
        return tuple(sorted(b for b, stroke in m.before.items() if m.stroke[b] != stroke))

    def turn(self, v: int, *, on: bool) -> None:
        """Switch the vertex `v`; `settle` mends what this breaks."""
        m, log = self.matching, self.matching.log
        log.append((self.active, v, self.active[v]))
        if on:
            for bond, stroke in self.arrays.off[v]:
                self._hold(bond, stroke, -1)
            self.active[v] = 1
            m.set_mate(v, EXPOSED)
            self._loose.append(v)
            for bond, _ in self.arrays.off[v]:
                if self.arrays.cause_stroke(bond, v) == m.stroke[bond]:
                    if m.free[bond]:
                        self._adopt(bond)
                    else:
                        self._count(v, 1)
        else:
            if m.mate[v] >= 0:
                self._release(v)
            elif self.causes[v]:
                self._count(v, -self.causes[v])
            self.active[v] = 0
            m.set_mate(v, SETTLED)
            for bond, stroke in self.arrays.off[v]:
                self._hold(bond, stroke, 1)

    def decide(self, v: int, *, on: bool) -> None:
        """Let one of the vertices `either` be ON or OFF from now on; `settle` does the rest."""
        m = self.matching
        m.log.append((m.optional, v, m.optional[v]))
        m.optional[v] = 0
        if on:
            self._loose.append(v)
        else:
            self.turn(v, on=False)

    def _hold(self, bond: int, stroke: int, change: int) -> None:
        """Let one more, or one less, fix `bond` at `stroke`."""
        m, arrays = self.matching, self.arrays
        hold = self.hold[stroke]
        clash = bool(self.hold[0][bond] and self.hold[1][bond])
        m.log.append((hold, bond, hold[bond]))
        hold[bond] += change
        self._fault(bool(self.hold[0][bond] and self.hold[1][bond]) - clash)
        was_free, free = m.free[bond], not (self.hold[0][bond] or self.hold[1][bond])
        extra = arrays.nodes + bond
        now = m.stroke[bond]
        if not free and not self.hold[now][bond]:
            now = 1 - now
        m.touched.append(bond)
        if was_free:
            if free:
                return
            if arrays.form[bond] != EDGE:
                if m.mate[extra] >= 0:
                    self._release(extra)
                m.set_mate(extra, SETTLED)
            else:
                v = arrays.tail[bond]
                if m.mate[v] >= 0 and m.via[v] == bond:
                    self._release(v)
        else:
            if not free and now == m.stroke[bond]:
                return
            for v in self._caused(bond):
                self._count(v, -1)
            if free and arrays.form[bond] != EDGE:
                m.set_mate(extra, EXPOSED)
        m.log.append((m.free, bond, was_free))
        m.free[bond] = free
        m.put(bond, now)
        if free:
            self._adopt(bond)
        else:
            for v in self._caused(bond):
                self._count(v, 1)

    def _adopt(self, bond: int) -> None:
        """Match over `bond`, which is free, as its stroke says, or change the stroke."""
        m, arrays = self.matching, self.arrays
        caused = [v for v in self._caused(bond) if m.mate[v] == EXPOSED]
        kind = arrays.form[bond]
        extra = arrays.nodes + bond
        if kind == MIDDLE:
            if m.mate[extra] == EXPOSED:
                if caused:
                    m.join(extra, caused[0], bond)
                else:
                    self._loose.append(extra)
        elif kind == LEAF:
            if m.mate[extra] == EXPOSED:
                if caused:
                    m.join(extra, caused[0], bond)
                else:
                    m.drop(bond)
        elif kind == EDGE and self.active[arrays.tail[bond]] and self.active[arrays.head[bond]]:
            if len(caused) == 2:
                m.join(caused[0], caused[1], bond)
            elif m.mate[arrays.tail[bond]] < 0 or m.via[arrays.tail[bond]] != bond:
                m.drop(bond)

    def _release(self, v: int) -> None:
        """Part `v` and its mate, both of which need another if they are not leaves."""
        w = self.matching.part(v)
        self._loose += [v, w]

    def _count(self, v: int, change: int) -> None:
        """Let `v` have more or fewer fixed causes."""
        m = self.matching
        old = self.causes[v]
        new = old + change
        m.log.append((self.causes, v, old))
        self.causes[v] = new
        self._fault((new > 1) - (old > 1))
        if new and not old:
            if m.mate[v] >= 0:
                self._release(v)
            m.set_mate(v, SETTLED)
        elif old and not new:
            m.set_mate(v, EXPOSED)
            self._loose.append(v)
            self._eased.append(v)

    def _fault(self, change: int) -> None:
        if change:
            self.matching.log.append((self.faults, 0, self.faults[0]))
            self.faults[0] += change

    def settle(self) -> None:
        """Give every vertex a cause if there is a way, and as many storages as can be theirs."""
        self._wake()
        while True:
            if self._loose or self.hard.felled:
                loose, self._loose = self._loose, []
                self._again(self.hard, loose, self._mend)
            elif self._slow or self.soft.felled:
                slow, self._slow = self._slow, []
                self._again(self.soft, slow, self._better)
            else:
                break

    def _again(self, forest: Forest, roots: list[int], attempt: Callable[[int], None]) -> None:
        """Make attempts for `roots` and for those that failed before in what has changed."""
        felled = forest.begin_round()
        for root in sorted({*roots, *(tree.root for tree in felled)}):
            attempt(root)
        mate, shut = self.matching.mate, self.matching.shut
        # Nobody can enter what is settled; a leaf that may not change is an end by itself.
        forest.end_round(felled, lambda v: mate[v] == SETTLED or (mate[v] == EXPOSED and shut[v]))

    def _mend(self, v: int) -> None:
        """Give `v` a cause if it has none."""
        m = self.matching
        self.exposed.discard(v)
        if m.mate[v] == EXPOSED and not m.optional[v]:
            if m.cover(v, self.hard, at_any_price=True):
                self._wake()
            else:
                self._expose(v)

    def _better(self, storage: int) -> None:
        """Put a storage into integral causality if it is not and can be."""
        free = self.matching.free[self.arrays.stores[storage][0]]
        if free and storage in self.derivative and self._gain(storage):
            self._wake()

    def _wake(self) -> None:
        """Find what is worth another search, now that bonds were touched."""
        m, arrays = self.matching, self.arrays
        nodes, tail, head = arrays.nodes, arrays.tail, arrays.head
        soft, hard = self.soft.tree_of, self.hard.tree_of
        vertices: list[int] = []
        for bond in dict.fromkeys(m.touched):
            vertices += (tail[bond], head[bond], nodes + bond)
            if bond in arrays.stored:
                self._status(bond)
                if arrays.form[bond] == LEAF:
                    self._slow += [k for k in arrays.stored[bond] if k in self.derivative]
        m.touched.clear()
        for v in self._eased:
            vertices += (w for _, w in arrays.near[v])
        self._eased.clear()
        for v in vertices:
            tree = soft[v]
            if tree is not None:
                self.soft.fell(tree)
            tree = hard[v]
            if tree is not None:
                self.hard.fell(tree)
