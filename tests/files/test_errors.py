"""Every refusal of a model file: its code, the place in the file, the reason, the remedy."""

import json
import os
import stat
import tomllib
from pathlib import Path
from typing import Any

import pytest

from hybond.errors import FileError
from hybond.files import dumps, from_data, load, loads, save, to_data
from hybond.model.builder import Model
from hybond.model.constructors import C, I, Se
from hybond.model.parts import InputPart, Part, Submodel, SubmodelPart

H = "hybond = 1\n"
E = H + "[elements]\n"


def refused(text: str, **options: Any) -> FileError:
    with pytest.raises(FileError) as caught:
        loads(text, where="a.toml", **options)
    return caught.value


# text, code, place after the file's name, part of the reason, part of the remedy
WRONG = [
    # the file as a whole
    ("", "HB-F106", "", "empty", "hybond = 1"),
    (" \n\t\n", "HB-F106", "", "empty", "hybond = 1"),
    ("title = 'x'", "HB-F106", "", "no key 'hybond'", "hybond = 1"),
    ("[tool.ruff]\nx = 1", "HB-F106", "", "not a hybond model", "hybond = 1"),
    ("hybond = 2", "HB-F107", ":1: hybond", "version 2; this hybond reads up to 1", "update"),
    ("hybond = '1'", "HB-F107", ":1: hybond", "the text '1'", "hybond = 1"),
    ("hybond = true", "HB-F107", ":1: hybond", "true", "hybond = 1"),
    ("hybond = 1.0", "HB-F107", ":1: hybond", "1.0", "hybond = 1"),
    ("hybond = 0", "HB-F107", ":1: hybond", "0", "hybond = 1"),
    # syntax
    (H + "title = ", "HB-F105", ":2:9", "not TOML: a value is missing", "behind the ="),
    (H + "[elements]\na = { C = 1", "HB-F105", ":3:12", "in braces is not closed", "}"),
    (H + "title = 'a", "HB-F105", ":2:11", "not closed", "quote"),
    (H + "a = 1\na = 2", "HB-F105", ":3:6", "'a' is there twice", "rename"),
    (H + "[elements]\n[elements]", "HB-F105", ":3:10", "twice", ""),
    # values that no model has
    (H + "[parameters]\nm = inf", "HB-F108", ":3: parameters.m", "inf is not a finite", ""),
    (H + "[parameters]\nm = -nan", "HB-F108", ":3: parameters.m", "nan is not a finite", ""),
    (H + "[parameters]\nm = 1979-05-27", "HB-F108", ":3: parameters.m", "a date", "text"),
    (H + "[parameters]\nm = 9223372036854775808", "HB-F108", ":3: parameters.m", "63 bits", "1e20"),
    (E + "a.C = [[1, inf], [0, 1]]", "HB-F108", ":3: elements.a.C[0][1]", "finite", ""),
    # unknown keys
    (H + "[elemnts]", "HB-F109", ":2: elemnts", "section or key of a model", "'elements'"),
    (H + "tilte = ''", "HB-F109", ":2: tilte", "section or key", "'title'"),
    (E + "a = { I = 1, ff = 2 }", "HB-F109", ":3: elements.a.ff", "not a key", "'f'"),
    (E + "a = { I = 1, q = 2 }", "HB-F109", ":3: elements.a.q", "not a key", "known names"),
    (E + "a = { C = 1, impulsive = true }", "HB-F109", ":3: elements.a.impulsive", "", "domain"),
    (E + "a = { C = { f = 'q' } }", "HB-F109", ":3: elements.a.C.f", "not a key", "e"),
    (H + "[graph]\nbond = []", "HB-F109", ":3: graph.bond", "", "'bonds'"),
    (H + "[signals]\nh = { integral = 'f', begin = 1 }", "HB-F109", ":3: signals.h.begin", "", ""),
    (H + "[inputs]\nu = { const = 1 }", "HB-F109", ":3: inputs.u.const", "", "'constant'"),
    (H + "[inputs.u.pwm]\nperiod=1\nduty=1\nhi=1", "HB-F109", ":5: inputs.u.pwm.hi", "", "'high'"),
    (
        H + "[machines.m]\nstates={}\nstart='a'\nrule=[]",
        "HB-F109",
        ":5: machines.m.rule",
        "",
        "rules",
    ),
    (H + "[experiment]\nutnil = 3", "HB-F109", ":3: experiment.utnil", "", "'until'"),
    (H + "[models.d]\nelement = {}", "HB-F109", ":3: models.d.element", "", "'elements'"),
    (H + "[models.d]\nhybond = 1", "HB-F109", ":3: models.d.hybond", "", "known names"),
    # missing keys
    (
        H + "[signals]\nh = { start = 1 }",
        "HB-F111",
        ":3: signals.h",
        "'integral' is missing",
        "add",
    ),
    (H + "[inputs]\nu = { pwm = { duty = 1 } }", "HB-F111", ":3: inputs.u.pwm", "'period'", "add"),
    (H + "[machines.m]\nstart = 'a'", "HB-F111", ":2: machines.m", "'states' is missing", ""),
    (H + "[machines.m]\nstates = {}", "HB-F111", ":2: machines.m", "'start' is missing", ""),
    (E + "a = { C = {} }", "HB-F111", ":3: elements.a.C", "'e' is missing", ""),
    (E + "a = { R = { f = { extrapolate = 'linear' } } }", "HB-F111", ":3: elements.a.R.f", "", ""),
    # wrong types
    (H + "title = 3", "HB-F112", ":2: title", "the number 3, where text is needed", ""),
    (H + "name = ''", "HB-F112", ":2: name", "length >= 1", ""),
    (H + "elements = 3", "HB-F112", ":2: elements", "where a table is needed", ""),
    (H + "indeterminate = 'eror'", "HB-F112", ":2: indeterminate", "not one of", "'error'"),
    (
        H + "[parameters]\nm = true",
        "HB-F112",
        ":3: parameters.m",
        "true, where a number or text",
        "",
    ),
    (H + "[parameters]\nm = [1]", "HB-F112", ":3: parameters.m", "a list of 1", ""),
    (E + "a = 'C'", "HB-F112", ":3: elements.a", "where a table is needed", ""),
    (E + "a = { C = true }", "HB-F112", ":3: elements.a.C", "true", ""),
    (E + "a = { Se = { e = '1' } }", "HB-F112", ":3: elements.a.Se", "a table with e", ""),
    (E + "a = { TF = [[1]] }", "HB-F112", ":3: elements.a.TF", "a list of 1", ""),
    (E + "a = { C = [1, 2] }", "HB-F112", ":3: elements.a.C[0]", "where a list is needed", ""),
    (
        E + "a = { R = 1, impulsive = 1 }",
        "HB-F112",
        ":3: elements.a.impulsive",
        "true or false",
        "",
    ),
    (E + "a = { R = 1, domain = 1 }", "HB-F112", ":3: elements.a.domain", "text", ""),
    (E + "a = { submodel = 1 }", "HB-F112", ":3: elements.a.submodel", "text", ""),
    (
        E + "a = { submodel = 's', parameters = {k=[1]} }",
        "HB-F112",
        ":3: elements.a.parameters.k",
        "",
        "",
    ),
    (
        E + "a = { R = { f = { table = [[1, 2]] } } }",
        "HB-F112",
        ":3: elements.a.R.f.table",
        "length 2",
        "",
    ),
    (
        E + "a = { R = { f = { table = [[1,2],[1,2]], extrapolate = 'linea' } } }",
        "HB-F112",
        ":3: elements.a.R.f.extrapolate",
        "'linea'",
        "'linear'",
    ),
    (H + "[graph]\nbonds = 'a -> b'", "HB-F112", ":3: graph.bonds", "where a list is needed", ""),
    (H + "[graph]\nbonds = [\n'a -> b',\n3]", "HB-F112", ":5: graph.bonds[1]", "the number 3", ""),
    (H + "[signals]\nh = true", "HB-F112", ":3: signals.h", "true, where", ""),
    (H + "[inputs]\nu = 5", "HB-F112", ":3: inputs.u", "where a table is needed", ""),
    (H + "[inputs]\nu = { table = [] }", "HB-F112", ":3: inputs.u.table", "length >= 1", ""),
    (
        H + "[inputs]\nu = { table = [[1, 2], [3]] }",
        "HB-F112",
        ":3: inputs.u.table[1]",
        "length 2",
        "",
    ),
    (
        H + "[machines.m]\nstates = { a = 'j' }\nstart = 'a'",
        "HB-F112",
        ":3: machines.m.states.a",
        "where a list is needed",
        "",
    ),
    (
        H + "[machines.m]\nstates = {}\nstart = 'a'\nrules = [1]",
        "HB-F112",
        ":5: machines.m.rules[0]",
        "where text is needed",
        "",
    ),
    (H + "[ports]\np = 1", "HB-F112", ":3: ports.p", "text", ""),
    (H + "[experiment]\nrtol = '1'", "HB-F112", ":3: experiment.rtol", "a number", ""),
    (H + "[experiment]\npoints = 1.5", "HB-F112", ":3: experiment.points", "a whole number", ""),
    (H + "[experiment]\nplot = 'x'", "HB-F112", ":3: experiment.plot", "a list", ""),
    (H + "[layout]\na = [1]", "HB-F112", ":3: layout.a", "of length 2", ""),
    (H + "[layout]\na = [1, 'x']", "HB-F112", ":3: layout.a[1]", "a number is needed", ""),
    # exactly one kind
    (E + "a = { Cx = 1 }", "HB-F113", ":3: elements.a.Cx", "'Cx' is not a kind", "'C'"),
    (E + "a = { Cx = 1, domain = 'd' }", "HB-F113", ":3: elements.a.Cx", "", "'C'"),
    (E + "a = { juncton = 1 }", "HB-F113", ":3: elements.a.juncton", "", "'junction'"),
    (E + "a = { C = 1, I = 1 }", "HB-F113", ":3: elements.a", "C and I", "two elements"),
    (E + "a = {}", "HB-F113", ":3: elements.a", "no kind", "junction"),
    (E + "a = { domain = 'd' }", "HB-F113", ":3: elements.a", "no kind, only 'domain'", "Se"),
    (H + "[inputs]\nu = {}", "HB-F113", ":3: inputs.u", "constant, table, pwm", "constant"),
    (H + "[inputs]\nu = { constant = 1, table = [[0,0]] }", "HB-F113", ":3: inputs.u", "", ""),
    # values that do not fit the kind
    (E + "a = { junction = 2 }", "HB-F114", ":3: elements.a.junction", "not the number 2", "= 0"),
    (E + "a = { junction = '1' }", "HB-F114", ":3: elements.a.junction", "the text '1'", ""),
    (E + "a = { junction = true }", "HB-F114", ":3: elements.a.junction", "not true", ""),
    (E + "a = { junction = 1.0 }", "HB-F114", ":3: elements.a.junction", "1.0", ""),
    (E + "a = { junction = [] }", "HB-F114", ":3: elements.a.junction", "an empty list", ""),
    (E + "a = { C = [[1, 2]] }", "HB-F114", ":3: elements.a.C", "square", "[[a, b]"),
    (E + "a = { C = [] }", "HB-F114", ":3: elements.a.C", "square", ""),
    (E + "a = { R = { e = 'f', f = 'e' } }", "HB-F114", ":3: elements.a.R", "one of them", ""),
    (E + "a = { R = {} }", "HB-F114", ":3: elements.a.R", "an empty table", ""),
    (E + "a = { C = { e = [] } }", "HB-F114", ":3: elements.a.C.e", "one port", ""),
    (
        E + "a = { R = { e = { table = [[1,2],[1]] } } }",
        "HB-F114",
        ":3: elements.a.R.e.table",
        "",
        "",
    ),
    (
        E + "a = { R = { e = { table = [[1],[1]] } } }",
        "HB-F114",
        ":3: elements.a.R.e.table",
        "",
        "",
    ),
    (E + "a = { I = 1, p = 1, f = 1 }", "HB-F114", ":3: elements.a", "p and from f", "one of them"),
    (H + "[inputs]\nu = { constant = 1, linear = true }", "HB-F114", ":3: inputs.u.linear", "", ""),
    # names
    (E + "'a b' = { C = 1 }", "HB-M103", ":3: elements.'a b'", "cannot be a name", "letters"),
    (E + "time = { C = 1 }", "HB-M103", ":3: elements.time", "cannot be a name", ""),
    (H + "[parameters]\n1a = 1", "HB-M103", ":3: parameters.1a", "", ""),
    (H + "[models.'x.toml']", "HB-M103", ":2: models.'x.toml'", "", ""),
    (H + "[ports]\n'' = 'x'", "HB-M103", ":3: ports.''", "", ""),
    (
        H + "[parameters]\na = 1\n[elements]\na = { C = 1 }",
        "HB-M104",
        ":5: elements.a",
        "twice",
        "rename",
    ),
    (
        H + "[signals]\na = 'x'\n[inputs]\na = { constant = 1 }",
        "HB-M104",
        ":5: inputs.a",
        "twice",
        "",
    ),
    (
        H + "[signals]\na = 'x'\n[machines.a]\nstates = {}\nstart = 'x'",
        "HB-M104",
        ":4: machines.a",
        "twice",
        "",
    ),
    (
        H + "[models.d]\n[models.d.elements]\npi = {C=1}",
        "HB-M103",
        ":4: models.d.elements.pi",
        "",
        "",
    ),
    # files from text
    (
        E + "a = { submodel = 'b.toml' }",
        "HB-F115",
        ":3: elements.a.submodel",
        "no directory",
        "base=",
    ),
]


