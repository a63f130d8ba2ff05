"""check, draw, explain, new, convert, demo."""

from typing import Any

import pytest

import hybond as hb
from hybond.cli.demo import EXPECTED
from hybond.files.examples import examples_folder, models_in

CONFLICT = """\
hybond = 1
[elements]
V = { Se = 10 }
W = { Se = 12 }
r = { R = 1 }
node = { junction = 0 }
[graph]
bonds = ["V -> node", "W -> node", "node -> r"]
"""

SOURCES = """\
hybond = 1
[elements]
one = { Sf = 1 }
two = { Sf = 2 }
d = { junction = 1, law = "diode" }
[graph]
bonds = ["one -> d", "two -> d"]
"""

PUCK = """\
hybond = 1
domain = "translational"
[elements]
x = { junction = 1, law = "coulomb", limit = 1 }
y = { junction = 1, law = "coulomb", pair = "x" }
z = { junction = 1, law = "relay", limit = 1 }
m_x = { I = 1 }
m_y = { I = 1 }
m_z = { I = 1 }
brake = { R = 1 }
[graph]
bonds = ["x -> m_x", "y -> m_y", "z -> m_z", "z -> brake"]
[signals]
path = { integral = "x.f" }
[machines.brakes]
start = "off"
states = { off = [], on = ["brake"] }
rules = ["off -> on when z.f > 1"]
"""


def test_check_reports_counts_machines_and_fieldless_states(shell: Any) -> None:
    done = shell("check", "ball.toml")
    assert done.code == 0
    assert "3 elements (1 I, 1 Se, 1 Sf)" in done.out
    assert "machine impact: *away, hits (fieldless)" in done.out
    assert "derivative causality: ball.p" in done.out  # while it hits, the floor rules
    assert done.out.endswith("fine\n")


def test_check_counts_what_was_written(shell: Any) -> None:
    # laws bring in the sources of friction, and two numbers of a pair; a switched R its junction
    shell.file("puck.toml", PUCK)
    done = shell("check", "puck.toml")
    assert done.code == 0
    assert "  4 elements (3 I, 1 R)\n" in done.out
    assert "  3 junctions, 3 of them controlled; 4 bonds\n" in done.out
    assert "  3 stored quantities and 1 integral\n" in done.out
    assert "machine x: *sticks, slips" in done.out and "machine z: *sticks" in done.out


def test_check_enters_the_start_where_junctions_have_laws(shell: Any) -> None:
    """One ampere into a diode and two out of it: no branch of its law has that."""
    shell.file("two.toml", SOURCES)
    run = shell("check", "two.toml")
    assert run.code == 2
    assert "HB-C101" in run.err and "differ by -1" in run.err
    assert "fine" not in run.out


def test_check_explains_a_conflict(shell: Any) -> None:
    shell.file("conflict.toml", CONFLICT)
    done = shell("check", "conflict.toml")
    assert done.code == 2
    assert done.err.startswith("HB-C101")
    assert "V -> node" in done.err and "W -> node" in done.err


def test_draw_writes_beside_you_unless_told(shell: Any) -> None:
    (shell.folder / "models").mkdir()
    (shell.folder / "ball.toml").rename(shell.folder / "models" / "ball.toml")
    assert shell("draw", "models/ball.toml").out == "ball.svg\n"
    away = (shell.folder / "ball.svg").read_text(encoding="utf-8")
    assert away.startswith("<svg")
    shell("draw", "models/ball.toml", "--mode", "impact=hits", "--out", "hits.svg", "--numbers")
    assert (shell.folder / "hits.svg").read_text(encoding="utf-8") != away


def test_explain_lists_impulses_and_energy(shell: Any) -> None:
    done = shell("explain", "ball.toml")
    assert done.code == 0
    assert "impulse    contact.e = 15 N·s δ" in done.out
    assert "50 J before, 12.5 J after" in done.out and "lost 37.5 J" in done.out


def test_explain_at_shows_the_nearest_event(shell: Any) -> None:
    done = shell("explain", "charger.toml", "--at", "0.2 s")
    table = done.out.split("\n\n")[1]
    assert table.startswith("t = 0.192751231 s  guard")
    assert table.count("guard") == 1


def test_explain_reports_the_cycle_of_a_run_that_cannot_advance(shell: Any) -> None:
    done = shell("explain", "no_mode.toml")
    assert done.code == 3
    assert "The run stopped: HB-N401" in done.out
    assert "(a) -> (b)" in " ".join(done.out.split())
    assert done.err.startswith("HB-N401")


@pytest.mark.parametrize("name", ["start.toml", "start.json"])
def test_new_makes_a_model_that_runs(shell: Any, name: str) -> None:
    assert shell("new", name).code == 0
    assert shell("check", name).code == 0
    assert shell("run", name).code == 0
    before = (shell.folder / name).read_bytes()
    assert shell("new", name).code == 1
    assert (shell.folder / name).read_bytes() == before
    assert shell("new", name, "--from", "bouncing_ball", "--force").code == 0
    assert (shell.folder / name).read_bytes() != before
    assert "did you mean 'bouncing_ball'" in shell("new", "x.toml", "--from", "bouncing_bal").err


def test_convert_there_and_back_means_the_same(shell: Any) -> None:
    assert shell("convert", "ball.toml", "there.json").code == 0
    assert shell("convert", "there.json", "back.toml").code == 0
    first, last = (hb.load(shell.folder / f).flatten() for f in ("ball.toml", "back.toml"))
    assert (first.nodes, first.machines) == (last.nodes, last.machines)
    assert shell("convert", "ball.toml", "back.toml").code == 1
    assert shell("convert", "ball.toml", "back.toml", "--force").code == 0


def test_demo_shows_a_picture_and_a_plot(shell: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("hybond.cli.demo.examples_folder", lambda: shell.folder)
    shell.file("bouncing_ball.toml", (shell.folder / "ball.toml").read_text(encoding="utf-8"))
    done = shell("demo")
    assert done.code == 0, done.err
    made = {f.name for f in (shell.folder / "hybond-demo").iterdir()}
    assert made == {"bouncing_ball.svg", "bouncing_ball.png", "bouncing_ball.txt"}
    assert "hybond-demo" in done.out and "t = 0 s" in done.out


@pytest.mark.slow
def test_demo_of_a_folder_says_what_failed(shell: Any) -> None:
    shell.file("_part.toml", "not a model")
    done = shell("demo", "--examples", ".", "--out", "out")
    assert done.code == 3
    lines = done.out.splitlines()
    assert [line.split()[0] for line in lines[:-1]] == ["ball", "charger", "no_mode", "spring"]
    assert "FAILED: HB-N401" in lines[2]
    assert "follow each other" in (shell.folder / "out" / "no_mode.txt").read_text("utf-8")
    (shell.folder / "no_mode.toml").rename(shell.folder / "diode_inductor_no_mode.toml")
    done = shell("demo", "--examples", ".", "--out", "out")
    assert done.code == 0 and "HB-N401 as expected" in done.out
    (shell.folder / "spring.toml").rename(shell.folder / "falling_rod_threshold.toml")
    assert shell("demo", "--examples", ".", "--out", "out").code == 3  # it should have failed


def test_expected_failures_are_examples() -> None:
    assert set(EXPECTED) <= {f.stem for f in models_in(examples_folder())}
