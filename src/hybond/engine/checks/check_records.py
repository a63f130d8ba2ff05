"""What laws are held against: values as they are read from outside, and what was found."""

from __future__ import annotations

from hybond.engine.model import Model
from hybond.engine.words import Floats, Ints, floats, ints, record


@record
class Checks:
    """What is known of laws that do not hold.

    A law is known by `what` (see `laws_held`) and its number `index`; `off` is what is left of it
    and `size` the sum of the magnitudes of its terms.
    """

    v: Floats
    tolerance: Floats
    """By how much each bond variable may be off."""
    magnitude: Floats
    largest: Floats
    """The largest bond variable of each class that the run has seen at its checks."""
    due: int
    """How many evaluations the run will have made when it is looked at again."""
    looks: int
    first_look: bool
    """Whether lost digits are not counted yet: what does not hold then is suspect, no more."""
    suspects: int
    said: Ints
    """Of each law: whether it was found not to hold; elements, storages, junctions."""
    violated: int
    what: int
    index: int
    off: float
    size: float
    t: float


def make_checks(m: Model) -> Checks:
    """Return checks of a run that has not begun."""
    c = Checks()
    c.v = floats(2 * m.slots)
    c.tolerance = floats(2 * m.bonds)
    c.magnitude = floats(2 * m.bonds)
    c.largest = floats(m.classes)
    c.said = ints(m.elements + m.storages + m.junctions)
    return c
