"""Exit codes and messages: one clear message, never a traceback."""

import json
import os
from pathlib import Path
from typing import Any

import pytest


@pytest.mark.parametrize(
    "words, code, says",
    [
        ([], 1, "no verb"),
        (["rnu"], 1, "'run'"),
        (["run"], 1, "FILE"),
        (["run", "ball.toml", "--unti", "1"], 1, "--unti"),
        (["run", "ball.toml", "--rtol", "x"], 1, "--rtol"),
        (["run", "ball.toml", "--rtol", "7"], 1, "HB-S107"),
        (["run", "ball.toml", "--solver", "rk54"], 1, "'rk45'"),
        (["run", "ball.toml", "--until", "1 kg"], 1, "HB-S106"),
        (["run", "ball.toml", "--until", "-1"], 1, "HB-S106"),
        (["run", "ball.toml", "--until", "nan"], 1, "HB-S106"),
        (["run", "ball.toml", "--at", "1.6"], 1, "HB-S110"),
        (["run", "ball.toml", "--at=-1"], 1, "HB-S110"),
        (["run", "ball.toml", "--at", "1", "--signals", "heigth"], 1, "'height'"),
        (["run", "ball.toml", "--set", "e"], 1, "HB-X103"),
        (["run", "ball.toml", "--set", "e=1 ??"], 2, "HB-"),
        (["run", "ball.toml", "--out", "r.xls"], 1, ".csv"),
        (["run", "ball.toml", "--plot", "none/r.png"], 1, "no folder"),
        (["run", "nothing.toml"], 2, "HB-F101"),
        (["check", "."], 2, "HB-F102"),
        (["draw", "ball.toml", "--mode", "impact=hit"], 1, "'hits'"),
        (["draw", "ball.toml", "--out", "ball.toml"], 1, ".svg"),
        (["convert", "ball.toml", "ball.yaml"], 1, ".json"),
        (["demo", "--examples", "none"], 1, "no models"),
    ],
)
def test_refusals_have_a_code_and_a_reason(
    shell: Any, words: list[str], code: int, says: str
) -> None:
    done = shell(*words)
    assert done.code == code, done.err
    assert done.err.startswith("HB-") and says in done.err
    assert "Traceback" not in done.err
    assert done.out == ""


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"\xff\xfe\x00\x80",
        b"hybond = 99\n",
        b"hybond = 1\nfoo = 1\n",
        b"hybond = 1\nx = " + b"[" * 100_000,
        b"hybond = 1\n[elements]\na = { Se = \"__import__('os').getcwd()\" }\n",
        b'hybond = 1\n[elements]\na = { Se = "9**9**9**9**9" }\nb = { R = 1 }\n'
        b'[graph]\nbonds = ["a -> b"]\n[experiment]\nuntil = 1\n',
        b'hybond = 1\n[experiment]\nuntil = "tomorrow"\n',
        b'hybond = 1\n[experiment]\nuntil = 1\nplot = ["x.e"]\n',
    ],
    ids=["empty", "binary", "version", "key", "deep", "code", "power", "until", "plot"],
)
def test_hostile_files_are_refused_and_json_stays_one_object(shell: Any, data: bytes) -> None:
    (shell.folder / "bad.toml").write_bytes(data)
    done = shell("run", "bad.toml", "--json")
    assert done.code in (2, 3), done.err
    assert done.err.startswith("HB-") and "Traceback" not in done.err
    assert not done.err.startswith("HB-X001")
    assert done.json["status"] == "error"
    assert done.json["error"]["code"] in done.err


