"""Laws with several solutions: a motion follows one of them, and says where that ends.

Newton's method may end at any of them, and where no storage feels which, nothing else would tell:
a value that guards read would hop. So one goes from the begin of each step to its end by as short
parts as that needs. In each of them the first step of Newton's method leads nearly all the way,
slopes do not turn, and half way the laws nearly hold on the straight line. Where no part is short
enough the solution has ended, as at a fold; that is noted where the motion goes on beyond it.

Source: P. Deuflhard, *Newton Methods for Nonlinear Problems*, 2004, chapter 5.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit
from hybond.engine.algebra.products import copy_part
from hybond.engine.checks.another import element_of
from hybond.engine.engine import OK, Engine
from hybond.engine.methods.stepping import between
from hybond.engine.mode.mode_records import Mode
from hybond.engine.mode.nonlinear.branch import (
    forget_points,
    groups_of,
    know,
    put_point,
    step_from,
    take_signs,
    take_unknowns,
)
from hybond.engine.mode.nonlinear.newton import keep_guess
from hybond.engine.mode.nonlinear.newton_system import largest_of
from hybond.engine.mode.nonlinear.several import may_have_several
from hybond.engine.mode.rows.storage_bonds import rate_bond
from hybond.engine.mode.solving import solve_in_step
from hybond.engine.reasons.noting import ENDS, MANY, note_violation
from hybond.engine.reasons.warned import ROOT, add_about, begin_warning
from hybond.engine.run.others_told import is_as_before, see_chosen, see_left
from hybond.engine.surfaces.values import set_motion
from hybond.engine.words import Floats

AGAIN: Final = 8
"""Times in a step that rows may be eliminated anew, which parts are begun again for."""
STRAIGHT: Final = 0.25
"""The part of Newton's first step by which all others together may lead elsewhere."""
STILL: Final = 1e-7
STILL_OF_ALL: Final = 1e-10
"""Part of an unknown, and of the largest, by which it has not moved at all."""
ROUNDED: Final = 1e-12
"""Likewise, of what is known: where Newton's method ends."""
LEAST: Final = 2.0**-44
"""The shortest part of a step."""
CORNER: Final = 2.0**-34
CONTINUOUS: Final = 1e-3
"""Parts shorter than that move no unknown by more than this part of the largest, nor do they have
to be straight: there may be a corner of a law."""
JUMPS: Final = 1e-3
"""What is known jumps if the shortest part moves it by more than this part of the whole step."""
BLUR: Final = 2.0**-30
"""Part of a step by which the end of a solution is blurred: laws are as good as flat there."""
APART: Final = 1e-3
"""How far apart two solutions are, as a part of the largest variable of the kind."""


def begin_to_follow(e: Engine, again: bool) -> None:
    """Take the solution that laws have where the motion begins for the one to follow.

    Where a run goes on `again` from where the last step of another began, that one's.
    """
    mode = e.mode
    b = mode.branch
    e.work.following.jumped_at = math.inf
    given = e.root_given
    came = given or e.root_known != 0.0
    if came:
        # what another run hands on, or what was followed before an event
        keep_guess(mode, e.root_before if again and e.root_given else e.root_now)
    e.root_given = False
    e.root_known = 0.0
    # what a run moves by that is unsound already is nothing to follow
    b.known = False
    if e.slide.k > 0 or e.checks.violated > 0:
        see_left(e)
        return
    set_motion(e, e.v, e.t, e.y)
    if not may_have_several(e, mode):
        see_left(e)
        return
    if b.points > 0 and (e.t < b.when.at[0] or e.t > b.when.at[b.points - 1]):
        forget_points(mode)
    e.work.following.rated = False
    b.known = solves_at(e, e.t, e.y)
    b.ended = False
    b.points = 0
    if b.known:
        put_point(e, mode, e.t)
        came = given or (came and is_as_before(e, e.root_now))
        keep_root(e)
        if not came:
            see_chosen(e)


def solves_at(e: Engine, t: float, y: Floats) -> bool:
    """Whether laws have a solution at a time, with the state; nothing is refused."""
    refused = e.refusal
    set_motion(e, e.v, t, y)
    found = solve_in_step(e, e.mode, e.v) == OK
    e.refusal = refused
    return found


