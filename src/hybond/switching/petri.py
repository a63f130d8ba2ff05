"""A safe Petri net that chooses the mode: compiled into one machine over its markings."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from hybond.errors import ModelError
from hybond.model.builder import Model
from hybond.names import did_you_mean

_TRANSITION = re.compile(
    r"(?P<take>[\w\s+]+)->(?P<give>[\w\s+]*)\swhen\s(?P<guard>.+)\Z", re.DOTALL
)

Marking = frozenset[str]


@dataclass(frozen=True, slots=True)
class Transition:
    """A transition of a net: the places it takes a token from, those it gives one to."""

    take: Marking
    give: Marking
    guard: str
    text: str


def petri_net(
    m: Model,
    name: str,
    *,
    places: Mapping[str, Sequence[str]],
    marked: Sequence[str],
    transitions: Sequence[str],
    limit: int = 1000,
) -> None:
    """Add a machine that runs a safe Petri net whose places switch things ON.

    The markings that can be reached (guards left aside) become the states of one machine, called
    after their places, ``"left__waiting"``. A junction is ON while one of the places that list it
    is marked. All transitions whose guards hold fire together, as machines do; of two that want
    the same token the one listed first gets it.

    Parameters
    ----------
    m : Model
    name : str
        The machine.
    places : mapping
        Each place, and what it switches ON.
    marked : sequence of str
        The places with a token at the start.
    transitions : sequence of str
        ``"idle + waiting -> busy when part.e > 1"``; the right side may be empty.
    limit : int
        Markings, and rules, beyond which the net is refused.

    Raises
    ------
    ModelError
        HB-M193 a text that is not a transition, or a place that does not exist; HB-M194 a marking
        in which a place gets a second token; HB-M195 more than `limit` markings or rules.

    Notes
    -----
    W. Borutzky, *Bond Graph Methodology*, Springer 2010, chapter 7. The net selects one bond graph
    among all those that its markings name, and unlike local machines it enumerates them: n places
    in parallel cost 2^n states. Write independent nets as nets of their own.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("two valves", domain="hydraulic")
    >>> m.add(P=hb.Se("1 Pa"), a=hb.One(), b=hb.One(), n=hb.Zero(), ra=hb.R(1), rb=hb.R(1),
    ...       tank=hb.C(1))
    >>> m.bond("P -> a -> n -> tank", "a -> ra", "n -> b -> rb")
    >>> hb.switching.petri_net(
    ...     m, "plan", places={"fill": ["a"], "full": [], "drain": ["b"]}, marked=["fill"],
    ...     transitions=["fill -> full when tank.e >= 0.5", "full -> drain when time >= 2"])
    >>> run = hb.simulate(m, until=3)
    >>> [run.graph.mode_text(e.steps[-1].mode) for e in run.events]
    ['fill', 'full', 'drain']
    """
    net = [_read(text, places, name) for text in transitions]
    for place in marked:
        _known(place, places, name)
    start = frozenset(marked)
    states: dict[Marking, str] = {start: _called(start, places)}
    rules: list[str] = []
    waiting = [start]
    while waiting:
        marking = waiting.pop(0)
        for fired in _together(marking, net, name, limit):
            after = marking
            for t in fired:
                after = after - t.take
            for t in fired:
                after = after | t.give
            if after not in states:
                states[after] = _called(after, places)
                waiting.append(after)
            guard = (
                " and ".join(f"({t.guard})" for t in fired) if len(fired) > 1 else fired[0].guard
            )
            rules.append(f"{states[marking]} -> {states[after]} when {guard}")
            if len(states) > limit or len(rules) > limit:
                raise _too_large(name, limit)
    m.machine(
        name,
        states={text: _listed(marking, places) for marking, text in states.items()},
        start=states[start],
        rules=rules,
    )


def _read(text: str, places: Mapping[str, Sequence[str]], name: str) -> Transition:
    match = _TRANSITION.match(text) if isinstance(text, str) else None
    if match is None:
        raise ModelError(
            f"{text!r} is not a transition",
            code="HB-M193",
            where=name,
            hint='write "idle + waiting -> busy when part.e > 1"',
        )
    sides = []
    for side in (match["take"], match["give"]):
        found = [p.strip() for p in side.split("+")] if side.strip() else []
        for place in found:
            _known(place, places, name)
        if len(set(found)) < len(found):
            raise ModelError(
                f"{text!r} moves two tokens of one place; the net is safe, it has one",
                code="HB-M193",
                where=name,
                hint="name each place once on a side",
            )
        sides.append(frozenset(found))
    if not sides[0]:
        raise ModelError(
            f"{text!r} takes no token, so nothing would ever stop it",
            code="HB-M193",
            where=name,
            hint="name the place that it empties",
        )
    return Transition(sides[0], sides[1], match["guard"].strip(), text)


def _known(place: str, places: Mapping[str, Sequence[str]], name: str) -> None:
    if place not in places:
        raise ModelError(
            f"the net has no place {place!r}",
            code="HB-M193",
            where=name,
            hint=did_you_mean(place, places),
        )


def _called(marking: Marking, places: Mapping[str, Sequence[str]]) -> str:
    return "__".join(p for p in places if p in marking) or "no_token"


def _listed(marking: Marking, places: Mapping[str, Sequence[str]]) -> list[str]:
    return list(dict.fromkeys(node for p in places if p in marking for node in places[p]))


def _too_large(name: str, limit: int) -> ModelError:
    return ModelError(
        f"the net has more than {limit} markings or rules",
        code="HB-M195",
        where=name,
        hint="split it into nets that do not share places, or raise limit",
    )


def _together(
    marking: Marking, net: Sequence[Transition], name: str, limit: int
) -> list[list[Transition]]:
    """Return the sets of transitions that can fire together, those with earlier ones first.

    In this order the first set whose guards all hold is the one that gives each transition, in
    listed order, its tokens if they are still there.
    """
    found: list[list[Transition]] = []

    def extend(k: int, fired: list[Transition], left: Marking) -> None:
        if k == len(net):
            if fired:
                found.append(fired)
            if len(found) > limit:
                raise _too_large(name, limit)
            return
        t = net[k]
        if t.take <= left:
            extend(k + 1, [*fired, t], left - t.take)
        extend(k + 1, fired, left)

    extend(0, [], marking)
    for fired in found:
        left = marking.difference(*(t.take for t in fired))
        for t in fired:
            if left & t.give:
                place = min(left & t.give)
                raise ModelError(
                    f"{t.text!r} puts a second token on {place!r} "
                    f"in the marking {', '.join(sorted(marking))}",
                    code="HB-M194",
                    where=name,
                    hint="the net must be safe: make the transition take that token as well",
                )
            left = left | t.give
    return found
