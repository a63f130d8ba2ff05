"""Bond variables of a mode at one instant, in equations that keep their digits.

Elimination does not know how large bond variables will be. A flow through what resists next to
nothing may come out as the difference of two pressures a billion times as large: nothing of it is
left. What rounding of such differences hides of the laws that read them is told by `put_back`; if
that is too much, rows are eliminated anew, each for the largest of its terms.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import NOT_FINITE, OK, Engine, count_work
from hybond.engine.mode.digits.closely import closely, sum_closely
from hybond.engine.mode.equations import eliminate_by, level_of
from hybond.engine.mode.left_free.undetermined import least_of_free
from hybond.engine.mode.mode_records import Mode, Reads
from hybond.engine.mode.nonlinear.branch import begin_on_branch
from hybond.engine.mode.nonlinear.newton import by_knowns, keep_guess, knowns_of, newton
from hybond.engine.mode.nonlinear.newton_system import largest_of, measure_terms, write_bonds
from hybond.engine.mode.nonlinear.put_back import HIDDEN, UNIT, is_known
from hybond.engine.mode.reading import put_knowns, show_read
from hybond.engine.mode.rows.tableau import NOT_OPEN, part_of
from hybond.engine.words import Floats

ROUNDS: Final = 4
"""Times that rows are eliminated anew at one instant: what was nothing but rounding is known better
each time."""
RETURNS: Final = 24
"""Times that Newton begins anew with what was left free taken off: all numbers are within 1e616
of each other, and each time takes 16 digits off, or nearly."""
AFAR: Final = 1e6
"""Times the largest bond variable that an unknown was, so that the others have lost digits."""
BETTER: Final = 10.0
"""How many times more of a law is hidden than the last time before it is done again."""


def solve(e: Engine, mode: Mode, v: Floats) -> int:
    """Put the bond variables into `e.work.w` and write them into `v`.

    OK, or NOT_FINITE with a fault noted: HB-N301 if Newton does not converge, HB-N302 if a law has
    no value.
    """
    w = e.work.w
    if mode.dynamics == 0:
        count_work(e, 2 * e.model.bonds + mode.knowns)
        knowns_of(e, mode, v, True)
        closely(e, mode, mode.direct, w)
    elif by_newton(e, mode, v) != OK:
        return NOT_FINITE
    else:
        sum_closely(e, mode, w)
    write_bonds(e, v, w)
    return OK


def solve_in_step(e: Engine, mode: Mode, v: Floats) -> int:
    """Do the same where nothing is shown or decided by them but rates."""
    e.work.in_step = True
    found = by_newton(e, mode, v)
    e.work.in_step = False
    if found != OK:
        return NOT_FINITE
    write_bonds(e, v, e.work.w)
    return OK


def by_newton(e: Engine, mode: Mode, v: Floats) -> int:
    """Put the bond variables of a mode with laws that are evaluated into `e.work.w`."""
    count_work(e, 2 * e.model.bonds + mode.knowns)
    if mode.branch.known and mode.guessed:
        begin_on_branch(e, mode, v[0])
    elif begins_elsewhere(e, mode):
        keep_guess(mode, e.root_now)
        mode.branch.since = e.roots_kept
    knowns_of(e, mode, v, True)
    if newton_with_digits(e, mode, v) != OK:
        return NOT_FINITE
    if mode.finite_frees > 0:
        least_of_free(e, mode, v, e.work.w)
        keep_guess(mode, e.work.w)
        for _ in range(RETURNS):
            if mode.loose == 0 or not has_come_from_afar(e, mode):
                break
            knowns_of(e, mode, v, True)
            if newton_with_digits(e, mode, v) != OK:
                return NOT_FINITE
            least_of_free(e, mode, v, e.work.w)
            keep_guess(mode, e.work.w)
    return OK


def begins_elsewhere(e: Engine, mode: Mode) -> bool:
    """Whether a mode begins at the solution that the motion of another one has followed.

    Its own was that of an earlier visit, or of a look.
    """
    if mode.guessed and mode.branch.since == e.roots_kept:
        return False
    return e.root_known != 0.0 or (e.root_given and not mode.guessed)


def has_come_from_afar(e: Engine, mode: Mode) -> bool:
    """Whether Newton has ended where what is left free is all that its digits tell.

    It leaves that as it began, and so it is as large as in some state that was only looked at.
    """
    frees = mode.finite_frees
    return largest_of(frees, e.work.guess.at) > AFAR * largest_of(2 * e.model.bonds, e.work.w)


def newton_with_digits(e: Engine, mode: Mode, v: Floats) -> int:
    """Do what `newton` does, rows being eliminated anew where it finds that they lose digits."""
    e.work.lost = 0.0
    found = newton(e, mode, v)
    for _ in range(ROUNDS):
        if e.work.lost <= max(HIDDEN, BETTER * mode.lost):
            break
        weigh(e, mode)
        knowns_of(e, mode, v, True)
        e.work.lost = 0.0
        found = newton(e, mode, v)
        mode.lost = e.work.lost
    mode.solves += 1
    if found == OK and mode.doubted and not mode.weighed:
        found = newton_apart(e, mode, v)
    if found != OK or mode.solves < mode.looks_due:
        return found
    mode.looks_due = 2 * mode.solves
    for _ in range(ROUNDS):
        lost = lost_in_rows(e, mode, e.work.w)
        if found != OK or lost <= max(HIDDEN, BETTER * mode.rows_lost):
            break
        mode.rows_lost = lost
        for k in range(2 * e.model.bonds):
            e.work.lost_at[k] = e.work.w[k]
        weigh(e, mode)
        knowns_of(e, mode, v, True)
        found = newton(e, mode, v)
    return found


def newton_apart(e: Engine, mode: Mode, v: Floats) -> int:
    """Solve once more, rows being eliminated by how large bond variables are or may become.

    Nothing flows between what is level, and much as soon as it is not.
    """
    w = e.work.w
    at = e.work.lost_at
    for k in range(mode.knowns):
        e.work.xi[k] = level_of(e.model, mode, k)
    by_knowns(e, mode, mode.finite, at)
    for k in range(2 * e.model.bonds):
        at[k] = max(math.fabs(at[k]), math.fabs(w[k]))
    eliminate_again(e, mode, at)
    for j in range(mode.finite_frees):
        mode.guess.at[j] = w[mode.free_column[j]]
        mode.guessed = True
    knowns_of(e, mode, v, True)
    return newton(e, mode, v)


def lost_in_rows(e: Engine, mode: Mode, w: Floats) -> float:
    """Return the most of a linear law, or of a junction's sum, that lost digits hide."""
    m = e.model
    n = m.bonds
    measure_terms(e, mode, w)
    most = 0.0
    for element in range(m.elements):
        part = part_of(m, mode, element)
        for row in range(m.part_power[part], m.part_power[part + 1]):
            begin_row(e)
            for i in range(m.row_first[row], m.row_first[row + 1]):
                add_term(e, math.fabs(m.row_value[i]), m.row_column[i], w)
            most = max(most, part_hidden(e))
    for j in range(m.junctions):
        switch = m.junction_switch[j]
        if mode.given[j] != NOT_OPEN or (switch >= 0 and mode.on[switch] == 0):
            continue
        begin_row(e)
        for i in range(m.end_first[j], m.end_first[j + 1]):
            add_term(e, 1.0, m.end_bond[i] + (n if m.junction_kind[j] == 0 else 0), w)
        most = max(most, part_hidden(e))
    return most


