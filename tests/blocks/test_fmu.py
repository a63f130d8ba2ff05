"""Functional mock-up units as blocks, against their difference equation; and refusals."""

import shutil
import subprocess
import zipfile
from collections.abc import Callable
from pathlib import Path

import needs
import pytest

import hybond as hb
from hybond.engine.compiled.native import OK, NativeModel, NativeRun, Unavailable
from hybond.engine.tables import tables_of

XML2 = """<?xml version="1.0"?>
<fmiModelDescription fmiVersion="2.0" modelName="gain" guid="{1}">
<CoSimulation modelIdentifier="gain"/>
<UnitDefinitions><Unit name="rpm"><BaseUnit rad="1" s="-1" factor="0.10471975511965977"/></Unit>
</UnitDefinitions>
<ModelVariables>
<ScalarVariable name="y" valueReference="0" causality="input">
<Real unit="rpm" start="0"/></ScalarVariable>
<ScalarVariable name="u" valueReference="1" causality="output">
<Real unit="rpm"/></ScalarVariable>
<ScalarVariable name="kp" valueReference="2" causality="parameter">
<Real start="1"/></ScalarVariable>
</ModelVariables><ModelStructure/></fmiModelDescription>"""
XML3 = """<?xml version="1.0"?>
<fmiModelDescription fmiVersion="3.0" modelName="gain" instantiationToken="{1}">
<CoSimulation modelIdentifier="gain"/>
<ModelVariables>
<Float64 name="y" valueReference="0" causality="input" start="0"/>
<Float64 name="u" valueReference="1" causality="output"/>
<Float64 name="kp" valueReference="2" causality="parameter" start="1"/>
</ModelVariables><ModelStructure/></fmiModelDescription>"""


@pytest.fixture(scope="module")
def unit(tmp_path_factory: pytest.TempPathFactory) -> Callable[[int], Path]:
    """Return the function that makes the FMU of a version of FMI."""

    def make(version: int, xml: str | None = None) -> Path:
        folder = tmp_path_factory.mktemp("unit")
        path = folder / "gain.fmu"
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr("modelDescription.xml", xml or {2: XML2, 3: XML3}[version])
            if xml is None:
                library = folder / "gain.so"
                source = Path(__file__).with_name("gain.c")
                flags = ["-shared", "-fPIC", f"-DFMI={version}"]
                subprocess.run([*needs.QUICK, *flags, source, "-o", library], check=True)
                place = "linux64" if version == 2 else "x86_64-linux"
                archive.write(library, f"binaries/{place}/gain.so")
        return path

    return make


def plant() -> hb.Model:
    m = hb.Model("plant", domain="rotational")
    m.add(J=hb.I("1 kg*m^2"), torque=hb.Se("2 N*m"), w=hb.One())
    m.bond("torque -> w -> J")
    return m


@pytest.mark.c
@pytest.mark.parametrize("version", [2, 3])
def test_a_unit_is_its_difference_equation(unit: Callable[[int], Path], version: int) -> None:
    pytest.importorskip("fmpy")
    m = plant()
    m.block(lag=hb.FMU(unit(version), every="10 ms", inputs={"y": "w.f"}, parameters={"kp": 20}))
    run = hb.simulate(m, until="0.25 s", fmus=True)
    x = held = 0.0
    for n in range(25):
        assert run["lag.u"].at(n * 0.01 + 0.005) == pytest.approx(x, rel=1e-12, abs=1e-300)
        held = 2.0 * n * 0.01  # what the unit was given at the instant
        for _ in range(100):
            x += 1e-4 * 20 * (held - x)
    assert run["lag.u"].unit == ("1/s" if version == 2 else "")


@pytest.mark.c
@pytest.mark.parametrize("version", [2, 3])
def test_a_unit_runs_by_the_library(unit: Callable[[int], Path], version: int) -> None:
    """What it sets drives an integral: of steps of 10 ms, in two runs beside each other."""
    pytest.importorskip("fmpy")
    m = plant()
    m.block(lag=hb.FMU(unit(version), every="10 ms", inputs={"y": "w.f"}, parameters={"kp": 20}))
    m.signal(path=hb.Integral("lag.u"))
    try:
        model = NativeModel(tables_of(m.flatten(), calling=True, until=0.25))
        runs = [NativeRun(model, fmus=True) for _ in range(2)]
    except Unavailable as why:
        pytest.skip(str(why))
    for _ in zip(*(run.slices(steps=7) for run in runs), strict=True):
        pass
    x = total = 0.0
    for n in range(25):
        total += 0.01 * x
        for _ in range(100):
            x += 1e-4 * 20 * (2.0 * n * 0.01 - x)
    for run in runs:
        assert run.status == OK
        (at,) = [k for k, s in enumerate(model.tables.stored) if s == "path"]
        assert run.y[at] == pytest.approx(total, rel=1e-9)
    with pytest.raises(hb.UsageError) as caught:
        NativeRun(model)
    assert caught.value.code == "HB-S117"


