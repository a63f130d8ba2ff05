"""Cockcroft-Walton ladders: sources and capacitors joined by ideal diodes, and nothing else."""

import functools
import math

import numpy as np
import pytest

import hybond as hb

V, FREQ, C = 100.0, 50.0, 1e-6
PERIOD = 1.0 / FREQ
RTOL = 1e-8


def ladder(diodes: int) -> hb.Model:
    """Diode k leads from node k-1 to node k, capacitor k lies between nodes k-2 and k.

    Node 0 is ground, and node -1 the source.
    """
    m = hb.Model("ladder", domain="electrical")
    m.add(V=hb.Se(f"{V}*sin({2.0 * math.pi * FREQ}*time)"), n_1=hb.Zero())
    m.bond("V -> n_1")
    for k in range(1, diodes + 1):
        below = "n_1" if k == 1 else f"n{k - 2}"
        m.add(**{f"n{k}": hb.Zero(), f"C{k}": hb.C(C), f"d{k}": hb.One(law="diode")})
        m.bond(f"n{k - 1} -> d{k} -> n{k}" if k > 1 else "d1 -> n1")
        if k == 2:
            m.bond("n2 -> C2")
        else:
            m.add(**{f"c{k}": hb.One()})
            m.bond(f"n{k} -> c{k} -> {below}", f"c{k} -> C{k}")
    return m


@functools.cache
def run_of(diodes: int, periods: float) -> hb.Result:
    return hb.simulate(ladder(diodes), until=periods * PERIOD, rtol=RTOL)


def source(t):
    return V * np.sin(2.0 * np.pi * FREQ * np.asarray(t))


class Matrices:
    """Charges by Kirchhoff: capacitor k loses and gains what the diodes carry."""

    def __init__(self, n: int) -> None:
        # node voltage: what its column of capacitors adds up to, over the source or ground
        self.stack = np.zeros((n, n))
        for k in range(1, n + 1):
            self.stack[k - 1, range(k - 1, -1, -2)] = 1.0
        self.drive = np.array([1.0 if k % 2 else 0.0 for k in range(1, n + 1)])
        # a diode brings its charge into node k and takes it from node k-1
        inject = np.eye(n) - np.eye(n, k=1)
        self.charge = self.stack.T @ inject

    def blocking(self, q, t):
        """What the diodes block: the voltage of their head minus that of their tail."""
        node = self.stack @ (q / C) + np.outer(self.drive, source(t)).reshape(-1)
        return np.diff(node, prepend=0.0)


def pivoted(G, w, active):
    """Solve ``0 <= c | w + G c >= 0`` for positive definite G by exchanging pairs.

    All that are wrong at once, as long as that works; then the last of them alone, which ends
    (Murty 1974).
    """
    for k in range(1000):
        c = np.zeros(len(w))
        c[active] = np.linalg.solve(G[np.ix_(active, active)], -w[active])
        wrong = np.where(active, c < -1e-13, w + G @ c < -1e-13)
        if not wrong.any():
            return c, active
        if k >= 10:
            wrong[: np.flatnonzero(wrong)[-1]] = False
        active = active ^ wrong
    raise AssertionError("the oracle found no solution")


@functools.cache
def swept(n: int, periods: float, steps: int) -> np.ndarray:
    """Charges at the end by implicit steps of a fixed length."""
    matrices = Matrices(n)
    G = matrices.charge.T @ matrices.charge
    q, active = np.zeros(n), np.zeros(n, dtype=bool)
    for t in np.linspace(0.0, periods * PERIOD, round(periods * steps) + 1)[1:]:
        passed, active = pivoted(G, matrices.blocking(q, t) / V, active)
        q = q + C * V * matrices.charge @ passed
    return q


def sampled(run: hb.Result, n: int, points: int = 500) -> dict[str, np.ndarray]:
    t = np.linspace(0.0, run.t_end, points)
    names = [
        f"{a}{k}.{b}" for k in range(1, n + 1) for a, b in (("d", "f"), ("d", "e"), ("n", "e"))
    ]
    return run.sample(t.tolist(), names + [f"C{k}.q" for k in range(1, n + 1)])


SIZES = [(4, 6.0), (10, 3.0), (20, 3.0)]


@pytest.mark.sampled(1)
@pytest.mark.parametrize(("n", "periods"), SIZES)
def test_each_diode_conducts_or_blocks(n, periods):
    run = run_of(n, periods)
    assert run.status == "ok"
    found = sampled(run, n)
    current = 2.0 * math.pi * FREQ * V * C  # through one capacitor
    for k in range(1, n + 1):
        f, e = found[f"d{k}.f"], found[f"d{k}.e"]
        assert f.min() >= -1e-6 * current
        assert e.max() <= 1e-6 * V
        assert np.abs(f * e).max() <= 1e-9 * current * V
    # nothing trivial: the first diodes do both
    assert found["d1.f"].max() > 0.1 * current
    assert found["d1.e"].min() < -V


