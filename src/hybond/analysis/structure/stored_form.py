"""The equations of a mode in what is stored alone, whatever the elimination had kept besides.

Which efforts and flows stay as pseudo-states depends on the reference mode, and with them would
all that is said of infinity: a kept force that holds a constraint has impulses, a kept flow that
an algebraic row gives is one constraint more. Eliminating them all gives ``E x' = A x + B u`` in
stored quantities, in which E lacks one rank per storage in derivative causality. Such a mode has
no impulses in x beyond the jump onto its constraints (index 1), as long as energy is positive.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hybond.equations.descriptor import Descriptor
from hybond.equations.ranks import Tracked, counted, scaled


def stored_form(d: Descriptor) -> Descriptor:
    """Return `d` without the pseudo-states that its rows determine.

    Those that algebraic rows give are put in first; the others (what holds a constraint) then by
    rows with rates, so that an output that reads one comes to read rates.

    Examples
    --------
    Two capacitors in parallel, kept as two rates and the current between them:

    >>> d = Descriptor.of([[1, 0, 0], [0, 1, 0], [0, 0, 0]], [[0, 0, -1], [0, 0, 1], [1, -0.5, 0]],
    ...                   [[1], [0], [0]], states=("a.q", "b.q", "i"), inputs=("J",), stored=2)
    >>> small = stored_form(d)
    >>> small.states, small.E.tolist(), small.A.tolist(), small.B.tolist()
    (('a.q', 'b.q'), [[1.0, 1.0], [0.0, 0.0]], [[0.0, 0.0], [1.0, -0.5]], [[1.0], [0.0]])
    """
    for with_rates in (False, True):
        d = _eliminated(d, with_rates=with_rates)
    return d


def _eliminated(d: Descriptor, *, with_rates: bool) -> Descriptor:
    """Return `d` without the pseudo-states that rows determine, those with rates or the others."""
    from scipy.linalg import qr

    n, first = len(d.states), d.stored
    columns = np.array(
        [k for k in range(first, n) if not (d.E[:, k].any() or d.F[:, k].any())], dtype=np.intp
    )
    rows = np.flatnonzero(d.E.any(axis=1) == with_rates)
    if not len(columns) or not len(rows):
        return d
    m = scaled(d).A[np.ix_(rows, columns)]
    values = np.linalg.svd(m, compute_uv=False)
    rank = counted(values, float(values[0])).value
    if not rank:
        return d
    chosen = np.sort(qr(m.T, mode="r", pivoting=True)[1][:rank])
    out = np.sort(qr(m[chosen], mode="r", pivoting=True)[1][:rank])
    rows, columns = rows[chosen], columns[out]
    others, stay = np.setdiff1d(np.arange(n), rows), np.setdiff1d(np.arange(n), columns)
    e, a, b = Tracked.of(d.E), Tracked.of(d.A), Tracked.of(d.B)
    c, direct, f = Tracked.of(d.C), Tracked.of(d.D), Tracked.of(d.F)
    inverse = a.take(rows, columns).inverse()
    # v_out = inverse (E_r v' - A_r v_stay - B_r u)
    other, shown = a.take(others, columns) @ inverse, c.take(columns=columns) @ inverse

    def put_in(m: Tracked, at: NDArray[np.intp], by: Tracked) -> NDArray[np.float64]:
        whole = m.take(others, at) + -by @ m.take(rows, at)
        return whole.value

    every = np.arange(d.B.shape[1])
    return Descriptor(
        put_in(e, stay, other),
        put_in(a, stay, other),
        put_in(b, every, other),
        (c.take(columns=stay) + -shown @ a.take(rows, stay)).value,
        (direct + -shown @ b.take(rows)).value,
        (f.take(columns=stay) + shown @ e.take(rows, stay)).value,
        tuple(d.states[k] for k in stay),
        d.inputs,
        d.outputs,
        first,
    )
