"""Dry friction in two directions between several bodies: belts, contacts, sleds, impacts."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import hybond as hb

EXAMPLES = Path(__file__).parents[2] / "examples"


def along(angle: float) -> tuple[float, float]:
    return math.cos(angle), math.sin(angle)


def states(run: hb.Result, machine: int) -> list[str]:
    own = run.graph.machines[machine]
    return [own.states[e.steps[-1].mode[machine]] for e in run.events]


@pytest.mark.slow
def test_stick_slip_on_a_belt_that_moves_obliquely() -> None:
    def belt(planar: bool) -> hb.Model:
        m = hb.Model("belt", domain="translational")
        own = dict(law="coulomb", limit=2, breakaway=3)
        c, s = along(0.4) if planar else (1.0, 0.0)
        for axis, part in (("x", c), ("y", s)) if planar else (("x", c),):
            law = own if axis == "x" else dict(law="coulomb", pair="sx")
            m.add(**{f"b{axis}": hb.Sf(0.5 * part), f"z{axis}": hb.Zero()})
            m.add(**{f"s{axis}": hb.One(**law), f"v{axis}": hb.One()})
            m.add(**{f"m{axis}": hb.I(1), f"k{axis}": hb.C(1)})
            m.bond(f"b{axis} -> z{axis} -> v{axis}", f"z{axis} -> s{axis}")
            m.bond(f"v{axis} -> m{axis}", f"v{axis} -> k{axis}")
        return m

    plane, line = (hb.simulate(belt(a), until=40, rtol=1e-10) for a in (True, False))
    assert len(plane.events) == len(line.events) > 8
    for a, b in zip(plane.events, line.events, strict=True):
        assert a.t == pytest.approx(b.t, abs=1e-7)
    c, s = along(0.4)
    for t in np.linspace(0.0, 40.0, 41):
        assert plane["mx.p"].at(t) == pytest.approx(c * line["mx.p"].at(t), abs=1e-7)
        assert plane["my.p"].at(t) == pytest.approx(s * line["mx.p"].at(t), abs=1e-7)


@pytest.mark.slow
def test_the_limit_follows_the_force_of_a_contact() -> None:
    # the table shakes, 4 < N < 20: along any line the block does what it does on one line
    def table(angle: float | None) -> hb.Model:
        m = hb.Model("table", domain="translational")
        own = dict(law="coulomb", limit="0.3*table.e", breakaway="0.4*table.e")
        m.add(table=hb.Zero(law="unilateral", gap="height"), ground=hb.Sf(0))
        m.add(mz=hb.I(2), vz=hb.One(), G=hb.Se("-12[N] + 8[N]*sin(5*time/1[s])"))
        m.bond("G -> vz -> mz", "ground -> table -> vz")
        m.signal(height=hb.Integral("vz.f"))
        c, s = (1.0, 0.0) if angle is None else along(angle)
        for axis, part in (("x", c), ("y", s)) if angle is not None else (("x", c),):
            law = own if axis == "x" else dict(law="coulomb", pair="sx")
            m.add(**{f"s{axis}": hb.One(**law), f"m{axis}": hb.I(2, f=part)})
            m.add(**{f"F{axis}": hb.Se(f"{4.0 * part}[N]*cos(time/1[s])")})
            m.bond(f"F{axis} -> s{axis} -> m{axis}")
        return m

    plane, line = (hb.simulate(table(a), until=8, rtol=1e-10) for a in (2.1, None))
    assert len(plane.events) == len(line.events) > 4
    c, s = along(2.1)
    for t in np.linspace(0.0, 8.0, 33):
        assert plane["mx.p"].at(t) == pytest.approx(c * line["mx.p"].at(t), abs=1e-7)
        assert plane["my.p"].at(t) == pytest.approx(s * line["mx.p"].at(t), abs=1e-7)


def chain(angle: float, seed: int, masses: int = 2) -> hb.Model:
    """Masses in a plane, each on the ground with friction, in a row of springs; axes turned."""
    pick = np.random.default_rng(seed)
    c, s = along(angle)

    def vector(size: float) -> tuple[float, float]:
        x, y = (size * pick.normal(size=2)).tolist()
        return c * x - s * y, s * x + c * y

    def number(low: float, high: float) -> float:
        return float(pick.uniform(low, high))

    m = hb.Model("chain", domain="translational")
    for k in range(masses):
        mass, limit, w = number(0.5, 2.0), number(0.5, 2.0), number(0.5, 2.0)
        stretch, loss = number(0.3, 2.0), number(0.05, 0.3)
        v, q, F, G, belt = (vector(a) for a in (2.0, 2.0, 2.0, 2.0, 0.4 * (seed % 2)))
        for i, axis in enumerate("xy"):
            a = f"{axis}{k}"
            law = dict(limit=limit, breakaway=1.15 * limit) if i == 0 else dict(pair=f"sx{k}")
            push = f"({F[i]!r}*sin({w}*time/1[s]) + {G[i]!r}*cos({0.7 * w}*time/1[s]))*1[N]"
            m.add(**{f"v{a}": hb.One(), f"m{a}": hb.I(mass, f=v[i]), f"F{a}": hb.Se(push)})
            m.add(**{f"b{a}": hb.Sf(belt[i]), f"z{a}": hb.Zero()})
            m.add(**{f"s{a}": hb.One(law="coulomb", **law), f"n{a}": hb.Zero()})
            m.add(**{f"d{a}": hb.One(), f"k{a}": hb.C(stretch, q=q[i]), f"r{a}": hb.R(loss)})
            m.bond(f"F{a} -> v{a}", f"v{a} -> m{a}", f"v{a} -> z{a} -> s{a}", f"b{a} -> z{a}")
            m.bond(f"v{a} -> n{a} -> d{a}", f"d{a} -> k{a}", f"d{a} -> r{a}")
            if k:
                m.bond(f"n{a} -> v{axis}{k - 1}")
    return m


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 1])
def test_turned_axes_turn_the_motion(seed: int) -> None:
    found = []
    for angle in (0.0, 0.6):
        run = hb.simulate(chain(angle, seed), until=4)
        p = np.array([[run[f"m{a}{k}.p"].at(4.0) for a in "xy"] for k in range(2)])
        c, s = along(angle)
        found.append((p @ np.array([[c, -s], [s, c]]), [e.t for e in run.events]))
        audit = run.audit()
        assert audit.power < 1e-12
        assert audit.energy < 1e-6
    for p, events in found[1:]:
        assert np.allclose(p, found[0][0], rtol=0.0, atol=5e-7)
        assert len(events) == len(found[0][1])
        assert np.allclose(events, found[0][1], rtol=0.0, atol=1e-6)


def test_two_pads_of_one_block_hold_together() -> None:
    m = hb.Model("pads", domain="translational")
    m.add(vx=hb.One(), vy=hb.One(), mx=hb.I(1, f=3), my=hb.I(1, f=4))
    for pad, limit in (("a", 1), ("b", 2)):
        m.add(**{f"{pad}x": hb.One(law="coulomb", limit=limit)})
        m.add(**{f"{pad}y": hb.One(law="coulomb", pair=f"{pad}x")})
        m.bond(f"vx -> {pad}x", f"vy -> {pad}y")
    m.bond("vx -> mx", "vy -> my")
    run = hb.simulate(m, until=3)
    assert run.events[-1].t == pytest.approx(5.0 / 3.0, rel=1e-9)
    assert run["mx.p"].at(3.0) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.slow
def test_a_sled_that_turns_while_it_slides() -> None:
    # two pads at +-0.5 on a body that does not turn far: a second derivation by hand
    m = hb.Model("sled", domain="translational")
    m.add(vx=hb.One(), vy=hb.One(), w=hb.One(domain="rotational"))
    m.add(mx=hb.I(1, f=3), my=hb.I(1, f=1), J=hb.I(0.2, f=4, domain="rotational"))
    m.bond("vx -> mx", "vy -> my", "w -> J")
    for pad, arm in (("a", 0.5), ("b", -0.5)):
        m.add(**{f"{pad}x": hb.One(law="coulomb", limit=1), f"z{pad}": hb.Zero()})
        m.add(**{f"{pad}y": hb.One(law="coulomb", pair=f"{pad}x"), f"t{pad}": hb.TF(arm)})
        m.bond(f"vx -> {pad}x", f"vy -> z{pad} -> {pad}y", f"w -> t{pad} -> z{pad}")
    run = hb.simulate(m, until=3, rtol=1e-10)

    def field(t: float, v: np.ndarray) -> list[float]:
        force, turn = np.zeros(2), 0.0
        for arm in (0.5, -0.5):
            pad = np.array([v[0], v[1] + arm * v[2]])
            pull = pad / np.linalg.norm(pad)
            force += pull
            turn += arm * pull[1]
        return [-force[0], -force[1], -turn / 0.2]

    end = 1.2
    found = solve_ivp(field, (0.0, end), [3.0, 1.0, 4.0], rtol=1e-11, atol=1e-12)
    assert run["mx.p"].at(end) == pytest.approx(found.y[0, -1], abs=1e-7)
    assert run["my.p"].at(end) == pytest.approx(found.y[1, -1], abs=1e-7)
    assert run["J.f"].at(end) == pytest.approx(found.y[2, -1], abs=1e-6)
    assert states(run, 0)[-1] == states(run, 1)[-1] == "sticks"


def test_relays_of_two_capacitors_share_a_disk() -> None:
    m = hb.Model("relay", domain="electrical")
    m.add(x=hb.Zero(law="relay", limit=1), y=hb.Zero(law="relay", pair="x"))
    m.add(cx=hb.C(1, e=3), cy=hb.C(1, e=4))
    m.bond("x -> cx", "y -> cy")
    run = hb.simulate(m, until=10)
    assert run.events[-1].t == pytest.approx(5.0, rel=1e-10)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("restitution", [0.5, None])
def test_what_is_hit_breaks_loose(restitution: float | None) -> None:
    # a ball of 1 kg at 4 m/s hits a block of 2 kg at rest: as with friction in one direction, no
    # impulse of friction
    m = hb.Model("hit", domain="translational")
    law = {} if restitution is None else {"restitution": restitution}
    m.add(sx=hb.One(law="coulomb", limit=3, breakaway=4), sy=hb.One(law="coulomb", pair="sx"))
    m.add(mx=hb.I(2), my=hb.I(2), Fy=hb.Se(1.5), vb=hb.One(), mb=hb.I(1, f=4))
    m.add(c=hb.Zero(law="unilateral", gap="gap", **law))
    m.signal(xb=hb.Integral("vb.f", -2), xs=hb.Integral("sx.f", 0), gap="xs - xb")
    m.bond("Fy -> sy -> my", "c -> sx -> mx", "vb -> mb", "vb -> c")
    run = hb.simulate(m, until=6)
    hit = run.events[1]
    assert hit.t == pytest.approx(0.5, abs=1e-9)
    eps = restitution or 0.0
    assert run["mx.f"].at(0.5, side="right") == pytest.approx(4.0 * (1.0 + eps) / 3.0, rel=1e-9)
    assert states(run, 0)[0] == "sticks"
    assert states(run, 0)[1] == "slips"
    assert states(run, 0)[-1] == "sticks"


@pytest.mark.slow
def test_the_puck_of_the_examples() -> None:
    model = hb.load(EXAMPLES / "planar_puck.toml")
    calm = hb.simulate(model, parameters={"wind": "0 N"})
    # m v' = -mu m g - b v
    m, b, limit, v = 0.16, 0.02, 0.1 * 0.16 * 9.81, math.hypot(1.2, 2.0)
    assert calm.events[-1].t == pytest.approx(m / b * math.log(1.0 + b * v / limit), abs=1e-8)
    assert calm["x"].at(6.0) / calm["y"].at(6.0) == pytest.approx(-0.6, abs=1e-10)
    windy = hb.simulate(model)
    assert states(windy, 0) == ["slips", "sticks"]
    assert windy["x"].at(6.0) > calm["x"].at(6.0) + 0.5
    assert windy.audit().energy < 1e-7
