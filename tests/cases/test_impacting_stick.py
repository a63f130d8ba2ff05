"""A stick hits the ground with a little friction, against its equations of motion."""

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

EXAMPLES = Path(__file__).parents[2] / "examples"

G, EPS, MU, L = 10.0, 1.0, 0.01, 1.0
MASS = np.diag([1.0, 1.0, 1.0 / 12.0])


def motion(until, lever):
    """Flights; impacts by Newton's law, MU times its impulse along; tip at ``x + lever*sin``."""
    z = np.array([0.0, L / 2 * math.cos(math.pi / 4) + 0.01, math.pi / 4, -0.5, 0.1, 0.1])
    t, hits = 0.0, []

    def field(t, z):
        return [z[3], z[4], z[5], 0.0, -G, 0.0]

    def gap(t, z):
        return z[1] - L / 2 * math.cos(z[2])

    gap.terminal, gap.direction = True, -1.0
    while True:
        part = solve_ivp(field, (t, until), z, rtol=1e-12, atol=1e-14, events=gap, max_step=1e-2)
        t, z = float(part.t[-1]), part.y[:, -1].copy()
        if part.status != 1:
            return hits, z
        s, c = math.sin(z[2]), math.cos(z[2])
        normal = np.array([0.0, 1.0, L / 2 * s])
        tangent = np.array([1.0, 0.0, lever * c])
        # friction opposes the slip after the impact: one of the two ways agrees with itself
        ways = []
        for way in (1.0, -1.0):
            push = np.linalg.solve(MASS, normal - MU * way * tangent)
            area = -(1.0 + EPS) * (normal @ z[3:]) / (normal @ push)
            if (tangent @ (z[3:] + push * area)) * way > 0.0:
                ways.append((area, z[3:] + push * area))
        ((area, after),) = ways
        z[3:] = after
        hits.append((t, area))


@pytest.mark.sampled(2)
@pytest.mark.parametrize("lever", [L / 2, -L / 2])
def test_against_its_equations(lever, simulate, solver):
    """With the tip on either side; on its own, the slip turns round in the first impact."""
    text = (EXAMPLES / "impacting_stick.toml").read_text(encoding="utf-8")
    assert '"l/2*cos(theta)"' in text
    if lever < 0:
        text = text.replace('"l/2*cos(theta)"', '"-l/2*cos(theta)"')
    run = hb.simulate(hb.loads(text), solver=solver)
    hits, end = motion(0.2, lever)
    assert len(hits) == 2
    found = [e for e in run.events[1:] if any(s.impulses for s in e.steps)]
    assert [e.t for e in found] == pytest.approx([t for t, _ in hits], rel=1e-6)
    areas = [max(abs(s.impulses.get("contact.e", 0.0)) for s in e.steps) for e in found]
    assert areas == pytest.approx([a for _, a in hits], rel=1e-6)
    names = ("y", "theta", "vx.f", "vy.f", "w.f")
    assert [run[n].at(0.2) for n in names] == pytest.approx(list(end[1:]), rel=1e-5)


def test_a_slip_that_turns_round():
    """At 0.1999 s Siconos prints these, with steps of 0.1 ms."""
    run = hb.simulate(hb.load(EXAMPLES / "impacting_stick.toml"))
    first = next(e for e in run.events[1:] if any(s.impulses for s in e.steps))
    assert run["vx.f"].at(first.t, side="right") == pytest.approx(-0.50374, abs=1e-5)
    found = [run[n].at(0.1999) for n in ("theta", "vx.f", "vy.f", "w.f")]
    assert found == pytest.approx([1.081570, -0.506867, -1.212274, 3.212071], rel=2e-3)
    # restitution of velocities and a slip that turns round create energy (Kane): the run says so
    assert run.audit().created > 0.0
    assert not run.audit().holds(1e-10)
    # friction opposes the slip after each impact
    for event in run.events[1:]:
        for step in event.steps:
            if "contact.e" in step.impulses:
                assert step.impulses["slip.e"] == pytest.approx(
                    MU * abs(step.impulses["contact.e"]), rel=1e-9
                )
                assert run["slip.f"].at(event.t, side="right") > 0.0
