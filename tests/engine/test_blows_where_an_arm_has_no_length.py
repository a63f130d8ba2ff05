"""Pendulums of two masses each, by cosine and sine, that strike where one of the sines is zero."""

from __future__ import annotations

import math
import random

import pytest

import hybond as hb

M1, M2 = 0.9, 0.5


def pendulums(seed: int | None, eps: float, *, at: float, gravity: float = 0.0) -> hb.Model:
    """Two point masses on unit rods; the first comes at 1 rad/s to the second, at rest at `at`."""
    m = hb.Model("pendulums", domain="generic")
    q = at - 0.5
    parts = {
        "wa": hb.One(),
        "wb": hb.One(),
        "c": hb.Zero(law="unilateral", gap="b - a", restitution=eps),
    }
    for k, (body, arm, mass, speed) in enumerate(
        [
            ("a", "cos", M1, math.cos(q)),
            ("a", "sin", M1, math.sin(q)),
            ("b", "cos", M2, 0.0),
            ("b", "sin", M2, 0.0),
        ]
    ):
        parts[f"v{k}"] = hb.One()
        parts[f"i{k}"] = hb.I(mass, f=speed)
        parts[f"t{k}"] = hb.TF(f"{arm}({body})")
        if arm == "sin" and gravity:
            parts[f"w{k}"] = hb.Se(-gravity * mass)
    bonds = [f"w{'ab'[k // 2]} -> t{k} -> v{k} -> i{k}" for k in range(4)] + ["wa -> c -> wb"]
    bonds += [f"w{k} -> v{k}" for k in range(4) if f"w{k}" in parts]
    names = list(parts)
    if seed is not None:
        random.Random(seed).shuffle(names)
        random.Random(seed).shuffle(bonds)
    m.add(**{name: parts[name] for name in names})
    m.bond(*bonds)
    m.signal(a=hb.Integral("wa.f", q), b=hb.Integral("wb.f", at))
    return m


@pytest.mark.sampled(2)
@pytest.mark.parametrize("solver", ["auto", "radau", "rk45"])
@pytest.mark.parametrize("at", [0.0, math.pi / 2, math.pi, 0.3])
@pytest.mark.parametrize("eps", [1.0, 0.5, 0.0])
def test_a_blow_does_not_depend_on_the_order_of_elements(
    solver: str, at: float, eps: float
) -> None:
    """One order in three went through each other: rounding was measured through the short arm."""
    after_a = (M1 - eps * M2) / (M1 + M2)
    after_b = (1.0 + eps) * M1 / (M1 + M2)
    for seed in [None, *range(8)]:
        run = hb.simulate(pendulums(seed, eps, at=at), 0.9, solver=solver)
        assert run.events.t[1] == pytest.approx(0.5, abs=1e-6)
        assert run["wa.f"].at(0.8) == pytest.approx(after_a, rel=1e-6)
        assert run["wb.f"].at(0.8) == pytest.approx(after_b, rel=1e-6)
        assert run["b"].at(0.9) == pytest.approx(at + 0.4 * after_b, abs=1e-6)


@pytest.mark.parametrize("seed", range(6))
def test_energy_tells_the_blow_of_a_pendulum_that_falls(seed: int) -> None:
    """The rods are up to the left and right of their hinges, and gravity pulls along the sines."""
    g = 9.81
    run = hb.simulate(pendulums(seed, 1.0, at=0.0, gravity=g), 2.0, rtol=1e-10)
    t = run.events.t[1]
    before = run["wa.f"].at(t, side="left")
    a, b = (run[name].at(t) for name in ("a", "b"))
    assert a == pytest.approx(b, abs=1e-8)
    # each starts with its own energy: a at the angle -0.5 with 1 rad/s, b at zero without speed;
    # the height of a rod is the integral of sin(q) q', so 1 - cos(q)
    for name, speed, q0 in (("wa.f", 1.0, -0.5), ("wb.f", 0.0, 0.0)):
        now = run[name].at(t, side="left")
        q = a if name == "wa.f" else b
        fell = g * (math.cos(q) - math.cos(q0))
        assert 0.5 * now**2 == pytest.approx(0.5 * speed**2 + fell, rel=1e-7)
    after = run["wb.f"].at(t)
    assert after == pytest.approx(2.0 * M1 / (M1 + M2) * before, rel=1e-7)
