"""A run that does not reach its end does not look like one that did."""

from typing import Any

import pytest

import hybond as hb
from tests.export.programs import ask, compile_quickly

RELAY = """\
hybond = 1

[parameters]
q0 = -0.2

[elements]
x = { C = 1, q = "q0" }
s = { Sf = '-(if R.state == "above" then 1 else -1)' }
n = { junction = 0 }

[graph]
bonds = ["s -> n -> x"]

[machines.R]
states = { above = [], below = [] }
start = "below"
rules = ["above -> below when x.q < 0", "below -> above when x.q > 0"]

[experiment]
until = 1
sliding = "refuse"
"""
AT = "t = 0.2 s  stopped where events accumulate, of 1 s"


def test_a_run_that_stops_where_events_accumulate_says_so(shell: Any) -> None:
    shell.file("relay.toml", RELAY)
    done = shell("run", "relay.toml")
    assert done.code == 3 and AT in done.out
    assert shell("explain", "relay.toml").code == 3
    assert shell("run", "relay.toml", "--until", "0.1").code == 0
    assert shell("run", "relay.toml", "--json").json["status"] == "accumulation"


def test_a_sweep_has_the_code_of_its_worst_member(shell: Any) -> None:
    shell.file("relay.toml", RELAY)
    assert shell("sweep", "relay.toml", "--vary", "q0=-2,-3").code == 0
    done = shell("sweep", "relay.toml", "--vary", "q0=-2,-0.2")
    assert done.code == 3 and "accumulation        0.2" in done.out


@pytest.mark.c
@pytest.mark.slow
def test_a_program_ends_with_the_same_code(shell: Any) -> None:
    shell.file("relay.toml", RELAY)
    text = hb.export(hb.load("relay.toml"), to="c")
    program = compile_quickly(text, shell.folder, "relay")
    said = ask(program, "--events", code=3).splitlines()
    assert said[-1].startswith("# stopped: events of R accumulate (t = 0.2")
    assert ask(program, "--events", "--until", "0.1").splitlines()[-1].startswith("state x.q")
