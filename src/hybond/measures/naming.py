"""The names by which the signals of a run are read."""

from __future__ import annotations

from hybond.errors import HybondError, UnitError, UsageError
from hybond.model.expressions import Expr, names
from hybond.model.graph import FlatGraph
from hybond.names import did_you_mean


def names_of(graph: FlatGraph) -> list[str]:
    """Return stored quantities, co-energy variables, signals and listed outputs of a model."""
    found = []
    for s in graph.storages:
        found += [s.path, f"{s.path.rpartition('.')[0]}.{'e' if s.kind == 'C' else 'f'}"]
    found += [i.path for i in graph.integrals]
    found += list(graph.signals)
    for key in ("plot", "outputs"):
        found += [str(n) for n in graph.experiment.get(key, ())]
    return list(dict.fromkeys(found))


def read_name(graph: FlatGraph, name: str) -> Expr:
    """Return a name, or any expression of names, in canonical names.

    Raises
    ------
    UsageError
        HB-S109 with the nearest names.
    """
    assert graph.read is not None
    if not isinstance(name, str):
        raise UsageError(
            f"{name!r} is not the name of a signal",
            code="HB-S109",
            where="name",
            hint=f'a name in quotes: run["{next(iter(names_of(graph)), "v.f")}"]',
        )
    try:
        found = graph.read(name)
    except UnitError:
        raise  # it is there, and means nothing
    except HybondError as error:
        raise UsageError(
            f"there is no signal {name!r}: {error.why}",
            code="HB-S109",
            where=name.strip() or "signals",
            hint=error.hint or did_you_mean(name, names_of(graph)),
        ) from None
    known = {f"at:{w.index}" for w in graph.watches}
    if any(n.startswith("at:") and n not in known for n in names(found)):
        raise UsageError(
            f"{name!r} compares time with something that nothing in the model compares it with",
            code="HB-S109",
            where=name,
            hint="make it a signal of the model, so that a run stops there: m.signal(x=...)",
        )
    return found
