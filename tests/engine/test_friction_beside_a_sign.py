"""A mass that rubs by a junction and by a law ``sign(f)`` comes to rest, and rests by the junction.

The law has no value that holds, the junction has; both change at the same velocity. Implicit steps
that passed it had stages on either side, took what their error control lets pass for a motion, and
had the friction turn round, again and again.
"""

import math
from typing import Literal

import numpy as np
import pytest
from scipy.optimize import brentq

import hybond as hb

CASES = [
    # inertia, momentum, limit, of the sign, push, its frequency, end
    (1.1, -0.09, 1.79, 1.79, 0.85, 2.37, 2.4),
    (3.8, -0.65, 0.3, 0.39, 0.04, 1.69, 1.3),
    (0.34, 0.2, 0.63, 1.9, 0.5, 5.1, 2.1),
    (2.0, 0.5, 1.0, 0.7, 0.0, 1.0, 1.7),
    (1.2, 0.042, 2.5, 1.32, 1.9, 4.2, 5.0),
]


def at_rest(case: tuple[float, ...]) -> float:
    """Return when it comes to rest."""
    return float(brentq(lambda t: momentum(case, t) * math.copysign(1.0, case[1]), 0.0, 3.0))


def momentum(case: tuple[float, ...], t: float) -> float:
    """Return its momentum before that."""
    _, p, limit, sign, push, w, _ = case
    rubs = math.copysign(limit + sign, p)
    return p + push / w * (1.0 - math.cos(w * t)) - rubs * t


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", ["auto", "rk45", "radau"])
@pytest.mark.parametrize("law", ["coulomb", "relay"])
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("ratio", [1.0, -2.0])
@pytest.mark.parametrize("case", CASES, ids=["a", "b", "c", "d", "e"])
def test_friction_beside_a_sign_comes_to_rest_at_once(
    case: tuple[float, ...],
    ratio: float,
    turned: bool,
    law: Literal["coulomb", "relay"],
    solver: Literal["auto", "rk45", "radau"],
) -> None:
    inertia, p, limit, sign, push, w, end = case
    m = hb.Model("rubs")
    m.add(m=hb.I(inertia, p=p), v=hb.One(), r=hb.R({"e": f"{sign}*sign(f)"}))
    m.add(u=hb.Se(f"{-push if turned else push}*sin({w}*time)"), t=hb.TF(ratio))
    m.add(k=hb.One(law=law, limit=limit * abs(ratio)))
    m.bond("v -> u" if turned else "u -> v", "r -> v" if turned else "v -> r")
    m.bond("v -> m", "t.2 -> v", "k -> t.1")
    rest = at_rest(case)
    run = hb.simulate(m, end * rest, solver=solver)
    assert run.status == "ok"
    # it slips, and it sticks
    assert run.events.t[1:] == pytest.approx([rest], rel=3e-7)
    for t in np.linspace(0.0, 0.99, 7) * rest:
        assert run["m.p"].at(t) == pytest.approx(momentum(case, t), abs=1e-7 * abs(p))
    assert run["m.p"].at(end * rest) == 0.0
    assert run["r.e"].at(end * rest) == 0.0
