"""Bond variables that sources and resistors alone decide, whatever is stored and whatever switches.

A source gives its own. A junction has it on all of its bonds, so that what hangs on one of these is
apart from the rest; where that is nothing but resistors, transformers and sources, it is given.
Nothing that a machine does can hold such a variable where it is, but by what the sources read.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from hybond.model.expressions import Expr, names
from hybond.model.graph import End, FlatGraph, Node
from hybond.model.kinds import RESISTORS, SOURCES, TWO_PORTS

Reads = frozenset[int]
"""The machines whose states decide what sources give."""
_NOTHING: Reads = frozenset()


class GivenBySources:
    """What is given of a graph.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("a divider, and a filter behind the same source")
    >>> m.add(u=hb.Se("sin(time/(1 s))"), n=hb.Zero(), i=hb.One(), a=hb.R(1.0), b=hb.R(2.0))
    >>> m.add(j=hb.One(), r=hb.R(1.0), c=hb.C(1.0))
    >>> m.bond("u -> n -> i -> a", "i -> b", "n -> j -> r", "j -> c")
    >>> g = m.flatten()
    >>> given = GivenBySources(g).known
    >>> [name for name in ("u.e", "u.f", "b.e", "a.f", "j.f", "c.e") if str(g.read(name)) in given]
    ['u.e', 'b.e', 'a.f']
    """

    def __init__(self, graph: FlatGraph) -> None:
        self.graph = graph
        self.owner = {k: m.index for m in graph.machines for k in m.controls}
        self.known: dict[str, Reads] = {}
        """Name of each bond variable that is given, and the machines that have a say in it."""
        while self._by_sources() | self._by_junctions() | self._by_parts():
            pass

    def read_by(self, e: Expr) -> Reads | None:
        """Return the machines that decide what an expression of what is given is, None if of more.

        Parameters
        ----------
        e : expression
            In canonical names.
        """
        for name in names(e):
            kind = name.partition(":")[0]
            if kind not in ("time", "u", "at", "in", "on") and name not in self.known:
                return None
        return self.machines_in(e)

    def machines_in(self, e: Expr) -> Reads:
        """Return the machines that decide what is given in an expression, whatever else it reads.

        Parameters
        ----------
        e : expression
            In canonical names.
        """
        found = _NOTHING
        for name in names(e):
            kind, _, rest = name.partition(":")
            if kind == "in":
                found |= {int(rest.split(":")[0])}
            elif kind == "on" and int(rest) in self.owner:
                found |= {self.owner[int(rest)]}
            else:
                found |= self.known.get(name, _NOTHING)
        return found

    def _put(self, name: str, reads: Reads) -> bool:
        """Note that something is given; return whether that is new."""
        if name in self.known:
            return False
        self.known[name] = reads
        return True

    def _by_sources(self) -> bool:
        new = False
        for node in self.graph.nodes:
            # one that a law brought in is what the law makes of it
            if node.kind in SOURCES and node.law is not None and not _is_moved(node):
                reads = self.read_by(node.law.expressions[0])
                if reads is not None:
                    new = self._put(_variable(node.law.output, node.ends[0]), reads) or new
        return new

    def _by_junctions(self) -> bool:
        new = False
        for node in self.graph.nodes:
            reads = self._common(node)
            if reads is not None:
                for end in node.ends:
                    new = self._put(_variable(_COMMON[node.kind], end), reads) or new
        return new

    def _common(self, node: Node) -> Reads | None:
        """Return what decides the common variable of a junction, None if it is not given."""
        if not node.is_junction or node.controlled:
            return None
        common = (self.known.get(_variable(_COMMON[node.kind], end)) for end in node.ends)
        return next((reads for reads in common if reads is not None), None)

    def _by_parts(self) -> bool:
        """Find parts that hang together, but at junctions of which the common variable is given."""
        common = [self._common(node) for node in self.graph.nodes]
        new = False
        seen: set[int] = set()
        for bond in self.graph.bonds:
            if bond.index in seen:
                continue
            part, reads = self._part(bond.index, common)
            seen |= part
            if reads is not None:
                for b in sorted(part):
                    new = self._put(f"e:{b}", reads) or new
                    new = self._put(f"f:{b}", reads) or new
        return new

    def _part(self, first: int, common: Sequence[Reads | None]) -> tuple[set[int], Reads | None]:
        """Return the bonds that hang together with one, and what decides them if they are given.

        `common` is what decides the common variable of each junction, None if it is not given.
        """
        g = self.graph
        reads: Reads | None = _NOTHING
        part, todo = {first}, [first]
        met: set[int] = set()
        resists = False
        while todo:
            bond = g.bonds[todo.pop()]
            for index in {bond.tail, bond.head} - met:
                met.add(index)
                node = g.nodes[index]
                own = common[index]
                if own is None:
                    own = self._of_node(node)
                    more = [end.bond for end in node.ends if end.bond not in part]
                    part.update(more)
                    todo += more
                resists = resists or node.kind in RESISTORS
                reads = None if own is None or reads is None else reads | own
        # of sources alone nothing says what passes between them
        return part, reads if resists else None

    def _of_node(self, node: Node) -> Reads | None:
        """Return what decides what an element says, None if it bends, stores or switches."""
        if _is_moved(node):
            return None
        if node.kind in SOURCES and node.law is not None:
            return self.known.get(_variable(node.law.output, node.ends[0]))
        if node.is_junction:
            return _NOTHING
        straight = node.kind in (*RESISTORS, *TWO_PORTS)
        return _NOTHING if straight and node.law is not None and node.law.linear else None


_COMMON: Mapping[str, str] = {"0": "e", "1": "f"}
"""The variable that all bonds of a junction have in common."""


def _is_moved(node: Node) -> bool:
    """Whether a machine switches a node, or a law of junctions has the say in it."""
    return node.controlled or node.implied or node.machine is not None


def _variable(which: str, end: End) -> str:
    return f"{which}:{end.bond}"