def follow_roots(e: Engine) -> None:
    """Follow the solution through the last step."""
    s = e.step
    mode = e.mode
    b = mode.branch
    e.work.following.jumped_at = math.inf
    b.known = b.known and e.checks.violated == 0
    if not b.known or e.slide.k > 0:
        return
    n = 2 * e.model.bonds
    # what the step itself has moved by
    on_it = b.points > 0 and not b.ended
    b.known = False
    came = solves_at(e, s.t1, s.y1)
    fit(b.own, n)
    copy_part(n, e.work.w, 0, b.own.at, 0)
    b.known = b.points > 0 and s.t0 >= b.when.at[0] and s.t0 <= b.when.at[b.points - 1]
    found = solves_at(e, s.t0, s.y0)
    b.known = found
    b.points = 0
    b.ended = False
    if not found:
        return
    put_point(e, mode, s.t0)
    begin_signs(e, mode)
    gone = s.t0
    part = s.t1 - s.t0
    least = LEAST * part
    again = 0
    while gone < s.t1 and not b.ended:
        t = min(gone + part, s.t1)
        basis = b.basis
        middle = gone + 0.5 * (t - gone)
        shortest = t - gone <= 2.0 * least or middle <= gone or middle >= t
        if goes_straight(e, mode, gone, t):
            take_rate(e, mode, t - gone)
            put_point(e, mode, t)
            gone = t
            part *= 2.0
        elif shortest and jumps(e, mode, t):
            e.work.following.rated = False
            e.work.following.jumped_at = t
            gone = t
            part *= 2.0
            if e.model.laws > 0:
                # which branches of junctions hold behind it is not settled yet
                b.points = 0
                gone = s.t1
            elif solves_at(e, t, e.work.following.y.at):
                put_point(e, mode, t)
            else:
                b.ended = True
        elif b.basis != basis and again < AGAIN:
            # rows were eliminated anew: what slopes are by, and the sign of their determinant
            e.work.following.rated = False
            again += 1
            begin_signs(e, mode)
        elif shortest and is_flat(e, mode):
            # from rest a flow may go as a root of time: what comes of it is followed from there on
            b.points = 0
            gone = s.t1
        elif shortest:
            b.ended = True
        else:
            part = 0.5 * (t - gone)
    if not b.ended and on_it and came and b.points > 0:
        see_what_moved(e, mode)


def is_flat(e: Engine, mode: Mode) -> bool:
    """Whether slopes at the last point leave something free, as of an orifice that is shut.

    There laws have no solution that could be followed to another one; it is as short as it may be.
    """
    for g in range(groups_of(mode)):
        if e.work.following.sign.at[g] == 0.0:
            return True
    return False


def begin_signs(e: Engine, mode: Mode) -> None:
    """Take the signs of slopes at the last point."""
    b = mode.branch
    f = e.work.following
    write_at(e, b.when.at[b.points - 1])
    fit(f.sign, groups_of(mode))
    fit(f.now, groups_of(mode))
    for g in range(groups_of(mode)):
        f.sign.at[g] = 0.0
    fit(f.here, mode.finite_frees)
    take_unknowns(e, mode, f.here.at)
    know(e, mode, e.v)
    if step_from(e, mode, e.v, f.here.at):
        take_signs(e, mode, f.sign.at)


def turns(e: Engine, mode: Mode) -> bool:
    """Whether slopes have another sign after the last step of Newton's than at the last point."""
    f = e.work.following
    take_signs(e, mode, f.now.at)
    for g in range(groups_of(mode)):
        if f.sign.at[g] * f.now.at[g] < 0.0:
            return True
    return False


def write_at(e: Engine, t: float) -> None:
    """Write what the motion is at a time of the step, but for bond variables."""
    f = e.work.following
    fit(f.y, e.states)
    between(e, t, f.y.at)
    set_motion(e, e.v, t, f.y.at)


def goes_straight(e: Engine, mode: Mode, t0: float, t1: float) -> bool:
    """Whether the solution goes from the last point to a time as good as straight; it is in `w`.

    It leads there by the rate of the last part, if one is known, or by Newton's first step. Behind
    a steep law that saturates that step is far too long: what is known has moved, and the unknown
    that keeps the law from saturating has not yet.
    """
    basis = mode.branch.basis
    if e.work.following.rated:
        if leads_straight(e, mode, t0, t1, True):
            return True
        if mode.branch.basis != basis:
            return False
    return leads_straight(e, mode, t0, t1, False)


