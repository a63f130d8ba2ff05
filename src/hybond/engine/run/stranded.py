"""Motion that gets nowhere, refused with what is known of it."""

from __future__ import annotations

from hybond.engine.engine import OK, REFUSED, Engine, say_fault
from hybond.engine.expressions.paired import holds
from hybond.engine.guards.guard_values import (
    ask_in_motion,
    begin_sizes_in_motion,
    measure_in_motion,
)
from hybond.engine.guards.in_force import is_asked
from hybond.engine.mode.equations import mode_of
from hybond.engine.planar.stops import slips_now
from hybond.engine.reasons.facts import add_fact
from hybond.engine.surfaces.combine import combine_here
from hybond.engine.surfaces.values import evaluate
from hybond.engine.words import Text


def in_vain(e: Engine, why: Text) -> int:
    """Refuse to go on where guards hold again and again, and nothing changes."""
    m = e.model
    if mode_of(e, e.state) != OK or combine_here(e, e.state) != OK:
        return REFUSED
    if evaluate(e, e.mode, e.v, e.t, e.y) != OK:
        return REFUSED
    say_fault(e, "HB-N406", why, "")
    begin_sizes_in_motion(e)
    ask_in_motion(e)
    for k in range(m.machines):
        for rule in range(m.rule_first[k], m.rule_first[k + 1]):
            if m.rule_watched[rule] != 0 and is_asked(e, k, rule, e.state[k]):
                measure_in_motion(e, rule)
                if holds(m, rule, e.work.stack):
                    add_fact(e.fault, float(rule))
    return REFUSED


def no_slip(e: Engine) -> int:
    """Refuse slip in the plane that no step follows."""
    m = e.model
    say_fault(e, "HB-N408", "no step follows the slip", "")
    e.fault.t = e.step.t0
    add_fact(e.fault, 0.0)
    for d in range(m.disks):
        if slips_now(e, d):
            add_fact(e.fault, float(m.disk_machine[d]))
    return REFUSED
