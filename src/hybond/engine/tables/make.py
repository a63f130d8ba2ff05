"""Tables of a model: the columns that `engine.model.Model` names."""

from __future__ import annotations

from typing import Any

from hybond.engine.tables.arguments import put_arguments
from hybond.engine.tables.calls import put_rated, refuse_calls
from hybond.engine.tables.code import check_depths
from hybond.engine.tables.columns import FLOATS, INTS, ModelTables, put_rows
from hybond.engine.tables.contacts import limit_at_rest, put_contacts
from hybond.engine.tables.courses import put_courses
from hybond.engine.tables.elements import put_elements
from hybond.engine.tables.followers import put_followers
from hybond.engine.tables.hangs import put_hangs
from hybond.engine.tables.islands import put_islands
from hybond.engine.tables.kinks import put_kinks
from hybond.engine.tables.laws import put_laws
from hybond.engine.tables.machines import put_machines
from hybond.engine.tables.options import Options, options_of
from hybond.engine.tables.powers import put_powers
from hybond.engine.tables.signals import put_acting, put_signals
from hybond.engine.tables.storages import put_storages
from hybond.engine.tables.surfaces import put_surfaces
from hybond.engine.tables.terms import put_terms
from hybond.engine.tables.told import put_told
from hybond.equations.slots import slots_of
from hybond.model.expressions import (
    Expr,
    names,
)
from hybond.model.fieldless import reads_pre, switches_of
from hybond.model.graph import FlatGraph
from hybond.model.resolve import prior


def tables_of(
    graph: FlatGraph,
    *,
    options: Options | None = None,
    calling: bool = False,
    tells: bool = False,
    **given: Any,
) -> ModelTables:
    """Return the tables of a model; `given` are options of the run, by name.

    They are taken from the experiment unless all of them are there, `options`. With `calling` they
    are for a run that can call inputs that are functions in Python, and blocks. With `tells` it
    writes down what explains its events: what guards read, energies.

    If numbers of the graph are expressions of parameters, those in the tables are so as well.

    Raises
    ------
    ModelError
        HB-E630 an input that is a function in Python or a block, without `calling`, HB-E631 an
        element that says too many things; those of `options.options_of`.
    """
    options = options or options_of(graph, given)
    graph = options.graph
    t = ModelTables(graph, slots_of(graph))
    t.numbers.update(options.numbers)
    _sizes(t)
    put_machines(t)
    put_elements(t)
    _junctions(t)
    put_islands(t)
    put_storages(t)
    put_powers(t)
    if not calling:
        refuse_calls(graph)
    put_signals(t)
    _priors(t)
    put_laws(t)
    put_acting(t)
    put_hangs(t)
    put_surfaces(t)
    put_followers(t)
    put_kinks(t)
    put_courses(t)
    put_arguments(t)
    put_terms(t)
    put_contacts(t)
    put_told(t, tells=tells)
    _reads(t)
    _outputs(t, options.outputs)
    t.numbers["ends"] = graph.ends
    put_rated(t)
    check_depths(t.pairs, t.slots.index)
    return t


def _sizes(t: ModelTables) -> None:
    g, s = t.graph, t.slots
    t.numbers.update(
        bonds=len(g.bonds),
        storages=len(g.storages),
        integrals=len(g.integrals),
        inputs=len(g.inputs),
        watches=len(g.watches),
        machines=len(g.machines),
        switches=sum(n.controlled for n in g.nodes),
        nodes=len(g.nodes),
        slots=s.size,
        input_slot=s.u.start,
        input_rate_slot=s.du.start,
        signal_slot=s.s.start,
        stored_slot=s.x.start,
        bond_slot=s.w.start,
        on_slot=s.on.start,
        at_slot=s.at.start,
        laws=sum(m.law is not None for m in g.machines),
        decided=int(g.indeterminate == "least leakage"),
    )
    t.nodes = [n.path for n in g.nodes]
    t.bonds = [f'"{b.name}".{kind}' for kind in "ef" for b in g.bonds]


def _junctions(t: ModelTables) -> None:
    g = t.graph
    switches = [n.index for n in g.nodes if n.controlled]
    nodes = [n for n in g.nodes if n.is_junction]
    t.numbers["junctions"] = len(nodes)
    t.ints["junction_kind"] = [int(n.kind) for n in nodes]
    t.ints["junction_switch"] = [switches.index(n.index) if n.controlled else -1 for n in nodes]
    ends = [[(end.bond, end.sign) for end in n.ends] for n in nodes]
    put_rows(t, "end_first", ends, end_bond=INTS, end_sign=INTS)


def _priors(t: ModelTables) -> None:
    g = t.graph
    switches = [n.index for n in g.nodes if n.controlled]
    nodes = [n for n in g.nodes if reads_pre(n)]
    by_source = {m.law.source: m for m in reversed(g.machines) if m.law}
    acting, machine, state = [], [], []
    read: list[list[tuple[int, int, float]]] = []
    for node in nodes:
        acting.append([(switches.index(s.index),) for s in switches_of(g, node)])
        owner = by_source.get(node.index)
        machine.append(owner.index if owner is not None and node.implied else -1)
        state.append(owner.states.index("impact") if owner and "impact" in owner.states else -1)
        assert node.law is not None
        slots = {t.slots.index[n] for e in node.law.expressions for a in prior(e) for n in names(a)}
        limit = t.values.entry(limit_at_rest(g, node), f"what {node.path} reads at rest")
        read.append([(k, *limit) for k in sorted(slots)])
    t.numbers["priors"] = len(nodes)
    put_rows(t, "prior_first", acting, prior_switch=INTS)
    t.ints["prior_machine"] = machine
    t.ints["prior_state"] = state
    put_rows(
        t,
        "prior_read",
        read,
        prior_slot=INTS,
        prior_limit=INTS,
        prior_limit_constant=FLOATS,
    )


def _reads(t: ModelTables) -> None:
    """Put what each pair reads, a guard in the forms that it has while time passes too."""
    forms = [[e] for e in t.pairs]
    first = t.ints["atom_first"]
    for k, test in enumerate(t.ints["rule_test"]):
        own = slice(first[k], first[k + 1])
        numbers = [test, *t.ints["atom_value"][own], *t.ints["atom_size"][own]]
        forms[k] += [t.values.all[n] for n in numbers]
    first = t.ints["rest_atom"]
    for r, (k, test) in enumerate(zip(t.ints["rest_pair"], t.ints["rest_test"], strict=True)):
        own = slice(first[r], first[r + 1])
        numbers = [test, *t.ints["atom_value"][own], *t.ints["atom_size"][own]]
        if k >= 0:
            forms[k] += [t.values.all[n] for n in numbers]
    for k, a in enumerate(t.ints["kink_pair"]):
        forms[a].append(t.values.all[t.ints["atom_size"][int(t.numbers["kink_atom"]) + k]])
    read = [{t.slots.index[n] for e in own for n in names(e)} for own in forms]
    put_rows(t, "read_first", [[(k,) for k in sorted(own)] for own in read], read_slot=INTS)


def _outputs(t: ModelTables, outputs: list[tuple[str, Expr]]) -> None:
    t.outputs = [name for name, _ in outputs]
    t.numbers["outputs"] = len(outputs)
    t.ints["output_value"] = [t.values.number(e, name) for name, e in outputs]
