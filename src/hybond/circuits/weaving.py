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
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from hybond.circuits.blocks import blocks
from hybond.circuits.coils import Magnetics
from hybond.circuits.graph_names import GraphNames
from hybond.circuits.leaves import Leaf, negated
from hybond.circuits.notices import Line, Notices
from hybond.circuits.numerals import quantity
from hybond.circuits.opened import GROUND
from hybond.circuits.reduction import Tree, reduce_block
from hybond.circuits.texts import Texts
from hybond.model.parts import Part

Terms = tuple[tuple[int, str], ...]
"""A sum: sign and name of each term."""
_LEADING = {"I": 0, "winding": 0, "Se": 1, "Sf": 1, "R": 2, "C": 3, "meter": 4}
"""Which element gives its name to a 1-junction."""


@dataclass
class Woven:
    """A bond graph under way, and where voltages and currents are found in it.

    Parameters
    ----------
    elements : dict
        Name to part; of a source that is still to be said, the value is None.
    bonds : list of (str, str)
    lines : dict
        Element to the line that it comes from.
    drops : dict
        Branch to its voltage from node a to node b; missing if nothing tells it.
    currents : dict
        Branch to its current from node a to node b.
    potentials : list of (int, int, str)
        A node, the node against which its voltage is counted, and the 0-junction that has it.
    pending : list of (str, Leaf, int)
        Sources whose value follows from a controlling one: name, branch and sign.
    idle : list of Leaf
        Branches that no current can pass.
    """

    names: GraphNames
    elements: dict[str, Part] = field(default_factory=dict)
    bonds: list[tuple[str, str]] = field(default_factory=list)
    lines: dict[str, Line] = field(default_factory=dict)
    drops: dict[int, Terms] = field(default_factory=dict)
    currents: dict[int, Terms] = field(default_factory=dict)
    potentials: list[tuple[int, int, str]] = field(default_factory=list)
    pending: list[tuple[str, int, int]] = field(default_factory=list)
    idle: list[int] = field(default_factory=list)
    junctions: dict[int, str] = field(default_factory=dict)
    """Of each switch, its controlled junction."""
    inputs: dict[int, str] = field(default_factory=dict)
    """Of each source that is an input, its name."""
    signals: dict[str, str] = field(default_factory=dict)
    """Voltages of open windings."""
    own: list[str] = field(default_factory=list)
    """The name that each branch has, or would have."""


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
    leaves : sequence of Leaf
    ends : sequence of (int, int)
        Nodes a and b of each; different ones.
    nodes : sequence of str
        Names to show; number 0 is ground.
    names : GraphNames
    texts : Texts
    notices : Notices

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
        self.out = Woven(names)
        self.own = self.out.own = [names.take(leaf.branch.name) for leaf in leaves]
        self.tasks: list[tuple[str, Tree, str, int]] = []
        self.reference = 0
        self.inside: dict[int, list[str]] = {}
        """Of each switch, the resistance and the drop in series with it."""
        self.cores: dict[str, str] = {}
        self.open: set[int] = set()

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
        self.open = {b.edges[0] for b in found if len(b.edges) == 1}
        for block in sorted(found, key=lambda b: b.edges[0]):
            if len(block.edges) == 1:
                self.leave_idle(block.edges[0])
            else:
                self.block(block.reference, block.edges)
        for k in self.out.idle:
            if self.leaves[k].role == "winding":
                self.open_winding(k)
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
        if branch.kind in "igf":
            raise branch.line.refuse(
                f"the current of {branch.name} has no way back",
                code="HB-F139",
                hint="connect both of its nodes",
            )
        if leaf.role in ("R", "I", "meter", "winding"):
            self.out.drops[k] = ()
        if leaf.role == "winding":
            self.notices.add(branch.line, f"{branch.name} is open: no current can pass it")
        elif branch.kind not in "veh":
            loose = [n for n in self.ends[k] if n and sum(n in pair for pair in self.ends) == 1]
            why = "it is in no loop"
            if loose:
                why = f"nothing else is joined to {' and '.join(self.nodes[n] for n in loose)}"
            self.notices.add(
                branch.line, f"{branch.name} is left out: no current can pass it, {why}"
            )

    def wound(self, core: Magnetics) -> list[int]:
        """Return the coils of a core that have a current, by their place."""
        open_keys = {self.leaves[k].branch.key for k in self.open}
        return [i for i, key in enumerate(core.coils) if key not in open_keys]

    def port(self, core: Magnetics, index: int) -> str:
        """Return the port of a coil at the field of its core; a single coil needs none."""
        kept = self.wound(core)
        return "" if len(kept) == 1 else f".{kept.index(index) + 1}"

    def open_winding(self, k: int) -> None:
        """Let a coil without current see what the others of its core induce."""
        winding = self.leaves[k].winding
        assert winding is not None
        core = self.cores.get(winding.core.name)
        if core is None:
            return  # none of them has a current
        if winding.core.matrix is not None:
            # e = M i' of the coils with a current, so i' = M^-1 e, which induces m i' here
            kept = self.wound(winding.core)
            numbers = np.array(winding.core.numbers)
            parts = np.linalg.solve(numbers[np.ix_(kept, kept)], numbers[kept, winding.index])
            terms = (
                f"{float(c)!r}*{core}{self.port(winding.core, i)}.e"
                for c, i in zip(parts, kept, strict=True)
            )
            name = self.own[k]
            self.out.signals[name] = " + ".join(terms)
            self.out.drops[k] = ((1, name),)
        elif winding.index == 0:
            self.out.drops[k] = ((1, f"{core}.e"),)
        else:
            name = self.element(k, "TF", winding.core.ratios[winding.index][0])
            nothing = self.out.names.take(f"{name}_open")
            self.out.elements[nothing] = Part("Sf", "0 A")
            self.bond(nothing, name)
            self.bond(name, core)
            self.out.drops[k] = ((1, f"{name}.1.e"),)

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

    def junction(self, kind: str, name: str, **options: Any) -> str:
        self.out.elements[name] = Part(kind, None, options)
        return name

    def node(self, n: int) -> str:
        """Return a new 0-junction for a node of the circuit."""
        names, text = self.out.names, self.nodes[n]
        name = self.junction("0", names.take(text if names.free(text) else f"n_{text}", "n"))
        self.out.potentials.append((n, self.reference, name))
        return name

    def bond(self, tail: str, head: str, sign: int = 1) -> None:
        self.out.bonds.append((tail, head) if sign > 0 else (head, tail))

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
        return self.junction("1", self.out.names.take(f"i_{text}")), way, -1

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
        self.bond(tail if way > 0 else head, name)
        self.bond(name, head if way > 0 else tail)
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
        self.bond(host, name, sign * way)
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
            name = self.junction("0", self.out.names.take(f"u_{self.inner(tree.parts)}"))
        self.bond(host, name, sign * way)
        self.parts_on_zero(tree, name, way)

    # elements

    def element(self, k: int, kind: str, value: Any, **options: Any) -> str:
        name = self.own[k]
        self.out.elements[name] = Part(kind, value, options)
        self.out.lines[name] = self.leaves[k].branch.line
        return name

    def passive(self, k: int, host: str, sign: int) -> None:
        """Hang R, C or I onto a junction; `sign` is that of its own voltage and current."""
        leaf = self.leaves[k]
        options: dict[str, Any] = {}
        if leaf.start is not None and leaf.start.number:
            start = leaf.start if sign > 0 else negated(leaf.start)
            key, unit = ("e", "V") if leaf.role == "C" else ("f", "A")
            options[key] = self.texts.value(start, unit)
        name = self.element(k, leaf.role, leaf.text, **options)
        self.bond(host, name)
        self.out.drops[k] = ((sign, f"{name}.e"),)
        self.out.currents[k] = ((sign, f"{name}.f"),)

    def source(self, k: int, kind: str, sign: int) -> str:
        """Return a new source whose value is `sign` times that of the branch."""
        leaf = self.leaves[k]
        text = leaf.text
        if text is None:
            name = self.element(k, kind, None)
            self.out.pending.append((name, k, sign))
            return name
        assert leaf.drive is not None
        if leaf.drive.input is not None:
            text = self.out.inputs[k] = self.out.names.take(f"u_{leaf.branch.name}")
        if sign < 0:
            text = minus(text)
        return self.element(k, kind, text)

    def leaf_on_one(self, k: int, host: str, sign: int) -> None:
        leaf = self.leaves[k]
        match leaf.role:
            case "R" | "C" | "I":
                self.passive(k, host, sign)
            case "Se" | "meter":
                name = self.source(k, "Se", 1)
                self.bond(host, name, sign)
                self.out.drops[k] = ((1, f"{name}.e"),)
                self.out.currents[k] = ((sign, f"{name}.f"),)
            case "Sf":
                name = self.source(k, "Sf", sign)
                self.bond(name, host)
                self.out.drops[k] = ((-sign, f"{name}.e"),)
                self.out.currents[k] = ((sign, f"{name}.f"),)
            case "winding":
                self.winding_on_one(k, host, sign)
            case _:
                name = self.switched(k)
                if sign < 0 and leaf.role == "diode":
                    # two diodes against each other: the node between them turns the sign
                    between = self.junction("0", self.out.names.take(f"u_{leaf.branch.name}"))
                    self.bond(host, between)
                    self.bond(name, between)
                    sign = 1
                else:
                    self.bond(host, name)
                self.reads(k, name, sign)

    def leaf_on_zero(self, k: int, host: str, sign: int) -> None:
        leaf = self.leaves[k]
        match leaf.role:
            case "R" | "C" | "I":
                self.passive(k, host, sign)
            case "Se" | "meter":
                name = self.source(k, "Se", sign)
                self.bond(name, host)
                self.out.drops[k] = ((sign, f"{name}.e"),)
                self.out.currents[k] = ((-sign, f"{name}.f"),)
            case "Sf":
                name = self.source(k, "Sf", 1)
                self.bond(host, name, sign)
                self.out.drops[k] = ((sign, f"{name}.e"),)
                self.out.currents[k] = ((1, f"{name}.f"),)
            case "winding":
                self.winding_on_zero(k, host, sign)
            case _:
                name = self.switched(k)
                turned = sign < 0 and leaf.role == "diode"
                self.bond(host, name, -1 if turned else 1)
                self.reads(k, name, 1 if turned else sign)

    # diodes and switches

    def switched(self, k: int) -> str:
        """Return the junction of a diode or switch, with its resistance and drop."""
        leaf = self.leaves[k]
        name = self.own[k]
        options = {"law": "diode"} if leaf.role == "diode" else {}
        self.junction("1", name, **options)
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
            self.bond(name, inside)
        return name

    def reads(self, k: int, name: str, sign: int) -> None:
        """Say where the voltage and current of a switch are; `sign` is that along its junction."""
        self.out.drops[k] = tuple((sign, f"{n}.e") for n in [*self.inside[k], name])
        self.out.currents[k] = ((sign, f"{name}.f"),)

    # coupled coils

    def core(self, core: Magnetics, host: str = "") -> str:
        """Return the element or junction that coils share; a `host` becomes that junction."""
        known = self.cores.get(core.name)
        if known is not None:
            return known
        name = self.cores[core.name] = host or self.out.names.take(core.name)
        keys = {leaf.branch.key: leaf for leaf in self.leaves if leaf.winding is not None}
        starts = [keys[c].start for c in core.coils]
        if core.matrix is not None:
            options: dict[str, Any] = {}
            kept = self.wound(core)
            used = [starts[i] for i in kept]
            if any(s is not None and s.number for s in used):
                given = [0.0 if s is None else self.texts.value(s, "A") for s in used]
                options["f"] = given if len(kept) > 1 else given[0]
            rows: Any = [[core.matrix[i][j] for j in kept] for i in kept]
            value = rows if len(kept) > 1 else rows[0][0]
            self.out.elements[name] = Part("I", value, options)
        else:
            if not host:
                self.junction("0", name)
            index = next(k for k, x in enumerate(self.leaves) if x.branch.key == core.coils[0])
            inductance = self.own[index]
            total = sum(
                m * (0.0 if s is None else s.number)
                for m, s in zip(core.turns, starts, strict=True)
            )
            options = {"f": quantity(total, "A")} if total else {}
            self.out.elements[inductance] = Part("I", core.inductance, options)
            self.out.lines[inductance] = self.leaves[index].branch.line
            self.bond(name, inductance)
        if not host:
            self.out.lines[name] = core.line
        return name

    def winding_on_one(self, k: int, host: str, sign: int) -> None:
        """Hang a coil onto a 1-junction."""
        winding = self.leaves[k].winding
        assert winding is not None
        core = self.core(winding.core)
        self.out.currents[k] = ((sign, f"{host}.f"),)
        if winding.core.matrix is not None:
            port = f"{core}{self.port(winding.core, winding.index)}"
            self.out.drops[k] = ((1, f"{port}.e"),)
            if sign > 0:
                self.bond(host, port)
                return
            between = self.junction("0", self.out.names.take(f"u_{self.own[k]}"))
            self.bond(between, host)
            self.bond(between, port)
            return
        if winding.index == 0:
            self.bond(host, core, sign)
            self.out.drops[k] = ((1, f"{core}.e"),)
            return
        ahead, back = winding.core.ratios[winding.index]
        name = self.element(k, "TF", ahead if sign > 0 else back)
        self.bond(host, name, sign)
        self.bond(name, core, sign)
        self.out.drops[k] = ((1, f"{name}.{1 if sign > 0 else 2}.e"),)

    def winding_on_zero(self, k: int, host: str, sign: int) -> None:
        """Hang a coil onto a 0-junction; against its sign, by a 1-junction of its own."""
        winding = self.leaves[k].winding
        assert winding is not None
        rigid = winding.core.matrix is None
        if sign < 0:
            between = self.junction("1", self.out.names.take(f"i_{self.own[k]}"))
            self.bond(between, host)
            self.winding_on_one(k, between, 1)
        elif rigid and winding.index == 0 and winding.core.name not in self.cores:
            # the node of the first winding is the core: its voltage is that of the turns
            self.core(winding.core, host)
            self.out.drops[k] = ((1, f"{host}.e"),)
        elif rigid and winding.index == 0:
            between = self.junction("1", self.out.names.take(f"i_{self.own[k]}"))
            self.bond(host, between)
            self.winding_on_one(k, between, 1)
        else:
            self.winding_on_one(k, host, 1)
            port = self.cores[winding.core.name]
            if not rigid:
                port += self.port(winding.core, winding.index)
            own = f"{self.own[k]}.1" if rigid else port
            self.out.currents[k] = ((1, f"{own}.f"),)


