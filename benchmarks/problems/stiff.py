"""P6: a ball on a stiff springy floor that relaxes in 0.1 ms while nothing touches it."""

from __future__ import annotations

from collections.abc import Hashable

import numpy as np
from measuring.exact import Linear, Vector, follow
from measuring.others import in_rumoca
from measuring.ours import in_hybond
from measuring.problem import C, Outcome, Problem, points
from measuring.programs import in_c
from measuring.restarts import Mode, in_scipy

import hybond as hb

STIFF, DAMPED, WEIGHT, DROP, RTOL = 1000.0, 0.1, 9.81, 3.0, 1e-8
LENGTHS, FULL = (3.0, 12.0), (3.0, 12.0)
MODELICA = f"""model Stiff
  Real v(start = 0.0, fixed = true);
  Real pad(start = 0.0, fixed = true);
  Real height(start = {DROP}, fixed = true);
  Real force;
  discrete Boolean touching(start = false, fixed = true);
equation
  force = {STIFF}*pad - {DAMPED}*v;
  der(v) = -{WEIGHT} + (if touching then force else 0.0);
  der(pad) = if touching then -v else -{STIFF / DAMPED}*pad;
  der(height) = v;
  when {{not pre(touching) and height <= 0.0 and v < 0.0, pre(touching) and force < 0.0}} then
    touching = not pre(touching);
  end when;
end Stiff;
"""


def model() -> hb.Model:
    """Return the ball; spring and damper of the floor share their rate, contact is a machine."""
    m = hb.Model("stiff ball", domain="translational")
    m.add(weight=hb.Se(-WEIGHT), ball=hb.I(1.0), pad=hb.C(1.0 / STIFF), damper=hb.R(DAMPED))
    m.add(v=hb.One(), contact=hb.Zero(), squeeze=hb.One())
    m.bond("weight -> v -> ball", "contact -> v", "contact -> squeeze -> pad", "squeeze -> damper")
    m.signal(height=hb.Integral("v.f", start=DROP))
    m.machine(
        "floor",
        states={"away": [], "touching": ["contact"]},
        start="away",
        rules=[
            "away -> touching when height <= 0 and v.f < 0",
            "touching -> away when contact.e < 0",
        ],
    )
    return m


def matrix(touching: bool) -> Vector:
    """Return the field on (speed, pad, height, 1)."""
    a = np.zeros((4, 4))
    a[0, 3], a[2, 0] = -WEIGHT, 1.0
    if touching:
        a[0, :2] = -DAMPED, STIFF
        a[1, 0] = -1.0
    else:
        a[1, 1] = -STIFF / DAMPED
    return a


def mode_of(touching: Hashable) -> Mode:
    """Return the field of a mode and its rule."""
    a = matrix(bool(touching))

    def rates(t: float, y: Vector) -> Vector:
        return np.asarray(a[:3, :3] @ y + a[:3, 3])

    if touching:
        return rates, [(lambda t, y: STIFF * y[1] - DAMPED * y[0], lambda t, y: (False, y))]
    return rates, [(lambda t, y: y[2] if y[0] < 0.0 else 1.0, lambda t, y: (True, y))]


def true(end: float) -> tuple[float, ...]:
    """Return the height at the end."""
    speed, height = np.eye(4)[0], np.eye(4)[2]
    force = np.array([-DAMPED, STIFF, 0.0, 0.0])
    modes: dict[Hashable, Linear] = {
        False: Linear(matrix(False), ((height, speed, True, np.array),), 2e-2),
        True: Linear(matrix(True), ((force, None, False, np.array),), 5e-3),
    }
    y, _ = follow(modes, False, np.array([0.0, 0.0, DROP, 1.0]), end)
    return (float(y[2]),)


def problem(full: bool) -> Problem:
    """Return the problem."""
    longest = (FULL if full else LENGTHS)[1]

    def limit(end: float) -> Outcome | None:
        run = in_c("stiff", end, RTOL, points(end, longest))
        return run and Outcome(run.seconds, run.found[1:2])

    def ours(solver: str, end: float) -> Outcome:
        return in_hybond(
            model(),
            end,
            points(end, longest),
            ["height", "v.f"],
            lambda run: (run.final["height"],),
            rtol=RTOL,
            solver=solver,
        )

    def scipy(end: float) -> Outcome:
        return in_scipy(
            mode_of,
            False,
            [0.0, 0.0, DROP],
            end,
            points(end, longest),
            lambda t, y, times: (float(y[2]),),
            rtol=RTOL,
            atol=1e-12,
            method="Radau",
        )

    return Problem(
        "P6",
        "ball on a stiff floor, by a machine",
        "second",
        LENGTHS,
        FULL,
        {
            C: limit,
            "hybond radau": lambda end: ours("radau", end),
            "hybond rk45": lambda end: ours("rk45", end),
            "SciPy": scipy,
            "rumoca": lambda end: in_rumoca(
                MODELICA,
                "Stiff",
                end,
                points(end, longest),
                lambda run: (float(run["height"][-1]),),
                rtol=RTOL,
                solver="bdf",
            ),
        },
        true,
        "C, hybond radau and SciPy take Radau IIA of order 5, rumoca BDF.",
    )
