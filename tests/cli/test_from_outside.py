"""What a fuzzer found in what is read from outside: each cause once, refused by a code."""

import io
import json
import signal
import sys
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from time import process_time
from timeit import timeit
from typing import Any

import pytest

import hybond as hb
from hybond.equations.surfaces import surfaces_of
from hybond.model import hierarchy
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


@pytest.mark.slow
def test_many_rules_between_two_states_take_no_quadratic_time() -> None:
    m = hb.Model()
    m.add(c=hb.C(1, q=1), r=hb.R(1), n=hb.Zero())
    m.bond("n -> c", "n -> r")
    rules = ["a -> b when c.q > 2", "b -> a when c.q < 2"]
    m.machine("k", states={"a": [], "b": []}, start="a", rules=rules * 3000)
    graph = m.flatten()
    assert timeit(lambda: surfaces_of(graph), timer=process_time, number=1) < 0.5
    assert surfaces_of(graph) == ()


def block(signals: dict[str, str], **more: Any) -> hb.Model:
    m = hb.Model(**more)
    m.add(s=hb.Se(1), m=hb.I(1), r=hb.R(1), j=hb.One())
    m.bond("s -> j", "j -> m", "j -> r")
    m.signal(**signals)
    return m


@pytest.mark.parametrize(
    "signals",
    [
        {**{f"a{k}": f"a{k + 1} + 1" for k in range(3000)}, "a3000": "m.f"},
        {f"a{k}": f"a{(k + 1) % 3000}" for k in range(3000)},
        {"a0": "m.f", **{f"a{k}": f"a{k - 1}*a{k - 1}" for k in range(1, 64)}},
        {"a0": "m.f", **{f"a{k}": "sin(" * 90 + f"a{k - 1}" + ")" * 90 for k in range(1, 9)}},
        {**{f"a{k}": "sin(" * 90 + f"a{k + 1}" + ")" * 90 for k in range(20)}, "a20": "m.f"},
    ],
    ids=["row", "circle", "doubling", "levels", "levels in a row"],
)
def test_signals_of_signals_are_bounded(signals: dict[str, str]) -> None:
    with pytest.raises(hb.ExpressionError) as caught:
        block(signals).flatten()
    assert caught.value.code == "HB-E107" and caught.value.where.startswith("signals.a")
    assert caught.value.hint


def test_signals_of_signals_within_bounds_have_their_values() -> None:
    signals = {**{f"a{k}": f"a{k + 1} + 1" for k in range(90)}, "a90": "m.f"}
    run = hb.simulate(block(signals), until=1)
    assert run["a0"].at(1.0) == pytest.approx(run["m.f"].at(1.0) + 90.0)


@pytest.mark.slow
def test_parameters_may_stand_in_any_order() -> None:
    count = 5000
    given = {f"p{k}": f"p{k + 1} + 1" for k in range(count)}
    m = block({}, parameters={**given, f"p{count}": 1})
    begin = process_time()
    graph = m.flatten()
    assert process_time() - begin < 3
    assert graph.parameters["p0"] == count + 1
    m = block({}, parameters={f"p{k}": f"p{(k + 1) % 1000}" for k in range(1000)})
    with pytest.raises(hb.ModelError) as caught:
        m.flatten()
    assert caught.value.code == "HB-M108" and len(caught.value.why) < 200


def test_what_is_wrong_in_a_parameter_has_its_place(shell: Shell) -> None:
    for text in ("1 +", "foo(1)", "sin(1, 2)", "5 zz"):
        for path, words in (("m", ()), ("part.m", ())):
            inner = f'[models.n.parameters]\nm = "{text}"\n[models.n.elements]\na.I = "m"\n'
            top = f'[parameters]\nm = "{text}"\n[elements]\na.I = "m"\n'
            part = '[elements]\npart.submodel = "n"\n' + inner
            shell.file("m.toml", "hybond = 1\n" + (top if path == "m" else part))
            assert f": {path}: " in shell("check", "m.toml", *words).err
        assert " at m: " in shell("run", "spring.toml", "--set", f"m={text}").err
    assert " at solver: " in shell("run", "spring.toml", "--solver", "rk5").err


