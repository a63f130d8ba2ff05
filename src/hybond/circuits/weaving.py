"""From branches between nodes to the elements, junctions and bonds of a bond graph.

The textbook method, simplified as it goes along: a node is a 0-junction, what stands in series is
one 1-junction, what stands in parallel one 0-junction; the reference node and the bonds to it are
left out. The half arrow of R, C and I points to the element, that of a source out of it where it
can.

Signs: of each tree of the reduction it is known along which way the current of its 1-junction, or
the voltage of its 0-junction, is counted. A C or I whose nodes are written the other way starts
from minus the value written; a source turns its arrow or, where no arrow can help, its value.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from hybond.circuits.blocks import blocks
from hybond.circuits.graph_names import GraphNames
from hybond.circuits.leaves import Leaf, negated
from hybond.circuits.notices import Notices
from hybond.circuits.numerals import quantity
from hybond.circuits.opened import GROUND
from hybond.circuits.reduction import Tree, reduce_block
from hybond.circuits.resistive import as_law
from hybond.circuits.texts import Texts, minus
from hybond.circuits.windings import Windings
from hybond.circuits.woven import Woven
from hybond.model.parts import Part

_LEADING = {"I": 0, "winding": 0, "Se": 1, "Sf": 1, "R": 2, "C": 3, "meter": 4}
"""Which element gives its name to a 1-junction."""


def weave(
    leaves: Sequence[Leaf],
    ends: Sequence[tuple[int, int]],
    nodes: Sequence[str],
    names: GraphNames,
    texts: Texts,
    notices: Notices,
) -> Woven:
    """Return the bond graph of a circuit.

    Parameters
    ----------
    ends : sequence of (int, int)
        Nodes a and b of each; different ones.
    nodes : sequence of str
        Names to show; number 0 is ground.

    Raises
    ------
    FileError
        HB-F139 (no path to ground, a current without a way back).
    """
    return _Weaver(leaves, ends, nodes, names, texts, notices).run()


class _Weaver:
    def __init__(
        self,
        leaves: Sequence[Leaf],
        ends: Sequence[tuple[int, int]],
        nodes: Sequence[str],
        names: GraphNames,
        texts: Texts,
        notices: Notices,
    ) -> None:
        self.leaves, self.ends, self.nodes, self.texts = leaves, ends, nodes, texts
        self.notices = notices
        self.out = Woven(leaves, names)
        self.own = self.out.own = [names.take(leaf.branch.name) for leaf in leaves]
        self.tasks: list[tuple[str, Tree, str, int]] = []
        self.reference = 0
        self.inside: dict[int, list[str]] = {}
        """Of each switch, the resistance and the drop in series with it."""

    # the whole

    def run(self) -> Woven:
        used = sorted({n for pair in self.ends for n in pair})
        found, apart = blocks(len(self.nodes), self.ends, 0)
        lost = apart & set(used)
        if lost:
            first = next(k for k, pair in enumerate(self.ends) if pair[0] in lost)
            shown = ", ".join(self.nodes[n] for n in sorted(lost)[:8])
            raise self.leaves[first].branch.line.refuse(
                f"no path to ground from {shown}" + (", ..." if len(lost) > 8 else ""),
                code="HB-F139",
                hint=f"connect them to node {GROUND}; a winding may have a resistor to ground",
            )
        idle = {b.edges[0] for b in found if len(b.edges) == 1}
        self.windings = Windings(self.out, self.texts, idle)
        for block in sorted(found, key=lambda b: b.edges[0]):
            if len(block.edges) == 1:
                self.leave_idle(block.edges[0])
            else:
                self.block(block.reference, block.edges)
        for k in self.out.idle:
            if self.leaves[k].role == "winding":
                self.windings.open(k)
        self.sort()
        return self.out

    def sort(self) -> None:
        """Put elements in the order of the netlist, before the other junctions."""
        place: dict[str, tuple[int, int]] = {}
        for k, name in enumerate(self.own):
            place[name] = (k, 0)
            place.update({inside: (k, 1) for inside in self.inside.get(k, ())})
        last = (len(self.own), 0)
        elements = self.out.elements
        self.out.elements = {
            name: elements[name] for name in sorted(elements, key=lambda n: place.get(n, last))
        }

    def leave_idle(self, k: int) -> None:
        """Take note of a branch that no current can pass."""
        leaf = self.leaves[k]
        branch = leaf.branch
        self.out.idle.append(k)
        self.out.currents[k] = ()
        if leaf.role == "Sf" and branch.kind != "c":  # at rest one stands for each capacitor
            raise branch.line.refuse(
                f"the current of {branch.name} has no way back",
                code="HB-F139",
                hint="connect both of its nodes",
            )
        if leaf.role in ("R", "I", "meter", "winding"):
            self.out.drops[k] = ()
        if leaf.role == "winding":
            self.notices.add(branch.line, f"{branch.name} is open: no current can pass it")
        elif leaf.role != "Se" or branch.kind not in "vehb":
            loose = [n for n in self.ends[k] if n and sum(n in pair for pair in self.ends) == 1]
            why = "it is in no loop"
            if loose:
                why = f"nothing else is joined to {' and '.join(self.nodes[n] for n in loose)}"
            self.notices.add(
                branch.line, f"{branch.name} is left out: no current can pass it, {why}"
            )

    def block(self, reference: int, edges: tuple[int, ...]) -> None:
        self.reference = reference
        order = list(dict.fromkeys(n for k in edges for n in self.ends[k]))
        core = reduce_block({k: self.ends[k] for k in edges}, reference, order)
        if core.whole is not None:
            whole = core.whole
            if whole.kind == "series":
                self.loop(whole)
            else:
                other = whole.a if whole.b == reference else whole.b
                self.parts_on_zero(whole, self.node(other), 1 if whole.a == other else -1)
        else:
            at = {n: self.node(n) for n in core.nodes}
            for tree in core.trees:
                if reference in (tree.a, tree.b):
                    other = tree.a if tree.b == reference else tree.b
                    sign = 1 if tree.a == other else -1
                    if tree.kind == "parallel":
                        self.parts_on_zero(tree, at[other], sign)
                    else:
                        self.tasks.append(("0", tree, at[other], sign))
                else:
                    self.between(tree, at[tree.a], at[tree.b])
        self.work()

    def work(self) -> None:
        """Hang what is waiting onto its junctions; a ladder is deep, so there is no recursion."""
        while self.tasks:
            kind, tree, host, sign = self.tasks.pop()
            if kind == "0":
                self.on_zero(tree, host, sign)
            else:
                self.on_one(tree, host, sign)

    # junctions

    def node(self, n: int) -> str:
        """Return a new 0-junction for a node of the circuit."""
        names, text = self.out.names, self.nodes[n]
        name = self.out.junction("0", names.take(text if names.free(text) else f"n_{text}", "n"))
        self.out.potentials.append((n, self.reference, name))
        return name

    def chain(self, parts: list[tuple[Tree, bool]]) -> tuple[str, int, int]:
        """Return a new 1-junction for parts in series, which way its current goes, and its switch.

        Returns
        -------
        name : str
        way : int
            1 if the current goes the way of the series.
        controlled : int
            Branch whose switching the junction does, -1 if none.
        """
        single = [(t.branch, ahead) for t, ahead in parts if t.kind == "leaf"]
        roles = {k: self.leaves[k].role for k, _ in single}
        switches = [(k, ahead) for k, ahead in single if roles[k] in ("diode", "switch")]
        diode = next(((k, ahead) for k, ahead in switches if roles[k] == "diode"), None)
        if diode is not None:
            way = 1 if diode[1] else -1
        else:
            votes = {"Sf": 0, "Se": 0, "other": 0}
            for k, ahead in single:
                if roles[k] in ("Se", "Sf"):
                    votes[roles[k]] += 1 if ahead == (roles[k] == "Sf") else -1
                elif roles[k] in ("C", "I", "winding", "meter"):
                    votes["other"] += 1 if ahead else -1
            way = next((1 if v > 0 else -1 for v in votes.values() if v), 1)
        chosen = diode or (switches[0] if switches else None)
        if chosen is not None:
            return self.switched(chosen[0]), way, chosen[0]
        leading = min((k for k, _ in single), key=lambda k: _LEADING.get(roles[k], 9), default=None)
        text = self.leaves[leading].branch.name if leading is not None else self.inner(parts)
        return self.out.junction("1", self.out.names.take(f"i_{text}")), way, -1

    def inner(self, parts: list[tuple[Tree, bool]]) -> str:
        tree = parts[0][0]
        while tree.kind != "leaf":
            tree = tree.parts[0][0]
        return self.leaves[tree.branch].branch.name

    def loop(self, whole: Tree) -> None:
        name, way, controlled = self.chain(whole.parts)
        self.parts_on_one(whole.parts, name, way, controlled)

    def between(self, tree: Tree, tail: str, head: str) -> None:
        """Join two 0-junctions by what is between their nodes."""
        parts = tree.parts if tree.kind == "series" else [(tree, True)]
        name, way, controlled = self.chain(parts)
        self.out.bond(tail if way > 0 else head, name)
        self.out.bond(name, head if way > 0 else tail)
        self.parts_on_one(parts, name, way, controlled)

    def parts_on_zero(self, tree: Tree, host: str, sign: int) -> None:
        for part, ahead in reversed(tree.parts):
            self.tasks.append(("0", part, host, sign if ahead else -sign))

    def parts_on_one(
        self, parts: list[tuple[Tree, bool]], host: str, way: int, controlled: int
    ) -> None:
        others = [(t, ahead) for t, ahead in parts if t.kind != "leaf" or t.branch != controlled]
        for part, ahead in parts:
            if part.kind == "leaf" and part.branch == controlled:
                self.reads(controlled, host, way if ahead else -way)
        for part, ahead in reversed(others):
            if part.kind == "leaf" and self.leaves[part.branch].role == "meter" and len(parts) > 1:
                self.out.drops[part.branch] = ()
                self.out.currents[part.branch] = ((way if ahead else -way, f"{host}.f"),)
                continue
            self.tasks.append(("1", part, host, way if ahead else -way))

    def on_zero(self, tree: Tree, host: str, sign: int) -> None:
        """Hang a tree onto a 0-junction whose voltage is `sign` times that of the tree."""
        if tree.kind == "leaf":
            self.leaf_on_zero(tree.branch, host, sign)
            return
        name, way, controlled = self.chain(tree.parts)
        self.out.bond(host, name, sign * way)
        self.parts_on_one(tree.parts, name, way, controlled)

    def on_one(self, tree: Tree, host: str, sign: int) -> None:
        """Hang a tree onto a 1-junction whose current is `sign` times that of the tree."""
        if tree.kind == "leaf":
            self.leaf_on_one(tree.branch, host, sign)
            return
        if self.reference in (tree.a, tree.b):
            way = 1 if tree.b == self.reference else -1
            name = self.node(tree.a if way > 0 else tree.b)
        else:
            way = sign
            name = self.out.junction("0", self.out.names.take(f"u_{self.inner(tree.parts)}"))
        self.out.bond(host, name, sign * way)
        self.parts_on_zero(tree, name, way)

    # elements

    def passive(self, k: int, host: str, sign: int) -> None:
        """Hang R, C or I onto a junction; `sign` is that of its own voltage and current."""
        leaf = self.leaves[k]
        options: dict[str, Any] = {}
        if leaf.start is not None and leaf.start.number:
            start = leaf.start if sign > 0 else negated(leaf.start)
            key, unit = ("e", "V") if leaf.role == "C" else ("f", "A")
            options[key] = self.texts.value(start, unit)
        says: Any = leaf.text
        if leaf.formula is not None and leaf.branch.law is not None:
            says = as_law(leaf.branch.law.imposes, leaf.formula, sign)
        name = self.out.element(k, leaf.role, says, **options)
        self.out.bond(host, name)
        self.out.drops[k] = ((sign, f"{name}.e"),)
        self.out.currents[k] = ((sign, f"{name}.f"),)

    def source(self, k: int, kind: str, sign: int) -> str:
        """Return a new source whose value is `sign` times that of the branch."""
        leaf = self.leaves[k]
        text = leaf.text
        if text is None:
            name = self.out.element(k, kind, None)
            self.out.pending.append((name, k, sign))
            return name
        assert leaf.drive is not None
        if leaf.drive.input is not None:
            text = self.out.inputs[k] = self.out.names.take(f"u_{leaf.branch.name}")
            if leaf.drive.ramp:
                text = f"{text}*{leaf.drive.ramp}"
        if sign < 0:
            text = minus(text)
        return self.out.element(k, kind, text)

    def leaf_on_one(self, k: int, host: str, sign: int) -> None:
        leaf = self.leaves[k]
        match leaf.role:
            case "R" | "C" | "I":
                self.passive(k, host, sign)
            case "Se" | "meter":
                name = self.source(k, "Se", 1)
                self.out.bond(host, name, sign)
                self.out.drops[k] = ((1, f"{name}.e"),)
                self.out.currents[k] = ((sign, f"{name}.f"),)
            case "Sf":
                name = self.source(k, "Sf", sign)
                self.out.bond(name, host)
                self.out.drops[k] = ((-sign, f"{name}.e"),)
                self.out.currents[k] = ((sign, f"{name}.f"),)
            case "winding":
                self.windings.on_one(k, host, sign)
            case _:
                name = self.switched(k)
                if sign < 0 and leaf.role == "diode":
                    # two diodes against each other: the node between them turns the sign
                    between = self.out.junction("0", self.out.names.take(f"u_{leaf.branch.name}"))
                    self.out.bond(host, between)
                    self.out.bond(name, between)
                    sign = 1
                else:
                    self.out.bond(host, name)
                self.reads(k, name, sign)

    def leaf_on_zero(self, k: int, host: str, sign: int) -> None:
        leaf = self.leaves[k]
        match leaf.role:
            case "R" | "C" | "I":
                self.passive(k, host, sign)
            case "Se" | "meter":
                name = self.source(k, "Se", sign)
                self.out.bond(name, host)
                self.out.drops[k] = ((sign, f"{name}.e"),)
                self.out.currents[k] = ((-sign, f"{name}.f"),)
            case "Sf":
                name = self.source(k, "Sf", 1)
                self.out.bond(host, name, sign)
                self.out.drops[k] = ((sign, f"{name}.e"),)
                self.out.currents[k] = ((1, f"{name}.f"),)
            case "winding":
                self.windings.on_zero(k, host, sign)
            case _:
                name = self.switched(k)
                turned = sign < 0 and leaf.role == "diode"
                self.out.bond(host, name, -1 if turned else 1)
                self.reads(k, name, 1 if turned else sign)

    # diodes and switches

    def switched(self, k: int) -> str:
        """Return the junction of a diode or switch, with its resistance and drop."""
        leaf = self.leaves[k]
        name = self.own[k]
        options = {"law": "diode"} if leaf.role == "diode" else {}
        self.out.junction("1", name, **options)
        self.out.lines[name] = leaf.branch.line
        self.out.junctions[k] = name
        series = []
        if leaf.resistance is not None:
            series.append((f"{name}_R", Part("R", leaf.resistance)))
        if leaf.drop:
            series.append((f"{name}_drop", Part("Se", quantity(leaf.drop, "V"))))
        self.inside[k] = []
        for wanted, part in series:
            inside = self.out.names.take(wanted)
            self.out.elements[inside] = part
            self.inside[k].append(inside)
            self.out.bond(name, inside)
        return name

    def reads(self, k: int, name: str, sign: int) -> None:
        """Say where the voltage and current of a switch are; `sign` is that along its junction."""
        self.out.drops[k] = tuple((sign, f"{n}.e") for n in [*self.inside[k], name])
        self.out.currents[k] = ((sign, f"{name}.f"),)


def ends_of(leaves: Sequence[Leaf], numbers: Mapping[str, int]) -> list[tuple[int, int]]:
    """Return the nodes of each branch, by number."""
    return [(numbers[leaf.branch.a], numbers[leaf.branch.b]) for leaf in leaves]
