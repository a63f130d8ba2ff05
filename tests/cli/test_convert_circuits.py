"""convert: netlists and files of BondGraphTools to model files."""

import json
import math
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


def test_words_of_the_netlist_name_signals(shell: Any) -> None:
    """A half wave of 10 V on 50 ohm behind no diode to speak of: 10 V/pi, and the power of it."""
    half = NETLIST.replace("C1 out 0 100u\n", "").replace("D(IS=1e-14 RS=0.1)", "D(Ron=1u)")
    shell.file("half.cir", half.replace("40m uic", "{T}").replace(".model", ".param T=40m\n.model"))
    done = shell("measure", "half.cir", "mean(V(in,OUT))", "mean(v(out)*i(D1))", "--json")
    measures = json.loads(done.out)["measures"]
    assert list(measures) == ["mean(V(in,OUT))", "mean(v(out)*i(D1))"]  # told as they were asked
    values = [one["value"] for one in measures.values()]
    assert values == pytest.approx([-10 / math.pi, 100 / 50 / 4], rel=1e-4)
    done = shell("run", "half.cir", "--at", "5ms", "--signals", "v(out),i(V1)", "--json")
    samples = json.loads(done.out)["samples"]
    assert [column[0] for name, column in samples.items() if name != "t"][-2:] == pytest.approx(
        [10.0, -0.2], rel=1e-4
    )
    done = shell("sweep", "half.cir", "--vary", "R1.R=50,100", "--signals", "v(out)", "--json")
    assert done.code == 0
    done = shell("measure", "half.cir", "mean(v(nowhere))")
    assert done.code == 2 and done.err.splitlines()[-2].startswith("HB-F134 at mean(v(nowhere))")


@pytest.mark.parametrize("given", ["auto", "D1=300 mA"])
def test_the_current_of_each_diode_is_found_or_said(shell: Any, given: str) -> None:
    shell.file("rectifier.cir", NETLIST)
    noted = shell("run", "rectifier.cir")
    assert "note: D1 carries" in noted.out
    fits = shell("run", "rectifier.cir", "--diode-current", given)
    assert fits.code == 0 and "note: D1 carries" not in fits.out
    assert shell("run", "rectifier.cir", "--diode-current", "D7=1 A").code == 1


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


def test_a_netlist_is_checked_and_exported_as_it_is(shell: Any) -> None:
    shell.file("rectifier.cir", NETLIST)
    done = shell("check", "rectifier.cir")
    assert done.code == 0 and "Half-wave rectifier" in done.out
    done = shell("export", "rectifier.cir", "--to", "python", "--out", "rectifier.py")
    assert done.code == 0 and (shell.folder / "rectifier.py").exists()


STEPPED = """RC, charged for as long as its time constant
.param R=1k T={R*1u}
V1 a 0 1
R1 a b {R}
C1 b 0 1u IC=0
.tran 1u 10m uic
.step param R list 500 1k 2k
.meas tran vt find v(b) at={T}
.meas tran mean avg v(b) from={T} to={2*T}
.meas tran charge param='vt*T/R'
.meas tran events when v(b)=0.5
.meas tran never when v(b)=2
.end
"""


def test_measurements_are_columns_of_a_sweep_and_follow_its_parameters(shell: Any) -> None:
    """Each at its own time constant: 1 - 1/e, whatever R is; the table is not that of the ends."""
    shell.file("rc.cir", STEPPED)
    record = shell("sweep", "rc.cir", "--json").json
    assert set(record["final"]) == {"C1.q", "C1.e"} == set(record["units"])
    found = record["measurements"]
    assert found["vt"] == pytest.approx(3 * [1 - math.exp(-1)], rel=1e-6)
    assert found["mean"] == pytest.approx(3 * [1 - math.exp(-1) + math.exp(-2)], rel=1e-6)
    assert found["charge"] == pytest.approx(3 * [1e-6 * (1 - math.exp(-1))], rel=1e-6)
    assert found["meas_events"] == pytest.approx([r * 1e-6 * math.log(2) for r in (500, 1e3, 2e3)])
    assert found["never"] == [None, None, None]
    done = shell("sweep", "rc.cir", "--out", "table.csv")
    assert done.out.splitlines()[2].split()[-5:] == ["vt", "mean", "charge", "meas_events", "never"]
    head = (shell.folder / "table.csv").read_text().splitlines()[0]
    assert head == "member,R,status,t_end,events,C1.q,C1.e,vt,mean,charge,meas_events,never"
    # a run with another value, too, and what is measured is no final value
    record = shell("run", "rc.cir", "--set", "R=2000", "--json").json
    assert record["measurements"]["vt"] == pytest.approx(1 - math.exp(-1), rel=1e-6)
    assert set(record["final"]) == {"C1.q", "C1.e"}
