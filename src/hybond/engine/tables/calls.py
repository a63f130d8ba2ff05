"""What a run calls, in the tables: inputs that are functions in Python, and blocks of signals."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hybond.engine.surfaces.reads import READS_INPUT
from hybond.errors import ModelError
from hybond.model.expressions import names
from hybond.model.expressions.rounded_roots import magnitude
from hybond.model.graph import FlatGraph, Sample
from hybond.model.inputs import Called

if TYPE_CHECKING:
    from hybond.engine.tables.columns import ModelTables


def blocks_of(g: FlatGraph) -> list[Sample]:
    """Return the samples that a block computes, by the number of the block."""
    return [s for s in g.samples if s.block is not None]


def refuse_calls(g: FlatGraph) -> None:
    """Refuse what an export cannot call.

    Raises
    ------
    ModelError
        HB-E630.
    """
    for s in blocks_of(g):
        raise ModelError(
            f"the block {s.path} is code from elsewhere",
            code="HB-E630",
            where=f"blocks.{s.path}",
            hint="write what it does as sampled signals",
        )
    for i in g.inputs:
        if isinstance(i.waveform, Called):
            raise ModelError(
                f"the input {i.path} is a function in Python",
                code="HB-E630",
                where=f"inputs.{i.path}",
                hint="give it as a table, or as pulses",
            )


def put_samples(t: ModelTables) -> None:
    """Put the sampled signals of a model into its tables, and the blocks behind some of them."""
    g = t.graph
    blocks = blocks_of(g)
    plain = [s.block is None for s in g.samples]
    t.numbers["samples"] = len(g.samples)
    t.ints["sample_signal"] = [s.signals[0] if p else -1 for s, p in zip(g.samples, plain)]
    t.ints["sample_value"] = [
        t.values.number(s.values[0], s.path) if p else -1 for s, p in zip(g.samples, plain)
    ]
    t.ints["sample_size"] = [
        t.values.number(magnitude(s.values[0]), s.path) if p else -1
        for s, p in zip(g.samples, plain)
    ]
    t.floats["sample_every"] = [s.every for s in g.samples]
    t.floats["sample_phase"] = [s.phase for s in g.samples]
    t.numbers["blocks"] = len(blocks)
    t.ints["sample_block"] = [
        -1 if p else sum(not q for q in plain[:k]) for k, p in enumerate(plain)
    ]
    read = [[t.values.number(e, s.path) for e in s.values] for s in blocks]
    written = [list(s.signals) for s in blocks]
    for first, column, rows in (
        ("block_first", "block_value", read),
        ("block_set", "block_signal", written),
    ):
        t.ints[first] = [sum(map(len, rows[:k])) for k in range(len(rows) + 1)]
        t.ints[column] = [k for row in rows for k in row]
    t.numbers["most_called"] = max(map(len, [*read, *written]), default=0)


def put_rated(t: ModelTables) -> None:
    """Put the inputs there whose rate is read: that of a function takes two calls more.

    Called when all other tables are made.
    """
    inputs = t.graph.inputs
    read = {n for e in (*t.values.all, *t.pairs) for n in names(e) if n.startswith("du:")}
    kinds = zip(t.ints["surface_kind"], t.ints["surface_index"], strict=True)
    read |= {f"du:{k}" for kind, k in kinds if kind == READS_INPUT}
    t.numbers["called"] = sum(isinstance(i.waveform, Called) for i in inputs)
    t.ints["input_rated"] = [int(f"du:{i.index}" in read) for i in inputs]
