"""Parameters of functional mock-up units, set by FMPy, against hybond with these parameters."""

import shlex
from pathlib import Path

import needs
import pytest

import hybond as hb

fmpy = pytest.importorskip("fmpy")
pytestmark = pytest.mark.c
EXAMPLES = Path(__file__).parents[2] / "examples"
CASES = [
    ("bouncing_ball_newton", {"g": 7.0, "eps": 0.7}),
    ("boost", {"V": 11.0, "light.R": 60.0}),
]


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", shlex.join(needs.QUICK))


def driven() -> hb.Model:
    """A capacitor behind a source: its start and the source's follow from one parameter."""
    m = hb.Model("driven", domain="electrical")
    m.parameter(U="4 V", R="5 ohm", tau="R*C", C="1 mF")
    m.add(v=hb.Se("u"), i=hb.One(), r=hb.R("R"), c=hb.C("tau/R", e="U/2"))
    m.bond("v -> i -> r", "i -> c")
    m.input(u="2*U")
    m.experiment.update(until=0.01, outputs=["c.e", "R"])
    return m


@pytest.mark.sampled(1)
@pytest.mark.parametrize("fmi", ["2.0", "3.0"])
@pytest.mark.parametrize(("name", "values"), CASES, ids=[name for name, _ in CASES])
@pytest.mark.slow
def test_a_unit_with_other_parameters(
    name: str, values: dict[str, float], fmi: str, tmp_path: Path
) -> None:
    from fmpy.validation import validate_fmu

    model = hb.load(EXAMPLES / f"{name}.toml")
    unit = tmp_path / "unit.fmu"
    hb.export(model, to="fmu", path=unit, fmi=fmi)
    assert validate_fmu(str(unit)) == []
    run = hb.simulate(model, parameters=values)
    states = [s.path for s in run.graph.storages]
    for kind, close in (("CoSimulation", 1e-8), ("ModelExchange", 2e-4)):
        found = fmpy.simulate_fmu(
            str(unit),
            fmi_type=kind,
            start_values=values,
            stop_time=run.t_end,
            output_interval=run.t_end / 50,
            relative_tolerance=1e-8,
            output=states,
        )
        for state in states:
            size = float(max(abs(x) for x in found[state]))
            expected = float(run[state].at(run.t_end))
            assert found[state][-1] == pytest.approx(expected, abs=close * size), (kind, state)


@pytest.mark.parametrize("fmi", ["2.0", "3.0"])
def test_parameters_are_declared(fmi: str, tmp_path: Path) -> None:
    """With units and start values; one that is made of others is calculated."""
    from fmpy.validation import validate_fmu

    unit = tmp_path / "unit.fmu"
    hb.export(driven(), to="fmu", path=unit, fmi=fmi)
    assert validate_fmu(str(unit)) == []
    about = {v.name: v for v in fmpy.read_model_description(str(unit)).modelVariables}
    told = {k: (v.causality, v.variability, v.start, v.unit) for k, v in about.items()}
    assert told["R"] == ("parameter", "fixed", "5.0", "ohm")
    assert told["U"] == ("parameter", "fixed", "4.0", "V")
    assert told["tau"] == ("calculatedParameter", "fixed", None, "s")
    assert about["tau"].description == "R*C"


@pytest.mark.sampled(1)
@pytest.mark.parametrize("fmi", ["2.0", "3.0"])
@pytest.mark.slow
def test_starts_and_inputs_follow(fmi: str, tmp_path: Path) -> None:
    """An input that nobody sets begins where the parameter puts it; a run forgets the last one."""
    model, unit = driven(), tmp_path / "unit.fmu"
    hb.export(model, to="fmu", path=unit, fmi=fmi)
    for values, inputs in (
        ({"U": 3.0}, {}),
        ({}, {}),
        ({"U": 3.0, "R": 9.0}, {"u": 1.0}),
    ):
        other = driven()
        other.inputs = {**other.inputs, **{k: hb.Input(constant=x) for k, x in inputs.items()}}
        run = hb.simulate(other, parameters=values)
        found = fmpy.simulate_fmu(
            str(unit),
            start_values={**values, **inputs},
            stop_time=0.01,
            output_interval=0.001,
            output=["c.e", "c.q", "tau", "R", "R.out"],
        )
        resistance = values.get("R", 5.0)
        assert found["R"] == pytest.approx(resistance)
        assert found["R.out"] == pytest.approx(resistance)
        assert found["tau"] == pytest.approx(resistance * 1e-3)
        times = found["time"].tolist()
        assert found["c.q"] == pytest.approx(run["c.q"].at(times), rel=1e-7)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("fmi", ["2.0", "3.0"])
def test_a_value_that_makes_another_model_is_refused(
    fmi: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    unit = tmp_path / "unit.fmu"
    hb.export(driven(), to="fmu", path=unit, fmi=fmi)
    with pytest.raises(fmpy.fmi1.FMICallException, match="ExitInitializationMode"):
        fmpy.simulate_fmu(str(unit), start_values={"R": 0.0}, stop_time=0.01)
    said = capfd.readouterr()
    assert "the model is made of other parts where not R != 0" in said.out + said.err


@pytest.mark.slow
def test_a_parameter_is_set_before_the_unit_begins(tmp_path: Path) -> None:
    unit = tmp_path / "unit.fmu"
    hb.export(driven(), to="fmu", path=unit, fmi="2.0")
    about = fmpy.read_model_description(str(unit))
    reference = {v.name: v.valueReference for v in about.modelVariables}
    slave = fmpy.instantiate_fmu(fmpy.extract(str(unit)), about, fmi_type="CoSimulation")
    slave.setReal([reference["R"]], [6.0])
    with pytest.raises(fmpy.fmi1.FMICallException):
        slave.setReal([reference["tau"]], [1.0])
    slave.setupExperiment(startTime=0.0)
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    assert slave.getReal([reference["R"], reference["tau"]]) == pytest.approx([6.0, 6e-3])
    with pytest.raises(fmpy.fmi1.FMICallException):
        slave.setReal([reference["R"]], [7.0])
    slave.doStep(currentCommunicationPoint=0.0, communicationStepSize=0.001)
    slave.reset()
    assert slave.getReal([reference["R"], reference["tau"]]) == pytest.approx([5.0, 5e-3])
    slave.freeInstance()