def test_submodels_that_double_are_not_opened(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(hierarchy, "OPENED", 5000)
    m = hb.Model("leaf")
    m.add(r=hb.R(1))
    for k in range(40):
        outer = hb.Model(f"m{k}")
        outer.add(a=hb.Submodel(m), b=hb.Submodel(m))
        m = outer
    with pytest.raises(hb.ModelError) as caught:
        m.flatten()
    assert caught.value.code == "HB-F103" and caught.value.hint


@pytest.mark.parametrize("port", ["9" * 5000, "²", "٣", "0", "100000000"])
def test_a_port_has_a_number(port: str) -> None:
    m = hb.Model()
    m.add(f=hb.I(1), j=hb.One())
    m.bond(f"j -> f.{port}")
    with pytest.raises(hb.ModelError) as caught:
        m.flatten()
    assert caught.value.code in ("HB-M101", "HB-M131")


@pytest.mark.parametrize("value", ["{" + "1+" * 30_000 + "1}", "1e" + "9" * 4000])
def test_long_values_of_a_netlist(tmp_path: Path, value: str) -> None:
    path = tmp_path / "n.cir"
    path.write_text(f"t\nV1 a 0 1\nR1 a 0 {value}\n")
    with pytest.raises(hb.FileError) as caught:
        hb.read_circuit(path)
    assert caught.value.code == "HB-F131" and len(str(caught.value)) < 400


def test_a_coefficient_beyond_floats_is_there(shell: Shell) -> None:
    m = hb.Model(parameters={"a": 1e300, "b": 1e-300})
    m.add(s=hb.Se(1), c=hb.I("b"), r=hb.R("a"), j=hb.One())
    m.bond("s -> j", "j -> c", "j -> r")
    hb.save(m, "m.json")
    assert shell("equations", "m.json").code == 0


@contextmanager
def small_disk() -> Iterator[None]:
    """Files of 600 bytes at most; byte code, which Python does not find cut short, is none then."""
    resource = pytest.importorskip("resource")
    written = sys.dont_write_bytecode
    sys.dont_write_bytecode = True
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    answer = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (600, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
        signal.signal(signal.SIGXFSZ, answer)
        sys.dont_write_bytecode = written


@pytest.mark.parametrize(
    "words",
    [
        ("run", "charger.toml", "--out", "x.csv"),
        ("run", "ball.toml", "--out", "x.npz"),
        ("run", "ball.toml", "--out", "x.json"),
        ("convert", "charger.toml", "x.json"),
        ("draw", "ball.toml", "--out", "x.svg"),
    ],
)
def test_a_full_disk_has_a_place_and_leaves_nothing(shell: Shell, words: tuple[str, ...]) -> None:
    with small_disk():
        done = shell(*words)
    assert done.code in (1, 2) and f" at {words[-1]}: " in done.err and "try: " in done.err
    assert not [f for f in shell.folder.iterdir() if f.name.startswith((".", "x."))]


def test_a_journal_on_a_full_disk_has_whole_rows_and_the_run_is_kept(shell: Shell) -> None:
    (shell.folder / "many.toml").write_text(
        (shell.folder / "ball.toml").read_text().replace("e = 0.5", "e = 0.95")
    )
    with small_disk():
        done = shell("run", "many.toml", "--until", "30", "--journal", "j.csv", "--json")
    assert done.code == 1 and "HB-S113 at j.csv: " in done.err and "try: make room" in done.err
    assert json.loads(done.out)["events"]
    text = (shell.folder / "j.csv").read_text()
    assert 400 < len(text) <= 600 and text.endswith("\n")
    assert {row.count(",") for row in text.splitlines()} == {text.splitlines()[0].count(",")}
