"""Restitution of a compliant contact, against closed forms derived here and published numbers.

The half period of a spring and damper is checked three ways: the formula of the textbooks, the
package's closed forms, and simulations of graphs in which everything else varies.
"""

import itertools
import json
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.special import gamma

import hybond as hb
from hybond.analysis.restitution.contact import find_contact
from hybond.analysis.restitution.contact_phase import compressive_sign, simulated_phase
from hybond.analysis.restitution.half_period import ENDS, half_period, loaded_half_period
from hybond.analysis.restitution.newton_law import newton_law_model
from hybond.analysis.restitution.report import derivation
from hybond.analysis.restitution.restitution import paper_formula, restitution

EXAMPLES = Path(__file__).parents[2] / "examples"
BONDS = (
    ("weight", "v"),
    ("v", "ball"),
    ("contact", "v"),
    ("contact", "squeeze"),
    ("squeeze", "pad"),
    ("squeeze", "damper"),
)
# all directions of the three bonds around the contact, with the others turned along
SOME = [(a ^ b, b ^ c, a, b, c, a ^ c) for a, b, c in itertools.product((0, 1), repeat=3)] + [
    (1, 1, 0, 0, 0, 1),
    (1, 0, 1, 0, 0, 0),
]


def ball_example():
    return hb.load(EXAMPLES / "bouncing_ball.toml")


def ball(flips=(0,) * 6, *, c="1 mm/N", r="10 N*s/m", m="2 kg"):
    """Return a ball above a springy floor with each bond drawn either way."""
    model = hb.Model("ball", domain="translational", parameters={"m": m, "g": "9.81 m/s^2"})
    # a source's value belongs to its bond, so the weight's sign turns with the arrow
    model.add(
        weight=hb.Se("m*g" if flips[0] else "-m*g"),
        ball=hb.I("m"),
        pad=hb.C(c),
        damper=hb.R(r),
        v=hb.One(),
        contact=hb.Zero(),
        squeeze=hb.One(),
    )
    for (a, b), flip in zip(BONDS, flips, strict=True):
        model.bond(f"{b} -> {a}" if flip else f"{a} -> {b}")
    model.signal(height=hb.Integral("v.f", start="1 m"))
    model.machine(
        "floor",
        states={"away": [], "touching": ["contact"]},
        start="away",
        rules=[
            "away -> touching when height <= 0 and v.f < 0",
            f"touching -> away when contact.e {'>' if flips[2] else '<'} 0",
        ],
    )
    return model


def pair(bonds, *, m1=2.0, m2=3.0, extra=None, rules=None):
    """Return two bodies with a springy buffer between, joined by `bonds`."""
    model = hb.Model("pair", domain="translational", parameters={"m1": m1, "m2": m2})
    model.add(
        body1=hb.I("m1", f="1 m/s"),
        body2=hb.I("m2", f="-0.5 m/s"),
        s1=hb.One(),
        s2=hb.One(),
        contact=hb.Zero(),
        squeeze=hb.One(),
        pad=hb.C("1 mm/N"),
        damper=hb.R("10 N*s/m"),
        **(extra or {}),
    )
    model.bond(*bonds)
    model.signal(gap=hb.Integral("s2.f - s1.f", start="1 m"))
    model.machine(
        "hit",
        states={"apart": [], "touching": ["contact"]},
        start="apart",
        rules=rules
        or [
            "apart -> touching when gap <= 0 and s1.f > s2.f",
            "touching -> apart when contact.e < 0",
        ],
    )
    return model


PAIR = (
    "s1 -> body1",
    "s2 -> body2",
    "s1 -> contact",
    "contact -> s2",
    "contact -> squeeze",
    "squeeze -> pad",
    "squeeze -> damper",
)


def textbook(m, c, r):
    """Return exp(-pi zeta / sqrt(1 - zeta^2))."""
    zeta = r / 2 * math.sqrt(c / m)
    return math.exp(-math.pi * zeta / math.sqrt(1 - zeta**2))


def refused(code, call, *args, **options):
    with pytest.raises(hb.HybondError) as error:
        call(*args, **options)
    assert error.value.code == code
    return str(error.value)


# -- the published example


def test_published_value():
    found = restitution(ball_example(), "contact", dt="1 ms")
    assert found.value == pytest.approx(1 / 1.1, rel=1e-14)
    assert round(found.value, 2) == 0.91
    assert str(found.formula) == "(1 + pad.C/(damper.G*Δt))^-1"
    assert found.at(1e-2) == pytest.approx(0.990099, abs=5e-7)
    assert found.at(1e-4) == pytest.approx(0.5, rel=1e-14)


