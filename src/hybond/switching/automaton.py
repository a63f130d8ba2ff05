"""Many local machines as one global automaton, and what that costs."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import product
from typing import Any

from hybond.errors import ModelError
from hybond.model.builder import Model
from hybond.model.expressions import Bool, Compare, Expr, Name, Not, Or, String, parse, transform
from hybond.model.parts import Integral, MachinePart, Part, Sampled, SubmodelPart
from hybond.names import did_you_mean
from hybond.switching.drawn import copied

_WHEN = re.compile(r"\swhen\s")


def global_automaton(
    model: Model, name: str, *, machines: Sequence[str] | None = None, limit: int = 1000
) -> Model:
    """Return a copy of the model in which one machine does what several did.

    Its states are the combinations that can be reached (guards left aside), called
    ``"closed__blocks"``; its rules fire in one what the machines fire together. Laws and guards
    that read ``S.state`` are rewritten. The run has the same events at the same times.

    Parameters
    ----------
    model : Model
    name : str
        The new machine.
    machines : sequence of str, optional
        Those to replace, in order; all of the model itself (not of its submodels) by default.
    limit : int
        States, and rules, beyond which the automaton is refused.

    Raises
    ------
    ModelError
        HB-M144 for a machine that does not exist, HB-M195 beyond `limit`.

    Notes
    -----
    The opposite of local machines (P. J. Mosterman and G. Biswas, 1995): the enumeration of modes
    that they avoid. Useful to hand a model to tools that know one automaton, to check that a set of
    local machines does what was meant, and small. n machines of two states cost up to 2^n states.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("two")
    >>> m.add(a=hb.One(), b=hb.One())
    >>> for s, t in (("a", 1), ("b", 2)):
    ...     m.machine(f"M{s}", states={"off": [], "on": [s]}, start="off",
    ...               rules=[f"off -> on when time >= {t}"])
    >>> whole = hb.switching.global_automaton(m, "mode")
    >>> dict(whole.machines["mode"].states)
    {'off__off': (), 'off__on': ('b',), 'on__off': ('a',), 'on__on': ('a', 'b')}
    >>> len(whole.machines["mode"].rules)
    5
    """
    chosen = list(model.machines) if machines is None else list(machines)
    for machine in chosen:
        if machine not in model.machines:
            raise ModelError(
                f"no machine {machine!r}",
                code="HB-M144",
                where=name,
                hint=did_you_mean(machine, model.machines),
            )
    new = copied(model)
    parts = [new.machines.pop(machine) for machine in chosen]
    choices = [_choices(part) for part in parts]
    start = tuple(part.start for part in parts)
    reached = [start]
    seen = {start}
    rules: list[tuple[tuple[str, ...], tuple[str, ...], str]] = []
    for state in reached:
        for together in product(
            *(c.get(s, [("", s)]) for c, s in zip(choices, state, strict=True))
        ):
            guards = [g for g, _ in together if g]
            if not guards:
                continue
            target = tuple(t for _, t in together)
            text = guards[0] if len(guards) == 1 else " and ".join(f"({g})" for g in guards)
            rules.append((state, target, text))
            if target not in seen:
                seen.add(target)
                reached.append(target)
            if len(reached) > limit or len(rules) > limit:
                raise ModelError(
                    f"the automaton has more than {limit} states or rules",
                    code="HB-M195",
                    where=name,
                    hint="leave machines out, or raise limit",
                )
    called = {state: "__".join(state) for state in sorted(seen)}
    change = _rewriter(dict(zip(chosen, range(len(chosen)), strict=True)), name, called)
    new.machines = {k: _machine(part, change) for k, part in new.machines.items()}
    new.machine(
        name,
        states={
            text: tuple(
                dict.fromkeys(
                    node for part, s in zip(parts, state, strict=True) for node in part.states[s]
                )
            )
            for state, text in called.items()
        },
        start=called[start],
        rules=[f"{called[a]} -> {called[b]} when {change(guard)}" for a, b, guard in rules],
    )
    fixed = {k: new.reference_states.pop(k) for k in chosen if k in new.reference_states}
    reference = tuple(fixed.get(k, s) for k, s in zip(chosen, start, strict=True))
    if fixed and reference in called:
        new.reference_states[name] = called[reference]
    new.signals = {k: _signal(v, change) for k, v in new.signals.items()}
    new.elements = {k: _element(v, change) for k, v in new.elements.items()}
    return new


def _halves(rule: str) -> tuple[str, str]:
    """Return ``"a -> b"`` and the guard of a rule."""
    halves = _WHEN.split(rule, maxsplit=1)
    if len(halves) < 2 or "->" not in halves[0]:
        raise ModelError(
            f"{rule!r} is not a rule",
            code="HB-M145",
            where=rule,
            hint='write "closed -> open when time >= t_off"',
        )
    return halves[0], halves[1]


def _choices(part: MachinePart) -> dict[str, list[tuple[str, str]]]:
    """Return per state its (guard, target) in listed order, then ("", state): none fires."""
    found: dict[str, list[tuple[str, str]]] = {}
    for rule in part.rules:
        arrow, guard = _halves(rule)
        source, _, target = arrow.partition("->")
        found.setdefault(source.strip(), []).append((guard.strip(), target.strip()))
    return {state: [*rules, ("", state)] for state, rules in found.items()}


def _rewriter(
    place: Mapping[str, int], name: str, called: Mapping[tuple[str, ...], str]
) -> Callable[[str], str]:
    """Return what puts the automaton's state where a text asks for a machine's."""

    def one(e: Expr) -> Expr:
        if not isinstance(e, Compare) or e.op not in ("==", "!="):
            return e
        for a, b in ((e.left, e.right), (e.right, e.left)):
            machine = a.path.removesuffix(".state") if isinstance(a, Name) else ""
            wanted = b.text if isinstance(b, String) else b.path if isinstance(b, Name) else ""
            if machine not in place or a == Name(machine):
                continue
            inside = [t for state, t in called.items() if state[place[machine]] == wanted]
            tests = tuple(Compare("==", Name(f"{name}.state"), String(t)) for t in inside)
            any_of: Expr = tests[0] if len(tests) == 1 else Or(tests) if tests else Bool(False)
            return any_of if e.op == "==" else Not(any_of)
        return e

    def change(text: str) -> str:
        if not any(f"{machine}.state" in text for machine in place):
            return text
        return str(transform(parse(text), one))

    return change


def _machine(part: MachinePart, change: Callable[[str], str]) -> MachinePart:
    rules = []
    for rule in part.rules:
        arrow, guard = _halves(rule)
        rules.append(f"{arrow} when {change(guard)}")
    return replace(part, rules=tuple(rules))


def _signal(
    signal: str | float | Integral | Sampled, change: Callable[[str], str]
) -> str | float | Integral | Sampled:
    if isinstance(signal, Integral):
        return replace(signal, rate=_value(signal.rate, change))
    if isinstance(signal, Sampled):
        return replace(signal, value=_value(signal.value, change))
    return str(_value(signal, change)) if isinstance(signal, str) else signal


def _element(part: Part | SubmodelPart, change: Callable[[str], str]) -> Part | SubmodelPart:
    if isinstance(part, SubmodelPart):
        return replace(part, inputs=_value(part.inputs, change))
    return replace(part, value=_value(part.value, change))


def _value(value: Any, change: Callable[[str], str]) -> Any:
    if isinstance(value, str):
        return change(value)
    if isinstance(value, Mapping):
        return {k: _value(v, change) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [_value(v, change) for v in value]
    return value
