"""A netlist with its subcircuits opened: branches between nodes, values in global parameters."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field

from hybond.circuits.behaviour import PLACE, Law, Read
from hybond.circuits.cards import Card
from hybond.circuits.deck import Deck, ModelCard, Scope
from hybond.circuits.formulas import evaluate, names_in, read_formula, size
from hybond.circuits.notices import Line, Notices
from hybond.circuits.powers import powers_below_zero
from hybond.files import limits
from hybond.model.expressions import Expr, Name, Number, substitute
from hybond.names import did_you_mean

GROUND = "0"
LONGEST_FORMULA = 60
"""Parts of a value written with parameters; a longer one is written as a number."""
INSTANCES = 50_000
"""Subcircuits, each as often as it is used."""
_GROUNDS = frozenset({"0", "gnd"})
_CONTESTED = "?"
"""Before a name that means one thing where it is written and another where it is used."""


@dataclass(frozen=True, slots=True)
class Value:
    """A value in terms of the global parameters, and what it is with their values."""

    formula: Expr
    number: float

    @property
    def parametric(self) -> bool:
        """Whether parameters occur in it."""
        return not isinstance(self.formula, Number)


@dataclass(frozen=True, slots=True)
class Branch:
    """A two-terminal element between the nodes `a` and `b`; current is counted from a to b."""

    name: str
    """Path of the element, ``"X1.R3"``."""
    kind: str
    """Its letter."""
    line: Line
    a: str
    b: str
    """`a` and `b`: node keys, in lower case; ``"0"`` is ground."""
    value: Value | None = None
    start: Value | None = None
    wave: tuple[str, tuple[Value, ...]] | None = None
    """Name and arguments of the function of time."""
    senses: tuple[str, ...] = ()
    """Controlling nodes of E, G and S; controlling source of F, H and W, in lower case."""
    model: ModelCard | None = None
    parameters: Mapping[str, Value] = field(default_factory=dict)
    """Values of the parameters of the model."""
    state: str = ""
    law: Law | None = None
    """Of a source that computes: its nodes are keys, its elements paths."""
    shape: Mapping[str, Value] = field(default_factory=dict)
    """Of a source, what is said beside its function of time: ``td``, ``r``."""

    @property
    def key(self) -> str:
        """Return the name in lower case, as others refer to it."""
        return self.name.lower()


@dataclass(frozen=True, slots=True)
class Coupling:
    """A K card: coils by key, and how they are coupled."""

    name: str
    line: Line
    coils: tuple[str, ...]
    value: Value


@dataclass
class Opened:
    """Everything that is to become a bond graph."""

    branches: list[Branch] = field(default_factory=list)
    couplings: list[Coupling] = field(default_factory=list)
    nodes: dict[str, str] = field(default_factory=dict)
    """Node key to the name to show."""
    parameters: dict[str, tuple[str, Expr, Line]] = field(default_factory=dict)
    """Global parameters: key to the name as written, its formula and line."""
    values: dict[str, float] = field(default_factory=dict)


Environment = dict[str, Expr]


def open_deck(deck: Deck, notices: Notices) -> Opened:
    """Return a deck with subcircuits opened and names resolved.

    Raises
    ------
    FileError
        HB-F130 (nodes that do not fit), HB-F131 (a value that does not exist), HB-F134 (undefined
        parameter, model or subcircuit), HB-F135 (recursion), HB-F142 (too many elements).
    """
    return _Opening(deck, notices).run()


def global_value(formula: Expr, opened: Opened, line: Line) -> Value:
    """Return a value that is written at the top of a netlist.

    Raises
    ------
    FileError
        HB-F131, HB-F134.
    """
    number = _number(formula, opened, line)
    constant = not any(True for _ in names_in(formula))
    return Value(Number(number) if constant else formula, number)


def _number(formula: Expr, opened: Opened, line: Line) -> float:
    try:
        return evaluate(formula, opened.values)
    except KeyError as error:
        name = str(error.args[0])
        if name.startswith(_CONTESTED):
            name = name.removeprefix(_CONTESTED)
            raise line.refuse(
                f"the parameter {name!r} is one where the subcircuit is written, and another one "
                "where it is used: simulators differ in which they take",
                code="HB-F134",
                hint=f"give the subcircuit a parameter {name} of its own, and pass it on",
            ) from None
        raise line.refuse(
            f"there is no parameter {name!r}",
            code="HB-F134",
            hint=did_you_mean(name, opened.parameters) or f"add .param {name}=...",
        ) from None
    except (ArithmeticError, ValueError) as error:
        raise line.refuse(
            f"the value does not exist: {error}", code="HB-F131", hint="check the parameters"
        ) from None


class _Opening:
    def __init__(self, deck: Deck, notices: Notices) -> None:
        self.deck = deck
        self.notices = notices
        self.result = Opened()
        self.shared = deck.shared
        self.instances = 0

    def run(self) -> Opened:
        top = self.deck.top
        result = self.result
        result.parameters = {k: (name, f, line) for k, (f, line, name) in top.parameters.items()}
        for key in self.ordered(top.parameters):
            formula, line, _ = top.parameters[key]
            result.values[key] = self.number(formula, line)
        levels: list[tuple[Scope, Environment]] = [(top, {})]
        self.cards(top, levels, "", {})
        return result

    def ordered(self, given: Mapping[str, tuple[Expr, Line, str]]) -> list[str]:
        """Return parameters so that each comes after what it needs."""
        done: dict[str, None] = {}
        for first in given:
            if first in done:
                continue
            path: dict[str, None] = {first: None}
            work: list[tuple[str, Iterator[str]]] = [(first, names_in(given[first][0]))]
            while work:
                key, needs = work[-1]
                need = next(needs, None)
                if need is None:
                    work.pop()
                    path.pop(key)
                    done[key] = None
                elif need in path:
                    raise given[key][1].refuse(
                        f"the parameter {need!r} is defined by itself",
                        code="HB-F135",
                        hint="give one of them a number",
                    )
                elif need in given and need not in done:
                    work.append((need, names_in(given[need][0])))
                    path[need] = None
        return list(done)

    def number(self, formula: Expr, line: Line) -> float:
        return _number(formula, self.result, line)

    def value(self, formula: Expr, env: Environment, line: Line) -> Value:
        """Return a value as it is inside a subcircuit."""
        whole = substitute(formula, env) if env else formula
        number = self.number(whole, line)
        if size(whole) > LONGEST_FORMULA:
            self.notices.add(line, "a long expression is written as a number")
            whole = Number(number)
        elif not any(True for _ in names_in(whole)):
            whole = Number(number)
        return Value(whole, number)

    def environment(
        self, inner: Scope, outer: Environment, card: Card, env: Environment
    ) -> Environment:
        """Return what the parameters inside a subcircuit mean."""
        found = dict(outer)
        for name, formula in env.items():
            there = name in outer or name in self.result.parameters
            if there and formula != outer.get(name, Name(name)):
                found[name] = Name(_CONTESTED + name)
        given = card.given
        allowed = {*inner.defaults, *inner.parameters}
        for name in given:
            if name not in allowed:
                raise card.line.refuse(
                    f"the subcircuit {inner.name!r} has no parameter {name!r}",
                    code="HB-F134",
                    hint=did_you_mean(name, allowed) or "take it out",
                )
        local: dict[str, tuple[Expr, Line, str]] = {
            name: (formula, inner.line, name)
            for name, formula in inner.defaults.items()
            if name not in given
        }
        local |= {name: entry for name, entry in inner.parameters.items() if name not in given}
        for name in local:
            found.pop(name, None)
        for name, formula in given.items():
            found[name] = self.value(formula, env, card.line).formula
        for name in self.ordered(local):
            formula, line, _ = local[name]
            found[name] = self.value(formula, found, line).formula
        return found

    def cards(
        self,
        scope: Scope,
        levels: list[tuple[Scope, Environment]],
        prefix: str,
        terminals: Mapping[str, str],
    ) -> None:
        env = levels[-1][1]
        own = {card.name.lower() for card in scope.cards}

        def node(name: str) -> str:
            key = name.lower()
            if key in _GROUNDS:
                return GROUND
            if key in terminals:
                return terminals[key]
            if prefix and key not in self.shared:
                key, name = f"{prefix.lower()}.{key}", f"{prefix}.{name}"
            self.result.nodes.setdefault(key, name)
            return key

        def path(name: str) -> str:
            return f"{prefix}.{name}" if prefix else name

        for card in scope.cards:
            if card.kind == "x":
                self.instance(card, scope, levels, path(card.name), node)
                continue
            if len(self.result.branches) >= limits.ELEMENTS:
                raise card.line.refuse(
                    f"more than {limits.ELEMENTS} elements, subcircuits opened",
                    code="HB-F142",
                    hint="convert a part of the circuit",
                )
            value = None if card.value is None else self.value(card.value, env, card.line)
            if card.kind == "k":
                coils = tuple(path(c).lower() for c in card.refers)
                assert value is not None
                self.result.couplings.append(Coupling(path(card.name), card.line, coils, value))
                continue
            start = None if card.start is None else self.value(card.start, env, card.line)
            nodes = [node(n) for n in card.nodes]
            senses: tuple[str, ...] = tuple(nodes[2:])
            if card.kind in "fhw" and card.law is None:
                if card.refers[0].lower() not in own:
                    raise card.line.refuse(
                        f"there is no source {card.refers[0]!r}",
                        code="HB-F134",
                        hint=did_you_mean(card.refers[0], [c.name for c in scope.cards]),
                    )
                senses = (path(card.refers[0]).lower(),)
            model, parameters = self.model(card, scope, env)
            self.result.branches.append(
                Branch(
                    path(card.name),
                    card.kind,
                    card.line,
                    nodes[0],
                    nodes[1],
                    value,
                    start,
                    self.wave(card, env),
                    senses,
                    model,
                    parameters,
                    card.state,
                    None if card.law is None else self.law(card, env, node, path),
                    {k: self.value(v, env, card.line) for k, v in card.shape.items()},
                )
            )

    def law(
        self, card: Card, env: Environment, node: Callable[[str], str], path: Callable[[str], str]
    ) -> Law:
        """Return the law of a source as it is in its subcircuit."""
        assert card.law is not None
        whole = substitute(card.law.formula, env) if env else card.law.formula
        known = {"time", *self.result.parameters}
        for name in names_in(whole):
            if name not in known and not name.startswith(PLACE):
                self.number(Name(name), card.line)
        self.powers(whole, card)
        reads = tuple(
            Read("v", node(r.first), node(r.second))
            if r.kind == "v"
            else Read("i", path(r.first).lower())
            for r in card.law.reads
        )
        return Law(card.law.imposes, whole, reads)

    def powers(self, whole: Expr, card: Card) -> None:
        """Say which powers of what is below zero are others elsewhere."""
        for exponent in powers_below_zero(whole, self.result.values):
            said = "is so, too" if exponent.lstrip("-").isdigit() else "has no value"
            self.notices.add(
                card.line,
                f"of what is below zero a power {exponent} {said}; to "
                f"ngspice it is that of the magnitude: abs(x)^{exponent} means the same to both",
            )

    def wave(self, card: Card, env: Environment) -> tuple[str, tuple[Value, ...]] | None:
        if card.wave is None:
            return None
        name, texts = card.wave
        if any(text == "=" for text in texts):
            raise card.line.refuse(
                "options of a function of time are not understood",
                code="HB-F130",
                hint="write the values one after another",
            )
        read = (read_formula(text, card.line) for text in texts if text not in "()")
        return name, tuple(self.value(f, env, card.line) for f in read)

    def model(
        self, card: Card, scope: Scope, env: Environment
    ) -> tuple[ModelCard | None, dict[str, Value]]:
        if card.kind not in "dswa":
            return None, {}
        name = card.refers[-1].lower()
        found = scope.find_model(name)
        if found is None:
            raise card.line.refuse(
                f"there is no model {card.refers[-1]!r}",
                code="HB-F134",
                hint=did_you_mean(name, self.known(scope, "models"))
                or f"add .model {card.refers[-1]} {'D' if card.kind == 'd' else 'SW'}(...)",
            )
        values = {k: self.value(f, env, found.line) for k, f in found.parameters.items()}
        return found, values

    def instance(
        self,
        card: Card,
        scope: Scope,
        levels: list[tuple[Scope, Environment]],
        path: str,
        node: Callable[[str], str],
    ) -> None:
        name = card.refers[0].lower()
        inner = scope.find_subcircuit(name)
        if inner is None:
            raise card.line.refuse(
                f"there is no subcircuit {card.refers[0]!r}",
                code="HB-F134",
                hint=did_you_mean(name, self.known(scope, "subcircuits"))
                or f"add .subckt {card.refers[0]} ... .ends",
            )
        chain = [entry for entry, _ in levels]
        itself = any(entry is inner for entry in chain)
        if itself or len(levels) > limits.LEVELS:
            why = "contains itself" if itself else f"is more than {limits.LEVELS} deep"
            raise card.line.refuse(
                f"the subcircuit {card.refers[0]!r} {why}",
                code="HB-F135",
                hint="a subcircuit cannot be part of itself",
            )
        self.instances += 1
        if self.instances > INSTANCES:
            raise card.line.refuse(
                f"more than {INSTANCES} subcircuits, all opened",
                code="HB-F142",
                hint="convert a part of the circuit",
            )
        if len(card.nodes) != len(inner.nodes):
            raise card.line.refuse(
                f"{card.name} has {len(card.nodes)} nodes, {card.refers[0]!r} has "
                f"{len(inner.nodes)}",
                code="HB-F130",
                hint=f"its nodes are {' '.join(inner.nodes)}",
            )
        home = next(k for k, entry in enumerate(chain) if entry is inner.parent)
        env = self.environment(inner, levels[home][1], card, levels[-1][1])
        terminals = {n: node(g) for n, g in zip(inner.nodes, card.nodes, strict=True)}
        self.cards(inner, [*levels, (inner, env)], path, terminals)

    def known(self, scope: Scope, group: str) -> list[str]:
        found: list[str] = []
        at: Scope | None = scope
        while at is not None:
            found += getattr(at, group)
            at = at.parent
        return found