@pytest.mark.parametrize(("r", "expected"), [(0.1, 0.995), (10.0, 0.605)])
def test_half_period_of_the_published_ball(r, expected):
    """With its R read as 10 m/(N s), and as 10 N s/m."""
    found = half_period(1.0, 1e-3, r, ends="zero compression").value
    assert found == pytest.approx(expected, abs=5e-4)
    assert found == pytest.approx(textbook(1.0, 1e-3, r), rel=1e-13)


def test_conductance_and_resistance_are_two_spellings():
    as_r = restitution(ball(r="0.1 N*s/m", m="1 kg"), "contact")
    assert str(as_r.formula) == "(1 + damper.R*pad.C/Δt)^-1"
    assert as_r.value == pytest.approx(1 / 1.1, rel=1e-14)


def test_symbols_are_those_of_the_model():
    model = ball(c="1/k", r="2*d")
    model.parameter(k="1000 N/m", d="5 N*s/m")
    found = restitution(model, "contact")
    assert str(found.formula) == "(1 + 2*d*(1/k)/Δt)^-1"
    assert found.value == pytest.approx(1 / (1 + 10 * 1e-3 / 1e-3), rel=1e-14)
    changed = restitution(model, "contact", parameters={"k": "500 N/m"})
    assert changed.value == pytest.approx(1 / 21, rel=1e-14)


# -- closed forms


@pytest.mark.slow
@given(st.floats(1e-3, 30.0), st.floats(0.01, 100.0), st.floats(1e-6, 1.0))
@example(1.0, 1.0, 0.9375)  # critical, but for rounding
@settings(max_examples=60, deadline=None, derandomize=True)
def test_closed_form_against_its_own_motion(zeta, mass, compliance):
    """The end of the exact motion (matrix exponential) lies where the closed form says."""
    from scipy.linalg import expm

    resistance = 2 * zeta * math.sqrt(mass / compliance)
    matrix = np.array([[0, 1], [-1 / (mass * compliance), -resistance / mass]])
    for ends in ENDS:
        phase = half_period(mass, compliance, resistance, ends=ends)
        if math.isinf(phase.duration):
            assert ends == "zero compression"
            assert zeta >= 1.0
            continue
        d, w = expm(matrix * phase.duration) @ [0.0, 1.0]
        # the tail of an overdamped motion has lost digits to cancellation
        assert -w == pytest.approx(phase.value, rel=1e-7, abs=1e-12)
        force = d / compliance + resistance * w
        measure = force / (resistance or 1.0) if ends == "release" else d / math.sqrt(compliance)
        assert abs(measure) < 1e-9 * max(1.0, math.sqrt(mass))
        loaded = loaded_half_period(mass, compliance, resistance, ends=ends, speed=1.7, pull=0.0)
        assert loaded.value == pytest.approx(phase.value, rel=1e-9, abs=1e-13)


@pytest.mark.slow
@given(st.floats(0.0, 30.0))
def test_a_floor_that_only_pushes_gives_more_back(zeta):
    resistance = 2 * zeta
    release, zero = (half_period(1.0, 1.0, resistance, ends=e).value for e in ENDS)
    assert 0.0 <= zero <= release <= 1.0


def test_critical_damping_is_no_special_point():
    below, at, above = (
        half_period(1.0, 1.0, 2 * zeta, ends="release").value for zeta in (1 - 1e-9, 1.0, 1 + 1e-9)
    )
    assert at == pytest.approx(math.exp(-2.0), rel=1e-15)
    assert below == pytest.approx(at, rel=1e-8)
    assert above == pytest.approx(at, rel=1e-8)


# -- simulation of the model's own graph


def check_phases(model, *, m, c, r, pull, speed=0.8, junction="contact", rel=1e-8):
    found = restitution(model, junction, speed=speed)
    assert found.contact.mass_value == pytest.approx(m, rel=1e-13)
    assert found.contact.values == pytest.approx((c, r), rel=1e-13)
    assert found.value == pytest.approx(1 / (1 + r * c / 1e-3), rel=1e-13)
    for ends in ENDS:
        closed = half_period(m, c, r, ends=ends)
        for method in ("closed form", "simulation"):
            got = found.rebound(ends, method=method)
            assert got is not None, found.notes
            assert got.value == pytest.approx(closed.value, rel=rel)
            assert got.duration == pytest.approx(closed.duration, rel=rel)
        if pull:
            closed = loaded_half_period(m, c, r, ends=ends, speed=speed, pull=pull)
            for method in ("closed form", "simulation"):
                got = found.rebound(ends, method=method, sources=True)
                assert got.value == pytest.approx(closed.value, rel=rel)
                assert got.duration == pytest.approx(closed.duration, rel=rel)
    return found


