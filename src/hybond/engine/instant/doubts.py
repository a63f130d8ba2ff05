"""What is warned of at an instant. Only where somebody will read it: `tells` of the model."""

from __future__ import annotations

from hybond.engine.engine import Engine
from hybond.engine.mode.mode_records import Mode
from hybond.engine.reasons.warned import IMPULSIVE, add_about, begin_warning


def warn_of_impulsive(e: Engine, mode: Mode) -> None:
    """Warn of laws declared impulsive, which a jump has taken into its equations."""
    m = e.model
    begin_warning(e.warned, IMPULSIVE, e.t)
    for i in range(mode.dynamics):
        if mode.dynamic[i] >= 0 and m.dynamic_impulsive[mode.dynamic[i]] != 0:
            add_about(e.warned, float(m.dynamic_node[mode.dynamic[i]]))
