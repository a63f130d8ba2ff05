"""Shares that a step leaves open, against enumeration; laws that act on nothing; exact balances."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from passive_nets import network

import hybond as hb
from hybond.engine.algebra.blocks import fit
from hybond.engine.algebra.svd import make_svd
from hybond.engine.complementarity.least_shares import least_shares, make_shares


def stepped(model: hb.Model, until: float, h: float, **options: object) -> hb.Result:
    return hb.simulate(model, until, solver="moreau-jean", step=h, **options)


def warned(run: hb.Result) -> list[str]:
    return [w for w in run.warnings if "share what they carry" in w]


# -- shares


def nearest(l, basis, low, high):
    """The least-norm point of ``l + basis t`` in a box, every set of active bounds tried."""
    best = None
    ends = zip(low, high, strict=True)
    sides = [[0, *(s for s, b in ((-1, a), (1, z)) if np.isfinite(b))] for a, z in ends]
    for pattern in itertools.product(*sides):
        rows = [k for k, s in enumerate(pattern) if s]
        bounds = np.array([low[k] if pattern[k] < 0 else high[k] for k in rows])
        # minimise |l + B t|^2 with B[rows] t = bounds - l[rows], by the KKT system
        r, n = len(rows), basis.shape[1]
        kkt = np.block([[basis.T @ basis, basis[rows].T], [basis[rows], np.zeros((r, r))]])
        right = np.concatenate([-basis.T @ l, bounds - l[rows]])
        t, *_ = np.linalg.lstsq(kkt, right, rcond=None)
        if np.abs(kkt @ t - right).max(initial=0.0) > 1e-9:
            continue
        z = l + basis @ t[:n]
        if (
            (z >= low - 1e-9).all()
            and (z <= high + 1e-9).all()
            and (best is None or z @ z < best @ best)
        ):
            best = z
    return best


def shares(l, basis, low, high):
    """The shares that the engine's own text finds, and which of them were open."""
    n, many = basis.shape
    x = make_shares()
    blocks = ((x.values, l), (x.low, low), (x.high, high), (x.basis, basis.ravel()))
    for block, numbers in blocks:
        fit(block, len(numbers))
        block.at[: len(numbers)] = np.asarray(numbers, dtype=float).tolist()
    fit(x.rows, 1)
    fit(x.flows, 1)
    least_shares(make_svd(2 * n, 2 * n), n, many, 0, x)
    return np.array(x.values.at[:n]), [k for k in range(n) if x.open.at[k]]


@settings(max_examples=60)
@given(st.integers(0, 10_000))
def test_shares_are_the_least_of_all(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n, k = int(rng.integers(2, 6)), int(rng.integers(1, 3))
    basis = rng.integers(-2, 3, (n, k)).astype(float)
    basis = basis[:, np.abs(basis).max(axis=0) > 0]
    if basis.shape[1] and np.linalg.matrix_rank(basis) < basis.shape[1]:
        basis = basis[:, :1]
    l = np.where(rng.random(n) < 0.3, 0.0, rng.uniform(0.0, 3.0, n))
    low = np.where(rng.random(n) < 0.2, l, 0.0)
    high = np.where(
        low == l, l, np.where(rng.random(n) < 0.3, l + rng.uniform(0.0, 1.0, n), np.inf)
    )
    high = np.where((low < l) | (rng.random(n) < 0.7), high, np.inf)
    got, open_ = shares(l, basis, low, high)
    want = nearest(l, basis, low, high)
    assert got == pytest.approx(want, abs=1e-8)
    assert {int(j) for j in np.flatnonzero(np.abs(got - l) > 1e-8)} <= set(open_)


def parallel(count: int, source: str = "5*sin(2*time)") -> hb.Model:
    m = hb.Model("parallel", domain="electrical")
    m.add(V=hb.Se(source), a=hb.Zero(), b=hb.Zero(), load=hb.R(1.0))
    for k in range(count):
        m.add(**{f"d{k}": hb.One(law="diode")})
        m.bond(f"a -> d{k} -> b")
    m.bond("V -> a", "b -> load")
    return m


@pytest.mark.sampled(1)
@pytest.mark.parametrize("count", [2, 3])
def test_diodes_in_parallel_share_alike_as_they_do_between_located_events(count: int) -> None:
    run = stepped(parallel(count), 7.0, 0.01, theta=1.0)
    located = hb.simulate(parallel(count), 7.0)
    for t in (0.5, 1.0, 3.5, 4.0, 6.6):
        i = 5.0 * np.sin(2.0 * t)
        for k in range(count):
            assert float(run[f"d{k}.f"].at(t)) == pytest.approx(max(i, 0.0) / count, abs=1e-9)
            assert float(located[f"d{k}.f"].at(t)) == pytest.approx(max(i, 0.0) / count, abs=1e-6)
    (warning,) = warned(run)
    assert "d0, d1" in warning and "least leakage" in warning
    assert any("least leakage" in w for w in located.warnings)


def test_diodes_in_series_share_what_they_block() -> None:
    m = hb.Model("series", domain="electrical")
    m.add(V=hb.Se("5*sin(2*time)"), n=hb.Zero(), k=hb.Zero(), g=hb.Zero(), r=hb.R(1.0))
    m.add(d1=hb.One(law="diode"), d2=hb.One(law="diode"))
    m.bond("V -> n -> d1 -> k -> d2 -> g -> r")
    run = stepped(m, 3.0, 0.01, theta=1.0)
    for name in ("d1.e", "d2.e"):
        assert float(run[name].at(2.0)) == pytest.approx(2.5 * np.sin(4.0), abs=1e-9)
    assert float(run["d1.f"].at(0.5)) == pytest.approx(5.0 * np.sin(1.0), abs=1e-9)


@pytest.mark.parametrize("start", [1.0, -1.0])
def test_a_diode_beside_a_closed_switch_is_left_alone(start: float) -> None:
    """Nothing decides its current once the switch is closed; it does not take any up."""
    m = hb.Model("beside", domain="electrical")
    m.add(J=hb.Sf(f"if time < 0.5 then {start} else 1"), a=hb.Zero(), r=hb.R(1.0))
    m.add(d=hb.One(law="diode"), s=hb.One())
    m.bond("J -> a", "a -> d", "a -> s", "a -> r")
    m.machine("S", states={"open": [], "closed": ["s"]}, start="open",
              rules=["open -> closed when time >= 0.25"])  # fmt: skip
    for run in (stepped(m, 1.0, 0.01, theta=1.0), hb.simulate(m, 1.0)):
        assert float(run["d.f"].at(0.1)) == pytest.approx(max(start, 0.0), abs=1e-12)
        assert float(run["d.f"].at(0.9)) == pytest.approx(0.0, abs=1e-12)
        assert float(run["s.f"].at(0.9)) == pytest.approx(1.0, abs=1e-12)
        assert not warned(run)


LEGS = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)]


