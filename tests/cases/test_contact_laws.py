"""Contacts as laws of junctions: balls, blocks and tables, against closed forms."""

import itertools
import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import hybond as hb

G = 9.81

# -- a ball falls from 1 m


@pytest.fixture(scope="module")
def ball(simulate):
    return simulate("bouncing_ball_contact")


def impacts(run: hb.Result):
    return [e for e in run.events if e.cause == "guard"]


@pytest.mark.slow
def test_first_impact_of_the_ball(ball):
    hit = impacts(ball)[0]
    assert hit.t == pytest.approx(0.4515236409857308, rel=1e-9)
    assert ball["v.f"].at(hit.t, side="left") == pytest.approx(-4.429446918070019, rel=1e-9)
    assert hit.steps[0].impulses["contact.e"] == pytest.approx(8.415949144333036, rel=1e-9)
    assert ball["v.f"].at(hit.t) == pytest.approx(3.986502226263017, rel=1e-9)
    assert [s.kind for s in hit.steps] == ["pinnacle", "continuous"]


def test_later_impacts_of_the_ball(ball):
    """Flights last 0.9 of the one before; the published instants are their sums."""
    first = math.sqrt(2.0 / G)
    expected = [first]
    for k in range(60):
        expected.append(expected[-1] + 2.0 * first * 0.9 ** (k + 1))
    assert [e.t for e in impacts(ball)[:61]] == pytest.approx(expected, rel=1e-9)
    assert expected[1:5] == pytest.approx([1.264266, 1.995734, 2.654056, 3.246545], abs=6e-7)


def test_the_ball_comes_to_rest(ball):
    (landing,) = ball.accumulations
    assert landing.t == pytest.approx(math.sqrt(2.0 / G) * (1 + 0.9) / (1 - 0.9), rel=1e-9)
    assert landing.t == pytest.approx(8.578949, abs=6e-7)
    assert landing.landed
    assert ball.mode == {"contact": "closed"}
    for t in (8.6, 9.3, 10.0):
        assert ball["contact.e"].at(t) == pytest.approx(G, rel=1e-12)
        assert ball["v.f"].at(t) == 0.0
        assert ball["height"].at(t) == pytest.approx(0.0, abs=1e-12)


def test_a_plastic_ball_stays_at_once(simulate):
    run = simulate("bouncing_ball_contact", parameters={"eps": 0})
    assert run.events[1].t == pytest.approx(math.sqrt(2.0 / G), rel=1e-9)
    assert len(run.events) <= 3
    assert run.t_end == 10.0
    assert run["contact.e"].at(1.0) == pytest.approx(G, rel=1e-12)
    assert run["height"].at(10.0) == pytest.approx(0.0, abs=1e-12)
    lost = sum(s.energy.lost for e in run.events for s in e.steps if s.energy is not None)
    assert lost == pytest.approx(G, rel=1e-9)


# -- blocks


def block(gap: str = "height", **law) -> hb.Model:
    m = hb.Model("table", domain="translational")
    m.add(weight=hb.Se("-2*9.81 N"), mass=hb.I("2 kg"), v=hb.One())
    m.add(contact=hb.Zero(law="unilateral", gap=gap, **law))
    m.bond("weight -> v -> mass", "contact -> v")
    m.signal(height=hb.Integral("v.f"))
    return m


@pytest.mark.parametrize("law", [{}, {"restitution": 0.0}, {"restitution": 0.8}])
def test_a_block_at_rest_on_a_table_from_the_start(law):
    run = hb.simulate(block(**law), until=1.0)
    assert run.mode == {"contact": "closed"}
    assert [e.t for e in run.events if e.t > 0.0] == []
    assert run["contact.e"].at([0.0, 0.5, 1.0]) == pytest.approx([2 * G] * 3, rel=1e-12)
    assert run["v.f"].at(1.0) == 0.0


