"""What an exported file says first: the model as it was written, and its equations."""

from __future__ import annotations

import textwrap

from hybond.equations.derive import state_equations
from hybond.errors import HybondError
from hybond.files import dumps
from hybond.model.builder import Model
from hybond.model.graph import FlatGraph
from hybond.translate.lines import plain

WRITTEN = 300
"""Lines of a model above which it is not repeated in what is exported from it."""
SMALL = 60
"""Bonds up to which the equations of all modes are written, too."""
WIDTH = 92


def title_of(graph: FlatGraph) -> str:
    """Return what the model is called."""
    return graph.title or graph.name or "a hybrid bond graph"


def story(model: Model, graph: FlatGraph) -> list[str]:
    """Return the lines of a comment: the model file, and the mixed-Boolean state equations.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("rc")
    >>> m.add(c=hb.C(2.0), r=hb.R(5.0))
    >>> m.bond("c -> r")
    >>> lines = story(m, m.flatten())
    >>> lines[lines.index("State equations:") :]
    ['State equations:', '', "    c.q' = -c.q/(c.C*r.R)"]
    """
    written = dumps(model, inline=True).splitlines()
    if len(written) > WRITTEN:
        written = [f"({len(written)} lines, not repeated here)"]
    lines = ["The model:", "", *(f"    {line}".rstrip() for line in written)]
    equations = _equations(graph)
    if equations:
        lines += ["", "State equations:", "", *(f"    {line}" for line in equations)]
    return [plain(part) for line in lines for part in _folded(line)]


def _equations(graph: FlatGraph) -> list[str]:
    if len(graph.bonds) > SMALL:
        return []
    try:
        return str(state_equations(graph)).splitlines()
    except HybondError:  # nonlinear storage, junction laws: there is no such form
        return []


def _folded(line: str) -> list[str]:
    if len(line) <= WIDTH:
        return [line]
    indent = " " * (len(line) - len(line.lstrip()) + 4)
    return textwrap.wrap(
        line, WIDTH, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False
    )
