"""hybond causality: the table, the object of --json, what is ahead, advice, diagnosis."""

from pathlib import Path
from typing import Any

import pytest

import hybond as hb
from hybond.causality.report import CausalityReport

EXAMPLES = Path(__file__).parents[2] / "examples"

CLUTCH = """\
hybond = 1
title = "Two inertias"
domain = "rotational"
[elements]
rotor = { I = "10 kg*m^2", f = "1 rad/s" }
drag = { R = "0.1 N*m*s" }
load = { I = "1 kg*m^2" }
fan = { R = "5 N*m*s" }
w1 = { junction = 1 }
w2 = { junction = 1 }
grip = { junction = 0 }
[graph]
bonds = ["w1 -> rotor", "w1 -> drag", "w1 -> grip -> w2", "w2 -> load", "w2 -> fan"]
[machines.clutch]
states = { open = [], closed = ["grip"] }
start = "open"
rules = ["open -> closed when time >= 1 s"]
"""

BUCK = """\
hybond = 1
domain = "electrical"
[elements]
V = { Se = "12 V" }
ground = { Se = "0 V" }
sw = { junction = 1 }
diode = { junction = 1 }
x = { junction = 0 }
i = { junction = 1 }
L = { I = "1 mH" }
out = { junction = 0 }
C = { C = "100 uF" }
load = { R = "10 ohm" }
[graph]
bonds = [
  "V -> sw -> x", "ground -> diode -> x", "x -> i -> out", "i -> L", "out -> C", "out -> load",
]
[machines.S]
states = { on = ["sw"], off = [] }
start = "on"
rules = ["on -> off when time >= 1 ms", "off -> on when time >= 2 ms"]
[machines.D]
states = { blocks = [], conducts = ["diode"] }
start = "blocks"
rules = ["blocks -> conducts when diode.e > 0", "conducts -> blocks when diode.f < 0"]
"""


def bonds(record: dict[str, Any]) -> dict[str, dict[str, Any]]:
    return {bond["name"]: bond for bond in record["bonds"]}


def test_the_clutch_says_which_strokes_follow_it(shell: Any) -> None:
    shell.file("clutch.toml", CLUTCH)
    done = shell("causality", "clutch.toml")
    assert done.code == 0, done.err
    assert done.out.startswith("Two inertias\n  reference mode (open), ")
    assert "2 of 2 stored quantities in integral causality" in done.out
    assert "dynamic through grip" in done.out
    assert "by the mode: " in done.out and "derivative causality" not in done.out
    closed = shell("causality", "clutch.toml", "--mode", "clutch=closed")
    assert "shown: mode (closed)" in closed.out
    assert "derivative causality: " in closed.out


def test_the_object_of_json_says_the_same(shell: Any) -> None:
    shell.file("clutch.toml", CLUTCH)
    record = shell("causality", "clutch.toml", "--mode", "clutch=closed", "--json").json
    assert (record["hybond"], record["mode"]) == (1, {"clutch": "closed"})
    assert record["reference"]["mode"] == {"clutch": "open"}
    assert (record["reference"]["integral"], record["reference"]["storages"]) == (2, 2)
    assert len(record["derivative"]) == 1 and record["conflicts"] == []
    found = bonds(record)
    dynamic = {name for name, bond in found.items() if bond["kind"] == "dynamic"}
    assert dynamic and all(found[name]["through"] == ["grip"] for name in dynamic)
    # Textbook: one inertia keeps its stroke, the other's turns, with the bond that carries it.
    late = record["derivative"][0].removesuffix(".p")
    assert found[f"{'w1' if late == 'rotor' else 'w2'} -> {late}"]["kind"] == "dynamic"
    assert record["ahead"] == {"modes": 2, "complete": True, "without_causality": 0, "causes": []}


