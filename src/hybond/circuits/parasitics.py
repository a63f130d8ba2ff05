"""Resistance, inductance and capacitance written on the card of another part."""

from __future__ import annotations

from dataclasses import replace

from hybond.circuits.cards import Card
from hybond.model.expressions import Expr, Number


def with_parasitics(card: Card) -> list[Card]:
    """Return a card, and as cards of their own what LTspice lets it carry.

    ``Rser`` and ``Lser`` are in series with the part, ``Rpar`` and ``Cpar`` across all of it. A
    value of zero is none.

    Examples
    --------
    >>> from hybond.circuits.notices import Line
    >>> line = Line("x.net", 2, "L1 a b 1m Rser=2 Cpar=1p")
    >>> beside = {"rser": Number(2.0), "cpar": Number(1e-12)}
    >>> coil = Card("L1", line, ("a", "b"), Number(1e-3), parasitics=beside)
    >>> [(c.name, c.nodes) for c in with_parasitics(coil)]
    [('L1', ('a', 'L1#1')), ('R_L1_Rser', ('L1#1', 'b')), ('C_L1_Cpar', ('a', 'b'))]
    """
    given = {k: v for k, v in card.parasitics.items() if v != Number(0.0)}
    if not given:
        return [replace(card, parasitics={})]
    first, last = card.nodes[0], card.nodes[1]

    def part(letter: str, word: str, a: str, b: str, value: Expr) -> Card:
        return Card(f"{letter}_{card.name}_{word}", card.line, (a, b), value)

    series = [(k.upper()[0], k.capitalize(), given[k]) for k in ("rser", "lser") if k in given]
    inside = [f"{card.name}#{k + 1}" for k in range(len(series))]
    at = [first, *inside, last]
    found = [replace(card, nodes=(at[0], at[1], *card.nodes[2:]), parasitics={})]
    found += [part(*series[k][:2], at[k + 1], at[k + 2], series[k][2]) for k in range(len(series))]
    across = [(k.upper()[0], k.capitalize(), given[k]) for k in ("rpar", "cpar") if k in given]
    return found + [part(letter, word, first, last, v) for letter, word, v in across]
