"""Rigid contacts with friction: no answer, one, several, each against a closed form."""

from __future__ import annotations

import itertools
import math
from fractions import Fraction

import numpy as np
import pytest

import hybond as hb

G = 9.81
RODS = [
    # half length, inertia, mass, friction, angle, speed of turning
    (1.0, 1.0 / 3.0, 1.0, 1.5, 1.106538745764405, 4.0),
    (0.5, 0.02, 1.0, 2.0, 1.0, 8.0),
    (2.0, 0.6, 2.0, 1.6, 1.2, 3.0),
    (1.0, 1.0 / 3.0, 1.0, 1.5, 1.1, 1.0),
    (0.5, 0.02, 1.0, 2.0, 1.0, 0.5),
    (2.0, 0.6, 2.0, 1.6, 1.2, 0.0),
    (1.0, 1.0 / 3.0, 1.0, 0.3, 1.1, 1.0),
    (0.5, 0.02, 1.0, 0.1, 0.7, 0.5),
    (2.0, 0.6, 2.0, 0.4, 1.2, 0.0),
    (1.0, 1.0 / 3.0, 1.0, 0.3, 1.1, 5.0),
    (0.5, 0.02, 1.0, 0.1, 0.7, 9.0),
    (2.0, 0.6, 2.0, 0.4, 1.2, 4.0),
]


def rod(
    l: float,
    J: float,
    m: float,
    mu: float,
    theta: float,
    w: float,
    slip: float,
    *,
    eps: float = 0.0,
    falls: float | None = None,
) -> hb.Model:
    """A rod whose lower tip slides on a floor: no velocity along the normal, `slip` along it.

    Or one whose centre `falls`, and drifts at `slip`, without weight.
    """
    model = hb.Model("rod", domain="translational")
    normal, along = l * math.cos(theta) * w, slip - l * math.sin(theta) * w
    if falls is not None:
        normal, along = falls, slip
    model.add(mx=hb.I(m, f=along), my=hb.I(m, f=normal))
    model.add(weight=hb.Se(-m * G if falls is None else 0.0))
    model.add(rot=hb.I(J, f=w, domain="rotational"), w=hb.One(domain="rotational"))
    model.add(vx=hb.One(), vy=hb.One(), tangent=hb.Zero())
    model.add(arm_x=hb.TF(f"{l}*sin(theta)"), arm_y=hb.TF(f"-({l})*cos(theta)"))
    model.add(contact=hb.Zero(law="unilateral", gap="gap", restitution=eps))
    model.add(slip=hb.One(law="coulomb", limit=f"{mu}*contact.e", impulsive=True))
    model.bond("vx -> mx", "weight -> vy -> my", "w -> rot", "contact -> vy", "contact -> arm_y.2")
    model.bond("arm_y.1 -> w", "vx -> tangent -> slip", "w -> arm_x -> tangent")
    model.signal(theta=hb.Integral("w.f", start=theta))
    model.signal(y=hb.Integral("vy.f", start=l * math.sin(theta)))
    model.signal(gap=f"y - ({l})*sin(theta)")
    return model


def of_contact(case: tuple[float, ...], slip: float) -> tuple[float, float]:
    """Return a and b of the acceleration ``a N + b`` of the tip (Genot and Brogliato 1999)."""
    l, J, m, mu, theta, w = case
    s, c = math.sin(theta), math.cos(theta)
    way = math.copysign(1.0, slip)
    return 1.0 / m + l * c * (l * c + way * mu * l * s) / J, l * s * w * w - G


@pytest.mark.sampled(3)
@pytest.mark.parametrize("slip", [-1.0, 0.5])
@pytest.mark.parametrize("case", RODS)
def test_painleves_rod_lifts_off_bears_or_has_no_answer(
    case: tuple[float, ...], slip: float
) -> None:
    """``0 <= N``, ``a N + b >= 0``: four cases, of which one has two answers and one has none."""
    a, b = of_contact(case, slip)
    model = rod(*case, slip)
    if a < 0.0 and b < 0.0:
        with pytest.raises(hb.HybondError, match="HB-J110"):
            hb.simulate(model, until=1e-3)
        return
    run = hb.simulate(model, until=1e-3)
    said = [w for w in run.warnings if "answers" in w]
    force = run["contact.e"].at(0.0, side="right")
    assert force == pytest.approx(max(0.0, -b / a) if a > 0.0 else 0.0, rel=1e-6, abs=1e-9)
    assert bool(said) == (a < 0.0)
    if said:
        assert "contact, slip have 2 answers" in said[0]
        assert "(open, " in said[0] and "and not (closed, " in said[0]
    if force == 0.0:
        assert run["gap"].at(1e-3) == pytest.approx(b * 0.5e-6, rel=5e-2)


