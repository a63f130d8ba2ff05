"""A step repeated so that it ends just past the first instant at which a guard holds."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import OK, REFUSED, Engine
from hybond.engine.expressions.pairs import ROUNDING
from hybond.engine.guards.guard_values import atom_at, holds_at, terms_here
from hybond.engine.guards.locate import locate
from hybond.engine.guards.locator import NONE, Locator
from hybond.engine.guards.together import (
    ends_in_rounding,
    is_kink_alone,
    kink_there,
    last_of_instant,
    with_its_energy,
)
from hybond.engine.guards.within_rounding import past_rounding
from hybond.engine.methods.control import is_propagated
from hybond.engine.methods.explicit.dopri import spacing
from hybond.engine.methods.explicit.one_instant import LEAST, room_of_instant
from hybond.engine.methods.linear.rates_off import RATES
from hybond.engine.methods.stepping import by_radau, no_shorter, retry
from hybond.engine.mode.mode_records import is_constrained

FORWARD: Final = 20
"""Times that the motion goes on beyond a guard that holds in vain; then that is refused."""
SHORTER: Final = 30
"""Times that a step is repeated shorter, at the most."""
NEARLY: Final = 1e-2
"""Part of a step that is its end."""
NO_TIME: Final = 1e-100
"""Part of the run that is next to none: what holds as soon as time passes holds at any such one."""
AT_RIM: Final = 2.0
"""Roundings off its threshold at which what is compared waits to be told from it."""
FAR: Final = 4.0
"""How many times as far as to the instant a step may go that shows it as it is."""


def find_within(e: Engine, g: Locator) -> int:
    """Repeat a step shorter until there are values all over it, where a law has an edge."""
    for _ in range(SHORTER if e.model.edges > 0 else 0):
        h = 0.25 * (e.step.t1 - e.step.t0)
        if e.step.t0 + h == e.step.t0:
            return REFUSED
        if retry(e, e.step.t0 + h) != OK and not is_led(e):
            return REFUSED
        if locate(e, g) == OK:
            return OK
    return REFUSED


def land(e: Engine, g: Locator, room: float, end: float, last: float, tries: int) -> int:
    """Repeat the step so that it ends just past the instant found; find all that is one with it.

    Not beyond `end`. A motion that is tied is known at any instant, whatever the step is. Where a
    guard held in the motion and not when it was settled, so many `tries` up to the `last`, they
    differ by a last place, and a motion slower than that would never get past: it goes on by a few
    last places of the time, each time by twice as many, a few times. Where the guard holds is known
    of the step that ends there: a longer one may have it later by more than an instant.
    """
    far = e.step.t1 - e.step.t0 > FAR * (g.at - e.step.t0)
    if not g.tied and (far or not shows_instants(e)) and land_first(e, g, room) != OK:
        return REFUSED
    if g.at == math.inf:
        return OK
    top = min(g.at + room, end)
    # guards are asked within the step, never where its polynomial is extended
    if top > e.step.t1:
        if is_kink_alone(e, g):
            return OK  # no step goes far beyond a kink
        longest = e.step.t1
        g.found_at = math.nan
        made = retry(e, top)
        if e.step.off > 1.0:
            # what decays within the instant is followed as far as a step can
            top = longest
            made = retry(e, top)
        if made != OK:
            return REFUSED
    g.looked = math.nan
    if tries > 0 and tries <= FORWARD and g.at - last <= room:
        g.at = min(g.at + LEAST * spacing(g.at) * math.pow(2.0, float(tries)), top)
    if e.model.laws > 0 and kink_there(e, g) < 0:
        # beyond a kink what is stored may be what it jumps to
        g.at = with_its_energy(e, g, g.at, top)
    g.began = g.at
    if not g.failed:
        g.at = last_of_instant(e, g, g.at, top)
    if not g.failed:
        g.at = past_rounding(e, g, g.at, room, end)
    if g.failed:
        return REFUSED
    return end_there(e, g) if is_unseen(e, g) else OK


def is_unseen(e: Engine, g: Locator) -> bool:
    """Whether something is over in the step so soon that its polynomial may know nothing of it."""
    if g.tied or e.model.kinks + e.model.slide_kinks > 0 or g.at >= e.step.t1 or g.at <= e.step.t0:
        return False
    h = e.step.t1 - e.step.t0
    fast = is_propagated(e) and e.exact.flow.norm * h > RATES
    if not fast and (not by_radau(e) or e.curved):
        return False
    # what holds where the step ends, too, has begun to hold
    return not holds_any(e, g, e.step.t1)


def holds_any(e: Engine, g: Locator, t: float) -> bool:
    """Whether a guard holds at an instant of the step."""
    for k in range(g.guards):
        if holds_at(e, g, k, t):
            return True
    return False


def end_there(e: Engine, g: Locator) -> int:
    """End the step at the instant found, which is none if no guard holds in the motion itself.

    While a picofarad settles behind a nano-ohm, a polynomial that satisfies the tolerance may have
    its current negative for as long as next to no time.
    """
    if retry(e, g.at) != OK:
        return REFUSED
    g.looked = math.nan
    g.found_at = math.nan
    if not holds_any(e, g, g.at):
        g.at = math.inf
    return OK


def shows_instants(e: Engine) -> bool:
    """Whether the last step shows an instant in it as well as one that ends there would.

    Its polynomial is the motion, and its rates, sums of the state, hide nothing.
    """
    return e.straight and e.step.precise and not is_constrained(e.mode)


def knows_ends(e: Engine) -> bool:
    """Whether a step ends where the motion does, whatever its polynomial says in between."""
    return is_propagated(e) and e.model.kinks == 0


def land_first(e: Engine, g: Locator, room: float) -> int:
    """Repeat the step so that it ends just past the first instant at which a guard holds.

    A step that is long enough to pass over what is narrow next to the guard, as a force that is
    larger near rest, may not know of it; the one that ends there does. If its error is too large,
    the step becomes shorter and nothing has happened yet, ``g.at`` being infinite.
    """
    h = e.step.t1 - e.step.t0
    longest = e.step.t1
    at = g.at
    about = g.about
    for k in range(2):
        past = 1e-6 if k == 0 else 1e-3
        end = at + max(past * (at - e.step.t0), 2.0 * room)
        if end >= longest and knows_ends(e):
            # a motion that is over within an instant
            end = at + past * (at - e.step.t0)
        if end >= longest or end - e.step.t0 <= 1e-9 * h:
            break
        g.at = at  # a first try that did not find it again has left none
        if e.model.kinks + e.model.slide_kinks == 0 or kink_there(e, g) == NONE:
            made = retry(e, end)
            if e.step.off > 1.0:
                return shorten(e, g)
            if made != OK:
                return REFUSED
        else:
            # the rates may jump just there, of which this error is to know nothing
            retry(e, at - past * (at - e.step.t0))
            if e.step.off > 1.0:
                return shorten(e, g)
            if retry(e, end) != OK:
                return as_led(e, g)
        if locate(e, g) != OK:
            return find_within(e, g)
        if g.at < math.inf:
            begins = g.at - e.step.t0 <= room and at - e.step.t0 > room
            if begins and is_kink_alone(e, g):
                # what rests on a kink lies beside it by what stages are off, up to this one
                g.looked = math.nan
                g.at = at
                return OK
            return closer(e, g)
    if knows_ends(e) and e.step.t1 != longest and about and not is_lost(e, g):
        # the step that ends there has the motion itself, in which no guard holds up to there
        return OK
    # the instant was not found again: the step as it was
    if e.step.t1 != longest and retry(e, longest) != OK:
        return as_led(e, g)
    if about and locate(e, g) != OK:
        return REFUSED
    if not about or g.at == math.inf:
        g.at = at
    return OK


def is_lost(e: Engine, g: Locator) -> bool:
    """Whether what a step moves something by is lost in the last place of that, at a threshold.

    A step that ends sooner than the next number is no nearer to a guard, nor are those after it.
    What stands still elsewhere, as what is large and not connected, is no matter of a guard.
    """
    s = e.step
    stands = False
    for k in range(e.states):
        stands = stands or (s.y1[k] == s.y0[k] and s.f0[k] != 0.0 and s.y0[k] != 0.0)
    if not stands:
        return False
    lost = False
    for k in range(g.guards):
        for a in range(g.atom_first[k], g.atom_first[k + 1]):
            before = atom_at(e, g, a, s.t0)
            there = atom_at(e, g, a, s.t1)
            near = math.fabs(there) <= AT_RIM * ROUNDING * terms_here(e, g, k, a)
            lost = lost or (near and there == before)
    return lost


def closer(e: Engine, g: Locator) -> int:
    """Repeat a step in which a guard holds long before its end, until one ends where it does.

    Of what has all but died away a polynomial that satisfies the tolerance knows nothing; at the
    end of a step that is propagated is what is left of it. Where that is rounding, within an
    instant, or no other number, the guard begins where the longer step has it: others would lead
    nowhere.
    """
    if not knows_ends(e):
        return OK
    for _ in range(SHORTER):
        if g.at >= e.step.t1 - NEARLY * (e.step.t1 - e.step.t0):
            break
        end = g.at + 1e-6 * (g.at - e.step.t0)
        if end - e.step.t0 <= NO_TIME * e.span:
            break
        longer = e.step.t1
        if retry(e, end) != OK or locate(e, g) != OK:
            return REFUSED
        if g.at == math.inf:
            within = e.step.t1 - e.step.t0 <= room_of_instant(e, e.step.t0)
            if (within and ends_in_rounding(e, g)) or is_lost(e, g):
                return locate(e, g) if retry(e, longer) == OK else REFUSED
            break
    return OK


def shorten(e: Engine, g: Locator) -> int:
    """Repeat a step that its error forbids, shorter, and look whether a guard holds in it."""
    if by_radau(e):
        return as_led(e, g)
    h = e.step.t1 - e.step.t0
    made = REFUSED
    for _ in range(SHORTER):
        h *= 0.5
        if e.step.t0 + h == e.step.t0:
            return no_shorter(e)
        made = retry(e, e.step.t0 + h)
        if e.step.off <= 1.0:
            break
    if made != OK:
        return REFUSED
    if locate(e, g) != OK:
        return REFUSED
    if g.at < math.inf:
        return land_first(e, g, room_of_instant(e, e.t))
    return OK


def is_led(e: Engine) -> bool:
    """Whether the step ends where shorter ones have led, and not where it was to end."""
    led = by_radau(e) and e.step.off > 1.0 and e.step.t1 > e.step.t0
    e.refusal = e.refusal and not led
    return led


def as_led(e: Engine, g: Locator) -> int:
    """Let the step end where shorter ones have led that were too many, and look for a guard there.

    What is left of the way is for the run.
    """
    if not is_led(e) or (locate(e, g) != OK and find_within(e, g) != OK):
        return REFUSED
    return land_first(e, g, room_of_instant(e, e.t)) if g.at < math.inf else OK
