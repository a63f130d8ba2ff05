"""Why contacts cannot rest at which impacts accumulate.

Only where somebody will read it: `tells` of the model.
"""

from __future__ import annotations

from typing import Final

from hybond.engine.contacts.landing_records import Landings
from hybond.engine.engine import Engine
from hybond.engine.reasons.facts import copy_fault
from hybond.engine.reasons.warned import UNREST, add_about, begin_warning

REBOUNDS: Final = 0
"""Its rebounds do not vanish."""
NO_SOLUTION: Final = 1
"""Its structure has none at rest: the fault `unrest` of the run says why."""
NO_SIGN: Final = 2
"""The impulses of the reaction have no sign."""
OPEN: Final = 3
"""The equations at rest leave the reaction open."""
OTHER_SIGN: Final = 4
"""The reaction at rest has not the sign of its impulses."""


def tell_no_solution(e: Engine, g: Landings) -> None:
    """Note that the structure at rest has no solution, for the reason last refused."""
    g.why = NO_SOLUTION
    copy_fault(e.fault, e.unrest)


def tell_refusal(e: Engine, g: Landings, r: int) -> None:
    """Note what is wrong with a reaction at rest."""
    column = e.model.reaction_column[r]
    g.why = OTHER_SIGN
    g.why_reaction = r
    g.why_force = g.force[column]
    if g.sign[r] == 0:
        g.why = NO_SIGN
        return
    for j in range(g.loose):
        if e.trial.freedom.at[column * g.loose + j] != 0.0:
            g.why = OPEN


def tell_verdict(e: Engine, g: Landings) -> None:
    """Keep why the contacts chosen do not land."""
    m = e.model
    for k in range(g.touches):
        if g.chosen[k] != 0:
            machine = m.contact_machine[g.touch_contact[k]]
            g.kept_why[machine] = g.why
            g.kept_reaction[machine] = g.why_reaction
            g.kept_force[machine] = g.why_force


def warn_of_unrest(e: Engine, g: Landings, machine: int) -> None:
    """Warn that a machine cannot rest.

    Numbers: the machine, why, the reaction, what it is at rest, the sign of its impulses.
    """
    begin_warning(e.warned, UNREST, e.t)
    r = g.kept_reaction[machine]
    add_about(e.warned, float(machine))
    add_about(e.warned, float(g.kept_why[machine]))
    add_about(e.warned, float(r))
    add_about(e.warned, g.kept_force[machine])
    add_about(e.warned, float(g.sign[r]) if e.model.reactions > 0 else 0.0)