def table(x: float, y: float) -> hb.Model:
    """A square table of 2 kg on four rigid legs, its load of 20 N at (x, y)."""
    m = hb.Model("table")
    m.add(down=hb.One(), tilt=hb.One(), roll=hb.One())
    m.add(mass=hb.I(2.0), Jx=hb.I(0.5), Jy=hb.I(0.5))
    m.add(weight=hb.Se(-20.0), tx=hb.Se(-20.0 * x), ty=hb.Se(-20.0 * y))
    m.bond("weight -> down -> mass", "tx -> tilt -> Jx", "ty -> roll -> Jy")
    for k, (a, b) in enumerate(LEGS):
        # the tip moves at v + a tilt' + b roll'
        m.add(**{f"leg{k}": hb.Zero(law="unilateral", gap=f"gap{k}", restitution=0.0)})
        m.add(**{f"x{k}": hb.TF(a), f"y{k}": hb.TF(b)})
        m.bond(f"leg{k} -> down", f"leg{k} -> x{k}.2", f"x{k}.1 -> tilt")
        m.bond(f"leg{k} -> y{k}.2", f"y{k}.1 -> roll")
        tip = f"down.f + {a}*tilt.f + {b}*roll.f"
        m.signal(**{f"gap{k}": hb.Integral(tip, start=0.0)})
    return m


def least_on_legs(x: float, y: float) -> np.ndarray:
    """The least sum of squares of what carries the load: every set of legs tried."""
    arms = np.array([[1.0, a, b] for a, b in LEGS]).T
    best = None
    for r in range(1, 5):
        for legs in itertools.combinations(range(4), r):
            force = np.zeros(4)
            force[list(legs)] = np.linalg.lstsq(arms[:, legs], [20.0, 20.0 * x, 20.0 * y])[0]
            holds = np.abs(arms @ force - [20.0, 20.0 * x, 20.0 * y]).max() < 1e-9
            if holds and (force > -1e-9).all() and (best is None or force @ force < best @ best):
                best = force
    assert best is not None
    return best


@pytest.mark.sampled(3)
@pytest.mark.parametrize(("x", "y"), [(0.0, 0.0), (0.3, 0.1), (0.5, 0.45), (0.7, -0.25)])
def test_a_table_on_four_legs(x: float, y: float) -> None:
    run = stepped(table(x, y), 0.5, 0.01)
    want = least_on_legs(x, y)
    got = [float(run[f"leg{k}.e"].at(0.4)) for k in range(4)]
    assert got == pytest.approx(want, abs=1e-8)
    assert float(run["down.f"].at(0.4)) == pytest.approx(0.0, abs=1e-12)
    (warning,) = warned(run)
    assert "leg0, leg1, leg2, leg3" in warning


def test_three_legs_have_one_answer_and_no_warning() -> None:
    m = parallel(1)
    assert not warned(stepped(m, 3.0, 0.01))


# -- laws that act on nothing


