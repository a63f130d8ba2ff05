"""What a fuzzer found in what is read from outside: each cause once, refused by a code."""

import io
import zipfile
from pathlib import Path

import pytest

import hybond as hb
from tests.cli.conftest import Shell

UNIT = """<fmiModelDescription fmiVersion="2.0" modelName="g" guid="g">
<CoSimulation modelIdentifier="g"/>
<UnitDefinitions><Unit name="V"><BaseUnit kg="1"/></Unit></UnitDefinitions>
<ModelVariables><ScalarVariable name="y" valueReference="0" causality="output">
<Real unit="V" start="1"/></ScalarVariable></ModelVariables></fmiModelDescription>
"""


@pytest.mark.parametrize("kind", ["C", "I", "R", "G"])
@pytest.mark.parametrize("value", [2, "2", "x"])
def test_one_value_is_no_law_of_two_bonds(kind: str, value: object) -> None:
    m = hb.Model(parameters={"x": 1})
    m.add(a=getattr(hb, kind)(value), j=hb.One(), s=hb.Se(1))
    m.bond("s -> j", "j -> a.1", "j -> a.2")
    with pytest.raises(hb.ModelError) as caught:
        m.flatten()
    assert (caught.value.code, caught.value.where) == ("HB-M161", f"elements.a.{kind}")
    assert "2 bonds" in caught.value.why and caught.value.hint


@pytest.mark.parametrize(
    "values",
    [
        "m=1..2:2147483648",
        "m=1..2:9223372036854775807",
        "m=1..2:" + "9" * 5000,
        "m=1..2:１２",
        "m=1..2:1000001",
    ],
)
def test_a_sweep_has_a_bounded_number_of_members(shell: Shell, values: str) -> None:
    done = shell("sweep", "spring.toml", "--vary", values)
    assert (done.code, done.err.split()[0]) == (1, "HB-X103")


def test_combinations_are_bounded_before_they_are_made(shell: Shell) -> None:
    done = shell("sweep", "spring.toml", *("--vary", "m=1..2:2000", "--vary", "k=1..2:2000"))
    assert done.code == 1 and "more than 1000000 members" in done.err


def test_steps_of_time_stepping_are_counted(shell: Shell) -> None:
    words = ("--solver", "moreau-jean", "--step", "1e-3", "--max-steps", "50")
    done = shell("run", "ball.toml", *words)
    assert done.code == 3 and "HB-N409" in done.err and "50 steps without an event" in done.err
    assert "a longer step" in done.err and "moreau-jean, 50 steps" in done.out
    # an event begins the count anew: the ball falls 1 s, and flies as long again after it
    assert shell("run", "ball.toml", *words[:-1], "1001").code == 0


def unit(folder: Path, text: str, packing: int, broken: bool = False) -> Path:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", packing) as archive:
        archive.writestr("modelDescription.xml", text)
    data = bytearray(packed.getvalue())
    if broken:
        data[60:64] = b"\xff\xff\xff\xff"
    (folder / "g.fmu").write_bytes(data)
    return folder / "g.fmu"


@pytest.mark.parametrize("packing", [zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_a_damaged_archive_is_no_unit(tmp_path: Path, packing: int) -> None:
    with pytest.raises(hb.FileError) as caught:
        hb.FMU(unit(tmp_path, UNIT, packing, broken=True), every=1)
    assert caught.value.code == "HB-F160"


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("<fmi", '<?xml version="1.0" encoding="UTF-6"?><fmi'),
        ('kg="1"', 'kg="1.5"'),
        ('kg="1"', 'kg="99"'),
        ('kg="1"', 'kg="1" factor="0"'),
        ('kg="1"', 'kg="1" factor="nan"'),
        ('kg="1"', 'kg="1" offset="1e999"'),
        ('start="1"', 'start="inf"'),
        ('start="1"', 'start="one"'),
        ('Reference="0"', 'Reference="-1"'),
        ('Reference="0"', 'Reference="4294967296"'),
    ],
)
def test_a_description_with_a_value_that_is_none(tmp_path: Path, old: str, new: str) -> None:
    assert hb.FMU(unit(tmp_path, UNIT, zipfile.ZIP_STORED), every=1)
    with pytest.raises(hb.FileError) as caught:
        hb.FMU(unit(tmp_path, UNIT.replace(old, new), zipfile.ZIP_STORED), every=1)
    assert caught.value.code == "HB-F160"


def test_many_rules_between_two_states_take_no_quadratic_time() -> None:
    m = hb.Model()
    m.add(c=hb.C(1, q=1), r=hb.R(1), n=hb.Zero())
    m.bond("n -> c", "n -> r")
    rules = ["a -> b when c.q > 2", "b -> a when c.q < 2"]
    m.machine("k", states={"a": [], "b": []}, start="a", rules=rules * 3000)
    from hybond.equations.surfaces import surfaces_of

    graph = m.flatten()
    from timeit import timeit

    assert timeit(lambda: surfaces_of(graph), number=1) < 0.5
    assert surfaces_of(graph) == ()
