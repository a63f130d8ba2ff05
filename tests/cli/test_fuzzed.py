"""What `benchmarks/fuzz.py` found: each cause once, and a few cases of every reader again."""

import io
import json
import os
import random
import sys
import time
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import hybond as hb
from hybond.causality import report
from hybond.errors import HybondError
from hybond.files.edit import edit_toml
from hybond.files.parse import parse
from hybond.files.place import Source
from hybond.fitting.data import read_data
from hybond.names import did_you_mean
from hybond.studio.curves import phase
from hybond.studio.session import Session
from hybond.sweep.folder import Folder
from hybond.sweep.part import Part
from tests.cli.conftest import Shell

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))

STATE: dict[str, Any] = {
    "format": "hybond state 1",
    **{"model": "ball", "t": 1.0, "stored": {"ball.p": -9.0}, "signals": {}, "machines": {}},
}
RC = """hybond = 1
[elements]
c = { C = 1, q = 1 }
r = { R = 1 }
n = { junction = 0 }
[graph]
bonds = ["n -> c", "n -> r"]
"""


@pytest.mark.parametrize(
    "reader", ["toml", "json-tree", "netlist", "graph", "fmu", "state", "page"]
)
def test_changed_inputs_are_understood_or_refused(reader: str, tmp_path: Path) -> None:
    pytest.importorskip("resource")
    from fuzzing.everything import READERS
    from fuzzing.judging import judged

    for seed in range(4):
        draw = random.Random(f"{reader} {seed}")
        verdict = judged(
            reader, seed, tmp_path / "case", lambda at, draw=draw: READERS[reader](draw, at)
        )
        assert not verdict.wrong, verdict.said


def test_a_judge_sees_what_is_wrong(tmp_path: Path) -> None:
    pytest.importorskip("resource")
    from fuzzing.judging import judged

    def says(error: Exception) -> str:
        def case(folder: Path) -> None:
            raise error

        return judged("x", 0, tmp_path / "case", case).kind

    assert says(hb.UsageError("a", code="HB-S106", where="b", hint="c")) == "refused"
    assert says(hb.UsageError("a", code="HB-S106", where="b")) == "no place or remedy"
    assert says(hb.UsageError("a", code="HB-S999", where="b", hint="c")) == "code without page"
    assert says(ValueError("a")) == "ValueError"
    left = judged("x", 0, tmp_path / "case", lambda at: (at / ".a").touch())
    assert left.kind == "left over"


@pytest.mark.parametrize("text", ["a\x1b[31m", "\u202ea", "\ud800", "a\x00", "\u2028"])
def test_a_refusal_does_nothing_to_a_terminal(text: str) -> None:
    error = HybondError(f"{text} here", code="HB-M101", where=text, hint=text)
    error.said_in("m.toml", 3, text)
    assert str(error).encode() and str(error).replace("\n", "").isprintable()
    assert len(error.why) == len(f"{text} here")  # what points below a letter still does


def test_a_refusal_of_a_megabyte_is_short() -> None:
    error = HybondError("(" * 10**6 + " end", code="HB-E101", hint="not " * 10**6)
    assert len(str(error)) < 3000 and error.why.endswith("... end")
    started = time.process_time()
    assert did_you_mean("a" * 10**6, ["a" * 100, "b"] * 300)
    assert time.process_time() - started < 1.0


@pytest.mark.parametrize(
    "change",
    [
        {"t": 10**400},
        {"stored": {"\ud800": 1.0}},
        {"units": {"ball.p": "[]"}},
        {"units": {"ball.p": "zz"}},
    ],
)
def test_a_state_that_is_none(tmp_path: Path, change: dict[str, Any]) -> None:
    (tmp_path / "s.json").write_text(json.dumps({**STATE, "units": {"ball.p": "N*s"}}))
    assert hb.load_state(tmp_path / "s.json").t == 1.0
    (tmp_path / "s.json").write_text(json.dumps({**STATE, **change}))
    with pytest.raises(hb.UsageError) as caught:
        hb.load_state(tmp_path / "s.json")
    assert caught.value.code == "HB-S135"


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="the system has no pipes with names")
def test_a_pipe_that_nobody_writes_is_no_file(tmp_path: Path) -> None:
    for name in ("d.csv", "s.json", "g.fmu"):
        os.mkfifo(tmp_path / name)
    with pytest.raises(hb.FileError, match=r"HB-A530(.|\n)*ordinary"):
        read_data(tmp_path / "d.csv")
    with pytest.raises(hb.UsageError, match=r"HB-S135(.|\n)*ordinary"):
        hb.load_state(tmp_path / "s.json")
    with pytest.raises(hb.FileError, match=r"HB-F160(.|\n)*ordinary"):
        hb.FMU(tmp_path / "g.fmu", every=1)
    with pytest.raises(hb.FileError, match="HB-A530"):
        read_data("/dev/zero")


