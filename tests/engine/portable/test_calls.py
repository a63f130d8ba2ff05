"""Inputs that are functions, and blocks, in the engine as Python runs it."""

import math

import pytest
from portable_runs import assert_the_same

import hybond as hb


def loop() -> hb.Model:
    """A flywheel in a wind, held by a controller; a brake that a guard on the wind sets."""
    m = hb.Model("loop", domain="rotational")
    m.add(J=hb.I("0.5 kg*m^2"), B=hb.R("0.1 N*m*s/rad"), torque=hb.Se("wind + ctl.u"))
    m.add(w=hb.One(), brake=hb.Zero(), D=hb.G("2 rad/(N*m*s)"))
    m.bond("torque -> w -> J", "w -> B", "w -> brake -> D")
    wind = hb.Input(function=lambda t: math.sin(9.0 * t) + (0.0 if t < 0.4 else 0.7), breaks=[0.4])
    m.input(wind=wind)

    def control(t: float, u: dict[str, float]) -> dict[str, float]:
        return {"u": 2.0 * (1.0 - u["speed"])}

    m.block(ctl=hb.Block(control, inputs={"speed": "w.f"}, outputs=["u"], every="50 ms"))
    rules = ["free -> braking when wind > 0.8", "braking -> free when wind < -0.2"]
    m.machine("guardian", states={"free": [], "braking": ["brake"]}, start="free", rules=rules)
    return m


def test_functions_are_called_by_the_engine_as_python(monkeypatch: pytest.MonkeyPatch) -> None:
    run, _ = assert_the_same(loop(), monkeypatch, until=1.0)
    assert [event.cause for event in run.events[1:]] == ["guard"] * 3


def test_what_a_function_raises_goes_through(monkeypatch: pytest.MonkeyPatch) -> None:
    m = loop()
    m.inputs["wind"] = hb.Input(function=lambda t: 1.0 / (t < 0.5))
    with pytest.raises(ZeroDivisionError):
        assert_the_same(m, monkeypatch, until=1.0)
