"""What a model answers: the values of its expressions, and what its parts are called.

These are given with each model: as code in tables for the library, as functions and texts of a
printed program.
"""

from __future__ import annotations

from hybond.engine.model import Model
from hybond.engine.words import Floats, Text, given


@given
def value(m: Model, k: int, v: Floats) -> float:
    """Return expression k of the model at the values `v`."""
    return float(m.answers.values[k](v))


@given
def machine_name(m: Model, k: int) -> Text:
    """Return the name of machine k."""
    return str(m.answers.machines[k])


@given
def state_name(m: Model, k: int) -> Text:
    """Return the name of state k, counted over all machines."""
    return str(m.answers.states[k])


@given
def stored_name(m: Model, k: int) -> Text:
    """Return the name of stored quantity k, or of an integrated signal behind them."""
    return str(m.answers.stored[k])


@given
def output_name(m: Model, k: int) -> Text:
    """Return the name of output k."""
    return str(m.answers.outputs[k])


@given
def node_name(m: Model, k: int) -> Text:
    """Return the name of node k."""
    return str(m.answers.nodes[k])


@given
def bond_name(m: Model, k: int) -> Text:
    """Return the name of bond variable k: efforts, then flows."""
    return str(m.answers.bonds[k])


@given
def rule_text(m: Model, k: int) -> Text:
    """Return the guard of rule k as written."""
    return str(m.answers.rules[k])
