"""Statements of portable Python: from `ast` to the typed tree, comments included."""

from __future__ import annotations

import ast
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from hybond.translate.annotations import annotated_type
from hybond.translate.comments import Comments
from hybond.translate.expressions import (
    ARITHMETIC,
    Scope,
    arithmetic,
    condition,
    expression,
    fits,
    of_type,
)
from hybond.translate.tree import (
    INT,
    NONE,
    VOID,
    Assign,
    Augment,
    Block,
    Call,
    Do,
    Element,
    Expr,
    Field,
    For,
    If,
    Jump,
    Local,
    Notes,
    Return,
    Statement,
    Type,
    Value,
    While,
    Word,
)


@dataclass
class Loop:
    """A loop that is being read; what is assigned wherever a ``break`` leaves it."""

    variable: str | None = None
    at_breaks: list[set[str]] = field(default_factory=list)


@dataclass
class Body:
    """A function's body while it is read."""

    scope: Scope
    result: Type
    """What the function returns."""
    comments: Comments
    loops: list[Loop] = field(default_factory=list)
    alive: bool = True
    """Whether the next statement can be reached."""
    last: int = 0
    """The last line that has been read."""
    limit: int = 0
    """The last line on which a comment may belong to the statement that is read."""

    def block(self, nodes: Sequence[ast.stmt], limit: int) -> Block:
        """Return a block; `limit` is the last line on which a comment may belong to it."""
        read: list[Statement] = []
        for k, node in enumerate(nodes):
            if not self.alive:
                raise self.scope.refuse(node, "this is never reached")
            self.limit = nodes[k + 1].lineno - 1 if k + 1 < len(nodes) else limit
            read.append(self.statement(node, first=not read))
        column = nodes[0].col_offset
        below = self.comments.between(self.last + 1, limit, column)
        for k in range(self.last + 1, limit + 1):
            if k in self.comments.own and self.comments.own[k][0] >= column:
                self.last = k
        return Block(tuple(read), below)

    def statement(self, node: ast.stmt, *, first: bool = False) -> Statement:
        """Return one statement."""
        reader = _READERS.get(type(node))
        if reader is None:
            what = type(node).__name__
            raise self.scope.refuse(node, f"{what} is not a statement of the subset")
        return reader(self, node, self.notes(node, first=first))

    def notes(self, node: ast.stmt, *, first: bool = False) -> Notes:
        """Return the comments of a statement, and go on behind its first line."""
        begin = node.lineno
        above = self.comments.between(self.last + 1, begin - 1)
        gap = not first and any(k in self.comments.blank for k in range(self.last + 1, begin))
        compound = isinstance(node, ast.If | ast.While | ast.For)
        line = begin if compound else node.end_lineno or begin
        behind = self.comments.behind.get(line, "")
        if compound:
            header = node.iter if isinstance(node, ast.For) else node.test  # type: ignore[attr-defined]
            line = header.end_lineno or begin
            behind = self.comments.behind.get(line, "")
        self.last = line
        return Notes(begin, above, behind, gap)

    def declared(self, name: str, wanted: Type, node: ast.AST) -> Local:
        """Return the variable that an assignment gives a value, new or known."""
        scope = self.scope
        if any(loop.variable == name for loop in self.loops):
            raise scope.refuse(node, f"{name!r} is the variable of a loop around this")
        if name not in scope.types:
            if name.startswith("_"):
                raise scope.refuse(node, f"no variable can be called {name!r}")
            if wanted in (NONE, VOID):
                raise scope.refuse(node, f"{name!r} has no type yet", f"{name}: Kind | None = None")
            scope.types[name] = wanted
        known = scope.types[name]
        if not fits(wanted, known):
            raise scope.refuse(node, f"{name!r} is {known}, and gets {wanted}")
        scope.assigned.add(name)
        return Local(name, known)


def _assign(body: Body, node: ast.stmt, notes: Notes) -> Statement:
    assert isinstance(node, ast.Assign)
    if len(node.targets) != 1:
        raise body.scope.refuse(node, "two targets at once")
    target = node.targets[0]
    value = expression(node.value, body.scope)
    if isinstance(target, ast.Name):
        return Assign(body.declared(target.id, value.type, node), value, notes)
    place = _place(target, body.scope)
    if not fits(value.type, place.type):
        raise body.scope.refuse(node, f"{place.type} is wanted, this is {value.type}")
    return Assign(place, value, notes)


