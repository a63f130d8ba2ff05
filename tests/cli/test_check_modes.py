"""check --modes."""

from __future__ import annotations

from typing import Any


def test_time_that_stops_ends_with_3_and_a_picture(shell: Any) -> None:
    done = shell("check", "--modes", "no_mode.toml", "--out", "modes.svg")
    assert (done.code, done.err) == (3, "")
    # by hand: above 0.5 V each state is left for the other
    assert "no mode holds from (a) where c.q > 0.5" in done.out
    assert "possible: time stops" in done.out
    assert done.out.splitlines()[-1] == "modes.svg"
    svg = (shell.folder / "modes.svg").read_text(encoding="utf-8")
    assert 'data-mode="a"' in svg and 'data-mode="b"' in svg


def test_json_is_one_object(shell: Any) -> None:
    done = shell("check", "ball.toml", "--modes", "--until", "0", "--json")
    assert done.code == 0
    data = done.json
    assert data["hybond"] == 1 and data["file"] == "ball.toml" and data["time"] == "proved"
    assert [n["kinds"] for n in data["nodes"]] == [["start", "continuous"], ["pinnacle"]]


def test_what_is_assumed_is_said(shell: Any) -> None:
    words = ("--modes", "--until", "0", "--where", "c.q < 0.5")
    done = shell("check", "no_mode.toml", *words)
    assert done.code == 0 and "assumed: c.q < 0.5" in done.out
    assert "proved: time always goes on" in done.out


def test_options_that_belong_to_it(shell: Any) -> None:
    for words in (("--out", "a.svg"), ("--where", "c.q < 1"), ("--modes", "--cross")):
        done = shell("check", "no_mode.toml", *words)
        assert done.code == 1 and "HB-X101" in done.err
    assert "HB-X102" in shell("check", "no_mode.toml", "--modes", "--out", "a.gif").err
