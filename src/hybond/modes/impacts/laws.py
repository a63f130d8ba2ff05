"""Impact laws: what impulses several closed contacts exchange at one instant.

A law is a function of numbers alone: `W`, the response of the separating velocities to impulses at
the contacts (the Delassus matrix; symmetric, positive semi-definite), `v`, the velocities before
(negative ones approach), and a restitution per contact. All laws give ``v+ = v + W nu`` with
impulses ``nu >= 0`` and agree for one contact: ``v+ = -eps v``. They differ, legitimately, for
several.

``newton``
    Only approaching contacts enter, all of them together: ``0 <= nu ⟂ v+ + eps v >= 0``; and closed
    plastic ones (eps = 0) that are at rest, since these stay together. One step: others may
    approach after it, so it is repeated (`sequence.sequence`).
``newton_simultaneous``
    All closed contacts, ``0 <= nu ⟂ v+ + eps v >= 0``. One that separated before may approach
    after it: then it is repeated as well.
``poisson``
    Compression of all, ``0 <= nu_c ⟂ v_c = v + W nu_c >= 0``, then restitution of impulses:
    ``0 <= nu - (1 + eps) nu_c ⟂ v+ >= 0``.
``lzb``
    Compression and expansion of stiff springs, energetic restitution: `compliant.compliant_impact`.

``newton_simultaneous`` can *create* energy where restitution differs between contacts that act on
each other. That is a property of the law, not of the arithmetic, so nothing is clamped: the impact
is refused. The others never do while eps <= 1. For ``newton``, ``v + v+ = (1 - eps) v <= 0`` for
each active contact. For ``poisson``, ``nu - nu_c`` minimises the energy after the compression over
all impulses of at least ``eps nu_c``; ``max(eps) nu_c`` is one of them, and returns ``max(eps)**2``
of what the compression took.

Where contacts depend on each other (`W` is singular on them: a table of four legs) the velocities
after are unique but the shares of the impulses are not; the shares of least ``sum W_ii nu_i**2``
are taken and flagged. If restitution differs among such contacts, the laws but ``lzb`` have no
meaning and refuse it.

References
----------
C. Glocker, F. Pfeiffer, "Multiple impacts with friction in rigid multibody systems", Nonlinear
Dynamics 7:471-497, 1995. M. Anitescu, F. A. Potra, Nonlinear Dynamics 14:231-247, 1997.
J. J. Moreau, "Unilateral contact and dry friction in finite freedom dynamics", CISM 302, 1988.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hybond.modes.impacts.case import Case, Impact
from hybond.modes.impacts.compliant import compliant_impact
from hybond.modes.impacts.shares import scales, still_impulses
from hybond.run_options import IMPACT_LAWS

__all__ = ["IMPACT_LAWS", "Impact", "impact"]

Array = NDArray[np.float64]


def impact(
    W: ArrayLike,
    v: ArrayLike,
    *,
    eps: ArrayLike,
    law: str = "newton",
    stiffness: ArrayLike = 1.0,
    exponent: float = 1.0,
    names: Sequence[str] = (),
    floor: float = 0.0,
) -> Impact:
    """Return the impulses of closed contacts at one instant.

    Parameters
    ----------
    W : array_like, shape (n, n)
        Response of the separating velocities to the impulses.
    v : array_like, shape (n,)
        Separating velocities before; negative ones approach.
    eps : array_like, shape (n,) or scalar
        Restitution, at least 0: kinematic for Newton's laws, of impulses for Poisson's, energetic
        for ``lzb``. Above 1 the contact is a source of energy, which is flagged.
    law : str
        One of `IMPACT_LAWS`.
    stiffness : array_like, shape (n,) or scalar
        For ``lzb``: stiffness of each contact. Only ratios matter.
    exponent : float
        For ``lzb``: force is stiffness times indentation to this power; 1 linear, 1.5 Hertz.
    names : sequence of str
        What errors call the contacts; by default ``contact 0``, ``contact 1``, ...
    floor : float
        Velocities up to this one count as zero, besides `APPROACH`.

    Returns
    -------
    Impact

    Raises
    ------
    UsageError
        HB-J205: there is no such law.
    NumericsError
        HB-J201: the law would create energy. HB-J203: no impulse stops what approaches.
        HB-J204: see `compliant_impact`.
    ModelError
        HB-J202: dependent contacts with different restitution.
    ValueError
        Shapes that do not fit; a negative restitution; a stiffness that is not positive.

    Examples
    --------
    Three equal balls that touch, the first one arrives at 1 m/s, elastic: two answers.

    >>> W = [[2.0, -1.0], [-1.0, 2.0]]
    >>> impact(W, [-1.0, 0.0], eps=1.0).after.tolist()  # a step: (0, 1, 0); next (0, 0, 1)
    [1.0, -1.0]
    >>> at_once = impact(W, [-1.0, 0.0], eps=1.0, law="newton_simultaneous")
    >>> at_once.after.tolist()  # (-1/3, 2/3, 2/3)
    [1.0, 0.0]
    >>> at_once.energy
    0.0
    """
    case = Case.of(W, v, eps, law, names, floor)
    if law == "lzb":
        if not exponent > 0.0:
            raise ValueError(f"the exponent of a contact's force is positive, not {exponent}")
        k = np.broadcast_to(np.asarray(stiffness, dtype=float), case.v.shape)
        if not (np.isfinite(k).all() and (k > 0.0).all()):
            raise ValueError(f"stiffnesses are positive, not {k.tolist()}")
        return _lzb(case, k, exponent)
    return {"newton": _newton, "newton_simultaneous": _newton_simultaneous, "poisson": _poisson}[
        law
    ](case)


def _newton(case: Case) -> Impact:
    """Let the approaching contacts rebound; the others only feel it."""
    comes = case.v < -case.still
    if not comes.any():
        return _rebound(case, np.flatnonzero(comes))
    # A plastic contact at rest stays together: impulses pass through it as through a joint.
    stays = (case.eps == 0.0) & (np.abs(case.v) <= case.still)
    return _rebound(case, np.flatnonzero(comes | stays))


def _newton_simultaneous(case: Case) -> Impact:
    """Let all closed contacts rebound."""
    if not (case.v < -case.still).any():
        return _rebound(case, np.array([], dtype=np.intp))
    return _rebound(case, np.arange(len(case.v)))


def _rebound(case: Case, of: NDArray[np.intp]) -> Impact:
    v, eps = case.v, case.eps
    came = of[v[of] < -case.still]
    # Impulses that move nothing see no relative velocity: neither may they see what is asked for.
    inner = case.W[np.ix_(came, came)]
    kernel = still_impulses(inner)
    speeds = v[came] / scales(inner)
    speeds = speeds / np.max(np.abs(speeds), initial=1e-300)
    spread = eps[came] - np.mean(eps[came]) if len(came) else eps[came]
    case.refuse_dependent(kernel, came, kernel.T @ (spread * speeds))
    z, stays, unique = case.solve((1.0 + eps) * v, of)
    after = np.where(stays, -eps * v, v + case.W @ z)
    return case.finish(z, after, unique=unique)


def _poisson(case: Case) -> Impact:
    """Compress all closed contacts, then give back a part of each impulse, at least."""
    v, eps, W = case.v, case.eps, case.W
    every = np.arange(len(v))
    if not (v < -case.still).any():
        return case.finish(np.zeros(len(v)), v.copy())
    squeezed, stays, unique = case.solve(v, every)
    tight = np.flatnonzero(stays)
    # Compressions that move nothing, being returned in unequal parts, may move something.
    inner = W[np.ix_(tight, tight)]
    kernel, scale = still_impulses(inner), scales(inner)
    moved = inner / np.outer(scale, scale) @ (eps[tight, None] * kernel)
    case.refuse_dependent(kernel, tight, np.abs(moved).max(axis=0, initial=0.0))
    slowed = np.where(stays, 0.0, v + W @ squeezed)
    more, stuck, _ = case.solve(slowed + W @ (eps * squeezed), every)
    impulses = (1.0 + eps) * squeezed + more
    after = np.where(stuck, 0.0, v + W @ impulses)
    return case.finish(impulses, after, unique=unique)


def _lzb(case: Case, stiffness: Array, exponent: float) -> Impact:
    """Integrate compression and expansion; the energy is not let grow by the error of that."""
    v, W = case.v, case.W
    if not (v < -case.still).any():
        return case.finish(np.zeros(len(v)), v.copy())
    case.solve(v, np.arange(len(v)))  # springs cannot stop what no impulse can stop
    done = compliant_impact(W, v, eps=case.eps, stiffness=stiffness, exponent=exponent)
    z = done.impulses
    gained, curvature = z @ v, z @ W @ z
    if (case.eps <= 1.0).all() and gained + 0.5 * curvature > 0.0:
        z = z * (-2.0 * gained / curvature)  # along the ray of impulses, to where it is zero
    after = v + W @ z
    after = np.where(np.abs(after) <= max(done.error, case.still), 0.0, after)
    return case.finish(z, after, error=done.error, pieces=done.pieces)