def test_every_bond_direction():
    # every fifth of all: any two bonds point in all four ways there
    for flips in itertools.islice(itertools.product((0, 1), repeat=6), 0, None, 5):
        graph = ball(flips).flatten()
        contact = find_contact(graph, "contact")
        assert contact.mass_value == pytest.approx(2.0, rel=1e-14)
        assert contact.values == pytest.approx((1e-3, 10.0), rel=1e-14)
        # what pushes the ball up is a positive effort if the bond points at the ball
        assert compressive_sign(graph, contact) == (-1 if flips[2] else 1), flips


@pytest.mark.sampled(3)
@pytest.mark.parametrize("flips", SOME, ids=str)
def test_contact_phase_in_bond_directions(flips):
    """The weight tells whether the side that pushes was found."""
    graph = ball(flips).flatten()
    contact = find_contact(graph, "contact")
    options = {"ends": "release", "speed": 0.8}
    sign = compressive_sign(graph, contact)
    got = simulated_phase(graph, contact, loads=True, sign=sign, **options)
    closed = loaded_half_period(2.0, 1e-3, 10.0, pull=9.81, **options)
    assert got.value == pytest.approx(closed.value, rel=1e-8)
    assert got.duration == pytest.approx(closed.duration, rel=1e-8)


def test_the_ball_with_all_methods():
    check_phases(ball(), m=2.0, c=1e-3, r=10.0, pull=9.81)


@pytest.mark.parametrize(
    "turned", [(), (2,), (3,), (4,), (2, 3), (0, 1, 4), (2, 3, 4, 5, 6)], ids=str
)
def test_two_bodies_collide_with_their_reduced_mass(turned):
    bonds = [
        " -> ".join(reversed(b.split(" -> "))) if k in turned else b for k, b in enumerate(PAIR)
    ]
    # the junction's effort is the pressure if the bodies' arrows say so; else the rules do not
    # need it: the closing rule tells the direction
    rules = [
        "apart -> touching when gap <= 0 and s1.f > s2.f",
        "touching -> apart when squeeze.f < -9",
    ]
    if (2 in turned) != (3 in turned):
        # one arrow turned alone makes a contact of s1 + s2
        rules[0] = "apart -> touching when gap <= 0 and s1.f + s2.f > 0"
    found = check_phases(pair(bonds, rules=rules), m=6 / 5, c=1e-3, r=10.0, pull=0.0)
    assert str(found.contact.mass) == "m1*m2/(m1 + m2)"


def test_three_bodies_and_gravity_between_two():
    extra = {"push1": hb.Se("4 N"), "push2": hb.Se("-9 N")}
    model = pair((*PAIR, "push1 -> s1", "push2 -> s2"), extra=extra)
    check_phases(model, m=6 / 5, c=1e-3, r=10.0, pull=4 / 2 + 9 / 3)


def test_uneven_levers():
    """A lever in front of a body, one in front of the pad, and one on the contact itself."""
    extra = {"arm": hb.TF("a"), "crank": hb.TF(0.5)}
    bonds = (
        "s1 -> body1",
        "s2 -> body2",
        "s1 -> arm.2",
        "arm.1 -> contact",
        "contact -> s2",
        "contact -> crank -> squeeze",
        "squeeze -> pad",
        "squeeze -> damper",
    )
    model = pair(bonds, extra=extra, rules=["apart -> touching when gap <= 0 and s1.f > s2.f"])
    model.parameter(a=3.0)
    # arm: e1 = a e2, f2 = a f1; seen from port 1 (the contact) the mass is a^2 m1
    # crank: seen from port 1 C is C2/m^2 and R is m^2 R2
    m1, m2 = 9 * 2.0, 3.0
    check_phases(model, m=m1 * m2 / (m1 + m2), c=1e-3 / 0.25, r=10 * 0.25, pull=0.0)
    contact = find_contact(model.flatten(), "contact")
    assert str(contact.bodies[0].mass) == "m1*a^2"


def test_levers_entered_from_the_other_side():
    extra = {"arm": hb.TF("a"), "crank": hb.TF(0.5)}
    bonds = (
        "s1 -> body1",
        "s2 -> body2",
        "s1 -> arm -> contact",
        "contact -> s2",
        "contact -> crank.2",
        "crank.1 -> squeeze",
        "squeeze -> pad",
        "squeeze -> damper",
    )
    model = pair(bonds, extra=extra, rules=["apart -> touching when gap <= 0 and s1.f > s2.f"])
    model.parameter(a=3.0)
    m1, m2 = 2.0 / 9, 3.0
    check_phases(model, m=m1 * m2 / (m1 + m2), c=1e-3 * 0.25, r=10 / 0.25, pull=0.0)


