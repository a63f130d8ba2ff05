"""Mistakes of newcomers: code, file, line, reason and remedy of each, and remedies that work."""

from __future__ import annotations

import contextlib
import io
import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest
from listed import listed

import hybond as hb
from hybond.cli.main import main

with open(Path(__file__).with_name("cases.toml"), "rb") as file:
    CASES: dict[str, Any] = tomllib.load(file)
RIGHT = CASES["right"].lstrip()


def line_of(text: str, part: str) -> int:
    return 1 + text[: text.index(part)].count("\n")


def judge(case: dict[str, Any], code: str, why: str, hint: str) -> None:
    assert code == case["code"]
    for words in case["says"]:
        assert words in why
    assert case["try"] in hint
    assert hint


def no_inner_names(words: Iterable[str]) -> None:
    for text in words:
        for inner in (
            "Traceback",
            "object at 0x",
            "law:",
            "<class",
            "NoneType",
            "msgspec",
            "numpy",
        ):
            assert inner not in text


def refused(text: str, run: bool) -> hb.HybondError:
    with pytest.raises(hb.HybondError) as caught:
        model = hb.loads(text, where="rc.toml")
        model.flatten()
        if run:
            hb.simulate(model)
    return caught.value


def test_what_the_mistakes_are_made_in_is_right() -> None:
    run = hb.simulate(hb.loads(RIGHT))
    # the switch closes after 1 ms: 10 V over 100 ohm and 1 uF, from 1 V less what has leaked
    assert run.status == "ok" and len(run.events) > 2


@listed("case", CASES["file"])
def test_in_a_file(case: dict[str, Any]) -> None:
    old, new = case.get("swap", case["change"])
    text = RIGHT.replace(old, new, 1)
    assert text != RIGHT
    error = refused(text, case.get("run", False))
    judge(case, error.code, error.why, error.hint)
    line = case.get("line")
    if line is None:
        line = line_of(text, case["at"]) if "at" in case else line_of(RIGHT, old)
    assert error.file == "rc.toml" or not line
    assert (error.line or 0) == line
    if line:
        assert error.written == text.split("\n")[line - 1].strip()[:100]
        assert f"rc.toml:{line}" in error.place
        assert f"\n    {line} | " in str(error)
    no_inner_names([str(error)])


@listed("case", [case for case in CASES["file"] if "fix" in case])
def test_the_remedy_works(case: dict[str, Any]) -> None:
    old, new = case.get("swap", case["change"])
    text = RIGHT.replace(old, new, 1)
    error = refused(text, case.get("run", False))
    wrong, right = case["fix"]
    if not case.get("free"):
        assert right.strip(' "={}') in error.hint
    mended = text.replace(wrong, right)
    assert mended != text
    hb.simulate(hb.loads(mended), until="0.1 ms")


@listed("case", CASES["netlist"])
def test_in_a_netlist(case: dict[str, Any], tmp_path: Path) -> None:
    path = tmp_path / "n.cir"
    text = case["text"].lstrip()
    path.write_text(text)
    with pytest.raises(hb.HybondError) as caught:
        hb.read_circuit(path)
    error = caught.value
    judge(case, error.code, error.why, error.hint)
    if "at" in case:
        assert error.line == line_of(text, case["at"])
        assert f"n.cir:{error.line}" in error.place
    no_inner_names([str(error)])


@listed("case", CASES["command"])
def test_on_the_command_line(
    case: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("rc.toml").write_text(RIGHT)
    Path("rc.cir").write_text("x\n")
    Path("rc.txt").write_text("x\n")
    said = io.StringIO()
    with contextlib.redirect_stderr(said), contextlib.redirect_stdout(io.StringIO()):
        assert main(case["args"]) in (1, 2)
    reason, _, hint = said.getvalue().partition("\n  try: ")
    judge(case, reason[:7], reason, hint)
    assert reason[7:11] == " at "
    no_inner_names([said.getvalue()])


@listed("case", CASES["python"])
def test_in_python(case: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    Path("rc.toml").write_text(RIGHT)
    m = hb.loads(RIGHT)
    names = {"hb": hb, "m": m}
    if "run" in case["text"]:
        names["run"] = hb.simulate(m)
    with pytest.raises(hb.HybondError) as caught:
        exec(compile(case["text"], "case", "exec"), names)
    error = caught.value
    judge(case, error.code, error.why, error.hint)
    assert error.place
    no_inner_names([str(error)])


def test_a_model_that_was_changed_blames_no_line_of_the_file() -> None:
    m = hb.loads(RIGHT, where="rc.toml")
    m.elements["R"] = hb.R("2 kg")
    with pytest.raises(hb.UnitError) as caught:
        m.flatten()
    assert caught.value.line is None and caught.value.where == "elements.R.R"


def test_a_refusal_in_another_file_names_that_file(tmp_path: Path) -> None:
    inner = 'hybond = 1\ndomain = "electrical"\n[elements]\nn = { junction = 0 }\n'
    inner += 'r = { R = "2 kg" }\n[graph]\nbonds = ["n -> r"]\n[ports]\na = "n"\n'
    (tmp_path / "part.toml").write_text(inner)
    outer = RIGHT.replace('submodel = "drain"', 'submodel = "part.toml"').replace(
        ', parameters = { r = "1 Mohm" }, inputs = { wet = "0.5" }', ""
    )
    (tmp_path / "top.toml").write_text(outer)
    with pytest.raises(hb.UnitError) as caught:
        hb.load(tmp_path / "top.toml").flatten()
    assert caught.value.file == str(tmp_path / "part.toml")
    assert (caught.value.line, caught.value.written) == (5, 'r = { R = "2 kg" }')


def test_a_refusal_keeps_its_line_when_it_is_copied() -> None:
    import pickle

    error = refused(RIGHT.replace('"Rs" }', '"rs" }'), False)
    again = pickle.loads(pickle.dumps(error))
    assert str(again) == str(error) and again.to_dict()["line"] == error.line


def test_a_signal_that_is_wrong_in_itself_is_the_place_also_where_a_law_reads_it() -> None:
    text = RIGHT.replace('V = { Se = "U" }', 'V = { Se = "drive" }')
    text = text.replace("[inputs]", 'drive = "U + 1 A"\n\n[inputs]', 1)
    error = refused(text, run=False)
    assert error.code == "HB-U102"
    assert error.where == "signals.drive"
    assert error.line == line_of(text, 'drive = "U')


def test_a_domain_that_changes_the_units_of_signals_is_the_place() -> None:
    text = """hybond = 1
domain = "translational"
[elements]
pull = { Se = "10 N" }
drum = { I = "2 kg*m^2" }
v = { junction = 1 }
w = { junction = 1, domain = "rotational" }
[graph]
bonds = ["pull -> v -> w -> drum"]
[signals]
height = { integral = "v.f", start = "1 m" }
"""
    error = refused(text, run=False)
    assert (error.code, error.where, error.line) == ("HB-U103", "elements.w.domain", 7)
    assert "TF" in error.hint
