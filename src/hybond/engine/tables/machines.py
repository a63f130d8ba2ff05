"""Tables of machines: their states, what these switch, and the rules between them."""

from __future__ import annotations

from hybond.engine.tables.columns import INTS, ModelTables, first_of, put_rows
from hybond.engine.tables.contacts import rules_of
from hybond.engine.tables.factored_guards import asks_both_sides, factored_guard
from hybond.engine.tables.guards import seen_in_motion
from hybond.engine.tables.plain_guards import plain_guard
from hybond.model.expressions import comparisons, names
from hybond.model.expressions.kinks import may_lack_value
from hybond.model.expressions.rounded_roots import magnitude
from hybond.model.graph import FlatGraph, Machine

_STILL = ("in:", "on:", "at:")
_ZERO_IS = {"<": 1, "<=": -1, ">": -1, ">=": 1}
"""The side of zero on which a difference has the truth that it has at zero."""


def put_machines(t: ModelTables) -> None:
    """Put the machines into the tables, with their rules as pairs and as values."""
    g = t.graph
    switches = [n.index for n in g.nodes if n.controlled]
    place = {index: k for k, index in enumerate(switches)}
    t.machines = [m.path for m in g.machines]
    t.states = [s for m in g.machines for s in m.states]
    t.ints["state_first"] = first_of([list(m.states) for m in g.machines])
    t.ints["start"] = [m.start for m in g.machines]
    t.ints["is_law"] = [int(m.law is not None) for m in g.machines]
    t.ints["leads_on"] = [int(bool(m.led_on)) for m in g.machines]
    on = [[(place[n],) for n in sorted(nodes)] for m in g.machines for nodes in m.on]
    put_rows(t, "on_first", on, on_switch=INTS)
    owners = owners_of(g)
    t.ints["switch_machine"] = [owners[k].index for k in switches]
    forced = rules_of(g)
    rules = [[(f.rule.source, f.rule.target, f.sign, f.reaction) for f in own] for own in forced]
    put_rows(
        t,
        "rule_first",
        rules,
        rule_source=INTS,
        rule_target=INTS,
        rule_landed=INTS,
        rule_reaction=INTS,
    )
    t.ints["rule_piece"] = [
        int(m.pieces) for m, own in zip(g.machines, forced, strict=True) for _ in own
    ]
    tests, watched, plain, atoms, touches = [], [], [], [], []
    asked = [
        (f.rule, plain_guard(f.rule.guard) if is_by_hand(m) else f.rule.guard)
        for m, own in zip(g.machines, forced, strict=True)
        for f in own
    ]
    for rule, guard in asked:
        t.pairs.append(guard)
        t.rules.append(rule.text)
        followed = factored_guard(guard)
        test, differences = seen_in_motion(followed)
        touches.append(int(asks_both_sides(followed)))
        signs = [_ZERO_IS.get(c.op, 1) for c in comparisons(followed)]
        plain.append(t.values.number(guard, rule.text))
        tests.append(t.values.number(test, rule.text))
        moves = any(not n.startswith(_STILL) for n in names(rule.guard))
        watched.append(int(moves))
        atoms.append(
            [
                (t.values.number(d), t.values.number(magnitude(d)), sign)
                for d, sign in zip(differences, signs, strict=True)
            ]
            if moves
            else []
        )
    doubted = [int(may_lack_value(f.rule.guard)) for own in forced for f in own]
    t.ints.update(rule_touches=touches)
    t.ints.update(rule_value=plain, rule_test=tests, rule_watched=watched, rule_doubted=doubted)
    put_rows(t, "atom_first", atoms, atom_value=INTS, atom_size=INTS, atom_zero=INTS)


def is_by_hand(m: Machine) -> bool:
    """Whether a machine is no law of a junction, nor of an element."""
    return m.law is None and not m.led_on and not m.pieces


def owners_of(g: FlatGraph) -> dict[int, Machine]:
    """Return the machine that switches each controlled node."""
    return {k: m for m in reversed(g.machines) for k in m.controls}
