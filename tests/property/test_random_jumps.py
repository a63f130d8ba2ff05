"""Jumps against independent formulas: projection, two-body impact, least energy."""

from __future__ import annotations

import numpy as np
import pytest
from dense_oracle import Contradiction, Dense, switching_net
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize_scalar

import hybond as hb

SETTINGS = settings(
    max_examples=60,
    derandomize=True,
    deadline=None,
    database=None,
    suppress_health_check=list(HealthCheck),
)


def own_order(run: hb.Result, net) -> list[int]:
    index = {s.path: s.index for s in run.graph.storages}
    return [index[n + (".q" if net.nodes[n][0] == "C" else ".p")] for n in net.of("C", "I")]


@given(seed=st.integers(0, 10**6), size=st.integers(2, 7), rings=st.integers(0, 2))
@SETTINGS
def test_mode_switch(seed, size, rings) -> None:
    net = switching_net(seed, size, rings=rings, sources=0.3)
    assume(net.controlled and net.on != net.later and net.of("C", "I"))
    one, two = Dense(net), Dense(net.after())
    try:
        one.check()
        two.check(1.0)
    except Contradiction:
        assume(False)
    run = hb.simulate(net.model(), until=1.4, rtol=1e-10)
    before = one.flow(one.enter(net.x0(), 0.0), 0.0, 1.0)
    after = two.enter(before, 1.0)
    order = own_order(run, net)
    event = next(e for e in run.trace.events if e.t == 1.0)
    np.testing.assert_allclose(event.before[order], before, rtol=1e-6, atol=1e-7)
    # from the package's own state before: the projection alone
    x = event.before[order]
    want = two.enter(x, 1.0)
    np.testing.assert_allclose(event.after[order], want, rtol=1e-9, atol=1e-10)
    jump = event.after[order] - x
    if two.gz.shape[0]:
        # conserved: whatever is orthogonal to the ways the structure leaves open
        u, sv, _ = np.linalg.svd(two.d) if two.d.size else (np.eye(len(x)), np.zeros(0), None)
        kept = u[:, int((sv > 1e-9).sum()) :]
        assert np.abs(kept.T @ jump).max(initial=0.0) <= 1e-11 * (1 + np.abs(x).max())
    for step in event.steps:
        if step.energy is not None and step.impulses:
            source = two.work(x, want, 1.0)
            size = 1 + two.energy(x) + abs(source)
            assert abs(step.energy.source - source) <= 1e-9 * size
            assert abs(step.energy.lost - two.energy(jump)) <= 1e-9 * size
            assert step.energy.lost >= -1e-12 * size
    end = two.flow(after, 1.0, 1.4)
    np.testing.assert_allclose(
        run.segments[-1].y[-1][order], end, rtol=1e-6, atol=1e-7 * (1 + np.abs(end).max())
    )


@given(
    m1=st.floats(0.1, 10),
    m2=st.floats(0.1, 10),
    v1=st.floats(0.5, 5),
    v2=st.floats(-5, 0.2),
    eps=st.floats(0, 1),
    way=st.integers(0, 3),
)
@SETTINGS
def test_restitution(m1, m2, v1, v2, eps, way) -> None:
    m = hb.Model("impact", domain="translational")
    m.add(
        a=hb.I(m1, f=v1 if not way & 1 else -v1),
        b=hb.I(m2, f=v2 if not way & 2 else -v2),
        s1=hb.One(),
        s2=hb.One(),
        contact=hb.Zero(),
        rebound=hb.Sf(f"-{eps!r}*pre(s1.f - s2.f)"),
    )
    m.bond(
        "s1 -> a" if not way & 1 else "a -> s1",
        "s2 -> b" if not way & 2 else "b -> s2",
        "s1 -> contact -> s2",
        "contact -> rebound",
    )
    m.signal(gap=hb.Integral("s2.f - s1.f", start="1 m"))
    m.machine(
        "pair",
        states={"apart": [], "collide": ["contact"]},
        start="apart",
        rules=[
            "apart -> collide when gap <= 0 and s1.f > s2.f",
            "collide -> apart when pre(s1.f) <= pre(s2.f)",
        ],
    )
    t = 1.0 / (v1 - v2)
    run = hb.simulate(m, until=t + 0.1)
    total, approach = m1 * v1 + m2 * v2, v1 - v2
    w1 = (total - m2 * eps * approach) / (m1 + m2)
    w2 = (total + m1 * eps * approach) / (m1 + m2)
    (event,) = (e for e in run.trace.events if e.t > 0)
    assert abs(event.t - t) <= 1e-9 * t
    size = abs(v1) + abs(v2)
    assert abs(run["s1.f"].at(t + 0.05) - w1) <= 1e-10 * size
    assert abs(run["s2.f"].at(t + 0.05) - w2) <= 1e-10 * size
    lost = 0.5 * m1 * m2 / (m1 + m2) * (1 - eps**2) * approach**2
    energies = [s.energy for s in event.steps if s.energy is not None and s.impulses]
    assert abs(sum(e.lost for e in energies) - lost) <= 1e-9 * (m1 + m2) * size**2
    assert all(e.source == 0.0 for e in energies)


