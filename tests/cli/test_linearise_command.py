"""hybond linearise."""

from typing import Any

import numpy as np
import pytest

CHOPPER = """\
hybond = 1
title = "A lowpass behind pulses"
domain = "electrical"
[parameters]
R = "1 kohm"
[inputs]
gate = { pwm = { period = "50 us", duty = 0.25 } }
u = { constant = "2 V" }
[elements]
V = { Se = "gate*u" }
j = { junction = 1 }
r = { R = "R" }
c = { C = "1 uF" }
[graph]
bonds = ["V -> j -> r", "j -> c"]
[experiment]
until = "1 ms"
"""


def test_at_the_start_at_times_and_at_states(shell: Any) -> None:
    done = shell("linearise", "spring.toml", "--input", "m", "--output", "v.f")
    # v' = -k x / m: of the mass nothing but what is stored, p = 6 N*s, so that dv = -p/m^2 dm
    assert done.code == 0 and "linear in this mode" in done.out
    done = shell("linearise", "spring.toml", "--output", "v.f", "--json", "--at", "0.5, 1 s")
    first, second = done.json["points"]
    assert [first["t"], second["t"]] == [0.5, 1.0]
    # 2 kg on 8 N/m: 2 rad/s
    assert [p for p, _ in first["poles"]] == pytest.approx([0.0, 0.0], abs=1e-12)
    assert [abs(i) for _, i in first["poles"]] == pytest.approx([2.0, 2.0], rel=1e-12)
    assert first["operating"]["v.f"] == pytest.approx(3 * np.cos(1.0), rel=1e-7)
    assert second["operating"]["v.f"] == pytest.approx(3 * np.cos(2.0), rel=1e-7)
    done = shell("linearise", "spring.toml", "--at", "mass.p=4,spring.q=1 mm", "--json")
    assert done.json["points"][0]["operating"]["spring.q"] == pytest.approx(1e-3)


def test_a_parameter_by_name_and_a_setting(shell: Any) -> None:
    words = ("--input", "m", "--output", "v.f", "--json", "--set", "k=18 N/m")
    point = shell("linearise", "spring.toml", *words).json["points"][0]
    # v = p/m with p = 6 N*s: D = -p/m^2
    assert point["D"] == [[pytest.approx(-6.0 / 4.0, rel=1e-12)]]
    assert [abs(i) for _, i in point["poles"]] == pytest.approx([3.0, 3.0], rel=1e-12)


@pytest.mark.slow
def test_plots_of_each_kind(shell: Any) -> None:
    for kind in ("bode", "nyquist", "step", "poles"):
        words = ("--input", "u", "--output", "c.e", "--plot", f"{kind}.svg", "--kind", kind)
        done = shell("linearise", shell.file("chopper.toml", CHOPPER), *words)
        assert done.code == 0 and f"{kind}.svg" in done.out
        assert (shell.folder / f"{kind}.svg").read_text().count("<path") > 10


def test_a_sine_is_injected(shell: Any) -> None:
    file = shell.file("chopper.toml", CHOPPER)
    words = ("--inject", "--input", "u", "--output", "c.e", "--frequencies", "200..2kHz:2")
    done = shell("linearise", file, *words, "--json", "--plot", "r.svg")
    assert done.code == 0 and done.json["settled"] == [True, True]
    f = np.array(done.json["frequencies"])
    found = np.array([a + 1j * b for a, b in done.json["response"]])
    np.testing.assert_allclose(found, 0.25 / (1 + 2j * np.pi * f * 1e-3), rtol=1e-3)
    assert (shell.folder / "r.svg").exists()
    # what has not settled is said, with the exit code of the numerics
    done = shell("linearise", file, *words[:-1], "9 kHz", "--windows", "8")
    assert done.code == 3 and "NOT SETTLED" in done.out and "1 of 1" in done.err


@pytest.mark.parametrize(
    ("words", "code"),
    [
        (("--amplitude", "1"), "HB-X101"),
        (("--inject",), "HB-X101"),
        (("--plot", "x.png", "--kind", "bodo"), "HB-X101"),
        (("--kind", "bode"), "HB-X101"),
        (("--plot", "x.gif"), "HB-X102"),
        (("--at", "soon"), "HB-S106"),
        (("--input", "W"), "HB-A501"),
        (("--at", "5 s", "--mode", "a=b"), "HB-X105"),
    ],
)
def test_refusals(shell: Any, words: tuple[str, ...], code: str) -> None:
    done = shell("linearise", "spring.toml", *words)
    assert done.code in (1, 2) and code in done.err


def test_completion_knows_it(shell: Any) -> None:
    assert "linearise" in shell("completion", "bash").out
