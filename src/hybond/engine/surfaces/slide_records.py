"""What a run keeps of motion along switching surfaces."""

from __future__ import annotations

from hybond.engine.algebra.blocks import Block, Places, make_block, make_places
from hybond.engine.model import Model
from hybond.engine.words import Floats, Ints, floats, ints, record


@record
class Slide:
    """The surfaces slid on, and the combination of modes in the present one.

    ``surface[0 .. many - 1]`` are the surfaces slid on, `many` 0 if none. In the mode taken last
    `k` of them, ``side``, have modes on both sides: ``part[0 .. parts - 1]`` are these modes by
    number, those of corners.py.
    """

    many: int
    surface: Ints
    slid_product: bool
    """Whether those slid on make a product combination."""
    k: int
    side: Ints
    product: bool
    parts: int
    part: Ints
    room: int
    """Surfaces that there is room for, and parts."""
    room_parts: int
    of_state: Ints
    """Of each side: whether its function reads nothing that can jump."""
    # modes with different constraints are held to all of them: common_space.py
    common: bool
    holders: int
    holder: Ints
    held: int
    """Constraints of all holders, one after the other."""
    areas: int
    directions: Block
    moves: Block
    off: Block
    off_size: Block
    slope: Block
    inverse: Block
    area: Block
    total: Block
    area_size: Block
    """The size of the terms that made each area."""
    reached: Ints
    """Of each port: whether its law carries impulses: law_means.py."""
    push: Floats
    push_size: Floats
    """What each law carries on the mean, and the size of the terms that made it."""
    barred: Ints
    """Of each port: 0, the side on which its law lets go in all branches chosen, or HELD."""
    meant: Ints
    """Of each port: whether its friction rests in all branches chosen, by what it carries on the
    mean alone."""
    # the branches of junction laws in the modes around: branches.py
    branches: int
    branch: Places
    """Rows of states of machines."""
    choose_x: Floats
    choose_s: Floats
    kept_pre: Floats
    # those a little ahead of laws that are at their ends: from_edge.py
    edge_rate: Block
    """Of each part, then of the combination: the rates by which it is looked ahead."""
    modes_now: Places
    modes_slid: Places
    modes_ahead: Places
    """Of each part: the mode that it is now, that of a way to slide, and that a little ahead."""
    # the combination at one point
    known: bool
    at: Floats
    """The time, signals and stored quantities that the rest belongs to."""
    weight: Floats
    last: Floats
    """The weights found last, from which those of a product are sought."""
    has_last: bool
    coefficient: Floats
    by: Floats
    """Of each part, a row: the slopes of its coefficient by the weights."""
    w: Floats
    w_size: Floats
    """The size of the terms that made each bond variable."""
    rate: Floats
    solution: Floats
    """Of each part, a row of bond variables."""
    plain_solution: Floats
    """The same before parts are kept to the constraints of all, where there are junction laws."""
    part_rate: Floats
    plain_speed: Floats
    part_speed: Floats
    """Of each part, a row: how fast each function moves."""
    change: Floats
    """How the weights, columns, move the functions, rows."""
    gone: Ints
    """Of each surface: 1 if all parts move its function up alike, -1 if down, 0 if they differ."""
    margin: Floats
    """How far each surface is from being left, below, then above; each law from pulling."""
    gap: Floats
    """Of each side: its function."""
    parted: Ints
    """Of each surface: whether it has jumped away from the state that slides on it: parted.py."""
    jump_at: Floats
    jump_near: Ints
    """Of each place at which surfaces jump: what changes its sign there, whether that is now."""
    parts_now: bool
    """Whether the state that was just noted is not where its surfaces are."""
    tilted: Floats
    """Weights to try, and their coefficients."""
    tilted_coefficient: Floats
    v: Floats
    ahead: Floats
    """Values near those of the combination."""
    read_slope: Floats
    """The slopes of a function that reads bond variables, by all that it reads."""
    kink_at: Floats
    """Of each kink of a law, source or rate: what changes its sign there; 0 if it is rounding."""
    put_state: Floats
    """The state that stands among values."""
    # machines that follow others: followers.py
    given: bool
    """Whether the modes combined are those of `branch`, and nobody has to be asked."""
    led: Floats
    """Values that those read which follow; what rounding of them is measured by."""
    led_terms: Floats
    led_mode: Ints
    """The mode of a moment in which they change."""
    led_known: bool
    """Whether that mode has a solution, which is put into `led`."""
    led_jump: Floats
    """Impulses on entering that mode, and whether there are any."""
    led_jumps: bool
    entries: int
    """Modes whose jump on being entered is known: rows of states, of impulses, of what is stored
    then; whether there is one at all."""
    entry: Places
    entry_jump: Block
    entry_x: Block
    entry_known: Places
    wants_entry: bool
    """Whether that of a mode passed through is not known: ``wanted_entry``."""
    wanted_entry: Ints
    wants: bool
    """Whether the branches of laws in a mode passed through are not known: ``wanted``."""
    wanted: Ints
    begun: Ints
    asked: Ints
    """Those to be asked, by their place, and of each of them whether it is among these."""
    is_asked_now: Ints
    fires: Ints
    """Those that fire, by their place, and by which rules."""
    firing: Ints
    base: Ints
    """The mode in which switching begins, those that it goes from, and one that has come before."""
    origin: Ints
    turned: Ints
    phases: int
    """The modes combined since the last decision, with what followed in each: rows of states."""
    phase: Places
    restless: int
    """A machine whose followers find no end, or -1."""
    strikes: bool
    """Whether what was just met, and not slid on before, would strike a contact after each turn."""
    apart: Ints
    """Of each machine: whether it has a surface that is slid on, or met."""
    led_many: int
    led_surface: Ints
    """The surfaces for which it is known who follows: of each machine, `is_led_now`."""
    is_led_now: Ints
    led_atom: Floats
    """Of each comparison: its value in the first of the modes combined."""
    state: Ints
    corner: Ints
    target: Ints
    x: Floats
    rates: Floats
    rates2: Floats
    freedom: Block
    """Directions in which bond variables of some part are free, one after the other."""
    # what is decided after an event
    met: int
    met_surface: Ints
    first_met: Ints
    """Those met before any of them was left out."""
    first_many: int
    """How many; without what would strike a contact, once that is seen."""
    twin: Ints
    """Of each surface: 1 + that met in its place if the machines of both move something, or 0."""
    sides: Ints
    best: Ints
    best_product: bool
    best_weight: Floats
    trial_side: Ints
    matrix: Floats
    right: Floats
    pivot: Ints
    agrees: Ints
    """Of each side: whether all parts give its function one value."""
    number: Ints
    """Of storages: what has been visited; of bonds, on the way from a bond to a storage."""
    seen: Ints
    around: Ints
    """The mode whose neighbours are looked at."""
    settled: Ints
    """The mode in which the instant has settled, before it is decided what slides."""
    mark: Ints
    chosen: Ints
    keep: Floats
    y: Floats
    put_from: Floats
    """A state as it is before it is put on its surfaces, and the sizes that states may have."""
    size: Floats
    # infinitely many jumps of one instant, added up: crossings.py
    before: Floats
    impulses: Floats
    energy_before: float
    energy_after: float
    endless: Ints
    """Of each surface: whether it was said that jumps back and forth over it have no end."""
    ways: Block
    """Weights of the ways on."""
    told: int
    """Where warnings begin of the decision at this instant."""


