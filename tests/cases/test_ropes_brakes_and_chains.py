"""Ropes that go slack, brakes that press themselves, hoppers and chains, against closed forms."""

import math

import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import hybond as hb

G = 9.81


def instants(run: hb.Result) -> list[float]:
    """Return the times of what happened after the start."""
    return [event.t for event in run.events[1:]]


@pytest.mark.parametrize(("light", "heavy"), [(1.0, 3.0), (1e-3, 1e-2)])
def test_an_atwood_machine_lands_again_and_again(light: float, heavy: float) -> None:
    """The floor takes the heavy mass plastically; the rope is slack, and jerks it up again.

    A jerk keeps momentum, so that each flight begins with a part light/(light + heavy) of the speed
    before. All end at the sum of a geometric series, and the floor carries the difference.
    """
    h, both = 0.7, light + heavy
    m = hb.Model("atwood", domain="translational")
    m.add(A=hb.I(light), B=hb.I(heavy), WA=hb.Se(-light * G), WB=hb.Se(-heavy * G))
    m.add(a=hb.One(), b=hb.One(), rope=hb.Zero(law="unilateral", gap="x + y"))
    m.add(floor=hb.Zero(law="unilateral", gap=f"y + {h}"))
    m.bond("WA -> a -> A", "WB -> b -> B", "rope -> a", "rope -> b", "floor -> b")
    m.signal(x=hb.Integral("a.f"), y=hb.Integral("b.f"))
    pull = (heavy - light) / both * G
    lands = math.sqrt(2 * h / pull)
    speed, kept = pull * lands, light / both
    jerk = lands + 2 * speed / G
    rests = lands + 2 * speed * (1 / G + kept / pull) / (1 - kept)
    run = hb.simulate(m, 1.2 * rests)
    assert instants(run)[:3] == pytest.approx([lands, jerk, jerk + 2 * kept * speed / pull])
    assert instants(run)[-1] == pytest.approx(rests, rel=1e-7)
    assert run["rope.e"].at(1.1 * rests) == pytest.approx(light * G)
    assert run["floor.e"].at(1.1 * rests) == pytest.approx((heavy - light) * G)
    assert run.audit().holds()


@pytest.mark.parametrize("scale", [1e-9, 1e9])
@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_shoe_presses_itself_on_one_way_round(scale: float, way: float) -> None:
    """The limit of friction reads its own force: F = mu*(N + a*F), more or less than mu*N."""
    mu, lever, press, inertia, rate = 0.3, 3.0, 10.0 * scale, 2.0 * scale, 10.0
    m = hb.Model("brake", domain="rotational")
    m.add(J=hb.I(inertia, f=way * rate), w=hb.One())
    m.add(shoe=hb.One(law="coulomb", limit=f'{mu}*({press} + {lever}*"drag".e)'))
    m.bond("w -> J", "drag: w -> shoe")
    torque = mu * press / (1 - way * mu * lever)
    run = hb.simulate(m, 20.0)
    assert instants(run) == pytest.approx([inertia * rate / torque], rel=1e-9)
    assert run.audit().holds()


@pytest.mark.parametrize(("scale", "solver"), [(1e-9, "auto"), (1e9, "auto"), (1.0, "radau")])
def test_a_hopper_loses_what_its_foot_had(scale: float, solver: str) -> None:
    """Body, spring and foot fall; the foot stays on the floor until the spring lifts it."""
    body, foot, k, h = 1.0 * scale, 0.2 * scale, 400.0 * scale, 0.2
    m = hb.Model("hopper", domain="translational")
    m.add(M=hb.I(body), F=hb.I(foot), WM=hb.Se(-body * G), WF=hb.Se(-foot * G), spring=hb.C(1 / k))
    m.add(up=hb.One(), low=hb.One(), leg=hb.Zero(), floor=hb.Zero(law="unilateral", gap="y"))
    m.bond("WM -> up -> M", "WF -> low -> F", "low -> leg -> up", "leg -> spring", "floor -> low")
    m.signal(y=hb.Integral("low.f", h))
    fallen = math.sqrt(2 * h / G)
    w, speed, sag = math.sqrt(k / body), G * fallen, body * G / k

    def lift(t: float) -> float:
        """Return the pull of the spring on the foot less its weight."""
        pressed = sag - sag * math.cos(w * t) + speed / w * math.sin(w * t)
        return -k * pressed - foot * G

    leaves = brentq(lift, math.pi / w, 1.6 * math.pi / w)
    run = hb.simulate(m, fallen + 1.05 * leaves, solver=solver)
    assert instants(run) == pytest.approx([fallen, fallen + leaves], rel=1e-8)
    lost = run.events[1].steps[-1].energy.lost
    assert lost == pytest.approx(0.5 * foot * speed**2, rel=1e-9)


