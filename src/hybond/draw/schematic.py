"""A schematic: parts as symbols, wires between their ports, dots where wires meet.

Made of models that are made of parts. What two domains call a node is one junction each: the
0-junction of circuits and pipes, the 1-junction of mechanics; both are dots here, as far as
nothing but wires meets in them. What is no part is drawn as its letters.
"""

from __future__ import annotations

import itertools
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

from hybond.draw.arrange import layout
from hybond.draw.beside import Wire, beside, box_of, freest, named_nodes
from hybond.draw.circuit_places import Part as CircuitPart
from hybond.draw.circuit_places import Plan, circuit_places, two_ended
from hybond.draw.composing import composed
from hybond.draw.drawing import Drawing
from hybond.draw.geometry import Box, Point
from hybond.draw.measure import width
from hybond.draw.meeting import cut_back, element_of, joint, joints_of, nets_of, port_of
from hybond.draw.one_port_dots import MARK, with_dots
from hybond.draw.scene import Group, Line, Scene, Text
from hybond.draw.sketch import typeset
from hybond.draw.symbols import Placed, boxed, placed
from hybond.draw.wires import End, clear, led
from hybond.draw.wires import Wire as Wanted
from hybond.draw.words import shifted
from hybond.errors import UsageError
from hybond.model.builder import Model
from hybond.model.hierarchy import submodel_of
from hybond.model.kinds import KINDS
from hybond.model.parts import Part, SubmodelPart
from hybond.model.symbol import CORE, Symbol
from hybond.model.written_out import written_out
from hybond.units import try_quantity

CELL = (120.0, 100.0)
"""Pixels from one cell of the layout to the next: symbols need more than letters."""
MARGIN = 34.0
LONGEST = 26
"""Characters of what is written below a name."""
LETTERS = 19.0
CAP = 0.73
"""Size of letters, and how high their capitals are."""
_ROLE = {"diode": "diode", "switch": "switch", "resistor": "load", "current_source": "source"}
_SPREADING = ("C", "I", "TF", "GY")
"""What a source has none of: machines and loads have sources within them, too."""


@dataclass(frozen=True, slots=True)
class _Node:
    """A part, or what is none, and where its middle is."""

    name: str
    about: str
    symbol: Symbol | None
    ports: tuple[str, ...]
    letters: str
    at: Point
    is_part: bool


def draw_schematic(
    model: Model,
    *,
    positions: Mapping[str, tuple[float, float]] | None = None,
    title: bool = True,
) -> Drawing:
    """Draw a model that is made of parts as a schematic.

    Parameters
    ----------
    positions : mapping of name to (x, y)
        Where elements stand, in grid cells; by default where `Model.layout` puts them, the others
        where a layout finds room.
    title : bool
        Whether the title of the model stands above.

    Raises
    ------
    UsageError
        HB-D110 for a model without parts.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("divider", domain="electrical")
    >>> m.add(v=hb.Submodel("electrical.voltage_source"), r=hb.Submodel("electrical.resistor"))
    >>> m.add(a=hb.Zero(), b=hb.Zero())
    >>> m.bond("v.plus -> a", "a -> r.plus", "r.minus -> b", "b -> v.minus")
    >>> [g.name for g in draw_schematic(m).scene.groups][:2]
    ['title', 'wire']
    """
    model, stems = with_dots(written_out(model, layout=positions))
    bonds = _bonds(model)
    names = list(model.elements)
    if not any(isinstance(part, SubmodelPart) for part in model.elements.values()):
        raise UsageError(
            f"{model.name!r} has no parts: there is no schematic of single elements",
            code="HB-D110",
            where=model.name,
            hint="draw its bond graph, or build it from parts of the library",
        )
    dots = {n for n in names if _is_dot(model, n, bonds)}
    ends = _named_nets(dots, bonds)
    plan = _plan(model, dots, ends)
    places, at = _where(model, names, bonds, plan)
    nodes = {name: _node(model, name, at[name]) for name in names}
    toward = _toward(nodes, bonds) | (plan.toward if plan is not None else {})
    facing = plan.facing if plan is not None else {}
    put: dict[str, Placed] = {}
    for name, node in nodes.items():
        if name in dots:
            continue
        symbol = node.symbol
        if not node.is_part:
            put[name] = _lettered(node)
            continue
        if symbol is None:
            sides = {port: _side(toward, name, port) for port in node.ports}
            symbol = boxed(node.letters, node.ports, sides.__getitem__)
        ways = _of(toward, name, node.ports)
        put[name] = placed(symbol, node.at, ways, facing=facing.get(name, (0.0, 0.0)))
    nets = nets_of(dots | {f"{n}.{port}" for n, p in put.items() for port in p.pins}, bonds)
    cores = plan.cores if plan is not None else ()
    wires, meets = cut_back(_wires(nodes, put, dots, bonds, nets, plan, ends), sorted(dots))
    groups = [_wire(a, b, way, stems) for a, b, way in wires]
    if plan is not None and plan.bars:
        groups.append(Group("cores", "", "", plan.bars))
    groups += _parts(nodes, put, wires, cores)
    told = [n for n in names if n in dots and not n.endswith(MARK)]
    groups += named_nodes({n: meets.get(n, nodes[n].at) for n in told}, groups, wires)
    groups.append(Group("joints", "", "", tuple(joint(p) for p in joints_of(wires, nets, put))))
    places = {n: at for n, at in places.items() if not n.endswith(MARK)}
    return _drawing(model.title or model.name if title else "", groups, places)


