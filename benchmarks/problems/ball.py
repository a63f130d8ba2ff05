"""P1: a ball that gives back 0.999 of its speed, by a machine."""

from __future__ import annotations

import math

from measuring.others import in_rumoca
from measuring.ours import in_hybond
from measuring.problem import C, Outcome, Problem, points
from measuring.programs import in_c
from measuring.restarts import Mode, Vector, in_scipy

import hybond as hb

RESTITUTION, DROP, GRAVITY, RTOL = 0.999, 3.0, 9.81, 1e-8
LENGTHS, FULL = (500.0, 2500.0), (1000.0, 5000.0)
MODELICA = f"""model Ball
  Real height(start = {DROP}, fixed = true);
  Real v(start = 0.0, fixed = true);
  discrete Real count(start = 0.0, fixed = true);
  discrete Real last(start = 0.0, fixed = true);
equation
  der(height) = v;
  der(v) = -{GRAVITY};
  when height <= 0.0 and v < 0.0 then
    reinit(v, -{RESTITUTION}*pre(v));
    count = pre(count) + 1.0;
    last = time;
  end when;
end Ball;
"""


def model() -> hb.Model:
    """Return the ball with Newton's restitution as a source that a machine switches on."""
    m = hb.Model(
        "ball", domain="translational", parameters={"restitution": RESTITUTION, "drop": DROP}
    )
    m.add(weight=hb.Se(-GRAVITY), ball=hb.I(1.0), v=hb.One(), contact=hb.Zero())
    m.add(rebound=hb.Sf("-restitution*pre(v.f)"))
    m.bond("weight -> v -> ball", "contact -> v", "rebound -> contact")
    m.signal(height=hb.Integral("v.f", start="drop"))
    m.machine(
        "floor",
        states={"away": [], "impact": ["contact"]},
        start="away",
        rules=[
            "away -> impact when height <= 0 and v.f < 0",
            "impact -> away when pre(ball.p) >= 0",
        ],
    )
    return m


def bounce(n: int) -> float:
    """Return the time of the nth bounce."""
    flights = RESTITUTION * (1.0 - RESTITUTION ** (n - 1)) / (1.0 - RESTITUTION)
    return math.sqrt(2.0 * DROP / GRAVITY) * (1.0 + 2.0 * flights)


def until(bounces: float) -> float:
    """Return a time halfway to the next bounce."""
    return 0.5 * (bounce(int(bounces)) + bounce(int(bounces) + 1))


def last(run: hb.Result) -> tuple[float, ...]:
    """Return the number of bounces and the time of the last one."""
    at = [e.t for e in run.events if e.cause == "guard"]
    return len(at), at[-1]


def fall(t: float, y: Vector) -> list[float]:
    return [y[1], -GRAVITY]


def falling(restitution: float) -> Mode:
    """Return free fall, and what the floor does."""
    return fall, [
        (
            lambda t, y: y[0] if y[1] < 0.0 else 1.0,
            lambda t, y: (0, y * [0.0, -restitution]),
        )
    ]


def problem(full: bool) -> Problem:
    """Return the problem; output points are as dense as in the longest run."""
    longest = (FULL if full else LENGTHS)[1]

    def ours(n: float, solver: str = "rk45") -> Outcome:
        count = points(n, longest)
        return in_hybond(
            model(), until(n), count, ["height", "v.f"], last, rtol=RTOL, solver=solver
        )

    def scipy(n: float) -> Outcome:
        count = points(n, longest)
        return in_scipy(
            lambda mode: falling(RESTITUTION),
            0,
            [DROP, 0.0],
            until(n),
            count,
            lambda t, y, times: (len(times), times[-1]),
            rtol=RTOL,
        )

    return Problem(
        "P1",
        "ball, bounces by a machine",
        "bounce",
        LENGTHS,
        FULL,
        {
            C: lambda n: in_c("ball", until(n), RESTITUTION, DROP, RTOL, points(n, longest)),
            "hybond": ours,
            "hybond exact": lambda n: ours(n, "exact"),
            "SciPy": scipy,
            "rumoca": lambda n: in_rumoca(
                MODELICA,
                "Ball",
                until(n),
                points(n, longest),
                lambda run: (float(run["count"][-1]), float(run["last"][-1])),
                rtol=RTOL,
            ),
        },
        lambda n: (n, bounce(int(n))),
    )