@pytest.mark.parametrize("w", [0.0, 2.0, -3.0, 4.0, -5.0])
def test_the_force_of_a_contact_knows_that_its_lever_turns(w: float) -> None:
    """The tip of a turning rod on ice: ``N = (g - l w^2 sin) / (1/m + (l cos)^2/J)``, or none."""
    case = (1.0, 1.0 / 3.0, 1.0, 0.0, 1.0, w)
    a, b = of_contact(case, 1.0)
    run = hb.simulate(rod(*case, 1.0), until=1e-3)
    force = run["contact.e"].at(0.0, side="right")
    assert force == pytest.approx(max(0.0, -b / a), rel=1e-9, abs=1e-9)
    assert (run.mode["contact"] == "closed") == (b < 0.0)


def block(mu: float, theta: float, half: float = 0.25, high: float = 0.75) -> hb.Model:
    """A block that stands on one corner, inclined by `theta`, and tips over onto its base."""
    m = hb.Model("rocking", domain="translational")
    m.add(mx=hb.I(1.0), my=hb.I(1.0), weight=hb.Se(-G), vx=hb.One(), vy=hb.One())
    m.add(rot=hb.I((half**2 + high**2) / 3.0, domain="rotational"), w=hb.One(domain="rotational"))
    for k, side in ((1, -1.0), (2, 1.0)):
        m.add(**{f"c{k}": hb.Zero(law="unilateral", gap=f"gap{k}", restitution=0.0)})
        m.add(**{f"s{k}": hb.One(law="coulomb", limit=f"{mu}*c{k}.e", impulsive=True)})
        m.add(**{f"a{k}": hb.TF(f"{side * half}*cos(theta) + {high}*sin(theta)")})
        m.add(**{f"t{k}": hb.TF(f"{high}*cos(theta) - {side * half}*sin(theta)")})
        m.add(**{f"f{k}": hb.Zero()})
        m.bond(f"c{k} -> vy", f"c{k} -> a{k}.2", f"a{k}.1 -> w")
        m.bond(f"vx -> f{k} -> s{k}", f"w -> t{k} -> f{k}")
        m.signal(**{f"gap{k}": f"y + {side * half}*sin(theta) - {high}*cos(theta)"})
    m.bond("vx -> mx", "weight -> vy -> my", "w -> rot")
    y = high * math.cos(theta) + half * math.sin(theta)
    m.signal(theta=hb.Integral("w.f", start=theta), y=hb.Integral("vy.f", start=y))
    return m


@pytest.mark.sampled(1)
@pytest.mark.parametrize("mu", [1.0, 1.5, 2.0, 4.0])
@pytest.mark.slow
def test_a_rocking_block_lands_on_its_other_corner_however_rough_the_floor(mu: float) -> None:
    """Once the corners hold: the impact is the projection on turning about the other corner."""
    half, high, theta = 0.25, 0.75, 0.16
    run = hb.simulate(block(mu, theta), until=0.45)
    J = (half**2 + high**2) / 3.0
    about = J + half**2 + high**2
    fall = high * math.cos(theta) + half * math.sin(theta) - high
    w = -math.sqrt(2.0 * G * fall / about)
    # momentum about the corner that lands is kept (Housner 1963)
    after = w * (J + high**2 - half**2) / about
    hit = next(e for e in run.events[1:] if any(s.impulses for s in e.steps))
    assert run["w.f"].at(hit.t, side="left") == pytest.approx(w, rel=1e-6)
    assert run["w.f"].at(hit.t, side="right") == pytest.approx(after, rel=1e-6)
    assert run.status == "ok"


