"""Laws of junctions that have more than one answer, as rigid friction may (Painleve)."""

from __future__ import annotations

from hybond.engine.complementarity.branch_records import NOT_OF_PART
from hybond.engine.engine import Engine
from hybond.engine.laws.law_records import Laws
from hybond.engine.reasons.warned import SECOND_ANSWER, add_about, begin_warning


def warn_of_several(e: Engine, r: Laws) -> None:
    """Warn where other answers fit as well as that in ``r.problem``, where somebody reads it."""
    m = e.model
    p = r.problem
    if m.tells == 0 or p.answers < 2:
        return
    for k in range(m.ports):
        if r.loose[k] != 0:
            return  # a way was supposed, and is still to be held against what follows
    begin_warning(e.warned, SECOND_ANSWER, r.t)
    add_about(e.warned, float(p.answer_why))
    add_about(e.warned, float(p.answers))
    add_about(e.warned, 1.0 if p.more_answers else 0.0)
    for k in range(m.ports):
        if p.answer_way[k] != NOT_OF_PART:
            add_about(e.warned, float(k))
            for answer in range(p.answers):
                add_about(e.warned, float(p.answer_way[answer * p.n + k]))
