"""Machines as they are written: what they switch, their states, and their rules."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace

from hybond.errors import ModelError
from hybond.model.expressions import Compare, Expr, Name, Number, Pre, children, names, parse
from hybond.model.fed_laws import fed_laws
from hybond.model.graph import Machine, Node, Rule
from hybond.model.hierarchy import Opened, Scope
from hybond.model.indices import without_ranges
from hybond.model.junction_laws import law_of_junction
from hybond.model.laws import JunctionLaw
from hybond.model.planar_friction import paired, pairs_of
from hybond.model.resolve import Resolver, is_condition
from hybond.names import did_you_mean, join
from hybond.units import Dimension

_RULE = re.compile(r"\s*(\w+)\s*->\s*(\w+)\s+when\s+(.+)\Z", re.DOTALL)


def switched_by(opened: Opened) -> dict[str, tuple[int, str]]:
    """Return ``{node path: (machine index, machine path)}`` for all that machines switch."""
    found: dict[str, tuple[int, str]] = {}
    for k, (path, (scope, machine)) in enumerate(opened.machines.items()):
        where = f"machines.{path}"
        if not machine.states:
            raise ModelError("a machine needs a state", code="HB-M140", where=where, hint="add one")
        for state, listed in machine.states.items():
            if isinstance(listed, str):
                raise ModelError(
                    f"the state {state!r} lists {listed!r}, which is a text",
                    code="HB-M140",
                    where=f"{where}.states.{state}",
                    hint=f"write [{listed!r}]",
                )
            for name in listed:
                node = join(scope.prefix, name)
                node = opened.ports.get(node, node)
                if node not in opened.nodes:
                    raise ModelError(
                        f"{name!r} is not an element or junction",
                        code="HB-M141",
                        where=f"{where}.states.{state}",
                        hint=did_you_mean(node, opened.nodes),
                    )
                if found.get(node, (k,))[0] != k:
                    raise ModelError(
                        f"{node!r} is switched by two machines, {found[node][1]!r} and {path!r}",
                        code="HB-M142",
                        where=f"{where}.states.{state}",
                        hint="let one machine control it",
                    )
                found[node] = (k, path)
    return found


def machines_of(
    opened: Opened,
    resolver: Resolver,
    nodes: list[Node],
    dimensions: Mapping[str, Dimension | None],
) -> tuple[Machine, ...]:
    """Return the machines with what each state switches ON and their rules resolved.

    Raises
    ------
    ModelError
        HB-M144, HB-M145, HB-M146 for states and rules that say nothing.
    """
    by_path = {n.path: n for n in nodes}
    found = []
    for k, (path, (scope, part)) in enumerate(opened.machines.items()):
        where = f"machines.{path}"
        states = tuple(part.states)
        on = []
        for state in states:
            listed = (join(scope.prefix, name) for name in part.states[state])
            targets = (opened.ports.get(name, name) for name in listed)
            on.append(
                frozenset(
                    by_path[t if by_path[t].controlled else f"{t}.switch"].index for t in targets
                )
            )
        if part.start not in states:
            raise ModelError(
                f"the start state {part.start!r} is not one of the states",
                code="HB-M144",
                where=f"{where}.start",
                hint=did_you_mean(part.start, states),
            )
        rules = tuple(
            _rule(text, states, resolver, scope, f"{where}.rules[{j}]", dimensions)
            for j, text in enumerate(part.rules)
        )
        found.append(Machine(k, path, states, tuple(on), states.index(part.start), rules))
    return tuple(found)


def with_laws_of_junctions(
    machines: tuple[Machine, ...],
    with_laws: Mapping[str, str],
    opened: Opened,
    nodes: list[Node],
    resolver: Resolver,
    dimensions: Mapping[str, Dimension | None],
) -> tuple[Machine, ...]:
    """Return the machines, those that stand for the law of a junction with that law.

    The law of a junction that sources alone lead is nothing but its machine.
    """
    by_path = {n.path: n for n in nodes}
    pairs = pairs_of(opened.nodes)
    fed = fed_laws(opened)

    def of(path: str) -> JunctionLaw:
        source = by_path.get(with_laws[path])
        return law_of_junction(by_path[path], source, opened.nodes[path], resolver, dimensions)

    found = []
    for machine in machines:
        if machine.path in with_laws:
            law = of(machine.path)
            if machine.path in pairs:
                law = paired(law, of(pairs[machine.path]))
            machine = replace(machine, law=None if machine.path in fed else law)
        found.append(machine)
    return tuple(found)


def _meant(text: object) -> str:
    """Return a rule as it may be meant, with the arrow and `when` for what others write."""
    parts = re.match(
        r"\s*(\w+)\s*(?:[-=]+>|→|\bto\b|>)\s*(\w+)\s*"
        r"(?:when|if|on|at|where|,|:|\[)\s*(.+?)\]?\s*\Z",
        str(text),
    )
    if parts is None or not isinstance(text, str):
        return "closed -> open when time >= t_off"
    return f"{parts[1]} -> {parts[2]} when {parts[3]}"


def _rule(
    text: str,
    states: tuple[str, ...],
    resolver: Resolver,
    scope: Scope,
    where: str,
    dimensions: Mapping[str, Dimension | None],
) -> Rule:
    match = _RULE.match(text) if isinstance(text, str) else None
    if match is None:
        raise ModelError(
            f"{text!r} is not a rule",
            code="HB-M145",
            where=where,
            hint=f'write "{_meant(text)}"',
        )
    for name in match.group(1, 2):
        if name not in states:
            raise ModelError(
                f"{name!r} is not a state of this machine",
                code="HB-M144",
                where=where,
                hint=did_you_mean(name, states),
            )
    if match[1] == match[2]:
        raise ModelError(
            f"{text!r} leads back to the state that it leaves, and time could not advance",
            code="HB-M145",
            where=where,
            hint="leave it out: a machine stays where no rule fires",
        )
    found = rule_of(match[3].strip(), resolver, scope, where, dimensions)
    return replace(found, source=states.index(match[1]), target=states.index(match[2]))


def rule_of(
    text: str,
    resolver: Resolver,
    scope: Scope,
    where: str,
    dimensions: Mapping[str, Dimension | None],
) -> Rule:
    """Return the rule from state 0 to state 1 that has a text for its guard.

    Raises
    ------
    ModelError
        HB-M146 for what is no condition; those of names and units.
    """
    tree = parse(text, where=where)
    if "[" in text:
        tree = without_ranges(tree, scope, where)
    guard = resolver.resolve(tree, scope, where)
    if not is_condition(guard):
        raise ModelError(
            f"the guard {text!r} is a number, not a condition",
            code="HB-M146",
            where=where,
            hint="compare it with something, such as > 0",
        )
    resolver.dimension(guard, dimensions, where)
    reads = []
    for read in _reads(tree):
        meaning = resolver.resolve(read, scope, where)
        if not isinstance(meaning, Number):
            reads.append((_with_paths(str(read), read, scope), meaning))
    told = _with_paths(text, tree, scope)
    return Rule(0, 1, guard, text, tuple(reads), told if told != text else "")


def _with_paths(text: str, tree: Expr, scope: Scope) -> str:
    """Return a text of a part in which names have the path of the part; units stay as they are."""
    own = [n for n in names(tree) if n != "time" and n != scope.index and '"' not in n]
    if not scope.prefix or not own:
        return text
    one_of = "|".join(re.escape(n) for n in sorted(own, key=len, reverse=True))
    words = rf"\[[^\]]*\]|\d\s*[A-Za-z%°]+|\"[^\"]*\"|(?<![\w.])(?:{one_of})(?![\w.\[(])"
    return re.sub(words, lambda m: join(scope.prefix, m[0]) if m[0] in own else m[0], text)


def _reads(tree: Expr) -> list[Expr]:
    """Return the names and ``pre()`` in a guard, in order, each once."""
    if isinstance(tree, Name | Pre):
        return [tree]
    if isinstance(tree, Compare) and tree.op in ("==", "!="):
        return []
    return list(dict.fromkeys(r for c in children(tree) for r in _reads(c)))
