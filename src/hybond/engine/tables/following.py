"""Which parameters can be changed in what is exported: tables that know what they are made of.

The parameters of a model are followed into its tables. Where a number loses its way, in a matrix or
in an iteration, nothing shows that; so the tables are made anew with other values of all
parameters at once, and must come out as the first ones say: the same parts, and the same expression
of the parameters at each place. What fails that stays a number, with the reason.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from hybond.engine.tables.columns import ModelTables
from hybond.engine.tables.make import tables_of
from hybond.errors import HybondError
from hybond.model.builder import Model
from hybond.model.expressions import (
    Binary,
    Call,
    Compare,
    Expr,
    Neg,
    Number,
    Table,
    compile_expression,
    names,
    to_text,
    transform,
)
from hybond.model.expressions.traced import PREFIX, Followed, Traced, Trail, tree_of
from hybond.model.expressions.tree import walk
from hybond.model.flatten import flatten
from hybond.model.graph import FlatGraph

SIZES = (1e-3, 3e-2)
"""By which part of its value a parameter is moved: first those that are numbers, then all."""
SMALLEST = 1e-9
"""The part below which no values are looked for that meet all conditions."""
LOOKS = 64
"""How often tables are made anew to find out which parameters go where nothing is followed."""
UNKNOWN = "it goes where values are not followed"
GOLDEN = 0.6180339887498949

Values = Mapping[str, float]


@dataclass(slots=True)
class Following:
    """The tables of a model, and what is known of its parameters.

    Parameters
    ----------
    tables : ModelTables
        With numbers that are `Traced` where they follow from parameters.
    graph : FlatGraph
        Of the model as it is, with plain numbers.
    trail : Trail
    fixed : dict
        Parameters that stay numbers, and why.
    """

    tables: ModelTables
    graph: FlatGraph
    trail: Trail
    fixed: dict[str, str] = field(default_factory=dict)


def followed(
    model: Model, prepared: Callable[[FlatGraph], FlatGraph], options: Mapping[str, Any]
) -> Following:
    """Return the tables of a model whose numbers say how they follow from its parameters.

    Parameters
    ----------
    model : Model
    prepared : callable
        What is done to the flat graph first.
    options : mapping
        Of the run.
    """

    def made(wanted: Collection[str], at: Values) -> Following:
        plain = prepared(flatten(model, at))
        trail = Trail(wanted)
        tables = tables_of(prepared(flatten(model, at, trail)), plain, calling=False, **options)
        for e in (*tables.values.all, *tables.pairs):
            _ask_squares(e)
        return Following(tables, plain, trail)

    fixed: dict[str, str] = {}
    wanted = [*prepared(flatten(model, {})).parameters]
    while True:
        base = made(wanted, {})
        base.fixed = fixed
        proof = _Proof(base, partial(made, wanted))
        gone = {k: f"it goes into {why}" for k, why in base.trail.lost.items()} | proof.pinned
        if wanted and not gone and not proof.holds(wanted):
            gone = {k: proof.refused.get(k, UNKNOWN) for k in proof.culprits(wanted)}
        if not gone:
            return base
        fixed.update(gone)
        wanted = [path for path in wanted if path not in gone]


def _ask_squares(e: Expr) -> None:
    """Ask whether exponents are 2: squares are printed as products."""
    for node, _ in walk(e):
        if isinstance(node, Binary) and node.op == "^" and isinstance(node.right, Number):
            bool(node.right.value == 2.0)


class _Proof:
    """Tables made anew at other values, held against what the first ones say."""

    def __init__(self, base: Following, made: Callable[[Values], Following]) -> None:
        self.base = base
        self.made = made
        self.looks = 0
        self.refused: dict[str, str] = {}
        """Parameters of which another value alone is refused."""
        self.parameters = base.trail.parameters
        self.slots = {PREFIX + path: k for k, path in enumerate(self.parameters)}
        self.rules = {
            path: self._compiled(p.made_of)
            for path, p in self.parameters.items()
            if p.made_of is not None
        }
        self.conditions = [(e, self._compiled(e)) for e in base.trail.conditions]
        self.reading: dict[str, list[int]] = {path: [] for path in self.parameters}
        for k, (e, _) in enumerate(self.conditions):
            for path in self._sources(e):
                self.reading[path].append(k)
        self.direction: dict[str, float] = {}
        self.pinned: dict[str, str] = {}
        for path in self.parameters:
            self._try(path)

    def _compiled(self, e: Expr) -> Callable[[Sequence[float]], Any]:
        found: Callable[[Sequence[float]], Any] = compile_expression(e, self.slots, pre_offset=0)
        return found

    def _sources(self, e: Expr) -> set[str]:
        """Return the parameters that an expression depends on, directly or not."""
        found: set[str] = set()
        waiting = [n.removeprefix(PREFIX) for n in names(e)]
        while waiting:
            path = waiting.pop()
            if path not in found:
                found.add(path)
                made_of = self.parameters[path].made_of
                if made_of is not None:
                    waiting += [n.removeprefix(PREFIX) for n in names(made_of)]
        return found

    def _values(self, at: Values) -> list[float]:
        v: list[float] = []
        for path, p in self.parameters.items():
            if path in at:
                v.append(at[path])
            else:
                v.append(float(self.rules[path](v)) if p.made_of is not None else p.start)
        return v

    def _broken(self, at: Values, which: Sequence[int]) -> Expr | None:
        """Return a condition that does not hold."""
        v = self._values(at)
        return next((self.conditions[k][0] for k in which if not self.conditions[k][1](v)), None)

    def _moved(self, path: str, size: float) -> float:
        p = self.parameters[path]
        own = size * (1.0 + (GOLDEN * self.slots[PREFIX + path]) % 1.0)
        step = self.direction.get(path, 1.0) * own
        return p.start * (1.0 + step) if p.start else step

    def _try(self, path: str) -> None:
        """Find in which direction a parameter can be moved alone; else it is pinned."""
        for self.direction[path] in (1.0, -1.0):
            size = SIZES[0]
            while size >= SMALLEST:
                broken = self._broken({path: self._moved(path, size)}, self.reading[path])
                if broken is None:
                    return
                size /= 10.0
        assert broken is not None
        self.pinned[path] = f"the model is made of other parts where not {condition_text(broken)}"

    def _other(self, paths: Collection[str], size: float) -> dict[str, float] | None:
        """Return other values that meet all conditions together."""
        everything = range(len(self.conditions))
        while size >= SMALLEST:
            at = {path: self._moved(path, size) for path in paths}
            if self._broken(at, everything) is None:
                return at
            size /= 10.0
        return None

    def holds(self, paths: Collection[str]) -> bool:
        """Whether the tables follow these parameters: those that are numbers, then all of them."""
        numbers = [k for k in paths if self.parameters[k].made_of is None]
        for some, size in zip((numbers, paths), SIZES):
            at = self._other(some, size) if some else {}
            if at is None:
                return False
            self.looks += 1
            try:
                found = self.made(at)
            except HybondError as error:
                if len(at) == 1:
                    self.refused.update(dict.fromkeys(at, f"another value alone is {error.code}"))
                return False
            if not self._same(found, at):
                return False
        return True

    def _same(self, found: Following, at: Values) -> bool:
        """Whether tables at other values are those that the first ones say."""
        known, own = self.base.trail.conditions, found.trail.conditions
        # what a parameter is made of is not asked for where its value is given
        given = any(self.parameters[path].made_of is not None for path in at)
        alike = own.keys() <= known.keys() if given else own.keys() == known.keys()
        return alike and _shape(found, at) == _shape(self.base, at)

    def culprits(self, paths: Sequence[str]) -> list[str]:
        """Return parameters of some, which fail together, without which the others hold."""
        if len(paths) == 1 or self.looks > LOOKS:
            return list(paths)
        halves = paths[: len(paths) // 2], paths[len(paths) // 2 :]
        found = [k for half in halves if not self.holds(half) for k in self.culprits(half)]
        return found or list(paths)


def condition_text(e: Expr) -> str:
    """Return a condition in the names of parameters.

    Examples
    --------
    >>> from hybond.model.expressions import Compare, Name
    >>> condition_text(Compare("!=", Name("p:load.R"), Number(0.0)))
    'load.R != 0'
    """
    return to_text(e).replace(PREFIX, "")


def _shape(f: Following, at: Values) -> dict[str, Any]:
    """Return all that tables at other values have in common; `at` are those that are given."""
    t = f.tables
    return {
        "numbers": {k: repr(float(x)) for k, x in t.numbers.items()},
        "ints": t.ints,
        "floats": {k: [_said(x) for x in row] for k, row in t.floats.items()},
        "values": [_compared(e) for e in t.values.all],
        "pairs": [_compared(e) for e in t.pairs],
        "names": (t.machines, t.states, t.stored, t.outputs, t.nodes, t.bonds, t.rules),
        "lost": set(f.trail.lost),
        "parameters": {k: _rule(p) for k, p in f.trail.parameters.items() if k not in at},
    }


def _rule(p: Followed) -> Expr | str:
    return p.made_of or repr(p.start)


def _said(x: float) -> Expr | str:
    return x.tree if isinstance(x, Traced) else repr(float(x))


def _compared(e: Expr) -> Expr:
    """Return an expression whose numbers, those of tables too, are what they are made of."""

    def visit(n: Expr) -> Expr:
        if isinstance(n, Number):
            return tree_of(n.value)
        if isinstance(n, Table):
            points = (tree_of(x) for x in (*n.x, *n.y))
            return Call(f"table {n.extrapolate} {n.slope}", (n.arg, *points))
        return n

    return transform(e, visit)


def conditions_of(trail: Trail) -> Iterator[Expr]:
    """Yield what must hold of the parameters, each in its plainest form once.

    Where no number is infinite, a product is not zero if no factor is, and a quotient if its
    numerator is not.

    Examples
    --------
    >>> trail = Trail(["R", "C"])
    >>> r, c = (trail.follow(k, Number(v)).value for k, v in (("R", 2.0), ("C", 3.0)))
    >>> r != 0, -r != 0, 1 / (r * c) != 0, 2 * c > 1
    (True, True, True, True)
    >>> [condition_text(e) for e in conditions_of(trail)]
    ['R != 0', '2*C > 1']
    """
    plain = dict.fromkeys(c for e in trail.conditions for c in _plainer(e) if names(c))
    for c in plain:
        stronger = (Compare(op, c.left, c.right) for op in "<>") if isinstance(c, Compare) else ()
        if not (isinstance(c, Compare) and c.op == "!=" and any(s in plain for s in stronger)):
            yield c


def _plainer(e: Expr) -> list[Expr]:
    match e:
        case Compare("!=", Neg(arg), Number(0.0)):
            return _plainer(Compare("!=", arg, Number(0.0)))
        case Compare("!=", Binary("*", a, b), Number(0.0)):
            return [c for x in (a, b) for c in _plainer(Compare("!=", x, Number(0.0)))]
        case Compare("!=", Binary("/", a, _), Number(0.0)):
            return _plainer(Compare("!=", a, Number(0.0)))
        case Compare("!=", Binary("^", a, Number()), Number(0.0)):
            return _plainer(Compare("!=", a, Number(0.0)))
        case Compare("<" | ">", Binary("/", Number(1.0), a), Number(0.0)):
            return _plainer(Compare(e.op, a, Number(0.0)))
    return [e]
