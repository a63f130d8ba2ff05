"""What a name in an expression means: from names as written to canonical names.

`Resolver` knows the opened model and the wired graph. Its one question is `resolve(tree, scope)`;
the answer is the same tree in the canonical names of `graph`, with parameters put in and named
signals substituted.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

from hybond.errors import ExpressionError, ModelError
from hybond.model.dimensions import infer_dimension, instead_of
from hybond.model.expressions import (
    And,
    Binary,
    Bool,
    Call,
    Compare,
    Expr,
    If,
    Name,
    Neg,
    Not,
    Number,
    Or,
    Pre,
    String,
    children,
    names,
    parse,
    simplify,
    substitute,
    transform,
)
from hybond.model.expressions.parse import MAX_NESTING
from hybond.model.expressions.tree import any_kind, extent, with_children
from hybond.model.graph import Bond, Node, Storage, Watch
from hybond.model.hierarchy import Opened, Scope
from hybond.model.indices import MAX_NODES, gathered, gathers, no_member, of_an_array, one
from hybond.model.quantities import called_otherwise, made_of_its_own
from hybond.model.spelled import as_written
from hybond.names import did_you_mean, join, port_number
from hybond.units import Dimension

MAX_LEVELS = 500
"""Levels of an expression in which signals have been put for their names."""
TOO_MANY = (
    f"with all that it reads the expression has more than {MAX_NODES} values and operators, "
    f"or {MAX_LEVELS} in one another"
)
_QUOTED = re.compile(r'"([^"]*)"\.([a-z]+)\Z')


class Resolver:
    """Names to canonical names for one flattened model."""

    def __init__(
        self,
        opened: Opened,
        nodes: tuple[Node, ...],
        bonds: tuple[Bond, ...],
        storages: tuple[Storage, ...],
        machines: Mapping[str, tuple[int, tuple[str, ...]]],
    ) -> None:
        self.opened = opened
        self.nodes = nodes
        self.bonds = bonds
        self.machines = machines
        self.by_path = {n.path: n for n in nodes}
        self.stored = {s.path: s for s in storages}
        self.integrals = {path: k for k, path in enumerate(opened.integrals)}
        self.inputs = {path: k for k, path in enumerate(opened.inputs)}
        self.watches: list[Watch] = []
        self._watched: dict[Compare, int] = {}
        self._signals: dict[str, Expr] = {}
        self._open: list[str] = []
        self._spelled: dict[tuple[str, str], str] = {}
        self._bond_names = self._name_bonds()

    # -- trees

    def resolve(
        self, tree: Expr, scope: Scope, where: str, local: Mapping[str, Expr] | None = None
    ) -> Expr:
        """Return `tree` in canonical names.

        Raises
        ------
        ModelError
            HB-M120 unknown name, HB-M121 ambiguous bond name, HB-M122 a signal that needs
            itself, HB-M123 ``==`` between continuous signals.
        """
        if isinstance(tree, Number):
            return tree
        local = local or {}
        several: list[int] = []

        def visit(e: Expr) -> Expr:
            if isinstance(e, Compare) and e.op in ("==", "!="):
                return self._equality(e, scope, where)
            if isinstance(e, Name):
                if e.path in local:
                    return local[e.path]
                meant = self.name(e.path, scope, where)
                if isinstance(meant, Name):
                    self._spelled.setdefault((where, meant.path), e.path)
                return meant
            if isinstance(e, Call) and gathers(e):
                written = gathered(e, scope, where)
                several.append(extent(written)[1])
                if sum(several) > MAX_NODES:
                    raise _too_long(TOO_MANY, where)
                return visit(written)
            if isinstance(e, String):
                raise ModelError(
                    f"the text {e.text!r} stands alone",
                    code="HB-M120",
                    where=where,
                    hint='compare it with a machine\'s state: m.state == "open"',
                )
            return with_children(e, tuple(visit(c) for c in children(e)))

        whole = visit(tree)
        levels, nodes = extent(whole)
        if levels > MAX_LEVELS or nodes > MAX_NODES:
            raise _too_long(TOO_MANY, where)
        if not any_kind(whole, Compare):
            return whole
        return transform(transform(whole, _decided), self._watch)

    def _equality(self, e: Compare, scope: Scope, where: str) -> Expr:
        """``machine.state == "open"`` is a Boolean; any other ``==`` is an error."""
        for a, b in ((e.left, e.right), (e.right, e.left)):
            if not isinstance(a, Name) or not a.path.endswith(".state"):
                continue
            path = join(scope.prefix, one(a.path, scope, where).removesuffix(".state"))
            if path not in self.machines:
                continue
            index, states = self.machines[path]
            text = b.text if isinstance(b, String) else b.path if isinstance(b, Name) else ""
            if text not in states:
                raise ModelError(
                    f"the machine {path!r} has no state {text!r}",
                    code="HB-M120",
                    where=where,
                    hint=did_you_mean(text, states),
                )
            inside = Name(f"in:{index}:{states.index(text)}")
            return inside if e.op == "==" else Not(inside)
        raise ModelError(
            f"{e.op!r} compares continuous signals, which are never exactly equal",
            code="HB-M123",
            where=where,
            hint="write abs(a - b) > tol, or use <= and >=",
        )

    def _watch(self, e: Expr) -> Expr:
        """Replace a comparison that is affine in time alone by a Boolean that jumps on time."""
        if not isinstance(e, Compare):
            return e
        difference = simplify(Binary("-", e.left, e.right))
        slope_and_offset = affine_in_time(difference)
        if slope_and_offset is None or slope_and_offset[0] == 0.0:
            return e
        if e not in self._watched:
            slope, offset = slope_and_offset
            # `time >= t_off` gives t_off itself: a quotient by 1 is not rounded
            self._watched[e] = len(self.watches)
            self.watches.append(Watch(len(self.watches), e, (-offset / slope,)))
        return Name(f"at:{self._watched[e]}")

    # -- names

    def name(self, text: str, scope: Scope, where: str) -> Expr:
        """Return what one name means."""
        if text == "time":
            return Name("time")
        if "[" in text:
            text = of_an_array(text, scope, where, self.opened.arrays)
        quoted = _QUOTED.match(text)
        if quoted:
            return self._bond_variable(quoted[1], quoted[2], scope, where)
        path = join(scope.prefix, text)
        if text in scope.parameters:
            return scope.parameters[text]
        if path in self.opened.parameters:
            return self.opened.parameters[path]
        if path in self.integrals:
            return Name(f"s:{self.integrals[path]}")
        if path in self.inputs:
            return Name(f"u:{self.inputs[path]}")
        if path in self.opened.signals:
            return self.signal(path)
        found = self._of_a_node(path, where)
        if found is None:
            missing = no_member(path, self.opened.arrays)
            if missing is not None:
                raise ModelError(
                    f"{text!r} is not known here: {missing[0]}",
                    code="HB-M154",
                    where=where,
                    hint=missing[1],
                )
            raise ModelError(
                f"{text!r} is not known here",
                code="HB-M120",
                where=where,
                hint=made_of_its_own(text, where) or self._instead_of(text, path, scope),
            )
        return found

    def _instead_of(self, text: str, path: str, scope: Scope) -> str:
        known, node = self.known(scope), self.by_path.get(path.rpartition(".")[0])
        meant = "" if node is None else called_otherwise(text, node, known)
        return meant or instead_of(text, known)

    def signal(self, path: str) -> Expr:
        """Return a named signal's tree, resolved once."""
        if path in self._open:
            cycle = " -> ".join([*self._open[self._open.index(path) :], path])
            raise ModelError(
                f"the signal needs itself: {cycle}",
                code="HB-M122",
                where=f"signals.{path}",
                hint="break the cycle, or use an integral",
            )
        if path not in self._signals:
            if len(self._open) == MAX_NESTING:
                raise _too_long(
                    f"more than {MAX_NESTING} signals are made of one another", f"signals.{path}"
                )
            self._open.append(path)
            scope, text = self.opened.signals[path]
            where = f"signals.{path}"
            written = parse(text, where=where) if isinstance(text, str) else Number(float(text))
            try:
                tree = self.resolve(written, scope, where)
            except RecursionError:
                raise _too_long(
                    "too much stands in one another in the signals read", where
                ) from None
            if path in self.opened.given and is_condition(tree):
                tree = If(tree, Number(1.0), Number(0.0))
            self._signals[path] = tree
            self._open.pop()
        return self._signals[path]

    def read_as(self, path: str, tree: Expr) -> None:
        """Let a signal mean this tree to all that read it from now on."""
        self._signals[path] = tree

    def _of_a_node(self, path: str, where: str) -> Expr | None:
        base, _, variable = path.rpartition(".")
        if variable in ("p", "q") and path in self.stored:
            return Name(f"x:{self.stored[path].index}")
        if variable == "state" and base in self.machines:
            raise ModelError(
                f"{path!r} is compared with a state, nothing else",
                code="HB-M120",
                where=where,
                hint=f'{path} == "{self.machines[base][1][0]}"',
            )
        port = ""
        if base not in self.by_path:
            head, _, last = base.rpartition(".")
            if last.isdigit():
                base, port = head, last
        node = self.by_path.get(base)
        if node is None:
            target = self.opened.ports.get(base)
            if target is None or target == base:
                return None
            return self._of_a_node(join(target, port, variable), where)
        if variable == "on" and node.controlled:
            return Name(f"on:{node.index}")
        if variable not in ("e", "f"):
            return None
        return self._effort_or_flow(node, port, variable, where)

    def _effort_or_flow(self, node: Node, port: str, variable: str, where: str) -> Expr:
        if port:
            for end in node.ends:
                if end.port + 1 == port_number(port):
                    return Name(f"{variable}:{end.bond}")
            raise ModelError(
                f"{node.path!r} has no port {port}",
                code="HB-M120",
                where=where,
                hint=f"it has ports 1 to {len(node.ends)}",
            )
        if not node.is_junction:
            if len(node.ends) == 1:
                return Name(f"{variable}:{node.ends[0].bond}")
            raise ModelError(
                f"{node.path!r} has several ports",
                code="HB-M120",
                where=where,
                hint=f"write {node.path}.1.{variable} or {node.path}.2.{variable}",
            )
        common = "e" if node.kind == "0" else "f"
        if variable == common and node.ends:
            return Name(f"{variable}:{node.ends[0].bond}")
        if not node.controlled:
            raise ModelError(
                f"the {node.kind}-junction {node.path!r} has no common {variable}",
                code="HB-M120",
                where=where,
                hint=f'{node.path}.{common}, or a bond\'s: "a -> {node.path}".{variable}',
            )
        return balance(node, variable, without=self._implied(node))

    def _implied(self, node: Node) -> int | None:
        """Return the bond of the source that the law of a junction brought in."""
        for end in node.ends:
            bond = self.bonds[end.bond]
            if self.nodes[bond.head if bond.tail == node.index else bond.tail].implied:
                return end.bond
        return None

    def bonds_called(self, text: str, scope: Scope) -> list[int]:
        """Return the bonds with this name or label; more than one if it is ambiguous."""
        key = (f"{scope.prefix}." if scope.prefix else "") + _squeeze(text)
        return self._bond_names.get(key, [])

    def _name_bonds(self) -> dict[str, list[int]]:
        table: dict[str, list[int]] = {}
        for bond, written in zip(self.bonds, self.opened.bonds, strict=False):
            prefix = bond.name[: len(bond.name) - len(_local(bond.name, written.label))]
            local = bond.name[len(prefix) :]
            plain = local.split(":", 1)[1] if written.label else local
            for text in {local, plain, written.label} - {""}:
                table.setdefault(prefix + _squeeze(text), []).append(bond.index)
        return table

    def _bond_variable(self, text: str, variable: str, scope: Scope, where: str) -> Expr:
        bonds = self.bonds_called(text, scope)
        if len(bonds) == 1 and variable in ("e", "f"):
            return Name(f"{variable}:{bonds[0]}")
        if len(bonds) > 1:
            raise ModelError(
                f"{len(bonds)} bonds are called {text!r}",
                code="HB-M121",
                where=where,
                hint=f'label them: "b1: {text}"',
            )
        raise ModelError(
            f'there is no "{text}".{variable}',
            code="HB-M120",
            where=where,
            hint=did_you_mean(_squeeze(text), self._bond_names) or "the model has no bonds",
        )

    def dimension(
        self,
        tree: Expr,
        dimensions: Mapping[str, Dimension | None],
        where: str,
        *,
        certain: bool = False,
    ) -> Dimension | None:
        """Return a tree's dimension; a refusal speaks of names as they are written."""
        if isinstance(tree, Number):
            return infer_dimension(tree, dimensions.get, where=where, certain=certain)
        written = {name: self._as_written(name, where) for name in names(tree)}
        known = {text: dimensions.get(name) for name, text in written.items()}
        shown = substitute(tree, {name: Name(text) for name, text in written.items()})
        return infer_dimension(shown, known.get, where=where, certain=certain)

    def _as_written(self, name: str, where: str) -> str:
        """Return a canonical name as it stands at a place, else as a modeller would write it."""
        spelled = self._spelled.get((where, name))
        return spelled or as_written(name, self)

    def known(self, scope: Scope) -> list[str]:
        """Return the names that may be written in `scope`, for "did you mean"."""
        found = ["time", *scope.parameters]
        groups = (self.integrals, self.inputs, self.opened.signals, self.stored)
        found += [p for group in groups for p in group]
        for node in self.nodes:
            if node.hidden:
                continue
            if node.is_junction:
                found.append(f"{node.path}.{'e' if node.kind == '0' else 'f'}")
            if node.controlled or not node.is_junction:
                found += [f"{node.path}.e", f"{node.path}.f"]
        dot = f"{scope.prefix}."
        return [p.removeprefix(dot) for p in found if not scope.prefix or p.startswith(dot)]


