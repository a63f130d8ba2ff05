"""Laws of a mode that are solved for one after the other."""

from __future__ import annotations

from hybond.engine.algebra.blocks import Places, make_places
from hybond.engine.words import record


@record
class Apart:
    """The groups of laws that are solved one after the other; see `mode/nonlinear/apart`.

    Group g has the dynamic rows `row`, and as many free `unknown`, from ``begins[g]`` up to
    ``begins[g + 1]``; with these unknown and those before, its laws read the bond variables `read`
    from ``read_from[g]`` up to ``read_from[g + 1]``.
    """

    groups: int
    begins: Places
    row: Places
    unknown: Places
    read_from: Places
    read: Places
    group_of: Places
    """Of each free unknown: the group that it is solved in, or -1; ..."""
    row_group: Places
    """... of each row likewise."""
    given: Places
    """Of each group: the bond variable that its one law only gives, knowing all that it reads; or
    -1."""
    all_give: bool
    """Whether each is such a group."""


def make_apart() -> Apart:
    """Return no groups."""
    a = Apart()
    a.begins = make_places(2)
    a.row = make_places(1)
    a.unknown = make_places(1)
    a.read_from = make_places(2)
    a.read = make_places(1)
    a.group_of = make_places(1)
    a.row_group = make_places(1)
    a.given = make_places(1)
    return a
