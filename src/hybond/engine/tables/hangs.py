"""Tables of what laws hang on: the values that each of them reads, whatever its slopes are.

From these it is told which states act on which rates (`engine.mode.rows.acting`): of a row of a
thousand tanks each rate hangs on three levels.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from hybond.engine.tables.columns import INTS, put_rows
from hybond.model.expressions import names

if TYPE_CHECKING:
    from hybond.engine.tables.columns import ModelTables


def put_hangs(t: ModelTables) -> None:
    """Put the slots that each source reads into the tables, each dynamic row, storage and signal.

    A source with its rate; what a storage of several ports has stored is a state as well.
    """
    rows = list(zip(t.ints["source_value"], t.ints["source_rate"], strict=True))
    for name in ("dynamic_value", "co_energy", "integral_rate"):
        rows += [(k, -1) for k in t.ints[name]]
    index = t.slots.index
    read = [{index[n] for k in row if k >= 0 for n in names(t.values.all[k])} for row in rows]
    put_rows(t, "hang_first", [[(k,) for k in sorted(own)] for own in read], hang_slot=INTS)
