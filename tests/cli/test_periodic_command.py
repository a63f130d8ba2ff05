"""``hybond periodic``, as a command: what it prints, writes and refuses."""

import json
import math
from pathlib import Path

import pytest

from hybond.cli.interrupt import Interruptible
from hybond.cli.main import main
from hybond.cli.periodic import Runs

MODEL = """
hybond = 1
domain = "electrical"

[parameters]
D = 0.4

[inputs]
u = { pwm = { period = "0.1 ms", duty = "D" } }

[elements]
V = { Se = "10 V*u" }
L = { I = "1 mH" }
R = { R = "1 ohm" }
j = { junction = 1 }

[graph]
bonds = ["V -> j -> L", "j -> R"]
"""


@pytest.fixture
def chopper(tmp_path: Path) -> str:
    file = tmp_path / "chopper.toml"
    file.write_text(MODEL, encoding="utf-8")
    return str(file)


def test_the_orbit_is_printed_and_plotted(chopper: str, capsys, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    plot = tmp_path / "orbit.svg"
    assert main(["periodic", chopper, "--wrt", "D", "--plot", str(plot)]) == 0
    out = capsys.readouterr().out
    assert "stable: motions near it come to it" in out and f"{math.exp(-0.1):.9g}" in out
    assert "L.p by D" in out and plot.stat().st_size > 3000


def test_one_object_of_json(chopper: str, capsys) -> None:  # type: ignore[no-untyped-def]
    assert main(["periodic", chopper, "--set", "R.R=2 ohm", "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["multipliers"][0]["value"][0] == pytest.approx(math.exp(-0.2), rel=1e-9)
    assert data["signals"]["L.f"]["mean"] == pytest.approx(2.0, rel=1e-9)
    assert main(["periodic", chopper, "--along", "D=0.2..0.6", "--points", "3", "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert [p["value"] for p in data["branches"][0]["points"]][-1] == pytest.approx(0.6)


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        (["--period", "0.15 ms"], 1, "HB-A541"),
        (["--points", "5"], 1, "--points belongs to --along"),
        (["--along", "D"], 1, "is no way along a parameter"),
        (["--along", "D=0.2..0.3", "--wrt", "D"], 1, "--wrt does not go with --along"),
        (["--wrt", "E"], 1, "HB-A520"),
        (["--plot", "orbit.txt"], 1, "orbit.txt"),
    ],
)
def test_refused(chopper: str, capsys, words: list[str], code: int, said: str) -> None:  # type: ignore[no-untyped-def]
    assert main(["periodic", chopper, *words]) == code
    assert said in capsys.readouterr().err


def test_a_run_that_will_take_long_is_told_early_and_once(monkeypatch, capsys) -> None:  # type: ignore[no-untyped-def]
    clock = [100.0]
    monkeypatch.setattr("hybond.cli.periodic.time.monotonic", lambda: clock[0])
    bar = Runs(active=False)
    for part, events in ((0.0, 0), (1e-3, 10), (2e-3, 20), (3e-3, 30)):
        bar.shows(1, part, events)
        clock[0] += 1.0
    # a thousandth takes a second
    told = capsys.readouterr().err
    assert told.count("run 1 will take about 1000 s, of 1e+04 events") == 1
    for part in (0.0, 0.1, 0.5):
        bar.shows(2, part, 0)
        clock[0] += 1.0
    assert not capsys.readouterr().err


def test_ctrl_c_ends_the_search_and_not_a_step_of_it(chopper: str, monkeypatch, capsys) -> None:  # type: ignore[no-untyped-def]
    def pressed(self: Interruptible) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(Interruptible, "check", pressed)
    assert main(["periodic", chopper, "--period", "0.1 s"]) == 130
    out = capsys.readouterr()
    assert out.err.endswith("interrupted\n") and not out.out
