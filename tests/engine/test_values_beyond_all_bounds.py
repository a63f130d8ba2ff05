"""A value that is no number any more is not handed on as a run that went well.

Oracles: what an imposed motion stores is its integral, and the law says what that gives; below the
bound the run is right, beyond it there is none.
"""

from __future__ import annotations

import math

import pytest

import hybond as hb

WIDTH = 1e-3
REACHED = WIDTH * math.asinh(1e150)
"""How far a spring ``sinh(q/WIDTH)`` is pressed where it gives 1e150 N, m."""


def pressed(speed: str, turned: bool = False) -> hb.Model:
    m = hb.Model("pressed", domain="translational")
    m.add(push=hb.Sf(speed), spring=hb.C({"e": "1 [N]*sinh(q/(1 [mm]))"}), v=hb.One())
    m.bond("push -> v", "spring -> v" if turned else "v -> spring")
    return m


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("method", ["auto", "rk45", "radau", "qss2"])
def test_a_spring_that_is_pressed_beyond_all_forces_ends_the_run(method: str, turned: bool) -> None:
    model = pressed("1 m/s", turned)
    run = hb.simulate(model, 0.9 * REACHED, solver=method)
    q = float(run["spring.q"].at(0.3))
    assert abs(q) == pytest.approx(0.3, rel=1e-9)
    assert abs(float(run["spring.e"].at(0.3))) == pytest.approx(math.sinh(0.3 / WIDTH), rel=1e-6)
    with pytest.raises(hb.NumericsError, match="HB-N203") as refused:
        hb.simulate(model, 1.1 * REACHED, solver=method)
    assert "spring" in str(refused.value)


def test_a_flywheel_with_a_law_that_overflows_ends_the_run() -> None:
    m = hb.Model("spun", domain="rotational")
    m.add(push=hb.Se("1 N*m"), wheel=hb.I({"f": "1 [rad/s]*sinh(p/(1e-3 [N*m*s]))"}), w=hb.Zero())
    m.bond("push -> w -> wheel")
    assert hb.simulate(m, 0.9 * REACHED).status == "ok"
    with pytest.raises(hb.NumericsError, match=r"HB-N203 .*flow of bond 'w -> wheel'"):
        hb.simulate(m, 1.1 * REACHED)


def test_what_is_beyond_all_bounds_for_a_while_ends_the_run() -> None:
    # q = sin(2 pi t)/2: back at zero where the run ends
    model = pressed("pi*cos(2*pi*time/(1 s))*1 [m/s]")
    with pytest.raises(hb.NumericsError, match="HB-N203") as refused:
        hb.simulate(model, "1 s")
    assert 0.0 < refused.value.partial.t_end < 0.5


def test_a_resistor_that_overflows_under_a_flow_that_is_given_ends_the_run() -> None:
    m = hb.Model("forced", domain="electrical")
    m.add(i=hb.Sf("time*1 [A/s]"), r=hb.R({"e": "1 [V]*sinh(f/(1 [mA]))"}), n=hb.One())
    m.bond("i -> n -> r")
    run = hb.simulate(m, 0.9 * REACHED)
    assert float(run["r.e"].at(0.3)) == pytest.approx(math.sinh(0.3 / WIDTH), rel=1e-9)
    with pytest.raises(hb.NumericsError, match="HB-N203"):
        hb.simulate(m, 1.1 * REACHED)


def test_large_values_that_are_numbers_are_no_reason_to_stop() -> None:
    m = hb.Model("grows", domain="electrical")
    m.add(c=hb.C("1 F", q="1 C"), r=hb.R("-1 ohm"), n=hb.Zero())
    m.bond("n -> c", "n -> r")
    run = hb.simulate(m, "340 s")
    assert math.log(float(run["c.q"].at(340.0))) == pytest.approx(340.0, abs=1e-4)
    with pytest.raises(hb.NumericsError, match="HB-N203"):
        hb.simulate(m, "350 s")