ISOLATED = """
hybond = 1
name = "net"
domain = "electrical"

[elements]
n1 = { junction = 0 }
n2 = { junction = 0 }
n3 = { junction = 0 }
b0 = { junction = 1 }
C0 = { C = 1.529, e = 1.73 }
L0 = { I = 2.672, f = 1.79 }
b1 = { junction = 1, law = "diode" }
R1 = { R = 2.104 }
b2 = { junction = 1, law = "diode" }
R2 = { R = 3.117 }
b3 = { junction = 1 }
C3 = { C = 2.174, e = 1.94 }
L3 = { I = 0.708, f = -0.29 }
b4 = { junction = 1 }

[graph]
bonds = [
  "n1 -> b0", "C0 -> b0", "L0 -> b0", "n2 -> b1 -> n1", "b1 -> R1", "n3 -> b2 -> n1", "R2 -> b2",
  "b3 -> n2", "b3 -> C3", "b3 -> L3", "n2 -> b4 -> n3",
]

[machines.S4]
states = { open = [], closed = ["b4"] }
start = "open"
rules = [
  "open -> closed when time >= 0.32 and time < 1.61",
  "closed -> open when time < 0.32 or time >= 1.61",
]
"""


@pytest.mark.sampled(2)
@pytest.mark.parametrize("h", [0.02, 0.01, 0.005])
@pytest.mark.parametrize("theta", [0.5, 1.0])
def test_a_diode_between_coils_that_decide_without_it_is_no_problem(h: float, theta: float) -> None:
    """While S4 is open, n3 has nothing but the second diode: its current is zero or rounding."""
    run = stepped(hb.loads(ISOLATED), 2.0, h, theta=theta)
    assert run.status == "ok"
    located = hb.simulate(hb.loads(ISOLATED), 2.0, rtol=1e-9)
    names = [s.path for s in run.graph.storages]
    apart = max(abs(run.final[n] - located.final[n]) for n in names)
    assert apart < 2.0 * h


# -- random networks


def conditions(run: hb.Result) -> float:
    """The worst violation of a diode's law at the end of a step, relative to the run."""
    worst = 0.0
    for machine in run.graph.machines:
        if machine.law is None:
            continue
        found = run.table([f"{machine.path}.f", f"{machine.path}.e"])
        last = np.append(np.diff(found["t"]) != 0.0, True)
        last[0] = False
        f, e = found[f"{machine.path}.f"][last], found[f"{machine.path}.e"][last]
        fs, es = max(1.0, np.abs(f).max()), max(1.0, np.abs(e).max())
        worst = max(worst, -f.min() / fs, e.max() / es, np.abs(f * e).max() / fs / es)
    return worst


@pytest.mark.slow
@settings(max_examples=12)
@given(st.integers(0, 2000), st.booleans(), st.sampled_from([0.5, 0.7, 1.0]))
def test_random_networks_keep_their_laws_and_balances(
    seed: int, sources: bool, theta: float
) -> None:
    run = stepped(network(seed, sources=sources), 1.0, 0.02, theta=theta)
    assert conditions(run) < 1e-8
    audit = run.audit()
    # the balance of the scheme is exact, whatever its theta and however long its steps
    assert audit.power <= 1e-12 and audit.energy <= 1e-11
    if theta == 1.0 and not sources:
        assert audit.created <= 1e-11


@pytest.mark.slow
def test_a_network_that_rounding_once_refused() -> None:
    for h in (0.02, 0.01):
        assert stepped(network(2, sources=True), 2.0, h, theta=1.0).status == "ok"


# -- balances


def relay() -> hb.Model:
    m = hb.Model("relay", domain="electrical")
    m.add(i=hb.Sf("sin(3 [rad/s]*time)*1 [A]"), z=hb.Zero(law="relay", limit="0.3 A"))
    m.add(c=hb.C(1.0, e=0.5))
    m.bond("i -> z -> c")
    return m


def smoothed() -> hb.Model:
    m = hb.Model("smoothed", domain="electrical")
    m.add(V=hb.Se("10*sin(6*time)"), d=hb.One(law="diode"), n=hb.Zero(), s=hb.R(0.1))
    m.add(c=hb.C(0.1), r=hb.R(2.0))
    m.bond("V -> d -> n", "d -> s", "n -> c", "n -> r")
    return m


@pytest.mark.sampled(1)
@pytest.mark.parametrize("theta", [0.5, 0.6, 1.0])
@pytest.mark.parametrize("make", [relay, smoothed])
def test_first_order_is_no_imbalance(make, theta: float) -> None:
    audits = [stepped(make(), 5.0, h, theta=theta).audit() for h in (0.01, 0.0025)]
    for audit in audits:
        assert audit.power <= 1e-12 and audit.energy <= 1e-12 and audit.holds()
        # a law that takes hold gives next to nothing, and with theta 1 nothing
        assert audit.created <= (1e-12 if theta == 1.0 else 1e-4)


def test_energy_from_nowhere_is_found() -> None:
    """The audit fails a run whose steps stored what nothing gave them."""
    run = stepped(smoothed(), 1.0, 0.01)
    assert run.audit().holds()
    run.trace.stats["energy_unbalanced"] += 1.0
    assert not run.audit().holds()
