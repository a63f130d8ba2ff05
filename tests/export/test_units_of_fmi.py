"""Functional mock-up units, run by FMPy, against hybond."""

import shlex
import zipfile
from pathlib import Path

import needs
import numpy as np
import pytest

import hybond as hb

fmpy = pytest.importorskip("fmpy")
pytestmark = pytest.mark.c


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("units")


def states(model: hb.Model) -> list[str]:
    graph = model.flatten()
    return [s.path for s in graph.storages] + [i.path for i in graph.integrals]


CASES = [
    ("diode_inductor", "2.0", None),  # impulses and mythical modes
    ("half_bridge", "3.0", None),  # timed events, modulated
    ("bouncing_ball_newton", "2.0", "3 s"),  # impacts
    ("half_wave_rectifier", "3.0", "30 ms"),  # a diode as a law
    ("stick_slip", "3.0", None),  # friction that breaks loose at its bound
    ("cam_follower", "2.0", "0.12 s"),  # a contact that lets go where another guard acts
    ("parallel_resonant_converter", "3.0", None),  # charges of microcoulombs
]


@pytest.mark.sampled(1)
@pytest.mark.parametrize(("name", "fmi", "until"), CASES)
def test_a_unit_runs_as_the_model_does(
    folder: Path, monkeypatch: pytest.MonkeyPatch, name: str, fmi: str, until: str | None
) -> None:
    monkeypatch.setenv("CC", shlex.join(needs.QUICK))
    model = hb.load(f"examples/{name}.toml")
    path = folder / f"{name}.fmu"
    hb.export(model, to="fmu", path=path, fmi=fmi)
    from fmpy.validation import validate_fmu

    assert validate_fmu(str(path)) == []
    run = hb.simulate(model, until=until)
    names = states(model)
    end = run.t_end
    for kind, close in (("CoSimulation", 1e-8), ("ModelExchange", 1e-4)):
        found = fmpy.simulate_fmu(
            str(path),
            fmi_type=kind,
            stop_time=end,
            output_interval=end / 50,
            relative_tolerance=1e-8,
            output=names,
        )
        for state in names:
            times = found["time"]
            chosen = [int(np.abs(times - part * end).argmin()) for part in (0.3, 0.62, 1.0)]
            expected = [float(run[state].at(min(times[k], end))) for k in chosen]
            got = [float(found[state][k]) for k in chosen]
            size = max(float(np.abs(found[state]).max()), 1e-300)
            assert got == pytest.approx(expected, abs=close * size), (kind, state)


SLOW = {"clang", "gcc"} if needs.TCC else {"clang"}
"""Compilers that are not asked each time: gcc makes the library, and a unit takes it eight seconds.
"""


