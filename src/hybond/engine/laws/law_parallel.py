"""Idle laws beside others that carry: all that may carry the same do so, in the least shares.

An answer of the laws is a corner of what they may do: of two diodes in parallel one has all of the
current, and which one depends on nothing but their order. So what the answer may be moved by is
looked for: values that some conducting laws may give away and idle ones beside them may take, while
what is stored moves as it did, what blocks lets nothing through and what conducts holds nothing.
Of these answers the one of least leakage is taken, no law giving less than nothing: equal parts
take equal shares, whatever they are called and in whichever order they are declared. Laws that
have a share there are ON, the others OFF, and the mode then leaves open how they share.

Friction at rest shares what it holds in the same way, no law beyond its limit, and with it what
carries beside it, unless a limit of friction follows that. Friction that holds more at rest than
in motion is left as it is where its share would come to its limit: what breaks loose is decided
elsewhere.

What a closed switch or a wire carries is not asked for: a diode beside it carries nothing.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import fit, grow_block
from hybond.engine.algebra.products import copy_floats, copy_part, copy_places
from hybond.engine.algebra.rounding import CANCELS
from hybond.engine.complementarity.law_roles import CUT, ONE_SIDED, SHUT
from hybond.engine.complementarity.least_shares import least_shares
from hybond.engine.engine import Engine, svd_room
from hybond.engine.laws.law_records import BY_OTHERS, BY_STORAGE, NOT_ASKED, Laws
from hybond.engine.laws.law_shares import is_at_rest
from hybond.engine.mode.nonlinear.freedom import directions_left
from hybond.engine.mode.rows.tableau import COMMON
from hybond.engine.model import Model
from hybond.engine.words import Floats

RESIDUE: Final = 1e-12
"""Part of its terms up to which a difference of two solutions is nothing but rounding."""
SIZES: Final = 4
"""Orders of magnitude at which shares are looked for."""
UNMOVED: Final = 1e-9
"""Part of its terms up to which what a move does to a value cancels."""


def find_shares(e: Engine, r: Laws, q: Floats, h: float, jump: bool) -> bool:
    """Put the answer there in which all that may carry do: ``r.branch``; False if it is the one.

    ``r.shares`` says of which laws that decides. `q` and `h` are what the laws were asked with.
    """
    n = e.model.ports
    idle = False
    resting = 0
    r.left = 0
    for k in range(n):
        r.shares[k] = 0
        r.branch[k] = r.answer[k]
        r.share_l[k] = r.answer_l[k]
        r.carries[k] = 0
        r.idle[k] = 1 if is_idle(r, k, n, q, h) else 0
        idle = idle or r.idle[k] != 0
        resting += 1 if holds_still(e.model, r, k) else 0
    if idle:
        level = 0
        while level < SIZES and share_out(e, r, q, h, False) and take_shares(r, n):
            level += 1
    if resting > 1 and not jump and share_out(e, r, q, h, True):
        take_rests(e, r)
    if jump:
        r.left = 0
    changed = False
    for k in range(n):
        changed = changed or r.branch[k] != r.answer[k]
    return changed


def is_idle(r: Laws, k: int, n: int, q: Floats, h: float) -> bool:
    """Whether both variables of a one-sided law are zero in the answer, but for rounding."""
    if r.role[k] != ONE_SIDED or r.answer_open[k] != 0 or r.answer_l[k] != 0.0:
        return r.role[k] == ONE_SIDED and r.answer_open[k] != 0
    return given_to(r, k, n, q, h, r.answer_l) == 0.0


def given_to(r: Laws, k: int, n: int, q: Floats, h: float, l: Floats) -> float:
    """Return the `w` of a port, zero if it is nothing but rounding of its terms."""
    w = q[k]
    size = math.fabs(w)
    for i in range(n):
        term = (r.response.d[k * n + i] + h * r.response.ce[k * n + i]) * l[i]
        w += term
        size += math.fabs(term)
    return w if math.fabs(w) > CANCELS * size else 0.0


def holds_still(m: Model, r: Laws, k: int) -> bool:
    """Whether a port is friction in one direction that does not move in the answer."""
    return m.port_planar[k] == 0 and is_at_rest(r.problem, k)


def share_out(e: Engine, r: Laws, q: Floats, h: float, rubs: bool) -> bool:
    """Find the shares of laws that conduct, or with `rubs` of friction at rest; False if none."""
    n = e.model.ports
    many = find_moves(e, r, rubs)
    if many == 0:
        return False
    put_moves(e, r, many, q, h, rubs)
    put_bounds(e, r, many, rubs)
    if not least_shares(svd_room(e, 2 * n, 2 * n), 2 * n, many, 0, r.room):
        return False
    for j in range(many):
        if may_exchange(r, n, many, j, 1.0) or may_exchange(r, n, many, j, -1.0):
            grow_block(r.left_l, (r.left + 1) * n)
            for k in range(n):
                r.left_l.at[r.left * n + k] = r.room.basis.at[k * many + j]
            r.left += 1
    return True


def may_exchange(r: Laws, n: int, many: int, j: int, way: float) -> bool:
    """Whether a law at its bound may take, along move j, from others what these carry.

    What only adds, as what runs round in a ring of diodes, is no exchange.
    """
    x = r.room
    at_bound = False
    gives = False
    for i in range(2 * n):
        move = way * x.basis.at[i * many + j]
        if move == 0.0:
            continue
        low = x.values.at[i] <= x.low.at[i]
        high = x.values.at[i] >= x.high.at[i]
        if (move > 0.0 and high) or (move < 0.0 and low):
            return False
        at_bound = at_bound or low or high
        gives = gives or move * x.values.at[i] < 0.0
    return at_bound and gives


def keep_left(e: Engine, r: Laws) -> None:
    """Let what was found to be open of shares be so in the mode that is asked for."""
    copy_places(e.model.machines, r.candidate, 0, r.left_state, 0)


def add_left(e: Engine, r: Laws) -> None:
    """Let the trial know in which directions shares are open that its mode gives to some laws."""
    m = e.model
    trial = e.trial
    for k in range(m.machines):
        if r.left_state[k] != trial.state[k]:
            return
    n = 2 * m.bonds
    many = trial.loose + r.left
    fit(r.left_room, n * many)
    for b in range(n):
        copy_part(trial.loose, trial.freedom.at, b * trial.loose, r.left_room.at, b * many)
        for j in range(r.left):
            total = 0.0
            size = 0.0
            for k in range(m.ports):
                term = r.response.gain[b * m.ports + k] * r.left_l.at[j * m.ports + k]
                total += term
                size += math.fabs(term)
            moves = math.fabs(total) > UNMOVED * size
            r.left_room.at[b * many + trial.loose + j] = total if moves else 0.0
    fit(trial.freedom, n * many)
    copy_floats(n * many, r.left_room.at, trial.freedom.at)
    trial.loose = many


def take_shares(r: Laws, n: int) -> bool:
    """Let laws that have a share be ON, and those that could have one but have none be OFF.

    A current that begins to flow is small beside others. So those with a clear share are left alone
    from then on: whether there are any.
    """
    x = r.room
    clear = False
    for k in range(n):
        common = k if r.now.given[k] == COMMON else n + k
        if r.role[k] == ONE_SIDED and x.high.at[common] > 0.0 and x.values.at[common] > 0.0:
            r.carries[k] = 1
            clear = True
    for k in range(n):
        r.share_l[k] = x.values.at[k] if x.high.at[k] > x.low.at[k] else r.share_l[k]
        if r.role[k] == ONE_SIDED:
            take_share(r, k, n)
    return clear


def take_share(r: Laws, k: int, n: int) -> None:
    """Let a one-sided law be ON if its share was open and there is one, OFF if there is none."""
    x = r.room
    if x.open.at[k] != 0 or x.open.at[n + k] != 0:
        r.shares[k] = 1
        common = k if r.now.given[k] == COMMON else n + k
        r.branch[k] = 1 if x.values.at[common] > 0.0 else 0


def take_rests(e: Engine, r: Laws) -> None:
    """Let friction whose share is within its limit rest, and what is at its limit give that."""
    n = e.model.ports
    x = r.room
    for k in range(n):
        at = net_at(r, k, n)
        if holds_still(e.model, r, k) and x.open.at[at] != 0 and r.resting[k] != 0:
            if not math.fabs(x.values.at[at]) < x.high.at[at]:
                return
    for k in range(n):
        at = net_at(r, k, n)
        if holds_still(e.model, r, k) and x.open.at[at] != 0:
            r.shares[k] = 1
            r.branch[k] = 0
            if not math.fabs(x.values.at[at]) < x.high.at[at]:
                r.branch[k] = 1 if x.values.at[at] < 0.0 else -1
        elif r.role[k] == ONE_SIDED:
            take_share(r, k, n)


def net_at(r: Laws, k: int, n: int) -> int:
    """Return where minus the net variable of a port stands among all `l` and all `w`."""
    return n + k if r.now.given[k] == COMMON else k


def may_move(m: Model, r: Laws, k: int, rubs: bool) -> bool:
    """Whether the `l` of a port may differ between answers in which it does what it does."""
    if rubs and holds_still(m, r, k):
        return r.now.given[k] != COMMON
    return r.role[k] == SHUT or (is_active(r, k) and not (rubs and is_pressed(r, k)))


def is_pressed(r: Laws, k: int) -> bool:
    """Whether a limit of friction follows what a port gives."""
    p = r.problem
    for j in range(p.n):
        if p.sloped[j] != 0 and p.slope[j * p.n + k] != 0.0:
            return True
    return False


def is_active(r: Laws, k: int) -> bool:
    """Whether the `w` of a one-sided law is zero by its branch, and its `l` what it gives."""
    carries = r.branch[k] != 0 or r.idle[k] != 0
    return r.role[k] == ONE_SIDED and r.carries[k] == 0 and carries == (r.now.given[k] == COMMON)


def stays(m: Model, r: Laws, k: int, rubs: bool) -> bool:
    """Whether the `w` of a port is the same in all answers in which it does what it does."""
    if r.role[k] == ONE_SIDED:
        return rubs or r.carries[k] != 0 or is_active(r, k)
    return r.role[k] != CUT and not (rubs and holds_still(m, r, k) and r.now.given[k] == COMMON)


def find_moves(e: Engine, r: Laws, rubs: bool) -> int:
    """Find what the answer may be moved by, into ``r.room.onto``; return in how many ways.

    Each is a column with a row for every `l` in ``r.tried``, whose number is ``r.many_tried``.
    """
    m = e.model
    n = m.ports
    x = r.room
    many = 0
    if r.now.linear and told_by_storage(e, r):
        return 0
    for k in range(n):
        if may_move(m, r, k, rubs):
            r.tried[many] = k
            many += 1
    r.many_tried = many
    if many == 0:
        return 0
    fit(x.rows, (2 * n + m.storages) * many)
    rows = 0
    for k in range(n):
        if stays(m, r, k, rubs):
            rows += put_row(r, rows, k, n, r.response.d, rounding_of(r, r.response.size[k]))
            rows += put_row(r, rows, k, n, r.response.ce, 0.0)
    for s in range(m.storages):
        rows += put_row(r, rows, s, n, r.response.e, rounding_of(r, r.field[s]))
    fit(x.onto, many * many)
    return directions_left(e, rows, many, x.rows.at, x.onto.at)


def told_by_storage(e: Engine, r: Laws) -> bool:
    """Whether what is stored moves with all that ports could share, in a linear graph.

    Then no answer has another beside it, whatever the laws do: as in a ladder whose diodes have a
    capacitor at each end. It is asked once of equations, and found from all ports together.
    """
    p = r.now
    if p.moves == NOT_ASKED:
        n = e.model.ports
        fit(r.room.onto, n * n)
        left = directions_left(e, e.model.storages, n, r.response.e, r.room.onto.at)
        p.moves = BY_STORAGE if left == 0 else BY_OTHERS
    return p.moves == BY_STORAGE


def rounding_of(r: Laws, size: float) -> float:
    """Return what is rounding beside a value: the gains of a nonlinear graph are differences."""
    return 0.0 if r.now.linear else RESIDUE * math.fabs(size)


def put_row(r: Laws, row: int, at: int, n: int, a: Floats, least: float) -> int:
    """Put a row of `a` there, of the `l` in ``r.tried``; return 1, or 0 if it is zero."""
    many = r.many_tried
    out = r.room.rows.at
    found = 0
    for i in range(many):
        entry = a[at * n + r.tried[i]]
        out[row * many + i] = entry if math.fabs(entry) > least else 0.0
        if out[row * many + i] != 0.0:
            found = 1
    return found


def put_moves(e: Engine, r: Laws, many: int, q: Floats, h: float, rubs: bool) -> None:
    """Put the answer there, and what it may be moved by."""
    n = e.model.ports
    a = r.response
    x = r.room
    fit(x.basis, 2 * n * many)
    fit(x.values, 2 * n)
    for i in range(2 * n * many):
        x.basis.at[i] = 0.0
    for i in range(r.many_tried):
        copy_part(many, x.onto.at, i * many, x.basis.at, r.tried[i] * many)
    for k in range(n):
        # what is given moves as it is given, and what follows by what is fed through
        x.values.at[k] = r.share_l[k]
        x.values.at[n + k] = given_to(r, k, n, q, h, r.share_l)
        for j in range(0 if stays(e.model, r, k, rubs) else many):
            total = 0.0
            size = 0.0
            for i in range(n):
                term = a.d[k * n + i] * x.basis.at[i * many + j]
                total += term
                size += math.fabs(term)
            x.basis.at[(n + k) * many + j] = total if math.fabs(total) > UNMOVED * size else 0.0


def put_bounds(e: Engine, r: Laws, many: int, rubs: bool) -> None:
    """Put what bounds the shares there; what no move changes is zero: it is no measure of them."""
    m = e.model
    n = m.ports
    x = r.room
    fit(x.low, 2 * n)
    fit(x.high, 2 * n)
    for i in range(2 * n):
        k = i if i < n else i - n
        moves = False
        for j in range(many):
            moves = moves or x.basis.at[i * many + j] != 0.0
        x.low.at[i] = 0.0
        x.high.at[i] = math.inf if moves else 0.0
        if not moves:
            x.values.at[i] = 0.0
        elif rubs and holds_still(m, r, k):
            x.high.at[i] = limit_of(r, k)
            x.low.at[i] = -x.high.at[i]
        elif r.role[k] == ONE_SIDED:
            x.values.at[i] = max(x.values.at[i], 0.0)
        else:
            x.low.at[i] = -math.inf


def limit_of(r: Laws, k: int) -> float:
    """Return the limit of friction with the forces that contacts have shared."""
    p = r.problem
    total = p.limit[k]
    for j in range(p.n):
        total += p.slope[k * p.n + j] * r.share_l[j]
    return max(total, 0.0)
