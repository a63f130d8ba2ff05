"""Expressions of the model on pairs: guards, then rates of integrated signals."""

from __future__ import annotations

from hybond.engine.expressions.pairs import Stack, clear, pop_truth
from hybond.engine.model import Model
from hybond.engine.words import given


@given
def evaluate_pair(m: Model, k: int, s: Stack) -> None:
    """Leave pair k of the model on top of the stack."""
    m.answers.pair(k, s)


def holds(m: Model, k: int, s: Stack) -> bool:
    """Return the truth of pair k; ``s.refused`` says if it has none."""
    clear(s)
    s.touching = k < m.rule_first[m.machines] and m.rule_touches[k] != 0
    evaluate_pair(m, k, s)
    s.touching = False
    return pop_truth(s)


def holds_from(m: Model, k: int, s: Stack, level: float) -> bool:
    """Return the same of one comparison, zero up to `level`: it is at its limit that far."""
    s.level = level
    true = holds(m, k, s)
    s.level = 0.0
    return true
