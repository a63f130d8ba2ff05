"""P3: a buck converter with a switch at 100 kHz and an ideal diode."""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any

import numpy as np
from measuring.exact import Linear, Vector, follow
from measuring.others import in_pulsim, in_rumoca
from measuring.ours import in_hybond
from measuring.problem import C, Outcome, Problem, points
from measuring.programs import in_c
from measuring.restarts import Mode, in_scipy

import hybond as hb

VOLT, HENRY, FARAD, OHM, PERIOD, DUTY, RTOL = 12.0, 1e-4, 1e-4, 2.0, 1e-5, 0.5, 1e-8
LENGTHS, FULL = (200.0, 1000.0), (2000.0, 10000.0)
MODELICA = f"""model Buck
  Real i(start = 0.0, fixed = true);
  Real v(start = 0.0, fixed = true);
  discrete Boolean on(start = false, fixed = true);
equation
  when sample(0.0, {DUTY * PERIOD}) then
    on = not pre(on);
  end when;
  {HENRY}*der(i) = if on then {VOLT} - v elseif i > 0.0 or v < 0.0 then -v else 0.0;
  {FARAD}*der(v) = i - v/{OHM};
end Buck;
"""


def model() -> hb.Model:
    """Return the converter; a machine follows the gate, the diode its own law."""
    m = hb.Model("buck", domain="electrical")
    m.add(V=hb.Se(VOLT), switch=hb.One(), d=hb.One(law="diode"), x=hb.Zero(), i=hb.One())
    m.add(L=hb.I(HENRY), out=hb.Zero(), C=hb.C(FARAD), load=hb.R(OHM))
    m.bond("V -> switch -> x", "d -> x -> i -> L", "i -> out -> C", "out -> load")
    m.input(gate=hb.Input(pwm={"period": PERIOD, "duty": DUTY}))
    m.machine(
        "S",
        states={"open": [], "closed": ["switch"]},
        start="closed",
        rules=["closed -> open when gate < 0.5", "open -> closed when gate > 0.5"],
    )
    return m


def mode_of(mode: Hashable) -> Mode:
    """Return the field of a mode, and when the diode switches."""
    volt = VOLT if mode == "switch" else 0.0

    def convert(t: float, y: Vector) -> list[float]:
        current = 0.0 if mode == "none" else (volt - y[1]) / HENRY
        return [current, (y[0] - y[1] / OHM) / FARAD]

    if mode == "diode":
        return convert, [(lambda t, y: y[0], lambda t, y: ("none", y * [0.0, 1.0]))]
    if mode == "none":
        return convert, [(lambda t, y: y[1], lambda t, y: ("diode", y))]
    return convert, []


def edge(number: int) -> float:
    """Return the time of a falling (even) or rising (odd) edge of the gate."""
    return (number // 2 + (1.0 if number % 2 else DUTY)) * PERIOD


def freed(y: Vector) -> str:
    """Return the mode once the switch has opened."""
    return "diode" if y[0] > 0.0 else "none"


def circuit(b: Any) -> Any:
    """Build the same circuit with pulsim."""
    b.add_voltage_source("V", "plus", "gnd", VOLT)
    b.add_switch("S", "plus", "x", 1e6, 1e-9)
    b.add_diode("d", "gnd", "x", 1e6, 1e-9)
    b.add_inductor("L", "x", "out", HENRY)
    b.add_capacitor("C", "out", "gnd", FARAD)
    b.add_resistor("load", "out", "gnd", OHM)
    return b


def true(cycles: float) -> tuple[float, ...]:
    """Return current and voltage at the end, edge by edge."""
    one = np.array([[0.0, -1.0 / HENRY, 0.0], [1.0 / FARAD, -1.0 / (OHM * FARAD), 0.0], [0.0] * 3])
    on = one.copy()
    on[0, 2] = VOLT / HENRY
    none = one.copy()
    none[0] = 0.0
    ends = np.array([1.0, 0.0, 0.0])
    grid = PERIOD / 10.0
    modes: dict[Hashable, Linear] = {
        "switch": Linear(on, (), DUTY * PERIOD),
        "diode": Linear(one, ((ends, None, "none", lambda y: y * [0.0, 1.0, 1.0]),), grid),
        "none": Linear(none, (), grid),
    }
    y, t = np.array([0.0, 0.0, 1.0]), 0.0
    for number in range(int(2 * cycles)):
        mode = freed(y) if number % 2 else "switch"
        y, _ = follow(modes, mode, y, edge(number) - t)
        t = edge(number)
    return float(y[0]), float(y[1])


def problem(full: bool) -> Problem:
    """Return the problem."""
    longest = (FULL if full else LENGTHS)[1]

    def limit(n: float) -> Outcome | None:
        run = in_c("buck", n, RTOL, points(n, longest))
        return run and Outcome(run.seconds, run.found[1:])

    def ours(n: float, solver: str = "rk45") -> Outcome:
        return in_hybond(
            model(),
            n * PERIOD,
            points(n, longest),
            ["L.f", "C.e"],
            lambda run: (run.final["L.f"], run.final["C.e"]),
            rtol=RTOL,
            solver=solver,
        )

    def scipy(n: float) -> Outcome:
        return in_scipy(
            mode_of,
            "switch",
            [0.0, 0.0],
            n * PERIOD,
            points(n, longest),
            lambda t, y, times: (float(y[0]), float(y[1])),
            rtol=RTOL,
            edges=lambda k: (edge(k), (lambda y: "switch") if k % 2 else freed),
        )

    return Problem(
        "P3",
        "buck converter, switch and ideal diode",
        "cycle",
        LENGTHS,
        FULL,
        {
            C: limit,
            "hybond": ours,
            "hybond exact": lambda n: ours(n, "exact"),
            "SciPy": scipy,
            "rumoca": lambda n: in_rumoca(
                MODELICA,
                "Buck",
                n * PERIOD,
                points(n, longest),
                lambda run: (float(run["i"][-1]), float(run["v"][-1])),
                rtol=RTOL,
            ),
            "pulsim": lambda n: in_pulsim(
                circuit,
                n * PERIOD,
                lambda run: (float(run.i("L")[-1]), float(run.v("out")[-1])),
                rtol=RTOL,
                atol=1e-2 * RTOL,
                made={"switch_fn": lambda p: p.make_pwm_switch_fn(1.0 / PERIOD, DUTY, 0, 1)},
            ),
        },
        true,
    )