@pytest.mark.sampled(1)
@pytest.mark.parametrize(("n", "periods"), SIZES)
def test_charges_are_those_of_a_small_step_method(n, periods):
    run = run_of(n, periods)
    want, finer = swept(n, periods, 400), swept(n, periods, 800)
    assert want == pytest.approx(finer, abs=1e-9 * C * V)
    got = [run[f"C{k}.q"].at(run.t_end) for k in range(1, n + 1)]
    assert got == pytest.approx(finer, abs=1e-9 * C * V)


@pytest.mark.sampled(1)
@pytest.mark.parametrize(("n", "periods"), SIZES)
def test_charge_only_climbs(n, periods):
    """What the capacitors hold is what each diode has passed on, and none ever takes it back."""
    run = run_of(n, periods)
    found = sampled(run, n)
    held = np.array([found[f"C{k}.q"] for k in range(1, n + 1)])
    passed = np.linalg.solve(Matrices(n).charge, held)
    assert np.diff(passed, axis=1).min() >= -1e-9 * C * V
    assert passed[:, -1].min() >= -1e-9 * C * V
    assert passed[0, -1] > C * V


def test_charge_is_conserved():
    m = ladder(4)
    m.signal(**{f"passed{k}": hb.Integral(f"d{k}.f") for k in range(1, 5)})
    run = hb.simulate(m, until=PERIOD)
    for t in np.linspace(0.1, 1.0, 7) * run.t_end:
        passed = [run[f"passed{k}"].at(t) for k in range(1, 5)]
        held = [run[f"C{k}.q"].at(t) for k in range(1, 5)]
        assert held == pytest.approx(Matrices(4).charge @ passed, abs=1e-6 * C * V)


@pytest.mark.parametrize(("n", "periods"), SIZES)
def test_energy_is_never_created(n, periods):
    run = run_of(n, periods)
    assert run.audit().holds(10.0 * RTOL)
    for event in run.events:
        for step in event.steps:
            if step.energy is not None and step.kind != "mythical":
                assert step.energy.lost >= -1e-12 * C * V**2
    # no resistor: the ladder stands without a leak
    assert not [node for node in run.graph.nodes if node.kind in ("R", "G")]


@pytest.mark.parametrize("diodes", [2, 4])
def test_without_load_the_output_climbs_to_its_closed_form(diodes):
    """Each diode adds the peak of the source; nothing leaks, so that n2 and n4 only climb."""
    run = run_of(diodes, 20.0)
    top = np.array([run[f"n{diodes}.e"].at(k * PERIOD) for k in range(1, 21)])
    assert (np.diff(top) >= -1e-9 * V).all()
    assert (top <= diodes * V * (1.0 + 1e-9)).all()
    # what is lacking shrinks by the same part in each period: the limit of the last three
    one, two, three = top[-3:]
    limit = three - (three - two) ** 2 / ((three - two) - (two - one)) if three > two else three
    assert limit == pytest.approx(diodes * V, rel=1e-4)
    # the first capacitor holds the peak of the source
    assert run["C1.e"].at(run.t_end) == pytest.approx(V, rel=1e-6)


@pytest.mark.slow
def test_load_takes_its_charge_from_the_ladder():
    """With a load the output ripples, and droops as a small-step method finds it."""
    resistance, periods, steps = 1e5, 4, 4000
    m = ladder(4)
    m.add(R=hb.R(resistance))
    m.bond("n4 -> R")
    run = hb.simulate(m, until=periods * PERIOD)
    matrices = Matrices(4)
    G = matrices.charge.T @ matrices.charge
    q, active, top = np.zeros(4), np.zeros(4, dtype=bool), []
    times = np.linspace(0.0, periods * PERIOD, periods * steps + 1)
    for t in times[1:]:
        # the load leaves node 4, which is what capacitors 4 and 2 give
        node = (q[3] + q[1]) / C
        q = q - np.array([0.0, 1.0, 0.0, 1.0]) * node / resistance * (times[1] - times[0])
        passed, active = pivoted(G, matrices.blocking(q, t) / V, active)
        q = q + C * V * matrices.charge @ passed
        top.append((q[3] + q[1]) / C)
    got = run["n4.e"].at(times[1::40].tolist())
    assert got == pytest.approx(top[::40], abs=2e-3 * max(top))
    last = run["n4.e"].at(np.linspace((periods - 1) * PERIOD, periods * PERIOD, 101).tolist())
    assert np.ptp(last) > 0.05 * V


def test_example_is_the_ladder_of_four(simulate):
    run = simulate("cockcroft_walton")
    want = swept(4, 10.0, 400)
    got = [run[f"C{k}.q"].at(0.2) for k in range(1, 5)]
    assert got == pytest.approx(want, abs=1e-6 * C * V)


@pytest.mark.slow
def test_goes_on_where_the_ladder_is_full_but_for_rounding():
    """Every capacitor holds its limit to the last digits, and the diodes still decide."""
    run = run_of(4, 200.0)
    assert run.status == "ok" and run.t_end == pytest.approx(200.0 * PERIOD)
    full = [run[f"C{k}.e"].at(run.t_end) for k in range(1, 5)]
    assert full == pytest.approx([V, 2.0 * V, 2.0 * V, 2.0 * V], rel=1e-10)
