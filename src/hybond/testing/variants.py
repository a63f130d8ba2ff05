"""The same graph said in another way: other names, another order, bonds turned round.

And, to know what a difference is worth, the same graph with its numbers moved a little.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import dataclass, replace

from hybond.testing.curves import Curve
from hybond.testing.recipe import Bond, Part, Recipe, written


@dataclass(frozen=True)
class Variant:
    """A recipe that means the same as another.

    Parameters
    ----------
    recipe : Recipe
        What it says.
    same : dict
        Name of what is stored in the other: its name and its sign in this one.
    """

    recipe: Recipe
    same: dict[str, tuple[str, float]]


def renamed(recipe: Recipe) -> Variant:
    """Return the recipe with names whose order is the reverse of that before."""
    names = sorted(
        [p.name for p in recipe.parts]
        + [s.name for s in recipe.switches]
        + [name for name, _, _ in recipe.integrals]
        + [c.name for c in recipe.clocked]
    )
    new = {name: f"n{len(names) - k:03d}" for k, name in enumerate(names)}

    def word(path: str) -> str:
        first, dot, rest = path.partition(".")
        return new[first] + dot + rest

    def again(text: str) -> str:
        return written(text, lambda path: "{" + word(path) + "}")

    other = _texts(recipe, again)
    other = replace(
        other,
        parts=tuple(replace(p, name=new[p.name]) for p in other.parts),
        bonds=tuple(replace(b, tail=new[b.tail], head=new[b.head]) for b in other.bonds),
        switches=tuple(
            replace(
                s,
                name=new[s.name],
                junctions=tuple(new[j] for j in s.junctions),
                others=tuple(new[j] for j in s.others),
            )
            for s in other.switches
        ),
        integrals=tuple((new[name], text, start) for name, text, start in other.integrals),
        clocked=tuple(replace(c, name=new[c.name]) for c in other.clocked),
    )
    return Variant(other, {name: (word(name), 1.0) for name in recipe.stored})


def reordered(recipe: Recipe, seed: int) -> Variant:
    """Return the recipe with everything declared in another order."""
    draw = random.Random(seed)
    other = replace(
        recipe,
        parts=tuple(draw.sample(recipe.parts, len(recipe.parts))),
        bonds=tuple(draw.sample(recipe.bonds, len(recipe.bonds))),
        switches=tuple(draw.sample(recipe.switches, len(recipe.switches))),
        integrals=tuple(draw.sample(recipe.integrals, len(recipe.integrals))),
        clocked=tuple(draw.sample(recipe.clocked, len(recipe.clocked))),
    )
    return Variant(other, {name: (name, 1.0) for name in recipe.stored})


def turned(recipe: Recipe, seed: int) -> Variant:
    """Return the recipe with half of its bonds turned round, and the signs that go with it.

    At a 0-junction a bond that is turned has the other flow, and the port at it sees no difference;
    at a 1-junction it has the other effort, and the port sees the other effort and the other flow.
    Between two junctions of one kind nothing else changes. Between a 0 and a 1 a bond is not turned
    alone, nor are those of fields.
    """
    draw = random.Random(seed)
    parts = {p.name: p for p in recipe.parts}
    bonds = []
    signs: dict[str, float] = {}
    for bond in recipe.bonds:
        ends = parts[bond.tail], parts[bond.head]
        inner = [p for p in ends if p.kind in ("0", "1")]
        outer = [p for p in ends if p.kind not in ("0", "1")]
        if draw.random() < 0.5 or any(p.is_field for p in outer):
            bonds.append(bond)
        elif not outer and inner[0].kind == inner[1].kind:
            bonds.append(_reverse(bond))
        elif len(outer) == 1 and len(inner) == 1:
            bonds.append(_reverse(bond))
            (part,), (junction,) = outer, inner
            if part.kind == ("Sf" if junction.kind == "0" else "Se"):
                parts[part.name] = _negative(part)
            elif junction.kind == "1" and part.kind != "Sf":
                parts[part.name] = _negative(part)
                signs.update(dict.fromkeys(part.stored, -1.0))
            # what one reads of an element is its bond's
            signs[f"{part.name}.{'f' if junction.kind == '0' else 'e'}"] = -1.0
        else:
            bonds.append(bond)

    def again(text: str) -> str:
        return written(
            text, lambda name: "(-{" + name + "})" if name in signs else "{" + name + "}"
        )

    other = replace(recipe, parts=tuple(parts[p.name] for p in recipe.parts), bonds=tuple(bonds))
    return Variant(
        _texts(other, again), {name: (name, signs.get(name, 1.0)) for name in recipe.stored}
    )


def nudged(recipe: Recipe, seed: int, most: float) -> Recipe:
    """Return the recipe with what is stored at the start, and what laws give, moved a little.

    Each number by a part of itself, `most` at most.
    """
    draw = random.Random(seed)

    def moved(x: float) -> float:
        return x * (1.0 + most * draw.uniform(-1.0, 1.0))

    parts = []
    for p in recipe.parts:
        value = p.value
        if isinstance(value, Curve):
            value = replace(value, height=moved(value.height))
        elif isinstance(value, str):
            value = f"{moved(1.0)!r}*({value})"
        parts.append(replace(p, value=value, start=tuple(moved(x) for x in p.start)))
    return replace(recipe, parts=tuple(parts))


def _reverse(bond: Bond) -> Bond:
    return Bond(bond.head, bond.tail, bond.head_port, bond.tail_port)


def _negative(part: Part) -> Part:
    value = part.value
    if isinstance(value, Curve):
        return replace(part, value=value.turned(), start=tuple(-x for x in part.start))
    return replace(part, value=f"-({value})")


def _texts(recipe: Recipe, again: Callable[[str], str]) -> Recipe:
    """Return the recipe with all texts written again."""
    return replace(
        recipe,
        parts=tuple(_part(p, again) for p in recipe.parts),
        switches=tuple(
            replace(s, closes=again(s.closes), opens=again(s.opens)) for s in recipe.switches
        ),
        integrals=tuple((name, again(text), start) for name, text, start in recipe.integrals),
        clocked=tuple(replace(c, text=again(c.text)) for c in recipe.clocked),
    )


def _part(p: Part, again: Callable[[str], str]) -> Part:
    """Return a part with its text, or those of its law's options, written again."""
    if isinstance(p.value, str):
        return replace(p, value=again(p.value))
    if p.kind in ("0", "1") and isinstance(p.value, tuple):
        pairs = ((key, again(x) if isinstance(x, str) else x) for key, x in p.value)
        return replace(p, value=tuple(pairs))
    return p
