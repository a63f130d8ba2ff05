"""What flows through next to nothing: a difference of two states that are nearly one.

Where the states have eight digits, a current through a nano-ohm between them had none; every value
that a run tells is held, not the states alone. Closed forms.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

import hybond as hb

OMEGA = 100.0 * math.pi
TIMES = [0.0003 + 0.0013 * k for k in range(38)]
UNTIL = 0.05


def driven(resistance: float, turned: bool) -> str:
    """A sine behind a resistor and a capacitor of 1 mF."""
    bond = "j -> R" if not turned else "R -> j"
    return f"""
hybond = 1
[elements]
V = {{ Se = "sin({OMEGA!r}*time/(1 [s]))" }}
j = {{ junction = 1 }}
R = {{ R = {resistance!r} }}
C = {{ C = 1e-3 }}
[graph]
bonds = ["V -> j", "{bond}", "j -> C"]
"""


def current(resistance: float, t: float) -> float:
    """From rest: what goes on, and what dies out."""
    late = OMEGA * 1e-3 * resistance
    going_on = math.cos(OMEGA * t) + late * math.sin(OMEGA * t)
    dying = math.exp(-t / (1e-3 * resistance))
    return OMEGA * 1e-3 * (going_on - dying) / (1.0 + late * late)


@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("resistance", [1e-2, 1e-6, 1e-9])
def test_a_capacitor_behind_next_to_no_resistance(
    resistance: float, turned: bool, solver: str
) -> None:
    run = hb.simulate(hb.loads(driven(resistance, turned)), until=UNTIL, solver=solver)
    flow = run.sample(TIMES, "C.f")["C.f"]
    right = np.array([current(resistance, t) for t in TIMES])
    assert flow == pytest.approx(right, abs=2e-4 * OMEGA * 1e-3)
    assert run.audit().holds()


DIFFERENTIATOR = """
hybond = 1
domain = "electrical"
[elements]
gnd = { submodel = "electrical.ground" }
V = { submodel = "electrical.voltage_source", inputs.u = "1 [V]*sin(100*pi*time/(1 [s]))" }
C = { submodel = "electrical.capacitor", parameters.C = "1 uF" }
R = { submodel = "electrical.resistor", parameters.R = "1 kohm" }
A = { submodel = "electrical.op_amp_ideal" }
earth = { junction = 0 }
inp = { junction = 0 }
n = { junction = 0 }
out = { junction = 0 }
[graph]
bonds = [
  "gnd.pin -> earth", "inp -> V.plus", "V.minus -> earth", "inp -> C.plus", "C.minus -> n",
  "n -> R.plus", "R.minus -> out", "earth -> A.plus", "n -> A.minus", "A.out -> out",
  "A.ground -> earth",
]
"""


def test_an_amplifier_that_differentiates() -> None:
    """A gain of a million: its input is a millionth of what it tells."""
    run = hb.simulate(hb.loads(DIFFERENTIATOR), until=UNTIL)
    right = np.array([-1e-3 * OMEGA * math.cos(OMEGA * t) for t in TIMES])
    assert run.sample(TIMES, "out.e")["out.e"] == pytest.approx(right, abs=1e-5)
    assert run.audit().holds()


PULLED = """
hybond = 1
[elements]
v = { Sf = "sin(3*time/(1 [s]))" }
a = { junction = 0 }
d = { R = 1e9 }
m = { I = 2 }
k = { C = 0.5 }
w = { junction = 1 }
[graph]
bonds = ["v -> a", "a -> d", "a -> w", "w -> m", "w -> k"]
"""


def test_a_mass_pulled_along_by_a_stiff_damper() -> None:
    """It moves as it is pulled; the force is that of its mass and of the spring behind it."""
    run = hb.simulate(hb.loads(PULLED), until=10.0)
    times = [0.1 + 0.17 * k for k in range(58)]
    force = run.sample(times, "v.e")["v.e"]
    right = np.array([6 * math.cos(3 * t) + 2 * (1 - math.cos(3 * t)) / 3 for t in times])
    assert force == pytest.approx(right, abs=2e-4)


RECTIFIER = """
hybond = 1
domain = "electrical"
[parameters]
R_on = "1 ohm"
[elements]
gnd = { submodel = "electrical.ground" }
V = { submodel = "electrical.voltage_source", inputs.u = "10 [V]*sin(100*pi*time/(1 [s]))" }
D = { submodel = "electrical.diode", parameters.R_on = "R_on" }
C = { submodel = "electrical.capacitor", parameters.C = "1 mF" }
R = { submodel = "electrical.resistor", parameters.R = "100 ohm" }
earth = { junction = 0 }
inp = { junction = 0 }
out = { junction = 0 }
[graph]
bonds = [
  "gnd.pin -> earth", "inp -> V.plus", "V.minus -> earth", "inp -> D.plus", "D.minus -> out",
  "out -> C.plus", "C.minus -> earth", "out -> R.plus", "R.minus -> earth",
]
"""


@pytest.mark.parametrize("solver", ["auto", "radau"])
@pytest.mark.parametrize("r_on", [1e-6, 1e-9])
def test_a_diode_of_next_to_no_resistance_ends_each_half_wave(r_on: float, solver: str) -> None:
    """It took what the source would drive through it for stored energy, and blocked no more."""
    run = hb.simulate(hb.loads(RECTIFIER), until=UNTIL, solver=solver, parameters={"R_on": r_on})
    ends = [event.t for event in run.events if event.steps[-1].mode == (0,)]
    first = (math.pi - math.atan(OMEGA * 0.1)) / OMEGA
    # a current is zero to 1e-12 of what it is a difference of, 10 V through r_on, and it falls by
    # so much a second; the rest is what the tolerance of charges lets it be off by
    late = 2e-12 * 10.0 / r_on / (10.0 * 1e-3 * OMEGA**2) + 2e-7
    assert ends == pytest.approx([first, first + 0.02, first + 0.04], abs=late)