def leads_straight(e: Engine, mode: Mode, t0: float, t1: float, by_rate: bool) -> bool:
    """Whether it does by the rate of the last part; else by Newton's first step."""
    b = mode.branch
    f = e.work.following
    basis = b.basis
    frees = mode.finite_frees
    fit(f.here, frees)
    fit(f.first, frees)
    fit(f.there, frees)
    fit(f.middle, frees)
    fit(f.signs_there, groups_of(mode))
    take_unknowns(e, mode, f.here.at)
    write_at(e, t1)
    know(e, mode, e.v)
    if by_rate:
        for j in range(frees):
            f.first.at[j] = f.here.at[j] + (t1 - t0) * f.rate.at[j]
    elif step_from(e, mode, e.v, f.here.at):
        for j in range(frees):
            f.first.at[j] = f.here.at[j] - e.work.step.at[j]
    else:
        return False
    keep_first(mode, f.first.at)
    if not math.isfinite(largest_of(frees, f.first.at)) or not solves_at(e, t1, f.y.at):
        return False
    if b.basis != basis:
        return False
    n = 2 * e.model.bonds
    fit(f.found, n)
    copy_part(n, e.work.w, 0, f.found.at, 0)
    for j in range(frees):
        f.there.at[j] = e.work.w[mode.free_column[j]]
    know(e, mode, e.v)
    if not step_from(e, mode, e.v, f.there.at):
        return False
    if turns(e, mode):
        return False
    copy_part(groups_of(mode), f.now.at, 0, f.signs_there.at, 0)
    if t1 - t0 <= CORNER * (e.step.t1 - e.step.t0):
        if not is_next_to(e, mode):
            return False
    elif not is_straight(e, mode, t0, t1):
        return False
    for g in range(groups_of(mode)):
        if f.signs_there.at[g] != 0.0:
            f.sign.at[g] = f.signs_there.at[g]
    # what was looked at, and no other
    copy_part(n, f.found.at, 0, e.work.w, 0)
    keep_guess(mode, e.work.w)
    return True


def keep_first(mode: Mode, first: Floats) -> None:
    """Let Newton's method begin at unknowns."""
    for j in range(mode.finite_frees):
        mode.guess.at[j] = first[j]
    mode.guessed = True


def take_rate(e: Engine, mode: Mode, part: float) -> None:
    """Take the rates at which unknowns went through the part that was just found."""
    f = e.work.following
    f.rated = part > 0.0
    fit(f.rate, mode.finite_frees)
    for j in range(mode.finite_frees if f.rated else 0):
        f.rate.at[j] = (f.there.at[j] - f.here.at[j]) / part
        f.rated = f.rated and math.isfinite(f.rate.at[j])


def is_straight(e: Engine, mode: Mode, t0: float, t1: float) -> bool:
    """Whether what was tried first is nearly all of the way, and laws nearly hold half way."""
    f = e.work.following
    frees = mode.finite_frees
    least = STILL_OF_ALL * largest_of(frees, f.there.at)
    least += ROUNDED * largest_of(2 * e.model.bonds, e.work.base)
    for j in range(frees):
        off = math.fabs(f.there.at[j] - f.first.at[j])
        may = STRAIGHT * math.fabs(f.first.at[j] - f.here.at[j])
        if not off <= may + STILL * math.fabs(f.there.at[j]) + least:
            return False
        f.middle.at[j] = 0.5 * (f.here.at[j] + f.there.at[j])
    write_at(e, t0 + 0.5 * (t1 - t0))
    know(e, mode, e.v)
    straight = step_from(e, mode, e.v, f.middle.at)
    straight = straight and not turns(e, mode)
    for j in range(frees):
        off = math.fabs(e.work.step.at[j])
        may = STRAIGHT * math.fabs(f.there.at[j] - f.here.at[j])
        straight = straight and off <= may + STILL * math.fabs(f.there.at[j]) + least
    write_at(e, t1)
    return straight


