"""A sequencer that only drives inputs controls no junction, and may stand beside what does."""

from __future__ import annotations

import hybond as hb

PRESS = """hybond = 1
domain = "hydraulic"
[elements]
p = { submodel = "hydraulic.pressure_source", parameters = { p = "100 bar" } }
valve = { submodel = "hydraulic.directional_valve", inputs = { spool = "seq.state == 'down'" } }
cyl = { submodel = "hydraulic.cylinder" }
ram = { submodel = "translational.mass", parameters = { m = "500 kg" } }
t = { submodel = "hydraulic.atmosphere" }
[graph]
bonds = [
  "p.port -> valve.p", "valve.t -> t.port", "valve.a -> cyl.a", "valve.b -> cyl.b",
  "cyl.rod -> ram.flange",
]
[machines.seq]
states = { wait = [], down = [], up = [] }
start = "wait"
rules = ["wait -> down when time >= 1 [s]", "down -> up when time >= 2 [s]"]
""".replace("seq.state == 'down'", "if seq.state == 'down' then 1 else 0")


def test_a_press_with_a_sequencer_has_causality() -> None:
    """It was an internal error (HB-X001) of `check`, `draw` and `causality`."""
    model = hb.loads(PRESS)
    model.check()
    assert not hb.causality(model).conflicts