@pytest.mark.parametrize(("text", "code", "place", "why", "hint"), WRONG)
def test_refusal(text: str, code: str, place: str, why: str, hint: str) -> None:
    error = refused(text)
    assert (error.code, error.where) == (code, "a.toml" + place)
    assert why in error.why
    assert hint in error.hint


NOT_SYNTAX = [row for row in WRONG if row[1] != "HB-F105" and row[0].strip()]


@pytest.mark.parametrize(("text", "code", "place", "why", "hint"), NOT_SYNTAX)
def test_refusal_is_the_same_from_json_and_from_data(
    text: str, code: str, place: str, why: str, hint: str
) -> None:
    data = tomllib.loads(text)
    with pytest.raises(FileError) as caught:
        from_data(data, where="d")
    assert caught.value.code == code
    inner = place.partition(": ")[2]
    assert caught.value.where == (f"d: {inner}" if inner else "d")
    if code != "HB-F108":
        lines = json.dumps(data, indent=1)
        with pytest.raises(FileError) as caught:
            loads(lines, format="json", where="d")
        assert caught.value.code == code
        assert caught.value.where.endswith(f": {inner}" if inner else "d")


def test_every_code_is_listed_in_the_documentation() -> None:
    root = Path(__file__).parents[2]
    page = (root / "docs" / "model_files.md").read_text(encoding="utf-8")
    source = Path(from_data.__code__.co_filename).parent
    text = "".join(p.read_text(encoding="utf-8") for p in source.glob("*.py"))
    codes = {text[k : k + 7] for k in range(len(text)) if text.startswith("HB-F1", k)}
    assert len(codes) == 20
    assert {code for code in codes if f"`{code}`" not in page} == set()


