"""What a relay leads along a reference that begins to move, or bends, while it is led.

From rest along ``max(0, time - 0.5)`` what is led had no size, as nothing had moved: no step over
the bend was short enough (HB-N201); nor was one along its square, where what the mean moves by is
rounding of what either mode would. Where friction, or a law of one side, has to let go at a bend
that is no event, it did, and the run was said to be unsound.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

SOLVERS = ["auto", "radau", "rk45"]
LATE: dict[str, Callable[[float], float]] = {
    "2*max(0, time - 0.5)": lambda t: 2 * max(0.0, t - 0.5),
    "max(0, sin(3*time - 1.5))": lambda t: max(0.0, math.sin(3 * t - 1.5)),
    "min(0, 0.5 - time)": lambda t: min(0.0, 0.5 - t),
    "if time < 0.5 then 0 else 2*(time - 0.5)": lambda t: 2 * max(0.0, t - 0.5),
    "2*max(0, time - 0.5)^2": lambda t: 2 * max(0.0, t - 0.5) ** 2,
    "max(0, sin(3*time - 1.5))^2": lambda t: max(0.0, math.sin(3 * t - 1.5)) ** 2,
    "if time < 0.5 then 0 else (time - 0.5)^3": lambda t: max(0.0, t - 0.5) ** 3,
}


def led(ref: str, *, mass: float = 1.0, start: float = 0.0, dual: bool = False) -> hb.Model:
    """Return what a relay of 5 each way leads along `ref`, and its dual."""
    m = hb.Model("led")
    push = 'if q.state == "on" then 5 else -5'
    if dual:
        m.add(d=hb.Sf(push), w=hb.Zero(), i=hb.C(mass, e=start))
    else:
        m.add(d=hb.Se(push), w=hb.One(), i=hb.I(mass, f=start))
    m.bond("d -> w -> i")
    m.signal(ref=ref)
    x = "w.e" if dual else "w.f"
    rules = [f"off -> on when {x} < ref", f"on -> off when {x} > ref"]
    m.machine("q", states={"off": [], "on": []}, start="off", rules=rules)
    return m


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("ref", LATE)
@pytest.mark.parametrize(("mass", "dual"), [(1.0, False), (1e-3, False), (1e-6, True), (0.2, True)])
def test_it_is_led_from_rest_where_that_begins_late(
    mass: float, dual: bool, ref: str, solver: str
) -> None:
    run = hb.simulate(led(ref, mass=mass, dual=dual), until=1.0, solver=solver)
    assert run.status == "ok" and run.audit().holds()
    for t in (0.3, 0.7, 1.0):
        assert run["w.e" if dual else "w.f"].at(t) == pytest.approx(LATE[ref](t), abs=1e-8)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("ref", ["1 + 20*max(0, time - 0.5)", "max(1, 1 + 20*(time - 0.5))"])
def test_it_is_left_behind_where_the_reference_is_too_fast(ref: str, solver: str) -> None:
    run = hb.simulate(led(ref, start=1.0), until=1.0, solver=solver)
    assert run.status == "ok"
    assert run["w.f"].at(0.4) == pytest.approx(1.0, abs=1e-9)
    assert run["w.f"].at(1.0) == pytest.approx(1.0 + 5 * 0.5, abs=1e-8)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("drive", [12.0, 60.0])
@pytest.mark.parametrize(
    "ref",
    ["1 + 4*max(0, time - 0.5)", "max(1, 4*time - 1)", "1 + 2*(abs(time - 0.5) + time - 0.5)"],
)
def test_friction_lets_go_where_the_reference_bends(ref: str, drive: float, solver: str) -> None:
    m = hb.Model("disc")
    m.add(drive=hb.Se(f'if q.state == "on" then {drive} else {-drive}'), w1=hb.One(), w2=hb.One())
    m.add(shaft=hb.I(0.3, f=1.0), wheel=hb.I(0.6, f=1.0), drag=hb.R(0.3), between=hb.Zero())
    m.add(disc=hb.One(law="coulomb", limit=2.0))
    m.bond("drive -> w1 -> shaft", "w1 -> between -> w2 -> wheel", "w2 -> drag", "between -> disc")
    m.signal(ref=ref)
    rules = ["off -> on when w1.f < ref", "on -> off when w1.f > ref"]
    m.machine("q", states={"off": [], "on": []}, start="off", rules=rules)
    run = hb.simulate(m, until=1.0, solver=solver)
    assert run.status == "ok" and run.audit().holds()
    # 0.6*4 + 0.3 is more than 2: the wheel goes on with the limit
    alone = solve_ivp(lambda t, w: (2.0 - 0.3 * w) / 0.6, (0.5, 1.0), [1.0], rtol=1e-10, atol=1e-12)
    assert run["w1.f"].at(1.0) == pytest.approx(3.0, abs=1e-8)
    assert run["w2.f"].at(1.0) == pytest.approx(alone.y[0, -1], abs=1e-7)
    t = np.linspace(0.01, 0.99, 50)
    assert np.max(np.abs(run["disc.e"].at(t))) <= 2.0 + 1e-9
