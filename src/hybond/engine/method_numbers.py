"""The methods that a run may be asked for, by the numbers that ``model.method`` has."""

from typing import Final

RK45: Final = 0
"""Explicit steps of Dormand and Prince's, where no other number is there."""
RADAU: Final = 1
"""Implicit steps of Radau IIA."""
EXACT: Final = 2
"""The method that propagates linear modes, and leaves others to ``rk45``."""
AUTO: Final = 3
"""The one that leaves others to ``rk45`` and, where that is bound by stability, ``radau``."""
RK4: Final = 4
"""Steps of a fixed length from here on: the classical Runge-Kutta method."""
EULER: Final = 5
MOREAU: Final = 6
"""Time-stepping: from here on nothing is integrated by stages."""
QSS1: Final = 7
"""Quantised states of three orders."""
LIQSS1: Final = 10
"""Likewise, implicit."""
