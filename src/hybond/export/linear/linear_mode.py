"""A linear mode as rows whose coefficients depend on no point, and its inputs."""

from __future__ import annotations

from dataclasses import dataclass

from hybond.equations.linear_rows import LinearRows, linear_rows
from hybond.model.expressions import Expr, Number, names
from hybond.model.graph import FlatGraph, Mode, Node
from hybond.model.kinds import SOURCES


@dataclass(frozen=True, slots=True)
class Extended:
    """The rows of a mode and what drives them."""

    rows: LinearRows
    inputs: tuple[str, ...]
    """Every input of the model and every source."""
    default: tuple[int, ...]
    """Those that come from outside."""


def extended(graph: FlatGraph, mode: Mode, outputs: tuple[str, ...]) -> Extended:
    """Return all equations of a mode.

    Raises
    ------
    EquationError
        HB-E671 for what is not linear, HB-Q103 for a nonlinear law, HB-Q105 if the mode leaves a
        variable open.
    """
    sources = [n for n in graph.nodes if n.kind in SOURCES and _value(n) != Number(0.0)]
    inputs = [f"u:{i.index}" for i in graph.inputs] + [f"source:{n.index}" for n in sources]
    rows = linear_rows(
        graph, mode, None, inputs=inputs, outputs={text: graph.signal(text) for text in outputs}
    )
    many = len(graph.inputs)
    default = [k for k in range(many) if rows.B[:, k].any()]
    default += [many + j for j, n in enumerate(sources) if _is_free(_value(n))]
    paths = (*(i.path for i in graph.inputs), *(n.path for n in sources))
    return Extended(rows, paths, tuple(default))


def _value(node: Node) -> Expr:
    assert node.law is not None
    return node.law.expressions[0]


def _is_free(value: Expr) -> bool:
    """Whether a source reads nothing but the time."""
    return all(name == "time" or name.startswith("at:") for name in names(value))