@pytest.mark.parametrize(
    ("text", "code", "where"),
    [
        ("{", "HB-F105", "a:1:2"),
        ('{"hybond": 1,\n "title": "x" "y"}', "HB-F105", "a:2:15"),
        ('{"hybond": 1, "hybond": 1}', "HB-F105", "a"),
        ('{"hybond": 1, "elements": {"a": {"C": 1}, "a": {"C": 2}}}', "HB-F105", "a"),
        ('{"hybond": 1, "parameters": {"m": NaN}}', "HB-F108", "a"),
        ('{"hybond": 1, "parameters": {"m": -Infinity}}', "HB-F108", "a"),
        ('{"hybond": 1,\n "parameters": {\n"m": 1e999}}', "HB-F108", "a:3: parameters.m"),
        ('{"hybond": 1,\n "title": null}', "HB-F108", "a:2: title"),
        ('{"hybond": 1, "title": "\\ud800"}', "HB-F108", "a:1: title"),
        ("[1]", "HB-F106", "a"),
        ('{"hybond": 1,\n"graph": {"bonds": [\n"a -> b",\n3]}}', "HB-F112", "a:4: graph.bonds[1]"),
        ('{"graph": {"x": "hybond"},\n"hybond": 1}', "HB-F109", "a:1: graph.x"),
    ],
)
def test_json_refusal(text: str, code: str, where: str) -> None:
    with pytest.raises(FileError) as caught:
        loads(text, format="json", where="a")
    assert (caught.value.code, caught.value.where) == (code, where)


