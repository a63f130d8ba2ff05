"""Coupled coils: a field of inductances, or windings of one ideal transformer."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from hybond.circuits.notices import Line
from hybond.circuits.opened import Branch, Coupling, Opened, Value
from hybond.circuits.texts import Texts
from hybond.names import did_you_mean

SINGULAR = 1e-12
"""Smallest eigenvalue of the couplings, 1 being none, of coils that are not tied rigidly."""


@dataclass(frozen=True, slots=True)
class Magnetics:
    """Coils on one core."""

    name: str
    """Of the first coupling."""
    line: Line
    coils: tuple[str, ...]
    """Keys, in the order of the netlist."""
    matrix: tuple[tuple[str | float, ...], ...] | None
    """Inductances as the model says them; None if all couplings are 1: then the core has the
    inductance of the first coil, and the others are transformers on it."""
    inductance: str | float | None
    """None of an ideal transformer, which stores nothing."""
    ratios: tuple[tuple[str | float, str | float], ...]
    """Of each coil, the turns ratio to the first one and its inverse."""
    turns: tuple[float, ...]
    numbers: tuple[tuple[float, ...], ...]
    """The matrix of inductances with the values of the parameters, H."""
    tied: tuple[tuple[str, ...], ...] = ()
    """Of each coil, all that are coupled to it by 1, windings on its leg; empty: only itself."""
    leg: Winding | None = None
    """Of coils that are coupled by 1 beside others that are less: the coil of the field that they
    are windings of."""


@dataclass(frozen=True, slots=True)
class Winding:
    """One coil: on which core, and as which of its coils."""

    core: Magnetics
    index: int


Pairs = dict[tuple[str, str], Coupling]


def couple(opened: Opened, texts: Texts) -> dict[str, Winding]:
    """Return the coils that are coupled, by key.

    Raises
    ------
    FileError
        HB-F133 (a pair coupled twice), HB-F134 (no such coil), HB-F140 (a coupling above 1),
        HB-F141 (couplings that store negative energy, or none with some currents).
    """
    if not opened.couplings:
        return {}
    coils = {b.key: b for b in opened.branches if b.kind == "l"}
    pairs = _pairs(opened.couplings, coils)
    for key in {key for pair in pairs for key in pair}:
        branch = coils[key]
        if branch.value is None or branch.value.number <= 0.0:
            raise branch.line.refuse(
                f"the coupled coil {branch.name} has no positive inductance",
                code="HB-F140",
                hint="give it one, or take its coupling out",
            )
    found: dict[str, Winding] = {}
    for first in coils:
        if first in found or not any(first in pair for pair in pairs):
            continue
        group = _group(first, pairs, coils)
        found.update(_windings(group, pairs, coils, texts))
    return found


def _windings(
    group: tuple[str, ...], pairs: Pairs, coils: Mapping[str, Branch], texts: Texts
) -> dict[str, Winding]:
    """Return the coils of one core; those that are coupled by 1 share a leg of it."""
    legs = _legs(group, pairs)
    if len(legs) in (1, len(group)):
        core = _core(group, pairs, coils, texts)
        return {key: Winding(core, k) for k, key in enumerate(group)}
    _check(group, pairs, coils)
    field = replace(_core(tuple(leg[0] for leg in legs), pairs, coils, texts), tied=legs)
    found = {}
    for i, leg in enumerate(legs):
        if len(leg) == 1:
            found[leg[0]] = Winding(field, i)
            continue
        core = replace(_core(leg, pairs, coils, texts), leg=Winding(field, i))
        found.update({key: Winding(core, k) for k, key in enumerate(leg)})
    return found


def _legs(group: tuple[str, ...], pairs: Pairs) -> tuple[tuple[str, ...], ...]:
    """Return the coils that are coupled by 1, directly or by way of others, together."""
    legs: list[list[str]] = []
    for key in group:
        here = [leg for leg in legs if any(abs(_factor(key, b, pairs)) == 1.0 for b in leg)]
        rest = [leg for leg in legs if leg not in here]
        legs = [*rest, [*(b for leg in here for b in leg), key]]
    order = {key: k for k, key in enumerate(group)}
    sorted_legs = sorted(
        (sorted(leg, key=order.__getitem__) for leg in legs), key=lambda x: order[x[0]]
    )
    return tuple(map(tuple, sorted_legs))


def _factor(a: str, b: str, pairs: Pairs) -> float:
    """Return how two coils are coupled; 0 where nothing is written."""
    card = pairs.get((a, b) if a < b else (b, a))
    return 0.0 if card is None else card.value.number


def _pairs(couplings: list[Coupling], coils: Mapping[str, Branch]) -> Pairs:
    pairs: Pairs = {}
    for card in couplings:
        for key in card.coils:
            if key not in coils:
                raise card.line.refuse(
                    f"there is no coil {key!r}",
                    code="HB-F134",
                    hint=did_you_mean(key, coils) or "couple elements L",
                )
        if not 0.0 < abs(card.value.number) <= 1.0:
            raise card.line.refuse(
                f"a coupling of {card.value.number:g}", code="HB-F140", hint="above 0, at most 1"
            )
        for i, a in enumerate(card.coils):
            for b in card.coils[i + 1 :]:
                pair = (a, b) if a < b else (b, a)
                if a == b or pair in pairs:
                    raise card.line.refuse(
                        f"{a} and {b} are coupled twice", code="HB-F133", hint="keep one K"
                    )
                pairs[pair] = card
    return pairs


def _group(first: str, pairs: Pairs, coils: Mapping[str, Branch]) -> tuple[str, ...]:
    inside, grown = {first}, True
    while grown:
        more = {c for pair in pairs if inside & set(pair) for c in pair}
        grown = not more <= inside
        inside |= more
    return tuple(key for key in coils if key in inside)


def _remedy(k: np.ndarray, names: list[str]) -> str:
    """Return what to do about couplings that no coils have."""
    many = range(len(k))
    for i, j in ((i, j) for i in many for j in many if i != j and abs(k[i, j]) == 1.0):
        for m in many:
            if m not in (i, j) and k[m, j] != k[i, j] * k[m, i]:
                return (
                    f"{names[i]} and {names[j]} are coupled by {k[i, j]:g} and {names[m]} and "
                    f"{names[i]} by {k[m, i]:g}: couple {names[m]} and {names[j]} by "
                    f"{k[i, j] * k[m, i]:g}"
                )
    if np.any((k == 0.0) & ~np.eye(len(k), dtype=bool)):
        return "couple each coil with each other one: a K that is not written is a coupling of 0"
    return "coils that are both close to a third are close to each other: raise the smallest K"


def _check(group: tuple[str, ...], pairs: Pairs, coils: Mapping[str, Branch]) -> np.ndarray:
    """Return how coils are coupled, 1 of each with itself, if there are such coils."""
    k = np.array([[1.0 if a == b else _factor(a, b, pairs) for b in group] for a in group])
    legs = [group.index(leg[0]) for leg in _legs(group, pairs)]
    least = float(np.linalg.eigvalsh(k)[0])
    between = float(np.linalg.eigvalsh(k[np.ix_(legs, legs)])[0])
    if least >= -SINGULAR and between >= SINGULAR:
        return k
    names = [coils[key].name for key in group]
    why, hint = (
        ("would store negative energy", _remedy(k, names))
        if least < -SINGULAR
        else ("leave a current that stores nothing", "make one K less")
    )
    card = next(c for pair, c in pairs.items() if all(key in group for key in pair))
    raise card.line.refuse(f"the couplings of {', '.join(names)} {why}", code="HB-F141", hint=hint)


def _core(
    group: tuple[str, ...], pairs: Pairs, coils: Mapping[str, Branch], texts: Texts
) -> Magnetics:
    card = next(c for pair, c in pairs.items() if all(key in group for key in pair))
    k = _check(group, pairs, coils)
    text = [[""] * len(group) for _ in group]
    values = [coils[key].value for key in group]
    for i, a in enumerate(group):
        for j, b in enumerate(group[:i]):
            pair = pairs.get((a, b) if a < b else (b, a))
            text[i][j] = text[j][i] = "" if pair is None else texts.factor(pair.value, "")
    inductances: list[Value] = [v for v in values if v is not None]
    numbers = [v.number for v in inductances]
    rigid = bool(np.all(np.abs(k) == 1.0))
    matrix = None
    ratios: list[tuple[str | float, str | float]] = []
    for i, value in enumerate(inductances):
        sign = -1.0 if k[0, i] < 0 else 1.0
        if value.parametric or inductances[0].parametric:
            l0, li = texts.factor(inductances[0], "H"), texts.factor(value, "H")
            minus = "-" if sign < 0 else ""
            ratios.append((f"{minus}sqrt({li}/{l0})", f"{minus}sqrt({l0}/{li})"))
        else:
            turns = math.sqrt(numbers[i] / numbers[0])
            ratios.append((sign * turns, sign * math.sqrt(numbers[0] / numbers[i])))
    if not rigid:
        matrix = tuple(
            tuple(
                texts.value(inductances[i], "H")
                if i == j
                else _mutual(inductances[i], inductances[j], float(k[i, j]), text[i][j], texts)
                for j in range(len(group))
            )
            for i in range(len(group))
        )
    turns_of = tuple(
        (-1.0 if k[0, i] < 0 else 1.0) * math.sqrt(n / numbers[0]) for i, n in enumerate(numbers)
    )
    return Magnetics(
        card.name,
        card.line,
        group,
        matrix,
        texts.value(inductances[0], "H"),
        tuple(ratios),
        turns_of,
        tuple(
            tuple(float(k[i, j]) * math.sqrt(a * b) for j, b in enumerate(numbers))
            for i, a in enumerate(numbers)
        ),
    )


def _mutual(a: Value, b: Value, k: float, text: str, texts: Texts) -> str | float:
    if k == 0.0:
        return 0.0
    if a.parametric or b.parametric or text.lstrip("-")[:1].isalpha() or "(" in text:
        # the same text for both halves of the matrix, which must be symmetric
        first, second = sorted((texts.factor(a, "H"), texts.factor(b, "H")))
        return f"{text}*sqrt({first}*{second})"
    return f"{k * math.sqrt(a.number * b.number)!r} H"
