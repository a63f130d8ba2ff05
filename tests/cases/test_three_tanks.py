"""Three tanks with overflow against their three equations, and no water lost."""

import math

import pytest
from scipy.integrate import solve_ivp

G, RHO, HOLE, CD, LAM = 9.81, 1000.0, 4e-4, 0.7, 100.0
AREAS, EDGES = (0.1, 0.1, 0.4), (0.6, 0.4)


def hole(a, b):
    dp = RHO * G * (a - b)
    return CD * HOLE * math.sqrt(2 / RHO) * dp / (dp**2 + LAM**2) ** 0.25


def weir(level, edge):
    return 2 / 3 * 0.6 * 0.1 * math.sqrt(2 * G) * max(level - edge, 0.0) ** 1.5


def field(t, z, feed):
    a, b, c, _ = z
    over1, over2 = weir(a, EDGES[0]), weir(b, EDGES[1])
    q1, q2, q3 = hole(a, b), hole(b, c), hole(c, 0.0)
    return [
        (feed - q1 - over1) / AREAS[0],
        (q1 + over1 - q2 - over2) / AREAS[1],
        (q2 + over2 - q3) / AREAS[2],
        q3,
    ]


@pytest.fixture(scope="module")
def run(simulate):
    return simulate("three_tanks", rtol=1e-9)


def test_levels_follow_the_equations(run):
    events = [lambda t, z, _, k=k: z[k] - EDGES[k] for k in (0, 1)]
    options = {"method": "DOP853", "rtol": 1e-11, "atol": 1e-13, "events": events}
    fed = solve_ivp(field, (0, 120), [0.2, 0.1, 0.1, 0], args=(3e-3,), dense_output=True, **options)
    free = solve_ivp(field, (120, 300), fed.y[:, -1], args=(0.0,), dense_output=True, **options)
    for t in (10.0, 60.0, 119.0, 130.0, 250.0, 300.0):
        levels = (fed if t < 120 else free).sol(t)
        for name, level in zip(("first", "second", "third"), levels, strict=False):
            assert run[f"{name}.level"].at(t) == pytest.approx(level, rel=1e-6)
    edges = sorted(t for part in (fed, free) for ends in part.t_events for t in ends)
    assert len(edges) == 4
    assert [e.t for e in run.events if e.cause == "guard"] == pytest.approx(edges, rel=1e-6)
    # what was there and was fed is in the tanks, or has left
    volumes = sum(run[f"{name}.volume"].at(300) for name in ("first", "second", "third"))
    left = float(free.y[3, -1])
    assert volumes + left == pytest.approx(0.02 + 0.01 + 0.04 + 3e-3 * 120, rel=1e-6)