def test_gears_without_slip_count_in_full():
    """A wheel on a rack: translation and rotation are one mass at the contact."""
    model = ball()
    model.parameter(r="0.5 m", J="0.75 kg*m^2")
    model.add(
        wheel=hb.I("J", domain="rotational"),
        rack=hb.TF("r"),
        turn=hb.One(domain="rotational"),
    )
    model.bond("v -> rack.2", "rack.1 -> turn", "turn -> wheel")
    found = check_phases(model, m=2 + 0.75 / 0.25, c=1e-3, r=10.0, pull=2 * 9.81 / 5)
    assert found.contact.bodies[0].inertias == ("ball", "wheel")


def test_masses_on_a_differential():
    """Two masses that share a flow weigh m1*m2/(m1 + m2) there."""
    model = ball(m="1 kg")
    model.add(z=hb.Zero(), s1=hb.One(), s2=hb.One(), b1=hb.I("3 kg"), b2=hb.I("6 kg"))
    model.bond("v -> z", "z -> s1 -> b1", "s2 -> z", "b2 -> s2")
    found = restitution(model, "contact", speed=1.0)
    assert found.contact.mass_value == pytest.approx(3.0, rel=1e-14)
    closed = half_period(3.0, 1e-3, 10.0, ends="release")
    got = found.rebound("release", method="simulation")
    assert got.value == pytest.approx(closed.value, rel=1e-8)
    assert any("no closed form with weight" in n for n in found.notes)


def test_contact_inside_a_submodel():
    top = hb.Model("top", domain="translational")
    top.add(b=hb.Submodel(ball(), m="3 kg"))
    contact = find_contact(top.flatten(), "b.contact")
    assert str(paper_formula(contact)) == "(1 + b.damper.R*b.pad.C/Δt)^-1"
    assert (str(contact.mass), contact.mass_value) == ("b.m", 3.0)
    assert "submodel" in refused("HB-A206", newton_law_model, top, "b.contact", 0.5)


def test_springs_and_dampers_side_by_side_and_in_line():
    model = ball()
    model.add(pad2=hb.C("3 mm/N"), damper2=hb.G("0.2 m/(N*s)"))
    model.bond("squeeze -> pad2", "squeeze -> damper2")
    check_phases(model, m=2.0, c=0.75e-3, r=10 + 5, pull=9.81)

    model = ball()
    model.add(pad2=hb.C("3 mm/N"), node=hb.Zero())
    model.bonds.remove("squeeze -> pad")
    model.bond("squeeze -> node", "node -> pad", "node -> pad2")
    check_phases(model, m=2.0, c=4e-3, r=10.0, pull=9.81)


def test_spring_alone_gives_everything_back():
    model = ball()
    del model.elements["damper"]
    model.bonds.remove("squeeze -> damper")
    found = restitution(model, "contact", speed=1.0)
    assert found.value == 1.0
    assert "Nothing dissipates" in found.text()
    assert "Nothing dissipates" in found.markdown()
    for r in found.rebounds:
        assert r.value == pytest.approx(1.0, rel=1e-8)


def test_weight_holds_a_slow_ball():
    found = restitution(ball(r="100 N*s/m"), "contact", speed=1e-3)
    for method in ("closed form", "simulation"):
        held = found.rebound("release", method=method, sources=True)
        assert (held.value, held.duration) == (0.0, math.inf)
    assert "0 (no end)" in found.text()


def test_stiff_overdamped_contact():
    """Rates 8000 apart: the rebound is 1e-4 of the impact speed, the rest of it takes minutes."""
    graph = ball(r="4000 N*s/m").flatten()
    contact = find_contact(graph, "contact")
    options = {"speed": 0.8, "loads": False}
    got = simulated_phase(graph, contact, ends="release", **options)
    closed = half_period(2.0, 1e-3, 4000.0, ends="release")
    assert got.value == pytest.approx(closed.value, rel=1e-6)
    assert got.duration == pytest.approx(closed.duration, rel=1e-6)
    got = simulated_phase(graph, contact, ends="zero compression", **options)
    assert (got.value, got.duration) == (0.0, math.inf)


def test_moving_floor():
    """A floor that rises at constant speed changes nothing but the frame."""
    model = ball()
    model.add(floor_speed=hb.Sf("0.3 m/s"))
    model.bond("floor_speed -> contact")
    check_phases(model, m=2.0, c=1e-3, r=10.0, pull=9.81)