@pytest.mark.parametrize("eps", [None, 0.0, 0.7])
def test_a_stack_of_two_blocks(eps):
    """The table bears both, the lower block the upper one."""
    m = block("height", **({} if eps is None else {"restitution": eps}))
    m.add(w2=hb.Se("-3*9.81 N"), upper=hb.I("3 kg"), v2=hb.One())
    law = {} if eps is None else {"restitution": eps}
    m.add(between=hb.Zero(law="unilateral", gap="above - height", **law))
    m.bond("w2 -> v2 -> upper", "v -> between -> v2")
    m.signal(above=hb.Integral("v2.f"))
    run = hb.simulate(m, until=1.0)
    assert run.mode == {"contact": "closed", "between": "closed"}
    assert run["between.e"].at(0.5) == pytest.approx(3 * G, rel=1e-12)
    assert run["contact.e"].at(0.5) == pytest.approx(5 * G, rel=1e-12)


def test_a_block_is_lifted_off_the_table():
    """A pull that grows takes the block off where it equals the weight."""
    m = block()
    m.add(pull=hb.Se("10 [N/s]*time"))
    m.bond("pull -> v")
    run = hb.simulate(m, until=3.0)
    off = 2 * G / 10.0
    assert run.events[-1].t == pytest.approx(off, rel=1e-9)
    # m h'' = 10 (t - off)
    assert run["height"].at(3.0) == pytest.approx(10.0 * (3.0 - off) ** 3 / 12.0, rel=1e-7)


# -- a block on a vibrating table


def flights(A, w, until):
    """Lift-off where the table's acceleration is -g, impact where heights meet; then as before."""
    found, start = [], math.asin(G / (A * w * w)) / w
    period = 2.0 * math.pi / w
    while start < until:
        h, v = A * math.sin(w * start), A * w * math.cos(w * start)

        def above(t, h=h, v=v, start=start):
            return h + v * (t - start) - 0.5 * G * (t - start) ** 2 - A * math.sin(w * t)

        # the block leaves tangentially: look for the next change of sign well after it
        t = start + 1e-4
        while above(t) > 0.0:
            t += 1e-4
        hit = brentq(above, t - 1e-4, t, xtol=1e-15)
        found.append((start, hit))
        # it stays until the table's acceleration is below -g again
        start = math.asin(G / (A * w * w)) / w + period * math.floor(hit / period)
        while start < hit:
            start += period
        assert A * w * w * math.sin(w * hit) < G  # else it would leave at once
    return found


@pytest.mark.sampled(1)
def test_a_block_on_a_vibrating_table(simulate, solver):
    run = simulate("ball_on_shaker", solver=solver)
    expected = [t for pair in flights(5e-3, 60.0, 0.5) for t in pair if t < 0.5]
    assert len(expected) >= 6
    assert [e.t for e in run.events[1:]] == pytest.approx(expected, rel=1e-6)
    first, hit = expected[:2]
    # while it rides, the table carries m (g + a)
    force = 0.5 * (G - 5e-3 * 3600.0 * math.sin(60.0 * 0.5 * first))
    assert run["contact.e"].at(0.5 * first) == pytest.approx(force, rel=1e-6)
    assert run["contact.e"].at(0.5 * (first + hit)) == 0.0


def test_a_block_on_a_gentle_table_never_leaves(simulate):
    run = simulate("ball_on_shaker", parameters={"A": "2.7 mm", "w": "60 rad/s"})
    assert [e.t for e in run.events] == [0.0]


# -- rows of balls


def row(n: int, gap: float, eps: float = 1.0) -> hb.Model:
    """Equal balls in a row, the first one comes with 1 m/s."""
    m = hb.Model("row", domain="translational")
    for k in range(1, n + 1):
        m.add(**{f"m{k}": hb.I("1 kg", f=f"{float(k == 1)} m/s"), f"v{k}": hb.One()})
        m.bond(f"v{k} -> m{k}")
        m.signal(**{f"x{k}": hb.Integral(f"v{k}.f", f"{k - (gap if k == 1 else 0.0)} m")})
    for k in range(1, n):
        law = hb.Zero(law="unilateral", gap=f"x{k + 1} - x{k} - 1 [m]", restitution=eps)
        m.add(**{f"c{k}": law})
        m.bond(f"v{k} -> c{k} -> v{k + 1}")
    return m