@pytest.mark.parametrize(
    "made_by",
    [
        pytest.param(c, marks=[getattr(pytest.mark, c), *[pytest.mark.slow] * (c in SLOW)])
        for c in needs.COMPILERS
    ],
)
def test_any_compiler_makes_a_unit_that_runs(
    made_by: str, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CC", shlex.join(needs.COMPILERS[made_by]))
    model = hb.load("examples/diode_inductor.toml")
    path = folder / f"{made_by}.fmu"
    hb.export(model, to="fmu", path=path)
    run = hb.simulate(model)
    found = fmpy.simulate_fmu(str(path), stop_time=run.t_end, output=["L.p"])
    size = float(np.abs(found["L.p"]).max())
    for k in (len(found) // 5, len(found) // 2):
        expected = float(run["L.p"].at(float(found["time"][k])))
        assert float(found["L.p"][k]) == pytest.approx(expected, abs=1e-6 * size)


@pytest.fixture(scope="module")
def driven(folder: Path) -> Path:
    path = folder / "motor.fmu"
    hb.export(motor(hb.Input(constant="6 V")), to="fmu", path=path, until="0.2 s")
    return path


def motor(volts: hb.Input) -> hb.Model:
    """A motor on a source, with a brake that holds it above a speed."""
    m = hb.Model("motor", domain="electrical")
    m.input(volts=volts)
    m.add(U=hb.Se("volts"), R=hb.R("1 ohm"), L=hb.I("2 mH"), i=hb.One(), M=hb.GY("0.05 N*m/A"))
    m.add(w=hb.One(domain="rotational"), J=hb.I("1e-4 kg*m^2", domain="rotational"))
    m.add(grip=hb.Zero(domain="rotational"), pad=hb.G("2e3 rad/(N*m*s)", domain="rotational"))
    m.bond("U -> i -> R", "i -> L", "i -> M -> w -> J", "w -> grip -> pad")
    m.signal(speed="w.f", current="i.f")
    m.machine(
        "brake",
        states={"off": [], "on": ["grip"]},
        start="off",
        rules=["off -> on when speed > 100", "on -> off when speed < 80"],
    )
    m.experiment["outputs"] = ["speed", "current"]
    m.experiment["until"] = "0.2 s"
    return m


@pytest.mark.slow
def test_inputs_of_a_unit_are_set_from_outside(driven: Path) -> None:
    from fmpy import simulate_fmu

    dtype = [("time", float), ("volts", float)]
    signals = np.array([(0, 6.0), (0.05, 6.0), (0.05, 12.0), (0.2, 12.0)], dtype=dtype)
    found = simulate_fmu(
        str(driven),
        fmi_type="CoSimulation",
        stop_time=0.2,
        output_interval=0.005,
        input=signals,
        output=["speed", "current"],
    )
    table = [(0, "6 V"), ("50 ms", "12 V")]
    run = hb.simulate(motor(hb.Input(table=table)), until="0.2 s")
    for t in (0.04, 0.1, 0.2):
        k = int(np.abs(found["time"] - t).argmin())
        assert found["speed"][k] == pytest.approx(run["speed"].at(t), rel=1e-6)
        assert found["current"][k] == pytest.approx(run["current"].at(t), rel=1e-5)
    assert len(run.events) == 2  # the start, and the brake


@pytest.mark.slow
def test_a_unit_says_what_it_shows(driven: Path) -> None:
    description = fmpy.read_model_description(str(driven))
    of = {v.name: v for v in description.modelVariables}
    assert (of["volts"].causality, of["volts"].unit, float(of["volts"].start)) == ("input", "V", 6)
    assert (of["speed"].causality, of["speed"].unit) == ("output", "rad/s")
    assert of["der(J.p)"].derivative.name == "J.p"
    with zipfile.ZipFile(driven) as archive:
        assert "sources/motor.c" in archive.namelist()


@pytest.mark.slow
def test_the_same_model_gives_the_same_description(driven: Path) -> None:
    from hybond.export.fmu.package import to_fmu

    again = to_fmu(motor(hb.Input(constant="6 V")), until="0.2 s")
    (driven.parent / "again.fmu").write_bytes(again)
    with zipfile.ZipFile(driven) as a, zipfile.ZipFile(driven.parent / "again.fmu") as b:
        for name in ("modelDescription.xml", "sources/motor.c"):
            assert a.read(name) == b.read(name)


@pytest.mark.slow
def test_a_unit_is_a_block_of_another_model(driven: Path) -> None:
    m = hb.Model("outer")
    m.signal(seen="motor.speed")
    m.add(V=hb.Se(1), R=hb.R(1), i=hb.One())
    m.bond("V -> i -> R")
    m.block(motor=hb.FMU(driven, every="1 ms", inputs={"volts": "5 [V]"}))
    run = hb.simulate(m, until="0.1 s", fmus=True)
    alone = hb.simulate(motor(hb.Input(constant="5 V")), until="0.1 s")
    assert run["seen"].at(0.0995) == pytest.approx(alone["speed"].at(0.099), rel=1e-6)


def test_another_version_is_refused() -> None:
    with pytest.raises(hb.UsageError) as caught:
        hb.export(motor(hb.Input(constant=1)), to="fmu", fmi="1.0")
    assert caught.value.code == "HB-E604"