def test_maxwell_contact_has_no_formula_but_a_value():
    """Spring and damper in line: F'' + F'/(RC) + F/(mC) = 0, so a damped half sine."""
    m, c, r = 2.0, 1e-3, 200.0
    model = ball(c=c, r=r)
    model.elements["squeeze"] = hb.Zero()
    model.bonds = [b for b in model.bonds if "squeeze" not in b]
    model.bond("contact -> squeeze", "squeeze -> pad", "squeeze -> damper")
    model.machines.clear()
    # a 0-junction on a controlled 0-junction is one node with it: put a 1-junction between
    model.machine(
        "floor",
        states={"away": [], "touching": ["contact"]},
        start="away",
        rules=["away -> touching when height <= 0 and v.f < 0"],
    )
    found = restitution(model, "contact")
    assert found.refusal.code == "HB-A203"
    assert (found.formula, found.value) == (None, None)
    sigma, omega2 = 1 / (2 * r * c), 1 / (m * c)
    beat = math.sqrt(omega2 - sigma**2)
    got = found.rebound("release")
    assert got.method == "simulation"
    assert got.duration == pytest.approx(math.pi / beat, rel=1e-8)
    assert got.value == pytest.approx(math.exp(-math.pi * sigma / beat), rel=1e-8)
    assert "HB-A203" in found.text()
    with pytest.raises(hb.ModelError, match="HB-A203"):
        found.at(1e-3)


def test_hertz_contact():
    """F = k q^1.5 gives everything back after 2 q_max/v * B(0.4, 0.5)/2.5 (Hertz 1882)."""
    m, k, speed = 2.0, 1e5, 0.8
    model = ball(r="0 N*s/m")
    model.elements["pad"] = hb.C({"e": "k*q^1.5"})
    model.parameter(k=f"{k} N/m^(3/2)")
    model.elements["weight"] = hb.Se(0)
    quiet = restitution(model, "contact")
    assert quiet.refusal.code == "HB-A204"
    assert quiet.rebounds == ()
    assert "speed=" in quiet.notes[0]
    got = restitution(model, "contact", speed=speed).rebound("release")
    deepest = (1.25 * m * speed**2 / k) ** 0.4
    whole = 2 * deepest / speed * 0.4 * gamma(0.4) * gamma(0.5) / gamma(0.9)
    assert got.speed == speed
    assert got.value == pytest.approx(1.0, rel=1e-7)
    assert got.duration == pytest.approx(whole, rel=1e-6)


@pytest.mark.slow
def test_quadratic_damper_under_gravity():
    m, c, drag, speed = 2.0, 1e-3, 5.0, 0.8
    model = ball()
    model.elements["damper"] = hb.R({"e": "5*f*abs(f)"})
    model.domain = "generic"
    model.parameters = {"m": 2.0, "g": 9.81}
    model.elements["pad"] = hb.C(c)
    model.signals["height"] = hb.Integral("v.f", start=1.0)

    def force(d, w):
        return d / c + drag * w * abs(w)

    def released(t, y):
        return force(*y) if t > 1e-6 else 1.0

    released.terminal = True
    released.direction = -1
    exact = solve_ivp(
        lambda t, y: [y[1], 9.81 - force(*y) / m],
        (0, 1),
        [0.0, speed],
        rtol=1e-12,
        atol=1e-14,
        method="DOP853",
        events=released,
    )
    got = restitution(model, "contact", speed=speed).rebound("release", sources=True)
    assert got.value == pytest.approx(-exact.y_events[0][0][1] / speed, rel=1e-8)
    assert got.duration == pytest.approx(exact.t_events[0][0], rel=1e-8)


def test_what_stays_on_a_body_is_in_the_simulation():
    """A body that drags on a rail: no closed form, and less comes back."""
    model = ball()
    model.add(rail=hb.R("30 N*s/m"))
    model.bond("v -> rail")
    found = restitution(model, "contact")
    assert found.rebound("release", method="closed form") is None
    assert "rail" in found.notes[0]
    matrix = np.array([[0, 1], [-1 / (2e-3), -(10 + 30) / 2]])
    rates = np.linalg.eigvals(matrix)
    sigma, beat = -rates[0].real, abs(rates[0].imag)
    got = found.rebound("zero compression")
    assert got.duration == pytest.approx(math.pi / beat, rel=1e-8)
    assert got.value == pytest.approx(math.exp(-math.pi * sigma / beat), rel=1e-8)


# -- what it shows


def test_text_markdown_latex_record():
    found = restitution(ball_example(), "contact", dt=1e-3, speed="7.672027 m/s")
    assert found.latex() == (
        r"\varepsilon = \left(1 + \frac{C_{\mathrm{pad}}}{G_{\mathrm{damper}} \, \Delta t}"
        r"\right)^{-1}"
    )
    text = found.text()
    assert "= 0.909091" in text
    assert "depends on the time step" in text
    assert [s.number for s in derivation(found)] == [7, 8, 9, 10, 11, 12, 13, 14]
    assert found.latex() in found.markdown()
    record = json.loads(json.dumps(found.record(), allow_nan=False))
    assert record["value"] == pytest.approx(1 / 1.1)
    assert len(record["integrated"]) == 8
    assert {r["speed"] for r in record["integrated"]} == {None, 7.672027}


