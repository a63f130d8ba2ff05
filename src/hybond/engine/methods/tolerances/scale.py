"""The tolerance of each state, from the size that it has and lately had."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.products import copy_floats, copy_part
from hybond.engine.algebra.rounding import EPSILON
from hybond.engine.answers import value
from hybond.engine.engine import OK, Engine
from hybond.engine.methods.tolerances.moment_later import come_back, look_later
from hybond.engine.methods.tolerances.pushes import forget_pushes, see_pushes
from hybond.engine.methods.tolerances.signal_sizes import (
    allowed_signal,
    begin_signals,
    forget_rounding,
    measure_rates,
)
from hybond.engine.mode.digits.closely import lasting_size
from hybond.engine.mode.digits.clusters import MOMENT
from hybond.engine.mode.digits.part_energies import see_part
from hybond.engine.mode.digits.reach import holds, most_held
from hybond.engine.mode.digits.sizes import given_size, size_of
from hybond.engine.mode.mode_records import Mode, is_constrained
from hybond.engine.mode.nonlinear.guess import give_back_guess, hold_guess
from hybond.engine.mode.rows.storage import own_stiffness, with_stored
from hybond.engine.mode.rows.storage_bonds import rate_bond
from hybond.engine.mode.solving import solve
from hybond.engine.surfaces.values import field, set_state
from hybond.engine.words import Floats

NEGLIGIBLE: Final = 1e-6
"""A stored quantity is measured against at least this share of what the energy of its part of the
graph would make of it, so that rounding in an idle storage does not steer the step size."""
CLEAR: Final = 1e3
"""A stored quantity that is more than so many times what the rounding of its rate adds up to over
the whole run is not rounding: ..."""
BESIDE: Final = 1e3
"""... it is measured against no more than so many times its own size, however much energy there is
beside it."""
FAINT: Final = 1e-150
"""What is stored is measured against no less, in SI: the square of less is no number, so that it
has no energy. What grows from nothing by a power of time, or behind a steep law, would be followed
through all numbers that there are."""
ROUNDED: Final = 10.0 * EPSILON
"""Part of its terms that the rate of a stored quantity may be off by."""
SHORT: Final = MOMENT
"""Part of the run in which what that adds up to is no error, nor is it in a step, if that is more:
what is held at zero has a rate that is nothing else."""

ALONE: Final = 2.0
"""Times the slopes on all others that a state's own is at least where it settles by itself."""
SEEN: Final = 1e3
"""Times the rounding that is left of a state is its tolerance at least: iterations end at a part
of the tolerance, and that is to be more than rounding."""
CREEPS: Final = 1e-4
"""Part of the run below which a step that is too long may be so by rounding alone."""


def start_scale(e: Engine, mode: Mode) -> None:
    """Learn what the rates of stored quantities cancel from, where motion starts.

    From rest, rates may be nothing but rounding of these terms: then no step is small enough to be
    right to a part of what it adds. Where nothing has been stored yet, the terms of a moment later
    count as well: what pushes may begin at zero, or at what rounding of the time leaves of it. So
    do those where what moves will be then: two bodies that fall side by side have no speeds yet,
    and what is between them will be the rounding of their difference.
    """
    for k in range(e.model.storages):
        e.rate_noise[k] = 0.0
    forget_settling(e)
    forget_pushes(e)
    soon = SHORT * e.span
    if e.next_break < math.inf:
        soon = min(soon, 0.5 * (e.next_break - e.t))
    m = e.model
    forget_rounding(e)
    found = found_terms(e, mode, e.t, e.y)
    if not found or is_unmoved(e):
        copy_floats(m.storages, e.rounding, e.work.reach)
        find_still(e, found)
        look_later(e, mode)
        found_terms(e, mode, e.t + soon, e.y)
        come_back(e, mode)
        for k in range(m.storages):
            if e.work.part_still[e.storage_part[k]] != 0:
                e.rounding[k] = max(e.work.reach[k], e.rounding[k])
            else:
                e.rounding[k] = e.work.reach[k]
    find_moved_terms(e, mode, soon)
    begin_signals(e, mode, soon)
    if m.laws > 0:
        see_pushes(e, mode)
        for p in range(e.parts):
            pushed = e.work.part_here[p]
            e.energy = max(e.energy, pushed)
            see_part(e, p, pushed)
            e.scale_energy[p] = max(e.scale_energy[p], pushed)