def test_a_key_twice_in_json_is_named() -> None:
    with pytest.raises(FileError, match="the key 'a' is there twice"):
        loads('{"hybond": 1, "parameters": {"a": 1, "b": 2, "a": 3}}', format="json")


def test_an_unknown_format_is_refused() -> None:
    with pytest.raises(FileError, match="HB-F102"):
        loads("hybond = 1", format="yaml")  # type: ignore[arg-type]
    with pytest.raises(FileError, match="HB-F102"):
        dumps(Model(), format="yaml")  # type: ignore[arg-type]
    with pytest.raises(FileError, match="HB-F106"):
        from_data([])  # type: ignore[arg-type]


@pytest.mark.parametrize("name", ["a.txt", "a", "a.toml.bak"])
def test_other_suffixes_are_refused(tmp_path: Path, name: str) -> None:
    for act in (load, lambda path: save(Model(), path)):
        with pytest.raises(FileError) as caught:
            act(tmp_path / name)
        assert caught.value.code == "HB-F102"
        assert ".toml or .json" in caught.value.hint


@pytest.mark.parametrize("name", ["A.TOML", "a.Toml"])
def test_the_case_of_a_suffix_does_not_matter(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_text("hybond = 1")
    assert load(str(tmp_path / name)).name in ("a", "A")


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    (tmp_path / "folder.toml").mkdir()
    (tmp_path / "bad.toml").write_bytes(b"hybond = 1\n\xff\xfe\n")
    (tmp_path / "binary.json").write_bytes(bytes(range(256)))
    (tmp_path / "empty.toml").write_text("")
    (tmp_path / "utf16.toml").write_text("hybond = 1", encoding="utf-16")
    cases = {
        "none.toml": ("HB-F101", "no such file"),
        "folder.toml": ("HB-F101", "directory"),
        "folder.toml/x.toml": ("HB-F101", ""),
        "n\0l.toml": ("HB-F101", "null"),
        "x" * 5000 + ".toml": ("HB-F101", "long"),
        "bad.toml": ("HB-F104", "byte 0xff on line 2"),
        "binary.json": ("HB-F104", "not UTF-8"),
        "utf16.toml": ("HB-F104", "not UTF-8"),
        "empty.toml": ("HB-F106", "empty"),
    }
    for name, (code, why) in cases.items():
        path = tmp_path / name
        with pytest.raises(FileError) as caught:
            load(path)
        assert (caught.value.code, caught.value.where) == (code, str(path))
        assert why in caught.value.why


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes here")
def test_a_pipe_is_refused_without_waiting_for_a_writer(tmp_path: Path) -> None:
    path = tmp_path / "pipe.toml"
    os.mkfifo(path)
    with pytest.raises(FileError, match="not an ordinary file"):
        load(path)


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="no devices here")
def test_a_link_to_a_device_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "zero.toml"
    path.symlink_to("/dev/zero")
    with pytest.raises(FileError, match="not an ordinary file"):
        load(path)


