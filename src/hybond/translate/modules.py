"""Modules of portable Python: their declarations, and the program they make together."""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from hybond.translate.annotations import annotated_type
from hybond.translate.comments import Comments, comments_of
from hybond.translate.errors import PortableError
from hybond.translate.expressions import (
    MATH_CONSTANTS,
    MOST,
    ONE_FLOAT,
    OTHER_WORDS,
    TWO_FLOATS,
    WORDS,
    Scope,
    Surroundings,
)
from hybond.translate.reserved import GLOBALS
from hybond.translate.statements import Body
from hybond.translate.tree import (
    BOOL,
    FLOAT,
    FLOATS,
    INT,
    INTS,
    TEXT,
    VOID,
    Block,
    Constant,
    Function,
    Member,
    Module,
    Record,
    Signature,
    Type,
)


@dataclass(frozen=True, slots=True)
class Program:
    r"""Portable modules, each after those that it imports.

    Examples
    --------
    >>> program = load_texts({"half": "def half(x: float) -> float:\n    return x / 2.0\n"})
    >>> program.functions["half"].signature.result
    Type(kind='float', record='')
    """

    modules: tuple[Module, ...]

    @property
    def constants(self) -> dict[str, Constant]:
        """All constants by their printed name."""
        return {v.name: v for m in self.modules for v in m.constants.values()}

    @property
    def records(self) -> dict[str, Record]:
        """All records by name."""
        return {k: v for m in self.modules for k, v in m.records.items()}

    @property
    def functions(self) -> dict[str, Function]:
        """All functions by their printed name."""
        return {v.name: v for m in self.modules for v in m.functions.values()}


def text_of(path: Path) -> str:
    """Return the text of a module."""
    return path.read_text(encoding="utf-8")


def load(
    paths: Iterable[Path],
    among: Iterable[Path] = (),
    read: Callable[[Path], str] = text_of,
) -> Program:
    """Read portable modules, and those that they import: `among` others, or of the same folder.

    The last part of a module's name tells it from all others. `read` returns the text of each.

    Raises
    ------
    PortableError
        HB-E601.
    """
    known = {path.stem: path for path in among}
    raw: dict[str, _Raw] = {}
    waiting = list(paths)
    while waiting:
        path = waiting.pop()
        if path.stem in raw:
            continue
        found = raw[path.stem] = _Raw.of(path.stem, path.name, read(path))
        for name in _imported_modules(found.tree):
            waiting.append(known.get(name, path.with_name(f"{name}.py")))
    return _program(raw)


def load_texts(texts: Mapping[str, str]) -> Program:
    """Read portable modules that are given as texts.

    Parameters
    ----------
    texts : mapping of str to str
        The source of each module, by the last part of its name.

    Raises
    ------
    PortableError
        HB-E601 for anything outside the subset.
    """
    return _program({name: _Raw.of(name, f"{name}.py", text) for name, text in texts.items()})


def _program(raw: Mapping[str, _Raw]) -> Program:
    ordered = _in_order({n: raw[n] for n in sorted(raw)})
    _distinct(ordered)
    modules: dict[str, Module] = {}
    for r in ordered:
        modules[r.name] = r.declared(modules)
    return Program(tuple(r.with_bodies(modules) for r in ordered))


def _imported_modules(tree: ast.Module) -> list[str]:
    """Return the portable modules that a module imports, but `words`."""
    found = []
    for node in tree.body:
        if isinstance(node, ast.ImportFrom) and node.module not in ("__future__", "typing"):
            name = (node.module or "").rpartition(".")[2]
            if name != "words" and name not in found:
                found.append(name)
    return found


def _in_order(raw: Mapping[str, _Raw]) -> list[_Raw]:
    done: list[_Raw] = []
    begun: list[str] = []

    def visit(name: str, asked_by: _Raw | None) -> None:
        if any(r.name == name for r in done):
            return
        if name not in raw:
            assert asked_by is not None
            raise asked_by.refuse(1, f"there is no portable module {name!r}")
        if name in begun:
            raise raw[name].refuse(1, f"the imports go round: {' -> '.join([*begun, name])}")
        begun.append(name)
        for other in _imported_modules(raw[name].tree):
            visit(other, raw[name])
        begun.pop()
        done.append(raw[name])

    for name in raw:
        visit(name, None)
    return done


