"""Ends, starts and scripts of `hybond run`."""

from __future__ import annotations

import math
from typing import Any

import pytest

RIG = """\
hybond = 1
title  = "Charge and rest"
domain = "electrical"

[parameters]
V = "10 V"

[elements]
U = { Se = "V" }
R = { R = "1 kohm" }
C = { C = "1 mF" }
i = { junction = 1 }

[graph]
bonds = ["U -> i -> R", "i -> C"]

[experiment]
until = "20 s"

[[experiment.script]]
label = "charge"
until = "C.e > 8 V"

[[experiment.script]]
label  = "pulse"
repeat = 2
steps  = [{ lasts = "1 s", set = { V = "0 V" } }, { lasts = "1 s", set = { V = "8 V" } }]
"""


def test_a_run_ends_where_a_condition_holds(shell: Any) -> None:
    shell.file("rig.toml", RIG)
    words = ["run", "rig.toml", "--no-script", "--until", "C.e > 5 V", "--until", "10 s"]
    done = shell(*words)
    assert done.code == 0
    assert "C.e > 5 V holds" in done.out
    run = shell(*words, "--json").json
    assert (run["status"], run["ended_by"]) == ("ok", "C.e > 5 V")
    assert run["t_end"] == pytest.approx(math.log(2.0), abs=1e-9)
    assert run["events"][-1]["cause"] == "until"
    assert shell("run", "rig.toml", "--no-script", "--until", "C.e >").code != 0


def test_the_file_says_the_condition(shell: Any) -> None:
    own = RIG.split("[[experiment.script]]")[0].replace('"20 s"', '["C.e > 5 V", "20 s"]')
    shell.file("own.toml", own)
    run = shell("run", "own.toml", "--json").json
    assert run["t_end"] == pytest.approx(math.log(2.0), abs=1e-9)
    assert shell("explain", "own.toml").out.count("until") >= 1
    assert "HB-E641" in shell("export", "own.toml", "--to", "c", "--out", "own.c").err


def test_a_run_goes_on_from_what_another_has_saved(shell: Any) -> None:
    shell.file("rig.toml", RIG)
    one = ("run", "rig.toml", "--no-script", "--json")
    assert shell(*one, "--until", "1 s", "--save-state", "half.json").code == 0
    run = shell(*one, "--until", "2 s", "--start", "half.json").json
    assert run["events"] == []
    assert run["final"]["C.e"] == pytest.approx(10.0 * (1.0 - math.exp(-2.0)), rel=1e-12)
    assert "HB-S135" in shell("run", "rig.toml", "--no-script", "--start", "no.json").err
    assert "HB-X102" in shell("run", "rig.toml", "--save-state", "half.txt").err


def test_a_file_with_a_script_is_run_by_it(shell: Any) -> None:
    shell.file("rig.toml", RIG)
    done = shell("run", "rig.toml")
    assert done.code == 0, done.err
    assert "start: charge" in done.out and "change: pulse" in done.out
    run = shell("run", "rig.toml", "--json").json
    assert [s["ended_by"] for s in run["script"]] == ["C.e > 8 V"] + ["time"] * 4
    v = 8.0
    for _ in range(2):
        v = 8.0 + (v * math.exp(-1.0) - 8.0) * math.exp(-1.0)
    assert run["final"]["C.e"] == pytest.approx(v, rel=1e-9)
    labels = [e["label"] for e in run["events"] if "label" in e]
    assert labels == ["charge", "pulse", "pulse"]
    assert "HB-S106" in shell("run", "rig.toml", "--until", "C.e > 1 V").err


def test_steps_without_sense_are_told_with_their_place(shell: Any) -> None:
    shell.file("bad.toml", RIG.replace('lasts = "1 s"', 'last = "1 s"', 1))
    said = shell("run", "bad.toml").err
    assert "last" in said
    shell.file("bad.toml", RIG.replace('V = "0 V"', 'W = "0 V"'))
    assert "HB-S141" in shell("run", "bad.toml").err
    shell.file("bad.toml", RIG.replace("C.e > 8 V", "C.u > 8 V"))
    assert "HB-S136 at bad.toml" in shell("check", "bad.toml").err
