"""The unit of a signal in the words of its domain: a torque is in N*m, not in J.

Dimensions do not tell torque from energy or an angle from a number. A bond does, and a value that
was given in N*m; what is added to a torque, or is the larger of two, or a number of times a torque,
is a torque as well. An input is what the sources give that it drives, and what it is added to or
compared with.
"""

from __future__ import annotations

from hybond.model.dimensions import RATED, infer_dimension
from hybond.model.expressions import Expr, Name, transform
from hybond.model.expressions.tree import Binary, Call, Compare, If, Neg, Number, Pre, walk
from hybond.model.graph import FlatGraph
from hybond.model.kinds import SOURCES
from hybond.units import DIMENSIONLESS, Worded, parse_unit

_KEEP = ("abs", "min", "max", "hypot")
"""Functions whose value is of the kind of their arguments."""

_SHARED = tuple(parse_unit(unit)[1] for unit in ("N*m", "rad/s"))
"""Dimensions that torques and angular velocities share with energies and rates."""


def unit_of(e: Expr, graph: FlatGraph) -> str:
    """Return the SI unit of an expression of a graph, empty if it has none or is not known.

    Examples
    --------
    >>> import hybond as hb
    >>> graph = hb.library.part("rotational.clutch").flatten()
    >>> [unit_of(graph.signals[name], graph) for name in ("torque", "slip", "locked")]
    ['N*m', 'rad/s', '']
    """
    word = _word(e, graph, frozenset())
    if word:
        return word
    dimension = infer_dimension(e, graph.dimensions.get)
    text = "" if dimension is None else str(dimension)
    if dimension in _SHARED and not isinstance(e, Name):
        text = _of_source(e, graph) or text
    return "" if text == "1" else text


def _of_source(e: Expr, graph: FlatGraph) -> str:
    """Return the word of the sources that give an expression, or a sum in which it is a term."""
    e = _bare(e)
    words = {
        _of_name(f"{node.law.output}:{node.ends[0].bond}", graph, frozenset()) or ""
        for node in graph.nodes
        if node.kind in SOURCES and node.law and _has_term(_bare(node.law.expressions[0]), e)
    }
    return next(iter(words)) if len(words) == 1 else ""


def _bare(e: Expr) -> Expr:
    """Return an expression whose numbers have no units, as in laws."""
    return transform(e, lambda n: Number(n.value) if isinstance(n, Number) else n)


def _has_term(law: Expr, e: Expr) -> bool:
    if law == e:
        return True
    match law:
        case Neg(arg) | Pre(arg):
            return _has_term(arg, e)
        case Binary("+" | "-", left, right) | If(_, left, right):
            return _has_term(left, e) or _has_term(right, e)
        case Call(function, args) if function in _KEEP:
            return any(_has_term(arg, e) for arg in args)
    return False


def _word(e: Expr, graph: FlatGraph, within: frozenset[int]) -> str | None:
    """Return the word that all terms agree on; empty if they do not, None for a number.

    `within` are the integrals in whose rates this stands, and inputs by -1 less their numbers: one
    that reads itself says nothing.
    """
    match e:
        case Number(_, Worded(word=word)):
            return word
        case Number(_, dimension):
            return None if dimension in (None, DIMENSIONLESS) else ""
        case Name(path):
            return _of_name(path, graph, within)
        case Neg(arg) | Pre(arg):
            return _word(arg, graph, within)
        case Binary("+" | "-", left, right) | If(_, left, right):
            return _common((left, right), graph, within)
        case Call(function, args) if function in _KEEP:
            return _common(args, graph, within)
        case Binary("*", left, right):
            if _scales(left, graph, within):
                return _word(right, graph, within)
            return _word(left, graph, within) if _scales(right, graph, within) else ""
        case Binary("/", left, right) if _scales(right, graph, within):
            return _word(left, graph, within)
    return ""


def _scales(e: Expr, graph: FlatGraph, within: frozenset[int]) -> bool:
    """Whether a factor is a number: an angle times a torque is work."""
    bare = isinstance(e, Number) and e.dimension is None
    bare = bare or (isinstance(e, Call) and e.function in RATED)
    if not bare and infer_dimension(e, graph.dimensions.get) != DIMENSIONLESS:
        return False
    return not _word(e, graph, within)


def _common(terms: tuple[Expr, ...], graph: FlatGraph, within: frozenset[int]) -> str | None:
    words = {_word(term, graph, within) for term in terms} - {None}
    return "" if len(words) > 1 else next(iter(words), None)


def _of_name(path: str, graph: FlatGraph, within: frozenset[int]) -> str | None:
    kind, _, index = path.partition(":")
    if kind in ("e", "f"):
        domain = graph.bonds[int(index)].domain
        return domain.effort_unit if kind == "e" else domain.flow_unit
    if kind == "s":
        k = int(index)
        if k in within:
            return None
        rate = _word(graph.integrals[k].rate, graph, within | {k})
        return "rad" if rate == "rad/s" else ""
    if kind == "u":
        return _of_input(int(index), graph, within)
    if kind == "x":
        storage = graph.storages[int(index)]
        turns = storage.kind == "C" and graph.bonds[storage.bond].domain.flow_unit == "rad/s"
        return "rad" if turns else ""
    return ""


def _of_input(k: int, graph: FlatGraph, within: frozenset[int]) -> str | None:
    """Return the word of an input: of all sources it is a term of, and terms it stands beside."""
    if -1 - k in within:
        return None
    if graph.inputs[k].dimension not in _SHARED:
        return ""
    name, within = f"u:{k}", within | {-1 - k}
    words: set[str | None] = set()
    for node in graph.nodes:
        if node.kind in SOURCES and node.law and _is_term(name, node.law.expressions[0], graph):
            words.add(_of_name(f"{node.law.output}:{node.ends[0].bond}", graph, within))
    for tree in (*graph.signals.values(), *(i.rate for i in graph.integrals)):
        for e, _ in walk(tree):
            if isinstance(e, Compare) or (isinstance(e, Binary) and e.op in ("+", "-")):
                sides = (e.left, e.right)
                if any(_is_term(name, side, graph) for side in sides):
                    words.add(_common(sides, graph, within))
    # a gain of 1 in some unit is gone from a law: what stands there alone may have another one
    said = {w for w in words if w and parse_unit(w)[1] == graph.inputs[k].dimension}
    return next(iter(said), "") if len(said) < 2 else ""


def _is_term(name: str, e: Expr, graph: FlatGraph) -> bool:
    """Whether a name alone is an expression, one of its terms, or that times a bare number."""
    match e:
        case Name(path):
            return path == name
        case Neg(arg) | Pre(arg):
            return _is_term(name, arg, graph)
        case Binary("+" | "-", left, right) | If(_, left, right):
            return _is_term(name, left, graph) or _is_term(name, right, graph)
        case Call(function, args) if function in _KEEP:
            return any(_is_term(name, arg, graph) for arg in args)
        case Binary("*", Number(_, None), arg) | Binary("*" | "/", arg, Number(_, None)):
            return _is_term(name, arg, graph)
    return False
