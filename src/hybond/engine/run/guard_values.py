"""Guards and what they compare, at an instant of the last step.

After modes/locate.py.
"""

from __future__ import annotations

from typing import Final

from hybond.engine.engine import OK, Engine
from hybond.engine.expressions.paired import holds
from hybond.engine.instant.trial import refuse_pair
from hybond.engine.methods.stepping import between
from hybond.engine.mode.reading import solve_read
from hybond.engine.mode.sizes import measure
from hybond.engine.mode.values import set_motion
from hybond.engine.model import rule_text, value
from hybond.engine.reasons.facts import add_fact
from hybond.engine.run.locator import Locator
from hybond.engine.sliding.blend import begin_sizes, solve_here

BEYOND: Final = 1e-13
"""A weight this far beyond 0 or 1 has left."""


def look(e: Engine, g: Locator, t: float) -> None:
    """Fill the values at t that guards read."""
    if g.looked == t:
        return
    between(e, t, g.y)
    set_motion(e, e.v, t, g.y)
    if e.slide.k == 0:
        g.failed = solve_read(e, e.mode, g.reads, e.v) != OK or g.failed
    else:
        g.failed = solve_here(e, e.mode, e.v) != OK or g.failed
    g.looked = t
    g.sized = False


def atom_at(e: Engine, g: Locator, a: int, t: float) -> float:
    """Return the difference that comparison a of the locator looks at."""
    look(e, g, t)
    return atom_here(e, g, a)


def atom_here(e: Engine, g: Locator, a: int) -> float:
    """Return the same at the values of the motion."""
    if g.atom[a] < 0:
        return e.slide.margin[-1 - g.atom[a]]
    return value(e.model, e.model.atom_value[g.atom[a]], e.v)


def size_here(e: Engine, g: Locator, a: int) -> float:
    """Return what the magnitudes of the two sides of a comparison add up to."""
    return 1.0 if g.atom[a] < 0 else value(e.model, e.model.atom_size[g.atom[a]], e.v)


def test_here(e: Engine, rule: int) -> bool:
    """Return the truth of a guard at the values of the motion, rounding being counted."""
    if rule < 0:
        return e.slide.margin[-1 - rule] < -BEYOND
    return value(e.model, e.model.rule_test[rule], e.v) != 0.0


def holds_at(e: Engine, g: Locator, k: int, t: float) -> bool:
    """Ask a guard as settling will: with rounding counted as zero."""
    look(e, g, t)
    return holds_here(e, g, g.rule[k])


def holds_here(e: Engine, g: Locator, rule: int) -> bool:
    """Ask a guard at the values of the motion; nothing jumps there."""
    m = e.model
    stack = e.work.stack
    if rule < 0:
        return test_here(e, rule)
    if not g.sized:
        begin_sizes_in_motion(e)
        g.sized = True
    measure_in_motion(e, rule)
    ask_in_motion(e)
    true = holds(m, rule, stack)
    if stack.refused != 0:
        refuse_pair(e, e.v[0], rule_text(m, rule))
        if m.tells != 0:
            add_fact(e.fault, float(rule))
        g.failed = True
    return true


def ask_in_motion(e: Engine) -> None:
    """Let guards be asked at the values of the motion: nothing jumps there."""
    stack = e.work.stack
    stack.now = e.v
    stack.was = e.v
    stack.was_first = 0
    stack.jump = e.v
    stack.jumps = False
    stack.terms = e.work.terms


def begin_sizes_in_motion(e: Engine) -> None:
    """Prepare for guards to be measured at the values of the motion, after `solve_here`."""
    for k in range(e.model.storages):
        e.work.here[k] = e.v[e.model.stored_slot + k]
    begin_sizes(e, e.mode, e.v, e.work.here, e.work.terms)


def measure_in_motion(e: Engine, rule: int) -> None:
    """Find what rounding of the signals that a guard reads is measured by in the motion."""
    measure(e, e.mode, rule, e.work.xi, e.v, e.work.terms)
