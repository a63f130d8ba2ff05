"""A gap that is not the distance that the bonds close is refused; so is nothing else."""

import math

import pytest
from scipy.integrate import quad

import hybond as hb


def ball(gap: str, bond: str) -> hb.Model:
    m = hb.Model("ball", domain="translational", parameters={"g": "9.81 m/s^2"})
    m.add(weight=hb.Se("-1 [kg]*g"), ball=hb.I("1 kg"), v=hb.One())
    m.add(contact=hb.Zero(law="unilateral", gap=gap, restitution=0.5))
    m.bond("weight -> v -> ball", bond)
    m.signal(height=hb.Integral("v.f", "1 m"))
    return m


@pytest.mark.parametrize(
    ("gap", "bond"),
    [("-height", "contact -> v"), ("height", "v -> contact"), ("2*height", "contact -> v")],
)
def test_a_gap_that_is_not_the_distance(gap, bond):
    with pytest.raises(hb.ModelError) as caught:
        hb.simulate(ball(gap, bond), until=1)
    assert caught.value.code == "HB-M205"
    assert caught.value.where == "elements.contact.gap"


@pytest.mark.parametrize(
    ("gap", "bond"), [("height", "contact -> v"), ("0.5 [m] - height", "v -> contact")]
)
def test_a_gap_that_is(gap, bond):
    assert hb.simulate(ball(gap, bond), until=0.1).status == "ok"


def test_plastic_bodies_struck_from_both_sides_at_once_stay_together():
    """Masses 1, 3, 0.5, 7 at 4, 1, 1, -2 m/s: all end at the speed of the whole, -6.5/11.5 m/s."""
    m = hb.Model("row", domain="translational")
    places = (0.0, 4.0, 5.0, 9.0)
    bodies = zip((1.0, 3.0, 0.5, 7.0), (4.0, 1.0, 1.0, -2.0), places, strict=True)
    for k, (mass, speed, place) in enumerate(bodies):
        m.add(**{f"m{k}": hb.I(mass, f=speed), f"v{k}": hb.One()})
        m.bond(f"v{k} -> m{k}")
        m.signal(**{f"x{k}": hb.Integral(f"v{k}.f", place)})
    for k in range(3):
        gap = f"x{k + 1} - x{k} - 1 [m]"
        m.add(**{f"c{k}": hb.Zero(law="unilateral", gap=gap, restitution=0.0)})
        m.bond(f"v{k} -> c{k} -> v{k + 1}")
    run = hb.simulate(m, until=2)
    assert [run[f"v{k}.f"].at(2.0) for k in range(4)] == pytest.approx([-6.5 / 11.5] * 4)


@pytest.mark.parametrize(
    ("gap", "right"),
    [("height - plate", True), ("height + plate", False), ("height", False)],
)
def test_a_side_without_mass_may_move_at_any_speed(gap, right):
    """A plate on a spring and a damper: nothing stored says how fast it moves off the contact."""
    m = hb.Model("plate", domain="translational")
    m.add(ball=hb.I("1 kg", f="-1 m/s"), v=hb.One(), w=hb.One())
    m.add(pad=hb.C("1 mm/N"), damper=hb.R("1 N*s/m"))
    m.add(contact=hb.Zero(law="unilateral", gap=gap, restitution=0.0))
    m.bond("v -> ball", "contact -> v", "w -> contact", "w -> pad", "w -> damper")
    m.signal(height=hb.Integral("v.f", "1 cm"), plate=hb.Integral("w.f"))
    if right:
        assert hb.simulate(m, until="0.1 s").status == "ok"
        return
    with pytest.raises(hb.ModelError, match="HB-M205"):
        hb.simulate(m, until="0.1 s")


def crank(gap: str, ratio: str, bond: str = "stop -> v") -> hb.Model:
    """Two inertias that a two-port ties, which turns with the angle; they begin at one motion."""
    m = hb.Model("crank", domain="rotational")
    m.add(J=hb.I(0.05, f=-1), w=hb.One(), tf=hb.TF(ratio))
    m.add(v=hb.One(domain="translational"), M=hb.I(1, f=-2 * math.cos(0.5), domain="translational"))
    m.add(stop=hb.Zero(law="unilateral", gap=gap, restitution=0.5, domain="translational"))
    m.bond("w -> J", "w -> tf -> v -> M", bond)
    m.signal(angle=hb.Integral("w.f", start=0.5))
    return m


def test_a_gap_behind_a_modulated_two_port_between_inertias_is_no_wrong_gap():
    """Kinetic energy is kept up to the stop at `sin(angle) = 0.2`, and is a quarter after it."""
    run = hb.simulate(crank("2*sin(angle) - 0.4", "2*cos(angle)"), until=0.5, rtol=1e-9)

    def inertia(angle: float) -> float:
        return 0.05 + 4 * math.cos(angle) ** 2

    energy = inertia(0.5) / 2
    struck = quad(lambda a: math.sqrt(inertia(a) / 2 / energy), math.asin(0.2), 0.5)[0]
    assert run.events.t[1] == pytest.approx(struck, abs=1e-8)
    after = math.sqrt(energy / 4 * 2 / inertia(math.asin(0.2)))
    assert run["w.f"].at(run.events.t[1]) == pytest.approx(after, rel=1e-8)


