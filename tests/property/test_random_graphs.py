"""Random linear and nonlinear bond graphs against a dense second engine (`dense_oracle`)."""

from __future__ import annotations

import numpy as np
import pytest
from dense_oracle import Contradiction, Dense, Net, random_net
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

import hybond as hb

SETTINGS = settings(
    max_examples=60,
    derandomize=True,
    deadline=None,
    database=None,
    suppress_health_check=list(HealthCheck),
)
END = 1.5
RTOL = 1e-9


def ports(net: Net):
    """Yield (bond, sign into the element) of the one-ports."""
    for name, (kind, _) in net.nodes.items():
        if kind in ("C", "I", "R", "G", "Se", "Sf"):
            for k, s, _ in net.ends(name):
                yield name, k, s


def bond_values(run: hb.Result, net: Net, segment, t: float) -> np.ndarray:
    """Return all efforts, then flows, in the order of the net's bonds."""
    names = [f'"{a} -> {c}".{kind}' for kind in "ef" for a, c in net.bonds]
    side = "left" if t == segment.t[-1] else "right"
    found = run.sample([t], names, side=side)
    return np.array([found[n][0] for n in names])


def state(run: hb.Result, net: Net, y: np.ndarray) -> np.ndarray:
    index = {s.path: s.index for s in run.graph.storages}
    names = [n + (".q" if net.nodes[n][0] == "C" else ".p") for n in net.of("C", "I")]
    return y[[index[n] for n in names]] if names else np.zeros(0)


def simulate_or_contradict(net: Net, dense: Dense, until: float = END, **options):
    try:
        dense.check()
    except Contradiction:
        with pytest.raises(hb.CausalityError) as caught:
            hb.simulate(net.model(), until=until, rtol=RTOL, **options)
        assert caught.value.code in ("HB-C101", "HB-C104")
        return None
    return hb.simulate(net.model(), until=until, rtol=RTOL, **options)