def _distinct(modules: Iterable[_Raw]) -> None:
    """Decide what constants and functions are called where all modules stand in one file.

    That is their own name, and with the module's before it where several modules or a language have
    it. Two records of one name are refused.
    """
    homes: dict[str, list[_Raw]] = {}
    for r in modules:
        for name, node in r.declarations.items():
            is_record = isinstance(node, ast.ClassDef)
            words = GLOBALS if is_record else frozenset()
            if name.startswith("_") or name in {*WORDS, *OTHER_WORDS, *words}:
                raise r.refuse(node.lineno, f"nothing can be called {name!r}", "another name")
            homes.setdefault(name, []).append(r)
    for name, found in homes.items():
        for r in found:
            shown = name
            if len(found) > 1 or name in GLOBALS:
                node = r.declarations[name]
                if any(isinstance(o.declarations[name], ast.ClassDef) for o in found):
                    other = next(o for o in found if o is not r)
                    why = f"{name!r} is declared in {other.file}, too"
                    raise r.refuse(node.lineno, why, "one name, one record, in all modules")
                shown = f"{r.name.upper() if name.isupper() else r.name}_{name}"
                if shown in homes:
                    raise r.refuse(node.lineno, f"{shown!r} is declared, too", "another name")
            r.printed[name] = shown


