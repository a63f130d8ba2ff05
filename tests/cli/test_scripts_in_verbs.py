"""What verbs do with the script of a file, and what check says of one that cannot be done."""

from __future__ import annotations

import math
import re
from typing import Any

import pytest

RC = """\
hybond = 1
domain = "electrical"
[parameters]
V = "10 V"
[elements]
U = { Se = "V" }
r = { R = "1 kohm" }
C = { C = "1 mF" }
v = { junction = 1 }
[graph]
bonds = ["U -> v -> r", "v -> C"]
[experiment]
until = "4 s"
"""
SCRIPT = """\
[[experiment.script]]
label = "charge"
lasts = "1 s"
[[experiment.script]]
label = "empty"
lasts = "2 s"
set = { V = "0 V" }
"""
LEFT = 10.0 * (1.0 - math.exp(-1.0)) * math.exp(-2.0)


@pytest.mark.parametrize(
    "verb", [("run",), ("measure", "final(C.e)"), ("explain",), ("measure", "--losses")]
)
def test_run_and_measure_and_explain_do_the_script_alike(shell: Any, verb: tuple[str, ...]) -> None:
    """`run` measured at the end of the script, and `measure` without it, and did not say so."""
    file = shell.file("rc.toml", RC + 'measure = ["final(C.e)"]\n' + SCRIPT)
    done = shell(verb[0], file, *verb[1:], "--rtol", "1e-10")
    whole = shell(verb[0], file, *verb[1:], "--rtol", "1e-10", "--no-script")
    assert done.code == whole.code == 0
    if verb[0] == "explain":
        assert "t = 3 s  the end" in done.out and "t = 4 s  the end" in whole.out
        assert "empty" in done.out and "empty" not in whole.out
    elif verb[1:] == ("--losses",):
        # what is left in the capacitor, of its own: C e^2/2
        assert "t = 0 s to 3 s" in done.out and "t = 0 s to 4 s" in whole.out
    else:
        end = 10.0 * (1.0 - math.exp(-4.0))
        for out, value in ((done.out, LEFT), (whole.out, end)):
            found = re.search(r"final\(C\.e\) = ([\d.]+) (m?)V", out)
            assert found is not None
            scale = 1e-3 if found[2] else 1.0
            assert float(found[1]) * scale == pytest.approx(value, rel=1e-5)


@pytest.mark.parametrize(
    "first, second, why",
    [
        ('until = "2 s"', 'until = "1 s"', "step 2 begins at 2 s and ends at 1 s"),
        ('until = "2 s"', 'until = ["C.e > 3 V", "1 s"]', "step 2 begins at 2 s and ends at 1 s"),
        ('lasts = "1 s"', 'until = "500 ms"', "step 2 begins at 1 s and ends at 0.5 s"),
        ('lasts = "1 s"', 'until = "1 s"', "step 2 begins at 1 s and ends at 1 s"),
        (
            'until = ["C.e > 3 V", "2 s"]',
            'lasts = "1 s"\n[[experiment.script]]\nuntil = "1 s"',
            "step 3 begins at 1 s or later and ends at 1 s",
        ),
    ],
)
def test_a_step_that_ends_before_it_begins_is_refused_by_check(
    shell: Any, first: str, second: str, why: str
) -> None:
    """It was fine there, and refused by the run when it came to it."""
    steps = f"[[experiment.script]]\n{first}\n[[experiment.script]]\n{second}\n"
    file = shell.file("rc.toml", RC + steps)
    line = len((RC + steps).splitlines())
    for verb in ("check", "run"):
        done = shell(verb, file)
        assert done.code == 1 and "HB-S140" in done.err and why in done.err
        assert f"rc.toml:{line}" in done.err


def test_a_step_that_may_begin_in_time_is_no_mistake(shell: Any) -> None:
    steps = '[[experiment.script]]\nuntil = ["C.e > 3 V", "2 s"]\n'
    steps += '[[experiment.script]]\nuntil = "1 s"\n'
    file = shell.file("rc.toml", RC + steps)
    assert shell("check", file).code == 0 and shell("run", file).code == 0


def test_the_until_of_the_experiment_ends_a_script_of_steps_with_times(shell: Any) -> None:
    """The pages said so; the script went on."""
    file = shell.file("rc.toml", RC.replace('"4 s"', '"2 s"') + SCRIPT)
    done = shell("run", file)
    assert "t = 2 s  the end" in done.out
    done = shell("run", file, "--until", "500 ms")
    assert "t = 0.5 s  the end" in done.out
    assert "the script stopped in step 1 of 2 (charge): it has until t = 0.5 s" in done.out


