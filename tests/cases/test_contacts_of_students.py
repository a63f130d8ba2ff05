"""Contacts, friction and impacts as exercises have them, each against its closed form."""

from __future__ import annotations

import math

import pytest

import hybond as hb

G = 9.81


@pytest.mark.parametrize(("speed", "spin"), [(6.0, 0.0), (2.0, -80.0), (2.0, 80.0)])
@pytest.mark.parametrize("turned", [False, True])
def test_a_ball_slides_until_it_rolls(speed: float, spin: float, turned: bool) -> None:
    # bowling; with back spin it comes back, with top spin it gets faster: J = 2/5 m r^2
    mass, r, mu = 7.0, 0.11, 0.2
    m = hb.Model("ball")
    m.add(ball=hb.I(mass, f=speed), v=hb.One(), turns=hb.I(0.4 * mass * r * r, f=spin), w=hb.One())
    m.add(lane=hb.One(law="coulomb", limit=mu * mass * G), slip=hb.Zero(), radius=hb.TF(1 / r))
    m.bond("v -> ball", "w -> turns", "v -> slip", "slip -> radius -> w")
    m.bond("lane -> slip" if turned else "slip -> lane")
    run = hb.simulate(m, until=6.0)
    rolls = abs(speed - r * spin) / (3.5 * mu * G)
    assert run.events.t[1] == pytest.approx(rolls, rel=1e-9)
    assert run["v.f"].at(6.0) == pytest.approx((speed + 0.4 * r * spin) / 1.4, rel=1e-9)
    assert run.audit().holds()


def struck(a: float, b: float, u: float, v: float) -> tuple[float, float]:
    """Return both speeds after an elastic impact."""
    p = (a * u + b * v) / (a + b)
    return 2 * p - u, 2 * p - v


def test_a_small_ball_on_large_ones_flies_away() -> None:
    masses = (4.0, 1.0, 0.1)
    m = hb.Model("balls on each other")
    m.add(ground=hb.Sf(0.0))
    for i, mass in enumerate(masses):
        below = f"v{i - 1}" if i else "ground"
        m.add(**{f"v{i}": hb.One(), f"b{i}": hb.I(mass), f"w{i}": hb.Se(-G * mass)})
        m.add(**{f"c{i}": hb.Zero(law="unilateral", gap=f"h{i}", restitution=1.0)})
        m.bond(f"w{i} -> v{i} -> b{i}", f"{below} -> c{i} -> v{i}")
        rate = f"v{i}.f - v{i - 1}.f" if i else "v0.f"
        m.signal(**{f"h{i}": hb.Integral(rate, start=0.0 if i else 1.0)})
    falls = math.sqrt(2 / G)
    run = hb.simulate(m, until=falls + 0.01)
    v = [G * falls, -G * falls, -G * falls]
    v[0], v[1] = struck(4.0, 1.0, v[0], v[1])
    v[1], v[2] = struck(1.0, 0.1, v[1], v[2])
    assert v[0] < v[1] < v[2]
    got = [run[f"v{i}.f"].at(falls + 0.01) + G * 0.01 for i in range(3)]
    assert got == pytest.approx(v, rel=1e-9)


@pytest.mark.parametrize("solver", ["auto", "moreau-jean"])
def test_a_train_takes_up_its_slack_wagon_by_wagon(solver: str) -> None:
    n, mass, play, pull = 4, 10.0, 0.1, 20.0
    m = hb.Model("train")
    m.add(engine=hb.Se(pull), **{f"w{i}": hb.I(mass) for i in range(n)})
    m.add(**{f"v{i}": hb.One() for i in range(n)})
    m.bond("engine -> v0", *[f"v{i} -> w{i}" for i in range(n)])
    for i in range(n - 1):
        m.add(**{f"pulls{i}": hb.Zero(law="unilateral", gap=f"a{i}", restitution=0.0)})
        m.add(**{f"pushes{i}": hb.Zero(law="unilateral", gap=f"b{i}", restitution=0.0)})
        m.bond(f"v{i} -> pulls{i} -> v{i + 1}", f"v{i + 1} -> pushes{i} -> v{i}")
        m.signal(**{f"a{i}": hb.Integral(f"v{i + 1}.f - v{i}.f", start=play)})
        m.signal(**{f"b{i}": hb.Integral(f"v{i}.f - v{i + 1}.f", start=0.0)})
    run = hb.simulate(m, until=3.0, solver=solver, step=2e-3 if solver != "auto" else None)
    t, v, times = 0.0, 0.0, []
    for k in range(1, n):
        a = pull / (k * mass)
        takes = (math.sqrt(v * v + 2 * a * play) - v) / a
        t, v = t + takes, (v + a * takes) * k / (k + 1)
        times.append(t)
    v += pull / (n * mass) * (3.0 - t)
    if solver == "auto":
        assert list(run.events.t[1:]) == pytest.approx(times, rel=1e-9)
    assert run["v0.f"].at(3.0) == pytest.approx(v, rel=1e-9 if solver == "auto" else 5e-3)


