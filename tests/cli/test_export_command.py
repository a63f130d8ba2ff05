"""``hybond export``: files, refusals, what goes to the terminal."""

from __future__ import annotations

from pathlib import Path

import pytest

from hybond.cli.main import main

BALL = str(Path(__file__).parents[2] / "examples" / "bouncing_ball.toml")


@pytest.mark.slow
def test_a_file_is_written_once(tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["export", BALL, "--to", "c"]) == 0
    assert capsys.readouterr().out == "bouncing_ball.c\n"
    text = Path("bouncing_ball.c").read_text(encoding="utf-8")
    assert text.startswith("/* Ball on a springy floor (Margetts & Ngwompo)\n")
    assert main(["export", BALL, "--to", "c"]) == 1
    assert capsys.readouterr().err.startswith("HB-X104 at bouncing_ball.c")
    assert main(["export", BALL, "--to", "c", "--force", "--until", "1 s"]) == 0
    assert "    .until = 1.0," in Path("bouncing_ball.c").read_text(encoding="utf-8")


@pytest.mark.slow
def test_a_class_is_called_as_its_file(tmp_path, capsys) -> None:
    target = tmp_path / "Drop.java"
    assert main(["export", BALL, "--to", "java", "--out", str(target)]) == 0
    assert "public final class Drop {" in target.read_text(encoding="utf-8")


def test_settings_are_in_the_program(capsys) -> None:
    assert main(["export", BALL, "--to", "c", "--set", "ball.p=2", "--out", "-"]) == 0
    assert ".storage_start = (const double[]){2.0, 0.0}," in capsys.readouterr().out


def test_what_cannot_be_written_is_refused(tmp_path, capsys) -> None:
    assert main(["export", BALL, "--to", "jav"]) == 1
    assert capsys.readouterr().err.startswith("HB-E602 at --to: there is no export to 'jav'")
    assert main(["export", BALL, "--to", "c", "--out", str(tmp_path / "ball.txt")]) == 1
    assert capsys.readouterr().err.startswith("HB-X102")
    assert main(["export", BALL, "--to", "c", "--solver", "heun", "--out", "-"]) == 1
    assert capsys.readouterr().err.startswith("HB-E632")


def refused(capsys, *words: str) -> str:
    """Return how a command is refused."""
    assert main(list(words)) in (1, 2)
    return capsys.readouterr().err


def test_a_class_cannot_be_called_as_every_file(tmp_path, capsys) -> None:
    for name in ("my ball", "2balls", "class", "String"):
        said = refused(
            capsys, "export", BALL, "--to", "java", "--out", str(tmp_path / f"{name}.java")
        )
        assert said.startswith(f"HB-E606 at name: no Java class can be called {name!r}")
    assert list(tmp_path.iterdir()) == []


def test_numbers_that_make_no_program_are_refused(capsys) -> None:
    for option, value, code in (
        ("--rtol", "-1", "HB-S107"),
        ("--atol", "-1", "HB-S107"),
        ("--points", "0", "HB-E607"),
        ("--max-step", "0 s", "HB-S103"),
        ("--until", "-1 s", "HB-S106"),
    ):
        words = ("export", BALL, "--to", "c", "--out", "-", f"{option}={value}")
        assert refused(capsys, *words).startswith(code), option


def test_remedies_name_what_can_be_done(tmp_path, capsys) -> None:
    said = refused(capsys, "export", BALL, "--to", "c", "--out", str(tmp_path / "ball.txt"))
    assert "try: end it in .c\n" in said
    said = refused(capsys, "export", BALL, "--to", "c", "--out", str(tmp_path))
    assert "it is a folder" in said
    said = refused(capsys, "export", BALL, "--to", "python", "--until", "1 s", "--out", "-")
    assert "leave it out; it is for c, fmu, java" in said
    said = refused(capsys, "export", str(tmp_path / "buck.cir"), "--to", "c")
    assert said.startswith("HB-F101") and "there is no such file" in said


def test_the_version_of_a_unit_is_an_option(tmp_path, capsys) -> None:
    said = refused(capsys, "export", BALL, "--to", "fmu", "--fmi", "1.0", "--out", "-")
    assert said.startswith("HB-E604 at fmi: FMI 1.0 is not written")
    said = refused(capsys, "export", BALL, "--to", "c", "--fmi", "2.0", "--out", "-")
    assert said.startswith("HB-E602 at fmi")