# ---- writing


@pytest.mark.parametrize(
    ("model", "code", "where"),
    [
        ({"inputs": {"u": InputPart(function=float)}}, "HB-F110", "inputs.u"),
        ({"elements": {"a": C(object())}}, "HB-F110", "elements.a.C"),
        ({"elements": {"a": 3}}, "HB-F110", "elements.a"),
        ({"elements": {"a": SubmodelPart(3)}}, "HB-F110", "elements.a"),
        ({"parameters": {"a": 1j}}, "HB-F110", "parameters.a"),
        ({"parameters": {"a": float("nan")}}, "HB-F108", "model model: parameters.a"),
        (
            {"elements": {"a": Part("C", 1, {"colour": "red"})}},
            "HB-F109",
            "model model: elements.a.colour",
        ),
        ({"elements": {"a": Part("X", 1)}}, "HB-F113", "model model: elements.a.X"),
        ({"elements": {"a b": C(1)}}, "HB-M103", "model model: elements.'a b'"),
        ({"experiment": {"utnil": 1}}, "HB-F109", "model model: experiment.utnil"),
        ({"title": "\ud800"}, "HB-F108", "model model: title"),
    ],
)
def test_what_cannot_be_written_is_refused(
    tmp_path: Path, model: dict[str, Any], code: str, where: str
) -> None:
    m = Model()
    for key, value in model.items():
        setattr(m, key, value)
    path = tmp_path / "model.toml"
    for act in (dumps, lambda m: save(m, path)):
        with pytest.raises(FileError) as caught:
            act(m)
        assert (caught.value.code, caught.value.where) == (code, where)
    assert not path.exists()


