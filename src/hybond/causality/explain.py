"""Why a bond has its stroke, and why a mode has no causality, in words."""

from __future__ import annotations

from collections.abc import Iterable

from hybond.causality.record import Causality, Conflict, Origin
from hybond.errors import CausalityError
from hybond.model.graph import FlatGraph, Mode, Node
from hybond.model.kinds import Variable

_MANY = 8
"""Machines named in full in the place of an error; beyond it only those involved."""


def chain(graph: FlatGraph, causality: Causality, bond: int) -> list[str]:
    """Return one line per bond, from the forcing element to `bond`.

    Examples
    --------
    >>> import hybond as hb
    >>> from hybond.causality.assign import assign
    >>> m = hb.Model("rl")
    >>> m.add(V=hb.Se(10), j=hb.One(), r=hb.R(2), l=hb.I(1))
    >>> m.bond("V -> j -> l", "j -> r")
    >>> graph = m.flatten()
    >>> causality = assign(graph, graph.start_mode)
    >>> for line in chain(graph, causality, 2):
    ...     print(line)
    'j -> l': preferred by I:l
    'j -> r': propagated from 1:j
    """
    return [
        f"{graph.bonds[b].name!r}: {reason(graph, causality, b)}" for b in causality.chain(bond)
    ]


def describe_conflict(graph: FlatGraph, mode: Mode | None, conflict: Conflict) -> str:
    """Return one paragraph: both forcing elements, their chains of bonds, the switches.

    Without a mode it says nothing of switches.

    Examples
    --------
    >>> import hybond as hb
    >>> from hybond.causality.assign import assign
    >>> m = hb.Model("two_sources")
    >>> m.add(V=hb.Se(10), W=hb.Se(12), node=hb.Zero())
    >>> m.bond("V -> node", "W -> node")
    >>> graph = m.flatten()
    >>> (conflict,) = assign(graph, graph.start_mode).conflicts
    >>> print(describe_conflict(graph, graph.start_mode, conflict))
    Se V imposes effort on 0-junction node through 'V -> node', and so does Se W through
    'W -> node'.
    """
    node = graph.nodes[conflict.node]
    place = _title(node)
    a, b = _forcing(graph, conflict.origin_a), _forcing(graph, conflict.origin_b)
    gives_a, gives_b = (_name(variable) for variable in conflict.gives)
    if conflict.kind == "under":
        lacks = "effort" if node.kind == "0" else "flow"
        text = f"No bond gives {place} its {lacks}: "
    else:
        text = ""
    if len(conflict.bonds) == 1 and conflict.origin_b.rule == "pin":
        bond = graph.bonds[conflict.bonds[0]]
        other = graph.nodes[bond.tail + bond.head - conflict.node]
        text += f"{a} puts the stroke of {bond.name!r} at {_title(other)}"
        text += _through(graph, conflict.chain_a) if len(conflict.chain_a) > 1 else ""
        text += f", and it is pinned at {place}"
    elif len(conflict.bonds) == 1 and conflict.kind == "over":
        name = graph.bonds[conflict.bonds[0]].name
        along = _through(graph, conflict.chain_a) if len(conflict.chain_a) > 1 else ""
        text += f"{a} imposes {gives_a} on the bond {name!r}{along}, and so does {b}"
    else:
        text += f"{a} imposes {gives_a} on {place}{_through(graph, conflict.chain_a)}"
        if conflict.chain_b != conflict.chain_a:
            verb = "so does {}" if gives_a == gives_b else f"{{}} imposes {gives_b} on it"
            text += f", and {verb.format(b)}{_through(graph, conflict.chain_b)}"
        if gives_a != gives_b:
            text += ", which the gyrator makes the same"
    settings = {} if mode is None else _settings(graph, mode, conflict)
    switches = ", ".join(f"{k} = {v}" for k, v in settings.items())
    return text + (f"; switches: {switches}." if switches else ".")


def conflict_error(graph: FlatGraph, mode: Mode, conflict: Conflict) -> CausalityError:
    """Return the refusal of `mode` for `conflict`: HB-C101 two causes, HB-C102 none."""
    node = graph.nodes[conflict.node]
    involved = _settings(graph, mode, conflict)
    named = graph.mode_names(mode)
    states = named if len(named) <= _MANY else {**involved, "...": "..."}
    setting = ", ".join(f"{k} = {v}" if k != v else k for k, v in states.items())
    pinned = [
        graph.bonds[chain[0]].name
        for origin, chain in (
            (conflict.origin_b, conflict.chain_b),
            (conflict.origin_a, conflict.chain_a),
        )
        if origin.rule == "pin"
    ]
    if pinned:
        hint = f"take the pin of {pinned[0]!r} away"
    elif unjoined(graph, conflict):
        hint = join(unjoined(graph, conflict))
    elif conflict.kind == "over":
        ends = (graph.nodes[origin.node] for origin in (conflict.origin_a, conflict.origin_b))
        hint = "put a resistor between " + " and ".join(_title(end) for end in ends)
    else:
        hint = f"connect a resistor to {_title(node)}"
    if involved:
        hint += ", or change the rules of " + " or ".join(involved)
    return CausalityError(
        describe_conflict(graph, mode, conflict),
        code="HB-C101" if conflict.kind == "over" else "HB-C102",
        where=node.path + (f" in mode ({setting})" if setting else ""),
        hint=hint,
    )


