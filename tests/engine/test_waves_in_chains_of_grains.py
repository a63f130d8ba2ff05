"""A wave in a row of grains: what is ahead of it begins to move from nothing, by a high power.

What is stored there is next to nothing for long, and no step is short beside how it grows. Implicit
steps crept there, or underflowed.
"""

from __future__ import annotations

import pytest

import hybond as hb


def grains(many: int, law: str) -> hb.Model:
    """Return so many of 1 kg, the first with 1 m/s, and what is between two of them."""
    m = hb.Model("grains")
    for i in range(many):
        m.add({f"m{i}": hb.I(1.0, f=1.0 if i == 0 else 0.0), f"v{i}": hb.One()})
        m.bond(f"v{i} -> m{i}")
    for i in range(1, many):
        m.add({f"z{i}": hb.Zero(), f"h{i}": hb.C({"e": law})})
        m.bond(f"v{i - 1} -> z{i} -> v{i}", f"z{i} -> h{i}")
    return m


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("many", "law", "most"),
    [
        (3, "1e6*max(q, 0)^2", 1500),
        (5, "1e6*max(q, 0)^1.5", 3000),
        (8, "1e9*max(q, 0)^1.5", 5000),
        (4, "1e6*q^3", 4000),
        (5, "1e6*q^3", 4000),
    ],
)
def test_implicit_steps_follow_it(many: int, law: str, most: int) -> None:
    """Momentum and energy are what they were; explicit steps are another method."""
    run = hb.simulate(grains(many, law), until=0.05, solver="radau")
    other = hb.simulate(grains(many, law), until=0.05, solver="rk45")
    speeds = [run[f"m{i}.f"].at(0.05) for i in range(many)]
    assert sum(speeds) == pytest.approx(1.0, rel=1e-9)
    for i, speed in enumerate(speeds):
        assert speed == pytest.approx(other[f"m{i}.f"].at(0.05), abs=1e-6)
    assert run.audit().energy < 1e-8
    assert run.stats["steps"] < most