def wedge(load: float, steep: float, mu: float) -> hb.Model:
    """A wedge pressed into a groove: two faces at the angle `steep` to its way, both rough."""
    m = hb.Model("wedge", domain="translational", parameters={"mu": mu})
    s, c = math.sin(steep), math.cos(steep)
    m.add(mx=hb.I("1 kg"), my=hb.I("1 kg"), vx=hb.One(), vy=hb.One(), load=hb.Se(load))
    m.bond("vx -> mx", "load -> vy -> my")
    for k, side in ((1, 1.0), (2, -1.0)):
        m.add(**{f"n{k}": hb.Zero(law="unilateral"), f"r{k}": hb.Zero()})
        m.add(**{f"s{k}": hb.One(law="coulomb", limit=f"mu*n{k}.e")})
        m.add(**{f"nx{k}": hb.TF(side * c), f"tx{k}": hb.TF(-side * s), f"ty{k}": hb.TF(c)})
        m.add(**{f"ny{k}": hb.TF(s)})
        # n: away from the face; t: along it
        m.bond(f"n{k} -> nx{k}.2", f"nx{k}.1 -> vx", f"n{k} -> ny{k}.2", f"ny{k}.1 -> vy")
        m.bond(f"vx -> tx{k} -> r{k}", f"vy -> ty{k} -> r{k}", f"r{k} -> s{k}")
    return m


@pytest.mark.parametrize("mu", [0.2, 0.6, 1.4])
@pytest.mark.parametrize("load", [-2.0, 2.0])
def test_a_wedge_in_a_groove_says_that_it_may_jam(load: float, mu: float) -> None:
    """Pulled out it may leave, or stay jammed where the faces are steeper than friction's angle."""
    steep = 0.7
    run = hb.simulate(wedge(load, steep, mu), until=0.1)
    said = [w for w in run.warnings if "answers" in w]
    jams = mu > math.tan(steep)
    if load > 0.0:
        assert run["vy.f"].at(0.1) == pytest.approx(load * 0.1, rel=1e-9)
        assert bool(said) == jams
        if jams:
            assert "laws of n1, s1, n2, s2" in said[0]
            assert "(closed, sticks, closed, sticks)" in said[0].split("and not")[1]
    else:
        assert run["vy.f"].at(0.1) == pytest.approx(0.0, abs=1e-12)
        assert not said


def exact_impulses(mass: list[Fraction], v: list[Fraction], eps: Fraction) -> list[Fraction]:
    """Velocities after an impact of equal balls in a row, all contacts at once, by elimination."""
    n = len(v)
    # v+ of neighbours: (v_k+1 - v_k)+ = -eps (v_k+1 - v_k), momentum is kept
    jumps = [-eps * (b - a) for a, b in itertools.pairwise(v)]
    total = sum(m * a for m, a in zip(mass, v))
    rest = sum(mass[k] * sum(jumps[:k], Fraction(0)) for k in range(n))
    first = (total - rest) / sum(mass)
    return [first + sum(jumps[:k], Fraction(0)) for k in range(n)]


def row(n: int, apart: float, gap: float, eps: float = 1.0) -> hb.Model:
    """Equal balls, all but the first touching at rest; the first arrives over a `gap`."""
    m = hb.Model("row", domain="translational")
    for k in range(n):
        m.add(**{f"b{k}": hb.I("1 kg", f=1.0 if k == 0 else 0.0), f"v{k}": hb.One()})
        m.bond(f"v{k} -> b{k}")
        x = -gap if k == 0 else k * apart
        m.signal(**{f"x{k}": hb.Integral(f"v{k}.f", start=x)})
        if k:
            m.add(
                **{
                    f"c{k}": hb.Zero(
                        law="unilateral", gap=f"x{k} - x{k - 1} - {apart}", restitution=eps
                    )
                }
            )
            m.bond(f"v{k - 1} -> c{k} -> v{k}")
    return m


@pytest.mark.sampled(3)
@pytest.mark.parametrize("gap", [0.0, 1e-3, 0.0105])
@pytest.mark.parametrize("apart", [0.1, 0.125, 1.0 / 3.0, 1.0])
@pytest.mark.parametrize("n", [3, 4, 5])
def test_rounding_of_gaps_does_not_decide_which_balls_time_stepping_strikes(
    n: int, apart: float, gap: float
) -> None:
    """All that touch take part, at the start as well: -1 + 2/n, then 2/n each."""
    run = hb.simulate(row(n, apart, gap), until=0.05, solver="moreau-jean", step=1e-3)
    one = Fraction(1)
    exact = exact_impulses([one] * n, [one, *[one * 0] * (n - 1)], one)
    assert exact[1:] == [Fraction(2, n)] * (n - 1)
    assert [run.final[f"b{k}.p"] for k in range(n)] == pytest.approx([float(a) for a in exact])


