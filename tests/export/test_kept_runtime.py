"""The runtime that is kept from call to call: the same program, or none."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from hybond.export import kept, user_folder
from hybond.translate import load_texts
from hybond.translate.c_printer import CPrinter
from hybond.translate.effects import effects_of
from hybond.translate.modules import Program
from hybond.translate.reach import uses_of
from hybond.translate.specialise import Specialist, deciding
from hybond.translate.stored import restored, stored

TEXTS = {
    "model": """
from __future__ import annotations

from hybond.engine.words import given

MOST: Final = 3  # of them


@given
class Model:
    many: int
    few: int
""".replace("import given", "import given\n\nfrom typing import Final"),
    "user": '''
from __future__ import annotations

from hybond.engine.model import MOST, Model
from hybond.engine.words import Floats


def half(v: Floats) -> float:
    """Return half of it."""
    return -0.5 * v[0]  # of the first


def used(m: Model, v: Floats) -> float:
    # whether there are any
    if m.many > 0 and v[0] > 1e-12:
        for i in range(MOST):
            v[i] += half(v)
        return 1.0
    elif m.few > 0:
        return 2.0
    return half(v) if v[0] < 3.0 else 1e300
''',
}
FACTS = [
    {},
    {("Model", "many"): 0},
    {("Model", "few"): 0},
    {("Model", "many"): 0, ("Model", "few"): 0},
]


@pytest.fixture
def program(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Program:
    monkeypatch.setattr(kept, "place_of", lambda name: tmp_path / "there" / name)
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "user"))
    return load_texts(TEXTS)


def read(program: Program) -> kept.Read:
    effects = effects_of(program, ["used"])
    return kept.Read(program, effects, uses_of(program), deciding(program))


def printed(own: Specialist, facts: Any, texts: dict[int, list[str]] | None = None) -> str:
    less, uses = own.program_for(facts)
    printer = CPrinter(less, ["used"], effects=own.effects, uses=uses)
    printer.opened = own.opened
    printer.known = {} if texts is None else texts
    return "\n".join(line for m in less.modules for line in printer.chapter(m))


def test_a_program_that_is_stored_comes_back_as_it_was(program: Program) -> None:
    back = restored(stored(program))
    assert back == program and repr(back) == repr(program)  # 1 and True and 1.0 are told apart
    assert stored(back) == stored(program)


@pytest.mark.parametrize("facts", FACTS)
def test_functions_that_are_kept_aside_are_printed_as_those_that_are_read(
    program: Program, facts: Any
) -> None:
    """From bodies that are opened when asked for, for facts that were seen and that were not."""
    whole = read(program)
    fresh = Specialist(program, whole.effects)
    kept.keep_runtime(whole)
    back = kept.runtime_kept()
    assert back is not None and back.effects == whole.effects and back.deciding == whole.deciding
    bodies = [f.body for f in back.program.functions.values()]
    assert bodies == [kept.UNREAD] * 2
    known = {}
    for seen in FACTS[:2]:
        fresh.program_for(seen)
        known.update({made: fresh.made_uses[id(f)] for made, f in fresh.made.items()})
    for seen_before in ({}, known):
        own = Specialist(
            back.program, back.effects, uses=back.uses, bodies=back.bodies, known=seen_before
        )
        assert printed(own, facts) == printed(Specialist(program, whole.effects), facts)


def test_what_is_kept_of_other_sources_or_cut_off_is_not_read(
    program: Program, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert kept.runtime_kept() is None
    kept.keep_runtime(read(program))
    place = tmp_path / "there" / "read"
    data = place.read_bytes()
    assert list(place.parent.iterdir()) == [place]  # nothing half written beside it
    for wrong in (data[:-1], data[:70], data[:10], b"", data[:-1] + bytes([data[-1] ^ 1])):
        place.write_bytes(wrong)
        assert kept.runtime_kept() is None
    place.write_bytes(data)
    assert kept.runtime_kept() is not None
    monkeypatch.setattr(kept, "stamp", lambda: b"?" * 32)
    assert kept.runtime_kept() is None


def test_where_nothing_can_be_kept_nothing_is(program: Program, tmp_path: Path) -> None:
    for name in ("there", "user"):
        (tmp_path / name).write_text("a file in the way", encoding="utf-8")
    kept.keep_runtime(read(program))
    assert kept.runtime_kept() is None
    assert kept.printed_kept("c") == kept.Printed()


def test_what_is_printed_is_kept_with_what_it_uses(program: Program) -> None:
    own = Specialist(program, effects_of(program, ["used"]))
    own.program_for(FACTS[1])
    uses = {made: own.made_uses[id(f)] for made, f in own.made.items()}
    kept.keep_printed("c", kept.Printed(uses, {next(iter(uses)): "static\nδ"}))
    assert kept.printed_kept("c") == kept.Printed(uses, {next(iter(uses)): "static\nδ"})
    assert kept.printed_kept("java") == kept.Printed()


@pytest.mark.parametrize("why", ["no bytecode", "read only", "no place"])
def test_where_python_writes_no_bytecode_it_is_kept_with_the_user(
    program: Program, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, why: str
) -> None:
    """An installation that is read only took seconds for each export."""
    if why == "no bytecode":
        monkeypatch.setattr(sys, "dont_write_bytecode", True)
    elif why == "read only":
        (tmp_path / "there").write_text("a file in the way", encoding="utf-8")
    else:
        monkeypatch.setattr(kept, "place_of", lambda name: None)
    whole = read(program)
    kept.keep_runtime(whole)
    assert not (tmp_path / "there" / "read").exists()
    (file,) = (tmp_path / "user" / "hybond").iterdir()
    back = kept.runtime_kept()
    assert back is not None and back.effects == whole.effects
    file.write_bytes(file.read_bytes()[:-1])
    assert kept.runtime_kept() is None


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="rights as POSIX has them")
@pytest.mark.parametrize("what", ["file", "folder", "link", "linked folder", "of another"])
def test_what_others_can_have_written_is_not_read(
    program: Program, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, what: str
) -> None:
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    kept.keep_runtime(read(program))
    folder = tmp_path / "user" / "hybond"
    (file,) = folder.iterdir()
    assert kept.runtime_kept() is not None and folder.stat().st_mode & 0o077 == 0
    if what == "file":
        file.chmod(0o666)
    elif what == "folder":
        folder.chmod(0o777)
    elif what == "link":
        os.link(file, tmp_path / "other")
        file.unlink()
        file.symlink_to(tmp_path / "other")
    elif what == "linked folder":
        folder.rename(tmp_path / "other")
        folder.symlink_to(tmp_path / "other")
    else:
        real = os.getuid()
        monkeypatch.setattr(os, "getuid", lambda: real + 1)
    assert kept.runtime_kept() is None


def test_files_of_other_versions_are_taken_away(
    program: Program, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    whole = read(program)
    for k in range(20):
        monkeypatch.setattr(kept, "stamp", lambda k=k: bytes([k]) * 32)
        kept.keep_runtime(whole)
    monkeypatch.undo()
    assert len(list((tmp_path / "user" / "hybond").iterdir())) == user_folder.FILES


@pytest.mark.parametrize("given", ["", "relative/path"])
def test_the_folder_of_the_user_follows_the_rules_of_xdg(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, given: str
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", given)
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setattr(sys, "platform", "linux")
    assert user_folder.user_folder() == tmp_path / ".cache" / "hybond"
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "own"))
    assert user_folder.user_folder() == tmp_path / "own" / "hybond"


@pytest.mark.slow
@pytest.mark.parametrize("target", ["c", "java"])
def test_a_program_that_is_exported_again_is_the_same(tmp_path: Path, target: str) -> None:
    """Read, then from what was kept; and where Python keeps nothing."""
    said = []
    for more in ({}, {}, {"PYTHONDONTWRITEBYTECODE": "1"}):
        here = {**os.environ, "PYTHONPYCACHEPREFIX": str(tmp_path / "kept")}
        here["XDG_CACHE_HOME"] = str(tmp_path / "user")
        here.pop("PYTHONDONTWRITEBYTECODE", None)
        ball = ["export", "examples/bouncing_ball.toml", "--to", target, "--out", "-"]
        done = subprocess.run(
            [sys.executable, "-m", "hybond", *ball],
            env=here | more,
            capture_output=True,
            check=True,
        )
        said.append(done.stdout)
        assert list(tmp_path.rglob("_runtime.read")) and list(tmp_path.rglob(f"_runtime.{target}"))
    assert len(said[0]) > 500_000 and said[0] == said[1] == said[2]