FORCED = {"export": ("--force",)}


@pytest.mark.parametrize(
    "words",
    [
        ("linearise", "--at", "1 s"),
        ("sweep", "--vary", "r.R=1k,2k"),
        ("sweep", "--vary", "r.R=1k,2k", "--collect", "final(C.e)"),
        ("export", "--to", "modelica", "--out", "rc.mo"),
    ],
)
def test_commands_that_do_no_script_say_so(shell: Any, words: tuple[str, ...]) -> None:
    said = "without the script of the file, which `hybond run` does"
    done = shell(words[0], shell.file("rc.toml", RC + SCRIPT), *words[1:])
    assert done.code == 0 and said in done.err
    done = shell(words[0], shell.file("plain.toml", RC), *words[1:], *FORCED.get(words[0], ()))
    assert done.code == 0 and said not in done.err


@pytest.mark.parametrize("last", ['lasts = "5 s"', 'until = "6 s"', 'until = ["C.e < 0 V", "6 s"]'])
def test_a_last_step_that_is_cut_short_is_told(shell: Any, last: str) -> None:
    steps = f'[[experiment.script]]\nlasts = "1 s"\n[[experiment.script]]\n{last}\n'
    done = shell("run", shell.file("rc.toml", RC + steps))
    assert "the script stopped in step 2 of 2" in done.out and "t = 4 s" in done.out
    done = shell("run", shell.file("rc.toml", RC.replace('"4 s"', '"6 s"') + steps))
    assert "warning" not in done.out


@pytest.mark.parametrize("script", ["", SCRIPT])
@pytest.mark.parametrize(
    "text, fits",
    [
        ("mean(C.e, period=5000 s)", False),
        ("mean(C.e, period=2 s, periods=3)", False),
        ("rms(C.e, start=3.5 s, period=1 s)", False),
        ("rms(C.e, end=500 ms, period=1 Hz)", False),
        ("mean(C.e, period=1 s, periods=3)", True),
        ("rms(C.e, start=1 s, period=500 ms, periods=2)", True),
        ("rms(C.e, end=1 s, period=1 Hz)", True),
    ],
)
def test_windows_that_are_longer_than_the_run_are_refused_by_check(
    shell: Any, script: str, text: str, fits: bool
) -> None:
    file = shell.file("rc.toml", RC + f'measure = ["{text}"]\n' + script)
    done = shell("check", file)
    assert done.code == (0 if fits else 2)
    if not fits:
        assert "HB-R102 at" in done.err and "rc.toml:14: experiment.measure[0]" in done.err
    # as the run itself has it
    assert ("nothing" in shell("run", file).out) is not fits


MACHINE = """\
[machines.jets]
states = { fill = ["v"], dump = [] }
start = "fill"
rules = ["fill -> dump when C.e > 50 V"]
"""


@pytest.mark.parametrize("path, value", [("jets", "dump"), ("jets.start", "dump"), ("jets", "fil")])
def test_a_step_that_sets_a_machine_is_told_what_would_work(
    shell: Any, path: str, value: str
) -> None:
    """`jets` was told `jets.start`, which was refused in its turn."""
    steps = '[[experiment.script]]\nlasts = "1 s"\n[[experiment.script]]\nlasts = "1 s"\n'
    head, experiment = RC.split("[experiment]")
    text = f"{head}{MACHINE}[experiment]{experiment}{steps}"
    file = shell.file("rc.toml", f'{text}set = {{ "{path}" = "{value}" }}\n')
    done = shell("check", file)
    assert (
        done.code == 1
        and "HB-S141" in done.err
        and f"rc.toml:{len(text.splitlines()) + 1}" in done.err
    )
    assert "jets is a machine, which changes its state by its own rules" in done.err
    # as the remedy says
    assert "go = 0, in a rule 'fill -> dump when go > 0.5', and set go = 1" in done.err
    mended = text.replace("[parameters]", "[parameters]\ngo = 0")
    mended = mended.replace("when C.e > 50 V", "when go > 0.5") + "set = { go = 1 }\n"
    done = shell("run", shell.file("rc.toml", mended))
    assert done.code == 0 and "t = 1 s  change  jets  fill -> dump" in done.out
