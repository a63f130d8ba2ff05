"""What is told of models with many machines fits a screen, and says things once."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import hybond as hb
from hybond.cli.main import main
from hybond.report import WIDEST


def h_bridge() -> hb.Model:
    m = hb.Model("bridge", domain="electrical")
    m.add(
        battery=hb.Submodel("electrical.voltage_source", U="24 V"),
        ground=hb.Submodel("electrical.ground"),
        pwm=hb.Submodel("control.triangle_pwm", period="50 us", inputs={"u": "0.5"}),
        bridge=hb.Submodel(
            "electrical.h_bridge",
            R_on="10 mohm",
            T_dead="1 us",
            inputs={"a_up": "pwm.out", "b_up": "1 - pwm.out"},
        ),
        motor=hb.Submodel("electrical.dc_motor"),
    )
    m.bond("battery.plus -> bridge.plus", "battery.minus -> bridge.minus")
    m.bond("ground.pin -> battery.minus", "bridge.a -> motor.plus", "bridge.b -> motor.minus")
    return m


def test_modes_of_many_machines_do_not_widen_the_event_table() -> None:
    run = hb.simulate(h_bridge(), until="50 us")
    rows = run.events.rows()
    assert max(len(row[2]) for row in rows) <= WIDEST
    # what switched is told in full, and who is not named is counted
    assert any(row[2] == "bridge.leg_a.gates  down -> rises" for row in rows)
    modes = [row[2] for row in rows if row[2].startswith("(")]
    assert all(f"{7 - m.count(' = ')} more)" in m for m in modes)


def test_check_says_the_same_of_many_modes_once(
    tmp_path: object, capsys: pytest.CaptureFixture[str]
) -> None:
    file = f"{tmp_path}/press.toml"
    m = hb.Model("press", domain="hydraulic")
    m.add(
        pump=hb.Submodel("hydraulic.flow_source"),
        valve=hb.Submodel("hydraulic.directional_valve", inputs={"spool": "1"}),
        cylinder=hb.Submodel("hydraulic.cylinder"),
        relief=hb.Submodel("hydraulic.relief_valve", p_set="150 bar"),
        tank=hb.Submodel("hydraulic.atmosphere"),
        ram=hb.Submodel("translational.mass", m="200 kg"),
    )
    m.bond(
        "pump.outlet -> relief.inlet", "relief.outlet -> tank.port", "cylinder.rod -> ram.flange"
    )
    m.bond("tank.port -> pump.inlet", "pump.outlet -> valve.p", "valve.t -> tank.port")
    m.bond("valve.a -> cylinder.a", "valve.b -> cylinder.b")
    hb.save(m, file)
    assert main(["check", file]) == 0
    said = capsys.readouterr().out.splitlines()
    # 3 positions of the valve, 2 branches of the relief valve, 3 at each end of the stroke
    assert any("54 modes" in line for line in said)
    assert len(said) < 20 and said[-1] == "fine"
    told = sum(line.count("(") for line in said if line.startswith("modes ("))
    more = sum(int(line.split()[-2]) for line in said if line.endswith(" more"))
    never = next(int(line.split()[0]) for line in said if "no run enters" in line)
    assert told + more + never <= 54 - 1
    assert never > 0 and told + more > 0


FOLLOWER = """\
hybond = 1
domain = "translational"
[parameters]
high = "2 m/s"
[elements]
push = { Se = "if gate.state == 'on' then 3 else -3" }
body = { I = "1 kg" }
v = { junction = 1 }
two = { submodel = "watch", inputs = { u = "v.f" }, parameters = { high = "high" } }
[graph]
bonds = ["push -> v -> body"]
[machines.gate]
states = { on = [], off = [] }
start = "on"
rules = ["on -> off when two.inner.over > 0.5"]
[models.watch]
parameters = { high = "1 m/s", m = "1 m/s" }
inputs = { u = { constant = "0 m/s" } }
elements = { inner = { submodel = "deep", inputs = { u = "u" }, parameters = { m = "high" } } }
[models.watch.models.deep]
parameters = { m = "1 m/s" }
inputs = { u = { constant = "0 m/s" } }
signals = { over = "if state.state == 'high' then 1 else 0" }
[models.watch.models.deep.machines.state]
states = { low = [], high = [] }
start = "low"
rules = ["low -> high when u > m + 0 [m/s] and abs(u) > 0", "high -> low when u < -m"]
[experiment]
until = "1 s"
"""


def test_what_a_guard_in_a_part_reads_has_the_path_of_the_part(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "two.toml"
    file.write_text(FOLLOWER)
    assert main(["run", str(file)]) == 0
    said = capsys.readouterr().out
    # 2 m/s are reached after 2/3 s; what a unit is called is no name
    assert "t = 0.666666667 s  guard  two.inner.state  low -> high" in said
    assert (
        "two.inner.u > two.inner.m + 0 [m/s] and abs(two.inner.u) > 0   [two.inner.u = 2]" in said
    )


@pytest.mark.parametrize(
    "words, says, hint",
    [
        (["simulate", "spring.toml"], "no verb 'simulate'", "hybond run FILE"),
        (["plot", "spring.toml"], "no verb 'plot'", "--plot run.png"),
        (["draw", "spring.toml", "s.png"], "'s.png' is one word more", "--out s.png"),
        (["run", "spring.toml", "--plot"], "--plot needs a value", "--plot run.png"),
        (["run", "spring.toml", "--solver", "ode45"], "no solver 'ode45'", "'rk45'"),
        (["run", "spring.toml", "--solver", "ODE15s"], "no solver 'ODE15s'", "'radau'"),
    ],
)
def test_words_of_other_programs_are_told_what_they_are_here(
    shell: Any, words: list[str], says: str, hint: str
) -> None:
    done = shell(*words)
    assert done.code == 1 and says in done.err and hint in done.err


def test_one_thing_is_no_plural_and_two_sources_are_told_with_their_line(shell: Any) -> None:
    """Where two sources meet, a check knew the junction and not the line that has it."""
    text = "hybond = 1\n[elements]\nA = { Se = 1 }\nn = { junction = 0 }\nB = { Se = 2 }\n"
    shell.file("two.toml", text + '[graph]\nbonds = ["A -> n", "B -> n"]\n')
    done = shell("check", "two.toml")
    assert done.code == 2 and "two.toml:4" in done.err and "  1 junction; 2 bonds" in done.out
    assert shell("check", "two.toml", "--json").json["error"]["line"] == 4