def begin_row(e: Engine) -> None:
    """Begin to sum what is known of a row, and what is hidden of it."""
    e.work.row_known = 0.0
    e.work.row_hidden = 0.0


def add_term(e: Engine, factor: float, k: int, w: Floats) -> None:
    """Add a term of a row."""
    lost = UNIT * e.work.w_size[k]
    e.work.row_hidden += factor * lost
    if is_known(lost, e.work.w_reach[k], w[k]):
        e.work.row_known += factor * math.fabs(w[k])


def part_hidden(e: Engine) -> float:
    """Return the part of a row that is hidden, of what is known of it; 0 where nothing is."""
    w = e.work
    found = w.row_known > 0.0 and math.isfinite(w.row_hidden)
    return w.row_hidden / w.row_known if found else 0.0


def weigh(e: Engine, mode: Mode) -> None:
    """Eliminate the rows of a mode anew, by how large bond variables are where digits were lost."""
    at = e.work.lost_at
    eliminate_again(e, mode, at)
    for j in range(mode.finite_frees):
        mode.guess.at[j] = at[mode.free_column[j]]
        mode.guessed = True


def eliminate_again(e: Engine, mode: Mode, at: Floats) -> None:
    """Eliminate the rows of a mode anew; its laws are what they were, and so is their solution."""
    several = mode.branch.several
    known = mode.branch.known
    eliminate_by(e, mode, at)
    mode.branch.several = several
    mode.branch.known = known


def solve_read(e: Engine, mode: Mode, r: Reads, v: Floats) -> int:
    """Put the bond variables that are read into `e.work.w` and `v`; all of them after Newton."""
    if mode.dynamics > 0:
        return solve_in_step(e, mode, v)
    put_knowns(e, mode, r, v)
    show_read(e, mode, r, v)
    return OK
