"""Forward Euler."""

from __future__ import annotations

from hybond.solvers.base import FloatArray
from hybond.solvers.fixed import FixedStep


class ForwardEuler(FixedStep):
    """Forward Euler with fixed step and linear dense output.

    The method of the simulators of the first hybrid bond graph papers; of order 1, useful to
    reproduce them and for nothing else.

    Parameters
    ----------
    step : float
        Step size, in seconds.

    References
    ----------
    P. J. Mosterman, G. Biswas, "A hybrid modeling and simulation methodology for dynamic
    physical systems", Simulation 78(1), 2002.

    Examples
    --------
    >>> import numpy as np
    >>> euler = ForwardEuler(0.5)
    >>> euler.start(lambda t, y: -y, 0.0, np.ones(1), t_bound=1.0, jumped=True)
    >>> euler.step(1.0).y1, euler.step(1.0).y1
    (array([0.5]), array([0.25]))
    """

    name = "euler"
    order = 1

    def _advance(
        self, t0: float, t1: float, y0: FloatArray, f0: FloatArray
    ) -> tuple[FloatArray, FloatArray | None, FloatArray]:
        change = (t1 - t0) * f0
        return y0 + change, None, change[None, :]
