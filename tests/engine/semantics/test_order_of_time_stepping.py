"""Time-stepping against closed forms: its order, its energy, rest, what grows without a bound."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

import hybond as hb
from hybond.engine.timestepping import theta_step

sys.path.insert(0, str(Path(__file__).parents[3] / "benchmarks"))

from order_of_steps import PROBLEMS, G, errors, stepped


@pytest.mark.sampled(2)
@pytest.mark.parametrize("theta", [0.5, 1.0])
@pytest.mark.parametrize("name", PROBLEMS)
def test_the_order_of_a_step_is_that_of_closed_forms(name: str, theta: float) -> None:
    order = PROBLEMS[name][4 if theta == 0.5 else 5]
    steps = [200, 400, 800, 1600]
    found = errors(name, theta, steps)
    slope = -np.polyfit(np.log(steps), np.log(found), 1)[0]
    if name in ("oscillator", "decay") or theta == 1.0:
        assert slope == pytest.approx(order, abs=0.25)
    # where in a step an event falls is chance: that is in the mean of some lengths
    assert slope > order - 0.35
    assert found[-1] < {1.0: 1e-2, 2.0: 4e-5}[order] * (4.0 if theta == 1.0 else 1.0)


SNUBBED = [
    # source resistance and inductance, resistors and capacitors of the snubbers, load, step
    (0.06662, 1.13e-4, (98.6, 60.8, 91.7, 144.5), (27.3, 5.3, 3.33, 40.9), 96.95, 1e-5),
    (0.1, 2e-4, (50.0, 80.0, 120.0, 60.0), (10.0, 20.0, 5.0, 2.0), 60.0, 2e-5),
    (0.02, 5e-5, (200.0, 150.0, 90.0, 75.0), (4.0, 3.0, 30.0, 12.0), 40.0, 1e-5),
    (0.2, 1e-3, (30.0, 300.0, 40.0, 500.0), (1.0, 2.0, 3.0, 4.0), 150.0, 5e-5),
]


def snubbed(R: float, L: float, r: tuple, c: tuple, load: float) -> hb.Model:
    """A bridge of ideal diodes before a resistor, an RC snubber across each of them."""
    m = hb.Model("snubbed", domain="electrical")
    m.add(V=hb.Se("167*sin(2513*time)"), Rs=hb.R(R), Ls=hb.I(L), line=hb.One())
    m.add(a=hb.Zero(), n=hb.Zero(), p=hb.Zero(), q=hb.Zero(), out=hb.One(), RL=hb.R(load))
    m.bond("V -> line", "line -> Rs", "line -> Ls", "n -> line -> a", "p -> out -> q", "out -> RL")
    for k, (one, other) in enumerate((("a", "p"), ("n", "p"), ("q", "a"), ("q", "n"))):
        m.add(**{f"d{k}": hb.One(law="diode"), f"r{k}": hb.R(0.005 + 0.0 * r[k])})
        m.add(**{f"s{k}": hb.One(), f"rq{k}": hb.R(r[k]), f"cq{k}": hb.C(c[k] * 1e-9)})
        m.bond(f"{one} -> d{k} -> {other}", f"d{k} -> r{k}")
        m.bond(f"{one} -> s{k} -> {other}", f"s{k} -> rq{k}", f"s{k} -> cq{k}")
    return m


@pytest.mark.sampled(2)
@pytest.mark.parametrize("case", SNUBBED)
def test_snubbers_do_not_let_a_current_grow_without_a_bound(case: tuple) -> None:
    """What a bridge draws is bounded by what its source can drive, with any theta and step.

    With theta = 1/2 a stiff line rings from step to step, and no more than that.
    """
    *parts, step = case
    exact = hb.simulate(snubbed(*parts), 7.5e-3, solver="exact")
    t = np.linspace(2.5e-3, 7.5e-3, 400)
    right = exact["Ls.f"].at(t)
    for theta in (0.5, 0.6, 1.0):
        for h in (step, 0.5 * step):
            found = stepped(snubbed(*parts), 7.5e-3, h, theta)["Ls.f"].at(t)
            assert np.abs(found).max() < 4.0 * np.abs(right).max()
            if theta == 1.0:
                assert np.abs(found - right).mean() < 0.03 * np.abs(right).max()


@pytest.mark.slow
def test_a_current_that_grows_all_the_same_is_told_by_the_audit(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """However far a step is off by its own account, it has made more than there was."""
    *parts, step = SNUBBED[0]
    options = {"solver": "moreau-jean", "step": 0.5 * step, "theta": 0.5, "engine": "python"}
    right = hb.simulate(snubbed(*parts), 2e-3, **options)
    assert right.audit().holds()
    monkeypatch.setattr(theta_step, "is_damped", lambda _e, _s: False)
    monkeypatch.setattr(theta_step, "is_barred", lambda _s: False)
    grown = hb.simulate(snubbed(*parts), 2e-3, **options)
    assert abs(grown.final["Ls.f"]) > 1e6 * abs(right.final["Ls.f"])
    assert grown.status != "ok" or not grown.audit().holds()


@pytest.mark.parametrize("theta", [0.5, 0.75])
def test_a_law_that_takes_hold_in_a_step_gives_next_to_no_energy(theta: float) -> None:
    """A capacitor and a coil that a diode joins and parts: without a source energy does not grow.

    In steps as long as what swings, and more: by half of it and more where laws give what they do.
    """
    for L, C, h in ((1.0, 1.0, 0.3), (0.1, 2.0, 0.5), (3.0, 0.05, 1.0), (0.01, 0.01, 0.2)):
        m = hb.Model("parted", domain="electrical")
        m.add(l=hb.I(L, f=1.0), c=hb.C(C, e=-2.0), r=hb.R(0.3), n=hb.Zero(), d=hb.One(law="diode"))
        m.bond("n -> c", "n -> l", "n -> d -> r")
        run = stepped(m, 12.0, h, theta)
        energy = [
            L * run["l.f"].at(t) ** 2 + C * run["c.e"].at(t) ** 2 for t in np.arange(0, 12, h)
        ]
        assert (np.diff(energy) <= 0.01 * energy[0]).all()
        assert max(energy) <= 1.01 * energy[0] and energy[-1] < energy[0]


def block(mu: float, half: float, high: float, J: float) -> hb.Model:
    """A block at rest on both of its corners."""
    m = hb.Model("block", domain="translational")
    m.add(mx=hb.I(1.0), my=hb.I(1.0), weight=hb.Se(-G), vx=hb.One(), vy=hb.One())
    m.add(rot=hb.I(J, domain="rotational"), w=hb.One(domain="rotational"))
    for k, side in ((1, -1.0), (2, 1.0)):
        m.add(**{f"c{k}": hb.Zero(law="unilateral", gap=f"gap{k}", restitution=0.0)})
        m.add(**{f"s{k}": hb.One(law="coulomb", limit=f"{mu}*c{k}.e", impulsive=True)})
        m.add(**{f"a{k}": hb.TF(f"{side * half}*cos(theta) + {high}*sin(theta)")})
        m.add(**{f"t{k}": hb.TF(f"{high}*cos(theta) - {side * half}*sin(theta)")})
        m.add(**{f"f{k}": hb.Zero()})
        m.bond(f"c{k} -> vy", f"c{k} -> a{k}.2", f"a{k}.1 -> w")
        m.bond(f"vx -> f{k} -> s{k}", f"w -> t{k} -> f{k}")
        m.signal(**{f"gap{k}": f"y + {side * half}*sin(theta) - {high}*cos(theta)"})
    m.bond("vx -> mx", "weight -> vy -> my", "w -> rot")
    m.signal(theta=hb.Integral("w.f"), y=hb.Integral("vy.f", start=high))
    return m


RESTS = [
    # friction, half the width and the height, inertia
    (0.3, 0.25, 0.75, 0.2083),
    (0.8, 0.5, 0.5, 0.1667),
    (0.5, 0.3, 0.9, 0.3),
    (0.4, 0.5, 1.0, 0.4),
    (1.0, 0.2, 0.2, 0.03),
    (0.6, 2.0, 1.0, 3.0),
    (0.1, 1.0, 0.2, 0.35),
    (0.9, 1.0, 0.2, 0.35),
]


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    "options", [{}, {"solver": "radau"}, {"solver": "moreau-jean", "step": 1e-3}]
)
@pytest.mark.parametrize("case", RESTS)
def test_a_block_at_rest_stays_at_rest_in_few_steps(case: tuple, options: dict) -> None:
    """Nothing moves and no energy is there to measure anything by: each foot bears its half."""
    run = hb.simulate(block(*case), until=0.1, **options)
    assert run.status == "ok" and run.stats["steps"] <= 100
    for name in ("vx.f", "vy.f", "w.f"):
        assert run[name].at(0.1) == pytest.approx(0.0, abs=1e-12)
    assert run["c1.e"].at(0.05) == pytest.approx(G / 2.0, rel=1e-9)
    assert run["c2.e"].at(0.05) == pytest.approx(G / 2.0, rel=1e-9)


@pytest.mark.parametrize("theta", [0.5, 1.0])
@pytest.mark.parametrize("parts", [(0.5,), (0.15, 0.35)])
@pytest.mark.parametrize("ratio", [3.0, -0.7, 1.0 / 3.0])
def test_what_friction_holds_behind_gears_stands_still(
    ratio: float, parts: tuple[float, ...], theta: float
) -> None:
    """Nothing has moved, to the last bit, and nothing is left that energy could be wrong by."""
    m = hb.Model("held", domain="rotational")
    m.add(T=hb.Se("5*sin(3*time)"), w=hb.One(), u=hb.One(), J=hb.I(0.2), gears=hb.TF(ratio))
    m.add(r=hb.One(law="coulomb", limit=2.0 * abs(5.0 / ratio)))
    m.bond("T -> w -> gears -> u -> r", "w -> J")
    for k, part in enumerate(parts):
        m.add(**{f"K{k}": hb.I(part)})
        m.bond(f"u -> K{k}")
    run = stepped(m, 1.0, 1e-3, theta)
    assert run.final["J.p"] == 0.0
    assert run.audit().holds()
    # what a law gives is of the step, and torque at its middle if theta is 1/2
    mean = 5.0 * np.sin(3.0 * (0.5 - 1e-3 * (1.0 - theta)))
    assert run["r.e"].at(0.5) == pytest.approx(mean / ratio, rel=1e-5)


def growing(kind: str, rate: float) -> hb.Model:
    """Return something that grows by itself as ``exp(rate t)``, passive stiff things beside it."""
    m = hb.Model("growing")
    m.add(n=hb.Zero(), c=hb.C(1e-9, e=1.0), g=hb.R(1e-3), d=hb.One(law="diode"), o=hb.Se(0.0))
    m.bond("n -> c", "n -> g", "n -> d", "o -> d")
    m.add(v=hb.One(), m=hb.I(2.0, f=1.0))
    m.bond("v -> m")
    if kind == "damper":
        m.add(r=hb.R(-2.0 * rate))
        m.bond("v -> r")
    if kind == "behind a lever":
        m.add(r=hb.R(-2.0 * rate / 9.0), t=hb.TF(3.0), u=hb.One())
        m.bond("v -> t -> u -> r")
    if kind == "spring":
        m.add(k=hb.Se(f"{2.0 * rate**2}*x"))
        m.bond("k -> v")
    if kind == "a force that reads":
        m.add(k=hb.Se(f"{2.0 * rate}*v.f + 1e-9*sin(v.f)"))
        m.bond("k -> v")
    if kind == "turned over":
        m.add(k=hb.Se(f"{2.0 * rate**2}*sin(x)"))
        m.bond("k -> v")
    m.signal(x=hb.Integral("v.f", start=1.0 / rate))
    return m


@pytest.mark.sampled(3)
@pytest.mark.parametrize("theta", [0.5, 1.0])
@pytest.mark.parametrize(
    "kind", ["damper", "behind a lever", "spring", "a force that reads", "turned over"]
)
def test_what_grows_within_a_step_is_refused_and_not_made_to_decay(kind: str, theta: float) -> None:
    """Backward Euler turns ``exp(3)`` in a step into -1/2, and nothing tells it from a decay."""
    with pytest.raises(hb.HybondError, match="HB-N310"):
        stepped(growing(kind, 3000.0), 0.1, 1e-3, theta)
    slower = stepped(growing(kind, 30.0), 0.02, 1e-4, theta)
    assert slower.status == "ok"
    assert slower.final["m.f"] == pytest.approx(np.exp(0.6), rel=2e-2)
    assert slower.audit().holds()
