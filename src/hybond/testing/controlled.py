"""What controllers, clocks and gauges add to a random hybrid bond graph."""

from __future__ import annotations

import random
from dataclasses import replace

from hybond.testing.curves import Curve
from hybond.testing.recipe import Clocked, Part, Recipe, Switch

FAST = (1e-3, 1e-6, 1e-9)
"""By how much a storage is made smaller, so that it follows what drives it at once."""


def with_controls(recipe: Recipe, seed: int) -> Recipe:
    """Return a recipe with clocks, gates, gaps, guards on what is not stored, and fast parts.

    Each of them now and then: sources follow samples and pulses, diodes become thyristors, contacts
    get a gap that their own motion closes, friction a limit that something else moves, machines
    look at efforts and flows, a storage becomes so small that it is all but gone.

    Parameters
    ----------
    recipe : Recipe
        What it is added to.
    seed : int
        Which additions.
    """
    draw = random.Random(f"controls {seed}")
    recipe = _fast(recipe, draw)
    recipe = _clocks(recipe, draw)
    parts, integrals = [], list(recipe.integrals)
    for p in recipe.parts:
        other = _law(p, recipe, draw)
        if _options(other).get("gap"):
            # what closes the contact is the net of its bonds
            net = "f" if p.kind == "0" else "e"
            integrals.append((f"gap_{p.name}", f"-{{{p.name}.{net}}}", draw.uniform(0.0, 0.3)))
        parts.append(other)
    recipe = replace(recipe, parts=tuple(parts), integrals=tuple(integrals))
    return replace(recipe, switches=tuple(_guards(s, recipe, draw) for s in recipe.switches))


def _options(p: Part) -> dict[str, object]:
    return dict(p.value) if p.kind in ("0", "1") and isinstance(p.value, tuple) else {}


def _fast(recipe: Recipe, draw: random.Random) -> Recipe:
    """Make a storage so small that it follows what drives it."""
    linear = [p for p in recipe.parts if p.kind in "CI" and isinstance(p.value, Curve)]
    if not linear or draw.random() < 0.5:
        return recipe
    chosen = draw.choice(linear)
    by = draw.choice(FAST)
    assert isinstance(chosen.value, Curve)
    small = replace(
        chosen,
        value=replace(chosen.value, width=chosen.value.width * by),
        start=tuple(x * by for x in chosen.start),
    )
    return replace(recipe, parts=tuple(small if p is chosen else p for p in recipe.parts))


def _clocks(recipe: Recipe, draw: random.Random) -> Recipe:
    """Let sources follow a sample of what is stored, or a pulse."""
    clocked: list[Clocked] = []
    parts = []
    for p in recipe.parts:
        if p.kind in ("Se", "Sf") and isinstance(p.value, str) and draw.random() < 0.5:
            name = f"clock{len(clocked)}"
            every = recipe.until * draw.uniform(0.02, 0.3)
            if recipe.stored and draw.random() < 0.5:
                clocked.append(Clocked(name, "{" + draw.choice(recipe.stored) + "}", every))
                part = replace(p, value=f"({p.value})*(1 - tanh({{{name}}}))")
            else:
                duty = repr(round(draw.uniform(0.2, 0.8), 3))
                clocked.append(Clocked(name, duty, every, is_pulse=True))
                part = replace(p, value=f"({p.value})*{{{name}}}")
            parts.append(part)
        else:
            parts.append(p)
    return replace(recipe, parts=tuple(parts), clocked=tuple(clocked))


def _law(p: Part, recipe: Recipe, draw: random.Random) -> Part:
    """Give a law what its kind can have besides: a gate, a gap, a limit that something moves."""
    options = _options(p)
    law = options.get("law")
    if law is None or draw.random() < 0.5:
        return p
    seen = draw.choice(recipe.stored) if recipe.stored else ""
    if law == "diode" and p.kind == "1":
        gates = [f"sin({draw.uniform(2.0, 30.0) / recipe.until!r}*time) > 0.2", "time >= 0.1"]
        gates += [f"{{{c.name}}} > 0.5" for c in recipe.clocked]
        options |= {"law": "thyristor", "gate": draw.choice(gates)}
    elif law == "unilateral":
        options["gap"] = f"{{gap_{p.name}}}"
    elif law == "coulomb" and seen and "breakaway" not in options:
        options["limit"] = f"{options['limit']!r}*(1 + 0.5*sin({{{seen}}}))"
    return replace(p, value=tuple(options.items()))


def _guards(s: Switch, recipe: Recipe, draw: random.Random) -> Switch:
    """Let a machine look at an effort or a flow, or at a pulse, instead of what is stored."""
    seen = [p for p in recipe.parts if p.kind in "CIRG" and not p.is_field]
    pulses = [c for c in recipe.clocked if c.is_pulse]
    if pulses and draw.random() < 0.4:
        name = draw.choice(pulses).name
        return replace(s, closes=f"{{{name}}} > 0.5", opens=f"{{{name}}} < 0.5")
    if not seen or draw.random() < 0.5:
        return s
    part = draw.choice(seen)
    letter = draw.choice("ef")
    size = 1.0
    if isinstance(part.value, Curve):
        size = part.value.height if letter == "e" else part.value.width
    low, high = sorted(draw.uniform(-1.0, 1.0) * size for _ in range(2))
    name = f"{{{part.name}.{letter}}}"
    return replace(s, closes=f"{name} > {high:.4g}", opens=f"{name} < {low:.4g}")
