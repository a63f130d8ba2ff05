"""Motion that begins from rest, where a force grows from zero like a power of time."""

from pathlib import Path

import pytest
from export.programs import ask, compile_quickly, needs_c, read_events

import hybond as hb


def pushed(power: int) -> hb.Model:
    """A mass and a spring; without the spring the momentum is t^(n + 1)/(n + 1)."""
    m = hb.Model("pushed", domain="translational")
    m.add(F=hb.Se(f"1 [N]*time^{power}/1[s^{power}]"), v=hb.One(), m=hb.I("1 kg"))
    m.bond("F -> v -> m")
    m.experiment["until"] = 2.0
    return m


@pytest.mark.sampled(3)
@pytest.mark.parametrize("solver", ["rk45", "radau"])
@pytest.mark.parametrize("power", [3, 4, 8])
def test_a_power_of_time(power, solver):
    run = hb.simulate(pushed(power), solver=solver)
    assert run.final["m.p"] == pytest.approx(2.0 ** (power + 1) / (power + 1), rel=1e-7)
    assert run.stats["steps"] < 5000


@pytest.mark.sampled(1)
@needs_c
@pytest.mark.parametrize("solver", ["rk45", "radau"])
@pytest.mark.slow
def test_a_power_of_time_in_a_program(solver, tmp_path: Path):
    program = compile_quickly(hb.export(pushed(8), to="c", solver=solver), tmp_path, "pushed")
    said = read_events(ask(program, "--events"))
    assert said.states["m.p"] == pytest.approx(2.0**9 / 9.0, rel=1e-7)


DAMPERS = {
    "linear": 3.2,
    "hardening": {"e": "0.448*((f/0.14) + (f/0.14)^3)"},
    "stiffer": {"e": "1.2*(f/0.14 + (f/0.14)^3)"},
}


@pytest.mark.parametrize("law", DAMPERS.values(), ids=DAMPERS)
@pytest.mark.parametrize("limit", [0.392, 0.25])
def test_an_implicit_method_from_rest(law: object, limit: float) -> None:
    """A Jacobian made at rest is of rounding: it must not serve what has come to move."""
    runs = []
    for solver in ("radau", "rk45"):
        m = hb.Model("driven")
        m.add(i=hb.I(0.5614973262032086), r=hb.R(law), s=hb.Se("0.441*sin(24.2*time)"))
        m.add(lead=hb.R(1.0), at=hb.One(), g=hb.R({"f": "2.79*tanh(e/0.333)"}))
        m.add(v=hb.One(law="diode"), a=hb.Zero(law="relay", limit=limit))
        m.add(b=hb.Zero(law="relay", limit=3.26))
        m.bond("a -> v", "v -> r", "i -> v", "g -> b", "b -> a", "s -> at", "at -> v", "at -> lead")
        runs.append(hb.simulate(m, until=0.18, solver=solver))
    radau, rk45 = (run["i.p"].at([0.03, 0.06, 0.12]) for run in runs)
    assert abs(rk45).max() > 1e-3
    assert radau == pytest.approx(rk45, rel=1e-6)