def test_a_callable_input_says_what_to_do_instead() -> None:
    m = Model()
    m.input(u=lambda t: t)
    with pytest.raises(FileError, match="table") as caught:
        to_data(m)
    assert "Python function" in caught.value.why


def test_a_model_that_contains_itself_is_refused() -> None:
    a, b = Model("a"), Model("b")
    a.add(x=Submodel(b))
    b.add(y=Submodel(a))
    with pytest.raises(FileError, match="a -> b -> a") as caught:
        dumps(a)
    assert caught.value.code == "HB-F116"


@pytest.mark.parametrize(
    "content",  # the third is of a newer version: not ours to edit
    ["[tool]\nx = 1\n", "not toml at all", "hybond = 2\n[new]\n", "\x00\x01"],
)
def test_something_else_is_never_overwritten(tmp_path: Path, content: str) -> None:
    path = tmp_path / "pyproject.toml"
    path.write_text(content)
    with pytest.raises(FileError) as caught:
        save(Model("pyproject"), path)
    assert caught.value.code == "HB-F117"
    assert path.read_text() == content
    (tmp_path / "package.json").write_text('{"name": "x"}')
    with pytest.raises(FileError, match="HB-F117"):
        save(Model(), tmp_path / "package.json")


def test_a_file_that_cannot_be_written_is_said_so(tmp_path: Path) -> None:
    with pytest.raises(FileError) as caught:
        save(Model(), tmp_path / "nowhere" / "a.toml")
    assert caught.value.code == "HB-F119"
    (tmp_path / "d.toml").mkdir()
    with pytest.raises(FileError, match="HB-F101"):
        save(Model(), tmp_path / "d.toml")


def test_a_failed_write_leaves_the_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.toml"
    path.write_text("hybond = 1\n")

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    m = load(path)
    m.title = "new"
    with pytest.raises(FileError, match="No space left"):
        save(m, path)
    assert path.read_text() == "hybond = 1\n"
    assert [p.name for p in tmp_path.iterdir()] == ["a.toml"]


def test_mode_and_links_survive_saving(tmp_path: Path) -> None:
    real, link = tmp_path / "real.toml", tmp_path / "link.toml"
    real.write_text("hybond = 1\nname = 'n'\n")
    real.chmod(0o640)
    link.symlink_to(real)
    m = load(link)
    m.add(a=Se(1), b=I(1))
    save(m, link)
    assert link.is_symlink()
    assert stat.S_IMODE(real.stat().st_mode) == 0o640
    assert list(load(real).elements) == ["a", "b"]