def test_derivation_is_algebra():
    """Each step follows from those before: checked with sympy, in the model's symbols."""
    sympy = pytest.importorskip("sympy")
    found = restitution(ball_example(), "contact")
    names = "m pad_C damper_G dt a_mid a_last a_first q v_last eps v_first v_after"
    symbols = {n: sympy.Symbol(n) for n in names.split()}

    def side(text):
        for old, new in (
            ("a(i+1)", "a_last"),
            ("a(i-1)", "a_first"),
            ("a(i)", "a_mid"),
            ("q(i)", "q"),
            ("v(i+1)", "v_last"),
            ("v(i-1)", "v_first"),
            ("v(after)", "v_after"),
            ("v(before)", "v_first"),
            ("pad.C", "pad_C"),
            ("damper.G", "damper_G"),
            ("Δt", "dt"),
            ("ε", "eps"),
            ("^", "**"),
        ):
            text = text.replace(old, new)
        return sympy.sympify(text, locals=symbols)

    steps = {}
    for s in derivation(found):
        left, right = s.text.split(" = ")
        steps[s.number] = side(left) - side(right)
    a_last, q, v_last = symbols["a_last"], symbols["q"], symbols["v_last"]
    # (9) with v(i+1) = -q/dt is (10); (10) with (8) is (11); (11) with a(i) = a(i+1) is (12)
    ten = sympy.solve(steps[9].subs(v_last, -q / symbols["dt"]), a_last)[0]
    assert sympy.simplify(ten - sympy.solve(steps[10], a_last)[0]) == 0
    eleven = ten.subs(q, sympy.solve(steps[8], q)[0])
    assert sympy.simplify(eleven - sympy.solve(steps[11], a_last)[0]) == 0
    twelve = sympy.solve(steps[11].subs(symbols["a_mid"], a_last), a_last)[0]
    assert sympy.simplify(twelve - sympy.solve(steps[12], a_last)[0]) == 0
    ratio = sympy.solve(steps[14], symbols["eps"])[0]
    assert sympy.simplify(twelve / symbols["a_first"] - ratio) == 0


# -- refusals


def test_refusals_of_what_is_no_contact():
    model = ball()
    assert "did you mean 'contact'" in refused("HB-A201", restitution, model, "contac")
    refused("HB-A201", restitution, model, "v")
    refused("HB-A201", restitution, model, "squeeze")
    refused("HB-A201", restitution, model, "contact", state="flying")
    bare = hb.load(EXAMPLES / "bullet_and_wood.toml")
    refused("HB-A202", restitution, bare, "contact")
    refused("HB-A202", restitution, hb.load(EXAMPLES / "bouncing_ball_newton.toml"), "contact")
    model = ball()
    del model.elements["ball"]
    model.bonds.remove("v -> ball")
    assert "nothing collides" in refused("HB-A202", restitution, model, "contact")


def test_refusals_of_structure():
    model = ball()
    model.add(link=hb.TF("1 + height/(1 m)"))
    model.bonds.remove("contact -> v")
    model.bond("contact -> link -> v")
    refused("HB-A205", restitution, model, "contact")
    model = ball()
    model.bond("squeeze -> v")
    assert "loop" in refused("HB-A205", restitution, model, "contact")
    model = ball()
    model.elements["ball"] = hb.I({"f": "p/m + p^3"})
    model.domain, model.parameters = "generic", {"m": 2.0, "g": 9.81}
    model.elements["pad"], model.elements["damper"] = hb.C(1e-3), hb.R(10.0)
    model.signals["height"] = hb.Integral("v.f", start=1.0)
    refused("HB-A205", restitution, model, "contact")


def test_refusals_of_the_formula():
    model = ball()
    model.elements["damper"] = hb.R("10*(1 + time)")
    model.domain, model.parameters = "generic", {"m": 2.0, "g": 9.81}
    model.elements["pad"] = hb.C(1e-3)
    model.signals["height"] = hb.Integral("v.f", start=1.0)
    assert find_contact(model.flatten(), "contact").refusal.code == "HB-A204"
    model = ball()
    del model.elements["pad"]
    model.bonds.remove("squeeze -> pad")
    found = restitution(model, "contact")
    assert found.refusal.code == "HB-A203"
    refused("HB-A203", paper_formula, found.contact)


@pytest.mark.parametrize("bad", [{"dt": 0}, {"dt": "1 m"}, {"dt": math.nan}, {"speed": "1 s"}])
def test_refusals_of_values(bad):
    refused("HB-A207", restitution, ball(), "contact", **bad)


# -- the model by Newton's law


def times(run):
    return [e.t for e in run.events[1:]]


