"""What laws are held against: values as they are read from outside, and what was found."""

from __future__ import annotations

import math

from hybond.engine.model import Model
from hybond.engine.words import Floats, Ints, floats, ints, record


@record
class Checks:
    """What is known of laws that do not hold.

    A law is known by `what` (see `laws_held`) and its number `index`; `off` is what is left of it
    and `size` the sum of the magnitudes of its terms.
    """

    v: Floats
    other: Floats
    """Values from another beginning of Newton's method."""
    tolerance: Floats
    """By how much each bond variable may be off."""
    lost: Floats
    """By how much more, where digits were lost on the way to it."""
    magnitude: Floats
    largest: Floats
    """The largest bond variable of each class that the run has seen at its checks."""
    lasting: Floats
    """Likewise, but for those at the end of a step in no time: what was there for a moment."""
    pulls_since: Floats
    """Of each law: since when it pulls on the mean, infinite if it does not."""
    due: int
    """How many evaluations the run will have made when it is looked at again."""
    looks: int
    first_look: bool
    """Whether lost digits are not counted yet: what does not hold then is suspect, no more."""
    suspects: int
    unbounded: int
    """A bond variable that was found beyond all bounds, -1: none."""
    said: Ints
    """Of each law: whether it was found not to hold, in the order of the kinds in `noting`."""
    violated: int
    what: int
    index: int
    off: float
    t: float
    root: Ints
    """Of each bond: one in its part of the graph, while parts are found."""
    reached: Ints
    """Of the first bond of each part: whether a jump has anything to do there."""
    all_reached: bool
    ahead: Floats
    """The state to which the motion before the last located instant would have gone by its end."""
    beyond: float
    """When that is."""
    since: Floats
    """The state at that instant before it was settled."""
    at: float
    ahead_state: Ints
    """The mode of that motion."""
    foreseen: bool
    """Whether these are known."""
    close: bool
    """Whether the present instant is within that one; `late` by so much, of its `room`."""
    late: float
    room: float
    carried: Floats
    """Of each rule: the most that what it compares has been since its machine came there; ..."""
    unresolved: Floats
    """... and the most of it that was hardly more than rounding, ..."""
    unresolved_at: Floats
    """... at what time, ..."""
    unresolved_by: Floats
    """... and what rounding was there."""
    borne: Floats
    """Of each rule: what it compares, where it was more than rounding, over time, ..."""
    most_borne: Floats
    """... and the most of it; ..."""
    vague: Floats
    """... the same where it was not, but may be more than it is evaluated to, ..."""
    most_vague: Floats
    """... the most of that, ..."""
    vague_at: Floats
    """... at what time, ..."""
    vague_by: Floats
    """... and what rounding was there."""
    held: Ints
    """Of each rule: whether that motion makes it begin to hold in that instant."""
    looked: float
    """When laws were looked at last within a motion, s."""
    before: Floats
    after: Floats
    """What ports read before and after an impact."""
    terms: Floats
    """The magnitudes of what each of these is a sum of."""
    prior: Floats
    size: float
    """The largest sum of what is stored times its co-energy variable, J."""
    moved: float
    """The energy that has moved into storage or out of it, J; what of it comes from nowhere, and
    what steps may be off by; what does by rates that are shown, beyond those of the motion."""
    unbalanced: float
    may: float
    apart: float
    brought: float
    """What rates have brought into storage, less what they took out of it, J."""
    strayed: float
    """Since when the balance does not hold, s; infinity: it does. Which storage moved most then,
    and in which mode."""
    strayed_by: int
    strayed_state: Ints
    beside: Floats
    rate: Floats
    middle: Floats
    """Co-energy variables in the middle of a step, and rates there of its polynomial."""
    along: Floats
    lost_between: float
    """What laws have lost between the ends of steps beyond what they may be off by, J; since when,
    infinity: nothing."""
    lost_since: float
    apart_for: Floats
    """Of each storage: how long its rate was shown as another than it moved by, s; since when, the
    most of it, when that was, and what it moved by then."""
    apart_since: Floats
    most_apart: Floats
    most_at: Floats
    apart_from: Floats
    was_apart: Ints
    """Whether it was so at the end of the last step."""
    shown_at: float
    """When values were last looked at."""


def make_checks(m: Model) -> Checks:
    """Return checks of a run that has not begun."""
    c = Checks()
    c.v = floats(2 * m.slots)
    c.other = floats(2 * m.slots)
    c.tolerance = floats(2 * m.bonds)
    c.lost = floats(2 * m.bonds)
    c.magnitude = floats(2 * m.bonds)
    c.largest = floats(m.classes)
    c.lasting = floats(m.classes)
    c.pulls_since = floats(m.ports)
    for k in range(m.ports):
        c.pulls_since[k] = math.inf
    rules = m.rule_first[m.machines]
    c.said = ints(
        m.elements
        + 2 * m.storages
        + m.junctions
        + 2 * rules
        + m.ports
        + m.elements
        + 3 * m.storages
        + m.elements
        + m.ports
    )
    c.root = ints(m.bonds)
    c.reached = ints(m.bonds)
    c.ahead = floats(m.storages + m.integrals)
    c.since = floats(m.storages + m.integrals)
    c.ahead_state = ints(m.machines)
    c.carried = floats(rules)
    c.unresolved = floats(rules)
    c.unresolved_at = floats(rules)
    c.unresolved_by = floats(rules)
    c.borne = floats(rules)
    c.most_borne = floats(rules)
    c.vague = floats(rules)
    c.most_vague = floats(rules)
    c.vague_at = floats(rules)
    c.vague_by = floats(rules)
    c.held = ints(rules)
    c.looked = -1.0
    c.unbounded = -1
    c.before = floats(m.ports)
    c.after = floats(m.ports)
    c.terms = floats(m.ports)
    c.prior = floats(2 * m.bonds)
    c.beside = floats(m.storages + m.integrals)
    c.rate = floats(m.storages + m.integrals)
    c.middle = floats(m.storages)
    c.along = floats(m.storages)
    c.lost_since = math.inf
    c.shown_at = -1.0
    c.apart_for = floats(m.storages)
    c.apart_since = floats(m.storages)
    c.most_apart = floats(m.storages)
    c.most_at = floats(m.storages)
    c.apart_from = floats(m.storages)
    c.was_apart = ints(m.storages)
    c.strayed = math.inf
    c.strayed_state = ints(m.machines)
    return c
