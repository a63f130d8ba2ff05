"""Causality resistance: a resistor that keeps strokes where they are, and what that costs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

from hybond.causality.time_constants import time_constants
from hybond.errors import ModelError
from hybond.model.builder import Model
from hybond.model.constructors import R
from hybond.model.graph import FlatGraph, Mode
from hybond.model.parts import Part, Value
from hybond.names import did_you_mean
from hybond.switching.drawn import DrawnBond, add_all, copied

STIFF = 1e-3
"""Default: the resistor's time constant is this part of the fastest of the model."""
WARN = 1e-2
"""A time constant below this part of the fastest of the model is called stiff."""
MODES = 64
"""Modes that are looked at."""


@dataclass(frozen=True, slots=True)
class StiffMode:
    """One mode: the fastest time constant without and with the resistor, s.

    Infinite if the mode has none; the resistor makes none that is faster if both agree.
    """

    mode: str
    without: float
    fastest: float

    @property
    def ratio(self) -> float:
        """How many times faster the resistor made the mode."""
        return self.without / self.fastest if math.isfinite(self.fastest) else 1.0


@dataclass(frozen=True, slots=True)
class CausalityResistance:
    """What adding a causality resistance did."""

    element: str
    junction: str
    value: float
    """Its resistance, SI."""
    modes: tuple[StiffMode, ...]
    reference: float
    """The fastest time constant of the model without it, over these modes, s."""

    @property
    def fastest(self) -> float:
        """The fastest time constant with it, s."""
        return min((m.fastest for m in self.modes), default=math.inf)

    @property
    def warning(self) -> str:
        """What to beware of, empty if nothing: stiffness as a number, with its mode."""
        if not self.fastest < WARN * self.reference:
            return ""
        worst = min(self.modes, key=lambda m: m.fastest)
        return (
            f"{self.element} = {self.value:.6g} at {self.junction!r} makes a time constant of "
            f"{worst.fastest:.3g} s in mode ({worst.mode}); the fastest of the model itself is "
            f"{self.reference:.3g} s: {self.reference / worst.fastest:.3g} times stiffer"
        )


def add_causality_resistance(
    model: Model,
    junction: str,
    *,
    value: Value | None = None,
    name: str = "",
    modes: Sequence[Mode] | None = None,
) -> tuple[Model, CausalityResistance]:
    """Return a copy with a resistor at a junction, and what it does to the time constants.

    At a 0-junction it is a leak in parallel, weak if its resistance is large; at a 1-junction a
    loss in series, weak if it is small. It decides the common variable when a switch next to the
    junction stops doing so: the stroke of the resistor turns, those of the elements around it stay,
    and no storage depends on another. The price: the model is another one, right to first order in
    the resistance (or conductance), and stiff, because a weak resistor next to a storage is fast.

    Parameters
    ----------
    model : Model
        Not changed.
    junction : str
        A 0- or 1-junction of the model itself.
    value : number, quantity or expression, optional
        Its resistance. By default the one that makes a time constant 1000 times shorter than the
        fastest of the model.
    name : str
        ``<junction>_r`` by default.
    modes : sequence of Mode, optional
        The modes to compare; by default all of the model, or the first 64 of them.

    Returns
    -------
    Model
    CausalityResistance
        Time constants by mode, and a `warning` that says how stiff the model became. They are those
        of the linear model in that mode; a mode with nonlinear or modulated laws is left out.

    Raises
    ------
    ModelError
        HB-M101 no such junction; HB-M196 no value given, and no resistance makes a time constant
        that could be chosen by.

    Notes
    -----
    G. M. Asher, *The robust modelling of variable topology circuits using bond graphs*, ICBGM 1993.
    hybond turns strokes in each mode and does not need it; it is here to compare with models made
    for other tools, and to see what it costs them.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("branches", domain="electrical")
    >>> m.add(V=hb.Se("1 V"), sw=hb.One(), n=hb.Zero(), a=hb.One(), b=hb.One(),
    ...       La=hb.I("1 H"), Ra=hb.R("1 ohm"), Lb=hb.I("2 H"), Rb=hb.R("1 ohm"))
    >>> m.bond("V -> sw -> n -> a -> La", "a -> Ra", "n -> b -> Lb", "b -> Rb")
    >>> m.machine("S", states={"closed": ["sw"], "open": []}, start="closed",
    ...           rules=["closed -> open when time >= 1"])
    >>> other, report = hb.switching.add_causality_resistance(m, "n", value="1 kohm")
    >>> print(report.warning)
    n_r = 1000 at 'n' makes a time constant of 0.000666 s in mode (open); the fastest of the model
    itself is 1 s: 1.5e+03 times stiffer
    """
    part = model.elements.get(junction)
    if not isinstance(part, Part) or part.kind not in ("0", "1"):
        raise ModelError(
            f"{junction!r} is not a junction of this model",
            code="HB-M101",
            where=junction,
            hint=did_you_mean(
                junction,
                [k for k, p in model.elements.items() if isinstance(p, Part) and p.kind in "01"],
            ),
        )
    name = name or f"{junction}_r"
    plain = model.flatten()
    seen = tuple(modes) if modes is not None else first_modes(plain)
    without = {mode: _fastest(plain, mode) for mode in seen}
    reference = min(without.values(), default=math.inf)

    def resisted(resistance: Value) -> tuple[Model, CausalityResistance]:
        new = copied(model)
        options = {"domain": part.options["domain"]} if "domain" in part.options else {}
        add_all(new, {name: R(resistance, **options)}, [DrawnBond("", junction, name)])
        graph = new.flatten()
        law = graph.nodes[graph.by_path[name]].law
        assert law is not None
        rows = tuple(
            StiffMode(graph.mode_text(mode), without[mode], _fastest(graph, mode)) for mode in seen
        )
        number = law.matrix[0][0] if law.matrix is not None else math.nan
        return new, CausalityResistance(name, junction, number, rows, reference)

    if value is not None:
        return resisted(value)
    target = STIFF * reference
    weaker = 10.0 if part.kind == "0" else 0.1
    # a weaker resistor is a faster one; beyond the target, decades are halved down to a factor 1.01
    low, high = 0.0, 0.0
    if math.isfinite(target):
        for decades in range(-12, 13):
            high = weaker**decades
            if resisted(high)[1].fastest <= target:
                break
            low = high
        else:
            high = 0.0
    if not low or not high:
        raise ModelError(
            f"no resistance at {junction!r} makes a time constant {1 / STIFF:g} times shorter than "
            "the model's own",
            code="HB-M196",
            where=junction,
            hint="give value=...",
        )
    while max(low / high, high / low) > 1.01:
        middle = math.sqrt(low * high)
        if resisted(middle)[1].fastest <= target:
            high = middle
        else:
            low = middle
    return resisted(high)


def _fastest(graph: FlatGraph, mode: Mode) -> float:
    return min(time_constants(graph, mode, open_loop=True) or (), default=math.inf)


def first_modes(graph: FlatGraph) -> tuple[Mode, ...]:
    """Return the first `MODES` modes of a graph, in the order of its states."""
    found = []
    for mode in product(*(range(len(m.states)) for m in graph.machines)):
        found.append(mode)
        if len(found) == MODES:
            break
    return tuple(found)