def test_the_buck_converter_knows_its_conflict_ahead(shell: Any) -> None:
    shell.file("buck.toml", BUCK)
    for verb in ("causality", "check"):
        done = shell(verb, "buck.toml")
        assert done.code == 0, done.err
        assert "conflicts ahead: 1 of 4 reachable modes has no causality" in done.out
        assert "switches: S = on, D = conducts." in done.out
    record = shell("causality", "buck.toml", "--json").json
    (cause,) = record["ahead"]["causes"]
    assert cause["switches"] == {"sw": True, "diode": True}
    assert (cause["modes"], cause["mode"]) == (1, {"S": "on", "D": "conducts"})
    # Both open: nothing gives the coil its current, which is zero then.
    both = shell("causality", "buck.toml", "--mode", "S=off,D=blocks", "--json").json
    assert both["derivative"] == ["L.p"]
    through = bonds(record)["i -> L"]["through"]
    assert set(through) <= {"sw", "diode"}


def test_a_mode_without_causality_has_exit_code_2(shell: Any) -> None:
    shell.file("buck.toml", BUCK)
    done = shell("causality", "buck.toml", "--mode", "D=conducts")
    assert done.code == 2
    assert "conflict: Se " in done.out
    assert shell("causality", "buck.toml", "--mode", "D=conducts", "--json").json["conflicts"]


BRIDGE = """\
hybond = 1
domain = "electrical"
[elements]
V = { Se = "5 V" }
src = { junction = 1 }
a = { junction = 0 }
b = { junction = 0 }
p = { junction = 0 }
d1 = { junction = 1 }
d2 = { junction = 1 }
d3 = { junction = 1 }
d4 = { junction = 1 }
c = { C = "1 mF" }
load = { R = "10 ohm" }
[graph]
bonds = [
  "V -> src -> a", "b -> src", "a -> d1 -> p", "b -> d2 -> p", "d3 -> a", "d4 -> b",
  "p -> c", "p -> load",
]
"""


def test_the_diode_bridge_names_the_pairs_that_short_its_source(shell: Any) -> None:
    text = BRIDGE
    for d in ("d1", "d2", "d3", "d4"):
        text += (
            f'[machines.{d}_]\nstates = {{ blocks = [], conducts = ["{d}"] }}\nstart = "blocks"\n'
        )
        text += (
            f'rules = ["blocks -> conducts when {d}.e > 0", "conducts -> blocks when {d}.f < 0"]\n'
        )
    shell.file("bridge.toml", text)
    # By hand: d1 with d2 shorts the source, so does d3 with d4; with none the source floats.
    # One pair across puts it on the capacitor, one leg shorts the capacitor: no conflict.
    record = shell("causality", "bridge.toml", "--mode", "d1_=conducts,d4_=conducts", "--json").json
    assert (record["conflicts"], record["derivative"]) == ([], ["c.q"])
    leg = shell("causality", "bridge.toml", "--mode", "d1_=conducts,d3_=conducts", "--json").json
    assert (leg["conflicts"], leg["derivative"]) == ([], ["c.q"])
    one = shell("causality", "bridge.toml", "--mode", "d2_=conducts", "--json").json
    assert (one["conflicts"], one["derivative"]) == ([], [])
    ahead = record["ahead"]
    # d1 and d2 alone close a ring of junctions, which has strokes but no solution: the seven
    # others of the eight modes are seen by causality.
    assert (ahead["modes"], ahead["complete"], ahead["without_causality"]) == (16, True, 7)
    causes = {frozenset(c["switches"].items()): c["modes"] for c in ahead["causes"]}
    assert causes[frozenset((d, False) for d in ("d1", "d2", "d3", "d4"))] == 1
    assert causes[frozenset({("d3", True), ("d4", True)})] == 4
    assert all({("d1", True), ("d2", True)} <= on for on in causes if len(on) == 3)
    assert len(causes) == 4


