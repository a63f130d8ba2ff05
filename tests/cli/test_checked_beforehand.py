"""What `hybond check` refuses before a run does: what scripts set, what measurements ask for."""

import json
from typing import Any

import pytest

import hybond.cli.running as running
from hybond.engine.outcome.unsound import unsound_refusal
from hybond.runs.trace import Violation

RC = """\
hybond = 1
domain = "electrical"
[parameters]
R = "1 kohm"
[elements]
V = { Se = "10 V" }
v = { junction = 1 }
r = { R = "R" }
C = { C = "1 uF" }
[graph]
bonds = [@BONDS@]
[experiment]
until = "5 ms"
"""
STRAIGHT, TURNED = '"V -> v -> r", "v -> C"', '"V -> v", "r -> v -> C"'

SCRIPT = """\
[[experiment.script]]
repeat = 2
steps = [
  { lasts = "1 ms", set = { R = "3 kohm" } },
  { lasts = "1 ms", set = { @SET@ } },
]
"""


@pytest.mark.parametrize("bonds", [STRAIGHT, TURNED])
@pytest.mark.parametrize(
    "given, why, line",
    [
        ('Rr = "2 kohm"', "no parameter 'Rr'", 15),
        ('R = "2 V"', "wants ohm", 15),
        ('"C.e" = "2 V"', "where the model starts", 15),
    ],
)
def test_what_a_step_of_a_script_cannot_set_is_refused_by_check(
    shell: Any, bonds: str, given: str, why: str, line: int
) -> None:
    """It was fine there, and refused by the run, which did not say in which line."""
    text = RC.replace("@BONDS@", bonds) + SCRIPT.replace("@SET@", given)
    shell.file("rc.toml", text)
    for verb in ("check", "run"):
        done = shell(verb, "rc.toml")
        assert done.code == 1
        assert "HB-S141" in done.err and why in done.err and "script[0].steps[1].set" in done.err
    assert shell("check", "rc.toml", "--json").json["error"]["code"] == "HB-S141"


def test_a_script_that_can_be_done_is_fine(shell: Any) -> None:
    text = RC.replace("@BONDS@", STRAIGHT)
    shell.file("rc.toml", text + SCRIPT.replace("@SET@", 'R = "2 kohm"'))
    assert shell("check", "rc.toml").code == 0
    shell.file(
        "rc.toml",
        text.replace('until = "5 ms"\n', "") + '[[experiment.script]]\nuntil = "C.e > 3"\n',
    )
    done = shell("check", "rc.toml")
    assert done.code == 1 and "HB-S132" in done.err and "script[0]" in done.err


@pytest.mark.parametrize(
    "text, code, why",
    [
        ("mean(C.e, start=3 m)", "HB-R101", "'3 m' is not a time"),
        ("mean(C.e, start=2 ms, end=1 ms)", "HB-R101", "from 0.002 to 0.001 s"),
        ("rms(C.e, period=2 V)", "HB-R101", "'2 V' is not a time"),
        ("rms(C.e, period=1 ms, periods=1.5)", "HB-R101", "periods = 1.5"),
        ("thd(C.e, 50 V)", "HB-R101", "'50 V' is not a frequency"),
        ("frequency(C.e, level=5 m)", "HB-R101", "'5 m' is not a value of C.e"),
        ("rise_time(C.e, final=3 A)", "HB-R101", "'3 A' is not a value of C.e"),
        ("period(C.e, 3 V, edge=up)", "HB-R101", "edge = 'up'"),
        ("at(C.e, 6 ms)", "HB-R102", "not to 0.006 s"),
        ("max(C.e, start=9)", "HB-R102", "from 9 s"),
    ],
)
def test_a_measurement_that_no_run_can_give_is_refused_by_check(
    shell: Any, text: str, code: str, why: str
) -> None:
    shell.file("rc.toml", RC.replace("@BONDS@", STRAIGHT) + f'measure = ["mean(C.e)", "{text}"]\n')
    done = shell("check", "rc.toml")
    assert done.code == 2 and code in done.err and why in done.err
    assert "rc.toml:14" in done.err and "measure[1]" in done.err


def test_a_measurement_that_a_run_can_give_is_fine(shell: Any) -> None:
    asked = '"at(C.e, 5 ms)", "rms(C.e, period=1 kHz, periods=2)", "frequency(C.e, 3 V)"'
    shell.file("rc.toml", RC.replace("@BONDS@", TURNED) + f"measure = [{asked}]\n")
    assert shell("check", "rc.toml").code == 0


def test_a_level_is_refused_before_the_run_that_is_measured(shell: Any, monkeypatch: Any) -> None:
    shell.file("rc.toml", RC.replace("@BONDS@", STRAIGHT))
    monkeypatch.setattr(running, "simulate_with", None)  # nothing runs
    done = shell("measure", "rc.toml", "mean(C.e)", "frequency(C.e, level=5 A)")
    assert done.code == 1 and "HB-R101 at frequency(C.e, level=5 A)" in done.err


def test_measurements_of_a_run_whose_laws_do_not_hold_say_so_beside_them(
    shell: Any, monkeypatch: Any
) -> None:
    """A table that is kept without what went to stderr looked like that of a sound run."""
    shell.file("rc.toml", RC.replace("@BONDS@", STRAIGHT))
    simulate = running.simulate_with

    def unsound(*args: Any, **options: Any) -> Any:
        run = simulate(*args, **options)
        run.trace.unsound.append(Violation(0.002, "r", 1.0, 2.0, "R 1 kohm", ""))
        run.status, run.error = "unsound", unsound_refusal(run.trace.unsound, run.t_end)
        return run

    assert "laws" not in shell("measure", "rc.toml", "mean(C.e)").out
    monkeypatch.setattr(running, "simulate_with", unsound)
    done = shell("measure", "rc.toml", "mean(C.e)")
    assert done.code == 3 and "laws do not hold from 0.002 s on, of 5 ms" in done.out


def test_a_script_of_python_is_not_run_by_opening_it(shell: Any) -> None:
    shell.file("rc.py", "raise SystemExit(9)\n")
    done = shell("check", "rc.py")
    assert done.code == 2 and "HB-F102" in done.err and 'hb.save(model, "rc.toml")' in done.err


TWO = """
hybond = 1
domain = "electrical"
[elements]
U = { Se = "5 [V]*tanh(10*inp.e/(1 [V]))" }
r2 = { R = "10 kohm" }
r3 = { R = "10 kohm" }
top = { junction = 1 }
inp = { junction = 0 }
[graph]
bonds = ["U -> top -> r2", "top -> inp -> r3"]
[experiment]
until = "1 s"
"""


def test_who_only_measured_was_told_no_warning(shell: Any) -> None:
    shell.file("two.toml", TWO)
    done = shell("measure", "two.toml", "final(inp.e)")
    assert done.code == 0 and "warning: HB-N416" in done.err
    found = json.loads(shell("measure", "two.toml", "final(inp.e)", "--json").out)
    assert any("HB-N416" in text for text in found["warnings"])
