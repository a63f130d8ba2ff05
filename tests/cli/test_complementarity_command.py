"""hybond equations --complementarity."""

import json
from typing import Any

import numpy as np
import pytest

RECTIFIER = """hybond = 1
title = "Rectifier"
[elements]
V  = { Se = "10*sin(314*time/(1 s))" }
d  = { junction = 1, law = "diode" }
rs = { R = 2 }
n  = { junction = 0 }
c  = { C = 0.5 }
sw = { junction = 1 }
r  = { R = 4 }
[graph]
bonds = ["V -> d -> n", "d -> rs", "n -> c", "n -> sw -> r"]
[machines.load]
states = { off = [], on = ["sw"] }
start = "off"
"""


@pytest.fixture
def rectifier(shell: Any) -> Any:
    shell.file("rectifier.toml", RECTIFIER)
    return shell


def test_symbols_numbers_and_matrices(rectifier: Any) -> None:
    done = rectifier("equations", "rectifier.toml", "--complementarity")
    assert done.code == 0
    assert done.out.startswith("Rectifier\n\nc.q' = -c.q/(c.C*rs.R) + V/rs.R + l1/rs.R\n")
    assert "0 <= l1 ⟂ w1 >= 0\n" in done.out and "# with load = off\n" in done.out
    words = ("--mode", "load=on", "--numbers", "--matrices")
    done = rectifier("equations", "rectifier.toml", "--complementarity", *words)
    # 1/(2*0.5) + 1/(4*0.5)
    assert "c.q' = -1.5*c.q + 0.5*V + 0.5*l1\n" in done.out
    assert "\nD\n" in done.out and "# with load = on\n" in done.out


def test_other_forms(rectifier: Any) -> None:
    done = rectifier("equations", "rectifier.toml", "--complementarity", "--latex")
    assert r"0 \le l_{1} \perp w_{1} \ge 0" in done.out
    done = rectifier("equations", "rectifier.toml", "--complementarity", "--markdown")
    assert done.out.startswith("$$\n\\begin{aligned}\n") and "blocked effort of d" in done.out
    done = rectifier("equations", "rectifier.toml", "--complementarity", "--json")
    record = json.loads(done.out)
    assert record["hybond"] == 1 and record["mode"] == {"load": "off"}
    assert record["laws"] == [
        {"junction": "d", "law": "diode", "l": "-d.e", "w": "d.f", "bounded": "both"}
    ]
    np.testing.assert_allclose(record["numbers"]["A"], [[-1.0]])
    assert record["passive"] is True and record["relative degrees"] == [0]


@pytest.mark.parametrize("option", [["--outputs", "c.e"], ["--junctions"], ["--transfer"]])
def test_what_it_does_not_have_is_refused(rectifier: Any, option: list[str]) -> None:
    done = rectifier("equations", "rectifier.toml", "--complementarity", *option)
    assert done.code == 1 and "HB-X101" in done.err


def test_a_model_without_laws(rectifier: Any) -> None:
    elements = "c = { C = 1 }\nr = { R = 1 }"
    text = f"hybond = 1\n[elements]\n{elements}\n[graph]\nbonds = ['c -> r']\n"
    rectifier.file("rc.toml", text)
    done = rectifier("equations", "rc.toml", "--complementarity")
    assert "HB-Q109" in done.err and done.code == 2