def _bonds(model: Model) -> list[tuple[str, str]]:
    """Return the ends of each bond as written, arrow by arrow."""
    found = []
    for text in model.bonds:
        chain = str(text).rpartition(":")[2]
        ends = [e.strip() for e in chain.split("->")]
        found += list(itertools.pairwise(ends))
    return [(a, b) for a, b in found if {element_of(a), element_of(b)} <= model.elements.keys()]


def _places(
    model: Model,
    names: Sequence[str],
    bonds: Sequence[tuple[str, str]],
) -> dict[str, tuple[float, float]]:
    given = model.layout
    number = {n: k for k, n in enumerate(names)}
    if set(number) <= given.keys():
        return {n: given[n] for n in names}
    kinds = [p.kind if isinstance(p, Part) else "TF" for p in model.elements.values()]
    pairs = [
        (number[element_of(a)], number[element_of(b)])
        for a, b in bonds
        if element_of(a) != element_of(b)
    ]
    pinned = {number[n]: at for n, at in given.items() if n in number}
    found = dict(zip(names, layout(kinds, pairs, pinned=pinned), strict=True))
    if pinned:
        return found
    return composed(found, *_feet(model))


def _plan(model: Model, dots: Collection[str], nets: Mapping[str, str]) -> Plan | None:
    """Return the plan of an electrical circuit of parts with two ends, None of other models.

    `nets` are the nets of ends, by their names or by that of a dot in them.
    """
    if model.layout.keys() & model.elements.keys():
        return None
    sources, grounds = _feet(model)
    parts, signs = [], {}
    for name, part in model.elements.items():
        if name in dots and isinstance(part, Part) and part.kind == "0":
            continue
        if not isinstance(part, SubmodelPart):
            return None
        inner = submodel_of(part, name, model.models)
        symbol = inner.symbol
        ends = [nets.get(f"{name}.{port}", "") for port in inner.ports]
        if name in grounds and len(ends) == 1 and ends[0]:
            signs[name] = ends[0]
        elif symbol is not None and two_ended(symbol) and inner.domain == "electrical":
            one, two = sorted(inner.ports, key=symbol.pins.__getitem__)
            plus, minus = nets.get(f"{name}.{one}", ""), nets.get(f"{name}.{two}", "")
            if not plus or not minus:
                return None
            about = _node(model, name, (0.0, 0.0)).about
            role = "source" if name in sources else _role(part)
            core = str(part.parameters.get(CORE, ""))
            words = (name, about) if about else (name,)
            parts.append(CircuitPart(name, plus, minus, (one, two), role, words, core))
        else:
            return None
    return circuit_places(parts, list(dict.fromkeys(nets.values())), signs)


def _role(part: SubmodelPart) -> str:
    """Return what a part is in a circuit, as far as that says where it stands."""
    return _ROLE.get(part.model.rpartition(".")[2], "plain") if isinstance(part.model, str) else ""


def _named_nets(dots: Collection[str], bonds: Sequence[tuple[str, str]]) -> dict[str, str]:
    """Return the net of each end, by a dot that is in it, else by one of its ends."""
    nets = nets_of({end for bond in bonds for end in bond}, bonds)
    named = {
        net: end for (a, b), net in zip(bonds, nets, strict=True) for end in (a, b) if end in dots
    }
    return {
        end: named.get(net, net) for (a, b), net in zip(bonds, nets, strict=True) for end in (a, b)
    }


