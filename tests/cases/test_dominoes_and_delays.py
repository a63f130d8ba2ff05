"""Dominoes, chains, cradles, brakes and delayed or sampled controllers, each in closed form."""

import math

import pytest

import hybond as hb

BOTH = pytest.mark.parametrize("solver", ["auto", "radau"])


def times(run: hb.Result) -> list[float]:
    """Return the times of what happened after the start."""
    return [event.t for event in run.events[1:]]


@BOTH
def test_dominoes_take_each_other_along(solver: str) -> None:
    m = hb.Model("dominoes", domain="rotational")
    inertias = [0.01 * (1 + 0.3 * k) for k in range(5)]
    for k, inertia in enumerate(inertias):
        m.add({f"J{k}": hb.I(inertia, f=0.0 if k else 1.0), f"w{k}": hb.One()})
        m.bond(f"w{k} -> J{k}")
        m.signal({f"a{k}": hb.Integral(f"w{k}.f")})
    for k in range(4):
        m.add({f"c{k}": hb.Zero(law="unilateral", gap=f"0.2 - (a{k} - a{k + 1})")})
        m.bond(f"w{k} -> c{k} -> w{k + 1}")
    t, rate, together, expected = 0.0, 1.0, inertias[0], []
    for inertia in inertias[1:]:
        t += 0.2 / rate
        expected.append(t)
        rate *= together / (together + inertia)
        together += inertia
    run = hb.simulate(m, until=5.0, solver=solver)
    assert times(run) == pytest.approx(expected, rel=1e-9)
    assert run["w4.f"].at(5.0) == pytest.approx(rate, rel=1e-9)


@BOTH
def test_a_chain_is_picked_up_link_by_link(solver: str) -> None:
    """Each link lies still until its slack is gone, and is jerked along: momentum is kept."""
    m = hb.Model("chain", domain="translational")
    m.add(m0=hb.I(1.0, f=5.0), v0=hb.One())
    m.bond("v0 -> m0")
    m.signal(x0=hb.Integral("v0.f"))
    t, expected = 0.0, []
    for k in range(1, 7):
        gap = f"0.1 - (x{k - 1} - x{k})"
        m.add({f"m{k}": hb.I(0.2), f"v{k}": hb.One(), f"r{k}": hb.Zero(law="unilateral", gap=gap)})
        m.bond(f"v{k} -> m{k}", f"v{k - 1} -> r{k} -> v{k}")
        m.signal({f"x{k}": hb.Integral(f"v{k}.f")})
        t += 0.1 * (1 + 0.2 * (k - 1)) / 5.0
        expected.append(t)
    run = hb.simulate(m, until=1.0, solver=solver)
    assert times(run) == pytest.approx(expected, rel=1e-9)
    assert run["v0.f"].at(1.0) == pytest.approx(5 / 2.2, rel=1e-9)


@pytest.mark.parametrize("masses", [(1, 2, 1), (3, 1, 2, 0.5), (1, 0.5, 0.25, 0.125)])
def test_a_cradle_of_unequal_balls(masses: tuple[float, ...]) -> None:
    """Impact after impact, each of two balls, with a restitution of 0.9."""
    m = hb.Model("cradle", domain="translational")
    many = len(masses)
    for k, mass in enumerate(masses):
        m.add({f"m{k}": hb.I(float(mass), f=0.0 if k else 2.0), f"v{k}": hb.One()})
        m.bond(f"v{k} -> m{k}")
        m.signal({f"x{k}": hb.Integral(f"v{k}.f", start=0.5 * k)})
    for k in range(many - 1):
        gap = f"x{k + 1} - x{k} - 0.3"
        m.add({f"c{k}": hb.Zero(law="unilateral", gap=gap, restitution=0.9)})
        m.bond(f"v{k} -> c{k} -> v{k + 1}")
    x, v, t = [0.5 * k for k in range(many)], [2.0] + [0.0] * (many - 1), 0.0
    while True:
        meet = [
            (max(x[k + 1] - x[k] - 0.3, 0.0) / (v[k] - v[k + 1]), k)
            for k in range(many - 1)
            if v[k] - v[k + 1] > 1e-12
        ]
        if not meet or t + min(meet)[0] > 3.0:
            break
        later, k = min(meet)
        t += later
        x = [a + b * later for a, b in zip(x, v, strict=True)]
        one, other = masses[k], masses[k + 1]
        impulse = 1.9 * one * other / (one + other) * (v[k] - v[k + 1])
        v[k] -= impulse / one
        v[k + 1] += impulse / other
    run = hb.simulate(m, until=3.0)
    assert [run[f"v{k}.f"].at(3.0) for k in range(many)] == pytest.approx(v, rel=1e-9)


