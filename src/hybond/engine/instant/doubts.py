"""What is warned of at an instant, and told of a guard that reads what is open.

Only where somebody will read it: `tells` of the model.
"""

from __future__ import annotations

from hybond.engine.engine import Engine
from hybond.engine.mode.leakage import is_undetermined
from hybond.engine.mode.mode_records import Mode
from hybond.engine.reasons.facts import add_fact
from hybond.engine.reasons.warned import IMPULSIVE, LEFT_OPEN, add_about, begin_warning


def tell_open_rule(e: Engine, rule: int) -> None:
    """Tell the rule that is refused, and which bond variables are open in the trial."""
    n = 2 * e.model.bonds
    add_fact(e.fault, float(rule))
    for k in range(n):
        if is_undetermined(n, e.trial.loose, e.trial.freedom.at, k):
            add_fact(e.fault, float(k))


def warn_of_open(e: Engine, rule: int) -> None:
    """Warn of a guard whose truth depends on what the equations leave open."""
    m = e.model
    n = 2 * m.bonds
    begin_warning(e.warned, LEFT_OPEN, e.t)
    add_about(e.warned, float(rule))
    for k in range(m.machines):
        add_about(e.warned, float(e.trial.state[k]))
    for k in range(n):
        if is_undetermined(n, e.trial.loose, e.trial.freedom.at, k):
            add_about(e.warned, float(k))


def warn_of_impulsive(e: Engine, mode: Mode) -> None:
    """Warn of laws declared impulsive, which a jump has taken into its equations."""
    m = e.model
    begin_warning(e.warned, IMPULSIVE, e.t)
    for i in range(mode.dynamics):
        if mode.dynamic[i] >= 0 and m.dynamic_impulsive[mode.dynamic[i]] != 0:
            add_about(e.warned, float(m.dynamic_node[mode.dynamic[i]]))
