"""Laws of impacts at several contacts in runs of the library: closed forms, energy, invariance."""

from fractions import Fraction

import numpy as np
import pytest
from engine.by_engine import ENGINE
from example_runs import example
from export.programs import ask, check, compile_quickly, expected, needs_c, read_events
from scipy.optimize import brentq

import hybond as hb
from hybond.engine.outcome.engines import choose_engine

AT_ONCE = ["newton_simultaneous", "poisson", "lzb", "lzb_hertz"]


def row(speeds, masses, eps, *, stiffness=None, order=None, mirrored=False) -> hb.Model:
    """Balls in a row that touch; `order` is that of declaration, mirrored they move the other way.

    Mirrored, the bonds of contacts are turned round with their gaps.
    """
    n, way = len(speeds), -1.0 if mirrored else 1.0
    m = hb.Model("row", domain="translational")
    for k in order or range(n):
        m.add(**{f"m{k}": hb.I(masses[k], f=way * speeds[k]), f"v{k}": hb.One()})
        m.bond(f"v{k} -> m{k}")
        m.signal(**{f"x{k}": hb.Integral(f"v{k}.f", way * k)})
    for k in [j for j in order or range(n) if j < n - 1]:
        a, b = (k + 1, k) if mirrored else (k, k + 1)
        options = {} if stiffness is None else {"stiffness": stiffness[k]}
        law = hb.Zero(law="unilateral", gap=f"x{b} - x{a} - 1 [m]", restitution=eps[k], **options)
        m.add(**{f"c{k}": law})
        m.bond(f"v{a} -> c{k} -> v{b}")
    return m


def after(m: hb.Model, impact: str, n: int, **options) -> np.ndarray:
    """Return the velocities after the impacts with which a run begins."""
    run = hb.simulate(m, until=1e-3, impact=impact, engine=ENGINE, **options)
    return np.array([run[f"v{k}.f"].at(1e-3) for k in range(n)])


# -- rows of equal balls


@pytest.mark.parametrize("law", ["newton_simultaneous", "poisson"])
@pytest.mark.parametrize("n", [2, 3, 5, 8])
@pytest.mark.parametrize("e", [0.0, 0.25, 1.0])
def test_equal_balls_in_a_row(law, n, e):
    """Compression ends at 1/n for all; a part e of it comes back: the others have (1 + e)/n."""
    found = after(row([1] + [0] * (n - 1), [1] * n, [e] * (n - 1)), law, n)
    assert found == pytest.approx([(1 + e) / n - e] + [(1 + e) / n] * (n - 1), abs=1e-14)


def test_three_equal_balls_on_linear_springs():
    """The matrix has eigenvalues 1 and 3: sines until the first contact ends; then two rebound."""
    w = 3**0.5
    t = brentq(lambda t: np.sin(t) + np.sin(w * t) / w, 1.0, 3.0, xtol=1e-15)
    u1 = 1 - 0.5 * (1 - np.cos(t) + (1 - np.cos(w * t)) / 3)
    d2, rate = 0.5 * (np.sin(t) - np.sin(w * t) / w), 0.5 * (np.cos(t) - np.cos(w * t))
    apart = (rate**2 + 2 * d2**2) ** 0.5
    middle = (1 - u1) / 2
    found = after(row([1, 0, 0], [1, 1, 1], [1.0, 1.0]), "lzb", 3)
    assert found == pytest.approx([u1, middle - apart / 2, middle + apart / 2], abs=1e-10)


def test_ten_hertz_balls_as_published():
    """As in Siconos, by the authors of the law: 0.071 m/s back, 0.986 m/s at the far end."""
    found = after(row([1] + [0] * 9, [1] * 10, [1.0] * 9), "lzb_hertz", 10)
    assert [round(found[0], 3), round(found[-1], 3)] == [-0.071, 0.986]


