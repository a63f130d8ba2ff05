"""One-way valves by Bernoulli: as they close, flow is a root of what is left of the pressure.

A step that reached far beyond the closing had it too soon, and one that ended there did not come to
it. After eight of those the kink was passed over by a step a thousand times as long, of which only
the first stage knew of any flow: its error was two hundred times what it was taken for, and the
audit found the energy that was missing.
"""

import functools
import math

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import hybond as hb

LAWS = {"if": "if e > 0 then sqrt(e/{b}) else 0", "max": "sqrt(max(e, 0)/{b})"}


TIMES = np.linspace(0.01, 1.99, 100)


def sizes(which: int) -> tuple[float, float, float]:
    """Return the loss, the capacity and the resistance behind it."""
    rng = np.random.default_rng(0)
    drawn = [rng.uniform([-6, 0.8, 0.3], [-4, 2.5, 1.3]) for _ in range(8)]
    power, c, r = (float(x) for x in drawn[which])
    return 10**power, c, r


@functools.cache
def followed(which: int) -> NDArray[np.float64]:
    """Return the pressure behind the valve by SciPy, however the law is written."""
    b, c, r = sizes(which)

    def rate(t: float, p: list[float]) -> list[float]:
        left = 100 * math.sin(2 * math.pi * t) ** 2 - p[0]
        return [((math.sqrt(left / b) if left > 0 else 0.0) - p[0] / r) / c]

    found = solve_ivp(
        rate, [0, 2], [60.0], method="Radau", rtol=1e-11, atol=1e-10, t_eval=TIMES, max_step=0.01
    )
    return np.asarray(found.y[0])


@pytest.mark.parametrize("solver", ["auto", "radau", "rk45"])
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize(("which", "turned"), [(1, False), (7, True)])
@pytest.mark.sampled(1)
@pytest.mark.slow
def test_a_valve_closes_within_the_tolerance(
    solver: str, law: str, which: int, turned: bool
) -> None:
    b, c, r = sizes(which)
    m = hb.Model("artery")
    parts = {"heart": hb.Se("100*sin(2*pi*time)^2"), "v": hb.One(), "n": hb.Zero()}
    parts |= {"loss": hb.R({"f": LAWS[law].format(b=b)}), "c": hb.C(c, e=60.0), "r": hb.R(r)}
    m.add(**(dict(reversed(parts.items())) if turned else parts))
    m.bond("heart -> v -> n", "v -> loss")
    m.bond(*(["c -> n", "r -> n"] if turned else ["n -> c", "n -> r"]))
    run = hb.simulate(m, until=2.0, solver=solver)
    assert run.audit().holds()
    assert run["n.e"].at(TIMES.tolist()) == pytest.approx(followed(which), abs=2e-5)
