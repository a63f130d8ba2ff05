"""Friction by a table, translational and rotational: sticking by law, sliding by the points."""

import math

import numpy as np
import pytest
from library.trials import instants, trials
from scipy.integrate import solve_ivp

import hybond as hb

KINDS = {
    "translational": ("mass", "m", "flange", "F", ("right", "left"), "force"),
    "rotational": ("inertia", "J", "shaft", "M", ("shaft", "case"), "torque"),
}
SPEEDS, VALUES = [0.1, 0.2, 0.5, 2.0, 10.0], [1.4, 1.1, 1.0, 1.2, 2.0]


def rubbed(domain: str, size: float, start: float, push: str, values: list[float]) -> tuple:
    body, quantity, flange, letter, (moves, rests), source = KINDS[domain]
    points = {f"w_{k}": w for k, w in enumerate(SPEEDS, 1)}
    points |= {f"{letter}_{k}": value for k, value in enumerate(values)}
    parts = {
        "b": hb.Submodel(f"{domain}.{body}", **{quantity: size, "vw"[domain[0] == "r"]: start}),
        "r": hb.Submodel(f"{domain}.friction_table", **points),
        "wall": hb.Submodel(f"{domain}.frame"),
        "f": hb.Submodel(f"{domain}.{source}", inputs={source: push}),
    }
    joints = f"f.{flange} -> b.{flange}, b.{flange} - r.{moves}, r.{rests} - wall.{flange}"
    return joints, parts


@pytest.mark.parametrize("domain", sorted(KINDS))
@pytest.mark.parametrize("sign", [1, -1])
def test_on_a_straight_table_it_slides_to_rest_as_dry_and_viscous_friction_do(
    domain: str, sign: int
) -> None:
    """``"translational.friction_table"`` and ``"rotational.friction_table"``, beyond the points."""
    line = [1.0] + [1.0 + 0.25 * w for w in SPEEDS]
    joints, parts = rubbed(domain, 2.0, sign * 15.0, "0", line)
    # 2*w' = -1 - w/4
    stops = 8 * math.log(1 + 15 / 4)
    for run in trials(joints, stops + 1, **parts):
        assert instants(run) == pytest.approx([stops], rel=1e-8)
        t = np.array([0.5, 3.0, 9.0])
        speed = sign * (19 * np.exp(-t / 8) - 4)
        assert run["b.speed"].at(t) == pytest.approx(speed, rel=1e-8)
        assert run["r.slip"].at(t) == pytest.approx(speed, rel=1e-8)
        name = KINDS[domain][-1]
        assert run[f"r.{name}"].at(t) == pytest.approx(sign * (1 + abs(speed) / 4))
        assert run["r.power"].at(t) == pytest.approx(abs(speed) * (1 + abs(speed) / 4))
        assert (run["r.sticks"].at(stops + 0.5), run["b.speed"].at(stops + 1)) == (1, 0)


@pytest.mark.parametrize("domain", sorted(KINDS))
def test_it_holds_up_to_breakaway_then_falls_along_the_points(domain: str) -> None:
    unit = "N" if domain == "translational" else "N*m"
    joints, parts = rubbed(domain, 2.0, 0.0, f"0.5 [{unit}/s]*time", [1.5, *VALUES])
    breaks = 3.0

    def rates(t, w):
        return [(0.5 * t - np.interp(w[0], [0, *SPEEDS], [1.5, *VALUES])) / 2]

    known = solve_ivp(rates, (breaks, 6), [0], rtol=1e-11, atol=1e-13, max_step=1e-2)
    name = KINDS[domain][-1]
    for run in trials(joints, 6.0, **parts):
        assert instants(run) == pytest.approx([breaks], rel=1e-9)
        assert run[f"r.{name}"].at(2.0) == pytest.approx(1.0)
        assert run["r.sticks"].at([2.9, 3.1]) == pytest.approx([1, 0])
        assert run["b.speed"].at(6) == pytest.approx(known.y[0, -1], rel=1e-6)
