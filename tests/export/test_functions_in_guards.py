"""Each function of the expression language in a guard of an exported program."""

import math

import pytest
from export.programs import ask, compile_quickly, needs_c, read_events

import hybond as hb

TIMES = {
    "sin(x) >= 0.5": math.asin(0.5),
    "cos(x) <= 0.3": math.acos(0.3),
    "tan(x) >= 0.9": math.atan(0.9),
    "asin(x/2) >= 0.7": 2 * math.sin(0.7),
    "acos(x/2) <= 0.5": 2 * math.cos(0.5),
    "atan(x) >= 1": math.tan(1),
    "sinh(x) >= 2": math.asinh(2),
    "cosh(x) >= 2": math.acosh(2),
    "tanh(x) >= 0.9": math.atanh(0.9),
    "exp(x) >= 3": math.log(3),
    "log(1 + x) >= 0.6": math.exp(0.6) - 1,
    "log10(1 + x) >= 0.3": 10**0.3 - 1,
    "sqrt(x) >= 1.1": 1.21,
    "floor(x) >= 1": 1.0,
    "ceil(x + 0.25) >= 2": 0.75,
    "atan2(x, 1) >= 0.5": math.tan(0.5),
    "mod(x + 0.5, 1.9) <= 0.2": 1.4,
    "abs(x - 1.8) <= 0.1": 1.7,
    "sign(x - 1.65) > 0": 1.65,
    "hypot(x, 1) >= 1.5": math.sqrt(1.25),
    "min(x, 3) > 0.33": 0.33,
    "max(x, 0.5) > 0.61": 0.61,
    "x^3 > 0.2": 0.2 ** (1 / 3),
    "(if x > 0.4 then 1 else 0) > 0.5": 0.4,
    # numbers on the way are beyond all numbers, what is compared is not
    "log(1 + exp(1e3*x)) >= 810": 0.81,
    "log(2*exp(-1e3*x) + 3*exp(1e3*x)) > 820": 0.82 - 1e-3 * math.log(3),
    "exp(900*x - 900)/(1 + exp(900*x - 900)) > 0.5": 1.0,
    "sinh(900*x - 900)/cosh(900*x - 900) > 0.5": 1.0 + math.atanh(0.5) / 900,
    "(exp(9e2*x - 9e2) - exp(9e2 - 9e2*x))/(exp(9e2*x - 9e2) + exp(9e2 - 9e2*x)) > 0.5": (
        1.0 + math.atanh(0.5) / 900
    ),
    "sqrt((1e200*x)^2 + (5e199)^2) > 1.5e200": math.sqrt(2.25 - 0.25),
    "exp(1e3*x)*exp(-1e3*x)*x >= 0.83": 0.83,
}
"""When each guard begins to hold, where `x` is the time."""


@needs_c
@pytest.mark.slow
def test_a_program_fires_each_function_at_its_closed_form(tmp_path):
    m = hb.Model("functions")
    m.add(flow=hb.Sf(1), tank=hb.C(1), node=hb.Zero())
    m.bond("flow -> node -> tank")
    m.signal(x="tank.q")
    for k, guard in enumerate(TIMES):
        rules = [f"a -> b when {guard}"]
        m.machine(f"m{k}", states={"a": [], "b": []}, start="a", rules=rules)
    text = hb.export(m, to="c", until=2)
    said = read_events(ask(compile_quickly(text, tmp_path, "functions"), "--events"))
    machine = {
        name: t
        for (_, name, *_), t in zip(said.transitions, said.times, strict=True)
        if name != "-"
    }
    found = {guard: machine.get(f"m{k}") for k, guard in enumerate(TIMES)}
    assert found == pytest.approx(TIMES, abs=1e-9)
