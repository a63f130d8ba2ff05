"""The end of a step, noted: the state is put back on its constraints, looked at and shown."""

from __future__ import annotations

from hybond.engine.checks.bounds_held import hold_bounds
from hybond.engine.checks.energy_held import (
    hold_last_rates,
    hold_step,
    tell_balance,
    warn_of_steps,
)
from hybond.engine.checks.laws_held import look_now_and_then
from hybond.engine.checks.lost_between import see_between, tell_lost_between
from hybond.engine.checks.means_held import hold_means
from hybond.engine.checks.rates_apart import count_rates_apart, tell_rates_apart
from hybond.engine.contacts.landing import keep_still
from hybond.engine.engine import OK, REFUSED, Engine
from hybond.engine.guards.unresolved import tell_unresolved
from hybond.engine.laws.gaps_held import hold_gaps
from hybond.engine.laws.laws import limits_vary, look_at_limits, observe
from hybond.engine.methods.stepping import between, start
from hybond.engine.planar.stops import arm_slips
from hybond.engine.run.log import report_step
from hybond.engine.run.on_surfaces import hold_to_surfaces
from hybond.engine.run.roots_followed import note_roots
from hybond.engine.run.run_records import Run
from hybond.engine.run.source_jumps import put_before_kink
from hybond.engine.surfaces.values import set_state


def note(e: Engine, r: Run, t: float, shown: float) -> int:
    """Note a step that ends at `t`, with the state at `shown`, put back on its constraints.

    The two are one instant.
    """
    m = e.model
    early = e.early
    for k in range(e.states):
        e.y[k] = e.step.y1[k]
    if shown != e.step.t1:
        between(e, shown, e.y)
    if put_before_kink(e, r, t) != OK:
        return REFUSED
    if e.slide.k > 0 and hold_to_surfaces(e, t) != OK:
        return REFUSED
    keep_still(e, e.y)
    if m.laws > 0:
        set_state(e, e.mode, e.shown, t, e.y)
        observe(e, e.shown)
    if m.disks > 0:
        arm_slips(e, t, e.y)
    e.t = t
    note_roots(e)
    if m.laws > 0 and e.slide.k == 0 and hold_gaps(e, e.shown) != OK:
        return REFUSED
    if t > r.resumed:
        report_step(e, r.report)
    hold_step(e)
    see_between(e)
    count_rates_apart(e)
    look_now_and_then(e)
    hold_means(e)
    hold_last_rates(e)
    if hold_bounds(e) != OK:
        return REFUSED
    if limits_vary(m) and look_at_limits(e) != OK:
        return REFUSED
    e.early = early
    return OK


def go_on(e: Engine) -> int:
    """Tell the solver of a state that was put back on its constraints: no jump, no history."""
    for k in range(e.states):
        if e.y[k] != e.step.y1[k]:
            return start(e, e.t, e.y, e.until, False)
    return OK


def tell_at_end(e: Engine) -> None:
    """Tell what is known of a run only where it ends."""
    tell_balance(e)
    warn_of_steps(e)
    tell_unresolved(e)
    tell_rates_apart(e)
    tell_lost_between(e)
