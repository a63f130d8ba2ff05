"""From written bonds to ports: which port of which node each bond ends at, and its domain."""

from __future__ import annotations

from collections.abc import Mapping

from hybond.errors import ModelError
from hybond.model.domains import no_such_domain
from hybond.model.graph import End
from hybond.model.hierarchy import Scope, Written
from hybond.model.joined import Joined
from hybond.model.kinds import KINDS, TWO_PORTS
from hybond.names import join, port_number
from hybond.records import dataclass
from hybond.units import DOMAINS, Domain


@dataclass(frozen=True, slots=True)
class RawNode:
    """A node before its law is read."""

    path: str
    kind: str
    written: Written | None
    """None for the junction that stands for the switch of a switched element."""
    switched: bool = False

    @property
    def owner(self) -> str:
        """Return the path under which a machine switches it."""
        return self.path if self.written is not None else self.path.removesuffix(".switch")


@dataclass(frozen=True, slots=True)
class RawBond:
    """A bond between node numbers with the port labels as written."""

    tail: int
    head: int
    tail_port: str
    head_port: str
    name: str
    where: str


def ends_of(nodes: list[RawNode], bonds: list[RawBond]) -> list[tuple[End, ...]]:
    """Return each node's ends in port order.

    Raises
    ------
    ModelError
        HB-M130 no bond or too many at an element, HB-M131 a port used twice, missing or unknown,
        HB-M132 a bond from a node to itself.
    """
    touching: list[list[tuple[int, bool, str]]] = [[] for _ in nodes]
    for k, bond in enumerate(bonds):
        if bond.tail == bond.head:
            raise ModelError(
                f"the bond {bond.name!r} joins a node to itself",
                code="HB-M132",
                where=bond.where,
                hint="bond it to another node, or take the bond out",
            )
        touching[bond.tail].append((k, False, bond.tail_port))
        touching[bond.head].append((k, True, bond.head_port))
    return [_ports(node, found, bonds) for node, found in zip(nodes, touching, strict=True)]


def _ports(
    node: RawNode, found: list[tuple[int, bool, str]], bonds: list[RawBond]
) -> tuple[End, ...]:
    about = KINDS[node.kind]
    if node.kind in ("0", "1"):
        for bond, _, port in found:
            if port:
                raise ModelError(
                    f"a junction has no numbered ports: {bonds[bond].name!r}",
                    code="HB-M131",
                    where=bonds[bond].where,
                    hint=f"write {node.path}",
                )
        return tuple(End(b, inward, k) for k, (b, inward, _) in enumerate(found))
    if not found:
        raise ModelError(
            f"{node.kind} {node.path!r} has no bond",
            code="HB-M130",
            where=node.path,
            hint=f'connect it, "{node.path} -> ..."',
        )
    if node.kind in TWO_PORTS:
        return _two_ports(node, found, bonds)
    if len(found) == 1 and found[0][2] in ("", "1"):
        return (End(found[0][0], found[0][1], 0),)
    if about.most == 1 or any(not port for _, _, port in found):
        names = " and ".join(repr(bonds[b].name) for b, _, _ in found)
        raise ModelError(
            f"{node.kind} {node.path!r} has {len(found)} bonds: {names}",
            code="HB-M130",
            where=node.path,
            hint="take one of them out"
            if len({(bonds[b].tail, bonds[b].head) for b, _, _ in found}) == 1
            else "put a junction between"
            + ("" if about.most == 1 else f", or number the ports: {node.path}.1"),
        )
    return _numbered(node, found, bonds, len(found))


def _two_ports(
    node: RawNode, found: list[tuple[int, bool, str]], bonds: list[RawBond]
) -> tuple[End, ...]:
    if len(found) != 2:
        names = " and ".join(repr(bonds[b].name) for b, _, _ in found)
        raise ModelError(
            f"{node.kind} {node.path!r} needs two bonds and has {len(found)}: {names}",
            code="HB-M130",
            where=node.path,
            hint="one on each side",
        )
    if any(port for _, _, port in found):
        return _numbered(node, found, bonds, 2)
    (a, a_in, _), (b, b_in, _) = found
    if a_in == b_in:
        raise ModelError(
            f"both half arrows of {node.kind} {node.path!r} point the same way, so its sides "
            "cannot be told apart",
            code="HB-M131",
            where=node.path,
            hint=f"write {node.path}.1 and {node.path}.2",
        )
    first, second = ((a, a_in), (b, b_in)) if a_in else ((b, b_in), (a, a_in))
    return (End(*first, 0), End(*second, 1))


def _numbered(
    node: RawNode, found: list[tuple[int, bool, str]], bonds: list[RawBond], count: int
) -> tuple[End, ...]:
    taken: dict[int, End] = {}
    for bond, inward, port in found:
        number = port_number(port)
        if not 1 <= number <= count or number - 1 in taken:
            why = "is used twice" if number - 1 in taken else "does not exist"
            raise ModelError(
                f"port {port or '(none)'} of {node.kind} {node.path!r} {why}",
                code="HB-M131",
                where=bonds[bond].where,
                hint=f"number its {count} bonds {node.path}.1 to {node.path}.{count}",
            )
        taken[number - 1] = End(bond, inward, number - 1)
    return tuple(taken[k] for k in range(count))