def is_unmoved(e: Engine) -> bool:
    """Whether nothing has been stored yet on a part."""
    m = e.model
    for k in range(m.storages):
        if e.scale_energy[e.storage_part[k]] == 0.0:
            return True
    return m.storages == 0


def find_still(e: Engine, found: bool) -> None:
    """Note the parts on which nothing has been stored yet, or nothing pushes."""
    m = e.model
    still = e.work.part_still
    for i in range(e.parts):
        still[i] = 1
    for k in range(m.storages if found else 0):
        if e.rounding[k] > 0.0 and e.scale_energy[e.storage_part[k]] != 0.0:
            still[e.storage_part[k]] = 0


def forget_settling(e: Engine) -> None:
    """Know of no state how soon it settles."""
    for k in range(e.model.storages):
        e.settled[k] = math.inf


def know_settling(e: Engine, jacobian: Floats) -> None:
    """Learn what rounding of its rate leaves of a state that the rate itself brings back.

    It adds up for no longer than that takes: a capacitor of 1 pF behind 1 microhm is off by the
    rounding of its voltage, however long the run is. Two that are joined by it settle together, but
    what both have does not; their slopes on each other are as large as their own. Beside edges and
    limits of laws slopes are without bound, and say nothing of what a state has a moment later.
    """
    m = e.model
    n = e.states
    steep = m.edges > 0 or m.begins > 0 or m.bends > 0.0
    for k in range(m.storages):
        own = -jacobian[k * n + k]
        others = 0.0
        for j in range(n):
            others += math.fabs(jacobian[k * n + j]) if j != k else 0.0
        known = own > ALONE * others and e.rate_noise[k] > 0.0 and not steep
        e.settled[k] = SEEN * e.rate_noise[k] / own if known else math.inf


def find_moved_terms(e: Engine, mode: Mode, soon: float) -> None:
    """Learn what rates that cancel from nothing yet will cancel from, a moment later."""
    m = e.model
    none = False
    for k in range(m.storages):
        e.moved_rounding[k] = 0.0
        none = none or e.rounding[k] == 0.0
    if not none:
        return
    look_later(e, mode)
    refusal = e.refusal
    asked = e.evaluations
    if field(e, mode, e.t + soon, e.y, e.step.rate) == OK:
        for k in range(e.states):
            e.step.trial[k] = e.y[k] + soon * e.step.rate[k]
        copy_floats(m.storages, e.rounding, e.work.reach)
        found_terms(e, mode, e.t + soon, e.step.trial)
        for k in range(m.storages):
            if e.work.reach[k] == 0.0 and e.rounding[k] < math.inf:
                e.moved_rounding[k] = e.rounding[k]
            e.rounding[k] = e.work.reach[k]
    e.evaluations = asked
    e.refusal = refusal
    come_back(e, mode)


