"""Friction in the plane: what is known of disks, and room to decide and to lead slip to rest."""

from hybond.engine.complementarity.friction_disk import Disk, make_disk
from hybond.engine.model import Model
from hybond.engine.words import Floats, Ints, floats, ints, record


@record
class Planar:
    """The disks of friction of one run; disk d is that of the model.

    At an instant: `speed` of its slip and `size` that rounding of it is measured by, `way` its
    direction or that of what holds it (two numbers a disk), whether its slip is `resting`. `ready`
    says whether that is known of the present instant.
    """

    ready: bool
    speed: Floats
    size: Floats
    way: Floats
    resting: Ints

    slid: Ints
    """Whether it slid when a time step began, so that no breakaway limit holds it."""

    # those at rest, solved together: `free` has a force, else it is held
    held: int
    which: Ints
    free: Ints
    force: Floats
    loose: Ints
    holds: Ints
    rest: Floats
    rest_slope: Floats
    limit: Floats
    limit_slope: Floats
    l: Floats
    branch: Ints
    open: Ints
    soft: Floats
    disk: Disk
    a: Floats
    f0: Floats
    reach: float
    follow: Floats
    slip: Floats

    # while time passes: the largest speed since slip began, and ever
    largest: Floats
    ever: Floats
    signals: Floats

    # slip on its way to rest
    leading: bool
    steps: int
    ours: Ints
    ends: Ints
    """Disks that the last step has brought to rest."""
    heading: Floats
    ahead: Floats
    fx: Floats
    fy: Floats
    now: Floats
    falls: Floats
    left: Floats
    turns: Floats
    across: Floats
    still: Ints

    # room for states and values
    v: Floats
    y: Floats
    moved: Floats
    frozen: Floats
    rate: Floats
    other: Floats
    first: Floats
    second: Floats
    third: Floats
    fourth: Floats
    whole: Floats
    middle: Floats
    half: Floats
    final: Floats
    points: Floats
    gains: Floats
    ways: Floats


def make_planar(m: Model) -> Planar:
    """Return room for the disks of a model."""
    p = Planar()
    d = m.disks
    n = m.storages + m.integrals
    p.speed = floats(d)
    p.size = floats(d)
    p.way = floats(2 * d)
    p.resting = ints(d)
    p.slid = ints(d)
    p.which = ints(d)
    p.free = ints(d)
    p.force = floats(2 * d)
    p.loose = ints(d)
    p.holds = ints(d)
    p.rest = floats(d)
    p.rest_slope = floats(d * m.ports)
    p.limit = floats(d)
    p.limit_slope = floats(d * m.ports)
    p.l = floats(m.ports)
    p.branch = ints(m.ports)
    p.open = ints(m.ports)
    p.soft = floats(m.ports * m.ports)
    p.disk = make_disk()
    p.a = floats(4)
    p.f0 = floats(2)
    p.follow = floats(2)
    p.slip = floats(6)
    p.largest = floats(d)
    p.ever = floats(d)
    p.signals = floats(m.integrals)
    p.ours = ints(d)
    p.ends = ints(d)
    p.heading = floats(d)
    p.ahead = floats(d)
    p.fx = floats(d)
    p.fy = floats(d)
    p.now = floats(d)
    p.falls = floats(d)
    p.left = floats(d)
    p.turns = floats(d)
    p.across = floats(d)
    p.still = ints(d)
    p.v = floats(2 * m.slots)
    p.y = floats(n)
    p.moved = floats(n)
    p.frozen = floats(n)
    p.rate = floats(n)
    p.other = floats(n)
    p.first = floats(n)
    p.second = floats(n)
    p.third = floats(n)
    p.fourth = floats(n)
    p.whole = floats(n)
    p.middle = floats(n)
    p.half = floats(n)
    p.final = floats(n)
    p.points = floats(6 * d)
    p.gains = floats(6 * d)
    p.ways = floats(6 * d)
    return p
