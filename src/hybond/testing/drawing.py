"""A random hybrid bond graph from a seed."""

from __future__ import annotations

import random
from dataclasses import replace

from hybond.causality.assign import assign
from hybond.testing.controlled import with_controls
from hybond.testing.curves import RESISTIVE, STORED, Curve
from hybond.testing.recipe import Bond, Part, Recipe, Switch

RESISTED = 0.75
"""Part of the graphs that begin with a conflict whose sources get a resistance."""


def random_recipe(seed: int, *, size: int = 6, controlled: bool = False) -> Recipe:
    """Return a random hybrid bond graph; a seed always gives the same.

    Junctions stand in one or two trees with rings, double bonds and two-ports; elements of all
    kinds hang on them, linear or not, over up to six powers of ten. Nothing keeps storages
    independent or sources apart: dependent storage, parts that float and causal conflicts are
    wanted. Most graphs would not run for those conflicts alone: of three in four that begin with
    one, the sources get a resistance of their own, as real ones have.

    Parameters
    ----------
    seed : int
        Which one.
    size : int
        Junctions at most.
    controlled : bool
        Whether it gets clocks, gates, gaps, guards on efforts and flows, and fast parts too
        (:func:`~hybond.testing.controlled.with_controls`).

    Examples
    --------
    >>> random_recipe(7) == random_recipe(7)
    True
    """
    drawn = _Drawing(seed, size).recipe()
    if begins_in_conflict(drawn) and random.Random(f"inner {seed}").random() < RESISTED:
        drawn = with_resistances(drawn)
    return with_controls(drawn, seed) if controlled else drawn


def begins_in_conflict(recipe: Recipe) -> bool:
    """Return whether a source decides what something else decides too, in the mode at the start."""
    if not any(p.kind in ("Se", "Sf") for p in recipe.parts):
        return False
    graph = recipe.model().flatten()
    return bool(assign(graph, graph.start_mode).conflicts)


def with_resistances(recipe: Recipe) -> Recipe:
    """Return a recipe whose sources of effort have a resistor in series, those of flow one beside.

    Examples
    --------
    >>> bare = Recipe((Part("s", "Se", "1.0"), Part("j", "0")), (Bond("s", "j"),))
    >>> [f"{b.tail} -> {b.head}" for b in with_resistances(bare).bonds]
    ['s -> s_at', 's_at -> j', 's_at -> s_r']
    """
    sources = {p.name: "1" if p.kind == "Se" else "0" for p in recipe.parts if p.kind[0] == "S"}
    bonds: list[Bond] = []
    for b in recipe.bonds:
        name = b.tail if b.tail in sources else b.head
        if name not in sources:
            bonds.append(b)
            continue
        at = f"{name}_at"
        bonds += [replace(b, head=at, head_port=""), replace(b, tail=at, tail_port="")]
        bonds.append(Bond(at, f"{name}_r"))
    added = [Part(f"{name}_at", kind) for name, kind in sources.items()]
    added += [Part(f"{name}_r", "R", Curve("linear", 1.0, 1.0)) for name in sources]
    return replace(recipe, parts=(*recipe.parts, *added), bonds=tuple(bonds))