@BOTH
def test_a_planetary_gear_whose_ring_is_let_go(solver: str) -> None:
    z, sun, ring, carrier, torque = 2.5, 0.1, 0.3, 2.0, 10.0
    a, b = 1 / (1 + z), z / (1 + z)
    m = hb.Model("planetary", domain="rotational")
    m.add(Js=hb.I(sun), Jr=hb.I(ring), Jc=hb.I(carrier), s=hb.One(), r=hb.One(), c=hb.One())
    m.add(T=hb.Se(torque), gs=hb.TF(a), gr=hb.TF(b), x=hb.Zero(), brake=hb.Zero(), held=hb.Sf(0))
    m.bond("T -> s -> Js", "s -> gs -> x", "r -> gr -> x", "x -> c -> Jc", "r -> Jr")
    m.bond("r -> brake -> held")
    states, rules = {"on": ["brake"], "off": []}, ["on -> off when time > 1"]
    m.machine("B", states=states, start="on", rules=rules)
    run = hb.simulate(m, until=2.0, solver=solver)
    ss, sr, rr = sun + carrier * a * a, carrier * a * b, ring + carrier * b * b
    full = ss * rr - sr * sr
    assert run["s.f"].at(2.0) == pytest.approx(torque / ss + torque * rr / full, rel=1e-9)
    assert run["r.f"].at(2.0) == pytest.approx(-torque * sr / full, rel=1e-9)


@BOTH
def test_an_elevator_is_stopped_and_held_by_its_brake(solver: str) -> None:
    m = hb.Model("elevator", domain="translational")
    limit = 'if B.state == "on" then 4000 else 0'
    m.add(cab=hb.I(900), load=hb.I(700), v=hb.One(law="coulomb", limit=limit))
    m.add(weight=hb.Se("-(900 - 700)*9.81"), drive=hb.Se("pull"))
    m.bond("weight -> v -> cab", "v -> load", "drive -> v")
    m.signal(pull='if B.state == "run" then 3000 else 0', x=hb.Integral("v.f"))
    states: dict[str, list[str]] = {"run": [], "on": []}
    m.machine("B", states=states, start="run", rules=["run -> on when x >= 2"])
    gains, takes = (3000 - 1962) / 1600, (1962 + 4000) / 1600
    there = math.sqrt(4 / gains)
    run = hb.simulate(m, until=8.0, solver=solver)
    assert times(run) == pytest.approx([there, there * (1 + gains / takes)], rel=1e-8)
    assert run["x"].at(8.0) == pytest.approx(2 + 2 * gains / takes, rel=1e-8)


@BOTH
def test_a_relay_that_answers_late(solver: str) -> None:
    m = hb.Model("late")
    up = 'R.state == "on" or R.state == "going_off"'
    waits = 'R.state == "going_off" or R.state == "going_on"'
    m.signal(y=hb.Integral(f"-0.5*y + (if {up} then 2 else -2)"))
    m.signal(clock=hb.Integral(f"if {waits} then 1 else -1000*clock"))
    names = ("on", "going_off", "off", "going_on")
    states: dict[str, list[str]] = {name: [] for name in names}
    rules = ["on -> going_off when y > 0.5", "going_off -> off when clock >= 0.3"]
    rules += ["off -> going_on when y < -0.5", "going_on -> on when clock >= 0.3"]
    m.machine("R", states=states, start="on", rules=rules)
    t, y, way, expected = 0.0, 0.0, 1.0, []
    for _ in range(5):
        t += 2 * math.log((4 * way - y) / (3.5 * way))
        expected += [t, t + 0.3]
        t += 0.3
        y = way * (4 - 3.5 * math.exp(-0.15))
        way = -way
    run = hb.simulate(m, until=8.0, solver=solver)
    assert times(run)[:10] == pytest.approx(expected, rel=1e-7)


@BOTH
def test_a_sampled_controller_that_winds_back(solver: str) -> None:
    every, steps = 0.05, 100
    m = hb.Model("sampled")
    wanted, error = "(3*(1 - y) + i)", "4*(1 - y)"
    limited = f"min(max({wanted}, -0.4), 1.2)"
    m.signal(y=hb.Integral("-y + u"), u=hb.Sampled(limited, every=every))
    m.signal(i=hb.Sampled(f"i + {every}*({error} + 2*({limited} - {wanted}))", every=every))
    y = i = 0.0
    for _ in range(steps):
        asked = 3 * (1 - y) + i
        u = min(max(asked, -0.4), 1.2)
        i += every * (4 * (1 - y) + 2 * (u - asked))
        y = u + (y - u) * math.exp(-every)
    run = hb.simulate(m, until=steps * every, solver=solver)
    assert run["y"].at(steps * every) == pytest.approx(y, rel=1e-9)


@BOTH
def test_a_body_is_brought_to_rest_in_two_samples(solver: str) -> None:
    every = 0.1
    m = hb.Model("dead beat", domain="translational")
    m.add(M=hb.I(2.0, f=0.3), v=hb.One(), F=hb.Se("u"))
    m.bond("F -> v -> M")
    law = f"-2*(x/{every}^2 + 1.5*v.f/{every})"
    m.signal(x=hb.Integral("v.f", start=1.0), u=hb.Sampled(law, every=every))
    run = hb.simulate(m, until=0.35, solver=solver)
    assert run["x"].at(every) == pytest.approx(1 + 0.03 - (1 + 0.045) / 2, rel=1e-9)
    assert run["x"].at([0.2, 0.3]) == pytest.approx([0, 0], abs=1e-9)
    assert run["v.f"].at([0.25, 0.35]) == pytest.approx([0, 0], abs=1e-9)