def test_diagnostic_and_advice_are_said_and_recorded(shell: Any) -> None:
    shell.file("clutch.toml", CLUTCH)
    done = shell("causality", "clutch.toml", "--diagnostic", "--advice")
    assert "diagnostic causality: none" in done.out
    assert "grip: not absorbed: neither a resistor nor an effort source" in done.out
    assert 'connect it to 0-junction grip, as in "grip -> r1"' in done.out
    record = shell("causality", "clutch.toml", "--diagnostic", "--advice", "--json").json
    assert record["diagnostic"]["exists"] is False
    (advice,) = record["advice"]
    (resistor,) = advice["resistors"]
    # 10 and 1 kg m² on one resistor: R C with the reduced inertia 10/11.
    assert 1 / resistor["gain"] == pytest.approx(10 / 11)
    circuit = str(EXAMPLES / "diagnosis_circuit.toml")
    done = shell("causality", circuit, "--diagnostic", "--sensors", "n1.e,n2", "--advice")
    assert "diagnostic causality: one for all modes\n  a1: absorbed by R2\n" in done.out
    assert "advice: no change of strokes reaches storage or another switch" in done.out
    refused = shell("causality", circuit, "--diagnostic", "--sensors", "n7")
    assert (refused.code, refused.err[:7]) == (1, "HB-X108")


def test_why_gives_the_chain_of_one_bond(shell: Any) -> None:
    shell.file("clutch.toml", CLUTCH)
    done = shell("causality", "clutch.toml", "--why", "w1 -> drag")
    assert done.out.splitlines()[1:] == [
        "'w1 -> rotor': preferred by I:rotor",
        "'w1 -> drag': propagated from 1:w1",
    ]
    refused = shell("causality", "clutch.toml", "--why", "w1 -> drug")
    assert (refused.code, "did you mean 'w1 -> drag'" in refused.err) == (1, True)


def test_a_big_model_lists_what_changes_unless_all_is_asked_for(shell: Any) -> None:
    chains = '"V -> sw -> n", "sw -> r", "n -> c"'
    elements = "V = { Se = 1 }\nsw = { junction = 1 }\nn = { junction = 0 }\nr = { R = 1 }\n"
    elements += "c = { C = 1 }\n"
    for k in range(70):
        elements += f"r{k} = {{ R = 1 }}\n"
        chains += f', "n -> r{k}"'
    text = f"hybond = 1\n[elements]\n{elements}[graph]\nbonds = [{chains}]\n[machines.S]\n"
    text += 'states = { on = ["sw"], off = [] }\nstart = "on"\n'
    shell.file("big.toml", text)
    short = shell("causality", "big.toml").out
    assert "sw -> r " in short and "n -> r5 " not in short
    assert "n -> r5 " in shell("causality", "big.toml", "--all").out
    assert len(shell("causality", "big.toml", "--json").json["bonds"]) == 74


def test_a_wrong_mode_is_refused_as_text_and_as_object(shell: Any) -> None:
    shell.file("clutch.toml", CLUTCH)
    done = shell("causality", "clutch.toml", "--mode", "clutch=clsoed", "--json")
    assert done.code == 1 and "did you mean 'closed'" in done.err
    assert done.json["error"]["code"] == "HB-X105"


def test_python_gives_the_report_and_shows_it(shell: Any) -> None:
    model = hb.loads(CLUTCH)
    model.draw()  # what draws has imported the room of the same name before
    report = hb.causality(model, {"clutch": "closed"})
    assert isinstance(report, CausalityReport)
    assert str(report) == repr(report) and "dynamic through grip" in str(report)
    assert report._repr_svg_().startswith("<svg")
    assert report.derivative and not report.conflicts and report.loops == ()
    assert hb.causality(model.flatten(), (1,)).derivative == report.derivative
    assert report.why("w1 -> drag")[-1] == "'w1 -> drag': propagated from 1:w1"
    with pytest.raises(hb.ModelError, match="HB-M144"):
        hb.causality(model, {"clutch": "shut"})
