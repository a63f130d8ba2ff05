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
def test_a_power_of_time_in_a_program(solver, tmp_path: Path):
    program = compile_quickly(hb.export(pushed(8), to="c", solver=solver), tmp_path, "pushed")
    said = read_events(ask(program, "--events"))
    assert said.states["m.p"] == pytest.approx(2.0**9 / 9.0, rel=1e-7)