KANE = (1.0, 1.0 / 3.0, 1.0, 0.655564009465022, 0.7799683693155834, 1.317675810204062)


@pytest.mark.parametrize("options", [{"impact": "newton"}, {"impact": "newton_simultaneous"}, {}])
def test_newtons_laws_have_friction_and_say_in_joules_what_they_create(
    options: dict[str, str],
) -> None:
    """One contact that sticks: ``v_n+ = -eps v_n``, ``v_t+ = 0``, a projection by elimination."""
    l, J, m, _, theta, w = KANE
    vx, vy, eps = 0.020333397403910602, -0.6457209039253846, 0.9
    run = hb.simulate(rod(*KANE, vx, eps=eps, falls=vy), until=1e-3, **options)
    s, c = l * math.sin(theta), l * math.cos(theta)
    mass = np.diag([m, m, J])
    ways = np.array([[0.0, 1.0, -c], [1.0, 0.0, s]])
    v = np.array([vx, vy, w])
    to = np.linalg.inv(mass) @ ways.T
    asked = np.array([-eps, 0.0]) * (ways @ v) - ways @ v
    after = v + to @ np.linalg.solve(ways @ to, asked)
    hit = next(e for e in run.events if any(x.impulses for x in e.steps))
    found = [run[n].at(hit.t, side="right") for n in ("vx.f", "vy.f", "w.f")]
    assert found == pytest.approx(list(after), rel=1e-9)
    made = 0.5 * (after @ mass @ after - v @ mass @ v)
    (said,) = [x for x in run.warnings if "creates" in x]
    assert f"creates {made:.6g} J" in said


@pytest.mark.parametrize("impact", ["poisson", "lzb", "lzb_hertz"])
def test_laws_of_impacts_without_friction_say_what_they_leave_out(impact: str) -> None:
    run = hb.simulate(rod(*KANE, 0.02, eps=0.9, falls=-0.65), until=1e-3, impact=impact)
    assert any("has no friction: the impulses of slip are left out" in w for w in run.warnings)


def held_twice(limit: float, breakaway: float, stiff: bool) -> hb.Model:
    """A body that a growing force pushes against two brakes, rigid or each behind a spring."""
    m = hb.Model("held", domain="translational")
    m.add(push=hb.Se("1 [N/s]*time"), body=hb.I("1 kg"), v=hb.One())
    m.bond("push -> v -> body")
    for k in (1, 2):
        m.add(**{f"g{k}": hb.One(law="coulomb", limit=limit, breakaway=breakaway)})
        if stiff:
            m.add(**{f"n{k}": hb.Zero(), f"k{k}": hb.C("1 um/N"), f"d{k}": hb.R("1 kN*s/m")})
            m.add(**{f"e{k}": hb.One()})
            m.bond(f"v -> n{k} -> g{k}", f"n{k} -> e{k} -> k{k}", f"e{k} -> d{k}")
        else:
            m.bond(f"v -> g{k}")
    return m


def test_friction_that_others_hold_at_rest_is_said_to_have_several_answers() -> None:
    run = hb.simulate(held_twice(1.0, 1.5, stiff=False), "3.4 s")
    (said,) = run.warnings
    assert '"v -> g2".e open; least leakage decides' in said and run.audit().holds()
    # whatever the shares: as long as both together can hold it
    assert run.events[-1].t == pytest.approx(3.0, abs=1e-11)
    # where a stiffness decides, all brakes hold what they can
    run = hb.simulate(held_twice(1.0, 1.5, stiff=True), "3.1 s")
    assert not run.warnings
    assert abs(float(run["v.f"].at(2.9))) < 1e-5 < float(run["v.f"].at(3.1))
    # where rest holds no more than motion, shares are open all the same
    run = hb.simulate(held_twice(1.0, 1.0, stiff=False), "2.5 s")
    assert len(run.warnings) == 1 and run.events[-1].t == pytest.approx(2.0, abs=1e-11)