def _where(
    model: Model, names: Sequence[str], bonds: Sequence[tuple[str, str]], plan: Plan | None
) -> tuple[dict[str, tuple[float, float]], Mapping[str, Point]]:
    """Return where all stands, in cells and in pixels."""
    if plan is not None:
        return {n: (x / CELL[0], y / CELL[1]) for n, (x, y) in plan.at.items()}, plan.at
    places = _places(model, names, bonds)
    return places, {n: (x * CELL[0], y * CELL[1]) for n, (x, y) in places.items()}


def _feet(model: Model) -> tuple[list[str], list[str]]:
    """Return the names of what feeds a system, and of what stands for its zero."""
    sources, grounds = [], []
    for name, part in model.elements.items():
        if isinstance(part, SubmodelPart):
            inner = submodel_of(part, name, model.models)
            own = [p for p in inner.elements.values() if isinstance(p, Part)]
            given = inner.parameters | dict(part.parameters)
            written = [str(p.value) for p in own if p.kind in ("Se", "Sf")]
            values = [_zero(str(given.get(v, v))) for v in written]
            switched = bool(inner.machines) or any(p.options.get("law") for p in own)
            if "0" in values and len(inner.ports) == 1 and all(p.kind != "Sf" for p in own):
                grounds.append(name)
            elif values and not switched and all(p.kind not in _SPREADING for p in own):
                sources.append(name)
    return sources, grounds


def _wire(a: str, b: str, way: tuple[Point, ...], stems: Mapping[str, str]) -> Group:
    """Return a wire by the name of its bond: a dot of its own stands for the port behind it."""
    if stems.get(a) == b:
        return Group("stem", "", "", (Line("wire", way),))
    bond = f"{stems.get(a, a)} -> {stems.get(b, b)}"
    return Group("wire", bond, bond, (Line("wire", way),))


def _zero(value: str) -> str:
    """Return a plain 0 for zero in any unit, and any other value as it is."""
    quantity = try_quantity(value)
    return "0" if quantity is not None and quantity.value == 0.0 else value


def _node(model: Model, name: str, at: Point) -> _Node:
    part = model.elements[name]
    if isinstance(part, SubmodelPart):
        inner = submodel_of(part, name, model.models)
        about = ", ".join(typeset(str(v)) for v in list(part.parameters.values())[:2])
        letters = part.model.rpartition(".")[2].replace("_", " ")
        return _Node(name, _short(about), inner.symbol, tuple(inner.ports), letters, at, True)
    kind = part.kind
    value = (
        "" if kind in ("0", "1") or not isinstance(part.value, str | int | float) else part.value
    )
    return _Node(name, _short(typeset(str(value))), None, (), KINDS[kind].symbol, at, False)


def _short(text: str) -> str:
    return text if len(text) <= LONGEST else text[: LONGEST - 1] + "…"


def _lettered(node: _Node) -> Placed:
    """Return the letters of what is no part, as in a bond graph."""
    role = "node junction" if node.letters in ("0", "1") else "node"
    (x, y), half = node.at, max(width(node.letters, LETTERS, bold=True) / 2.0, 6.0)
    box = Box(x - half, y - CAP * LETTERS / 2.0, x + half, y + CAP * LETTERS / 2.0).grown(5.0)
    text = Text(role, node.letters, x, y + CAP * LETTERS / 2.0)
    return Placed((text,), {}, box)


def _is_dot(model: Model, name: str, bonds: Sequence[tuple[str, str]]) -> bool:
    """Whether a junction is a place where wires meet: one that no law or machine switches."""
    part = model.elements[name]
    if not isinstance(part, Part) or part.kind not in ("0", "1") or part.options.get("law"):
        return False
    if any(name in on for m in model.machines.values() for on in m.states.values()):
        return False
    ends = [(a, b) for a, b in bonds if name in (element_of(a), element_of(b))]
    others = [b if element_of(a) == name else a for a, b in ends]
    return bool(others) and all(
        isinstance(other := model.elements[element_of(o)], SubmodelPart)
        or (isinstance(other, Part) and other.kind == part.kind)
        for o in others
    )


def _toward(nodes: Mapping[str, _Node], bonds: Sequence[tuple[str, str]]) -> dict[str, Point]:
    """Return for each end of a bond the way from its node to the other ones."""
    found: dict[str, Point] = {}
    for a, b in bonds:
        for own, other in ((a, b), (b, a)):
            x, y = found.get(own, (0.0, 0.0))
            p, q = nodes[element_of(own)].at, nodes[element_of(other)].at
            found[own] = (x + q[0] - p[0], y + q[1] - p[1])
    return found


