"""A diode in the loop of a steep amplifier: what follows a sine is its closed form.

The output follows within 1e-15 s: its rates are as many times the rounding of time as well.
"""

import math

import numpy as np
import pytest

import hybond as hb
from hybond.engine.guards import guard_values

BEGINS, ENDS = 5.000000269e-4, 5.0000002705e-4
"""Where the output begins to follow: within 1e-14 s, and 0.5 ms is rounded to 1e-19 s."""


def rectifier(
    gain: float, wave: str, *, turned: bool, back: bool, drop: float = 0.8, ohm: float = 0.03
) -> hb.Model:
    m = hb.Model("rectifier", parameters={"w": 2000.0 * math.pi})
    m.add(vi=hb.Se(wave), b=hb.Se(f"12*tanh(-{gain}*x.e)"), c=hb.C(1e-9), load=hb.R(1e4))
    m.add(r1=hb.R(1e4), r2=hb.R(1e4), i=hb.One(), j=hb.One(), x=hb.Zero(), o=hb.Zero())
    m.add(y=hb.Zero(), d=hb.One(law="diode"), dr=hb.R(ohm), dv=hb.Se(drop))
    m.bond("vi -> i -> x", "i -> r1", "j -> r2", "b -> y", "o -> c", "o -> load", "d -> dr")
    m.bond("d -> dv", "o -> j -> x" if turned else "x -> j -> o", "y -> d -> o")
    if back:
        m.add(e=hb.One(law="diode"), er=hb.R(ohm), ev=hb.Se(drop))
        m.bond("x -> e -> y", "e -> er", "e -> ev")
    return m


@pytest.mark.parametrize("gain", [1e4, 1e5])
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("back", [False, True])
@pytest.mark.parametrize("size", [1.0, 0.01])
def test_a_precision_rectifier_late_in_time_comes_to_its_end(
    size: float, gain: float, *, back: bool, turned: bool
) -> None:
    """A half turn took thousands of steps, 1e-10 s each; or the diode switched for ever."""
    m = rectifier(gain, f"{size}*sin(w*time)", turned=turned, back=back)
    run = hb.simulate(m, 1e-3, max_steps=900)
    assert run.status == "ok"
    for t in np.linspace(0.55e-3, 0.95e-3, 9):
        # x = -tanh^-1((v + 0.8)/12)/gain, but for the drop on 0.03 ohm
        v = -size * math.sin(2000.0 * math.pi * t)
        x = math.atanh((v + 0.8) / 12.0) / gain
        assert run["c.e"].at(t) == pytest.approx(v - 2.0 * x, rel=1e-4, abs=1e-7)


@pytest.mark.parametrize("turned", [False, True])
def test_samples_as_rough_as_the_gain_makes_them_are_not_halved(
    monkeypatch: pytest.MonkeyPatch, *, turned: bool
) -> None:
    """At the onset each step took up to 128 blocks of nine instants, of noise from the gain."""
    m = rectifier(1e4, "sin(w*time)", turned=turned, back=True, drop=0.008, ohm=1.0)
    before = hb.simulate(m, BEGINS).state()
    looks = 0
    look_on = guard_values.look_on

    def counted(*given: object) -> None:
        nonlocal looks
        looks += 1
        look_on(*given)

    monkeypatch.setattr(guard_values, "look_on", counted)
    run = hb.simulate(m, ENDS, start=before, engine="python", max_steps=40)
    assert run.status == "ok"
    assert 0 < looks < 300 * run.stats["steps"]  # with halving 2800 a step