@pytest.mark.parametrize("law", AT_ONCE)
def test_stiffness_counts_for_springs_alone(law):
    found = [
        after(row([1, 0, 0], [1, 2, 3], [0.8, 0.8], stiffness=k), law, 3)
        for k in ([1.0, 1.0], [4e9, 4e9], [1.0, 50.0])
    ]
    assert found[1] == pytest.approx(found[0], abs=1e-11)
    moved = np.abs(found[2] - found[0]).max()
    assert moved > 1e-2 if law.startswith("lzb") else moved == 0.0


@pytest.mark.sampled(3)
@pytest.mark.parametrize("law", AT_ONCE)
@pytest.mark.parametrize("seed", range(4))
def test_rows_keep_momentum_create_no_energy_and_know_no_order(law, seed):
    """What the run says of the impact is what the balls have before and after."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(3, 6))
    u, mass = rng.normal(size=n), rng.uniform(0.3, 4.0, n)
    eps = rng.choice([0.0, 0.4, 0.8, 1.0], n - 1)
    if law == "newton_simultaneous":
        eps = np.full(n - 1, eps[0])  # with others it may create some
    stiffness = rng.uniform(0.2, 9.0, n - 1)
    run = hb.simulate(row(u, mass, eps, stiffness=stiffness), until=1e-3, impact=law)
    assert run.engine == choose_engine(ENGINE).said
    found = np.array([run[f"v{k}.f"].at(1e-3) for k in range(n)])
    assert mass @ found == pytest.approx(mass @ u, abs=1e-12)
    lost = 0.5 * mass @ (u**2 - found**2)
    assert lost >= -1e-13
    told = [s.energy.lost for e in run.events for s in e.steps if s.energy is not None]
    assert sum(told) == pytest.approx(lost, abs=1e-9)
    assert np.diff(found).min() >= -1e-10
    shuffled = row(u, mass, eps, stiffness=stiffness, order=rng.permutation(n).tolist())
    assert after(shuffled, law, n) == pytest.approx(found, abs=1e-10)
    turned = row(u, mass, eps, stiffness=stiffness, mirrored=True)
    assert -after(turned, law, n) == pytest.approx(found, abs=1e-10)


# -- contact after contact


def exact_sequence(e: Fraction) -> list[Fraction]:
    """Three equal balls, one collision after the other, in rational numbers."""
    u = [Fraction(1), Fraction(0), Fraction(0)]
    while (i := next((i for i in (0, 1) if u[i] > u[i + 1]), None)) is not None:
        a, b = u[i], u[i + 1]
        u[i], u[i + 1] = ((1 - e) * a + (1 + e) * b) / 2, ((1 + e) * a + (1 - e) * b) / 2
    return u


@pytest.mark.parametrize("e", ["1", "1/2", "1/5", "1/10", "2/25"])
def test_three_balls_in_sequence(e):
    found = after(row([1, 0, 0], [1, 1, 1], [float(Fraction(e))] * 2), "newton", 3)
    expected = [float(x) for x in exact_sequence(Fraction(e))]
    assert found == pytest.approx(expected, abs=1e-13)


def test_inelastic_collapse_below_the_critical_restitution():
    """Bernu and Mazighi; McNamara and Young: infinitely many impacts, and all go on together."""
    critical = 7 - 4 * 3**0.5
    found = after(row([1, 0, 0], [1, 1, 1], [0.9 * critical] * 2), "newton", 3)
    assert found == pytest.approx([1 / 3, 1 / 3, 1 / 3], abs=1e-10)


# -- a rod on two supports, a table on four legs


def rod(mass, inertia, half, eps, height, turn, order=(1, 2)) -> hb.Model:
    """A rod on two supports, at `half` on either side of its middle."""
    m = hb.Model("rod", domain="translational")
    m.add(body=hb.I(mass, f=height), v=hb.One())
    m.add(rotor=hb.I(inertia, f=turn, domain="rotational"), w=hb.One(domain="rotational"))
    m.bond("v -> body", "w -> rotor")
    m.signal(h=hb.Integral("v.f", "0 m"), angle=hb.Integral("w.f", "0 rad"))
    for k in order:
        arm = half if k == 1 else -half
        gap = f"h - {arm} [m]*angle" if arm > 0 else f"h + {-arm} [m]*angle"
        m.add(**{f"arm{k}": hb.TF(f"{arm} m")})
        m.add(**{f"c{k}": hb.Zero(law="unilateral", gap=gap, restitution=eps)})
        m.bond(f"c{k} -> v", f"w -> arm{k} -> c{k}")
    return m


@pytest.mark.parametrize("law", AT_ONCE)
@pytest.mark.parametrize("order", [(1, 2), (2, 1)])
def test_a_rod_that_falls_flat_rebounds_flat(law, order):
    run = hb.simulate(rod(2, 5, 3, 0.6, -1.0, 0.0, order), until=1e-3, impact=law, engine=ENGINE)
    assert run["v.f"].at(1e-3) == pytest.approx(0.6, abs=1e-9)
    assert run["w.f"].at(1e-3) == pytest.approx(0.0, abs=1e-9)
    (hit,) = [s for e in run.events for s in e.steps if s.impulses]
    assert [hit.impulses[f"c{k}.e"] for k in (1, 2)] == pytest.approx([1.6, 1.6], abs=1e-9)


@pytest.mark.parametrize("law", ["newton_simultaneous", "poisson"])
@pytest.mark.parametrize("e", [0.0, 0.6, 1.0])
@pytest.mark.parametrize("inertia", [5.0, 3.0])
def test_a_rod_that_rocks(law, e, inertia):
    """It turns about one support, the other tip hits: m b^2 < J lifts the first, else it stays."""
    m, b = 1.0, 2.0
    run = hb.simulate(rod(m, inertia, b, e, -0.5, 0.5 / b), until=1e-3, impact=law, engine=ENGINE)
    v, w = run["v.f"].at(1e-3), run["w.f"].at(1e-3)
    lifted = (1 + e) * (1 / m - b * b / inertia) / (1 / m + b * b / inertia)
    assert v - b * w == pytest.approx(e, abs=1e-12)
    assert v + b * w == pytest.approx(max(lifted, 0.0), abs=1e-12)


LEGS = {"a": (-1, -1), "b": (-1, 1), "c": (1, 1), "d": (1, -1)}


def table(eps, order="abcd") -> hb.Model:
    """A table of 8 kg that falls flat at 1 m/s."""
    m = hb.Model("table", domain="translational")
    m.add(top=hb.I("8 kg", f="-1 m/s"), v=hb.One())
    m.signal(h=hb.Integral("v.f", "0 m"), pitch=hb.Integral("p.f"), roll=hb.Integral("r.f"))
    for axis, inertia in (("p", 2.0), ("r", 3.0)):
        rotation = {"domain": "rotational"}
        m.add(**{axis: hb.One(**rotation), f"J{axis}": hb.I(inertia, **rotation)})
        m.bond(f"{axis} -> J{axis}")
    m.bond("v -> top")
    for leg in order:
        p, r = LEGS[leg]
        gap = f"h - {p} [m]*pitch - {r} [m]*roll"
        m.add(**{leg: hb.Zero(law="unilateral", gap=gap, restitution=eps[leg])})
        m.add(**{f"{leg}p": hb.TF(f"{p} m"), f"{leg}r": hb.TF(f"{r} m")})
        m.bond(f"{leg} -> v", f"p -> {leg}p -> {leg}", f"r -> {leg}r -> {leg}")
    return m


@pytest.mark.parametrize("law", AT_ONCE)
@pytest.mark.parametrize("order", ["abcd", "dbac"])
def test_the_legs_of_a_table_share_equally(law, order):
    run = hb.simulate(
        table(dict.fromkeys("abcd", 0.5), order), until=1e-3, impact=law, engine=ENGINE
    )
    assert run["v.f"].at(1e-3) == pytest.approx(0.5, abs=1e-9)
    (hit,) = [s for e in run.events for s in e.steps if s.impulses]
    assert [hit.impulses[f"{leg}.e"] for leg in "abcd"] == pytest.approx([3.0] * 4, abs=1e-9)


# -- refusals


def refused(m: hb.Model, law: str) -> hb.HybondError:
    with pytest.raises(hb.HybondError) as caught:
        hb.simulate(m, until=1e-3, impact=law)
    return caught.value


@pytest.mark.parametrize("law", ["newton_simultaneous", "poisson"])
def test_dependent_contacts_whose_restitution_differs(law):
    """Springs have an answer."""
    m = table({"a": 0.5, "b": 0.5, "c": 0.5, "d": 0.4})
    error = refused(m, law)
    assert isinstance(error, hb.ModelError)
    assert (error.code, error.where) == ("HB-J202", "a, b, c, d")
    assert error.hint == "give them the same restitution, or choose lzb"
    assert hb.simulate(m, until=1e-3, impact="lzb").status == "ok"


def test_a_law_that_would_create_energy():
    m = row([1, 0, 0.2], [1, 1, 1], [1.0, 0.0])
    error = refused(m, "newton_simultaneous")
    assert isinstance(error, hb.NumericsError)
    assert (error.code, error.where) == ("HB-J201", "c0, c1")
    assert error.hint == "choose poisson or lzb, which never do, or equal restitution"
    for law in ("poisson", "lzb"):
        u = after(m, law, 3)
        assert u @ u <= 1.04


def test_a_mass_that_is_not_linear():
    """The momenta follow the law, the velocities cannot: refused."""
    m = hb.Model("row", domain="generic")
    m.add(a=hb.I({"f": "p + p^3"}, p=1.0), b=hb.I(1.0), va=hb.One(), vb=hb.One())
    m.add(c=hb.Zero(law="unilateral", restitution=0.5))
    m.bond("va -> a", "vb -> b", "va -> c -> vb")
    assert refused(m, "poisson").code == "HB-J206"


def test_what_no_impulse_can_stop():
    """A ball between two walls that are driven together by sources of velocity."""
    m = hb.Model("jam", domain="translational")
    m.add(ball=hb.I("1 kg"), v=hb.One(), left=hb.Sf("1 m/s"), right=hb.Sf("-1 m/s"))
    m.add(a=hb.Zero(law="unilateral", restitution=0.5), b=hb.Zero(law="unilateral"))
    m.bond("v -> ball", "left -> a -> v -> b", "b -> right")
    error = refused(m, "poisson")
    assert (error.code, error.where) == ("HB-J203", "a, b")
    assert error.hint == "give one of the bodies a finite mass, or open one of the contacts"


def test_springs_that_never_come_to_an_end():
    """Restitution so small that the balls meet again and again, with masses far apart."""
    m = row([1.0] + [0.0] * 3, [1.0, 1e-7, 1e3, 1e-7], [1e-9, 1e-9, 1e-9])
    assert refused(m, "lzb").code == "HB-J204"


# -- exported, and from the file


@pytest.mark.sampled(1)
@needs_c
@pytest.mark.parametrize("law", ["poisson", "lzb_hertz"])
@pytest.mark.slow
def test_a_program_has_the_law(law, tmp_path):
    m = example("newtons_cradle")
    text = hb.export(m, to="c", until=1.4, impact=law)
    run = hb.simulate(m, until=1.4, impact=law)
    printed = ask(compile_quickly(text, tmp_path, "cradle"), "--events")
    check("newtons_cradle", read_events(printed), expected(run))
    assert len([e for e in run.events if any(s.impulses for s in e.steps)]) >= 1


def test_the_law_stands_in_the_experiment():
    m = row([1, 0, 0], [1, 1, 1], [1.0, 1.0])
    found = []
    for law in ("newton", "poisson"):
        m.experiment["impact"] = law
        found.append(hb.simulate(m, until=1e-3)["v2.f"].at(1e-3))
    assert found == pytest.approx([1.0, 2 / 3], abs=1e-14)


@pytest.mark.parametrize("law", ["newton_simultaneous", "poisson"])
def test_a_cradle_of_balls_struck_at_once_repeats_itself(law):
    """All meet where they hang, each half period: there and back, four share 2/5 of the speed.

    The gaps between those four were never more than rounding, which does not tell them apart.
    """
    run = hb.simulate(example("newtons_cradle"), until=5.0, impact=law, engine=ENGINE)
    half = np.pi * np.sqrt(0.1 / 0.981)
    hits = [e.t for e in run.events if any(s.impulses for s in e.steps)]
    assert hits == pytest.approx([half * (0.5 + k) for k in range(5)], rel=1e-6)
    for k in (1, 3):
        swings = [run[f"swing{j}.q"].at(k * half) for j in range(1, 6)]
        assert swings == pytest.approx([-0.03, 0.02, 0.02, 0.02, 0.02], rel=1e-6)
    for k in (2, 4):
        swings = [run[f"swing{j}.q"].at(k * half) for j in range(1, 6)]
        assert swings == pytest.approx([-0.05, 0.0, 0.0, 0.0, 0.0], abs=1e-8)


@pytest.mark.parametrize("loss", [1e-5, 3e-4])
def test_speeds_that_are_left_of_large_ones_may_be_off_by_their_rounding(loss: float) -> None:
    """The balls left behind creep with what is left of speeds 1e5 times as large."""
    eps = 1.0 - loss
    m = example("newtons_cradle")
    run = hb.simulate(m, parameters={"eps": eps}, rtol=1e-11)
    assert run.status == "ok" and run.audit().holds()
    fastest = 0.05 * (0.981 / 0.1) ** 0.5
    hit = 0.5 * np.pi * (0.1 / 0.981) ** 0.5
    first = next(e.t for e in run.events if e.t > 0.0)
    assert first == pytest.approx(hit, rel=1e-9)
    speeds = [float(run[f"v{k}.f"].at(hit + 1e-6)) for k in range(1, 6)]
    assert speeds[4] == pytest.approx(((1 + eps) / 2) ** 4 * fastest, rel=1e-7)
    assert sum(speeds) == pytest.approx(fastest, rel=1e-6)


# -- balls side by side: their approach is rounding of their speed


@pytest.mark.parametrize("eps", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("slow", [1e-7, 1e-10])
@pytest.mark.parametrize("law", ["newton", *AT_ONCE[:2]])
def test_balls_that_fly_together_and_hardly_approach(law, slow, eps):
    """Two of equal mass change what their speeds are apart into ``-eps`` of it."""
    m = row([3.0 + slow, 3.0], [0.1, 0.1], [eps])
    run = hb.simulate(m, until=1e-3, impact=law, engine=ENGINE)
    assert run.status == "ok" and run.audit().holds()
    v = [float(run[f"v{k}.f"].at(1e-3)) for k in range(2)]
    assert v[1] - v[0] == pytest.approx(eps * (3.0 + slow - 3.0), abs=2e-15)
    assert v[0] + v[1] == pytest.approx(6.0 + slow, abs=2e-15)


@pytest.mark.parametrize("eps", ["0.99999", "0.99998", "0.9999"])
def test_a_cradle_whose_balls_come_back_side_by_side(eps):
    """Impacts keep momentum; the swing of the centre of all balls is that of one pendulum."""
    m = example("newtons_cradle")
    m.parameters["eps"] = eps
    run = hb.simulate(m, "2.6 s", engine=ENGINE)
    assert run.status == "ok" and run.audit().holds()
    p = sum(float(run[f"ball{k}.p"].at(2.6)) for k in range(1, 6))
    w = (0.981 / 0.1) ** 0.5
    assert p == pytest.approx(0.1 * 0.05 * w * np.sin(w * 2.6), abs=1e-8)
