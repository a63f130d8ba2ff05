"""A complete choice of strokes, made from scratch."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from hybond.causality.arrays import LEAF, Arrays
from hybond.causality.first import first_matching
from hybond.causality.forest import Forest, Tree
from hybond.causality.matching import EXPOSED, SETTLED, Matching


class Assignment:
    """Strokes with as many junctions satisfied, then as many storages integral, as can be.

    Parameters
    ----------
    arrays : Arrays
        The compiled graph.
    off : collection of int
        The vertices that are OFF.
    pins : mapping
        Bond to stroke: fixed as if by an element.
    either : sequence of int
        Controlled vertices that may be ON or OFF as suits: OFF is a junction without a cause.

    Notes
    -----
    The choice is greedy in the order fixed, pins, storages, vertices `either`, resistors: each
    has its way if that is feasible with those before it.
    """

    def __init__(
        self,
        arrays: Arrays,
        *,
        off: Collection[int] = (),
        pins: Mapping[int, int] | None = None,
        either: Sequence[int] = (),
    ) -> None:
        self.arrays = arrays
        self.matching = Matching(arrays)
        self.hold = [0] * arrays.bonds, [0] * arrays.bonds
        """How many fix a bond at `TAIL`, at `HEAD`."""
        self.causes = [0] * arrays.nodes
        """How many fixed bonds are the cause of a vertex."""
        self.active = bytearray(bool(near) for near in arrays.near[: arrays.nodes])
        self.faults = [0]
        """Vertices with two fixed causes and bonds fixed both ways."""
        self.derivative: set[int] = set()
        self.soft = Forest(len(arrays.near), self.matching.log)
        """Searches for a better place for a storage that failed."""
        self.hard = Forest(len(arrays.near), self.matching.log)
        """Searches for a cause that failed: each is a conflict."""
        self.exposed: set[int] = set()
        """Vertices (and middles) that cannot be given a cause."""
        for v in either:
            self.matching.optional[v] = 1
        self._fix(off, pins or {})
        m = self.matching
        for v in first_matching(m):
            if m.mate[v] == EXPOSED and not m.cover(v, self.hard, at_any_price=True):
                self._expose(v)
        self._first_choice(list(either))

    @property
    def conflict(self) -> bool:
        """Whether there is no causality."""
        return self.broken > 0

    @property
    def broken(self) -> int:
        """How many vertices lack a cause or have too many."""
        return self.faults[0] + len(self.exposed)

    @property
    def dependent(self) -> int:
        """How many storages are in derivative causality."""
        return len(self.derivative)

    def _fix(self, off: Collection[int], pins: Mapping[int, int]) -> None:
        arrays, m, hold = self.arrays, self.matching, self.hold
        given = sorted(pins.items()) + arrays.fixed
        for v in sorted(off):
            if self.active[v]:
                self.active[v] = 0
                m.mate[v] = SETTLED
                given += arrays.off[v]
        for bond, stroke in given:
            if m.free[bond]:
                m.free[bond] = False
                m.stroke[bond] = stroke
                m.mate[arrays.nodes + bond] = SETTLED
            hold[stroke][bond] += 1
            # The first that is against the others is the fault, more of them are not.
            self.faults[0] += hold[stroke][bond] == 1 and hold[1 - stroke][bond] > 0
        for bond in dict.fromkeys(bond for bond, _ in given):
            for v in self._caused(bond):
                self.causes[v] += 1
                m.mate[v] = SETTLED
                self.faults[0] += self.causes[v] == 2

    def _caused(self, bond: int) -> list[int]:
        """List the active vertices that `bond` is the cause of, as its stroke is now."""
        arrays, stroke = self.arrays, self.matching.stroke[bond]
        found = []
        if arrays.at_tail[bond] == stroke and self.active[arrays.tail[bond]]:
            found.append(arrays.tail[bond])
        if arrays.at_head[bond] == stroke and self.active[arrays.head[bond]]:
            found.append(arrays.head[bond])
        return found

    def _expose(self, v: int) -> None:
        m = self.matching
        self.exposed.add(v)
        self.hard.plant(v, m.seen, m.met)

    def _first_choice(self, either: list[int]) -> None:
        """Let each storage, then each of `either`, then each resistor have its way if it can."""
        arrays, m = self.arrays, self.matching
        nodes, form = arrays.nodes, arrays.form
        for k, (bond, want) in enumerate(arrays.stores):
            if form[bond] == LEAF and m.free[bond]:
                if m.stroke[bond] != want:
                    self._gain(k)
                    m.log.clear()
                m.shut[nodes + bond] = True
        passing: list[Tree] = []
        for v in either:
            if m.mate[v] == EXPOSED and not m.cover(v, self.soft, at_any_price=False):
                passing.append(self.soft.plant(-1, m.seen, m.met))
            m.shut[v] = True
        for bond in range(arrays.bonds):
            if form[bond] == LEAF and m.free[bond] and arrays.law[bond] >= 0:
                leaf = nodes + bond
                if m.stroke[bond] != arrays.law[bond] and not self._change(leaf):
                    passing.append(self.soft.plant(-1, m.seen, m.met))
                m.shut[leaf] = True
                m.log.clear()
        # What no junction or resistor can change, a storage may: only its own trees stay.
        for tree in passing:
            self.soft.fell(tree)
            m.log.clear()
        self.soft.felled.clear()
        for v in either:
            m.shut[v] = False
        for bond in range(arrays.bonds):
            m.shut[nodes + bond] = False
            self._status(bond)
        self._forget()

    def _forget(self) -> None:
        m = self.matching
        m.log.clear()
        m.before.clear()
        m.touched.clear()

    def _status(self, bond: int) -> None:
        """Note which storages at `bond` are in derivative causality."""
        m = self.matching
        for k in self.arrays.stored.get(bond, ()):
            integral = m.stroke[bond] == self.arrays.stores[k][1]
            if integral:
                self.derivative.discard(k)
            else:
                self.derivative.add(k)
            if self.arrays.form[bond] == LEAF:
                m.shut[self.arrays.nodes + bond] = integral

    def _change(self, leaf: int) -> bool:
        """Let the leaf be matched if it is not, and the reverse, if there is a way."""
        m = self.matching
        if m.mate[leaf] == EXPOSED:
            return m.cover(leaf, self.soft, at_any_price=False)
        return m.uncover(leaf, self.soft)

    def _gain(self, storage: int) -> bool:
        """Put a storage into integral causality, if that is feasible."""
        m = self.matching
        if self._change(self.arrays.nodes + self.arrays.stores[storage][0]):
            return True
        self.soft.plant(storage, m.seen, m.met)
        return False

    def blockers(self, bond: int) -> list[int] | None:
        """List the bonds whose leaves keep the leaf of `bond` from changing; None if it can."""
        arrays, m = self.arrays, self.matching
        leaf = arrays.nodes + bond
        touched = len(m.touched)
        end = m.look(leaf)
        del m.touched[touched:]
        if end != EXPOSED:
            return None
        return [
            v - arrays.nodes
            for v in m.seen
            if v != leaf and v >= arrays.nodes and arrays.form[v - arrays.nodes] == LEAF
        ]