class _Drawing:
    """What has been drawn so far."""

    def __init__(self, seed: int, size: int) -> None:
        self.draw = random.Random(seed)
        self.spread = self.draw.choice((0.3, 0.3, 1.0, 3.0))
        self.bent = self.draw.choice((0.0, 0.0, 0.3, 0.7))
        self.hybrid = self.draw.choice((0.0, 0.3, 0.6))
        self.size = self.draw.randint(1, size)
        self.parts: list[Part] = []
        self.bonds: list[Bond] = []
        self.stored: dict[str, float] = {}

    def recipe(self) -> Recipe:
        """Return what is drawn."""
        kinds = {f"j{k}": self.draw.choice("01") for k in range(self.size)}
        names = list(kinds)
        free = self._junctions(kinds)
        islands = 2 if self.size > 3 and self.draw.random() < 0.15 else 1
        for k in range(1, self.size):
            if k == self.size - 1 and islands == 2:
                continue
            self._join(f"t{k}", self.draw.choice(names[:k]), names[k])
        for k in range(self.draw.randint(0, self.size // 2)):
            a, b = self.draw.choice(names), self.draw.choice(names)
            if a != b:
                self._join(f"u{k}", a, b)
        for k in range(self.draw.randint(2, self.size + 3)):
            self._element(k, names)
        for k in range(self.draw.choice((0, 1, 1, 2))):
            self._source(k, names)
        switches = self._switches(free)
        integrals: tuple[tuple[str, str, float], ...] = ()
        if self.stored and self.draw.random() < 0.3:
            name = self.draw.choice(list(self.stored))
            integrals = (("w0", "{" + name + "}", 0.0),)
        bonds = tuple(self.draw.sample(self.bonds, len(self.bonds)))
        used = {end for b in bonds for end in (b.tail, b.head)}
        parts = tuple(p for p in self.parts if p.name in used or p.name in free)
        until = 10.0 ** self.draw.uniform(-min(self.spread, 2.0), 0.3)
        return Recipe(parts, bonds, switches, integrals, float(f"{until:.3g}"))

    def _number(self, around: float = 1.0) -> float:
        return float(f"{around * 10.0 ** self.draw.uniform(-self.spread, self.spread):.3g}")

    def _junctions(self, kinds: dict[str, str]) -> list[str]:
        """Add the junctions; return those that are left to machines."""
        free = []
        for name, kind in kinds.items():
            options: tuple[tuple[str, object], ...] = ()
            if self.draw.random() < 0.6 * self.hybrid:
                law = self.draw.choice(("diode", "unilateral", "coulomb", "relay", "", ""))
                if not law:
                    free.append(name)
                elif law == "diode":
                    options = (("law", law),)
                elif law == "unilateral":
                    restitution = self.draw.choice((None, 0.0, 0.5))
                    options = (("law", law),)
                    if restitution is not None:
                        options = (*options, ("restitution", restitution))
                else:
                    limit = self._number()
                    options = (("law", law), ("limit", limit))
                    if law == "coulomb" and self.draw.random() < 0.3:
                        options = (*options, ("breakaway", 1.5 * limit))
            self.parts.append(Part(name, kind, options))
        return free

    def _bond(self, a: str, b: str, a_port: str = "", b_port: str = "") -> None:
        if self.draw.random() < 0.5:
            self.bonds.append(Bond(a, b, a_port, b_port))
        else:
            self.bonds.append(Bond(b, a, b_port, a_port))

    def _join(self, name: str, a: str, b: str) -> None:
        if self.draw.random() < 0.7:
            self._bond(a, b)
            return
        modulus = repr(self.draw.choice((1, -1)) * self._number())
        if self.stored and self.draw.random() < self.bent:
            what, measure = self.draw.choice(list(self.stored.items()))
            modulus += f"*(1 + 0.3*sin({{{what}}}/{measure!r}))"
        self.parts.append(Part(name, self.draw.choice(("TF", "GY")), modulus))
        self._bond(a, name, "", "1")
        self._bond(name, b, "2", "")

    def _element(self, k: int, junctions: list[str]) -> None:
        kind = self.draw.choice("CCIIRRG")
        name = f"{kind.lower()}{k}"
        where = self.draw.choice(junctions)
        start: tuple[float, ...] = ()
        if kind != "G" and self.draw.random() < 0.08:
            a, c = self._number(), self._number()
            b = float(f"{self.draw.uniform(-0.8, 0.8) * (a * c) ** 0.5:.3g}")
            if kind != "R":
                start = (self.draw.uniform(-a, a), self.draw.uniform(-c, c))
            part = Part(name, kind, ((a, b), (b, c)), start)
            self._bond(where, name, "", "1")
            self._bond(self.draw.choice(junctions), name, "", "2")
        else:
            curves = STORED if kind in "CI" else RESISTIVE
            form = self.draw.choice(curves) if self.draw.random() < self.bent else "linear"
            curve = Curve(form, self._number(), self._number())
            if kind in "CI":
                way = self.draw.choice((0.0, 1.0, 1.0)) * self.draw.uniform(-1.0, 1.0)
                start = (float(f"{way * curve.width:.3g}"),)
            part = Part(name, kind, curve, start)
            self._bond(where, name)
        self.parts.append(part)
        for stored, x in zip(part.stored, start, strict=True):
            self.stored[stored] = abs(x) or 1.0

    def _source(self, k: int, junctions: list[str]) -> None:
        kind = self.draw.choice(("Se", "Sf"))
        size = self.draw.choice((1, -1)) * self._number()
        text = repr(size)
        match self.draw.choice(("constant", "sine", "step", "fed back")):
            case "sine":
                text += f"*sin({self._number(3.0)!r}*time)"
            case "step":
                text += f"*(if time >= {self.draw.uniform(0.05, 0.9):.3g} then 1 else 0.2)"
            case "fed back" if self.stored:
                what, measure = self.draw.choice(list(self.stored.items()))
                text += f"*(1 - 0.5*tanh({{{what}}}/{measure!r}))"
        self.parts.append(Part(f"s{k}", kind, text))
        self._bond(f"s{k}", self.draw.choice(junctions))

    def _switches(self, free: list[str]) -> tuple[Switch, ...]:
        found = []
        for k, name in enumerate(free):
            closes, opens = "time >= 0.2 and time < 0.7", "time < 0.2 or time >= 0.7"
            if self.stored and self.draw.random() < 0.6:
                what, measure = self.draw.choice(list(self.stored.items()))
                low, high = sorted(self.draw.uniform(-1.0, 1.0) * measure for _ in range(2))
                closes, opens = f"{{{what}}} > {high:.4g}", f"{{{what}}} < {low:.4g}"
            start = self.draw.choice(("on", "off"))
            found.append(Switch(f"m{k}", (name,), (), start, closes, opens))
        return tuple(found)