@pytest.mark.parametrize(
    ("gap", "ratio", "bond"),
    [
        ("2*sin(angle)", "2*sin(angle)", "stop -> v"),
        ("3*sin(angle)", "2*cos(angle)", "stop -> v"),
        ("2*sin(angle)", "2*cos(angle)", "v -> stop"),
    ],
)
def test_a_wrong_gap_behind_a_modulated_two_port(gap, ratio, bond):
    with pytest.raises(hb.ModelError, match="HB-M205"):
        hb.simulate(crank(gap, ratio, bond), until=0.5)


def slides(gap: str, *, turned: bool = False, ratio: str = "") -> hb.Model:
    """A block of 2 kg at 3 m/s on a floor, which may push it back by the slope it has."""
    m = hb.Model("hill", domain="translational")
    m.add(mx=hb.I(2.0, f=-3.0 if turned else 3.0), my=hb.I(2.0), vx=hb.One(), vy=hb.One())
    m.add(w=hb.Se(-20.0), floor=hb.Zero(law="unilateral", gap=gap))
    m.bond("w -> vy -> my", "floor -> vy", "mx -> vx" if turned else "vx -> mx")
    if ratio:
        m.add(tf=hb.TF(ratio))
        m.bond("vx -> tf -> floor")
    m.signal(x=hb.Integral("vx.f"), y=hb.Integral("vy.f"))
    return m


@pytest.mark.parametrize("solver", ["auto", "radau", "rk4", "moreau-jean"])
@pytest.mark.parametrize(
    "gap",
    [
        "if x < 1.5 then y else y + 0.5*(x - 1.5)",
        "y - max(0, 0.2*(x - 1.5))",
        "if time < 0.5 then y else y + 0.5*(time - 0.5)",
        "y + 0.1*max(0, time - 0.5)",
        "y + 0.1*time^2",
    ],
)
def test_a_floor_that_begins_to_slope_under_a_closed_contact_is_refused(gap, solver):
    """The block slid on in the air, or in the hill: what it is made of was asked only at first."""
    fixed = {"step": "1 ms"} if solver in ("rk4", "moreau-jean") else {}
    with pytest.raises(hb.ModelError, match="HB-M205") as caught:
        hb.simulate(slides(gap, turned=solver == "radau"), until=1.2, solver=solver, **fixed)
    assert caught.value.where == "elements.floor.gap"


def test_one_contact_that_overlaps_from_its_start_hides_no_other():
    m = slides("if x < 1.5 then y else y + 0.5*(x - 1.5)")
    m.add(mz=hb.I(1.0), vz=hb.One(), g=hb.Se(-10.0), low=hb.Zero(law="unilateral", gap="z"))
    m.bond("g -> vz -> mz", "low -> vz")
    m.signal(z=hb.Integral("vz.f", start=-10.0))
    rules = ["a -> b when time > 0.2"]
    m.machine("clock", states={"a": [], "b": []}, start="a", rules=rules)
    with pytest.raises(hb.ModelError, match="HB-M205"):
        hb.simulate(m, until=1.2)


def test_a_fall_after_a_short_step_is_no_jump():
    """An input's corner just before the landing makes a step of 0.3 microseconds."""
    m = hb.Model("ball", domain="translational")
    m.add(ball=hb.I(1.0), v=hb.One(), w=hb.Se(-10.0))
    m.add(floor=hb.Zero(law="unilateral", gap="y - u", restitution=0.5))
    m.bond("w -> v -> ball", "floor -> v")
    m.signal(y=hb.Integral("v.f", start=1.0))
    m.input(u=hb.Input(table=[(0, 0), (0.4470003, 0), (2, 0)]))
    run = hb.simulate(m, until=1.0, solver="moreau-jean", step=1e-3)
    assert not [w for w in run.warnings if "jumps" in w]


def test_a_hill_with_its_bonds_is_run_up():
    """Against 0.5 all but 2.4 of 3 m/s is left, and 4 m/s^2 of weight acts."""
    m = slides("y - max(0, 0.5*(x - 1.5))", ratio="if x < 1.5 then 0 else 0.5")
    run = hb.simulate(m, until=1.0)
    assert run["x"].at(1.0) == pytest.approx(1.5 + 2.4 * 0.5 - 0.5 * 4.0 * 0.5**2, abs=1e-9)
    assert run["y"].at(1.0) == pytest.approx(0.5 * (run["x"].at(1.0) - 1.5), abs=1e-9)


@pytest.mark.parametrize("gap", ["hypot(cos(th), sin(th)) - 0.5", "(sin(th) + 2) - (2 + sin(th))"])
@pytest.mark.parametrize("turned", [False, True])
def test_two_points_of_one_body_have_no_speed_apart(gap: str, turned: bool) -> None:
    """Levers leave 1e-21 m/s of it, and the gap none: that is rounding, and no other distance."""
    m = hb.Model("lever")
    m.add(J=hb.I(1.0, f=1.0), w=hb.One(), p=hb.One(), q=hb.One(), s=hb.One())
    m.add(A=hb.TF("0.1*cos(th)"), B=hb.TF(3), C=hb.TF("0.3*cos(th)"))
    m.add(c=hb.Zero(law="unilateral", gap=gap))
    m.signal(th=hb.Integral("w.f", start=0.3))
    m.bond("w -> J", "w -> A -> p -> B -> q", "w -> C -> s")
    m.bond(*(["q -> c -> s"] if turned else ["s -> c -> q"]))
    run = hb.simulate(m, until=1.0)
    assert run["w.f"].at(1.0) == 1.0