def _annotated(body: Body, node: ast.stmt, notes: Notes) -> Statement:
    assert isinstance(node, ast.AnnAssign)
    scope = body.scope
    if not isinstance(node.target, ast.Name) or node.value is None:
        raise scope.refuse(node, "an annotation comes with a name and a value")
    wanted = annotated_type(node.annotation, scope.around)
    value = of_type(node.value, wanted, scope)
    if node.target.id in scope.types:
        raise scope.refuse(node, f"{node.target.id!r} is declared already")
    return Assign(body.declared(node.target.id, wanted, node), value, notes)


def _augmented(body: Body, node: ast.stmt, notes: Notes) -> Statement:
    assert isinstance(node, ast.AugAssign)
    op = ARITHMETIC.get(type(node.op))
    if op is None:
        raise body.scope.refuse(node, "this operator is not in the subset")
    if isinstance(node.target, ast.Name):
        target = expression(ast.copy_location(ast.Name(node.target.id), node), body.scope)
        if not isinstance(target, Local):
            raise body.scope.refuse(node, f"{node.target.id!r} is a constant")
        if any(loop.variable == target.name for loop in body.loops):
            raise body.scope.refuse(node, f"{target.name!r} is the variable of a loop around this")
        place: Local | Field | Element = target
    else:
        place = _place(node.target, body.scope)
    value = expression(node.value, body.scope)
    result = arithmetic(op, place, value, node, body.scope)
    if result.type != place.type:
        raise body.scope.refuse(node, f"{place.type} is wanted, this is {result.type}")
    return Augment(op, place, value, notes)


def _place(node: ast.expr, scope: Scope) -> Field | Element:
    if not isinstance(node, ast.Attribute | ast.Subscript):
        raise scope.refuse(node, "a value goes to a name, an element or a field")
    place = expression(node, scope)
    if not isinstance(place, Field | Element):
        raise scope.refuse(node, f"{ast.unparse(node)!r} does not change")
    return place


def _if(body: Body, node: ast.stmt, notes: Notes) -> Statement:
    assert isinstance(node, ast.If)
    scope, before = body.scope, None
    branches: list[tuple[Expr, Block]] = []
    others: list[Notes] = []
    ends: list[set[str]] = []
    end = body.limit
    here: ast.If | None = node
    orelse: Block | None = None
    alive = False
    while here is not None:
        cond = condition(here.test, scope)
        before = set(scope.assigned)
        following = here.orelse
        chained = len(following) == 1 and isinstance(following[0], ast.If)
        is_elif = chained and following[0].col_offset == here.col_offset
        limit = following[0].lineno - 1 if following else end
        branches.append((cond, body.block(here.body, limit)))
        if body.alive:
            ends.append(set(scope.assigned))
        alive, body.alive = alive or body.alive, True
        scope.assigned = set(before)
        if is_elif:
            here = following[0]  # type: ignore[assignment]
            assert here is not None
            others.append(body.notes(here, first=True))
            continue
        if following:
            others.append(_else_notes(body, following[0]))
            orelse = body.block(following, end)
            if body.alive:
                ends.append(set(scope.assigned))
            alive = alive or body.alive
        else:
            ends.append(before)
            alive = True
        here = None
    body.alive = alive
    scope.assigned = set.intersection(*ends) if ends else scope.assigned
    return If(tuple(branches), orelse, notes, tuple(others))


def _else_notes(body: Body, first: ast.stmt) -> Notes:
    """Return the notes of an ``else``, whose line the tree does not tell."""
    above = body.comments.between(body.last + 1, first.lineno - 1)
    lines = range(body.last + 1, first.lineno)
    behind = next((body.comments.behind[k] for k in lines if k in body.comments.behind), "")
    body.last = max(body.last, first.lineno - 1)
    return Notes(first.lineno, above, behind)