def found_terms(e: Engine, mode: Mode, t: float, y: Floats) -> bool:
    """Put the rounding of what rates cancel from at `t` there; False if there is nothing.

    What moves anything clearly acts for no longer than it takes to move what is stored: a force
    that stops a body in no time is over by then, and its rounding none of what the body does later.
    It is what the time itself is rounded by at the least.
    """
    m = e.model
    set_state(e, mode, e.v, t, y)
    if solve(e, mode, e.v) != OK:
        return False
    found = False
    for k in range(mode.sources):
        source = mode.source[k]
        if source >= 0 and m.source_size[source] >= 0:
            # a source that is zero may be a difference of what is large
            given = value(m, m.source_size[source], e.v)
            if math.isfinite(given):
                e.work.xi[m.storages + k] = given
    soonest = e.work.part_tried
    for i in range(e.parts):
        soonest[i] = SHORT * e.span
    for k in range(m.storages):
        i = e.storage_part[k]
        at = rate_bond(m, k)
        e.rounding[k] = size_of(e, mode, at, e.work.xi, e.v)
        e.rate_noise[k] = max(e.rate_noise[k], ROUNDED * e.rounding[k])
        found = found or e.rounding[k] > 0.0
        if moves_clearly(e, at, e.rounding[k]) and y[k] != 0.0:
            soonest[i] = min(soonest[i], math.fabs(y[k] / e.work.w[at]))
    for k in range(m.storages):
        at = rate_bond(m, k)
        acts = SHORT * e.span
        if moves_clearly(e, at, e.rounding[k]):
            first = soonest[e.storage_part[k]]
            own = first if y[k] == 0.0 else math.fabs(y[k] / e.work.w[at])
            acts = min(acts, max(own, math.fabs(e.t) * EPSILON / ROUNDED))
        e.push_alone[k] = max(e.push_alone[k], acts * given_size(e, mode, at, e.work.xi))
        if mode.closely and e.slide.k == 0:
            e.rounding[k] = ROUNDED * lasting_size(e, mode, k, at, acts)
        else:
            e.rounding[k] = ROUNDED * acts * e.rounding[k]
    if e.model.integrals > 0 and e.slide.k == 0:
        measure_rates(e, mode, t)
    return found


def moves_clearly(e: Engine, rate: int, size: float) -> bool:
    """Whether a bond variable, the rate of a storage, is more than rounding of terms of a size."""
    return math.fabs(e.work.w[rate]) > CLEAR * ROUNDED * size


def measure_again(e: Engine, mode: Mode) -> None:
    """Learn once more what rates cancel from, at the beginning of a step that was too long.

    A source that begins at zero has pushed by next to nothing where motion started.
    """
    before = e.work.reach
    copy_floats(e.model.storages, e.rounding, before)
    measure_anew(e, mode)
    for k in range(e.model.storages):
        e.rounding[k] = max(before[k], e.rounding[k])
    measure_behind(e, mode)


def measure_behind(e: Engine, mode: Mode) -> None:
    """Learn how well states are known that nothing moves yet but the rounding of others.

    A pulse may begin as rounding of what it is the difference of: a capacitor behind another then
    has what that leaves of the first one in a moment, or for as long as it takes to settle there.
    """
    m = e.model
    y = e.step.trial
    here = e.work.ahead
    soon = e.work.part_tried
    refusal = e.refusal
    hold_guess(e, mode)
    left = m.storages
    while left > 0:
        left -= 1
        none = False
        for k in range(m.storages):
            none = none or (e.rounding[k] == 0.0 and e.moved_rounding[k] == 0.0)
        if not none or field(e, mode, e.step.t, e.step.y, e.step.rate) != OK:
            break
        copy_floats(m.storages, e.step.rate, here)
        copy_floats(e.states, e.step.y, y)
        for k in range(m.storages):
            y[k] += known_to(e, k)
        if field(e, mode, e.step.t, y, e.step.rate) != OK:
            break
        for i in range(e.parts):
            soon[i] = SHORT * e.span
        for k in range(m.storages):
            here[k] = math.fabs(e.step.rate[k] - here[k])
            i = e.storage_part[k]
            if known_to(e, k) < here[k] * soon[i]:
                soon[i] = known_to(e, k) / here[k] if known_to(e, k) > 0.0 else soon[i]
        found = False
        for k in range(m.storages):
            off = soon[e.storage_part[k]] * here[k]
            if known_to(e, k) == 0.0 and off > 0.0 and math.isfinite(off):
                e.rounding[k] = off
                e.rate_noise[k] = max(e.rate_noise[k], here[k])
                found = True
        if not found:
            break
    give_back_guess(e, mode)
    e.refusal = refusal


def known_to(e: Engine, k: int) -> float:
    """Return how well a stored quantity is known."""
    off = max(e.rounding[k], e.moved_rounding[k])
    return off if math.isfinite(off) else 0.0


