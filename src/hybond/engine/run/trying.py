"""A mode tried where a run begins: what a run would meet there, without going on from it."""

from __future__ import annotations

from hybond.engine.algebra.products import copy_floats, copy_part
from hybond.engine.engine import OK, REFUSED, Engine
from hybond.engine.guards.in_force import is_asked
from hybond.engine.inputs.interval import interval_after
from hybond.engine.inputs.sampling import sample
from hybond.engine.instant.enabled import rule_holds
from hybond.engine.instant.indeterminate import keep_open_before
from hybond.engine.jumps.trial import a_priori, show_trial
from hybond.engine.laws.entering import enter
from hybond.engine.run.run_records import Run, begin
from hybond.engine.words import Ints


def try_at_start(e: Engine, r: Run, state: Ints, hold: Ints) -> int:
    """Enter a mode from the start of a run that has not begun, and see which rules leave it.

    `hold` says of each rule whether it does. REFUSED with a fault if the mode cannot be entered, or
    a guard has no truth there.
    """
    m = e.model
    g = r.settling
    begin(e)
    e.samples_end = e.until
    copy_floats(m.storages, e.y, g.x)
    copy_part(m.integrals, e.y, m.storages, g.s, 0)
    if a_priori(e, 0.0, g.x, g.s, e.state) != OK:
        return REFUSED
    keep_open_before(e)
    if sample(e, g.s) != OK:
        return REFUSED
    interval_after(e, 0.0)
    if enter(e, 0.0, g.x, g.s, state, True, False) != OK:
        return REFUSED
    show_trial(e, e.work.stack)
    for k in range(m.machines):
        for i in range(m.rule_first[k], m.rule_first[k + 1]):
            hold[i] = 0
            if m.is_law[k] == 0 and is_asked(e, k, i, e.trial.state[k]):
                hold[i] = rule_holds(e, 0.0, k, i)
                if hold[i] < 0:
                    return REFUSED
    return OK
