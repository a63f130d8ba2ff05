"""Tables of switching surfaces: the columns `surface_*` of `hybond.engine.model.Model`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hybond.engine.surfaces.reads import (
    READS_BOND,
    READS_INPUT,
    READS_SIGNAL,
    READS_STORED,
    READS_SWITCH,
    READS_TIME,
)
from hybond.engine.tables.columns import first_of
from hybond.engine.tables.contacts import rules_of
from hybond.engine.tables.guards import seen_in_motion
from hybond.equations.surfaces import Surface, moves, surfaces_of, way_beside
from hybond.model.expressions import Expr, Not, differentiate, names, simplify
from hybond.model.expressions.rounded_roots import magnitude
from hybond.model.graph import Rule

if TYPE_CHECKING:
    from hybond.engine.tables.columns import ModelTables

KINDS = {
    "x": READS_STORED,
    "s": READS_SIGNAL,
    "time": READS_TIME,
    "u": READS_INPUT,
    "e": READS_BOND,
    "f": READS_BOND,
    "on": READS_SWITCH,
    "in": READS_SWITCH,
}
"""What a switching function reads: stored quantities, signals, time, inputs, bond variables, and
what is ON or the state of a machine."""


def put_surfaces(t: ModelTables) -> None:
    """Put the switching surfaces of all machines into the tables."""
    g = t.graph
    surfaces = surfaces_of(g)
    # what was found of a surface is kept from model to model: its rules are equal, not the same
    listed = [(m, f.rule) for m, own in enumerate(rules_of(g)) for f in own]
    rules: dict[tuple[int, Rule], int] = {}
    for k, rule in enumerate(listed):
        rules.setdefault(rule, k)
    t.numbers["surfaces"] = len(surfaces)
    t.ints["surface_machine"] = [s.machine for s in surfaces]
    t.ints["surface_below"] = [s.below for s in surfaces]
    t.ints["surface_above"] = [s.above for s in surfaces]
    t.ints["surface_up"] = [rules[s.machine, s.up] for s in surfaces]
    t.ints["surface_down"] = [rules[s.machine, s.down] for s in surfaces]
    t.ints["surface_value"] = [t.values.number(s.g, s.text) for s in surfaces]
    t.ints["surface_twin"] = [0 if a is b else way_beside(a, b) for a in surfaces for b in surfaces]
    slopes = [_slopes(t, s) for s in surfaces]
    t.ints["surface_first"] = first_of(slopes)
    t.ints["surface_kind"] = [k for row in slopes for k, _, _ in row]
    t.ints["surface_index"] = [k for row in slopes for _, k, _ in row]
    t.ints["surface_slope"] = [k for row in slopes for _, _, (k, _) in row]
    t.floats["surface_constant"] = [a for row in slopes for _, _, (_, a) in row]
    # what else the rules ask for: first of the one that leads up, then of the other
    rests = [list(rest) for s in surfaces for rest in (s.up_rest, s.down_rest)]
    t.ints["surface_rest"] = first_of(rests)
    t.ints["rest_value"] = [t.values.number(e) for row in rests for e in row]
    t.ints["rest_moves"] = [int(moves(e)) for row in rests for e in row]
    _put_watched(t, [e for row in rests for e in row])


def _put_watched(t: ModelTables, rests: list[Expr]) -> None:
    """Put what is watched while sliding: that something else ceases to be as the rules ask."""
    pairs, tests, first = [], [], [len(t.ints["atom_value"])]
    for e in rests:
        pair = test = -1
        if moves(e):
            rule = Rule(0, 0, Not(e), "")
            pair = len(t.pairs)
            t.pairs.append(rule.guard)
            seen, differences = seen_in_motion(rule.guard)
            test = t.values.number(seen)
            t.ints["atom_value"] += [t.values.number(d) for d in differences]
            t.ints["atom_size"] += [t.values.number(magnitude(d)) for d in differences]
            t.ints["atom_zero"] += [1] * len(differences)
        pairs.append(pair)
        tests.append(test)
        first.append(len(t.ints["atom_value"]))
    t.ints.update(rest_pair=pairs, rest_test=tests, rest_atom=first)


def _slopes(t: ModelTables, s: Surface) -> list[tuple[int, int, tuple[int, float]]]:
    """Return the derivatives of a switching function by what it reads."""
    found: list[tuple[int, int, tuple[int, float]]] = []
    for name in sorted(names(s.g)):
        kind, _, index = name.partition(":")
        if kind not in KINDS:
            continue
        if KINDS[kind] == READS_SWITCH:
            found.append((READS_SWITCH, t.slots.index[name] - t.slots.on.start, (-1, 0.0)))
            continue
        slope: Expr = simplify(differentiate(s.g, name))
        place = int(index) if index else 0
        if kind == "f":
            place += len(t.graph.bonds)
        found.append((KINDS[kind], place, t.values.entry(slope)))
    return found