def is_next_to(e: Engine, mode: Mode) -> bool:
    """Whether no unknown has moved by much of the largest."""
    f = e.work.following
    most = CONTINUOUS * largest_of(mode.finite_frees, f.there.at)
    most += ROUNDED * largest_of(2 * e.model.bonds, e.work.base)
    for j in range(mode.finite_frees):
        if not math.fabs(f.there.at[j] - f.here.at[j]) <= most:
            return False
    return True


def jumps(e: Engine, mode: Mode, t: float) -> bool:
    """Whether it is what is known that jumps just before a time, as a source does.

    A source shows in the bond variables as they are with all unknowns at zero.
    """
    m = e.model
    b = mode.branch
    f = e.work.following
    s = e.step
    n = m.bond_slot + 2 * m.bonds
    fit(f.known_here, 4 * n)
    at = f.known_here.at
    for look in range(4):
        when = s.t0 if look == 0 else s.t1 if look == 1 else t
        write_at(e, b.when.at[b.points - 1] if look == 2 else when)
        know(e, mode, e.v)
        copy_part(m.bond_slot, e.v, 0, at, look * n)
        copy_part(2 * m.bonds, e.work.base, 0, at, look * n + m.bond_slot)
    for k in range(1, n):
        whole = math.fabs(at[n + k] - at[k])
        if math.fabs(at[3 * n + k] - at[2 * n + k]) > JUMPS * whole:
            return True
    return False


def see_what_moved(e: Engine, mode: Mode) -> None:
    """Note it if the step has moved what is stored by another solution than the one followed."""
    m = e.model
    b = mode.branch
    n = 2 * m.bonds
    at = (b.points - 1) * n
    off = 0.0
    size = 0.0
    for k in range(m.storages):
        r = rate_bond(m, k)
        apart = math.fabs(b.root.at[at + r] - b.own.at[r])
        most = max(e.checks.largest[m.bond_class[r]], math.fabs(b.own.at[r]))
        if apart > APART * most and apart > off:
            off = apart
            size = most
    if off > 0.0:
        note_violation(e, mode, e.step.t1, MANY, element_of(e, mode), off, size)


def tell_root(e: Engine, t: float) -> None:
    """Tell who looks into the motion what the solution is at a time, as was just found."""
    if e.model.tells == 0:
        return
    begin_warning(e.warned, ROOT, t)
    for k in range(2 * e.model.bonds):
        add_about(e.warned, e.work.w[k])


def note_roots(e: Engine) -> None:
    """Tell of the solution up to where the motion is, and note it if that is beyond its end."""
    b = e.mode.branch
    if not b.known:
        see_left(e)
        return
    n = 2 * e.model.bonds
    for p in range(1, b.points):
        if b.when.at[p] < e.t:
            copy_part(n, b.root.at, p * n, e.work.w, 0)
            tell_root(e, b.when.at[p])
    if solves_at(e, e.t, e.y):
        keep_root(e)
        if e.t >= e.work.following.jumped_at:
            see_chosen(e)
    see_end(e)


def keep_root(e: Engine) -> None:
    """Keep the solution just found where the motion is, for a run that goes on, and tell of it."""
    n = 2 * e.model.bonds
    e.root_known = 1.0
    e.roots_kept += 1.0
    e.mode.branch.since = e.roots_kept
    copy_part(n, e.work.w, 0, e.root_now, 0)
    copy_part(n, e.mode.branch.root.at, 0, e.root_before, 0)
    tell_root(e, e.t)


def see_end(e: Engine) -> None:
    """Note it if the motion has gone on beyond where the solution that it followed ends."""
    mode = e.mode
    b = mode.branch
    if not b.ended:
        return
    blur = BLUR * (e.step.t1 - e.step.t0)
    if not e.t > b.when.at[b.points - 1] - blur:
        return
    n = 2 * e.model.bonds
    at = (b.points - 1) * n
    off = 0.0
    size = 0.0
    for j in range(mode.finite_frees):
        k = mode.free_column[j]
        apart = math.fabs(b.own.at[k] - b.root.at[at + k])
        if apart >= off:
            off = apart
            size = math.fabs(b.root.at[at + k])
    note_violation(e, mode, b.when.at[b.points - 1], ENDS, element_of(e, mode), off, size)