@pytest.mark.c
def test_a_file_names_a_unit_and_keeps_it(unit: Callable[[int], Path], tmp_path: Path) -> None:
    shutil.copy(unit(2), tmp_path / "gain.fmu")
    text = hb.dumps(plant()) + (
        '\n[blocks]\nlag = { fmu = "gain.fmu", every = "10 ms", inputs = { y = "w.f" } }\n'
    )
    (tmp_path / "plant.toml").write_text(text)
    model = hb.load(tmp_path / "plant.toml")
    assert model.blocks["lag"].outputs == {"u": "0.0 1/s"}
    assert 'lag = { fmu = "gain.fmu"' in hb.dumps(model)
    assert hb.simulate(model, until="50 ms", fmus=True)["lag.u"].at(0.05) > 0


@pytest.mark.c
def test_nothing_runs_without_consent(unit: Callable[[int], Path]) -> None:
    m = plant()
    m.block(lag=hb.FMU(unit(2), every="10 ms"))
    m.flatten()
    with pytest.raises(hb.UsageError) as caught:
        hb.simulate(m, until=1)
    assert caught.value.code == "HB-S117"


@pytest.mark.c
def test_a_unit_that_fails_ends_the_run_and_keeps_it(unit: Callable[[int], Path]) -> None:
    pytest.importorskip("fmpy")
    m = plant()
    m.block(lag=hb.FMU(unit(2), every="10 ms", parameters={"kp": -1}))
    with pytest.raises(hb.NumericsError) as caught:
        hb.simulate(m, until=1, fmus=True)
    assert caught.value.code == "HB-N306" and caught.value.partial.t_end == pytest.approx(0.01)


@pytest.mark.parametrize(
    ("given", "code"),
    [
        ({"inputs": {"yy": "w.f"}}, "HB-F162"),
        ({"outputs": ["y"]}, "HB-F162"),
        ({"parameters": {"u": 1}}, "HB-F162"),
        ({"inputs": {"y": "J.p"}}, "HB-U103"),
        ({"every": 0}, "HB-M151"),
    ],
)
def test_what_does_not_fit_a_unit_is_refused(
    unit: Callable[..., Path], given: dict[str, object], code: str
) -> None:
    m = plant()
    with pytest.raises(hb.HybondError) as caught:
        m.block(lag=hb.FMU(unit(2, XML2), **{"every": "10 ms", **given}))
        m.flatten()
    assert caught.value.code == code


@pytest.mark.parametrize(
    ("xml", "code"),
    [
        (XML2.replace("CoSimulation", "ModelExchange"), "HB-F161"),
        (XML2.replace('fmiVersion="2.0"', 'fmiVersion="1.0"'), "HB-F161"),
        (XML2[:200], "HB-F160"),
        (XML2.replace('valueReference="1"', ""), "HB-F160"),
        (XML2.replace('modelIdentifier="gain"', 'modelIdentifier="../../gain"'), "HB-F160"),
        (XML2.replace('modelIdentifier="gain"', ""), "HB-F160"),
        ('<!DOCTYPE a [<!ENTITY b "c">]>' + XML2[21:], "HB-F160"),
    ],
)
def test_a_strange_description_is_refused(unit: Callable[..., Path], xml: str, code: str) -> None:
    with pytest.raises(hb.FileError) as caught:
        hb.FMU(unit(2, xml), every=1)
    assert caught.value.code == code


def test_a_file_that_is_no_unit_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.fmu").write_text("no zip")
    for name in ("a.fmu", "missing.fmu"):
        with pytest.raises(hb.FileError) as caught:
            hb.FMU(tmp_path / name, every=1)
        assert caught.value.code == "HB-F160"
    with pytest.raises(hb.FileError) as caught:
        hb.loads('hybond = 1\n[blocks]\na = { fmu = "../a.fmu", every = 1 }\n', base=tmp_path)
    assert caught.value.code == "HB-F115"


def test_a_function_is_called_once_an_instant_in_order() -> None:
    calls: list[tuple[float, float]] = []

    def seen(t: float, u: dict[str, float]) -> dict[str, float]:
        calls.append((t, u["speed"]))
        return {"n": len(calls)}

    m = plant()
    m.block(count=hb.Block(seen, inputs={"speed": "w.f"}, outputs=["n"], every=0.25))
    run = hb.simulate(m, until=1.1)
    assert calls == [(t, pytest.approx(2 * t, abs=1e-12)) for t in (0.0, 0.25, 0.5, 0.75, 1.0)]
    assert run["count.n"].at(0.6) == 3.0
    with pytest.raises(hb.FileError) as caught:
        hb.dumps(m)
    assert caught.value.code == "HB-F110"