@given(
    a=st.floats(0.2, 3),
    b=st.floats(0.1, 3),
    c=st.floats(0.2, 3),
    d=st.floats(0.1, 3),
    qa=st.floats(-2, 2),
    qb=st.floats(-2, 2),
    way=st.integers(0, 3),
)
@settings(SETTINGS, max_examples=30)
def test_nonlinear_c_joined_has_least_energy(a, b, c, d, qa, qb, way) -> None:
    assume(abs((a * qa + b * qa**3) - (c * qb + d * qb**3)) > 1e-6)
    m = hb.Model("joined")
    m.add(
        x=hb.C({"e": f"{a!r}*q + {b!r}*q^3"}, q=qa),
        y=hb.C({"e": f"{c!r}*q + {d!r}*q^3"}, q=qb),
        n=hb.Zero(),
        m=hb.Zero(),
        j=hb.One(),
    )
    m.bond("n -> x" if way & 1 else "x -> n", "m -> y" if way & 2 else "y -> m", "n -> j -> m")
    m.machine(
        "s", states={"open": [], "shut": ["j"]}, start="open", rules=["open -> shut when time >= 1"]
    )
    run = hb.simulate(m, until=1.5)

    def energy(q: float) -> float:
        r = qa + qb - q
        return a * q**2 / 2 + b * q**4 / 4 + c * r**2 / 2 + d * r**4 / 4

    best = minimize_scalar(energy, bounds=(-9, 9), method="bounded", options={"xatol": 1e-9})
    got = run["x.q"].at(1.2)
    assert abs(got - best.x) <= 1e-6
    assert abs(got + run["y.q"].at(1.2) - qa - qb) <= 1e-12 * (abs(qa) + abs(qb))
    assert abs(run["x.e"].at(1.2) - run["y.e"].at(1.2)) <= 1e-11 * (1 + abs(run["x.e"].at(1.2)))
    lost = sum(s.energy.lost for e in run.trace.events for s in e.steps if s.energy)
    start = energy(qa)
    assert abs(lost - (start - energy(best.x))) <= 1e-9 * (1 + start)


@pytest.mark.parametrize("way", range(4))
@pytest.mark.parametrize("junction", ["0", "1"])
def test_off_junction_destroys_what_it_must(way, junction) -> None:
    # the coil's current has nowhere to go: its flux is destroyed, the other store keeps its own
    m = hb.Model("cut")
    part = hb.I if junction == "1" else hb.C
    key = "p" if junction == "1" else "q"
    m.add(
        a=part(1.736, **{key: 0.349}),
        b=part(0.7, **{key: -0.2}),
        r=hb.R(1.3),
        j=hb.One() if junction == "1" else hb.Zero(),
    )
    m.bond("a -> j" if way & 1 else "j -> a", "b -> j" if way & 2 else "j -> b", "j -> r")
    m.machine("s", states={"on": ["j"], "off": []}, start="on", rules=["on -> off when time >= 1"])
    run = hb.simulate(m, until=2.0)
    assert run["a." + key].at(1.5) == 0.0
    assert run["b." + key].at(1.5) == 0.0