def sum_closely_on(e: Engine, mode: Mode) -> None:
    """Let rates of a mode be summed with all digits from here: they are known better then.

    Of storages that hold nothing yet, and do not move, as before.
    """
    mode.closely = True
    before = e.work.reach
    copy_floats(e.model.storages, e.rounding, before)
    measure_anew(e, mode)
    for k in range(e.model.storages):
        if e.rounding[k] == 0.0 and e.y[k] == 0.0:
            e.rounding[k] = before[k]


def measure_ahead(e: Engine, mode: Mode, t: float) -> None:
    """Learn what rates will cancel from at the top of a pulse to come, in the state as it is.

    Before it nothing is measured by what there is of it, the last e-folds above no number at all.
    """
    before = e.work.reach
    refusal = e.refusal
    copy_floats(e.model.storages, e.rounding, before)
    hold_guess(e, mode)
    forget_pushes(e)
    found_terms(e, mode, t, e.y)
    give_back_guess(e, mode)
    for k in range(e.model.storages):
        bounded = math.isfinite(e.rounding[k])
        e.rounding[k] = max(before[k], e.rounding[k] if bounded else 0.0)
    see_pushes(e, mode)
    e.refusal = refusal


def measure_anew(e: Engine, mode: Mode) -> None:
    """Learn what rates cancel from where a step begins, and forget what was before."""
    refusal = e.refusal
    hold_guess(e, mode)
    found_terms(e, mode, e.step.t, e.y)
    give_back_guess(e, mode)
    e.refusal = refusal


def tolerance(e: Engine, y0: Floats, y1: Floats, out: Floats) -> None:
    """Put the error that a step from `y0` to `y1` may make into `out`."""
    for k in range(e.states):
        # what a rejected step tried must not loosen the tolerance for good
        size = math.fabs(y0[k])
        e.largest_state[k] = max(e.largest_state[k], size)
        e.lately[k] = max(e.lately[k], size)
        out[k] = max(math.fabs(y1[k]), e.lately[k])
    energy = e.work.lately_energy
    for i in range(e.parts):
        root = e.lately[e.states + i]
        energy[i] = root * root
    allow(e, y0, y1, energy, out)


def widest_tolerance(e: Engine, y: Floats, out: Floats) -> None:
    """Put the error there that a step may make at `y`, beside all that states have ever been."""
    for k in range(e.states):
        out[k] = max(math.fabs(y[k]), e.largest_state[k])
    allow(e, y, y, e.scale_energy, out)


def allow(e: Engine, y0: Floats, y1: Floats, energy: Floats, out: Floats) -> None:
    """Put the error that a step may make there in place of what each state is measured by."""
    m = e.model
    if m.atol == m.atol:
        for k in range(e.states):
            out[k] = m.rtol * out[k] + m.atol
        for k in range(m.storages):
            out[k] = min(out[k], e.step.narrow[k])
        return
    v = e.work.values
    own = e.work.ahead
    copy_part(m.storages, y0, 0, v, m.stored_slot)
    here = e.work.part_here
    tried = e.work.part_tried
    for i in range(e.parts):
        here[i] = 0.0
        tried[i] = 0.0
    for k in range(m.storages):
        i = e.storage_part[k]
        own[k] = math.fabs(own_stiffness(m, k, v))
        here[i] += own[k] * y0[k] * y0[k]
        tried[i] += own[k] * (y1[k] * y1[k])
    for i in range(e.parts):
        e.scale_energy[i] = max(e.scale_energy[i], 0.5 * here[i])
        here[i] = max(max(energy[i], e.pushed_energy[i]), 0.5 * max(here[i], tried[i]))
    moments = max(e.step.tried / (SHORT * e.span), 1.0) if e.step.tried > 0.0 else 1.0
    begins = e.step.t < e.step.onset_end
    # what a modulus ties may be rounding of the modulus, which no rate shows
    turns = e.mode.dynamics > 0 and is_constrained(e.mode)
    for k in range(m.storages):
        moved = out[k] > 0.0
        most = here[e.storage_part[k]]
        floor = 0.0
        if own[k] > 0.0 and math.isfinite(own[k]) and math.isfinite(most):
            floor = NEGLIGIBLE * math.sqrt(2.0 * most / own[k])
            if floor > out[k] and m.co_energy[k] >= 0:
                floor = within_law(e, k, v, floor, most)
            clear = e.rounding[k] > 0.0 and out[k] > CLEAR * e.rounding[k] / SHORT
            if clear and not turns:
                floor = min(floor, BESIDE * out[k])
        out[k] = m.rtol * max(out[k], floor if math.isfinite(floor) else 0.0)
        if begins and e.step.onset[k] > 0.0:
            out[k] = max(out[k], m.rtol * e.step.onset[k])
            # what grows by rounding alone has not moved
            moved = moved or m.rtol * e.step.onset[k] > max(e.rounding[k], e.moved_rounding[k])
        # what has not moved yet has no size: the solver chooses its first step without it
        if moved:
            own_rounding = e.rounding[k] if e.step.solved else moments * e.rounding[k]
            if e.moved_rounding[k] > 0.0:
                # what is between motions is not what slows them
                own_rounding = moments * max(e.rounding[k], e.moved_rounding[k])
            own_rounding = min(own_rounding, e.settled[k])
            if e.step.tried > 0.0 and not e.step.solved:
                # an explicit step adds what it lasts for: else what is unstable seems no error
                own_rounding = min(own_rounding, SEEN * e.rate_noise[k] * e.step.tried)
            e.noise_matters = e.noise_matters or own_rounding > out[k]
            out[k] = max(max(out[k], own_rounding), m.rtol * FAINT)
        out[k] = min(out[k], max(e.step.narrow[k], ROUNDED * math.fabs(y0[k])))
    for k in range(m.storages, e.states):
        size = max(out[k], e.step.onset[k]) if begins else out[k]
        out[k] = allowed_signal(e, k, math.fabs(y1[k] - y0[k]), size)


