"""Equations and structure of a model as the page shows them: formulas as trees of MathML."""

from __future__ import annotations

import re
from typing import Any
from xml.etree import ElementTree

from hybond.equations.derive import state_equations
from hybond.model.graph import FlatGraph, Mode

LONGEST = 40_000
"""Characters of LaTeX up to which equations are set as formulas; beyond, they are text."""
_TAGS = frozenset(
    ("math", "mrow", "mi", "mo", "mn", "mtext", "mspace", "mfrac", "msub", "msup", "msubsup")
    + ("mover", "munder", "munderover", "msqrt", "mroot", "mtable", "mtr", "mtd", "mstyle")
)
_KEPT = ("width", "stretchy", "mathvariant")
Tree = list[Any]
"""A tag, its attributes, then texts and trees."""


def equations(graph: FlatGraph, mode: Mode | None) -> dict[str, Any]:
    """Return the equations of one mode, or of all with Booleans.

    Returns
    -------
    dict
        ``text``; ``formula``, a tree of MathML, None where there is nothing to set them with or
        they are too long; ``notes``, what the Booleans are.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("rc", domain="electrical")
    >>> m.add(c=hb.C("1 mF", e="10 V"), r=hb.R("1 kohm"), node=hb.Zero())
    >>> m.bond("node -> c", "node -> r")
    >>> equations(m.flatten(), None)["text"]
    "c.q' = -c.q/(c.C*r.R)"
    """
    found = state_equations(graph)
    latex = found.latex(mode)
    notes = re.findall(r"^% (.*)$", latex, re.MULTILINE)
    body = re.sub(r"^%.*$\n?", "", latex, flags=re.MULTILINE).strip()
    return {
        "text": "\n".join(t for t in found.text(mode).splitlines() if not t.startswith("# ")),
        "formula": formula(body) if len(body) <= LONGEST else None,
        "notes": notes,
    }


def formula(latex: str) -> Tree | None:
    r"""Return LaTeX as a tree of MathML; None without latex2mathml (extra ``studio``).

    Examples
    --------
    >>> formula(r"p_{\mathrm{ball}}")[2]
    ['mrow', {}, ['msub', {}, ['mi', {}, 'p'], ['mi', {'mathvariant': 'normal'}, 'ball']]]
    """
    try:
        from latex2mathml.converter import convert
    except ImportError:
        return None
    return _tree(ElementTree.fromstring(convert(latex)))


def _tree(e: ElementTree.Element) -> Tree:
    """Return an element of MathML; words that were set letter by letter are words again."""
    tag = e.tag.rpartition("}")[2]
    children = [_tree(child) for child in e]
    if tag not in _TAGS:
        tag = "mrow"
    word = children and all(_upright(c) for c in children)
    if tag == "mrow" and word:
        return ["mi", {"mathvariant": "normal"}, "".join(c[2] for c in children)]
    if tag == "mrow" and len(children) == 1 and _upright(children[0]):
        return children[0]
    text = (e.text or "").strip()
    kept = {k: v for k, v in e.attrib.items() if k in _KEPT}
    return [tag, kept, *([text] if text else []), *children]


def _upright(tree: Tree) -> bool:
    return tree[0] == "mi" and tree[1].get("mathvariant") == "normal" and len(tree) == 3


def structure(graph: FlatGraph) -> str:
    """Return the structure of the modes that the machines can reach, as `hybond analyse` does."""
    from hybond.analysis.structure.structure import structure as analysed

    return str(analysed(graph, modes="reachable"))
