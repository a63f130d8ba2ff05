"""The bond variables of a storage: the rate of what it stores, and what follows from that.

The rate is the flow of a compliance and the effort of an inertia; the other one is its co-energy
variable.
"""

from __future__ import annotations

from hybond.engine.model import Model


def rate_bond(m: Model, k: int) -> int:
    """Return the bond variable that is the rate of what port k stores, but for its sign."""
    return m.storage_bond[k] + (m.bonds if m.storage_kind[k] == 0 else 0)


def way_of_rate(m: Model, k: int) -> float:
    """Return 1, or -1 where what port k stores goes by the other sign of that bond variable."""
    return float(m.storage_sign[k]) if m.storage_kind[k] == 0 else 1.0


def co_energy_bond(m: Model, k: int) -> int:
    """Return the bond variable that is the co-energy variable of port k, but for its sign."""
    return m.storage_bond[k] + (m.bonds if m.storage_kind[k] == 1 else 0)
