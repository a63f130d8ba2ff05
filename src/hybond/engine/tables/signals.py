"""Tables of what goes with time: integrated signals, inputs, comparisons of time."""

from __future__ import annotations

from hybond.engine.tables.calls import put_samples
from hybond.engine.tables.columns import FLOATS, INTS, ModelTables, put_rows
from hybond.engine.tables.elements import levels_of
from hybond.engine.tables.expressions import number_of
from hybond.equations.rounding import rounding
from hybond.model.expressions import Binary, names
from hybond.model.inputs import Called, Constant, Free, Pwm, Timetable
from hybond.model.resolve import affine_in_time

_OPERATORS = {"<": 0, "<=": 1, ">": 2, ">=": 3}


def put_signals(t: ModelTables) -> None:
    """Put integrated signals, samples, inputs and comparisons of time into the tables."""
    g = t.graph
    t.pairs += [i.rate for i in g.integrals]
    t.ints["integral_rate"] = [t.values.number(i.rate, f"{i.path}'") for i in g.integrals]
    t.ints["integral_size"] = [t.values.number(rounding(i.rate)) for i in g.integrals]
    t.numbers["signals_act"] = int(
        any(n.startswith("s:") for i in g.integrals for n in names(i.rate))
    )
    t.floats["integral_start"] = [number_of(i.start) for i in g.integrals]
    put_samples(t)
    kinds, rows, levels = [], [], []
    for i in g.inputs:
        w = i.waveform
        own: list[tuple[int]] = []
        if isinstance(w, Free):
            kinds.append(4)
            rows.append([(w.level,)])
        elif isinstance(w, Constant):
            kinds.append(0)
            rows.append([(w.level,)])
        elif isinstance(w, Pwm):
            kinds.append(3)
            rows.append([(a,) for a in (w.period, w.duty, w.high, w.low, w.phase)])
        elif isinstance(w, Timetable):
            kinds.append(2 if w.linear else 1)
            rows.append([(a,) for a in (*w.times, *w.values)])
            if not w.linear:
                place = {a: k for k, a in enumerate(levels_of(g, i.index))}
                own = [(place[a],) for a in (w.values[0], *w.values)]
        else:
            assert isinstance(w, Called)
            kinds.append(5)
            rows.append([(a,) for a in w.breaks])
        levels.append(own)
    t.ints["input_kind"] = kinds
    put_rows(t, "input_first", rows, input_number=FLOATS)
    tables = [i.waveform if isinstance(i.waveform, Timetable) else None for i in g.inputs]
    t.floats["input_period"] = [0.0 if w is None else w.period for w in tables]
    put_rows(t, "level_first", levels, level_of=INTS)
    lines = [
        affine_in_time(Binary("-", w.compare.left, w.compare.right)) or (0.0, 0.0)
        for w in g.watches
    ]
    t.floats["watch_slope"] = [a for a, _ in lines]
    t.floats["watch_offset"] = [b for _, b in lines]
    t.ints["watch_operator"] = [_OPERATORS[w.compare.op] for w in g.watches]
    t.floats["watch_time"] = [w.times[0] for w in g.watches]


def put_acting(t: ModelTables) -> None:
    """Put into the tables which integrated signals rates read, when all laws are in them."""
    columns = ("source_value", "dynamic_value", "co_energy", "integral_rate")
    ports = ("port_limit", "port_gap", "port_gate")
    asked = {k for name in (*columns, *ports) for k in t.ints[name] if k >= 0}
    read = {n for k in asked for n in names(t.values.all[k])}
    t.ints["signal_acts"] = [int(f"s:{i.index}" in read) for i in t.graph.integrals]