def test_what_is_no_unit_is_said_once(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "g.fmu", "w") as archive:
        archive.writestr("modelDescription.xml", '<!DOCTYPE a [<!ENTITY b "c">]><a/>')
    with pytest.raises(hb.FileError) as caught:
        hb.FMU(tmp_path / "g.fmu", every=1)
    assert str(caught.value).count("HB-F160") == 1


@pytest.mark.parametrize("value", [10**400, float("inf"), float("nan")])
def test_a_sweep_has_finite_values(value: float) -> None:
    with pytest.raises(hb.UsageError) as caught:
        hb.Plan({"m": [1.0, value]})
    assert caught.value.code == "HB-P101"


def _damaged(content: bytes, name: str, new: bytes, called: str = "") -> bytes:
    packed = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(content)) as old, zipfile.ZipFile(packed, "w") as archive:
        for member in old.namelist():
            hit = member == name
            archive.writestr(called if hit and called else member, new if hit else old.read(member))
    return packed.getvalue()


def _encrypted(content: bytes) -> bytes:
    """Say of every member in the directory of an archive that it is encrypted."""
    found = bytearray(content)
    at = found.find(b"PK\x01\x02")
    while at >= 0:
        found[at + 8] |= 1
        at = found.find(b"PK\x01\x02", at + 4)
    return bytes(found)


def test_a_part_of_a_sweep_that_is_damaged_is_none(tmp_path: Path) -> None:
    whole = Part(0, ["ok"], np.ones(1), {}, {"final(x)": np.ones(1)}).to_bytes("k")
    longer = io.BytesIO()
    np.save(longer, np.ones(7))
    magic = b"\x93NUMPY\x01\x00\x10\x00"
    contents = [
        _damaged(whole, "c0.npy", magic + b"{'descr': (((((\n"),
        _damaged(whole, "c0.npy", b"no array"),
        _damaged(whole, "about.npy", b"no array"),
        _damaged(whole, "c0.npy", longer.getvalue()),
        _damaged(whole, "c0.npy", b"1", called="c0"),  # bytes as they are, as many as members
        _encrypted(whole),
        whole[:100],
        b"",
    ]
    folder = Folder(tmp_path / "s")
    folder.key = "k"
    folder.place(0, 1).write_bytes(whole)
    assert folder.read(0, 1) is not None
    for content in contents:
        folder.place(0, 1).write_bytes(content)
        assert folder.read(0, 1) is None
    folder.close()


@pytest.mark.parametrize(
    "about", ['{"key": "a", "part": 0, "job": {}}', '{"key": "a", "part": 1, "job": []}']
)
def test_a_folder_that_says_nonsense_of_its_sweep(tmp_path: Path, about: str) -> None:
    model = hb.loads(RC)
    (tmp_path / "s" / "parts").mkdir(parents=True)
    (tmp_path / "s" / "sweep.json").write_text(about)
    (tmp_path / "s" / "parts" / "x").write_text("")
    with pytest.raises(hb.UsageError) as caught:
        hb.sweep(model, {"r.R": [1.0, 2.0]}, collect="final(c.q)", until=1, out=tmp_path / "s")
    assert caught.value.code == "HB-P107"


def test_a_name_that_is_a_folder(shell: Shell) -> None:
    done = shell("new", "..", "--force")
    assert (done.code, done.err.split()[0]) == (1, "HB-X102")
    assert not (shell.folder / "...toml").exists()


@pytest.mark.parametrize("every", [1e-12, 1e-40])
def test_periods_that_no_run_comes_through(every: float) -> None:
    m = hb.loads(RC)
    m.signal(seen=hb.Sampled("c.q", every=every))
    with pytest.raises(hb.UsageError) as caught:
        hb.simulate(m, until=1)
    assert (caught.value.code, caught.value.where) == ("HB-S142", "signals.seen")
    m = hb.loads(RC)
    m.input(u=hb.Input(table=[[0, 0], [every / 2, 1]], period=every))
    with pytest.raises(hb.UsageError, match=r"HB-S142 at inputs\.u"):
        hb.simulate(m, until=1)


