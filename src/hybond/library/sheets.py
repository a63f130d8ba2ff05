"""What a page says of a part: its ports, parameters, inputs and signals, with their comments."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from hybond.library.shelves import SHELVES, part
from hybond.model.expressions import Name
from hybond.model.graph import FlatGraph
from hybond.model.parts import InputPart, Integral, Sampled
from hybond.model.unit_words import unit_of
from hybond.records import dataclass


@dataclass(frozen=True, slots=True)
class Port:
    """A place for bonds: a junction and what all that is bonded to it share."""

    name: str
    domain: str
    shares: str
    """``"effort"`` (a 0-junction), ``"flow"`` (a 1-junction), or empty: an element's own port."""


@dataclass(frozen=True, slots=True)
class Line:
    """A parameter, input or signal: its value as written, its unit, the comment beside it."""

    name: str
    value: str
    unit: str
    about: str


@dataclass(frozen=True, slots=True)
class Sheet:
    """All that a user of a part has to know."""

    name: str
    title: str
    about: str
    ports: tuple[Port, ...]
    parameters: tuple[Line, ...]
    inputs: tuple[Line, ...]
    signals: tuple[Line, ...]
    text: str
    """The model file."""


def sheet(name: str) -> Sheet:
    """Return what there is to know of a part.

    Raises
    ------
    ModelError
        HB-M105 if there is no such part.

    Examples
    --------
    >>> import hybond as hb
    >>> for line in hb.library.sheet("electrical.diode").parameters:
    ...     print(line.name, "=", line.value, "-", line.about)
    drop = 0 V - voltage at which the current begins
    R_on = 0 ohm - resistance while it conducts
    G_off = 0 S - conductance that leaks beside it, also while it conducts
    """
    model = part(name)
    text = SHELVES.joinpath(*name.split(".")).with_suffix(".toml").read_text(encoding="utf-8")
    graph = model.flatten()
    said = _comments(text)
    units = {given.path: unit_of(Name(f"u:{given.index}"), graph) for given in graph.inputs}
    units |= {path: unit_of(tree, graph) for path, tree in graph.signals.items()}
    units |= {s.path: unit_of(Name(f"s:{s.index}"), graph) for s in graph.integrals}

    def line(section: str, key: str, value: str) -> Line:
        unit = "" if section == "parameters" else units.get(key, "")
        return Line(key, value, unit, said.get((section, key), ""))

    return Sheet(
        name,
        model.title,
        model.about.strip(),
        tuple(_port(port, target, graph) for port, target in model.ports.items()),
        tuple(line("parameters", key, _written(v)) for key, v in model.parameters.items()),
        tuple(line("inputs", key, _waveform(v)) for key, v in model.inputs.items()),
        tuple(line("signals", key, _expression(v)) for key, v in model.signals.items()),
        text,
    )


def _port(name: str, target: str, graph: FlatGraph) -> Port:
    node = graph.nodes[graph.by_path[_node(target, graph)]]
    shares = {"0": "effort", "1": "flow"}.get(node.kind, "")
    return Port(name, node.domain.name, shares)


def _node(target: str, graph: FlatGraph) -> str:
    """Return the node of a port, which may be ``lever.1``, port 1 of a lever."""
    return target if target in graph.by_path else target.rpartition(".")[0]


def _waveform(given: InputPart) -> str:
    if given.pwm is not None:
        return "pwm, " + ", ".join(f"{key} {_written(v)}" for key, v in given.pwm.items())
    if given.table is not None:
        return f"table of {len(given.table)} points"
    return _written(given.constant)


def _expression(signal: Any) -> str:
    if isinstance(signal, Integral):
        return f"integral of {signal.rate}, from {_written(signal.start)}"
    if isinstance(signal, Sampled):
        return f"sample of {signal.value}, every {_written(signal.every)}"
    return str(signal)


def _written(value: Any) -> str:
    return value if isinstance(value, str) else f"{value:g}"


def _comments(text: str) -> Mapping[tuple[str, str], str]:
    """Return the comment at the end of the line of each key: ``(section, key)`` to its words."""
    import tomlkit
    from tomlkit.items import Item, Table

    return {
        (section, key): item.trivia.comment.lstrip("# ").rstrip()
        for section, table in tomlkit.parse(text).items()
        if isinstance(table, Table)
        for key, item in table.items()
        if isinstance(item, Item)  # tomlkit gives true and false as Python has them
    }
