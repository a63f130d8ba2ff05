"""Friction of several junctions on one velocity: all of it breaks loose where none can hold more.

Oracles: forces added up by hand; time-stepping, whose steps know no rules.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

import hybond as hb


def braked(*brakes: tuple[float, float], ratio: float = 1.0, way: float = 1.0) -> hb.Model:
    """A body of 1 kg that a growing force pushes; the last brake is behind a gear."""
    m = hb.Model("braked", domain="translational")
    m.add(push=hb.Se(f"{way} [N/s]*time"), body=hb.I("1 kg"), v=hb.One())
    m.bond("push -> v -> body")
    for k, (limit, breakaway) in enumerate(brakes):
        m.add(**{f"g{k}": hb.One(law="coulomb", limit=limit, breakaway=breakaway)})
        if k == len(brakes) - 1 and ratio != 1.0:
            m.add(t=hb.TF(ratio))
            m.bond(f"v -> t -> g{k}")
        else:
            m.bond(f"v -> g{k}" if k % 2 == 0 else f"g{k} -> v")
    return m


CASES = {
    "equal": (((1.0, 1.5), (1.0, 1.5)), 1.0, 3.0, 2.0),
    "three": (((1.0, 1.5), (1.0, 1.5), (0.5, 0.7)), 1.0, 3.7, 2.5),
    "different": (((1.0, 1.5), (2.0, 2.2)), 1.0, 3.7, 3.0),
    "one without breakaway": (((1.0, 1.0), (2.0, 2.5)), 1.0, 3.5, 3.0),
    "geared": (((1.0, 1.5), (1.0, 1.5)), 2.0, 4.5, 3.0),
    "geared the other way": (((1.0, 1.5), (1.0, 1.5)), -0.5, 2.25, 1.5),
}


@pytest.mark.sampled(6)
@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_brakes_on_one_body_break_loose_at_the_sum_of_what_they_hold(
    case: tuple[tuple[tuple[float, float], ...], float, float, float], way: float
) -> None:
    brakes, ratio, holds, slides = case
    run = hb.simulate(braked(*brakes, ratio=ratio, way=way), 8.0)
    assert run.events[-1].t == pytest.approx(holds, abs=1e-10)
    assert run["v.f"].at(holds) == 0.0
    # then the force less what slides: t - slides
    speed = way * 0.5 * ((8.0 - slides) ** 2 - (holds - slides) ** 2)
    assert run["v.f"].at(8.0) == pytest.approx(speed, rel=1e-9)
    assert run.audit().holds()


def test_a_motor_with_stiction_of_its_own_beside_a_brake() -> None:
    """Through a lever and two 1-junctions in a row; pulled back, it stops and holds again."""
    m = hb.Model("drive", domain="rotational")
    m.add(
        torque=hb.Se("3 [N*m]*sin(time/1 [s])"),
        rotor=hb.I("0.5 kg*m^2"),
        w=hb.One(),
        shaft=hb.One(),
    )
    m.add(stiction=hb.One(law="coulomb", limit="0.4 N*m", breakaway="0.8 N*m"))
    m.add(brake=hb.One(law="coulomb", limit="0.6 N*m", breakaway="1.0 N*m"))
    m.bond("torque -> w -> rotor", "w -> stiction", "w -> shaft -> brake")
    run = hb.simulate(m, 6.0)
    loose = math.asin(1.8 / 3.0)
    assert run.events[1].t == pytest.approx(loose, abs=1e-9)
    # 0.5 w' = 3 sin t - 1, until it rests again
    t = np.linspace(loose, 2.0, 7)
    speed = 2.0 * (3.0 * (math.cos(loose) - np.cos(t)) - (t - loose))
    assert run["w.f"].at(t) == pytest.approx(speed, abs=1e-7)
    back = next(e.t for e in run.events[2:])
    turned = 2.0 * (3.0 * (math.cos(loose) - math.cos(back)) - (back - loose))
    assert turned == pytest.approx(0.0, abs=1e-7)


def test_time_stepping_lets_go_at_the_same_force() -> None:
    for brakes, ratio, holds, _ in (CASES["different"], CASES["geared"]):
        run = hb.simulate(braked(*brakes, ratio=ratio), 8.0, solver="moreau-jean", step=1e-3)
        assert run["v.f"].at(holds - 0.01) == pytest.approx(0.0, abs=1e-12)
        assert float(run["v.f"].at(holds + 0.02)) > 1e-3


def test_what_else_happens_at_rest_loosens_nothing() -> None:
    """At 2.8 s another machine fires: forces are asked for anew, and the brakes hold up to 3 N."""
    m = braked((1.0, 1.5), (1.0, 1.5))
    m.machine("other", states={"a": [], "b": []}, start="a", rules=["a -> b when time >= 2.8"])
    run = hb.simulate(m, 4.0)
    assert [e.t for e in run.events] == pytest.approx([0.0, 2.8, 3.0], abs=1e-10)
