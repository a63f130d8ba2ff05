"""The account of a step: what sources gave and resistors took, and what is left of the balance."""

from __future__ import annotations

from hybond.engine.engine import Engine
from hybond.engine.mode.rows.storage import co_energy
from hybond.engine.model import Model
from hybond.engine.timestepping.step_records import Stepping


def meter_step(m: Model, s: Stepping, h: float) -> None:
    """Find what sources gave, impulses at their values in the end, and resistors took in a step."""
    s.supplied = 0.0
    s.dissipated = 0.0
    for k in range(m.suppliers):
        b = m.supplier_bond[k]
        given = h * s.mean[b] * s.mean[m.bonds + b]
        given += s.thrust[b] * s.w[m.bonds + b] + s.thrust[m.bonds + b] * s.w[b]
        s.supplied += float(m.supplier_sign[k]) * given
    for k in range(m.dissipators):
        b = m.dissipator_bond[k]
        s.dissipated += h * float(m.dissipator_sign[k]) * s.mean[b] * s.mean[m.bonds + b]


def balance_step(e: Engine, s: Stepping) -> None:
    """Find what a step has stored beyond what sources, resistors and laws gave it, J.

    The mean bond variables of a step obey the junction structure, so that with the co-energy
    variables at the same mean, ``theta z(x+) + (1 - theta) z(x)``, the scheme balances exactly:
    what was stored by them is what sources gave and resistors took by them, and the laws' work
    ``h l w``. (The energy itself moves by that less ``(theta - 1/2) dx' K dx``, the damping of the
    scheme, for linear storage.) What constraints on storage take away is a loss.
    """
    m = e.model
    stored = 0.0
    for end in range(2):
        part = s.theta if end == 1 else 1.0 - s.theta
        for k in range(m.storages):
            s.v0[m.stored_slot + k] = s.y[k] if end == 1 else e.y[k]
        co_energy(m, s.v0, s.x)
        for k in range(m.storages):
            if m.storage_pseudo[k] == 0:
                stored += part * s.x[k] * (s.y[k] - e.y[k])
    s.unbalanced = stored - (s.supplied - s.dissipated) - s.worked
