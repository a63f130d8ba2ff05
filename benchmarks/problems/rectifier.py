"""P2: a bridge of four ideal diodes between a sine and a capacitor with a load."""

from __future__ import annotations

import math
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

VOLT, OMEGA, R_LINE, R_LOAD, FARAD, RTOL = 325.0, 100.0 * math.pi, 0.1, 100.0, 470e-6, 1e-8
PERIOD = 2.0 * math.pi / OMEGA
LENGTHS, FULL = (20.0, 100.0), (200.0, 1000.0)
ROUGH = 1e-6
"""The tolerance for pulsim."""
CHARGING = 0.17
"""Part of a cycle at which runs end: a diode has just begun to conduct, nothing is forgotten."""
MODELICA = f"""model Rectifier
  Real v(start = 0.0, fixed = true);
  Real u;
  Real i;
equation
  u = {VOLT}*sin({OMEGA!r}*time);
  i = (if u > v then u - v elseif u < -v then -u - v else 0.0)/{R_LINE};
  {FARAD}*der(v) = i - v/{R_LOAD};
end Rectifier;
"""


def model() -> hb.Model:
    """Return the bridge; which diodes conduct is decided by complementarity."""
    m = hb.Model("rectifier", domain="electrical")
    m.add(V=hb.Se(f"{VOLT}*sin({OMEGA!r}*time)"), line=hb.One(), Rs=hb.R(R_LINE))
    m.add(a=hb.Zero(), b=hb.Zero(), plus=hb.Zero(), C=hb.C(FARAD), load=hb.R(R_LOAD))
    m.add(**{f"d{k}": hb.One(law="diode") for k in (1, 2, 3, 4)})
    m.bond("V -> line -> Rs", "b -> line -> a", "a -> d1 -> plus", "b -> d2 -> plus")
    m.bond("d3 -> a", "d4 -> b", "plus -> C", "plus -> load")
    return m


def mode_of(way: Hashable) -> Mode:
    """Return how the voltage moves while the pair `way` conducts, 0 for none."""
    assert isinstance(way, int)

    def charge(t: float, y: Vector) -> Vector:
        inwards = (way * VOLT * math.sin(OMEGA * t) - y) / R_LINE if way else 0.0
        return np.asarray((inwards - y / R_LOAD) / FARAD)

    if way:
        return charge, [
            (lambda t, y: way * VOLT * math.sin(OMEGA * t) - y[0], lambda t, y: (0, y)),
        ]
    return charge, [
        (lambda t, y: y[0] - VOLT * math.sin(OMEGA * t), lambda t, y: (1, y)),
        (lambda t, y: y[0] + VOLT * math.sin(OMEGA * t), lambda t, y: (-1, y)),
    ]


def linear(way: int) -> Linear:
    """Return the same with sine and cosine as states."""
    a = np.zeros((3, 3))
    a[0, 0] = -(1.0 / R_LOAD + (1.0 / R_LINE if way else 0.0)) / FARAD
    a[0, 1] = way * VOLT / (R_LINE * FARAD)
    a[1, 2], a[2, 1] = OMEGA, -OMEGA
    if way:
        rules = [(np.array([-1.0, way * VOLT, 0.0]), None, 0, np.array)]
    else:
        rules = [(np.array([1.0, -k * VOLT, 0.0]), None, k, np.array) for k in (1, -1)]
    return Linear(a, tuple(rules), PERIOD / 50.0)


def end(cycles: float) -> float:
    """Return when a run ends."""
    return (cycles + CHARGING) * PERIOD


def circuit(b: Any) -> Any:
    """Build the same circuit with pulsim."""
    b.add_sine_voltage_source("V", "s", "b", 0.0, VOLT, 1.0 / PERIOD, 0.0)
    b.add_resistor("Rs", "s", "a", R_LINE)
    for name, anode, cathode in (
        ("d1", "a", "plus"),
        ("d2", "b", "plus"),
        ("d3", "gnd", "a"),
        ("d4", "gnd", "b"),
    ):
        b.add_diode(name, anode, cathode, 1e6, 1e-9)
    b.add_capacitor("C", "plus", "gnd", FARAD)
    b.add_resistor("load", "plus", "gnd", R_LOAD)
    return b


def true(cycles: float) -> tuple[float, ...]:
    """Return events and the voltage at the end."""
    modes: dict[Hashable, Linear] = {way: linear(way) for way in (1, 0, -1)}
    y, _ = follow(modes, 1, np.array([0.0, 0.0, 1.0]), end(cycles))
    return (float(y[0]),)


def problem(full: bool) -> Problem:
    """Return the problem."""
    longest = (FULL if full else LENGTHS)[1]

    def limit(n: float) -> Outcome | None:
        run = in_c("rectifier", end(n) / PERIOD, RTOL, points(n, longest))
        return run and Outcome(run.seconds, run.found[1:])

    def ours(n: float, solver: str = "rk45") -> Outcome:
        return in_hybond(
            model(),
            end(n),
            points(n, longest),
            ["C.e"],
            lambda run: (run.final["C.e"],),
            rtol=RTOL,
            solver=solver,
        )

    def scipy(n: float) -> Outcome:
        return in_scipy(
            mode_of,
            1,
            [0.0],
            end(n),
            points(n, longest),
            lambda t, y, times: (float(y[0]),),
            rtol=RTOL,
            atol=1e-6,
            max_step=PERIOD / 20.0,  # or it steps over whole half cycles
        )

    return Problem(
        "P2",
        "bridge of four ideal diodes",
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
                "Rectifier",
                end(n),
                points(n, longest),
                lambda run: (float(run["v"][-1]),),
                rtol=RTOL,
            ),
            "pulsim": lambda n: in_pulsim(
                circuit,
                end(n),
                lambda run: (float(run.v("plus")[-1]),),
                rtol=ROUGH,
                atol=ROUGH,
            ),
        },
        true,
        f"pulsim at a tolerance of {ROUGH:g}: it averages what a diode does at its threshold, and "
        "ends with one that does not conduct at other tolerances.",
    )
