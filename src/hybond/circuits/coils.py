"""Coupled coils: a field of inductances, or windings of one ideal transformer."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

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


@dataclass(frozen=True, slots=True)
class Winding:
    """One coil: on which core, and as which of its coils."""

    core: Magnetics
    index: int


def couple(opened: Opened, texts: Texts) -> dict[str, Winding]:
    """Return the coils that are coupled, by key.

    Raises
    ------
    FileError
        HB-F133 (a pair coupled twice), HB-F134 (no such coil), HB-F140 (a coupling above 1),
        HB-F141 (couplings that store negative energy, or only some of which are rigid).
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
        core = _core(group, pairs, coils, texts)
        found.update({key: Winding(core, k) for k, key in enumerate(group)})
    return found


Pairs = dict[tuple[str, str], Coupling]


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


def _remedy(k: np.ndarray) -> str:
    """Return what to do about couplings that no coils have."""
    if np.any((k == 0.0) & ~np.eye(len(k), dtype=bool)):
        return "couple each coil with each other one: a K that is not written is a coupling of 0"
    return "coils that are both close to a third are close to each other: raise the smallest K"


def _core(
    group: tuple[str, ...], pairs: Pairs, coils: Mapping[str, Branch], texts: Texts
) -> Magnetics:
    card = next(c for pair, c in pairs.items() if pair[0] in group)
    k = np.eye(len(group))
    text = [[""] * len(group) for _ in group]
    values = [coils[key].value for key in group]
    for i, a in enumerate(group):
        for j, b in enumerate(group[:i]):
            pair = pairs.get((a, b) if a < b else (b, a))
            k[i, j] = k[j, i] = 0.0 if pair is None else pair.value.number
            text[i][j] = text[j][i] = "" if pair is None else texts.factor(pair.value, "")
    least = float(np.linalg.eigvalsh(k)[0])
    inductances: list[Value] = [v for v in values if v is not None]
    numbers = [v.number for v in inductances]
    rigid = bool(np.all(np.abs(k) == 1.0)) and np.linalg.matrix_rank(k) == 1
    if least < SINGULAR and not rigid:
        why, hint = (
            ("would store negative energy", _remedy(k))
            if least < -SINGULAR
            else (
                "tie only some coils rigidly",
                "couple each coil with each other one, all with 1 or all with less",
            )
        )
        names = ", ".join(coils[key].name for key in group)
        raise card.line.refuse(f"the couplings of {names} {why}", code="HB-F141", hint=hint)
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
