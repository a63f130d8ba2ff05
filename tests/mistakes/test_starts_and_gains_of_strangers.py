"""What is allowed and seldom meant, or has no solution, is said in words that fit."""

import re

import pytest

import hybond as hb


def falling(gap: str, start: float, law: str = "unilateral") -> hb.Model:
    m = hb.Model("falls", domain="translational", parameters={"floor": 0.3})
    m.add(m=hb.I(1), W=hb.Se(-10), v=hb.One(), c=hb.Zero(law=law, gap=gap, restitution=0.5))
    m.bond("W -> v -> m", "c -> v")
    m.signal(h=hb.Integral("v.f", start=start))
    return m


@pytest.mark.parametrize(
    ("gap", "start", "told"),
    [
        ("h", -1.0, -1.0),
        ("h - floor", 0.2, -0.1),
        ("h - 0.1 - 0.2", 0.3 - 1e-6, -1e-6),
        ("h", 0.0, None),
        ("h - 0.1 - 0.2", 0.3, None),  # -5.5e-17: rounding
        ("h - floor", 1.0, None),
    ],
)
@pytest.mark.parametrize("solver", ["auto", "radau", "moreau-jean"])
def test_a_start_below_the_floor_is_told(gap, start, told, solver) -> None:
    step = {"step": "1 ms"} if solver == "moreau-jean" else {}
    run = hb.simulate(falling(gap, start), 0.1, solver=solver, **step)
    said = [w for w in run.warnings if "the gap of 'c' is" in w]
    assert len(said) == (told is not None)
    if told is not None:
        assert float(said[0].split(" is ")[1].split()[0]) == pytest.approx(told, rel=1e-3)
        assert run["v.f"].at(0.1) == pytest.approx(0.0, abs=1e-12)


def test_a_part_that_starts_beyond_its_stop_is_told() -> None:
    m = hb.Model("stop", domain="translational")
    m.add(m=hb.Submodel("translational.mass"), f=hb.Submodel("translational.frame"))
    m.add(s=hb.Submodel("translational.end_stop", low="-1 mm", high="1 mm", start="3 mm"))
    m.bond("m.flange -> s.flange", "s.case -> f.flange")
    (said,) = hb.simulate(m, 0.1).warnings
    assert "the gap of 's.upper' is -0.002" in said


def alone(source: object, resistor: object, node: object, **signals: str) -> hb.Model:
    m = hb.Model("alone", domain="electrical")
    m.add(s=source, R=resistor, n=node)
    m.bond("s -> n -> R")
    m.signal(**signals)
    return m


CONTRADICTIONS = {
    "voltage": alone(hb.Se("1*n.f + 1"), hb.R(1), hb.One()),
    "current": alone(hb.Sf("2*n.e + 1"), hb.R(0.5), hb.Zero()),
    "signal": alone(hb.Se("x"), hb.R(3), hb.One(), x="3*n.f + 1"),
}


@pytest.mark.parametrize("name", CONTRADICTIONS)
def test_gains_without_a_solution_are_no_matter_of_what_is_stored(name: str) -> None:
    with pytest.raises(hb.HybondError, match="the sources and laws of this mode contradict") as e:
        hb.simulate(CONTRADICTIONS[name], 1.0)
    assert e.value.code == "HB-N303" and "redistribution" not in str(e.value)


@pytest.mark.parametrize(("gain", "current"), [(0.5, 2.0), (3.0, -0.5), (-1.0, 0.5)])
def test_other_gains_have_one(gain: float, current: float) -> None:
    """i = gain*i + 1."""
    run = hb.simulate(alone(hb.Se(f"{gain}*n.f + 1"), hb.R(1), hb.One()), 1.0)
    assert run["n.f"].at(1.0) == pytest.approx(current, rel=1e-12)


def test_what_many_modes_leave_open_is_told_once() -> None:
    """A bridge between whose pulses the line floats, in four modes of its firing."""
    m = hb.Model("bridge", domain="electrical")
    m.add(
        mains=hb.Submodel("electrical.sine_voltage", amplitude="325 V"),
        bridge=hb.Submodel("electrical.single_phase_thyristor_bridge", inputs={"alpha": 1.0}),
        load=hb.Submodel("electrical.resistor", R="10 ohm"),
        ground=hb.Submodel("electrical.ground"),
    )
    m.bond("mains.plus -> bridge.a", "mains.minus -> bridge.b", "ground.pin -> bridge.minus")
    m.bond("bridge.plus -> load.plus", "load.minus -> bridge.minus")
    run = hb.simulate(m, 0.06)
    told = [re.findall(r'"[^"]*"\.[ef]', w) for w in run.warnings if "least leakage" in w]
    assert len(told) == 1 and len(set(told[0])) == len(told[0]) > 3
    modes = {step.mode for event in run.events for step in event.steps if step.undetermined}
    assert len(modes) > 1  # each still has its own line in the record
