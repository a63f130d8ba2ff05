"""Tables that repeat, as a netlist's pulses do, in exported programs."""

from pathlib import Path

import needs
import numpy as np
import pytest
from export.programs import ask, compile_quickly, expected, needs_c, needs_java, read_events

import hybond as hb

NETLISTS = Path(__file__).parents[2] / "examples" / "netlists"
UNTIL = {"flyback": "0.3 ms", "switches": "10 ms"}


def repeating() -> hb.Model:
    """Three tables that charge three capacitors."""
    m = hb.Model("repeating")
    m.add(a=hb.Sf("held"), b=hb.Sf("saw"), c=hb.Sf("late"))
    m.add(x=hb.C(1), y=hb.C(1), z=hb.C(1), nx=hb.Zero(), ny=hb.Zero(), nz=hb.Zero())
    m.bond("a -> nx -> x", "b -> ny -> y", "c -> nz -> z")
    m.input(
        held=hb.Input(table=[(0, 1), (0.25, -1), (0.5, 3)], period=1),
        saw=hb.Input(table=[(0, 0), (2, 4), (2, -1), (2.5, 0)], linear=True, period=2.5),
        late=hb.Input(table=[(0.3, 2), (0.5, 0), (0.7, 2)], linear=True, period=0.4),
    )
    m.experiment["until"] = 6.0
    return m


def charges(t: float) -> dict[str, float]:
    """Return what they hold, by the areas below the tables."""
    fine = np.linspace(0.0, t, 600_001)
    mid = 0.5 * (fine[1:] + fine[:-1])
    held = np.select([mid % 1 < 0.25, mid % 1 < 0.5], [1.0, -1.0], 3.0)
    saw = np.where(mid % 2.5 < 2, 2 * (mid % 2.5), -1 + 2 * (mid % 2.5 - 2))
    late = np.where(mid < 0.3, 2.0, np.abs((mid - 0.3) % 0.4 - 0.2) * 10)
    step = fine[1]
    return {"x": held.sum() * step, "y": saw.sum() * step, "z": late.sum() * step}


def test_the_run_that_exports_are_held_against() -> None:
    run = hb.simulate(repeating())
    for name, q in charges(6.0).items():
        assert run.final[f"{name}.q"] == pytest.approx(q, rel=1e-6)


@needs_c
@pytest.mark.slow
def test_tables_in_a_c_program(tmp_path: Path) -> None:
    program = compile_quickly(hb.export(repeating(), to="c"), tmp_path, "repeating")
    said = read_events(ask(program, "--events"))
    for name, q in charges(6.0).items():
        assert said.states[f"{name}.q"] == pytest.approx(q, rel=1e-6)


@pytest.mark.slow
@needs_java
def test_tables_in_a_java_class(tmp_path: Path) -> None:
    path = tmp_path / "Repeating.java"
    hb.export(repeating(), to="java", path=path)
    said = read_events(ask(*needs.JAVA, path, "--events"))
    for name, q in charges(6.0).items():
        assert said.states[f"{name}.q"] == pytest.approx(q, rel=1e-6)


def test_tables_in_a_modelica_tool() -> None:
    rumoca = pytest.importorskip("rumoca")
    text = hb.export(repeating(), to="modelica")
    model = rumoca.Session().loads(text, model="repeating")
    config = rumoca.SimConfig(solver="rk-like", rtol=1e-10, atol=1e-12, dt=0.01)
    found = model.simulate(t=(0.0, 6.0), config=config)
    for name, q in charges(6.0).items():
        assert found[f"{name}_q"][-1] == pytest.approx(q, rel=1e-6)


@pytest.mark.sampled(1)
@needs_c
@pytest.mark.parametrize("name", sorted(UNTIL))
@pytest.mark.slow
def test_a_netlist_becomes_a_c_program(name: str, tmp_path: Path) -> None:
    """Driven by PULSE sources that repeat: the same events, the same final state."""
    model = hb.read_circuit(NETLISTS / f"{name}.cir").model
    until = UNTIL[name]
    run = expected(hb.simulate(model, until=until, solver="rk45"))
    text = hb.export(model, to="c", until=until, solver="rk45")
    said = read_events(ask(compile_quickly(text, tmp_path, name), "--events"))
    assert said.transitions == run.transitions
    assert said.times == pytest.approx(run.times, abs=1e-9 * run.end)
    for path, value in said.states.items():
        assert value == pytest.approx(run.states[path], abs=1e-9 * run.sizes[path]), path