@pytest.mark.parametrize(
    ("law", "after"),
    [("newton", (0.0, 0.0, 1.0)), ("newton_simultaneous", (-1 / 3, 2 / 3, 2 / 3))],
)
def test_three_balls(law, after):
    run = hb.simulate(row(3, 0.25), until=0.6, impact=law)
    assert run.events[1].t == pytest.approx(0.25, rel=1e-9)
    end = [run[f"v{k}.f"].at(0.6) for k in (1, 2, 3)]
    assert end == pytest.approx(after, abs=1e-12)


def test_newtons_cradle_hands_the_motion_on(simulate):
    """The ball swings for a quarter period; then the last one for half of one; and so on."""
    run = simulate("newtons_cradle")
    half = math.pi * math.sqrt(0.1 / 0.981)
    hits = [e.t for e in run.events[1:] if any(s.impulses for s in e.steps)]
    # later ones come in groups: balls that hang still do so to the accuracy of the run only
    hits = [b for a, b in itertools.pairwise([0.0, *hits]) if b - a > 1e-3]
    assert hits[:4] == pytest.approx([half * (0.5 + k) for k in range(4)], rel=1e-6)
    assert run["swing5.q"].at(half) == pytest.approx(0.05, rel=1e-6)
    assert run["swing1.q"].at(2.0 * half) == pytest.approx(-0.05, rel=1e-6)
    for k in (2, 3, 4):
        assert run[f"swing{k}.q"].at(half) == pytest.approx(0.0, abs=1e-9)


# -- an oscillator between two stops


@pytest.mark.slow
def test_end_stops(simulate):
    run = simulate("end_stops")
    k, room, eps = 50.0, 0.02, 0.6

    def field(t, z):
        return [z[1], 4.0 * math.sin(9.0 * t) - k * z[0]]

    def right(t, z):
        return room - z[0]

    def left(t, z):
        return room + z[0]

    right.terminal = left.terminal = True
    right.direction = left.direction = -1.0
    t, z, hits = 0.0, np.zeros(2), []
    while True:
        part = solve_ivp(
            field, (t, 5.0), z, method="DOP853", rtol=1e-12, atol=1e-14, events=[right, left]
        )
        if part.status != 1:
            break
        t, z = float(part.t[-1]), part.y[:, -1]
        z = np.array([math.copysign(room, z[0]), -eps * z[1]])
        hits.append(t)
    assert len(hits) > 15
    assert [e.t for e in run.events[1:]] == pytest.approx(hits, rel=1e-6)
    assert run["spring.q"].at(5.0) == pytest.approx(part.y[0, -1], rel=1e-5)


# -- a bumper


@pytest.mark.parametrize("eps", [1.2, "1.2"])
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("options", [{}, {"solver": "moreau-jean", "step": 0.01}])
def test_a_restitution_above_one_gives_what_it_says_with_a_warning(eps, turned, options):
    masses = "b0 -> v0", "b1 -> v1"
    if not turned:
        masses = "v0 -> b0", "v1 -> b1"
    run = hb.simulate(
        hb.loads(f"""
hybond = 1
domain = "translational"
[elements]
b0 = {{ I = 1.0, f = {-1.0 if turned else 1.0} }}
b1 = {{ I = 2.0 }}
v0 = {{ junction = 1 }}
v1 = {{ junction = 1 }}
bumper = {{ junction = 0, law = "unilateral", gap = "x1 - x0 - 1.0", restitution = {eps!r} }}
[graph]
bonds = ["{masses[0]}", "{masses[1]}", "v0 -> bumper -> v1"]
[signals]
x0 = {{ integral = "v0.f", start = 0.5 }}
x1 = {{ integral = "v1.f", start = 2.0 }}
"""),
        until=1.0,
        **options,
    )
    # momentum 1, and a velocity of parting of 1.2
    assert run["v0.f"].at(0.9) == pytest.approx((1.0 - 2.0 * 1.2) / 3.0, rel=1e-12)
    assert run["v1.f"].at(0.9) == pytest.approx(2.2 / 3.0, rel=1e-12)
    assert run.status == "ok"
    made = (1.4**2 + 2.0 * 2.2**2) / 18.0 - 0.5
    assert run.audit().created == pytest.approx(made / (0.5 + made), rel=1e-6)
    if not options:
        assert any(f"creates {made:.6g} J" in w for w in run.warnings)
    elif isinstance(eps, float):
        assert any("creates energy at each impact" in w for w in run.warnings)
