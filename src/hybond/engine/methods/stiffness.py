"""Whether a motion is stiff, seen from its steps: when ``auto`` goes over to ``radau``, and back.

An explicit step is bound by stability where the product of its size and the fastest rate of the
mode, found from its last two stages, lies at the rim of the region of stability. That rim is at
3.3 on the negative axis; near the imaginary axis it is at 1, where a motion that is followed may
be as well if tolerances are coarse: there many more steps decide. An implicit step is not needed
where the product is so small that explicit ones would be stable too. A step that is about to grow
is bound by nothing yet, and tells nothing.

What was counted outlives events: a motion that switches every few steps is stiff all the same.

Sources: E. Hairer, G. Wanner, *Solving Ordinary Differential Equations II*, IV.2 (DOPRI5); L.
Petzold, "Automatic selection of methods for solving stiff and nonstiff systems of ordinary
differential equations", SIAM J. Sci. Stat. Comput. 4(1), 1983.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import Engine
from hybond.engine.methods.flow_records import AUTO, LARGE
from hybond.engine.methods.radau import begin_radau
from hybond.engine.methods.radau_room import Radau, make_radau
from hybond.engine.methods.scale import forget_settling
from hybond.engine.words import Floats

RIM: Final = 3.25
"""Size times rate beyond which a step is bound by stability, ..."""
ROW: Final = 15
"""... and how many such steps in a row make a motion stiff, ..."""
FORGOTTEN: Final = 6
"""... unless so many in between were not."""
LONG_RIM: Final = 1.0
LONG_ROW: Final = 1000
EASY: Final = 2.0
"""Size times norm below which an explicit step would be stable as well, ..."""
EASY_ROW: Final = 100
"""... and how many such steps in a row lead back: enough for ``radau`` to damp what died out."""
OFF_ROW: Final = 10
"""The same where only an edge was left, and the run asked for explicit steps."""
GROWING: Final = 2.0
"""By which a step that is bound by nothing grows."""


def watch_explicit(e: Engine, h: float, grown: float) -> None:
    """Learn from a step of ``rk45`` of size `h`; the next may be so many times as long."""
    s = e.step
    if e.states > LARGE:
        return
    size = h * fastest(e)
    if size > RIM:
        s.bound += 1
        s.free = 0
    elif grown < GROWING:
        s.free += 1
        if s.free >= FORGOTTEN:
            s.bound = 0
    if size > LONG_RIM:
        s.long_bound += 1
        s.long_free = 0
    elif grown < GROWING:
        s.long_free += 1
        if s.long_free >= FORGOTTEN:
            s.long_bound = 0
    s.turns = s.bound >= ROW or s.long_bound >= LONG_ROW


def fastest(e: Engine) -> float:
    """Return the rate of what changes most between the last two stages, both at the step's end."""
    s = e.step
    n = e.states
    rates = 0.0
    states = 0.0
    for k in range(n):
        unit = s.scale[k]
        if unit > 0.0 and unit < math.inf:
            rate = (s.k[6 * n + k] - s.k[5 * n + k]) / unit
            state = (s.y1[k] - s.trial[k]) / unit
            rates += rate * rate
            states += state * state
    found = math.sqrt(rates / states) if states > 0.0 else 0.0
    return found if found < math.inf else 0.0


def watch_implicit(e: Engine, r: Radau) -> None:
    """Learn from a step of ``radau`` that was not cut short.

    Other methods than ``auto`` go back as soon as they may: they only wanted to leave an edge.
    """
    s = e.step
    if r.h * norm_of(r.n, r.jacobian, r.tolerance) > EASY:
        s.bound = 0
    elif r.next < GROWING * r.h:
        s.bound += 1
    s.turns = s.bound >= (EASY_ROW if e.model.method == AUTO else OFF_ROW) and not r.from_edge


def norm_of(n: int, jacobian: Floats, unit: Floats) -> float:
    """Return the norm of a Jacobian, states being measured in units of their tolerance."""
    most = 0.0
    for i in range(n):
        total = 0.0
        if unit[i] > 0.0 and unit[i] < math.inf:
            for j in range(n):
                if unit[j] < math.inf:
                    total += math.fabs(jacobian[i * n + j]) * unit[j]
            most = max(most, total / unit[i])
    return most


def turn(e: Engine) -> None:
    """Go on by the other method, where a step ends."""
    s = e.step
    s.turns = False
    s.implicit = not s.implicit
    forget_settling(e)
    if s.implicit and not s.roomy:
        s.roomy = True
        e.radau = make_radau(e.states)
    if s.implicit:
        begin_radau(e.radau, True)
    s.bound = 0
    s.free = 0
    s.long_bound = 0
    s.long_free = 0