def test_an_unexpected_failure_asks_for_a_report(
    shell: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(*args: Any) -> None:
        raise ZeroDivisionError("of the developers' own making")

    monkeypatch.setattr("hybond.cli.netlists.load", broken)
    done = shell("run", "ball.toml", "--json")
    assert done.code == 3
    assert done.err.startswith("HB-X001") and "please report" in done.err
    assert "Traceback" not in done.err
    assert done.json["error"]["code"] == "HB-X001"
    monkeypatch.setenv("HYBOND_DEBUG", "1")
    assert "Traceback" in shell("run", "ball.toml").err


@pytest.mark.skipif(
    os.name == "nt" or getattr(os, "geteuid", lambda: 1)() == 0,
    reason="whoever may write everywhere cannot be refused",
)
def test_a_folder_one_may_not_write_to(shell: Any) -> None:
    folder = shell.folder / "locked"
    folder.mkdir(mode=0o500)
    done = shell("run", "ball.toml", "--out", "locked/r.csv")
    assert done.code == 1 and "HB-X002" in done.err


def test_help_has_an_example_for_each_verb(shell: Any) -> None:
    whole = shell("--help")
    assert whole.code == 0
    for verb in ("demo", "new", "check", "draw", "run", "sweep", "explain", "convert", "library"):
        assert f"    {verb}" in whole.out
        done = shell(verb, "--help")
        assert done.code == 0 and f"hybond {verb}" in done.out.split("\nexample")[1]


def test_version(shell: Any) -> None:
    import hybond
    from hybond.engine.outcome.engines import choose_engine

    made = f"runs are made by {choose_engine().said}"
    assert shell("--version").out == f"hybond {hybond.__version__}\n{made}\n"


def test_every_verb_is_in_the_page(shell: Any) -> None:
    page = Path(__file__).parents[2] / "docs" / "cli.md"
    text = page.read_text(encoding="utf-8")
    for verb in ("demo", "new", "check", "draw", "run", "sweep", "explain", "convert", "library"):
        assert f"`hybond {verb}" in text


def test_json_failure_is_plain_ascii(shell: Any) -> None:
    done = shell("run", "δ.toml", "--json")
    assert done.out.isascii() and json.loads(done.out)["file"] == "δ.toml"


@pytest.mark.parametrize(
    "said, code, where",
    [
        ('until = "2 parsecs"', "HB-S106", "experiment.until"),
        ('until = ["1 s", "2 s"]', "HB-S106", "experiment.until"),
        ('solver = "rk54"', "HB-S101", "experiment.solver"),
        ('solver = "rk4"', "HB-S102", "experiment.solver"),
        ('solver = "rk4"\nstep = "1 N"', "HB-S106", "experiment.step"),
        ('max_step = "1 N"', "HB-S106", "experiment.max_step"),
        ('sliding = "hysteresis"', "HB-S111", "experiment.sliding"),
        ('start = { "mass.q" = 1 }', "HB-S134", "experiment.start.mass.q"),
        ('start = { "mass.p" = "1 N" }', "HB-S134", "experiment.start.mass.p"),
    ],
)
def test_check_refuses_what_a_run_of_the_experiment_refuses(
    shell: Any, said: str, code: str, where: str
) -> None:
    text = (shell.folder / "spring.toml").read_text()
    if "until" in said:
        text = text.replace('until = "2 s"\n', "")
    (shell.folder / "asked.toml").write_text(text + said + "\n")
    for words in (["run", "asked.toml"], ["check", "asked.toml"]):
        done = shell(*words)
        assert done.code in (1, 2)
        assert done.err.startswith(f"{code} at asked.toml:") and f": {where}: " in done.err
        assert "fine" not in done.out
    told = json.loads(shell("check", "asked.toml", "--json").out)
    assert told["error"]["where"] == where and not told["ok"]


@pytest.mark.parametrize("verb", ["run", "measure", "sweep"])
def test_what_does_not_add_up_is_no_signal(shell: Any, verb: str) -> None:
    """Of a force and a velocity nothing is printed, and they have the names that were asked for."""
    words = {
        "run": ["run", "spring.toml", "--at", "1", "--signals", "mass.f - spring.e"],
        "measure": ["measure", "spring.toml", "mean(mass.f - spring.e)"],
        "sweep": [
            "sweep",
            "spring.toml",
            "--vary",
            "m=1,2",
            "--collect",
            "final(mass.f - spring.e)",
        ],
    }[verb]
    done = shell(*words)
    assert done.code in (1, 2)
    assert "HB-U102" in done.err and "'mass.f' in m/s and 'spring.e' in N" in done.err


@pytest.mark.parametrize(
    "words, meant",
    [
        (["sweep", "ball.toml", "--measure", "final(v.f)"], "--collect"),
        (["run", "ball.toml", "-o", "run.csv"], "--out"),
        (["run", "ball.toml", "--t-end", "3"], "--until"),
        (["run", "ball.toml", "--param", "e=1"], "--set"),
    ],
)
def test_an_option_by_the_name_it_has_elsewhere_is_understood(
    shell: Any, words: list[str], meant: str
) -> None:
    done = shell(*words)
    assert done.code == 1 and f"did you mean '{meant}'?" in done.err