def test_a_hammer_drives_a_pile_into_soil() -> None:
    hammer, pile, soil, height = 500.0, 200.0, 40e3, 2.0
    m = hb.Model("pile")
    m.add(vh=hb.One(), h=hb.I(hammer), gh=hb.Se(-hammer * G), p=hb.I(pile), gp=hb.Se(-pile * G))
    m.add(vp=hb.One(law="coulomb", limit=soil))
    m.add(c=hb.Zero(law="unilateral", gap="d", restitution=0.0))
    m.bond("gh -> vh -> h", "gp -> vp -> p", "vp -> c -> vh")
    m.signal(d=hb.Integral("vh.f - vp.f", start=height), x=hb.Integral("vp.f", start=0.0))
    run = hb.simulate(m, until=2.0)
    v = math.sqrt(2 * G * height) * hammer / (hammer + pile)
    slows = soil / (hammer + pile) - G
    assert run["x"].at(2.0) == pytest.approx(-v * v / (2 * slows), rel=1e-9)


def test_a_worm_gear_holds_its_load_and_lifts_it() -> None:
    m = hb.Model("worm")
    m.add(motor=hb.Se("if time < 1 then 0 else 5"), w=hb.One(law="coulomb", limit=1.2))
    m.add(worm=hb.I(0.01), gear=hb.TF(1 / 30), load=hb.Se(-30.0), u=hb.One(), drum=hb.I(2.0))
    m.bond("motor -> w -> worm", "w -> gear -> u", "load -> u -> drum")
    run = hb.simulate(m, until=2.0)
    assert run["w.f"].at(0.9) == 0.0
    assert run["w.f"].at(2.0) == pytest.approx((5 - 1.2 - 1.0) / (0.01 + 2 / 900), rel=1e-9)


def test_a_plate_on_a_spring_throws_a_ball_where_the_spring_is_slack() -> None:
    m = hb.Model("catapult")
    m.add(vp=hb.One(), plate=hb.I(1.0), spring=hb.C(1e-3, q=-0.1), vb=hb.One(), ball=hb.I(0.5))
    m.add(gp=hb.Se(-G), gb=hb.Se(-0.5 * G))
    m.add(c=hb.Zero(law="unilateral", gap="d", restitution=0.3))
    m.bond("vp -> plate", "vp -> spring", "gp -> vp", "vb -> ball", "gb -> vb", "vp -> c -> vb")
    m.signal(d=hb.Integral("vb.f - vp.f", start=0.0))
    run = hb.simulate(m, until=0.1)
    w, rest = math.sqrt(1000 / 1.5), -1.5 * G / 1000
    leaves = math.acos(rest / (0.1 + rest)) / w
    assert run.events.t[1] == pytest.approx(leaves, rel=1e-8)
    assert run["vb.f"].at(leaves) == pytest.approx(
        (0.1 + rest) * w * math.sin(w * leaves), rel=1e-7
    )


def test_couplers_with_play_are_jerked_one_after_the_other() -> None:
    m = hb.Model("jerk")
    m.add(loco=hb.Sf("if time < 1 then 0 else 2"), s=hb.One())
    m.bond("loco -> s")
    before = "s"
    for i in range(4):
        m.add(**{f"c{i}": hb.Zero(law="unilateral", gap=f"g{i}", restitution=0.0)})
        m.add(**{f"v{i}": hb.One(), f"w{i}": hb.I(5.0 + i)})
        m.bond(f"v{i} -> w{i}", f"{before} -> c{i} -> v{i}")
        m.signal(**{f"g{i}": hb.Integral(f"v{i}.f - {before}.f", start=0.05 * i)})
        before = f"v{i}"
    run = hb.simulate(m, until=2.0)
    assert list(run.events.t[1:]) == pytest.approx([1.0, 1.025, 1.075, 1.15], rel=1e-12)
    assert [run[f"v{i}.f"].at(2.0) for i in range(4)] == pytest.approx([2.0] * 4, rel=1e-12)