def within_law(e: Engine, k: int, v: Floats, floor: float, energy: float) -> float:
    """Return a share of what storage k would hold with an energy, by its law if slopes say nothing.

    Far up an exponential there is next to no slope beside that of where it has been: by its slope
    at rest not even the share is anything that it could hold, and nothing of what it does would be
    an error.
    """
    if not math.isfinite(floor):
        return floor
    m = e.model
    now = v[m.stored_slot + k]
    if not holds(e, k, v, floor, energy):
        floor = NEGLIGIBLE * most_held(e, k, v, floor, energy)
    v[m.stored_slot + k] = now
    return floor


def within_bent(e: Engine, k: int, y: Floats, size: float) -> float:
    """Return the size at which a storage holds what it would at `size` if it stayed as soft.

    A spring that hardens has next to no stiffness beside rest: what energy would make of it by that
    is far beyond anything that it will ever be. Its stiffness is taken for a power in between.
    """
    now = math.fabs(y[k])
    if now == 0.0 or now >= size:
        return size
    m = e.model
    v = with_stored(e, y)
    own = math.fabs(own_stiffness(m, k, v))
    v[m.stored_slot + k] = math.copysign(size, y[k])
    there = math.fabs(own_stiffness(m, k, v))
    v[m.stored_slot + k] = y[k]
    if own == 0.0 or not (there > own and math.isfinite(there)):
        return size
    power = math.log(there / own) / math.log(size / now)
    return now * math.pow(size / now, 2.0 / (2.0 + power))


def controlled(n: int, scale: Floats) -> int:
    """Return how many components have a finite scale, at least 1."""
    many = 0
    for k in range(n):
        if scale[k] < math.inf:
            many += 1
    return max(many, 1)


def error_norm(n: int, error: Floats, scale: Floats) -> float:
    """Return the root mean square of ``error/scale`` over the controlled components.

    A component of scale 0 and error 0 counts as 0; scale 0 with an error gives infinity.
    """
    many = 0
    total = 0.0
    for k in range(n):
        if not scale[k] < math.inf:
            continue
        many += 1
        if scale[k] == 0.0:
            if error[k] != 0.0:
                total = math.inf if error[k] == error[k] else math.nan
            continue
        share = error[k] / scale[k]
        total += share * share
    return (
        math.sqrt(total / float(many))
        if many > 0 and total >= 0.0
        else (0.0 if many == 0 else math.nan)
    )