def test_a_measurement_of_a_parameter_that_is_not_there(tmp_path: Path) -> None:
    path = tmp_path / "n.cir"
    deck = "t\nV1 in 0 1\nR1 in 0 1\n.tran 1u 1m\n.meas tran v FIND {} AT=0\n"
    path.write_text(deck.format("v(in)"))
    assert not [w for w in hb.read_circuit(path).warnings if "measure" in str(w)]
    path.write_text(deck.format("(in)"))
    said = [str(w) for w in hb.read_circuit(path).warnings]
    assert any("there is no parameter 'in'" in w for w in said), said


def test_many_equal_items_are_edited_in_little_time() -> None:
    old = {"graph": {"bonds": ["a -> b", *["b -> c"] * 3000, "d -> e"]}}
    new = {"graph": {"bonds": ["a -> b", *["x -> c", "b -> c"] * 1500, "d -> e"]}}
    text = "[graph]\nbonds = [" + ", ".join(f'"{b}"' for b in old["graph"]["bonds"]) + "] # mine\n"
    started = time.process_time()
    found = edit_toml(text, old, new)
    assert time.process_time() - started < 5.0
    assert parse(Source("found", found)) == new and found.endswith("# mine\n")


def test_of_hundreds_of_conflicts_in_one_place_some_are_looked_at(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    m = hb.Model()
    names = [f"{k}" for k in range(60)]
    m.add(a=hb.Se(1), j=hb.Zero(), r=hb.R(1), **{f"s{k}": hb.Se(1) for k in names})
    m.add(**{f"c{k}": hb.One() for k in names})
    m.bond("a -> j", "j -> r", *[f"s{k} -> c{k} -> j" for k in names])
    states = {"off": [], "on": [f"c{k}" for k in names]}
    m.machine("k", states=states, start="off", rules=["off -> on when time > 1 [s]"])
    looked_at: list[Any] = []
    own = report.smallest
    monkeypatch.setattr(report, "smallest", lambda *given: looked_at.append(given) or own(*given))
    # whatever is looked at, the one machine that makes them is named
    assert "switches: k = on" in str(report.causality(m))
    assert 0 < len(looked_at) <= 20


# -- the studio


@pytest.fixture
def session(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.setenv("HYBOND_STATE", str(tmp_path / "state"))
    (tmp_path / "m.toml").write_text(RC)
    found = Session(tmp_path / "m.toml")
    yield found
    found.close()


def asked(session: Session, **message: Any) -> Any:
    answer = session.handle({"id": 1, **message})
    session.settle()
    return answer.get("error", {}).get("code")


def test_half_a_character_reaches_no_file(session: Session) -> None:
    file = session.document.file
    assert file is not None
    assert asked(session, ask="replace", text="hybond = 1\n# \ud800") == "HB-F104"
    edit = {"do": "set", "path": ["title"], "value": "\ud800"}
    assert asked(session, ask="edit", edit=edit) == "HB-F108"
    edit = {"do": "set", "path": ["parameters", "x"], "value": float("inf")}
    assert asked(session, ask="edit", edit=edit) == "HB-F108"
    assert file.read_text() == RC and asked(session, ask="look") is None
    assert asked(session, ask="edit", edit={**edit, "value": 2}) is None
    assert "x = 2" in file.read_text()


@pytest.mark.parametrize("name", ["n" * 70_000 + ".toml", "a\0.toml", "sub.toml", "a\n.toml", ""])
def test_names_that_no_file_has(session: Session, name: str) -> None:
    (session.root / "sub.toml").mkdir()
    for ask in ("save as", "open"):
        if name or ask == "save as":
            assert asked(session, ask=ask, file=name, replace=True) == "HB-W104"


def test_another_file_is_replaced_as_a_whole_or_not_at_all(
    session: Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    other = session.root / "other.toml"
    other.write_text("hybond = 1 # precious\n")

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(os, "replace", full)
        assert asked(session, ask="save as", file="other.toml", replace=True) == "HB-F119"
    assert other.read_text() == "hybond = 1 # precious\n"
    assert asked(session, ask="save as", file="other.toml", replace=True) is None
    assert other.read_text() == RC and session.document.name == "other.toml"


@pytest.mark.parametrize(
    "text",
    [
        "hybond = 1\n[ports]\na = { b = 1 }\n[elements]\nr = { R = 1 }\n",
        RC.replace("junction = 0", "junction = 0.0"),
        RC + "[layout]\nr = [inf, 0]\n",
        RC + "[layout]\nr = [1e300, nan]\n",
        RC.replace("junction = 0", "junction = false"),
        "hybond = 1\nmodels = 3\n",
        "hybond = 1\n[models]\na = 3\n[machines]\nb = 4\n",
        "hybond = 1\nx = " + "[" * 400 + "]" * 400,
    ],
)
def test_a_page_shows_what_means_nothing(session: Session, text: str) -> None:
    assert asked(session, ask="replace", text=text) is None
    assert asked(session, ask="look") is None
    # refused, or done; and it still answers
    asked(session, ask="edit", edit={"do": "add", "element": {"R": 1}})
    assert asked(session, ask="look") is None


@pytest.mark.parametrize("number", [10**400, 1e300, "x", None, [], {}])
def test_places_that_are_none(session: Session, number: object) -> None:
    for message in (
        {"ask": "attempt", "edit": {"do": "paste", "data": {}, "by": [number, 1]}},
        {"ask": "edit", "edit": {"do": "move", "at": {"r": [number, number]}}},
        {"ask": "curves", "run": 1, "names": [], "t0": number, "width": number},
    ):
        asked(session, **message)
    assert asked(session, ask="look") is None


def test_a_journal_with_nonsense_is_passed_over(session: Session) -> None:
    file = session.document.file
    assert file is not None and session.document.journal is not None
    path = session.document.journal.path
    session.close()
    lines = ["[" * 100_000, '{"edit": {"do": "remove", "names": 3}}', '{"edit": {"do": "add"}}']
    path.write_text(json.dumps({"text": RC}) + "\n" + "\n".join(lines) + "\n")
    again = Session(file)
    assert asked(again, ask="look") is None and again.document.text == RC
    again.close()


@pytest.mark.parametrize("name", ["out/\ud800", "out/a\0b"])
def test_names_that_no_file_has_are_refused(shell: Shell, name: str) -> None:
    """Before the run, not after it; a letter that cannot be written is written as its number."""
    Path("out").mkdir()
    for words in (
        ["analyse", "spring.toml", "--draw", f"{name}.svg"],
        ["draw", "spring.toml", "--out", f"{name}.svg"],
        *(["run", "spring.toml", f"--{k}", f"{name}.csv"] for k in ("out", "journal")),
        ["run", "spring.toml", "--plot", f"{name}.png"],
    ):
        done = shell(*words)
        assert done.code == 1 and not done.out
        assert "HB-X102" in done.err and "no name of a file" in done.err


def test_a_part_that_was_a_table_becomes_a_word() -> None:
    """What an inline table had is replaced by a text, item by item."""
    old = {"hybond": 1, "elements": {"r": {"R": {"e": "2*f"}}}}
    text = 'hybond = 1\n[elements]\nr = { R = { e = "2*f" } } # kept\n'
    new = {"hybond": 1, "elements": {"r": "gone"}}
    assert edit_toml(text, old, new, finely=True).splitlines()[2].startswith('r = "gone"')


def test_a_key_as_long_as_a_book_is_refused(session: Session) -> None:
    key = "sin(" * 500_000
    edit = {"do": "set", "path": ["parameters", key], "value": -0.7}
    begin = time.process_time()
    assert asked(session, ask="edit", edit=edit) is not None
    assert time.process_time() - begin < 2.0 and asked(session, ask="look") is None
    with pytest.raises(HybondError, match="HB-F108"):
        hb.loads(f'hybond = 1\n[parameters]\n"{key}" = 1\n')


def test_a_stretch_of_no_length_has_a_remedy() -> None:
    run = hb.simulate(hb.loads(RC), 0.1)
    with pytest.raises(HybondError, match="HB-W103") as seen:
        phase(run, "c.e", "c.q", 0.05, -1.0)
    assert seen.value.hint


def test_places_too_far_apart_are_not_drawn() -> None:
    m = hb.Model("far")
    m.add(c=hb.C(1.0, q=1.0), r=hb.R(1.0), n=hb.Zero())
    m.bond("n -> c", "n -> r")
    m.layout = {"n": (0, 0), "c": (1, 2**32)}
    with pytest.raises(HybondError, match="HB-D112"):
        hb.draw(m)
    m.layout = {"n": (0, 0), "c": (0, 1500)}
    assert "<svg" in hb.draw(m).svg()


def test_refusals_of_a_page_have_a_place_and_a_remedy(session: Session) -> None:
    assert asked(session, ask="replace", text="hybond = 1\n[elements]\nr = { R = }") is None
    for message in ({"ask": "run", "options": {"": 1}}, {"ask": "schematic", "level": "nowhere"}):
        error = session.handle({"id": 1, **message})["error"]
        assert error["where"] and error["try"]
