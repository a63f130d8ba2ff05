"""Tables of storage: where it begins, its laws and their slopes, how its energy is found."""

from __future__ import annotations

from hybond.engine.tables.columns import FLOATS, INTS, ModelTables, put_rows
from hybond.engine.tables.expressions import number_of
from hybond.engine.tables.start import start_of
from hybond.equations.antiderivative import known_energy
from hybond.equations.rounding import rounding
from hybond.equations.storage import EXACT, gauss, polynomial_degree, stiffness, stored_names
from hybond.model.expressions import Binary, Expr, Name, Neg, Number, substitute, turning
from hybond.model.expressions.slots import is_slotted
from hybond.model.expressions.tree import walk
from hybond.model.graph import Storage


def put_storages(t: ModelTables) -> None:
    """Put storage into the tables."""
    g = t.graph
    t.stored = [s.path for s in g.storages] + [i.path for i in g.integrals]
    t.ints["storage_bond"] = [s.bond for s in g.storages]
    t.ints["storage_kind"] = [int(s.kind == "I") for s in g.storages]
    t.ints["storage_sign"] = [s.sign for s in g.storages]
    t.floats["storage_start"] = [number_of(a) for a in start_of(g)[: len(g.storages)]]
    t.ints["storage_pseudo"] = [int(g.bonds[s.bond].domain.pseudo) for s in g.storages]
    kinds = [(t.ints["bond_island"][b.index], b.domain.name) for b in g.bonds]
    number = {kind: k for k, kind in enumerate(dict.fromkeys(kinds))}
    t.numbers["classes"] = 2 * len(number)
    own = [number[kind] for kind in kinds]
    t.ints["bond_class"] = [2 * k for k in own] + [2 * k + 1 for k in own]
    domains = [b.domain.name for b in g.bonds]
    place = {name: k for k, name in enumerate(dict.fromkeys(domains))}
    t.numbers["impulse_kinds"] = 2 * len(place)
    kind = [place[name] for name in domains]
    t.ints["bond_impulse"] = [2 * k for k in kind] + [2 * k + 1 for k in kind]
    t.ints["storage_impulse"] = [2 * kind[s.bond] + int(s.kind == "C") for s in g.storages]
    laws, rows = [], []
    kinks: dict[int, list[tuple[int]]] = {}
    groups: dict[int, list[int]] = {}
    degrees: dict[int, int | None] = {}
    together: dict[int, list[Storage]] = {}
    energies: dict[int, int] = {}
    for s in g.storages:
        together.setdefault(s.node, []).append(s)
    for s in g.storages:
        node = g.nodes[s.node]
        assert node.law is not None
        siblings = together[s.node]
        slopes = [(o, stiffness(node, s.port, o.port, g, siblings)) for o in siblings]
        rows.append([(o.index, *t.values.entry(e)) for o, e in slopes])
        if node.law.matrix is not None:
            laws.append(-1)
            continue
        law = substitute(node.law.expressions[s.port], stored_names(node, g, siblings))
        laws.append(t.values.number(law, f"law of {node.path}"))
        groups.setdefault(s.node, []).append(s.index)
        whole = known_energy(law, f"x:{s.index}") if len(siblings) == 1 else None
        energies[s.node] = -1 if whole is None else t.values.number(whole)
        kinks.setdefault(s.node, []).extend((t.values.number(e),) for e in turning(law))
        degree, before = polynomial_degree(law), degrees.get(s.node, 0)
        degrees[s.node] = None if degree is None or before is None else max(degree, before)
    t.ints["co_energy"] = laws
    t.ints["co_rounding"] = [_rounding(t, law) for law in laws]
    put_powers(t, rows)
    put_rows(t, "stiff_first", rows, stiff_other=INTS, stiff_value=INTS, stiff_constant=FLOATS)
    t.numbers["groups"] = len(groups)
    put_rows(t, "group_first", [[(k,) for k in own] for own in groups.values()], group_storage=INTS)
    points = []
    for node_index in groups:
        degree = degrees[node_index]
        exact = degree is not None and degree <= EXACT
        points.append(list(zip(*gauss((degree or 0) // 2 + 1), strict=True)) if exact else [])
    put_rows(t, "point_first", points, point_at=FLOATS, point_weight=FLOATS)
    put_rows(t, "bend_first", [kinks[node] for node in groups], bend_value=INTS)
    t.ints["energy_law"] = [energies[node] for node in groups]


def _rounding(t: ModelTables, law: int) -> int:
    """Return the law of what rounding of a law is measured by, -1 where that is what it gives.

    A gauge pressure is a difference of pressures, and has their last digits.
    """
    if law < 0 or not any(
        isinstance(p, Binary) and p.op in "+-" for p, _ in walk(t.values.all[law])
    ):
        return -1
    return t.values.number(rounding(t.values.all[law]))


def put_powers(t: ModelTables, stiff: list[list[tuple[int, int, float]]]) -> None:
    """Put laws of storages, then entries of the stiffness, as sums of powers of what they read."""
    stored = [f"x:{k}" for k in range(len(t.stored))]
    asked = [(law, stored[k]) for k, law in enumerate(t.ints["co_energy"])]
    asked += [(law, stored[other]) for row in stiff for other, law, _ in row]
    found = [powers_of(t.values.all[e], of) if e >= 0 else None for e, of in asked]
    rows = [powers or [] for powers in found]
    put_rows(t, "power_first", rows, power_degree=INTS, power_factor=FLOATS)


def powers_of(e: Expr, name: str) -> list[tuple[int, float]] | None:
    """Return degrees and factors of an expression that is a sum of powers of one name, else None.

    In the order in which it adds them, up to the third power.

    Examples
    --------
    >>> from hybond.model.expressions import parse
    >>> powers_of(parse("2*x - 3*(4*x^3) + 5"), "x")
    [(1, 2.0), (3, -12.0), (0, 5.0)]
    >>> powers_of(parse("2*x + sin(x)"), "x")
    """
    match e:
        case Binary(op="+" | "-" as op, left=left, right=right):
            before, last = powers_of(left, name), power_of(right, name)
            if before is None or last is None:
                return None
            degree, factor = last
            return [*before, (degree, factor if op == "+" else factor * -1.0)]
    only = power_of(e, name)
    return None if only is None else [only]


def power_of(e: Expr, name: str) -> tuple[int, float] | None:
    """Return the degree and the factor of a power of a name, None if it is none."""
    match e:
        case Number(value):
            return 0, number_of(value)
        case Name(path):
            return (1, 1.0) if path == name else None
        case Binary(op="*", left=Number(value), right=right):
            found = power_of(right, name)
            return None if found is None else (found[0], number_of(value) * found[1])
        case Binary(op="^", left=Name(path), right=Number(value)) if not is_slotted(value):
            return (int(value), 1.0) if path == name and value in (2.0, 3.0) else None
        case Neg(arg):
            found = power_of(arg, name)
            return None if found is None else (found[0], found[1] * -1.0)
    return None
