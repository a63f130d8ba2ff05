"""Many switched branches that share one voltage, or one speed: rows stay short until its sum.

With the sum of the bus added before its branches every branch stood in every other, and a mode of
400 branches took half a second to make.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm

import hybond as hb
from hybond.engine.engine import OK, make_engine
from hybond.engine.mode.equations import mode_of
from hybond.engine.mode.rows.tableau import WIDE
from hybond.engine.tables import answered, tables_of

N = WIDE + 4
FEED, LEAST = 0.05, 1.0


def branch_names(k: int) -> tuple[str, str, str]:
    return f"R{k}", f"S{k}", f"h{k}"


def bus(n: int, *, dual: bool = False, backwards: bool = False) -> hb.Model:
    """Return RC branches behind one resistance, or with all turned into its dual, RL ones."""
    m = hb.Model("bus", domain="translational" if dual else "electrical")
    common, single = (hb.One, hb.Zero) if dual else (hb.Zero, hb.One)
    feed = hb.R(1 / FEED) if dual else hb.R(FEED)
    m.add(V=hb.Sf(1.0) if dual else hb.Se(1.0), bus=common(), feed=feed, j=single())
    m.bond("V -> j -> bus", "j -> feed")
    for k in range(n):
        r, s, h = branch_names(k)
        size = LEAST + k / n
        store = hb.I(0.01) if dual else hb.C(0.01)
        m.add(**{r: hb.R(1 / size) if dual else hb.R(size), s: store, h: single()})
        m.bond(f"{h} -> bus" if backwards else f"bus -> {h}", f"{h} -> {r}", f"{h} -> {s}")
        held = "f" if dual else "e"
        sign = "-" if backwards else ""
        rule = f"on -> off when {sign}{s}.{held} > {0.3 + 0.4 * k / n}"
        m.machine(f"w{k}", states={"on": [h], "off": []}, start="on", rules=[rule])
    return m


def stored_at_openings(n: int, order: list[int], times: list[float]) -> list[np.ndarray]:
    """Return what all branches hold at each opening, by exponentials of the matrices between."""
    share = 1.0 / (LEAST + np.arange(n) / n)
    z = np.append(np.zeros(n), 1.0)
    found = []
    for k, length in zip(order, np.diff([0.0, *times]), strict=True):
        level = np.append(share, 1.0 / FEED) / (share.sum() + 1.0 / FEED)
        a = np.zeros((n + 1, n + 1))
        a[:n] = (share / 0.01)[:, None] * level
        a[:n, :n] -= np.diag(share / 0.01)
        z = expm(a * length) @ z
        found.append(z[:n])
        share[k] = 0.0
    return found


@pytest.mark.parametrize("backwards", [False, True], ids=["to branches", "from branches"])
@pytest.mark.parametrize("dual", [False, True], ids=["one voltage", "one flow"])
def test_branches_open_where_exponentials_of_matrices_say(dual, backwards):
    run = hb.simulate(bus(N, dual=dual, backwards=backwards), 0.2)
    opened = [(e.t, int(f.machine[1:])) for e in run.events for v in e.steps for f in v.fired]
    order = [k for _, k in opened]
    assert sorted(order) == list(range(N))
    held = stored_at_openings(N, order, [t for t, _ in opened])
    closed = np.ones(N, bool)
    limits = 0.3 + 0.4 * np.arange(N) / N
    for k, z in zip(order, held, strict=True):
        assert z[k] == pytest.approx(limits[k], rel=1e-10)
        closed[k] = False
        assert np.all(z[closed] < limits[closed])


def shaft(n: int, *, kind: str) -> hb.Model:
    """Return wheels that are locked to one shaft one after the other, or capacitors to one bus."""
    wheel = kind == "wheels"
    m = hb.Model("shaft", domain="rotational" if wheel else "electrical")
    common, single, store = (hb.One, hb.Zero, hb.I) if wheel else (hb.Zero, hb.One, hb.C)
    m.add(T=hb.Se(10.0) if wheel else hb.Sf(10.0), shaft=common(), S=store(1.0))
    m.bond("T -> shaft -> S")
    for k in range(n):
        m.add(**{f"S{k}": store(0.01 + 1e-3 * k), f"c{k}": single()})
        m.bond(f"shaft -> c{k} -> S{k}")
        rules = [f"free -> locked when time > {0.1 * (k + 1) / n}"]
        m.machine(f"m{k}", states={"locked": [f"c{k}"], "free": []}, start="free", rules=rules)
    return m


@pytest.mark.parametrize("kind", ["wheels", "capacitors"])
def test_what_is_tied_to_one_shaft_moves_as_one(kind):
    run = hb.simulate(shaft(N, kind=kind), 0.15)
    last = run.final
    mass = 1.0 + sum(0.01 + 1e-3 * k for k in range(N))
    held = "f" if kind == "wheels" else "e"
    for name in ["S", "S0", f"S{N - 1}"]:
        assert last[f"{name}.{held}"] == pytest.approx(10.0 * 0.15 / mass, rel=1e-12)


def parts_met(model: hb.Model) -> int:
    """Return how often rows met unknowns still free, with each machine in its first state."""
    e = make_engine(answered(tables_of(model.flatten(), until=1.0)))
    assert mode_of(e, [0] * e.model.machines) == OK
    return e.work.power.cells + e.work.built.cells


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    "made",
    [
        bus,
        lambda n: bus(n, dual=True),
        lambda n: bus(n, backwards=True),
        lambda n: shaft(n, kind="wheels"),
    ],
    ids=["one voltage", "one flow", "from branches", "wheels"],
)
def test_twice_the_branches_are_twice_the_work_before_their_sum(made):
    assert parts_met(made(2 * N)) < 2.2 * parts_met(made(N))
