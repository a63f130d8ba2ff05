"""Annotations of portable Python as types."""

from __future__ import annotations

import ast
from collections.abc import Mapping

from hybond.translate.errors import PortableError
from hybond.translate.expressions import Surroundings
from hybond.translate.tree import BOOL, FLOAT, FLOATS, INT, INTS, TEXT, VOID, Type

_TYPES: Mapping[str, Type] = {
    "int": INT,
    "float": FLOAT,
    "bool": BOOL,
    "Text": TEXT,
    "Floats": FLOATS,
    "Ints": INTS,
}


def annotated_type(node: ast.expr, around: Surroundings) -> Type:
    """Return the type that an annotation names.

    Raises
    ------
    PortableError
    """
    match node:
        case ast.Name(id=name) if name in _TYPES:
            return _TYPES[name]
        case ast.Name(id=name) if name in around.records:
            return Type("record", name)
        case ast.Constant(value=None):
            return VOID
        case ast.BinOp(left=left, op=ast.BitOr(), right=ast.Constant(value=None)):
            found = annotated_type(left, around)
            if found.is_reference:
                return found
        case ast.Subscript(value=ast.Name(id="Records"), slice=ast.Name(id=name)):
            if name in around.records:
                return Type("Records", name)
    why = f"{ast.unparse(node)!r} is not a type of the subset"
    raise PortableError(why, place=f"{around.file}:{node.lineno}")