def audit(run: hb.Result, net: Net, dense: Dense, times: np.ndarray) -> None:
    """Laws, power balance, energy balance and bond variables at many instants."""
    segment = run.segments[0]
    nb = len(net.bonds)
    ends = list(ports(net))
    accepted = segment.t[:: max(1, len(segment.t) // len(times))]
    for t in (*accepted, segment.t[-1]):
        w = bond_values(run, net, segment, float(t))
        assert np.isfinite(w).all()
        power = sum(s * w[k] * w[nb + k] for _, k, s in ends)
        size = sum(abs(w[k] * w[nb + k]) for _, k, s in ends)
        scale = max(size, np.abs(w[:nb]).max() * np.abs(w[nb:]).max())
        assert abs(power) <= 4e-12 * (scale + 1e-3)
        # the same bond variables as the second engine at the same state, shares included
        x = state(run, net, segment.at(float(t)))
        want = dense.w(x, float(t))
        np.testing.assert_allclose(w, want, rtol=1e-8, atol=1e-8 * (1 + np.abs(want).max()))
    metered = run.energies(segment)
    energy = [
        dense.energy(state(run, net, y)) + lost - given
        for y, (given, lost) in zip(segment.y, metered, strict=True)
    ]
    gross = max(
        max(dense.energy(state(run, net, y)) for y in segment.y),
        float(np.abs(metered).max()),
        1e-12,
    )
    assert np.ptp(energy) <= 10 * RTOL * gross * len(segment.t) ** 0.5 + 1e-14


@given(seed=st.integers(0, 10**6), size=st.integers(1, 7), rings=st.integers(0, 2))
@SETTINGS
def test_linear(seed, size, rings) -> None:
    net = random_net(seed, size, rings=rings)
    check_linear(net)


def check_linear(net: Net) -> None:
    if not net.bonds:
        return
    dense = Dense(net)
    run = simulate_or_contradict(net, dense)
    if run is None:
        return
    assert run.status == "ok"
    x0 = net.x0()
    x = dense.enter(x0, 0.0)
    size = 1.0 + np.abs(x).max(initial=0.0)
    first = run.segments[0]
    np.testing.assert_allclose(state(run, net, first.y[0]), x, atol=1e-11 * size, rtol=1e-10)
    # energies of the jump
    for event in run.trace.events:
        for step in event.steps:
            if step.energy is None or not step.impulses:
                continue
            assert abs(step.energy.before - dense.energy(x0)) <= 1e-11 * (1 + dense.energy(x0))
            assert abs(step.energy.after - dense.energy(x)) <= 1e-11 * (1 + dense.energy(x))
            source = dense.work(x0, x, 0.0)
            assert abs(step.energy.source - source) <= 1e-10 * (1 + abs(source))
            # what is lost is the energy of the jump itself
            lost = dense.energy(x - x0)
            assert abs(step.energy.lost - lost) <= 1e-10 * (1 + abs(source) + lost)
    # motion
    want = dense.flow(x, 0.0, END)
    got = state(run, net, run.segments[-1].y[-1])
    np.testing.assert_allclose(got, want, rtol=1e-6, atol=1e-7 * (1 + np.abs(want).max(initial=0)))
    audit(run, net, dense, np.linspace(0.0, END, 7))


@given(seed=st.integers(0, 10**6), size=st.integers(2, 6))
@settings(SETTINGS, max_examples=40)
def test_exact_singularities(seed, size) -> None:
    # zero resistance, zero conductance, zero moduli count as structure
    check_linear(random_net(seed, size, rings=1, zero=0.3))


@given(seed=st.integers(0, 10**6), size=st.integers(2, 7))
@settings(SETTINGS, max_examples=40)
def test_order_of_elements_does_not_matter(seed, size) -> None:
    net = random_net(seed, size, rings=2, controlled=0.6, sources=0.3)
    assume(net.bonds)
    dense = Dense(net)
    try:
        dense.check()
    except Contradiction:
        assume(False)
    one = hb.simulate(net.model(), until=0.3, rtol=RTOL)
    two = hb.simulate(net.model(seed + 1), until=0.3, rtol=RTOL)
    np.testing.assert_allclose(
        state(one, net, one.segments[-1].y[-1]),
        state(two, net, two.segments[-1].y[-1]),
        rtol=1e-7,
        atol=1e-8,
    )
    for t in (0.0, 0.3):
        a = bond_values(one, net, one.segments[0], t)
        b = bond_values(two, net, two.segments[0], t)
        assert np.isfinite(a).all() and np.isfinite(b).all()
        np.testing.assert_allclose(a, b, rtol=1e-6, atol=1e-7 * (1 + np.abs(a).max()))


@given(seed=st.integers(0, 10**6), size=st.integers(1, 5), rings=st.integers(0, 1))
@settings(SETTINGS, max_examples=30)
def test_nonlinear(seed, size, rings) -> None:
    net = random_net(seed, size, rings=rings, nonlinear=0.6, controlled=0.2, sources=0.3)
    assume(net.bonds and net.of("C", "I"))
    dense = Dense(net)
    run = simulate_or_contradict(net, dense, until=0.8)
    if run is None:
        return
    x = dense.enter(net.x0(), 0.0)
    first = run.segments[0]
    np.testing.assert_allclose(state(run, net, first.y[0]), x, rtol=1e-8, atol=1e-9)
    ivp = solve_ivp(
        lambda t, a: dense.y @ dense.w(a, t), (0, 0.8), x, rtol=1e-9, atol=1e-10, method="DOP853"
    )
    got = state(run, net, run.segments[-1].y[-1])
    np.testing.assert_allclose(got, ivp.y[:, -1], rtol=2e-6, atol=2e-7)
    audit(run, net, dense, np.linspace(0.0, 0.8, 4))


@pytest.mark.parametrize("name", ["parallel C", "C across Se", "TF-coupled C"])
def test_power_balance_between_accepted_steps(name) -> None:
    # output points need not be accepted points: there, too, states must be on their constraints
    net = NAMED[name]
    run = hb.simulate(net.model(), until=END, rtol=1e-6)
    names = [f'"{a} -> {b}"' for a, b in net.bonds]
    t = np.linspace(0.01, END - 0.01, 11).tolist()
    values = run.sample(t, [f"{n}.{v}" for n in names for v in "ef"])
    terms = np.array(
        [s * values[f"{names[k]}.e"] * values[f"{names[k]}.f"] for _, k, s in ports(net)]
    )
    assert (np.abs(terms.sum(axis=0)) <= 1e-12 * np.abs(terms).sum(axis=0)).all()


# -- named degenerate structures -------------------------------------------------------------------


def named(nodes, bonds, on=(), controlled=(), start=None) -> Net:
    return Net(dict(nodes), list(bonds), list(controlled), set(on), None, start or {})


NAMED = {
    "parallel C": named(
        {"c1": ("C", 1.0), "c2": ("C", 2.0), "r": ("R", 1.0), "n": ("0", None)},
        [("n", "c1"), ("c2", "n"), ("n", "r")],
        start={"c1": 3.0, "c2": -1.0},
    ),
    "rigidly joined I": named(
        {"a": ("I", 1.0), "b": ("I", 2.0), "r": ("R", 1.0), "v": ("1", None)},
        [("a", "v"), ("v", "b"), ("r", "v")],
        start={"a": 3.0, "b": -1.0},
    ),
    "C across Se": named(
        {"c": ("C", 1.0), "s": ("Se", (1.0, 2.0, 3.0)), "n": ("0", None), "r": ("R", 2.0)},
        [("c", "n"), ("n", "s"), ("n", "r")],
        start={"c": 3.0},
    ),
    "TF-coupled C": named(
        {
            "a": ("C", 1.0),
            "b": ("C", 2.0),
            "t": ("TF", -1.5),
            "r": ("R", 1.0),
            "n": ("0", None),
            "m": ("0", None),
        },
        [("n", "a"), ("n", "t.1"), ("m", "t.2"), ("b", "m"), ("m", "r")],
        start={"a": 1.0, "b": 1.0},
    ),
    "GY-coupled C and I": named(
        {
            "a": ("C", 1.0),
            "b": ("I", 2.0),
            "g": ("GY", 1.5),
            "r": ("R", 1.0),
            "n": ("0", None),
            "m": ("1", None),
        },
        [("n", "a"), ("n", "g.1"), ("g.2", "m"), ("b", "m"), ("m", "r")],
        start={"a": 1.0, "b": 1.0},
    ),
    "algebraic loop": named(
        {
            "r1": ("R", 1.0),
            "r2": ("R", 2.0),
            "r3": ("G", 0.7),
            "r4": ("R", 0.4),
            "c": ("C", 1.0),
            "n1": ("0", None),
            "n2": ("0", None),
            "v1": ("1", None),
            "v2": ("1", None),
        },
        [
            ("c", "n1"),
            ("n1", "v1"),
            ("v1", "r1"),
            ("v1", "n2"),
            ("n2", "r2"),
            ("n1", "v2"),
            ("v2", "r4"),
            ("v2", "n2"),
            ("r3", "n2"),
        ],
        start={"c": 1.0},
    ),
    "ring 0-1-0-1": named(
        {
            "a": ("0", None),
            "b": ("1", None),
            "c": ("0", None),
            "d": ("1", None),
            "s": ("C", 1.0),
            "l": ("I", 1.0),
            "r": ("R", 1.0),
        },
        [("a", "b"), ("b", "c"), ("c", "d"), ("d", "a"), ("a", "s"), ("b", "l"), ("d", "r")],
        start={"s": 1.0, "l": 0.5},
    ),
}


def bridge(on: str) -> Net:
    """Four switches between a source and a load, the load floating when none conducts."""
    nodes = {
        "s": ("Se", (10.0, 1.0, 2.0)),
        "p": ("0", None),
        "m": ("0", None),
        "a": ("0", None),
        "b": ("0", None),
        "i": ("1", None),
        "l": ("I", 0.5),
        "r": ("R", 1.0),
        "i0": ("1", None),
        **{f"q{k}": ("1", None) for k in range(1, 5)},
    }
    bonds = [
        ("s", "i0"),
        ("i0", "p"),
        ("m", "i0"),
        ("p", "q1"),
        ("q1", "a"),
        ("p", "q2"),
        ("q2", "b"),
        ("a", "q3"),
        ("q3", "m"),
        ("b", "q4"),
        ("q4", "m"),
        ("a", "i"),
        ("i", "b"),
        ("i", "l"),
        ("i", "r"),
    ]
    return Net(nodes, bonds, ["q1", "q2", "q3", "q4"], {f"q{k}" for k in on}, None, {"l": 0.3})


@pytest.mark.parametrize("name", NAMED)
def test_named_structure(name) -> None:
    check_linear(NAMED[name])


@pytest.mark.parametrize("on", ["14", "23", "1", "12", "34", "124", "", "4", "234"])
def test_bridge(on) -> None:
    check_linear(bridge(on))


@pytest.mark.parametrize("on", ["13", "1234", "24"])
def test_bridge_shorted(on) -> None:
    with pytest.raises(hb.CausalityError) as caught:
        hb.simulate(bridge(on).model(), until=1.0)
    assert caught.value.code in ("HB-C101", "HB-C104")


@pytest.mark.parametrize("order", range(4))
def test_closed_switches_share_the_current(order) -> None:
    net = named(
        {
            "s": ("Sf", (1.0, 0.0, 1.0)),
            "a": ("0", None),
            "b": ("0", None),
            "r": ("R", 1.0),
            "q1": ("1", None),
            "q2": ("1", None),
            "q3": ("1", None),
        },
        [
            ("s", "a"),
            ("a", "q1"),
            ("q1", "b"),
            ("b", "q2"),
            ("q2", "a"),
            ("q3", "b"),
            ("a", "q3"),
            ("b", "r"),
        ],
        on=["q1", "q2", "q3"],
        controlled=["q1", "q2", "q3"],
    )
    run = hb.simulate(net.model(order), until=0.1)
    assert abs(run["q1.f"].at(0.05) - 1 / 3) < 1e-12
    assert abs(run["q2.f"].at(0.05) + 1 / 3) < 1e-12
    assert abs(run["q3.f"].at(0.05) - 1 / 3) < 1e-12
    assert abs(run["r.f"].at(0.05) - 1.0) < 1e-12
