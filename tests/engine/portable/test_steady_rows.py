"""Rows that are the same in every mode are eliminated once in a run: no bit depends on that."""

from __future__ import annotations

from itertools import pairwise, product
from pathlib import Path

import pytest

import hybond as hb
from hybond.engine.engine import OK, Engine, make_engine
from hybond.engine.inputs.interval import interval_after
from hybond.engine.mode.equations import mode_of
from hybond.engine.tables import answered, tables_of

EXAMPLES = Path(__file__).parents[3] / "examples"
NAMES = ("cockcroft_walton", "boost", "clutch", "capacitors_joined", "thyristor_rectifier")


def begun(name: str) -> Engine:
    """Return a run that has made no mode yet."""
    graph = hb.load(EXAMPLES / f"{name}.toml").flatten()
    e = make_engine(answered(tables_of(graph, calling=True)))
    interval_after(e, 0.0)
    return e


def equations(e: Engine, state: tuple[int, ...]) -> list[object]:
    """Return the rows of a mode, entry by entry."""
    if mode_of(e, list(state)) != OK:
        return [e.fault.code]
    mode = e.mode
    found: list[object] = [mode.source[: mode.sources], mode.dynamic[: mode.dynamics]]
    for rows in (mode.finite, mode.power, mode.constraints, mode.agreements):
        first = rows.first.at[: rows.rows + 1]
        found += [first, rows.column.at[: first[-1]], rows.value.at[: first[-1]]]
        found.append(rows.size.at[: first[-1]])
    free = 2 * e.model.bonds * mode.finite_frees
    found += [mode.same, mode.free_column[: mode.finite_frees], mode.finite_free.at[:free]]
    return [list(x) for x in found]  # type: ignore[call-overload]


@pytest.mark.parametrize("name", NAMES)
def test_a_mode_is_the_same_whichever_was_the_first(name: str) -> None:
    e = begun(name)
    m = e.model
    many = [range(b - a) for a, b in pairwise(m.state_first[: m.machines + 1])]
    states = [*product(*many)][-6:]
    others = [equations(e, state) for state in states]
    assert e.work.steady_known
    for state, other in zip(states, others, strict=True):
        assert equations(begun(name), state) == other
    assert len({str(x) for x in others}) > 1