@pytest.mark.parametrize("solver", ["auto", "radau", "qss"])
def test_a_jumper_hangs_on_a_rope_that_was_slack(solver: str) -> None:
    """The gap counts the stretch of the rope: it is taut from 20 m on, and slack again there."""
    mass, k, slack = 70.0, 150.0, 20.0
    m = hb.Model("bungee", domain="translational")
    m.add(M=hb.I(mass), W=hb.Se(-mass * G), v=hb.One(), rubber=hb.C(1 / k), stretch=hb.One())
    m.add(rope=hb.Zero(law="unilateral", gap=f"{slack} + x + rubber.q"))
    m.bond("W -> v -> M", "rope -> v", "rope -> stretch -> rubber")
    m.signal(x=hb.Integral("v.f"))
    taut = math.sqrt(2 * slack / G)
    w, speed, sag = math.sqrt(k / mass), G * taut, mass * G / k
    free = 2 * (math.pi - math.atan2(speed / w, sag)) / w
    run = hb.simulate(m, taut + 1.02 * free, solver=solver)
    assert instants(run) == pytest.approx([taut, taut + free], rel=1e-8)


def one_after_another(masses: list[float], v: list[float], eps: float) -> list[float]:
    """Return speeds after impacts of neighbours, the first pair that approaches first."""
    while True:
        pairs = [i for i in range(len(v) - 1) if v[i] - v[i + 1] > 1e-12]
        if not pairs:
            return v
        i = pairs[0]
        impulse = (1 + eps) * (v[i] - v[i + 1]) / (1 / masses[i] + 1 / masses[i + 1])
        v[i] -= impulse / masses[i]
        v[i + 1] += impulse / masses[i + 1]


@pytest.mark.parametrize(
    ("masses", "eps"),
    [([1.0] * 4, 1.0), ([1.0] * 4, 0.5), ([3.0, 1.0, 2.0, 1.0], 1.0), ([1e-9] * 4, 0.5)],
)
def test_a_chain_of_resets_hands_an_impact_on(masses: list[float], eps: float) -> None:
    """Four bodies, three machines that read `pre()`: pinnacles of one instant."""
    m = hb.Model("chain", domain="translational", parameters={"e": eps})
    for i, mass in enumerate(masses):
        m.add({f"b{i}": hb.I(mass, f=0.0 if i else 1.0), f"v{i}": hb.One()})
        m.bond(f"v{i} -> b{i}")
        m.signal({f"x{i}": hb.Integral(f"v{i}.f", i + (0.25 if i else 0.0))})
    for i in range(3):
        m.add({f"c{i}": hb.Zero(), f"s{i}": hb.Sf(f"-e*pre(v{i}.f - v{i + 1}.f)")})
        m.bond(f"v{i} -> c{i} -> v{i + 1}", f"c{i} -> s{i}")
        m.machine(
            f"meet{i}",
            states={"apart": [], "hit": [f"c{i}"]},
            start="apart",
            rules=[
                f"apart -> hit when x{i + 1} - x{i} <= 1 and pre(v{i}.f - v{i + 1}.f) > 0",
                f"hit -> apart when pre(v{i}.f - v{i + 1}.f) <= 0",
            ],
        )
    run = hb.simulate(m, 0.9)
    got = [run.final[f"b{i}.p"] / masses[i] for i in range(4)]
    assert got == pytest.approx(one_after_another(masses, [1.0, 0.0, 0.0, 0.0], eps), abs=1e-12)
    assert len(instants(run)) == 1


@pytest.mark.parametrize("solver", ["auto", "radau"])
def test_a_body_turns_over_about_its_middle_axis(solver: str) -> None:
    """Euler's equations as three gyrators whose moduli are the angular momenta (Dzhanibekov)."""
    j, start, until = (1.0, 2.0, 3.0), (0.01, 1.0, 0.02), 20.0
    m = hb.Model("body", domain="rotational")
    for i in range(3):
        m.add({f"J{i}": hb.I(j[i], f=start[i]), f"w{i}": hb.One(), f"g{i}": hb.GY(f"J{i}.p")})
        m.bond(f"w{i} -> J{i}", f"w{(i + 1) % 3} -> g{i} -> w{(i + 2) % 3}")
    run = hb.simulate(m, until, solver=solver)
    found = solve_ivp(
        lambda t, w: [(j[i - 2] - j[i - 1]) * w[i - 2] * w[i - 1] / j[i] for i in range(3)],
        (0.0, until),
        start,
        method="DOP853",
        rtol=1e-12,
        atol=1e-14,
    )
    got = [run[f"w{i}.f"].at(until) for i in range(3)]
    assert got == pytest.approx(found.y[:, -1].tolist(), abs=1e-6)
    assert min(run["w1.f"].y) < -0.9
