"""Submodels: inline, as files, as `Model` objects."""

from pathlib import Path

import pytest

from hybond.errors import FileError
from hybond.files import dumps, from_data, load, loads, save, to_data
from hybond.files.edit import same
from hybond.model.builder import Model
from hybond.model.constructors import C, I, One
from hybond.model.parts import Submodel, SubmodelPart

CAR = """\
hybond = 1
[elements]
front = { submodel = "parts/wheel.toml", parameters = { r = "0.3 m" } }
rear = { submodel = "parts/wheel.toml" }
engine = { submodel = "motor" }
gear = { submodel = "rotational.gear" }

[models.motor.elements]
coil = { submodel = "parts/coil.json" }
"""
WHEEL = 'hybond = 1\n[elements]\ntyre = { submodel = "rubber/tyre.toml" }\n[ports]\nhub = "tyre"\n'


@pytest.fixture
def car(tmp_path: Path) -> Path:
    (tmp_path / "parts" / "rubber").mkdir(parents=True)
    (tmp_path / "car.toml").write_text(CAR)
    (tmp_path / "parts" / "wheel.toml").write_text(WHEEL)
    (tmp_path / "parts" / "coil.json").write_text('{"hybond": 1, "name": "Coil"}')
    (tmp_path / "parts" / "rubber" / "tyre.toml").write_text(
        "hybond = 1\n[elements]\nrim = { C = 1 }\n"
    )
    return tmp_path / "car.toml"


def test_files_are_read_relative_to_the_file_that_names_them(car: Path) -> None:
    model = load(car)
    assert model.elements["front"] == SubmodelPart("parts/wheel.toml", {"r": "0.3 m"})
    wheel = model.models["parts/wheel.toml"]
    assert wheel.name == "wheel" and wheel.ports == {"hub": "tyre"}
    assert wheel.models["rubber/tyre.toml"].elements["rim"] == C(1)
    assert model.models["motor"].models["parts/coil.json"].name == "Coil"
    # A name that is no file is left to the library.
    assert list(model.models) == ["motor", "parts/wheel.toml"]


def test_text_takes_files_from_base(car: Path) -> None:
    found = to_data(loads(CAR, base=car.parent), inline=True)
    assert same({**found, "name": "car"}, to_data(load(car), inline=True))
    with pytest.raises(FileError, match="no directory"):
        loads(CAR)
    assert from_data(to_data(load(car)), base=car.parent).models["parts/wheel.toml"]


def test_references_are_kept_when_saving(car: Path) -> None:
    model = load(car)
    save(model, car)
    assert car.read_text() == CAR
    save(model, car.parent / "again.toml")
    assert 'submodel = "parts/wheel.toml"' in (car.parent / "again.toml").read_text()


def test_saving_elsewhere_never_changes_the_meaning(car: Path, tmp_path: Path) -> None:
    model = load(car)
    away = tmp_path / "away"
    away.mkdir()
    with pytest.raises(FileError, match="cannot be read") as caught:
        save(model, away / "car.toml")
    assert caught.value.code == "HB-F118"
    assert not list(away.iterdir())
    model.models["parts/wheel.toml"].add(new=I(1))
    with pytest.raises(FileError, match="says something else"):
        save(model, car)
    save(model.models["parts/wheel.toml"], car.parent / "parts" / "wheel.toml")
    save(model, car)
    assert "new" in load(car).models["parts/wheel.toml"].elements


def test_inline_text_stands_alone(car: Path) -> None:
    model = load(car)
    for format in ("toml", "json"):
        alone = loads(dumps(model, format=format, inline=True), format=format)
        assert alone.elements["front"] == SubmodelPart("wheel", {"r": "0.3 m"})
        assert alone.elements["rear"] == SubmodelPart("wheel", {})
        assert alone.models["wheel"].models["tyre"].elements["rim"] == C(1)
        assert alone.models["motor"].models["Coil"].name == "Coil"


def test_model_objects_are_written_inline() -> None:
    wheel, other = Model("wheel 1"), Model("wheel 1", title="Other")
    wheel.add(j=One())
    known = Model("known")
    car = Model("car")
    car.add(a=Submodel(wheel), b=Submodel(wheel, k=2), c=Submodel(other), d=Submodel(known))
    car.add(e=Submodel("wheel_1_2"), f=Submodel(Model("pre")), g=Submodel(Model("2x")))
    car.models["mine"] = known
    found = loads(dumps(car))
    names = {key: part.model for key, part in found.elements.items()}  # type: ignore[union-attr]
    assert names == {
        "a": "wheel_1",
        "b": "wheel_1",
        "c": "wheel_1_3",  # wheel_1_2 is a name that the car already uses
        "d": "mine",
        "e": "wheel_1_2",
        "f": "pre_2",
        "g": "m_2x",
    }
    assert found.models["wheel_1"].name == "wheel 1"
    assert found.models["wheel_1_3"].title == "Other"
    assert "wheel_1" not in car.models  # writing does not change the model


def test_a_fault_in_a_submodel_file_names_that_file(car: Path) -> None:
    wheel = car.parent / "parts" / "wheel.toml"
    wheel.write_text("hybond = 1\n[elements]\ntyre = { Cx = 1 }\n")
    with pytest.raises(FileError) as caught:
        load(car)
    assert caught.value.where == f"{wheel}:3: elements.tyre.Cx"
    wheel.write_text("hybond = 1\n[elements]\n[elements]\n")
    with pytest.raises(FileError) as caught:
        load(car)
    assert caught.value.where == f"{wheel}:3:10"
    wheel.unlink()
    with pytest.raises(FileError, match="no such file") as caught:
        load(car)
    assert caught.value.where == f"{car}:3: elements.front.submodel"
    assert caught.value.code == "HB-F101"
    assert str(wheel) in caught.value.hint


def test_faults_deep_inside_inline_models() -> None:
    text = "hybond = 1\n[models.a.models.b.elements]\n\nx = { Cx = 1 }\n"
    with pytest.raises(FileError) as caught:
        loads(text, where="t")
    assert caught.value.where == "t:4: models.a.models.b.elements.x.Cx"


def test_a_subdirectory_cannot_reach_its_parent(car: Path) -> None:
    (car.parent / "parts" / "wheel.toml").write_text(WHEEL.replace("rubber/", "../"))
    with pytest.raises(FileError, match="upwards"):
        load(car)
