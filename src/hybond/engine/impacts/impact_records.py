"""An impact at several contacts as numbers, and room to solve it."""

from typing import Final

from hybond.engine.algebra.svd import Svd, make_svd
from hybond.engine.complementarity.lcp import Lcp, make_lcp
from hybond.engine.words import Floats, Ints, floats, ints, record

NEWTON: Final = 0
"""Contact after contact: a branch of each contact's own law, and none of those here."""
NEWTON_SIMULTANEOUS: Final = 1
POISSON: Final = 2
LZB: Final = 3

EXCHANGED: Final = 0
CREATES_ENERGY: Final = 1
DEPENDS: Final = 2
"""Contacts that depend on each other have restitutions that differ."""
CANNOT_STOP: Final = 3
NEVER_ENDS: Final = 4

COLUMNS: Final = 6
"""Lengths of step from which one is extrapolated: the order is twice as many."""


@record
class Compliant:
    """Contacts as stiff springs during an impact, in scaled variables; compliant.py says how.

    `base` are the separating velocities without impulses `p`; `d` are indentations, `force` what
    follows from them. A contact `acts` if it has a force; its indentation falls by `way` per
    distance travelled apart. Its velocity is to keep the sign of `keeps`, its indentation not to
    fall below zero if `lasts`: the first to fail, by more than its margin, ends a phase.
    """

    n: int
    w: Floats
    k: Floats
    exponent: float
    start: Floats
    base: Floats
    eps: Floats
    p: Floats
    d: Floats
    force: Floats
    v: Floats
    acts: Ints
    way: Floats
    keeps: Ints
    lasts: Ints
    keep_margin: Floats
    last_margin: Floats
    h: float
    """The next step."""
    steps: int
    pieces: int
    most: int
    """Phases so far, and the most."""

    # a step: increments of p, then of d; extrapolated, row by row
    gain: Floats
    off: Floats
    half: Floats
    inner: Floats
    table: Floats
    # while plastic contacts expand, which takes no time
    dropping: Ints
    kept: Floats
    coarse: Floats


@record
class Impact:
    """One impact at n contacts.

    Given: the response `w` of the separating velocities to impulses, row after row, symmetric; the
    velocities `v` before, `eps` restitution, `stiffness`, the `exponent` of forces. Found:
    `impulses`, velocities `after`, the change of `energy`, whether impulses are `shared` among
    contacts that depend on each other, an estimate of the `error` of velocities that were
    integrated. `blamed` are contacts that a refusal is about. Velocities up to `still` are zero.
    """

    n: int
    w: Floats
    v: Floats
    eps: Floats
    stiffness: Floats
    exponent: float
    still: float
    impulses: Floats
    after: Floats
    energy: float
    shared: bool
    error: float
    blamed: Ints

    lcp: Lcp
    svd: Svd
    nothing: Ints
    q: Floats
    z: Floats
    stays: Ints
    """Whether a contact does not part."""
    chosen: Ints
    scale: Floats
    inner: Floats
    kernel: Floats
    springs: Compliant


def make_compliant(n: int) -> Compliant:
    """Return room for n contacts."""
    c = Compliant()
    c.w = floats(n * n)
    c.k = floats(n)
    c.start = floats(n)
    c.base = floats(n)
    c.eps = floats(n)
    c.p = floats(n)
    c.d = floats(n)
    c.force = floats(n)
    c.v = floats(n)
    c.acts = ints(n)
    c.way = floats(n)
    c.keeps = ints(n)
    c.lasts = ints(n)
    c.keep_margin = floats(n)
    c.last_margin = floats(n)
    c.gain = floats(2 * n)
    c.off = floats(2 * n)
    c.half = floats(2 * n)
    c.inner = floats(n)
    c.table = floats(2 * n * COLUMNS)
    c.dropping = ints(n)
    c.kept = floats(n)
    c.coarse = floats(n)
    return c


def make_impact(n: int) -> Impact:
    """Return room for impacts at up to n contacts."""
    i = Impact()
    i.w = floats(n * n)
    i.v = floats(n)
    i.eps = floats(n)
    i.stiffness = floats(n)
    i.impulses = floats(n)
    i.after = floats(n)
    i.blamed = ints(n)
    i.lcp = make_lcp(n)
    i.svd = make_svd(n, n)
    i.nothing = ints(n)
    i.q = floats(n)
    i.z = floats(n)
    i.stays = ints(n)
    i.chosen = ints(n)
    i.scale = floats(n)
    i.inner = floats(n * n)
    i.kernel = floats(n * n)
    i.springs = make_compliant(n)
    return i
