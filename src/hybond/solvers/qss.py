"""The quantised-state methods by name: QSS1 to QSS3, and LIQSS1 to LIQSS3 for stiff models.

All of them are `hybond.solvers.qss_solver.QuantizedState` with an order and a way of quantising.
"""

from __future__ import annotations

from hybond.solvers.qss_solver import QuantizedState


class QSS1(QuantizedState):
    """Quantised states that are constant between events; x is piecewise linear."""

    name = "qss1"
    order = 1


class QSS2(QuantizedState):
    """Quantised states that are lines; x is piecewise quadratic."""

    name = "qss2"
    order = 2


class QSS3(QuantizedState):
    """Quantised states that are parabolas; x is piecewise cubic."""

    name = "qss3"
    order = 3


class LIQSS1(QSS1):
    """QSS1 with quantised states ahead of the states: see `hybond.solvers.qss_quanta.place`."""

    name = "liqss1"
    implicit = True


class LIQSS2(QSS2):
    """QSS2 with quantised states ahead of the states."""

    name = "liqss2"
    implicit = True


class LIQSS3(QSS3):
    """QSS3 with quantised states ahead of the states."""

    name = "liqss3"
    implicit = True


METHODS: dict[str, type[QuantizedState]] = {
    m.name: m for m in (QSS1, QSS2, QSS3, LIQSS1, LIQSS2, LIQSS3)
}
"""By name."""
