"""Tables that repeat against SciPy's PCHIP, cams and followers against their kinematics."""

import numpy as np
import pytest
from library.bench import every_way
from library.trials import instants, trials
from scipy.interpolate import PchipInterpolator

import hybond as hb

LIFTS = np.array([0, 0, 0, 2.5, 7.5, 10, 7.5, 2.5, 0, 0, 0, 0]) * 1e-3


def curve(values: np.ndarray) -> PchipInterpolator:
    """Return three periods of it: the middle one knows what comes before and after."""
    return PchipInterpolator(np.arange(-12, 25), np.append(np.tile(values, 3), values[0]))


def test_a_table_that_repeats_is_the_monotone_cubic_of_scipy() -> None:
    """``"control.periodic_table"``: forwards and backwards, over several periods."""
    values = np.array([3.0, 1, 4, 1, 5, 9, 2, 6, 5, 3, 5, 8])
    m = hb.Model("table")
    given = {f"y_{k}": float(y) for k, y in enumerate(values)}
    at = "20*sin(2 [1/s]*time) - 4"
    m.add(t=hb.Submodel("control.periodic_table", inputs={"at": at}, period=10, **given))
    run = hb.simulate(m, until=2.0)
    t = np.linspace(0.05, 1.95, 80)
    x = np.mod((20 * np.sin(2 * t) - 4) * 1.2, 12)
    known = curve(values)
    assert run["t.out"].at(t) == pytest.approx(known(x), abs=1e-9)
    assert run["t.slope"].at(t) == pytest.approx(known(x, 1) * 1.2, abs=1e-9)
    assert run["t.out"].at(t).min() >= 1 and run["t.out"].at(t).max() <= 9


CAM = {f"lift_{k}": float(y) for k, y in enumerate(LIFTS)}


@pytest.mark.sampled(1)
@pytest.mark.parametrize("speed", [20.0, -20.0])
@pytest.mark.slow
def test_a_pressed_follower_keeps_to_the_cam(speed: float) -> None:
    """``"rotational.cam"``: its way, the contact's force and the torque by virtual work."""
    mass, load, first = 0.2, 80.0, 2 if speed > 0 else 8  # at the feet of its lift
    parts = {
        "s": hb.Submodel("rotational.speed", inputs={"speed": speed}),
        "c": hb.Submodel("rotational.cam", angle0=f"{30 * first} deg", **CAM),
        "m": hb.Submodel("translational.mass", m=mass),
        "f": hb.Submodel("translational.force", inputs={"force": -load}),
    }
    known, t = curve(LIFTS), np.linspace(0.002, 0.058, 7)
    x = np.mod(first + 6 / np.pi * speed * t, 12)
    by_angle = 6 / np.pi
    m = hb.Model("engine", domain="rotational")
    m.add(**parts)
    m.bond("f.flange -> m.flange")
    for way in every_way(m, "s.shaft - c.shaft", "c.follower - m.flange")[::3]:
        run = hb.simulate(way, until=0.06, rtol=1e-8)
        assert instants(run) == [] and run["c.touches"].at(0.05) == 1
        assert run["m.speed"].at(t) == pytest.approx(known(x, 1) * by_angle * speed, abs=1e-7)
        assert run["c.position"].at(t) == pytest.approx(known(x), abs=1e-8)
        force = load + mass * known(x, 2) * (by_angle * speed) ** 2
        assert run["c.force"].at(t) == pytest.approx(force, rel=1e-5)
        assert run["c.torque"].at(t) == pytest.approx(force * known(x, 1) * by_angle, abs=1e-5)


def test_a_follower_that_is_too_slow_leaves_the_cam_and_comes_back() -> None:
    """It flies from where the cam would have to pull, on a parabola, and meets the cam."""
    mass, load, speed = 0.2, 20.0, 100.0
    parts = {
        "s": hb.Submodel("rotational.speed", inputs={"speed": speed}),
        "c": hb.Submodel("rotational.cam", angle0="60 deg", **CAM),
        "m": hb.Submodel("translational.mass", m=mass),
        "f": hb.Submodel("translational.force", inputs={"force": -load}),
    }
    known, rate = curve(LIFTS), 6 / np.pi * speed
    fine = np.linspace(2.001, 5, 200001)
    leaves = fine[np.argmax(load + mass * known(fine, 2) * rate**2 < 0)]
    lift, v = known(leaves), known(leaves, 1) * rate
    after = (np.linspace(leaves, 12, 200001) - leaves) / rate
    flight = lift + v * after - load / mass * after**2 / 2
    lands = after[np.argmax(flight[10:] < known(np.linspace(leaves, 12, 200001))[10:]) + 10]
    times = [(leaves - 2) / rate, (leaves - 2) / rate + lands]
    joints = "s.shaft -> c.shaft, c.follower -> m.flange, f.flange -> m.flange"
    for run in trials(joints, times[-1] + 1e-3, rtol=1e-8, **parts):
        assert instants(run)[:2] == pytest.approx(times, rel=1e-4)
        middle = (times[0] + times[1]) / 2
        assert run["c.touches"].at(middle) == 0 and run["c.force"].at(middle) == 0
        high = lift + v * lands / 2 - load / mass * (lands / 2) ** 2 / 2
        assert run["c.position"].at(middle) == pytest.approx(high, rel=1e-4)
        assert run["c.gap"].at(middle) > 0
