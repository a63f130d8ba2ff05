"""hybond fit."""

from typing import Any

import numpy as np
import pytest

TANK = """\
hybond = 1
title = "A capacitor that is discharged"
domain = "electrical"
[parameters]
R = "1 ohm"
[elements]
c = { C = "1 F", e = "2 V" }
r = { R = "R" }
n = { junction = 0 }
[graph]
bonds = ["n -> c", "n -> r"]
[experiment]
until = "6 s"
"""


def test_a_resistor_from_a_file(shell: Any) -> None:
    t = np.linspace(0.1, 6.0, 30)
    noise = np.random.default_rng(2).normal(0.0, 5.0, len(t))
    rows = ["time,c.e [mV]", *(f"{a},{v}" for a, v in zip(t, 2e3 * np.exp(-t / 1.7) + noise))]
    data = shell.file("data.csv", "\n".join(rows))
    words = ("fit", shell.file("tank.toml", TANK), data, "--free", "R", "--log", "R")
    done = shell(*words, "--bounds", "R=0.1..9 ohm", "--plot", "fit.svg")
    assert done.code == 0 and "95 % interval" in done.out and "fit.svg" in done.out
    assert (shell.folder / "fit.svg").read_text().count("<path") > 20
    found = shell(*words, "--set", "R=3 ohm", "--json").json
    assert found["low"][0] < 1.7 < found["high"][0] and found["start"] == [3.0]
    assert found["residual"]["c.e"] == pytest.approx(5e-3, rel=0.3)
    several = shell(words[0], words[1], data, data, "--free", "R", "--json").json
    assert several["measurements"] == 60


def test_words_that_do_not_fit(shell: Any) -> None:
    model, data = shell.file("tank.toml", TANK), shell.file("data.csv", "t,c.e\n1,1\n2,0.5\n")
    for words, code in (
        ((data, "--free", "Q"), "HB-A520"),
        ((data, "--free", "R", "--bounds", "R"), "HB-X101"),
        (("none.csv", "--free", "R"), "HB-A530"),
        ((model, "--free", "R"), "HB-A530"),
        ((data, "--free", "R", "--loss", "cube"), "HB-A532"),
        ((data,), "HB-X101"),
    ):
        done = shell("fit", model, *words)
        assert done.code in (1, 2) and code in done.err


def test_a_fit_that_sees_no_slope_ends_with_three_and_says_why(shell: Any) -> None:
    law = "1 [A/V^0.5]*sign(e)*sqrt(abs(e))*R/(1 ohm)"
    hole = TANK.replace('{ R = "R" }', f'{{ R = {{ f = "{law}" }} }}')
    hole = hole.replace('e = "2 V"', 'e = "0 V"').replace("n = {", 'u = { Sf = "1 A" }\nn = {')
    model = shell.file("tank.toml", hole.replace("bonds = [", 'bonds = ["u -> n", '))
    data = shell.file("data.csv", "t,c.e\n1,1\n2,0.5\n")
    done = shell("fit", model, data, "--free", "R")
    assert done.code == 3 and "a law has no finite slope here" in done.out
    assert "the search did not converge" in done.err
    assert shell("fit", model, data, "--free", "R", "--json").json["converged"] is False
