"""What is refused because it would slide says which machine slides; put in, it does."""

from __future__ import annotations

import math
import re

import pytest

import hybond as hb

THERMOSTAT = """
hybond = 1
domain = "thermal_pseudo"
[elements]
heater  = { Sf = "if 293 >= T.e then 900 else 0" }
room    = { C = "5e4 J/K", e = "288 K" }
wall    = { R = "0.03 K/W" }
outside = { Se = "278 K" }
T       = { junction = 0 }
loss    = { junction = 1 }
[graph]
bonds = ["heater -> T -> room", "T -> loss -> wall", "loss -> outside"]
"""
RUB = """
hybond = 1
domain = "translational"
[elements]
pull = { Se = "1 N" }
mass = { I = "1 kg", f = "1 m/s" }
rub  = { R = { e = "2*sign(f)" } }
v    = { junction = 1 }
[graph]
bonds = ["pull -> v -> mass", "rub -> v"]
"""
STEERED = """
hybond = 1
domain = "translational"
[elements]
act  = { Se = "-8 [N]*sign(s)" }
mass = { I = "1 kg" }
v    = { junction = 1 }
[graph]
bonds = ["act -> v -> mass"]
[signals]
x = { integral = "v.f", start = 1 }
s = "v.f + 2*x"
"""
OWN = """
hybond = 1
[signals]
w = { integral = "0.3 - sign(w)", start = 0.35 }
"""


def refused(text: str, until: float) -> hb.HybondError:
    run = hb.simulate(hb.loads(text), until, on_error="return")
    assert run.error is not None and run.error.code == "HB-N410"
    return run.error


def with_machine(text: str, hint: str) -> str:
    """Put into a model file what the remedy says, word by word."""
    found = re.search(
        r"Here \[machines\.(\w+)\] with (states = .*), (start = \S+) and (rules = .*) slides, "
        r"if (\w+) has (.*) in place of (.*)",
        hint,
    )
    assert found is not None, hint
    name, states, start, rules, where, new, old = found.groups()
    line = next(a for a in text.splitlines() if re.match(rf"{where} *=", a))
    assert old in line
    switched = line.replace(old, new.replace("'", '\\"'))
    machine = f"[machines.{name}]\n{states}\n{start}\n{rules}\n"
    return text.replace(line, switched) + machine.replace("'", '"')


def test_a_thermostat_without_a_band_holds_its_temperature_with_the_machine_named() -> None:
    error = refused(THERMOSTAT, 2000)
    run = hb.simulate(hb.loads(with_machine(THERMOSTAT, error.hint)), 2000)
    # towards 278 + 0.03*900 = 305 K with a time constant of 1500 s, from 288 K
    met = 1500.0 * math.log(17.0 / 12.0)
    assert run["T.e"].at(0.5 * met) == pytest.approx(305.0 - 17.0 * math.sqrt(12.0 / 17.0))
    assert run.sliding[0].t0 == pytest.approx(met, rel=1e-7)
    assert run["T.e"].at(1500.0) == pytest.approx(293.0, rel=1e-12)
    assert run["heater.f"].at(1500.0) == pytest.approx(15.0 / 0.03, rel=1e-9)


def test_dry_friction_as_a_resistor_stops_and_holds_with_the_machine_named() -> None:
    error = refused(RUB, 3)
    assert "law = 'coulomb'" in error.hint
    run = hb.simulate(hb.loads(with_machine(RUB, error.hint)), 3)
    for t in (0.25, 0.5, 0.99):
        assert run["v.f"].at(t) == pytest.approx(1.0 - t, rel=1e-9)  # slowed down by 2 N - 1 N
    assert run["v.f"].at(2.0) == pytest.approx(0.0, abs=1e-10)
    assert run["pull.e"].at(2.0) + run["rub.e"].at(2.0) == pytest.approx(0.0, abs=1e-9)


def test_a_switched_force_slides_along_the_line_that_its_sign_reads() -> None:
    error = refused(STEERED, 4)
    run = hb.simulate(hb.loads(with_machine(STEERED, error.hint)), 4)
    met = (-8.0 + math.sqrt(128.0)) / 16.0  # where -8*t + 2*(1 - 4*t^2) is zero
    assert run.sliding[0].t0 == pytest.approx(met, rel=1e-7)
    there = 1.0 - 4.0 * met**2
    for t in (1.0, 2.0, 4.0):
        assert run["x"].at(t) == pytest.approx(there * math.exp(-2.0 * (t - met)), abs=1e-7)


def test_an_integral_that_switches_its_own_rate_stands_with_the_machine_named() -> None:
    error = refused(OWN, 2)
    run = hb.simulate(hb.loads(with_machine(OWN, error.hint)), 2)
    assert run["w"].at(0.25) == pytest.approx(0.35 - 0.7 * 0.25)
    assert run["w"].at(1.5) == pytest.approx(0.0, abs=1e-9)


def test_of_several_jumps_nobody_knows_which_one_would_slide() -> None:
    error = refused(OWN.replace("0.3 - sign(w)", "0.3 - sign(w) - 2*sign(w - 5)*0"), 2)
    assert "Here" not in error.hint and "machine" in error.hint


def piecewise(until: float) -> tuple[float, float]:
    """Return x and v: exponentials from step to step of the force, met by bisection."""
    x, v, k, t = 0.2, 0.0, 20, 0.0

    def after(h: float) -> tuple[float, float]:
        end = -20.0 * 0.01 * k / 3.0  # the speed that drag and force agree on
        fades = math.exp(-3.0 * h)
        return x + end * h + (v - end) * (1.0 - fades) / 3.0, end + (v - end) * fades

    while True:
        low, high = 0.0, 1e-3
        inside = abs(after(min(high, until - t))[0] / 0.01 - k) <= 0.5
        if inside and t + high >= until:
            return after(until - t)
        if not inside:
            for _ in range(80):
                middle = 0.5 * (low + high)
                if abs(after(middle)[0] / 0.01 - k) <= 0.5:
                    low = middle
                else:
                    high = middle
        t, step = t + high, after(high)
        k += 0 if inside else (1 if step[1] > 0.0 else -1)
        x, v = step


def test_a_step_that_ends_at_a_jump_knows_nothing_of_what_is_behind_it() -> None:
    """A stage beyond it by a last place was taken for one before: 2e-6 off at rtol = 1e-8."""
    m = hb.Model("steps", domain="translational")
    m.add(act=hb.Se("-20*(floor(x/0.01 + 0.5)*0.01) - 3*v.f"), mass=hb.I("1 kg"), v=hb.One())
    m.bond("act -> v -> mass")
    m.signal(x=hb.Integral("v.f", start=0.2))
    run = hb.simulate(m, 3, solver="rk45")
    for t in (0.3, 0.6, 0.78, 1.1):
        x, v = piecewise(t)
        assert run["x"].at(t) == pytest.approx(x, abs=1e-8)
        assert run["v.f"].at(t) == pytest.approx(v, abs=3e-8)
    assert run.audit().holds()