def balance(node: Node, variable: str, *, without: int | None = None) -> Expr:
    """Return a junction's net variable, in minus out: zero when it is ON.

    The bond `without` is left out: that of a source which the law of the junction brought in.
    """
    total: Expr = Number(0.0)
    for end in node.ends:
        if end.bond == without:
            continue
        term = Name(f"{variable}:{end.bond}")
        if total == Number(0.0):
            total = term if end.inward else Neg(term)
        else:
            total = Binary("+" if end.inward else "-", total, term)
    return total


def _too_long(why: str, where: str) -> ExpressionError:
    return ExpressionError(
        why, code="HB-E107", where=where, hint="let fewer signals be made of one another"
    )


def is_condition(e: Expr) -> bool:
    """Whether `e` is true or false rather than a number."""
    match e:
        case Compare() | And() | Or() | Not() | Bool():
            return True
        case Name(path):
            return path.startswith(("on:", "in:", "at:"))
        case Pre(arg):
            return is_condition(arg)
        case If():
            return is_condition(e.then) and is_condition(e.orelse)
        case _:
            return False


def _decided(e: Expr) -> Expr:
    """Return a condition for the comparison of what it gives, ``(if c then 1 else 0) > 0.5``."""
    match e:
        case Compare(op, If(cond, Number(a), Number(b)), Number(c)):
            yes, no = _holds(op, a, c), _holds(op, b, c)
        case Compare(op, Number(c), If(cond, Number(a), Number(b))):
            yes, no = _holds(op, c, a), _holds(op, c, b)
        case _:
            return e
    if yes == no:
        return Bool(yes)
    return cond if yes else Not(cond)


