"""``hybond export``: files, refusals, what goes to the terminal."""

from __future__ import annotations

from pathlib import Path

from hybond.cli.main import main

BALL = str(Path(__file__).parents[2] / "examples" / "bouncing_ball.toml")


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
    assert main(["export", BALL, "--to", "c", "--solver", "liqss2", "--out", "-"]) == 1
    assert capsys.readouterr().err.startswith("HB-E632")
