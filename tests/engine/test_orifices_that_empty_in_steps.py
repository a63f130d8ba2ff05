"""Time-stepping of tanks that empty through orifices, whose flow is a root of the level."""

import math

import pytest
from scipy.integrate import solve_ivp

import hybond as hb

ORIFICE = "0.5*sign(e)*sqrt(abs(e))"


@pytest.mark.parametrize("step", [1e-2, 0.37, 1.0])
@pytest.mark.parametrize(("size", "theta"), [(1.0, 0.5), (1e-6, 1.0)])
@pytest.mark.parametrize("turned", [False, True])
def test_a_tank_empties_and_stays_empty(
    step: float, size: float, theta: float, turned: bool
) -> None:
    """As sqrt(q) = 1 - t/4: at t = 4 Newton's method went to and fro about the foot of the root."""
    m = hb.Model("tank")
    root = math.sqrt(size)
    m.add(T=hb.C(1.0, q=-size if turned else size), p=hb.Zero())
    m.add(o=hb.R({"f": f"{root}*{ORIFICE}"}))
    m.bond("p -> T", "o -> p" if turned else "p -> o")
    run = hb.simulate(m, 8.0, method=hb.MoreauJean(step=step, theta=theta))
    assert abs(run["T.q"].at(8.0)) <= 1e-5 * size
    half = (1 - 2 / 4) ** 2 * size
    assert abs(run["T.q"].at(2.0)) == pytest.approx(half, abs=0.1 * step * size)


@pytest.mark.parametrize("law", [ORIFICE, "0.5*sqrt(max(e, 0))"])
def test_a_tank_that_is_filled_anew_leaves_its_stop(law: str) -> None:
    """A stop at level zero carries nothing; the next half of the wave fills the tank again."""
    m = hb.Model("tank")
    m.add(T=hb.C(1.0, q=1.0), p=hb.Zero(), o=hb.R({"f": law}), stop=hb.One(law="diode"))
    m.add(rain=hb.Sf("0.5*max(sin(1*time), 0)"))
    m.bond("rain -> p -> T", "p -> o", "stop -> p")
    run = hb.simulate(m, 15.0, method=hb.MoreauJean(step=1e-2))

    def rate(t: float, q: list[float]) -> list[float]:
        return [0.5 * max(math.sin(t), 0) - 0.5 * math.sqrt(max(q[0], 0))]

    want = solve_ivp(rate, [0, 15], [1.0], rtol=1e-8, atol=1e-10, max_step=0.05, dense_output=True)
    for t in (5.0, 6.25, 8.0, 12.5, 14.0, 15.0):
        assert run["T.q"].at(t) == pytest.approx(want.sol(t)[0], abs=1e-4)


@pytest.mark.slow
def test_a_row_of_tanks_empties() -> None:
    """What the first held leaves through the last; nothing is left, and nothing is made."""
    m = hb.Model("row")
    for i in range(3):
        m.add({f"T{i}": hb.C(1.0, q=0.0 if i else 1.0), f"p{i}": hb.Zero(), f"j{i}": hb.One()})
        m.add({f"o{i}": hb.R({"f": ORIFICE})})
        m.bond(f"p{i} -> T{i}", f"p{i} -> j{i} -> o{i}")
    m.bond("j0 -> p1", "j1 -> p2")
    m.signal(out=hb.Integral("o2.f"))
    run = hb.simulate(m, 14.0, method=hb.MoreauJean(step=1e-2))
    left = sum(run[f"T{i}.q"].at(14.0) for i in range(3))
    assert abs(left) < 1e-9
    assert run["out"].at(14.0) == pytest.approx(1.0, rel=1e-9)
