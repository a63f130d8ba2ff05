"""What a trial has found is not found again where the state it was made for is written.

Its values are those of the state after its jump. Once that is written nothing jumps any more, and
``pre()`` reads these values; only what acts on ``pre()`` has others then.
"""

from __future__ import annotations

from hybond.engine.algebra.products import copy_part
from hybond.engine.engine import Engine
from hybond.engine.jumps.jump import STAYS
from hybond.engine.jumps.trial import forget_jump
from hybond.engine.laws.law_standing import is_simple


def is_still_known(e: Engine) -> bool:
    """Whether the values of the trial are those at the state it has led to.

    What is slid on is chosen anew there, and friction in the plane takes its direction.
    """
    return e.slide.many == 0 and e.model.disks == 0


def stay_on_trial(e: Engine) -> None:
    """Let the trial be one from the state it has led to: its values hold, and nothing jumps."""
    trial = e.trial
    forget_jump(e)
    trial.struck = False
    trial.dusted = False
    trial.factors = 0
    e.moved = STAYS


def acts_on_prior(e: Engine, still: bool) -> bool:
    """Whether a law that acts in the mode reads ``pre()``; junction laws do.

    Not laws that take one of two sides by present values alone: what they have chosen from a state
    that is `still` the same they would choose again.
    """
    m = e.model
    acts = m.laws > 0 and not (still and m.priors == 0 and e.mode.dynamics == 0)
    for k in range(m.ports if not acts else 0):
        acts = acts or not is_simple(m, k)
    for k in range(m.priors):
        acts = acts or e.mode.prior_acts[k] != 0
    return acts


def show_prior(e: Engine) -> None:
    """Show what ``pre()`` reads beside the values of the trial."""
    m = e.model
    copy_part(m.slots, e.pre, 0, e.v, m.slots)
