"""What is warned of where motion meets switching surfaces.

Only where somebody will read it: `tells` of the model.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.algebra.blocks import grow_block
from hybond.engine.algebra.products import largest
from hybond.engine.engine import OK, Engine
from hybond.engine.reasons.warned import (
    NO_WAY_ON,
    NOT_UNIQUE,
    THROWS_BACK,
    TWIN_SURFACES,
    add_about,
    begin_warning,
    take_back_warning,
)
from hybond.engine.sliding.filippov import FEW, SLIDES, is_way, put_sides, speed_of
from hybond.engine.surfaces.blend import blend, find_pushes, find_speeds
from hybond.engine.surfaces.outputs import show_state

PUSHED: Final = 1e-9
"""A side leads to a surface if more than this part of both sides' speed does: less is rounding."""
SAME_WEIGHTS: Final = 1e-9
"""Weights lie in [0, 1], and come from solved equations: ways closer than this are one."""
CLEAR_OF_IT: Final = 1e-9
"""A way leaves its surface at more than this part of the largest speed: less is rounding."""


def begin_ways(e: Engine) -> None:
    """Note that from here on it is warned of the decision at this instant."""
    e.slide.told = e.warned.rows if e.model.tells != 0 else 0


def forget_ways(e: Engine) -> None:
    """Forget what was warned of a decision that is given up for another one."""
    row = e.slide.told
    while row < e.warned.rows:
        kind = e.warned.kind.at[row]
        way = kind == NO_WAY_ON or kind == NOT_UNIQUE or kind == THROWS_BACK
        if way or kind == TWIN_SURFACES:
            take_back_warning(e.warned, row)
        else:
            row += 1


def warn_of_surface(e: Engine, kind: int, surface: int) -> None:
    """Warn of something about a surface."""
    begin_warning(e.warned, kind, e.t)
    add_about(e.warned, float(surface))


def warn_of_twins(e: Engine, met: int) -> None:
    """Warn of machines that switch on a surface slid on, and do not slide; `met` were met.

    Complementary switches that ask for nothing else cross it together, and slide together.
    """
    s = e.slide
    for i in range(met):
        surface = s.first_met[i]
        for j in range(s.k):
            if s.best[j] == SLIDES and s.twin[surface] == 1 + s.side[j]:
                begin_warning(e.warned, TWIN_SURFACES, e.t)
                add_about(e.warned, float(s.side[j]))
                add_about(e.warned, float(surface))


def warn_of_no_way(e: Engine) -> None:
    """Warn that no way was found to go on from the surfaces met."""
    s = e.slide
    begin_warning(e.warned, NO_WAY_ON, e.t)
    for j in range(s.k):
        add_about(e.warned, float(s.side[j]))


def warn_of_ways(e: Engine) -> None:
    """Warn where several ways lead on, each clearly; the one taken is in ``best``."""
    s = e.slide
    if s.k > FEW:
        return
    distinct = 0
    total = 1
    for _ in range(s.k):
        total *= 3
    ways = 0
    for number in range(total):
        put_sides(e, number)
        ways += 1 if is_way(e) else 0
    if ways < 2:
        return
    if s.common and (find_pushes(e) != OK or find_speeds(e, True) != OK):
        return
    # those that slide most come first, and of ways that are one the first counts
    for slides in range(s.k, -1, -1):
        for number in range(total):
            if put_sides(e, number) != slides or not is_way(e) or is_known_way(e, distinct):
                continue
            if not is_clear(e):
                return
            grow_block(s.ways, (distinct + 1) * s.k)
            for j in range(s.k):
                s.ways.at[distinct * s.k + j] = s.weight[j]
            distinct += 1
    if distinct < 2:
        return
    begin_warning(e.warned, NOT_UNIQUE, e.t)
    add_about(e.warned, float(distinct))
    for j in range(s.k):
        add_about(e.warned, float(s.side[j]))
        add_about(e.warned, float(s.best[j]))


def is_known_way(e: Engine, many: int) -> bool:
    """Whether the weights are those of a way that was found before, but for rounding."""
    s = e.slide
    for way in range(many):
        same = True
        for j in range(s.k):
            same = same and math.fabs(s.ways.at[way * s.k + j] - s.weight[j]) <= SAME_WEIGHTS
        if same:
            return True
    return False


def is_clear(e: Engine) -> bool:
    """Whether a way leaves its surfaces at a speed that is more than rounding.

    What constraints keep at rest is rounding of what would move without them.
    """
    s = e.slide
    most = largest(s.parts * s.k, s.part_speed)
    if s.common:
        most = max(most, largest(s.parts * s.k, s.plain_speed))
    for j in range(s.k):
        if s.trial_side[j] != SLIDES and not math.fabs(speed_of(e, j)) > CLEAR_OF_IT * most:
            return False
    return True


def warn_of_strokes(e: Engine) -> None:
    """Warn where both modes lead to a surface, but a jump there leads back too far to slide."""
    s = e.slide
    show_state(e, e.t, e.y, e.shown)
    s.known = False
    if blend(e, e.shown) != OK:
        return
    low = s.plain_speed[0]
    high = -s.plain_speed[1]
    size = math.fabs(low) + math.fabs(high)
    if low > PUSHED * size and high > PUSHED * size:
        warn_of_surface(e, THROWS_BACK, s.side[0])
