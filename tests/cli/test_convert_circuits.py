"""convert: netlists and files of BondGraphTools to model files."""

import json
from typing import Any

import pytest

import hybond as hb

NETLIST = """\
Half-wave rectifier
V1 in 0 SIN(0 10 50)
D1 in out DX ; a comment
R1 out 0 50
C1 out 0 100u
.model DX D(IS=1e-14 RS=0.1)
.tran 0.1m 40m uic
.end
"""
GRAPH = """\
version: '0.1'
root: rc
models:
  /:
    components:
    - V base/Se e=5
    - R base/R r=2
    - C base/C C=0.1
    - i base/1
    netlist:
    - V i.non_inverting
    - i.inverting R
    - i.inverting C
"""


@pytest.mark.parametrize("suffix", ["cir", "net", "sp", "CKT", "spice"])
def test_a_netlist_becomes_a_commented_model(shell: Any, suffix: str) -> None:
    shell.file(f"rectifier.{suffix}", NETLIST)
    done = shell("convert", f"rectifier.{suffix}", "made.toml")
    assert done.code == 0
    assert f"warning: rectifier.{suffix}:6: DX: ideal diode" in done.err
    text = (shell.folder / "made.toml").read_text(encoding="utf-8")
    assert "# line 4: R1 out 0 50" in text
    assert shell("run", "made.toml").code == 0
    model = hb.load(shell.folder / "made.toml")
    wanted = hb.read_circuit(shell.folder / f"rectifier.{suffix}").model
    assert (model.elements, model.bonds) == (wanted.elements, wanted.bonds)


def test_strict_refuses_what_would_be_a_warning(shell: Any) -> None:
    shell.file("rectifier.cir", NETLIST)
    done = shell("convert", "rectifier.cir", "made.toml", "--strict")
    assert done.code == 2
    assert done.err.startswith("HB-F145 at rectifier.cir:6")
    assert not (shell.folder / "made.toml").exists()


def test_the_current_of_diodes_is_an_option(shell: Any) -> None:
    shell.file("rectifier.cir", NETLIST)
    assert shell("convert", "rectifier.cir", "a.json").code == 0
    done = shell("convert", "rectifier.cir", "b.json", "--diode-current", "10 mA")
    assert done.code == 0
    drops = [
        json.loads((shell.folder / name).read_text())["elements"]["D1_drop"]["Se"]
        for name in ("a.json", "b.json")
    ]
    assert drops[0] != drops[1]
    assert shell("convert", "rectifier.cir", "c.json", "--diode-current", "much").code == 1


def test_what_is_there_is_not_replaced(shell: Any) -> None:
    shell.file("rectifier.cir", NETLIST)
    shell.file("made.toml", "mine = 1\n")
    assert shell("convert", "rectifier.cir", "made.toml").code == 1
    assert shell("convert", "rectifier.cir", "made.toml", "--force").code == 2
    assert (shell.folder / "made.toml").read_text() == "mine = 1\n"


def test_options_of_netlists_are_not_for_models(shell: Any) -> None:
    assert shell("convert", "ball.toml", "made.json", "--strict").code == 1


def test_a_netlist_is_no_target(shell: Any) -> None:
    assert shell("convert", "ball.toml", "made.cir").code == 1


def test_a_file_of_bond_graph_tools(shell: Any) -> None:
    shell.file("rc.bg", GRAPH)
    done = shell("convert", "rc.bg", "made.toml")
    assert (done.code, done.err) == (0, "")
    assert hb.load(shell.folder / "made.toml").bonds == ["V -> i -> R", "i -> C"]


@pytest.mark.parametrize("name", ["a.cir", "a.bg"])
def test_a_file_that_is_not_there(shell: Any, name: str) -> None:
    done = shell("convert", name, "made.toml")
    assert done.code == 2
    assert done.err.startswith("HB-F101")
