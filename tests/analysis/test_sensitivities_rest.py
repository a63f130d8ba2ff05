"""Derivatives behind impacts that accumulate: geometric series, and what rests afterwards."""

import numpy as np
import pytest

import hybond as hb


def ball(eps: float, force: str = "0 N") -> hb.Model:
    m = hb.Model("ball", domain="translational", parameters={"eps": eps, "g": "10 m/s^2", "k": 5.0})
    m.add(weight=hb.Se(f"-g*(1 kg) + {force}"), ball=hb.I("1 kg"), v=hb.One())
    m.add(floor=hb.Zero(law="unilateral", gap="h", restitution="eps"))
    m.bond("weight -> v -> ball", "floor -> v")
    m.signal(h=hb.Integral("v.f", start="5 m"))
    return m


@pytest.mark.sampled(1)
@pytest.mark.parametrize("eps", [0.3, 0.8])
def test_the_limit_of_a_ball_that_comes_to_rest(eps: float) -> None:
    wrt = ["eps", "g", "h.start"]
    s = hb.sensitivities(ball(eps), "15 s", wrt=wrt, of=["v.f", "h"])
    # T = (1 + eps)/(1 - eps) sqrt(2 h/g), h = 5 m, g = 10 m/s^2
    T = (1 + eps) / (1 - eps)
    assert s.ends is None and s.events[-1].text == "impacts come to rest"
    assert s.events[-1].t == pytest.approx(T, rel=1e-9)
    assert s.events[-1].by == pytest.approx([2 / (1 - eps) ** 2, -T / 20, T / 10], rel=1e-9)
    assert s.derivatives[-1] == pytest.approx(np.zeros((2, 3)), abs=1e-12)
    goal = hb.EventTime(len(s.run.events) - 1)
    assert hb.gradient(ball(eps), goal, "15 s", wrt=wrt).by == pytest.approx(
        s.events[-1].by, rel=1e-9
    )


def test_a_ball_that_is_lifted_from_its_rest() -> None:
    m = ball(0.4, "(1 N)*k*max(time - 4 [s], 0 s)/(1 s)")
    s = hb.sensitivities(m, "8 s", wrt=["eps", "g", "k", "h.start"], of=["v.f", "h"])
    g, k = 10.0, 5.0
    t = 8.0 - (4.0 + g / k)  # behind the instant at which the force is the weight
    # v = k t^2/2, h = k t^3/6
    assert s["v.f"][-1] == pytest.approx([0, -t, t * t / 2 + t * g / k, 0], rel=1e-8, abs=1e-9)
    assert s["h"][-1] == pytest.approx(
        [0, -t * t / 2, t**3 / 6 + t * t / 2 * g / k, 0], rel=1e-8, abs=1e-9
    )
    lifted = next(e for e in s.events if e.t > 4.5)
    assert lifted.by == pytest.approx([0, 1 / k, -g / k**2, 0], rel=1e-8, abs=1e-9)


def test_a_ball_comes_to_rest_on_a_plate_that_flies() -> None:
    values = {"m": 1.5, "M": 2.5, "eps": 0.5, "g": 10.0}
    m = hb.Model("plate", domain="translational", parameters=values)
    m.add(weight=hb.Se("-m*g*(1 N)"), ball=hb.I("m*(1 kg)"), v=hb.One())
    m.add(plate=hb.I("M*(1 kg)"), w=hb.One())
    m.add(on=hb.Zero(law="unilateral", gap="h - y", restitution="eps"))
    m.bond("weight -> v -> ball", "w -> on -> v", "w -> plate")
    m.signal(h=hb.Integral("v.f", start="1 m"), y=hb.Integral("w.f"))
    wrt = ["m", "M", "eps", "g", "h.start"]
    s = hb.sensitivities(m, "3 s", wrt=wrt, of=["v.f", "y"], rtol=1e-10)
    assert s.ends is None and len(s.run.accumulations) == 1
    mm, M, eps, g, h, t = *values.values(), 1.0, 3.0
    both = mm + M
    # momentum, and the centre of mass, whatever the impacts were
    fall = g * t * t / 2
    assert s["v.f"][-1] == pytest.approx(
        [-g * t * M / both**2, mm * g * t / both**2, 0, -mm * t / both, 0], rel=1e-7, abs=1e-7
    )
    assert s["y"][-1] == pytest.approx(
        [(h - fall) * M / both**2, -(h - fall) * mm / both**2, 0, -mm / both * t * t / 2,
         mm / both],
        rel=1e-7, abs=1e-7,
    )  # fmt: skip
    T = (1 + eps) / (1 - eps) * np.sqrt(2 * h / g)
    landed = next(e for e in s.events if e.text == "impacts come to rest")
    own = [0, 0, 2 * np.sqrt(2 * h / g) / (1 - eps) ** 2, -T / (2 * g), T / (2 * h)]
    assert landed.by == pytest.approx(own, rel=1e-7, abs=1e-7)
    goal = hb.Final("y")
    back = hb.gradient(m, goal, "3 s", wrt=wrt, rtol=1e-10)
    # back through impacts that hardly differ it keeps fewer digits
    assert back.by == pytest.approx(s["y"][-1], rel=1e-7, abs=1e-7)
