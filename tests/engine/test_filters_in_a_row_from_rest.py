"""A step that reaches a plant through filters in a row begins there as a high power of time."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm

import hybond as hb

SOLVERS = ("auto", "rk45", "radau", "exact")
UNTIL, INERTIA, DRAG = 1.0, 1.3, 0.7
WAYS = ("law", "input", "machine")


def followed(taus: tuple[float, ...], gain: float, loop: float, at: float, high: float) -> list:
    """Return speed, angle and what the last filter has at the end, by one exponential."""
    n = len(taus)
    a = np.zeros((n + 3, n + 3))
    a[0, 0], a[0, n + 1], a[1, 0] = -(DRAG + 3) / INERTIA, gain / INERTIA, 1
    a[2, 1], a[2, n + 2] = -loop / taus[0], high / taus[0]
    for k, tau in enumerate(taus):
        a[2 + k, 2 + k] = -1 / tau
        if k > 0:
            a[2 + k, 1 + k] = 1 / tau
    begin = np.zeros(n + 3)
    begin[-1] = 1
    end = expm(a * (UNTIL - at)) @ begin
    return [end[0], end[1], end[n + 1]]


def servo(
    taus: tuple[float, ...], gain: float, loop: float, at: float, high: float, way: str
) -> hb.Model:
    """Return a shaft at rest whose reference is filtered; the filters are signals."""
    m = hb.Model("servo", domain="rotational")
    m.add(J=hb.I(INERTIA), drag=hb.R(DRAG), w=hb.One(), M=hb.Se("u"))
    m.bond("M -> w", *(("J -> w", "w -> drag") if way == "input" else ("w -> J", "drag -> w")))
    if way == "law":
        m.signal(ref=f"if time >= {at} then {high} else 0" if at > 0 else f"{high}")
    elif way == "input":
        m.input(ref=hb.Input(table=[[0, 0], [at, high]] if at > 0 else [[0, high]]))
    else:
        m.machine(
            "go", states={"no": [], "yes": []}, start="no", rules=[f"no -> yes when time >= {at}"]
        )
        m.signal(ref=f'if go.state == "yes" then {high} else 0')
    last = f"f{len(taus)}"
    m.signal(x=hb.Integral("w.f"), u=f"{gain}*{last} - 3*w.f")
    before = f"ref - {loop}*x"
    # declared from the last to the first, or the other way round
    filters = {f"f{k + 1}": (k, tau) for k, tau in enumerate(taus)}
    for name, (k, tau) in sorted(filters.items(), reverse=way == "machine"):
        read = before if k == 0 else f"f{k}"
        m.signal(**{name: hb.Integral(f"({read} - {name})/{tau}")})
    return m


@pytest.mark.sampled(3)
@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize(
    ("taus", "gain", "loop", "high"),
    [
        ((0.01,) * 4, 5.0, 1.0, 1.0),
        ((0.02, 0.003, 0.05, 0.0004), 12.0, 1.0, 1e-6),
        ((0.01,) * 7, 5.0, 0.0, 300.0),
        ((0.03, 0.01, 0.02), 8.0, 1.0, 0.2),
    ],
)
def test_filters_in_a_row_begin_from_rest(
    taus: tuple[float, ...], gain: float, loop: float, high: float, solver: str, way: str
) -> None:
    """No step was small enough for what begins as a power of time; all methods were refused."""
    for at in (0.0, 0.3):
        run = hb.simulate(servo(taus, gain, loop, at, high, way), UNTIL, solver=solver)
        got = [float(run[name].at(UNTIL)) for name in ("w.f", "x", f"f{len(taus)}")]
        np.testing.assert_allclose(got, followed(taus, gain, loop, at, high), rtol=1e-6)
        assert float(run["w.f"].at(0.5 * at)) == 0.0
        assert run.audit().holds()