def make_slide(m: Model) -> Slide:
    """Return room for sliding."""
    s = Slide()
    n = m.storages + m.integrals
    surfaces = max(m.surfaces, 1)
    s.surface = ints(surfaces)
    s.side = ints(surfaces)
    s.of_state = ints(surfaces)
    s.met_surface = ints(surfaces + 1)
    s.first_met = ints(surfaces)
    s.first_many = 0
    s.twin = ints(surfaces)
    s.sides = ints(surfaces)
    s.best = ints(surfaces)
    s.trial_side = ints(surfaces)
    s.agrees = ints(surfaces)
    s.parted = ints(surfaces)
    s.chosen = ints(surfaces)
    s.endless = ints(surfaces)
    s.parts = 1
    s.directions = make_block(1)
    s.moves = make_block(1)
    s.off = make_block(1)
    s.off_size = make_block(1)
    s.slope = make_block(1)
    s.inverse = make_block(1)
    s.area = make_block(1)
    s.total = make_block(1)
    s.area_size = make_block(1)
    s.reached = ints(m.ports)
    s.push = floats(m.ports)
    s.push_size = floats(m.ports)
    s.barred = ints(m.ports)
    s.meant = ints(m.ports)
    s.freedom = make_block(1)
    s.branch = make_places(1)
    s.modes_now = make_places(1)
    s.modes_slid = make_places(1)
    s.modes_ahead = make_places(1)
    s.edge_rate = make_block(1)
    s.choose_x = floats(m.storages)
    s.choose_s = floats(m.integrals)
    s.kept_pre = floats(m.slots)
    s.at = floats(n + 1)
    s.w = floats(2 * m.bonds)
    s.w_size = floats(2 * m.bonds)
    s.rate = floats(n)
    s.v = floats(2 * m.slots)
    s.ahead = floats(2 * m.slots)
    s.read_slope = floats(m.surface_first[m.surfaces])
    s.kink_at = floats(m.kinks)
    s.put_state = floats(n)
    follows = m.followers > 0
    s.led = floats(2 * m.slots if follows else 0)
    s.led_terms = floats(m.slots if follows else 0)
    s.led_jump = floats(m.slots if follows else 0)
    s.entry = make_places(1)
    s.entry_jump = make_block(1)
    s.entry_x = make_block(1)
    s.entry_known = make_places(1)
    s.wanted_entry = ints(m.machines)
    s.led_mode = ints(m.machines)
    s.wanted = ints(m.machines)
    s.begun = ints(m.machines)
    s.led_atom = floats(m.atom_first[m.rule_first[m.machines]] if follows else 0)
    s.asked = ints(m.followers)
    s.fires = ints(m.followers)
    s.firing = ints(m.followers)
    s.is_asked_now = ints(m.followers)
    s.base = ints(m.machines)
    s.origin = ints(m.machines)
    s.turned = ints(m.machines)
    s.phase = make_places(1)
    s.restless = -1
    s.strikes = False
    s.apart = ints(m.machines)
    s.led_many = -1
    s.led_surface = ints(surfaces)
    s.is_led_now = ints(m.machines)
    s.state = ints(m.machines)
    s.corner = ints(m.machines)
    s.target = ints(m.machines)
    s.x = floats(m.storages)
    s.rates = floats(n)
    s.rates2 = floats(m.storages)
    s.seen = ints(m.bonds)
    s.number = ints(m.bonds)
    s.around = ints(m.machines)
    s.settled = ints(m.machines)
    s.mark = ints(m.machines)
    s.keep = floats(m.storages)
    s.y = floats(n)
    jumps = m.surface_jump_first[m.surfaces]
    s.jump_at = floats(jumps)
    s.jump_near = ints(jumps)
    s.put_from = floats(n)
    s.size = floats(n)
    s.before = floats(n)
    s.impulses = floats(2 * m.bonds)
    fit_slide(m, s, 1, 2)
    if m.tells != 0:
        s.ways = make_block(8)
    return s


