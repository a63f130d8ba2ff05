"""What is told of models with many machines fits a screen, and says things once."""

from __future__ import annotations

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