def domains_of(nodes: list[RawNode], bonds: list[RawBond]) -> list[Domain]:
    """Return the domain of each bond.

    A region of bonds joined by junctions has one domain: the one that a node in it declares, else
    that of the models that contain its nodes. What a model says of one of its nodes there goes
    before its own domain. Two-ports and fields stand between regions: each port has its own.

    Raises
    ------
    ModelError
        HB-M133 unknown domain, HB-M134 two domains in one region.
    """
    regions = Joined(range(len(bonds)))
    touching: list[list[int]] = [[] for _ in nodes]
    for k, bond in enumerate(bonds):
        touching[bond.tail].append(k)
        touching[bond.head].append(k)
    for node, at in zip(nodes, touching, strict=True):
        if at and node.kind in ("0", "1"):
            regions.join(at)

    def declare(table: dict[int, tuple[str, str]], root: int, domain: str, path: str) -> None:
        _domain(domain, path)
        name, other = table.setdefault(root, (domain, path))
        if name == domain:
            return
        text = f"{path!r} is {domain} and {other!r} is {name}, but bonds and junctions join them"
        inside = [n for n, at in zip(nodes, touching) if any(regions.root(k) == root for k in at)]
        where = _odd_one(inside) or path
        for k, bond in enumerate(bonds):
            mixed = _mixed(bond, nodes) if regions.root(k) == root else ""
            if mixed:
                text, where = f"the bond {bond.name!r} joins {mixed}", bond.where
                break
        raise ModelError(
            text,
            code="HB-M134",
            where=where,
            hint="put a TF or GY between the domains, or a part that has one, such as a motor",
        )

    said: dict[int, tuple[str, str]] = {}
    default: dict[int, tuple[str, str]] = {}
    # regions, each with the models that say of one of their own nodes there what they are
    spoken: dict[int, list[str]] = {}
    silent: list[tuple[int, Scope, str]] = []
    for node, at in zip(nodes, touching, strict=True):
        if node.written is None or not at or node.kind in TWO_PORTS:
            continue
        own = node.written.part.options.get("domain")
        if own is None:
            _domain(node.written.scope.model.domain, node.written.scope.prefix)
        for root in dict.fromkeys(regions.root(k) for k in at):
            if own is not None:
                declare(said, root, str(own), node.path)
                spoken.setdefault(root, []).append(node.written.scope.prefix)
            else:
                silent.append((root, node.written.scope, node.path))
    for root, scope, path in silent:
        if any(speaker.startswith(scope.prefix) for speaker in spoken.get(root, ())):
            continue  # its own model, or one within it, knows better than by its domain
        if root in said and scope.model.domain != "generic":
            declare(said, root, scope.model.domain, path)
        elif default.get(root, ("generic", ""))[0] == "generic":
            # a model without a domain takes that of the parts that it joins
            default[root] = (scope.model.domain, path)
        elif scope.model.domain not in (default[root][0], "generic"):
            declare(default, root, scope.model.domain, path)
    chosen: Mapping[int, tuple[str, str]] = {**default, **said}
    return [
        _domain(*chosen.get(regions.root(k), ("generic", bonds[k].name))) for k in range(len(bonds))
    ]


def _odd_one(region: list[RawNode]) -> str:
    """Return where the domain is declared that the fewest elements of a region have."""
    declared: dict[str, list[str]] = {}
    for node in region:
        own = node.written.part.options.get("domain") if node.written is not None else None
        if own is not None and node.kind not in TWO_PORTS:
            declared.setdefault(str(own), []).append(node.path)
    if not declared:
        return ""
    own = [n.written.scope.model.domain for n in region if n.written is not None]
    # what is not the domain of the model is less likely to be meant
    least = declared[min(declared, key=lambda d: (own.count(d) > 0, len(declared[d])))]
    return f"elements.{least[-1]}.domain"


def _mixed(bond: RawBond, nodes: list[RawNode]) -> str:
    """Return what a bond joins if its ends, of two models, are of two domains."""
    ends = [nodes[k] for k in (bond.tail, bond.head)]
    written = [(n.path, n.written) for n in ends if n.written is not None]
    if len({w.scope.prefix for _, w in written}) < 2:
        return ""
    said = [(path, w.part.options.get("domain", w.scope.model.domain)) for path, w in written]
    if len({domain for _, domain in said} - {"generic"}) < 2:
        return ""
    return " to ".join(f"{path!r} ({domain})" for path, domain in said)


def _domain(name: str, path: str) -> Domain:
    if name not in DOMAINS:
        raise no_such_domain(name, join(path, "domain"))
    return DOMAINS[name]
