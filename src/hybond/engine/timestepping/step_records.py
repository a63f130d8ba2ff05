"""What time-stepping keeps: the matrices of steps, the laws of the step under way, its outcome."""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import Block, make_block
from hybond.engine.complementarity.least_shares import Shares, make_shares
from hybond.engine.model import Model
from hybond.engine.words import Floats, Ints, Records, floats, ints, record, records

COUPLED_KEPT: Final = 8
"""Configurations and lengths of steps whose matrices are kept."""
NOT_LOOKED: Final = -1


@record
class Coupled:
    """A step of length `h` in a configuration with open laws, linearised.

    `theta` is the weight of its end. The first `n` states act back on their rates. `state` and
    `direct` are bond variables by these and by `l`, `gain` by `l` with what `l` makes of the state;
    `inverse` is that of one minus `h` times the rates by the states, `push` the state at the end by
    `l`, both by columns as well, `m` the `w` of laws by `l`. Where all but the laws is linear,
    `straight`, they hold at every point. `still` columns of `basis` are the `l` by which two
    solutions may differ; where one of them `moves` a `w`, what they spend together has to be
    nothing. What grows by itself within a step has `outgrown` it; what relaxes or swings within one
    `rings` from step to step. In such steps laws may have `lost` what makes their answers the only
    ones.
    """

    place: int
    stamp: int
    """Of which ports, and which ones these were when it was made."""
    h: float
    theta: float
    used: int
    number: int
    """Of these matrices among all that were made."""
    known: bool
    straight: bool
    outgrown: bool
    rings: bool
    lost: bool
    n: int
    state: Block
    direct: Block
    gain: Block
    inverse: Block
    inverse_columns: Block
    push: Block
    push_columns: Block
    m: Block
    deaf: Ints
    idle: Ints
    semidefinite: int
    still: int
    moves: bool
    basis: Block


@record
class Guess:
    """The branches of laws that are tried first, and the factors of the last ones that fitted.

    `code` says of each port what it does, `way` in which direction; `unknown` are the `many` ports
    whose `l` is solved for.
    """

    number: int
    many: int
    code: Ints
    way: Ints
    kept_code: Ints
    unknown: Ints
    factor: Block
    right: Floats
    row: Ints
    l: Floats
    turned: Ints


@record
class Stepping:
    """Steps of one run: the point that was reached is that of the run, with bond variables `w`.

    `theta` is the weight of the end of the step under way.

    Of the last step: when it began, `l`, the branches, which laws were `struck`, what sources gave,
    what resistors took, what laws gave and what came from nowhere.
    """

    hand: bool
    """Whether any machine was written by hand."""
    grid: float
    """Where the grid of steps begins, and how many of them lead to its next point."""
    grid_next: int
    grid_new: bool
    theta: float
    begins: bool
    """Whether the point is no end of a step that the log knows."""
    since: int
    """Steps since the last break: where an instant was settled, a law turned or was struck."""
    t0: float
    v0: Floats
    v1: Floats
    w: Floats
    begin_w: Floats
    w0: Floats
    base: Floats
    without: Floats
    mean: Floats
    y: Floats
    rate0: Floats
    rate: Floats
    rate_l: Floats
    explicit: Floats
    move: Floats
    change: Floats
    went: Floats
    went_l: Floats
    went_w: float
    """How far the last iteration of Newton's method wanted to go, with the state and with `l`; how
    far bond variables went by `l`, as a part of their terms."""
    weight: Floats
    most_effort: Floats
    most_flow: Floats
    """Of each island: the largest effort and flow on it."""
    ever_effort: Floats
    ever_flow: Floats
    """The same, of all steps so far."""
    unit: Floats
    able: Floats
    """What a law's `l` is measured by: what is there, and what friction is able to hold."""
    reach: Floats
    nothing: Floats
    nothing_stored: Floats
    x: Floats

    # the laws of the step
    gap: Floats
    gap_rate: Floats
    closed_gap: Floats
    """The gap with which the step before began, of a contact that was closed then; minus infinity
    of one that was open, infinity where there was no step."""
    before: Floats
    """`w` at the beginning."""
    restitution: Floats
    free: Floats
    doubt: Floats
    rounded: Floats
    """What rounding of its `w` makes of each `l`."""
    holding: Floats
    """What the friction of each law may hold at most, with the `l` that were found."""
    l: Floats
    wl: Floats
    branch: Ints
    struck: Ints
    most: Floats
    """The fastest approach of each port so far."""
    size: float
    shared: Ints
    """Ports whose shares were open in this step, then those of which it was said."""
    shared_said: Ints
    turned: Ints
    """Friction that was asked to rest in the step, as it would end it sliding the other way."""
    second_said: bool

    couples: Records[Coupled]
    made: int
    numbers: int
    now: Coupled
    guess: Guess
    shares: Shares
    scale: Floats
    down: Floats
    square: Block
    at_once: Floats
    feel: Floats
    row: Ints

    # the outcome
    thrust: Floats
    """Impulses by which constraints have moved what is stored, of bond variables."""
    supplied: float
    dissipated: float
    worked: float
    unbalanced: float
    before_state: Ints
    after_state: Ints
    through: Ints
    begin_y: Floats
    steps: int
    row_last: Ints
    """Of each machine: at the end of which step it fired last, and for how many in a row."""
    row_count: Ints