def unjoined(graph: FlatGraph, conflict: Conflict) -> list[Node]:
    """Return the ports of parts that a conflict is with since nothing is joined to them.

    These are junctions in a part with one bond: nothing passes there. One of the model itself may
    stand there to say so.

    Examples
    --------
    >>> import hybond as hb
    >>> from hybond.causality.assign import assign
    >>> part = hb.Model("supply")
    >>> part.add(S=hb.Sf(1), j=hb.One(), out=hb.Zero())
    >>> part.bond("S -> j -> out")
    >>> m = hb.Model("open_circuit")
    >>> m.add(supply=hb.Submodel(part))
    >>> graph = m.flatten()
    >>> (conflict,) = assign(graph, graph.start_mode).conflicts
    >>> [node.path for node in unjoined(graph, conflict)]
    ['supply.out']
    """
    origins = [o for o in (conflict.origin_a, conflict.origin_b) if o.rule == "zero"]
    ends = (graph.nodes[o.node] for o in origins)
    return [n for n in ends if n.is_junction and "." in n.path]


def join(nodes: Iterable[Node]) -> str:
    """Return the remedy for junctions that nothing else is joined to."""
    return "join " + " and ".join(f'{n.path}: "{n.path} -> ..."' for n in dict.fromkeys(nodes))


def reason(graph: FlatGraph, causality: Causality, bond: int) -> str:
    """Say why `bond` has its stroke, in a few words: its own step, not the chain before it.

    Examples
    --------
    >>> import hybond as hb
    >>> from hybond.causality.assign import assign
    >>> m = hb.Model("rl")
    >>> m.add(V=hb.Se(10), j=hb.One(), r=hb.R(2), l=hb.I(1))
    >>> m.bond("V -> j -> l", "j -> r")
    >>> graph = m.flatten()
    >>> [reason(graph, assign(graph, graph.start_mode), bond) for bond in range(3)]
    ['fixed by Se:V', 'preferred by I:l', 'propagated from 1:j']
    """
    why = causality.reasons[bond]
    if why.via >= 0:
        return f"propagated from {_short(graph.nodes[why.via])}"
    node = graph.nodes[why.origin.node]
    short = _short(node)
    chosen = ", ".join(repr(graph.bonds[b].name) for b in why.ruled_out)
    against = f"conflicts with {chosen or 'what is fixed'}"
    match why.origin.rule:
        case "source":
            return f"fixed by {short}"
        case "off":
            return f"fixed by {short}, which is OFF"
        case "zero" if node.is_junction:
            return f"fixed by {short}, which has one bond"
        case "zero":
            return f"fixed by {short}, whose value is zero"
        case "pin":
            return "pinned"
        case "storage" if why.refused:
            return f"derivative for {short}, since integral causality {against}"
        case "storage":
            return f"preferred by {short}"
        case "resistor" if why.refused:
            return f"against the law of {short}, whose direction {against}"
        case "resistor":
            return f"chosen in the direction of the law of {short}"
        case _:
            return f"chosen at {short}" + (f"; the other {against}" if why.refused else "")


def _short(node: Node) -> str:
    return f"{node.kind}:{node.path}"


def _title(node: Node) -> str:
    return f"{node.kind}{'-junction' if node.is_junction else ''} {node.path}"


def _forcing(graph: FlatGraph, origin: Origin) -> str:
    title = _title(graph.nodes[origin.node])
    match origin.rule:
        case "off":
            return f"OFF {title}"
        case "zero" if graph.nodes[origin.node].is_junction:
            return f"{title} (nothing else is joined to it)"
        case "zero":
            return f"{title} (its value is zero)"
        case "pin":
            return f"the pin at {title}"
        case "storage":
            return f"{title} (integral causality)"
        case "resistor":
            return f"{title} (direction of its law)"
        case "free":
            return f"the choice at {title}"
        case _:
            return title


def _name(variable: Variable) -> str:
    return "effort" if variable == "e" else "flow"


def _through(graph: FlatGraph, bonds: tuple[int, ...]) -> str:
    return " through " + ", ".join(repr(graph.bonds[b].name) for b in bonds)


def _settings(graph: FlatGraph, mode: Mode, conflict: Conflict) -> dict[str, str]:
    """Return the machines (or lone switches) that had a part in `conflict`, and their states."""
    found = {}
    for path, on in conflict.switches:
        machine = graph.nodes[graph.by_path[path]].machine
        if machine is None:
            found[path] = "ON" if on else "OFF"
        else:
            found[graph.machines[machine].path] = graph.machines[machine].states[mode[machine]]
    return found