@dataclass
class _Raw:
    """A module while it is read."""

    name: str
    file: str
    tree: ast.Module
    comments: Comments
    declarations: dict[str, ast.stmt] = field(default_factory=dict)
    words: set[str] = field(default_factory=set)
    seen: dict[str, str] = field(default_factory=dict)
    """What is imported from other portable modules: name to module."""
    printed: dict[str, str] = field(default_factory=dict)
    """What is declared here, by the names that it has in one file."""

    @classmethod
    def of(cls, name: str, file: str, text: str) -> _Raw:
        made = cls(name, file, ast.parse(text, file), comments_of(text))
        for k, node in enumerate(made.tree.body):
            made.top(node, first=k == 0)
        return made

    def refuse(self, line: int, why: str, hint: str = "") -> PortableError:
        return PortableError(why, place=f"{self.file}:{line}", hint=hint)

    def top(self, node: ast.stmt, *, first: bool) -> None:
        """Take one statement of the module."""
        match node:
            case ast.Expr(value=ast.Constant(value=str())):
                return
            case ast.Import():
                if [a.name for a in node.names] != ["math"] or node.names[0].asname:
                    raise self.refuse(node.lineno, "only `import math` is portable")
                return
            case ast.ImportFrom():
                return self.imported(node)
            case ast.AnnAssign(target=ast.Name(id=name)):
                pass
            case ast.ClassDef(name=name) | ast.FunctionDef(name=name):
                pass
            case _:
                what = type(node).__name__
                raise self.refuse(node.lineno, f"{what} does not stand at the top of a module")
        if name in self.declarations:
            raise self.refuse(node.lineno, f"{name!r} is declared twice")
        self.declarations[name] = node

    def imported(self, node: ast.ImportFrom) -> None:
        if node.module in ("__future__", "typing"):
            if {a.name for a in node.names} <= {"annotations", "Final"}:
                return
            raise self.refuse(node.lineno, "only Final comes from typing")
        module = (node.module or "").rpartition(".")[2]
        for a in node.names:
            if a.asname:
                raise self.refuse(node.lineno, "an import does not rename")
            if module != "words":
                self.seen[a.name] = module
            elif a.name in WORDS or a.name in OTHER_WORDS:
                self.words.add(a.name)
            else:
                raise self.refuse(node.lineno, f"{a.name!r} is not a word of the subset")

    def around(self, modules: Mapping[str, Module], own: Module) -> Surroundings:
        """Return what the names of this module mean."""
        constants, records = dict(own.constants), dict(own.records)
        functions = {k: f.signature for k, f in own.functions.items()}
        for name, module in self.seen.items():
            there = modules[module]
            if name in there.constants:
                constants[name] = there.constants[name]
            elif name in there.records:
                records[name] = there.records[name]
            elif name in there.functions:
                functions[name] = there.functions[name].signature
            else:
                raise self.refuse(1, f"{module} has no {name!r}")
        # fields lead to records that are not imported by name
        for other in modules.values():
            for name, record in other.records.items():
                records.setdefault(name, record)
        return Surroundings(self.file, constants, records, functions, frozenset(self.words))

    def declared(self, modules: Mapping[str, Module]) -> Module:
        """Return the module without bodies."""
        doc = ast.get_docstring(self.tree) or ""
        own = Module(self.name, doc, tuple(_imported_modules(self.tree)))
        classes = {k: n for k, n in self.declarations.items() if isinstance(n, ast.ClassDef)}
        for name, node in classes.items():
            own.records[name] = Record(name, (), "", f"{self.file}:{node.lineno}")
        around = self.around(modules, own)
        for name, node in classes.items():
            own.records[name] = self.record(node, around)
        around = self.around(modules, own)
        for name, declaration in self.declarations.items():
            if isinstance(declaration, ast.AnnAssign):
                known = {**around.constants, **own.constants}
                own.constants[name] = self.constant(name, declaration, known)
            elif isinstance(declaration, ast.FunctionDef):
                own.functions[name] = self.function(declaration, around)
        return Module(
            own.name,
            own.doc,
            own.imports,
            own.constants,
            own.records,
            own.functions,
            tuple(self.declarations),
        )

    def marks(self, node: ast.ClassDef | ast.FunctionDef) -> set[str]:
        """Return the names of the decorators."""
        found = {d.id if isinstance(d, ast.Name) else "?" for d in node.decorator_list}
        if not found <= {"record", "given"}:
            raise self.refuse(node.lineno, "only @record and @given are in the subset")
        return found

    def record(self, node: ast.ClassDef, around: Surroundings) -> Record:
        marks = self.marks(node)
        if not marks or node.bases or node.keywords:
            raise self.refuse(node.lineno, "a class is a plain @record")
        members: list[Member] = []
        last = node.lineno
        for line in node.body:
            match line:
                case ast.Expr(value=ast.Constant(value=str(text))):
                    if members:
                        m = members[-1]
                        note = m.note or " ".join(text.split())
                        members[-1] = Member(m.name, m.type, note, m.above)
                case ast.AnnAssign(target=ast.Name(id=name), value=None):
                    above = self.comments.between(last + 1, line.lineno - 1)
                    note = self.comments.behind.get(line.lineno, "")
                    if name.startswith("_"):
                        raise self.refuse(line.lineno, f"no field can be called {name!r}")
                    if ast.unparse(line.annotation) != "Outside":
                        found = annotated_type(line.annotation, around)
                        members.append(Member(name, found, note, above))
                case _:
                    raise self.refuse(line.lineno, "a record has annotated fields, and no more")
            last = line.end_lineno or line.lineno
        doc = ast.get_docstring(node) or ""
        place = f"{self.file}:{node.lineno}"
        return Record(node.name, tuple(members), doc, place, "given" in marks)

    def constant(self, name: str, node: ast.AnnAssign, known: Mapping[str, Constant]) -> Constant:
        text = ast.unparse(node.annotation)
        if not text.startswith("Final") or node.value is None:
            raise self.refuse(node.lineno, "what stands at the top is Final and has a value")
        value = self.folded(node.value, known)
        kinds: dict[type, Type] = {bool: BOOL, int: INT, float: FLOAT, str: TEXT}
        if isinstance(value, tuple):
            found = INTS if all(type(v) is int for v in value) else FLOATS
            if ast.unparse(node.value).startswith("float_table"):
                found, value = FLOATS, tuple(float(v) for v in value)
        else:
            found = kinds[type(value)]
        if isinstance(value, int) and abs(value) > MOST:
            raise self.refuse(node.lineno, f"{value} does not fit 32 bits")
        above = self.comments.between(self._before(node) + 1, node.lineno - 1)
        behind = self.comments.behind.get(node.end_lineno or node.lineno, "")
        behind = behind or self._docstring_below(node)
        place = f"{self.file}:{node.lineno}"
        return Constant(self.printed[name], found, value, above, behind, place)

    def _before(self, node: ast.stmt) -> int:
        """Return the last line of what stands before a statement of the module."""
        k = self.tree.body.index(node)
        return (self.tree.body[k - 1].end_lineno or 0) if k else 0

    def _next(self, node: ast.stmt) -> int:
        """Return the first line of what stands behind a statement of the module."""
        k = self.tree.body.index(node) + 1
        if k == len(self.tree.body):
            return 1 + max([node.end_lineno or 0, *self.comments.own, *self.comments.blank])
        following = self.tree.body[k]
        if isinstance(following, ast.ClassDef | ast.FunctionDef):
            return min([following.lineno, *(d.lineno for d in following.decorator_list)])
        return following.lineno

    def _docstring_below(self, node: ast.stmt) -> str:
        k = self.tree.body.index(node) + 1
        match self.tree.body[k : k + 1]:
            case [ast.Expr(value=ast.Constant(value=str(text)))]:
                return " ".join(text.split())
        return ""

    def folded(self, node: ast.expr, known: Mapping[str, Constant]) -> Any:
        """Return the value of a constant's expression."""

        def value(e: ast.expr) -> Any:
            return self.folded(e, known)

        match node:
            case ast.Constant(value=bool() | int() | float() | str() as literal):
                return literal
            case ast.Name(id=name) if name in known:
                return known[name].value
            case ast.UnaryOp(op=ast.USub(), operand=arg):
                return -value(arg)
            case ast.BinOp(left=left, op=op, right=right) if type(op) in _FOLDED:
                return _FOLDED[type(op)](value(left), value(right))
            case ast.Attribute(value=ast.Name(id="math"), attr=name) if name in MATH_CONSTANTS:
                return getattr(math, name)
            case ast.Call(func=ast.Attribute(value=ast.Name(id="math"), attr=name), args=args):
                if name in ONE_FLOAT | TWO_FLOATS:
                    return float(getattr(math, name)(*map(value, args)))
            case ast.Call(func=ast.Name(id="float_table" | "int_table" as word), args=args):
                if word not in self.words:
                    raise self.refuse(node.lineno, f"import {word}")
                return tuple(map(value, args))
        raise self.refuse(node.lineno, f"{ast.unparse(node)!r} is not a constant of the subset")

    def function(self, node: ast.FunctionDef, around: Surroundings) -> Function:
        marks = self.marks(node)
        given = node.args
        if given.vararg or given.kwarg or given.kwonlyargs or given.defaults or given.posonlyargs:
            raise self.refuse(node.lineno, "parameters are plain names, without defaults")
        parameters: list[tuple[str, Type]] = []
        for a in given.args:
            if a.annotation is None:
                raise self.refuse(node.lineno, f"{a.arg!r} has no annotation")
            if a.arg.startswith("_"):
                raise self.refuse(node.lineno, f"no parameter can be called {a.arg!r}")
            parameters.append((a.arg, annotated_type(a.annotation, around)))
        if node.returns is None:
            raise self.refuse(node.lineno, f"{node.name} does not say what it returns")
        signature = Signature(
            self.printed[node.name], tuple(parameters), annotated_type(node.returns, around)
        )
        first = min([node.lineno, *(d.lineno for d in node.decorator_list)])
        above = self.comments.between(self._before(node) + 1, first - 1)
        body = None if "given" in marks else Block(())
        doc = ast.get_docstring(node) or ""
        return Function(signature, doc, body, f"{self.file}:{node.lineno}", above)

    def with_bodies(self, modules: Mapping[str, Module]) -> Module:
        """Return the whole module."""
        own = modules[self.name]
        around = self.around(modules, own)
        for name, f in list(own.functions.items()):
            node = self.declarations[name]
            assert isinstance(node, ast.FunctionDef)
            if f.body is not None:
                body = self.body(node, f.signature, around)
                own.functions[name] = Function(f.signature, f.doc, body, f.place, f.above)
        return own

    def body(self, node: ast.FunctionDef, signature: Signature, around: Surroundings) -> Block:
        types = dict(signature.parameters)
        scope = Scope(around, dict(types), set(types))
        reading = Body(scope, signature.result, self.comments)
        reading.last = (node.returns.end_lineno or node.lineno) if node.returns else node.lineno
        statements = node.body
        match statements:
            case [ast.Expr(value=ast.Constant(value=str())) as text, *rest]:
                statements = rest
                reading.last = text.end_lineno or text.lineno
        if not statements:
            return Block(())
        block = reading.block(statements, self._next(node) - 1)
        if reading.alive and signature.result != VOID:
            raise self.refuse(node.lineno, f"{node.name} may end without a result")
        unread = [n for n in scope.types if n not in scope.read and n not in types]
        if unread:
            raise self.refuse(node.lineno, f"{node.name} never reads {unread[0]!r}")
        return block


_FOLDED: Mapping[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Pow: operator.pow,
    ast.LShift: operator.lshift,
    ast.BitOr: operator.or_,
}