def fit_slide(m: Model, s: Slide, k: int, parts: int) -> None:
    """Make room for so many surfaces and parts; what was found of others may be lost."""
    if k <= s.room and parts <= s.room_parts:
        return
    n = m.storages + m.integrals
    s.room = max(k, s.room)
    s.room_parts = max(parts, s.room_parts)
    s.known = False
    s.has_last = False
    s.weight = floats(s.room)
    s.last = floats(s.room)
    s.best_weight = floats(s.room)
    s.tilted = floats(s.room)
    s.right = floats(s.room)
    s.pivot = ints(s.room)
    s.gone = ints(s.room)
    s.matrix = floats(s.room * s.room)
    s.change = floats(s.room * s.room)
    s.margin = floats(2 * s.room + m.ports)
    s.gap = floats(s.room)
    s.part = ints(s.room_parts)
    s.holder = ints(s.room_parts)
    s.coefficient = floats(s.room_parts)
    s.tilted_coefficient = floats(s.room_parts)
    s.by = floats(s.room_parts * s.room)
    s.part_speed = floats(s.room_parts * s.room)
    s.plain_speed = floats(s.room_parts * s.room)
    s.part_rate = floats(s.room_parts * n)
    s.solution = floats(s.room_parts * 2 * m.bonds)
    if m.laws > 0:
        s.plain_solution = floats(s.room_parts * 2 * m.bonds)