def minus(text: str | float) -> str | float:
    """Return minus a value as text.

    Examples
    --------
    >>> minus("5 V"), minus("-5 V"), minus("2 V*sin(w)"), minus("a + b")
    ('-5 V', '5 V', '-(2 V*sin(w))', '-(a + b)')
    """
    if not isinstance(text, str):
        return -text
    words = text.split()
    try:
        float(words[0])
    except (ValueError, IndexError):
        return f"-{text}" if text.isidentifier() else f"-({text})"
    if len(words) != 2 or not words[1].isalpha():
        return f"-({text})"
    return text[1:] if text.startswith("-") else f"-{text}"


def written(terms: Sequence[tuple[int, str]]) -> str:
    """Return a sum of terms as text; equal terms of opposite sign are gone.

    Examples
    --------
    >>> written([(1, "a.e"), (-1, "b.e"), (1, "b.e"), (1, "c.e")]), written([(-1, "a.e")])
    ('a.e + c.e', '-a.e')
    """
    count: dict[str, int] = {}
    for sign, name in terms:
        count[name] = count.get(name, 0) + sign
    text = ""
    for name, times in count.items():
        if not times:
            continue
        factor = "" if abs(times) == 1 else f"{abs(times)}*"
        if not text:
            text = f"{'-' if times < 0 else ''}{factor}{name}"
        else:
            text += f" {'-' if times < 0 else '+'} {factor}{name}"
    return text or "0"


def ends_of(leaves: Sequence[Leaf], numbers: Mapping[str, int]) -> list[tuple[int, int]]:
    """Return the nodes of each branch, by number."""
    return [(numbers[leaf.branch.a], numbers[leaf.branch.b]) for leaf in leaves]