def test_newton_model_bounces_as_published():
    simple = newton_law_model(ball_example(), "contact", "1/1.1")
    again = hb.loads(hb.dumps(simple))
    assert hb.dumps(again) == hb.dumps(simple)
    for model in (simple, again):
        run = hb.simulate(model, until="6 s")
        impacts = times(run)
        published = [0.782062, 2.203993, 3.496657, 4.671806, 5.740124]
        assert impacts == pytest.approx(published, abs=6e-7)
        assert run["v.f"].at(impacts[0], side="left") == pytest.approx(-7.672027, abs=6e-7)
        for k, peak in enumerate([2.479339, 2.049040, 1.693422, 1.399522]):
            top = 0.5 * (impacts[k] + impacts[k + 1])
            assert run["height"].at(top) == pytest.approx(peak, abs=6e-7)


def test_newton_model_is_the_shipped_one():
    """It says what the example written by hand says."""
    made = newton_law_model(ball_example(), "contact", "1/1.1")
    by_hand = hb.load(EXAMPLES / "bouncing_ball_newton.toml")
    assert made.elements["rebound"] == by_hand.elements["rebound"]
    assert made.bonds == by_hand.bonds
    assert made.machines["floor"].rules[0] == by_hand.machines["floor"].rules[0].replace(
        "impact", "collide"
    )
    assert "pad" not in made.layout
    assert made.layout["rebound"] == (3, 0)


def test_newton_model_of_the_papers_own_graph():
    """The paper's deformation stands still in flight: the machine switches it too."""
    model = hb.load(EXAMPLES / "bouncing_ball_margetts.toml")
    found = restitution(model, "contact")
    assert str(found.formula) == "(1 + C/(R*Δt))^-1"
    assert found.value == pytest.approx(1 / 1.1, rel=1e-14)
    simple = newton_law_model(model, "contact", found.value)
    assert "squeeze" not in simple.elements
    assert times(hb.simulate(simple, until="3 s"))[:2] == pytest.approx(
        [0.782062, 2.203993], abs=6e-7
    )


def test_newton_model_with_the_papers_value():
    found = restitution(ball_example(), "contact", dt="1 ms")
    simple = newton_law_model(ball_example(), "contact", found.value)
    assert times(hb.simulate(simple, until="3 s"))[1] == pytest.approx(2.203993, abs=6e-7)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("flips", SOME, ids=str)
def test_newton_model_in_every_bond_direction(flips):
    run = hb.simulate(newton_law_model(ball(flips), "contact", 0.5), until="1 s")
    first = math.sqrt(2 / 9.81)
    assert times(run) == pytest.approx([first, 2 * first], rel=1e-9)
    assert run["v.f"].at(times(run)[0]) == pytest.approx(0.5 * 9.81 * first, rel=1e-9)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("turned", [(), (0,), (1,), (2, 3), (4, 5), (0, 1, 2, 3, 4, 5, 6)], ids=str)
@pytest.mark.parametrize(
    ("m1", "m2", "v1", "v2", "eps"),
    [(1, 1, 1, 0, 0.8), (1, 1, 1, 0, 1.0), (2, 1, 1, -1, 0.5), (1, 3, 1, -2, 0.0)],
)
def test_newton_model_of_two_bodies(turned, m1, m2, v1, v2, eps):
    bonds = [
        " -> ".join(reversed(b.split(" -> "))) if k in turned else b for k, b in enumerate(PAIR)
    ]
    rules = ["apart -> touching when gap <= 0 and s1.f > s2.f"]
    model = pair(bonds, m1=m1, m2=m2, rules=rules)
    # an I's start is its own, whichever way its bond is drawn
    model.elements["body1"] = hb.I("m1", f=v1 * (-1 if 0 in turned else 1))
    model.elements["body2"] = hb.I("m2", f=v2 * (-1 if 1 in turned else 1))
    run = hb.simulate(newton_law_model(model, "contact", eps), until="1.5 s", on_error="return")
    (t, *_), wanted = times(run), 1.0 / (v1 - v2)
    assert t == pytest.approx(wanted, rel=1e-9)
    common, closing = m1 * v1 + m2 * v2, eps * (v1 - v2)
    after1 = (common - m2 * closing) / (m1 + m2)
    after2 = (common + m1 * closing) / (m1 + m2)
    assert run["s1.f"].at(t) == pytest.approx(after1, abs=1e-9)
    assert run["s2.f"].at(t) == pytest.approx(after2, abs=1e-9)


