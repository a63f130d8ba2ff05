"""The unit of a signal in the words of its domain: a torque is in N*m, not in J.

Dimensions do not tell torque from energy or an angle from a number. A bond does, and what is added
to a torque, or is the larger of two, or a number of times a torque, is a torque as well.
"""

from __future__ import annotations

from hybond.model.dimensions import RATED, infer_dimension
from hybond.model.expressions import Expr, Name
from hybond.model.expressions.tree import Binary, Call, If, Neg, Number, Pre
from hybond.model.graph import FlatGraph
from hybond.units import DIMENSIONLESS

_KEEP = ("abs", "min", "max", "hypot")
"""Functions whose value is of the kind of their arguments."""


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
    return "" if text == "1" else text


def _word(e: Expr, graph: FlatGraph, within: frozenset[int]) -> str | None:
    """Return the word that all terms agree on; empty if they do not, None for a number.

    `within` are the integrals in whose rates this stands: one that reads itself says nothing.
    """
    match e:
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
    if kind == "x":
        storage = graph.storages[int(index)]
        turns = storage.kind == "C" and graph.bonds[storage.bond].domain.flow_unit == "rad/s"
        return "rad" if turns else ""
    return ""
