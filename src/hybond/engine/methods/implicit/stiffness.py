"""Whether a motion is stiff, seen from its steps: when ``auto`` goes over to ``radau``, and back.

An explicit step is bound by stability where the product of its size and the fastest rate of the
mode, found from its last two stages, lies at the rim of the region of stability. That rim is at
3.3 on the negative axis; near the imaginary axis it is at 1, where a motion that is followed may
be as well if tolerances are coarse: there many more steps decide. An implicit step is not needed
where the product is so small that explicit ones would be stable too. A step that is about to grow
is bound by nothing yet, and tells nothing.

Where steps lead a motion nowhere, though, nobody can tell from two stages what binds them: a law
that saturates between these looks far less steep than it is, and what is level to the last digit
does not move at all. There the rates themselves are asked, beside where the motion is.

A step beyond the rim is within its tolerance where what decays has died out to far below that. The
current of a diode that charges a small capacitor is all that is left of it, and changes its sign
with such a step: the diode would block and conduct in turn. So steps in which a guard came to hold
count for more, and do where they only began beyond the rim.

What was counted outlives events: a motion that switches every few steps is stiff all the same.

Sources: E. Hairer, G. Wanner, *Solving Ordinary Differential Equations II*, IV.2 (DOPRI5); L.
Petzold, "Automatic selection of methods for solving stiff and nonstiff systems of ordinary
differential equations", SIAM J. Sci. Stat. Comput. 4(1), 1983.
"""

from __future__ import annotations

import math
from typing import Final

from hybond.engine.engine import OK, Engine
from hybond.engine.method_numbers import AUTO
from hybond.engine.methods.implicit.radau import begin_radau
from hybond.engine.methods.implicit.radau_room import Radau, make_radau
from hybond.engine.methods.tolerances.scale import error_norm, forget_settling
from hybond.engine.mode.nonlinear.guess import give_back_guess, hold_guess
from hybond.engine.surfaces.values import field
from hybond.engine.words import Floats

RIM: Final = 3.25
"""Size times rate beyond which a step is bound by stability, ..."""
ROW: Final = 15
"""... and how many such steps in a row make a motion stiff, ..."""
FORGOTTEN: Final = 6
"""... unless so many in between were not."""
CUT: Final = 5
"""For how many of them one more counts, in which a guard came to hold."""
SECOND: Final = 5.0
"""The part of a step after which its second stage is, inverted."""
LONG_RIM: Final = 1.0
LONG_ROW: Final = 1000
EASY: Final = 2.0
"""Size times norm below which an explicit step would be stable as well, ..."""
EASY_ROW: Final = 100
"""... and how many such steps in a row lead back: enough for ``radau`` to damp what died out."""
MOST_STATES: Final = 2000
"""Of more, a table of all slopes is too large to have unasked."""
LED_ROW: Final = 200
"""Steps after which it is seen how far they have led: ..."""
NOWHERE: Final = 0.1
"""... nowhere, where no state has moved by this part of its size; ..."""
ASKED: Final = 12
"""... how often the rates are asked then what grows fastest, ..."""
TELLS: Final = 4
"""... of which the last ones tell."""
TURNS: Final = 0.6180339887498949
"""No two states begin so with like numbers: parts of the golden section."""
OFF_ROW: Final = 10
"""The same where only an edge was left, and the run asked for explicit steps."""
GROWING: Final = 2.0
"""By which a step that is bound by nothing grows."""


def watch_explicit(e: Engine, h: float, grown: float) -> None:
    """Learn from a step of ``rk45`` of size `h`; the next may be so many times as long."""
    s = e.step
    if e.states > MOST_STATES:
        return
    size = h * fastest(e)
    s.past_rim = size > RIM or began_past(e)
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
    if leads_nowhere(e) and h * fastest_here(e) > EASY:
        s.turns = True


def began_past(e: Engine) -> bool:
    """Whether the last step began beyond the rim, by its first two stages, wherever it ends.

    A diode that begins to carry a current as the root of a voltage is as steep as can be there.
    """
    s = e.step
    n = e.states
    changes = 0.0
    rates = 0.0
    for k in range(n):
        unit = s.scale[k]
        if unit > 0.0 and unit < math.inf:
            change = (s.k[n + k] - s.k[k]) / unit
            rate = s.k[k] / unit
            changes += change * change
            rates += rate * rate
    # the second stage is a fifth of the step on
    return math.sqrt(changes) * SECOND > RIM * math.sqrt(rates)


def watch_cut(e: Engine) -> None:
    """Learn from a step of ``rk45`` that ends where a guard came to hold in it."""
    s = e.step
    if s.past_rim:
        s.bound += CUT
        s.free = 0
        s.turns = s.turns or s.bound >= ROW
    s.past_rim = False


def leads_nowhere(e: Engine) -> bool:
    """Whether a row of steps, which ends here, has led no state on by a part of its size."""
    s = e.step
    if s.looked == 0:
        for k in range(e.states):
            s.looked_at[k] = s.y0[k]
    s.looked += 1
    if s.looked < LED_ROW:
        return False
    s.looked = 0
    for k in range(e.states):
        if math.fabs(s.y1[k] - s.looked_at[k]) > NOWHERE * e.lately[k]:
            return False
    return True


def fastest_here(e: Engine) -> float:
    """Return the rate of what grows or dies out fastest within the tolerance of the present state.

    By how much a change of the state changes its rates, over and over.
    """
    s = e.step
    n = e.states
    v = s.peak_y
    refusal = e.refusal
    asked = e.evaluations
    hold_guess(e, e.mode)
    for k in range(n):
        part = math.fmod(float(k + 1) * TURNS, 1.0) - 0.5
        v[k] = part * s.scale[k] if s.scale[k] < math.inf else 0.0
    found = 1.0
    for i in range(ASKED):
        size = error_norm(n, v, s.scale)
        if not size > 0.0 or not size < math.inf:
            found = 0.0
            break
        for k in range(n):
            v[k] /= size
        # beside an edge of a law there may be values on one side alone
        side = side_with_rates(e, v)
        if side == 0.0:
            found = 0.0
            break
        for k in range(n):
            seen = s.scale[k] > 0.0 and s.scale[k] < math.inf
            v[k] = side * (s.rate[k] - s.f[k]) if seen else 0.0
        if i >= ASKED - TELLS:
            found *= error_norm(n, v, s.scale)
    give_back_guess(e, e.mode)
    e.evaluations = asked
    e.refusal = refusal
    return math.pow(found, 1.0 / float(TELLS)) if found < math.inf else 0.0


def side_with_rates(e: Engine, v: Floats) -> float:
    """Find the rates a way `v` on from the present state, or back; return 1, -1 or 0 if none."""
    s = e.step
    side = 1.0
    for _ in range(2):
        for k in range(e.states):
            s.trial[k] = s.y[k] + side * v[k]
        if field(e, e.mode, s.t, s.trial, s.rate) == OK:
            return side
        side = -side
    return 0.0


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
    s.looked = 0
    s.long_bound = 0
    s.long_free = 0