def test_newton_model_through_levers():
    """The rule speaks of the closing speed; momentum at the contact obeys the lever."""
    extra = {"arm": hb.TF("a")}
    bonds = (
        "s1 -> body1",
        "s2 -> body2",
        "s1 -> arm -> contact",
        "contact -> s2",
        "contact -> squeeze",
        "squeeze -> pad",
        "squeeze -> damper",
    )
    model = pair(bonds, extra=extra, rules=["apart -> touching when gap <= 0 and 3*s1.f > s2.f"])
    model.signal()
    model.signals["gap"] = hb.Integral("s2.f - 3*s1.f", start="1 m")
    model.parameter(a=3.0)
    run = hb.simulate(newton_law_model(model, "contact", 0.5), until="1 s")
    (t,) = times(run)
    assert t == pytest.approx(1 / 3.5, rel=1e-9)
    v1, v2 = run["s1.f"].at(t), run["s2.f"].at(t)
    assert v2 - 3 * v1 == pytest.approx(0.5 * 3.5, rel=1e-9)
    # the blow P on body 2 is 3 P on body 1
    assert 2 * (v1 - 1) == pytest.approx(-3 * 3 * (v2 + 0.5), rel=1e-9)


def test_newton_model_on_a_rising_floor():
    model = ball()
    model.add(lift=hb.Sf("30 cm/s"))
    model.bond("lift -> contact")
    model.signals["height"] = hb.Integral("v.f - 0.3 [m/s]", start="1 m")
    model.machines.clear()
    model.machine(
        "floor",
        states={"away": [], "touching": ["contact"]},
        start="away",
        rules=["away -> touching when height <= 0 and v.f < 0.3 [m/s]"],
    )
    run = hb.simulate(newton_law_model(model, "contact", 0.5), until="0.6 s")
    # 1 = 0.3 t + g t^2/2
    (t,) = times(run)
    assert t == pytest.approx((-0.3 + math.sqrt(0.09 + 2 * 9.81)) / 9.81, rel=1e-9)
    assert run["v.f"].at(t) - 0.3 == pytest.approx(0.5 * (9.81 * t + 0.3), rel=1e-9)


def test_newton_model_adds_the_direction_if_the_rule_lacks_it():
    model = ball()
    model.machines.clear()
    model.machine(
        "floor",
        states={"away": [], "touching": ["contact"]},
        start="away",
        rules=["away -> touching when height <= 0", "touching -> away when contact.e < 0"],
    )
    simple = newton_law_model(model, "contact", 0.5)
    assert simple.machines["floor"].rules[0] == "away -> collide when height <= 0 and v.f < 0"
    assert len(times(hb.simulate(simple, until="1 s"))) == 2


def test_newton_model_of_nonlinear_and_maxwell_contacts():
    model = ball(r="0 N*s/m")
    model.elements["pad"] = hb.C({"e": "k*q^1.5"})
    model.parameter(k="1e5 N/m^(3/2)")
    simple = newton_law_model(model, "contact", 0.5)
    assert set(simple.elements) == {"weight", "ball", "v", "contact", "rebound"}


def test_newton_model_keeps_what_is_taken():
    model = ball()
    model.parameter(eps=3.0)
    model.add(rebound=hb.R("1 N*s/m"))
    model.bond("v -> rebound")
    simple = newton_law_model(model, "contact", 0.5)
    assert simple.parameters["eps"] == 3.0
    assert simple.elements["rebound_contact"].value == "-eps_contact*pre(v.f)"
    assert set(model.elements) >= {"pad", "damper"}, "the model given stays as it was"


def test_newton_model_refusals():
    model = ball()
    model.machines.clear()
    model.machine(
        "floor",
        states={"away": [], "touching": ["contact"]},
        start="away",
        rules=["away -> touching when height <= 0 and v.f < 0 and pad.q <= 0"],
    )
    assert "pad" in refused("HB-A206", newton_law_model, model, "contact", 0.5)
    model = ball()
    model.signal(heat="damper.e*damper.f")
    assert "signals.heat" in refused("HB-A206", newton_law_model, model, "contact", 0.5)
    model = ball()
    model.signal(slip="contact.f")
    refused("HB-A206", newton_law_model, model, "contact", 0.5)
    model = ball()
    model.machines["floor"] = type(model.machines["floor"])(
        {"away": [], "touching": ["contact"]}, "touching", ("touching -> away when v.f > 0",)
    )
    assert "starts in contact" in refused("HB-A206", newton_law_model, model, "contact", 0.5)
    model = ball()
    model.machines["floor"] = type(model.machines["floor"])(
        {"away": [], "touching": ["contact"]}, "away", ("away -> touching when height <= 0",)
    )
    assert "direction" in refused("HB-A206", newton_law_model, model, "contact", 0.5)
    for bad in (-0.1, "-1/2"):
        refused("HB-A207", newton_law_model, ball(), "contact", bad)
    model = ball()
    model.add(mass2=hb.I("1 g"))
    model.bond("squeeze -> mass2")
    # a mass on the pad is a second body: then nothing gives way between
    refused("HB-A202", newton_law_model, model, "contact", 0.5)
