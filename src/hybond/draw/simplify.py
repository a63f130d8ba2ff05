"""A sketch without what carries no power and decides nothing: how a bond graph is drawn by hand.

A model that is put together from parts has a junction for each pin, an element for each loss that
is zero, and a ground. By the rules of the textbooks (D. C. Karnopp, D. L. Margolis, R. C.
Rosenberg, *System Dynamics*, 5th ed., section 4.1) the picture is the same system without them:

- an element that says zero (no volt at a 1-junction, no ampere at a 0-junction) adds nothing;
- bonds of a node that is at ground carry no power;
- two junctions of one kind that meet are one junction;
- a junction between two bonds, one that comes and one that goes, is a bond.

What switches, has a law or a badge stays.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

from hybond.draw.parts import in_frames
from hybond.draw.sketch import Arrow, Sketch, Symbol
from hybond.model.graph import FlatGraph


def made_of_parts(graph: FlatGraph) -> bool:
    """Return whether a model is put together from parts, which have pins, grounds and losses.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("lone", domain="electrical")
    >>> m.add(c=hb.C("1 mF"), r=hb.R("1 ohm"), node=hb.Zero())
    >>> m.bond("node -> c", "node -> r")
    >>> made_of_parts(m.flatten())
    False
    """
    return any("." in n.path for n in graph.nodes if not n.hidden and not n.implied)


def shown_of(
    sketches: Sequence[Sketch],
    graph: FlatGraph,
    simplify: bool | None,
    opened: Collection[str] | None = None,
) -> list[Sketch]:
    """Return sketches of one graph as they are drawn: None simplifies what is made of parts.

    With `opened` parts are frames, see `hybond.draw.parts.in_frames`.
    """
    zeros = zeros_of(graph)
    simpler = simplify or (simplify is None and made_of_parts(graph))
    if opened is not None:
        sketches = [in_frames(s, opened) for s in sketches]
    return [simplified(s, zeros) if simpler else s for s in sketches]


def zeros_of(graph: FlatGraph) -> dict[str, str]:
    """Return the elements that say that their effort, or their flow, is zero: path to ``e``, ``f``.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("short")
    >>> m.add(ground=hb.Se(0), i=hb.One(), r=hb.R(2))
    >>> m.bond("ground -> i -> r")
    >>> zeros_of(m.flatten())
    {'ground': 'e'}
    """
    return {
        n.path: n.law.output
        for n in graph.nodes
        if n.law is not None and n.law.matrix == ((0.0,),) and not n.controlled and len(n.ends) == 1
        if n.kind in ("Se", "Sf", "R", "G")
    }


def simplified(sketch: Sketch, zeros: dict[str, str]) -> Sketch:
    """Return a sketch without junctions between two bonds, grounds, and elements that say zero.

    Parameters
    ----------
    zeros : dict
        See `zeros_of`.
    """
    symbols, arrows = list(sketch.symbols), list(sketch.arrows)
    gone: set[int] = set()
    while True:
        fewer = _without_zero(symbols, arrows, zeros, gone)
        fewer = _without_twin(symbols, arrows, gone) if fewer is None else fewer
        fewer = _without_passage(symbols, arrows, gone) if fewer is None else fewer
        if fewer is None:
            break
        arrows = fewer
    # what is left without any bond was joined to the ground alone
    used = {end for a in arrows for end in (a.tail, a.head)}
    gone |= {k for k, s in enumerate(symbols) if k not in used and s.is_junction}
    kept = [k for k in range(len(symbols)) if k not in gone]
    place = {k: i for i, k in enumerate(kept)}
    return replace(
        sketch,
        symbols=tuple(symbols[k] for k in kept),
        arrows=tuple(replace(a, tail=place[a.tail], head=place[a.head]) for a in arrows),
        pins={place[k]: at for k, at in sketch.pins.items() if k in place},
        left_out=len(symbols) - len(kept),
        frames=tuple(
            replace(f, members=tuple(place[k] for k in f.members if k in place))
            for f in sketch.frames
        ),
    )


def _plain(s: Symbol) -> bool:
    """Whether it is a junction that nobody would miss."""
    return s.is_junction and not (s.controlled or s.law or s.badge or s.machine)


def _at(arrows: Sequence[Arrow], k: int) -> list[Arrow]:
    return [a for a in arrows if k in (a.tail, a.head)]


def _other(a: Arrow, k: int) -> int:
    return a.head if a.tail == k else a.tail


def _less(arrows: Sequence[Arrow], gone: Collection[Arrow]) -> list[Arrow]:
    """Return the arrows but those, which are told by identity: two may be alike."""
    out = {id(a) for a in gone}
    return [a for a in arrows if id(a) not in out]


def _without_zero(
    symbols: list[Symbol], arrows: list[Arrow], zeros: dict[str, str], gone: set[int]
) -> list[Arrow] | None:
    """Take out an element that says zero, or a node that it holds at zero; None if there is none.

    A zero of the variable that is common to a junction takes all its bonds with it, if these lead
    to junctions only; a zero of the other variable is one term of a sum.
    """
    for k, s in enumerate(symbols):
        if k in gone or s.path not in zeros or s.badge:
            continue
        (bond,) = _at(arrows, k)
        j = _other(bond, k)
        near = symbols[j]
        if not near.is_junction:
            continue
        common = (near.kind == "0") == (zeros[s.path] == "e")
        if not common:
            gone.add(k)
            return _less(arrows, [bond])
        around = _at(arrows, j)
        others = [_other(a, j) for a in around if a is not bond]
        if _plain(near) and all(symbols[o].is_junction for o in others):
            held = [o for o in others if symbols[o].kind == near.kind and _plain(symbols[o])]
            if held:
                continue  # first these become one
            gone |= {k, j}
            return _less(arrows, around)
    return None


def _without_twin(symbols: list[Symbol], arrows: list[Arrow], gone: set[int]) -> list[Arrow] | None:
    """Make one junction of two of a kind that meet; None if none do."""
    for bond in arrows:
        one, two = bond.tail, bond.head
        same = symbols[one].kind == symbols[two].kind
        if not same or not symbols[one].is_junction:
            continue
        # the one that keeps its name: what is switched, else what has more bonds
        if not _plain(symbols[two]) or (
            _plain(symbols[one]) and len(_at(arrows, two)) > len(_at(arrows, one))
        ):
            one, two = two, one
        if not _plain(symbols[two]) or (len(_at(arrows, two)) > 2 and not _plain(symbols[one])):
            continue
        moved = [
            replace(a, tail=one if a.tail == two else a.tail, head=one if a.head == two else a.head)
            if two in (a.tail, a.head)
            else a
            for a in _less(arrows, [bond])
        ]
        if any(a.tail == a.head for a in moved):
            continue
        gone.add(two)
        return moved
    return None


def _without_passage(
    symbols: list[Symbol], arrows: list[Arrow], gone: set[int]
) -> list[Arrow] | None:
    """Make a bond of a junction between one that comes and one that goes; None if there is none."""
    for k, s in enumerate(symbols):
        if k in gone or not _plain(s):
            continue
        near = _at(arrows, k)
        if len(near) != 2:
            continue
        comes, goes = sorted(near, key=lambda a: a.tail == k)
        if comes.head != k or goes.tail != k or comes.tail == goes.head:
            continue
        ends = {comes.tail, goes.head}
        if any({a.tail, a.head} == ends for a in arrows):
            continue
        if not any(symbols[e].is_junction for e in ends):
            continue
        gone.add(k)
        return [*_less(arrows, near), _joined(comes, goes)]
    return None


def _joined(comes: Arrow, goes: Arrow) -> Arrow:
    """Return one bond for two in a row, whose strokes are at the same ends."""
    strokes = comes.strokes or goes.strokes
    return replace(
        comes,
        head=goes.head,
        strokes=strokes,
        dashed=tuple(e for e in (0, 1) if e in (*comes.dashed, *goes.dashed) and e not in strokes),
        name=f"{comes.name}, {goes.name}",
        number=", ".join(n for n in (comes.number, goes.number) if n),
        late=tuple(sorted({*comes.late, *goes.late})),
        integral=comes.integral or goes.integral,
        conflict=comes.conflict or goes.conflict,
        off=comes.off or goes.off,
        region=comes.region or goes.region,
        emphasis=comes.emphasis or goes.emphasis,
    )