def _while(body: Body, node: ast.stmt, notes: Notes) -> Statement:
    assert isinstance(node, ast.While)
    scope = body.scope
    if node.orelse:
        raise scope.refuse(node, "a loop has no else")
    cond = condition(node.test, scope)
    forever = isinstance(cond, Value) and cond.value is True
    before = set(scope.assigned)
    loop = Loop()
    body.loops.append(loop)
    block = body.block(node.body, body.limit)
    body.loops.pop()
    body.alive = not forever or bool(loop.at_breaks)
    scope.assigned = set.intersection(*loop.at_breaks) if forever and loop.at_breaks else before
    return While(cond, block, notes)


def _for(body: Body, node: ast.stmt, notes: Notes) -> Statement:
    assert isinstance(node, ast.For)
    scope = body.scope
    if node.orelse:
        raise scope.refuse(node, "a loop has no else")
    call = node.iter
    ranged = isinstance(call, ast.Call) and isinstance(call.func, ast.Name)
    if not (ranged and call.func.id == "range" and 1 <= len(call.args) <= 3):  # type: ignore[attr-defined]
        raise scope.refuse(node, "a loop goes over range(...)")
    assert isinstance(call, ast.Call)
    if not isinstance(node.target, ast.Name):
        raise scope.refuse(node, "a loop has one variable")
    name = node.target.id
    if name.startswith("_") and name != "_":
        raise scope.refuse(node, f"no variable can be called {name!r}")
    if name in scope.assigned:
        why = f"{name!r} is a variable of the function, too"
        raise scope.refuse(node, why, "the variable of a loop belongs to it alone")
    bounds = [of_type(a, INT, scope) for a in call.args[:2]]
    start, stop = (Value(0, INT), bounds[0]) if len(bounds) == 1 else bounds
    step = _step(call.args[2], scope) if len(call.args) == 3 else 1
    before = set(scope.assigned)
    other, read = scope.types.get(name), name in scope.read
    scope.types[name] = INT
    scope.assigned.add(name)
    body.loops.append(Loop(name))
    block = body.block(node.body, body.limit)
    body.loops.pop()
    del scope.types[name]
    if other is not None:  # a variable of blocks before
        scope.types[name] = other
    if not read:
        scope.read.discard(name)
    scope.assigned = before
    body.alive = True
    return For(name, start, stop, step, block, notes)


def _step(node: ast.expr, scope: Scope) -> int:
    negative = isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub)
    literal = node.operand if isinstance(node, ast.UnaryOp) else node
    if not isinstance(literal, ast.Constant) or type(literal.value) is not int or not literal.value:
        raise scope.refuse(node, "the step of a range is a literal")
    return -literal.value if negative else literal.value


def _jump(body: Body, node: ast.stmt, notes: Notes) -> Statement:
    if isinstance(node, ast.Pass):
        return Jump("pass", notes)
    if isinstance(node, ast.Break):
        body.loops[-1].at_breaks.append(set(body.scope.assigned))
    body.alive = False
    return Jump("break" if isinstance(node, ast.Break) else "continue", notes)


def _return(body: Body, node: ast.stmt, notes: Notes) -> Statement:
    assert isinstance(node, ast.Return)
    if (node.value is None) != (body.result == VOID):
        raise body.scope.refuse(node, f"the function returns {body.result}")
    value = None if node.value is None else of_type(node.value, body.result, body.scope)
    body.alive = False
    return Return(value, notes)


def _do(body: Body, node: ast.stmt, notes: Notes) -> Statement:
    assert isinstance(node, ast.Expr)
    if not isinstance(node.value, ast.Call):
        raise body.scope.refuse(node, "an expression whose value goes nowhere")
    call = expression(node.value, body.scope)
    if not isinstance(call, Call | Word) or (isinstance(call, Word) and call.type != VOID):
        raise body.scope.refuse(node, "a value that goes nowhere")
    return Do(call, notes)


_READERS: Mapping[type[ast.stmt], Callable[[Body, ast.stmt, Notes], Statement]] = {
    ast.Assign: _assign,
    ast.AnnAssign: _annotated,
    ast.AugAssign: _augmented,
    ast.If: _if,
    ast.While: _while,
    ast.For: _for,
    ast.Break: _jump,
    ast.Continue: _jump,
    ast.Pass: _jump,
    ast.Return: _return,
    ast.Expr: _do,
}
