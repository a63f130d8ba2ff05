"""Dry friction in two directions: two junctions that share one disk.

Coulomb's friction between two flat faces is one force with two components. It is at most the
limit in size, whatever its direction, and opposes the slip: ``net = limit * f / |f|`` while the
faces slip at the velocity ``f = (fx, fy)``, ``|net| <= breakaway`` while they do not. Two laws of
one direction each would be a box, with a friction that is larger along the diagonals.

The pair is opened into one machine, ``sticks`` and ``slips``, that switches both junctions, a
source per junction, and two numbers that are kept between events:

``heading``
    The direction (rad) in which slip began, which `f` cannot tell while it is zero.
``slow``
    While positive, the speed from which slip comes to its end; while negative, slip begins, and up
    to the speed ``-slow`` it is the heading that counts.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from hybond.errors import ModelError
from hybond.model.graph import FlatGraph
from hybond.model.hierarchy import Opened, Written
from hybond.model.kinds import JUNCTIONS
from hybond.model.laws import TWO_SIDED, JunctionLaw
from hybond.model.parts import Integral, MachinePart
from hybond.names import did_you_mean, join

HEADING, SLOW = "heading", "slow"
"""Names of what is kept between events, below the path of the first junction."""
TINY = 1e-100
"""What every velocity is beside its heading, SI: the law has a value at zero as well."""
_OF_THE_SECOND = ("law", "pair", "domain", "label")
_NOT_OF_A_PAIR = ("impulsive",)


def pairs_of(nodes: Mapping[str, Written]) -> dict[str, str]:
    """Return the first junction of each planar friction and its second, by path.

    Raises
    ------
    ModelError
        HB-M206 for a pair that does not fit together.
    """
    found: dict[str, str] = {}
    for path, written in nodes.items():
        named = written.part.options.get("pair")
        if named is None:
            continue
        first = join(written.scope.prefix, str(named))
        _check(nodes, path, first, found)
        found[first] = path
    return found


def _check(nodes: Mapping[str, Written], path: str, first: str, found: Mapping[str, str]) -> None:
    """Refuse a second junction, or the first that it names."""
    own = nodes[path].part
    why = hint = ""
    if first not in nodes:
        why = f"{path!r} is paired with {first!r}, which is not an element"
        hint = did_you_mean(first, nodes)
    elif own.options.get("law") not in TWO_SIDED or own.kind not in JUNCTIONS:
        why = f"{path!r} has a pair, but no friction"
        hint = 'pair = "..." belongs to law = "coulomb" or "relay"'
    elif first == path or "pair" in nodes[first].part.options:
        why = f"{first!r} is itself the second of a pair"
        hint = "the first junction of a pair has the limit, the second has pair = ..."
    elif first in found:
        why = f"{first!r} is paired with {found[first]!r} already"
        hint = "a disk has two directions"
    else:
        other = nodes[first].part
        kinds = (own.kind, own.options.get("law")), (other.kind, other.options.get("law"))
        wrong = [o for o in own.options if o not in _OF_THE_SECOND]
        shared = [o for o in _NOT_OF_A_PAIR if o in other.options]
        if kinds[0] != kinds[1]:
            why = f"{path!r} and {first!r} are not of one kind"
            hint = "two 1-junctions, or two 0-junctions, with the same law"
        elif wrong:
            why = f"{path!r} gives {wrong[0]!r}, which it shares with {first!r}"
            hint = f"give {wrong[0]} at {first!r} alone"
        elif shared:
            why = f"{first!r} has a pair: its friction cannot be {shared[0]}"
            hint = "friction in two directions carries no impulses; leave it out"
    if why:
        raise ModelError(why, code="HB-M206", where=f"elements.{path}.pair", hint=hint)


def planar_parts(
    first: str, second: str, limit: str, breakaway: str, *, common: str, net: str
) -> tuple[MachinePart, tuple[str, str]]:
    """Return the machine of a pair, and the values of its two sources.

    Parameters
    ----------
    first, second : str
        The junctions, as named in their scope.
    limit, breakaway : str
        Expressions.
    common, net : {"e", "f"}
        Of the junctions.

    Examples
    --------
    >>> machine, _ = planar_parts("sx", "sy", "3", "4", common="f", net="e")
    >>> print(*machine.rules, sep=chr(10))
    sticks -> slips when hypot(sx.e, sy.e) > (4)
    slips -> sticks when hypot(sx.f, sy.f) < sx.slow
    """
    x, y = f"{first}.{common}", f"{second}.{common}"
    slow, heading = f"{first}.{SLOW}", f"{first}.{HEADING}"
    # what has just begun to slip: its heading outweighs the rounding of its velocity
    ahead = f"max(-{slow}, {TINY!r})"
    way = f"({x} + {ahead}*cos({heading}))", f"({y} + {ahead}*sin({heading}))"
    size = f"hypot({way[0]}, {way[1]})"
    values = tuple(
        f'if {first}.state == "slips" then ({limit})*{w}/{size} else 0*({limit})' for w in way
    )
    rules = (
        f"sticks -> slips when hypot({first}.{net}, {second}.{net}) > ({breakaway})",
        f"slips -> sticks when hypot({x}, {y}) < {slow}",
    )
    states = {"sticks": (), "slips": (first, second)}
    return MachinePart(states, "sticks", rules), (values[0], values[1])


def paired(first: JunctionLaw, second: JunctionLaw) -> JunctionLaw:
    """Return the law of the first junction with that of the second, which shares its limits."""
    other = replace(second, limit=first.limit, breakaway=first.breakaway, planar=True)
    return replace(first, second=other, planar=True)


def kept_paths(graph: FlatGraph) -> frozenset[str]:
    """Return the paths of what the engine keeps for its own use, and no other would."""
    return frozenset(
        join(m.path, own)
        for m in graph.machines
        if m.law is not None and m.law.planar
        for own in (HEADING, SLOW)
    )


def keep(opened: Opened, path: str) -> None:
    """Add what the pair of the first junction `path` keeps between events."""
    scope = opened.nodes[path].scope
    for own in (HEADING, SLOW):
        opened.integrals[join(path, own)] = (scope, Integral("0"))