def _holds(op: str, a: float, b: float) -> bool:
    return {"<": a < b, "<=": a <= b, ">": a > b, ">=": a >= b}[op]


def affine_in_time(e: Expr) -> tuple[float, float] | None:
    """Return (a, b) if ``e = a*time + b`` with plain numbers, else None."""
    match e:
        case Number():
            return 0.0, e.value
        case Name("time"):
            return 1.0, 0.0
        case Neg():
            inner = affine_in_time(e.arg)
            return None if inner is None else (-inner[0], -inner[1])
        case Binary(op="+" | "-"):
            left, right = affine_in_time(e.left), affine_in_time(e.right)
            if left is None or right is None:
                return None
            sign = 1.0 if e.op == "+" else -1.0
            return left[0] + sign * right[0], left[1] + sign * right[1]
        case Binary(op="*" | "/"):
            left, right = affine_in_time(e.left), affine_in_time(e.right)
            if left is None or right is None:
                return None
            if right[0] == 0.0 and e.op == "*":
                return left[0] * right[1], left[1] * right[1]
            if right[0] == 0.0 and right[1] != 0.0:
                return left[0] / right[1], left[1] / right[1]
            if left[0] == 0.0 and e.op == "*":
                return right[0] * left[1], right[1] * left[1]
            return None
        case _:
            return None


def prior(e: Expr) -> list[Expr]:
    """Return the arguments of all ``pre()`` in `e`."""
    if isinstance(e, Pre):
        return [e.arg]
    return [p for c in children(e) for p in prior(c)]


def _squeeze(text: str) -> str:
    return re.sub(r"\s*(->|:)\s*", r"\1", text.strip())


def _local(name: str, label: str) -> str:
    """Return the part of a bond's name after its scope's prefix."""
    if label:
        return name[name.index(f"{label}: ") :] if f"{label}: " in name else name
    return name