def _of(toward: Mapping[str, Point], name: str, ports: Sequence[str]) -> dict[str, Point]:
    return {p: toward[f"{name}.{p}"] for p in ports if f"{name}.{p}" in toward}


def _side(toward: Mapping[str, Point], name: str, port: str) -> str:
    x, y = toward.get(f"{name}.{port}", (-1.0, 0.0))
    if abs(x) >= abs(y):
        return "e" if x > 0 else "w"
    return "s" if y > 0 else "n"


def _wires(
    nodes: Mapping[str, _Node],
    put: Mapping[str, Placed],
    dots: set[str],
    bonds: Sequence[tuple[str, str]],
    nets: Sequence[str],
    plan: Plan | None,
    ends_of: Mapping[str, str],
) -> list[Wire]:
    """Return a wire for each bond."""
    wanted = []
    for (a, b), net in zip(bonds, nets, strict=True):
        ends: list[End] = []
        for end in (a, b):
            pin = None if element_of(end) in dots else put[element_of(end)].pins.get(port_of(end))
            ends.append((nodes[element_of(end)].at, None) if pin is None else pin)
        wanted.append(Wanted(ends[0], ends[1], net))
    found: list[Wire] = []
    solid = [p.box for p in put.values() if p.pins] + list(plan.cores if plan is not None else ())
    given: Sequence[tuple[Point, ...] | None] = ()
    if plan is not None:
        direct = [
            plan.way(w.a[0], w.b[0], ends_of[a]) for (a, _), w in zip(bonds, wanted, strict=True)
        ]
        given = clear(wanted, direct, solid)
    for (a, b), w, way in zip(bonds, wanted, led(wanted, solid, given=given), strict=True):
        for k, end in enumerate((a, b)):
            if element_of(end) not in dots and (w.a, w.b)[k][1] is None:
                way = _clipped(way, put[element_of(end)].box, at_end=bool(k))
        found.append((a, b, way))
    return found


def _clipped(way: tuple[Point, ...], box: Box, *, at_end: bool) -> tuple[Point, ...]:
    """Let a wire that goes to the middle of a box end at its edge."""
    if at_end:
        return _clipped(way[::-1], box, at_end=False)[::-1]
    for k, (p, q) in enumerate(itertools.pairwise(way)):
        inside = box.cut((p, q))
        if inside is not None and inside[1] < 1.0:
            part = inside[1]
            edge = (p[0] + part * (q[0] - p[0]), p[1] + part * (q[1] - p[1]))
            return (edge, *way[k + 1 :])
    return way


def _parts(
    nodes: Mapping[str, _Node],
    put: Mapping[str, Placed],
    wires: Sequence[Wire],
    cores: Sequence[Box],
) -> list[Group]:
    """Return the marks of what is drawn, names where they cover least."""
    lines = [piece for _, _, way in wires for piece in itertools.pairwise(way)]
    boxes = [*(p.box for p in put.values()), *cores]
    found = []
    for name, p in put.items():
        node = nodes[name]
        words = [node.name, *([node.about] if node.about else [])]
        texts = freest(beside(p.box, words), lines, boxes)
        boxes += [box_of(t) for t in texts]
        about = f"{name}: {node.letters}"
        found.append(Group("part", name, about, (*p.marks, *texts)))
    return found


def _drawing(
    title: str, groups: Sequence[Group], places: dict[str, tuple[float, float]]
) -> Drawing:
    """Return the drawing with all marks moved to where the paper begins."""
    boxes = [box_of(m) for g in groups for m in g.marks]
    head = 30.0 if title else 0.0
    x0, y0 = min(b.x0 for b in boxes) - MARGIN, min(b.y0 for b in boxes) - MARGIN - head
    x1, y1 = max(b.x1 for b in boxes) + MARGIN, max(b.y1 for b in boxes) + MARGIN
    moved = [*shifted(groups, -x0, -y0)]
    wide = max(x1 - x0, width(title, 13.0, bold=True) + 2 * MARGIN)
    if title:
        text = Text("title", title, MARGIN, MARGIN, "start")
        moved.insert(0, Group("title", "", "", (text,)))
    return Drawing(Scene(wide, y1 - y0, tuple(moved), title), places)