def make_stepping(m: Model) -> Stepping:
    """Return room for the steps of a run."""
    s = Stepping()
    n = m.ports
    states = m.storages + m.integrals
    for k in range(m.machines):
        s.hand = s.hand or (m.is_law[k] == 0 and k != m.ends)
    s.begins = True
    s.grid_new = True
    s.v0 = floats(2 * m.slots)
    s.v1 = floats(2 * m.slots)
    s.w = floats(2 * m.bonds)
    s.begin_w = floats(2 * m.bonds)
    s.w0 = floats(2 * m.bonds)
    s.base = floats(2 * m.bonds)
    s.without = floats(2 * m.bonds)
    s.mean = floats(2 * m.bonds)
    s.thrust = floats(2 * m.bonds)
    s.y = floats(states)
    s.rate0 = floats(states)
    s.rate = floats(states)
    s.rate_l = floats(states)
    s.explicit = floats(states)
    s.move = floats(states)
    s.change = floats(states)
    s.went = floats(states)
    s.went_l = floats(n)
    s.weight = floats(states)
    s.most_effort = floats(m.islands)
    s.most_flow = floats(m.islands)
    s.ever_effort = floats(m.islands)
    s.ever_flow = floats(m.islands)
    s.unit = floats(n)
    s.able = floats(n)
    s.reach = floats(m.storages)
    s.nothing = floats(n)
    s.nothing_stored = floats(m.integrals)
    s.x = floats(m.storages)
    s.gap = floats(n)
    s.gap_rate = floats(n)
    s.closed_gap = floats(n)
    for k in range(n):
        s.closed_gap[k] = math.inf
    s.before = floats(n)
    s.restitution = floats(n)
    s.free = floats(n)
    s.doubt = floats(n)
    s.rounded = floats(n)
    s.holding = floats(n)
    s.l = floats(n)
    s.wl = floats(n)
    s.branch = ints(n)
    s.struck = ints(n)
    s.most = floats(n)
    s.shared = ints(n)
    s.shared_said = ints(n)
    s.turned = ints(n)
    s.couples = records(Coupled, COUPLED_KEPT)
    s.now = make_coupled(n)
    s.guess = make_guess(n)
    s.shares = make_shares()
    s.scale = floats(n)
    s.down = floats(n)
    s.square = make_block(1)
    s.at_once = floats(n * n)
    s.feel = floats(n * n)
    s.row = ints(max(n, states))
    s.before_state = ints(m.machines)
    s.after_state = ints(m.machines)
    s.through = ints(m.machines)
    s.begin_y = floats(states)
    s.row_last = ints(m.machines)
    s.row_count = ints(m.machines)
    return s


def make_coupled(n: int) -> Coupled:
    """Return room for the matrices of a step with so many ports."""
    c = Coupled()
    c.state = make_block(1)
    c.direct = make_block(1)
    c.gain = make_block(1)
    c.inverse = make_block(1)
    c.inverse_columns = make_block(1)
    c.push = make_block(1)
    c.push_columns = make_block(1)
    c.m = make_block(n * n)
    c.deaf = ints(n)
    c.idle = ints(n)
    c.basis = make_block(1)
    return c


def make_guess(n: int) -> Guess:
    """Return room for guesses of the branches of n ports."""
    g = Guess()
    g.number = -1
    g.code = ints(n)
    g.way = ints(n)
    g.kept_code = ints(n)
    g.unknown = ints(n)
    g.factor = make_block(1)
    g.right = floats(n)
    g.row = ints(n)
    g.l = floats(n)
    g.turned = ints(n)
    return g
