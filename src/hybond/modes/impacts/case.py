"""What the impact laws share: their names, their record, and an impact that is to be solved."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hybond.errors import ModelError, NumericsError, UsageError
from hybond.modes.impacts.shares import least_shares
from hybond.names import did_you_mean
from hybond.run_options import IMPACT_LAWS
from hybond.solvers.lcp import lemke

Array = NDArray[np.float64]

APPROACH = 1e-12
"""A velocity below this part of the largest one at the impact neither approaches nor separates."""
CREATED = 1e-11
"""Energy that appears is more than rounding beyond this part of the terms that it is a sum of."""


@dataclass(frozen=True, slots=True)
class Impact:
    """One impact by a law.

    Parameters
    ----------
    law : str
        Name in `IMPACT_LAWS`.
    before, after : ndarray, shape (n,)
        Separating velocities. One that a law prescribes is exactly what it prescribes, and one
        that is zero but for rounding is 0.
    impulses : ndarray, shape (n,)
        Impulses of the contacts, none negative.
    active : tuple of int
        Contacts with an impulse.
    energy : float
        Change of kinetic energy, ``nu' (v + v+)/2``; negative if energy is lost.
    flags : tuple of str
        What a reader should know: ``"shares"`` (impulses of dependent contacts are not unique),
        ``"restitution"`` (an active contact has a restitution above 1).
    error : float
        Estimate of the error of `after`, in its unit, if the law is integrated; else 0.
    pieces : int
        Phases that were integrated, if the law is integrated; else 0.
    """

    law: str
    before: Array
    after: Array
    impulses: Array
    active: tuple[int, ...]
    energy: float
    flags: tuple[str, ...] = ()
    error: float = 0.0
    pieces: int = 0


@dataclass(frozen=True)
class Case:
    """An impact to be solved: checked numbers, and how its contacts are called.

    Parameters
    ----------
    law : str
        Name in `IMPACT_LAWS`.
    W, v, eps : ndarray
        See `laws.impact`.
    names : tuple of str
        What errors call the contacts.
    still : float
        Velocities up to this one are zero.
    """

    law: str
    W: Array
    v: Array
    eps: Array
    names: tuple[str, ...]
    still: float

    @classmethod
    def of(
        cls,
        W: ArrayLike,
        v: ArrayLike,
        eps: ArrayLike,
        law: str,
        names: Sequence[str],
        floor: float,
    ) -> Case:
        """Check the numbers of a call of `laws.impact`."""
        if law not in IMPACT_LAWS:
            remedy = did_you_mean(law, IMPACT_LAWS)
            raise UsageError(f"there is no impact law {law!r}", code="HB-J205", hint=remedy)
        v = np.array(v, dtype=float)
        W = np.array(W, dtype=float)
        n = len(v)
        eps = np.array(np.broadcast_to(np.asarray(eps, dtype=float), (n,)))
        if W.shape != (n, n) or (names and len(names) != n):
            raise ValueError(f"W {W.shape}, v {v.shape} and {len(names)} names do not fit")
        if not (np.isfinite(W).all() and np.isfinite(v).all() and np.isfinite(eps).all()):
            raise ValueError("a number of the impact is not finite")
        if (eps < 0.0).any():
            raise ValueError(f"restitution is at least 0, not {eps.tolist()}")
        size = float(np.max(np.abs(W), initial=0.0))
        if np.max(np.abs(W - W.T), initial=0.0) > 1e-9 * size:
            raise ValueError("the Delassus matrix is not symmetric")
        called = tuple(names) or tuple(f"contact {i}" for i in range(n))
        still = max(floor, APPROACH * float(np.max(np.abs(v), initial=0.0)))
        return cls(law, 0.5 * (W + W.T), v, eps, called, still)

    def called(self, contacts: ArrayLike) -> str:
        """List contacts by name."""
        return ", ".join(self.names[int(i)] for i in np.atleast_1d(np.asarray(contacts)))

    def solve(self, q: Array, of: NDArray[np.intp]) -> tuple[Array, Array, bool]:
        """Solve ``0 <= z ⟂ W z + q >= 0`` on some contacts.

        Returns
        -------
        z, stays : ndarray, shape (n,)
            The impulses (zero elsewhere), and whether a contact is at its bound W z + q = 0.
        unique : bool
            Whether no other z solves it; if one does, z has least ``sum W_ii z_i**2``.
        """
        W = self.W[np.ix_(of, of)]
        found = lemke(W, q[of])
        if found.status != "solved":
            raise NumericsError(
                f"no impulses stop the approach of {self.called(of[q[of] < -self.still])}: nothing "
                "that can move gives way",
                code="HB-J203",
                where=self.called(of),
                hint="give one of the bodies a finite mass, or open one of the contacts",
            )
        tight = np.flatnonzero(found.active | (np.abs(found.w) <= self.still))
        z, unique = least_shares(W, found.z, tight)
        whole, stays = np.zeros(len(q)), np.zeros(len(q), dtype=bool)
        whole[of] = z
        stays[of[tight]] = True
        return whole, stays, unique

    def finish(
        self, impulses: Array, after: Array, *, unique: bool = True, **integrated: float
    ) -> Impact:
        """Check the energy and make the record."""
        after = np.where(np.abs(after) <= self.still, 0.0, after)
        active = np.flatnonzero(impulses > 0.0)
        terms = 0.5 * impulses * (self.v + after)
        energy = float(terms.sum())
        size = float(0.5 * impulses @ (np.abs(self.v) + np.abs(after)))
        if abs(energy) <= CREATED * size:
            energy = 0.0 if (self.eps[active] >= 1.0).all() else min(energy, 0.0)
        flags = [] if unique else ["shares"]
        if (self.eps[active] > 1.0).any():
            flags.append("restitution")
        elif energy > 0.0:
            raise NumericsError(
                f"the impact law {self.law} would create energy ({energy:.6g} J, "
                f"{100 * energy / size:.3g} % of what is exchanged), because the restitution of "
                f"contacts that act on each other differs: {self._values(active)}",
                code="HB-J201",
                where=self.called(active),
                hint="choose poisson or lzb, which never do, or equal restitution",
            )
        return Impact(
            self.law,
            self.v,
            after,
            impulses,
            tuple(active.tolist()),
            energy,
            tuple(flags),
            float(integrated.get("error", 0.0)),
            int(integrated.get("pieces", 0)),
        )

    def _values(self, contacts: ArrayLike) -> str:
        every = np.atleast_1d(np.asarray(contacts))
        return ", ".join(f"{self.names[int(i)]} {self.eps[int(i)]:g}" for i in every)

    def refuse_dependent(self, kernel: Array, of: NDArray[np.intp], answer: Array) -> None:
        """Refuse restitutions that differ so that impulses of the kernel have an answer, not 0."""
        wrong = np.abs(answer) > 1e-9 * max(1.0, float(np.max(self.eps)))
        if not wrong.any():
            return
        touched = of[np.any(np.abs(kernel[:, wrong]) > 1e-9, axis=1)]
        raise ModelError(
            f"these contacts depend on each other, but their restitution differs: "
            f"{self._values(touched)}",
            code="HB-J202",
            where=self.called(touched),
            hint="give them the same restitution, or choose lzb",
        )
