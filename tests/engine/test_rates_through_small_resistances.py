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


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("resistance", [1e-2, 1e-6, 1e-9])
def test_a_capacitor_behind_next_to_no_resistance(resistance: float, turned: bool) -> None:
    run = hb.simulate(hb.loads(driven(resistance, turned)), until=UNTIL)
    flow = run.sample(TIMES, "C.f")["C.f"]
    right = np.array([current(resistance, t) for t in TIMES])
    assert flow == pytest.approx(right, abs=2e-4 * OMEGA * 1e-3)
    assert run.audit().holds()
    assert run.stats["steps"] < 2000


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


def behind_a_filter(small: float) -> str:
    """A sine behind next to no resistance, a small capacitor, and a large one behind 1 ohm."""
    return f"""
hybond = 1
[elements]
V = {{ Se = "sin({OMEGA!r}*time/(1 [s]))" }}
a = {{ junction = 1 }}
r = {{ R = {small!r} }}
n = {{ junction = 0 }}
c = {{ C = 1e-9 }}
b = {{ junction = 1 }}
R = {{ R = 1.0 }}
C = {{ C = 3e-3 }}
[graph]
bonds = ["V -> a", "a -> r", "a -> n", "n -> c", "n -> b", "b -> R", "b -> C"]
"""


@pytest.mark.parametrize("small", [1e-9, 1e-6])
def test_where_the_source_passes_zero_steps_are_no_shorter(small: float) -> None:
    """There what a current is a difference of is zero, and its rounding is that of the sine."""
    run = hb.simulate(hb.loads(behind_a_filter(small)), until=UNTIL)
    assert run.stats["steps"] < 3000
    late = OMEGA * 3e-3
    times = [t for t in TIMES if t > 0.02]
    going_on = [(late * math.sin(OMEGA * t) + math.cos(OMEGA * t)) * late for t in times]
    dying = [late * math.exp(-t / 3e-3) for t in times]
    right = (np.array(going_on) - np.array(dying)) / (1.0 + late**2)
    assert run.sample(times, "C.f")["C.f"] == pytest.approx(right, abs=1e-5)
