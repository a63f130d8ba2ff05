"""Junction laws of the exported runtime: events and states are those of the reference."""

from pathlib import Path

import pytest
from portable_runs import assert_the_same

import hybond as hb

EXAMPLES = Path(__file__).parents[3] / "examples"
IDLE = ("cockcroft_walton", "mmc_arm", "parallel_resonant_converter")
"""Where rounding says which diode is called conducting while it carries nothing."""
FILES = [
    "ball_on_shaker",
    "bead_column",
    "block_on_incline",
    "bouncing_ball_contact",
    "buck",
    "cam_follower",
    "check_valve",
    "cockcroft_walton",
    "diode_bridge",
    "diode_inductor_law",
    "end_stops",
    "friction_oscillator",
    "half_wave_rectifier",
    "impacting_stick",
    "mmc_arm",
    "newtons_cradle",
    "one_way_clutch",
    "parallel_resonant_converter",
    "planar_puck",
    "ratchet",
    "rlcd",
    "six_pulse_rectifier",
    "stick_slip",
    "thyristor_rectifier",
    "woodpecker",
]


@pytest.mark.sampled(1)
@pytest.mark.parametrize("name", FILES)
def test_examples_with_laws_run_as_the_reference_does(name, monkeypatch):
    model = hb.load(EXAMPLES / f"{name}.toml")
    options = {"until": SHORTER[name]} if name in SHORTER else {}
    assert_the_same(model, monkeypatch, events=name not in IDLE, **options)


SHORTER = {"cockcroft_walton": 0.06, "diode_bridge": 0.002, "parallel_resonant_converter": 5e-5}
"""Runs of which a part is enough, s."""


def clipper(bond, law):
    """A source, a diode and a capacitor with a load; the diode's bonds in either direction."""
    way = "" if bond == "with" else "-"
    gate = {"gate": "sin(300*time + 2) > 0"} if law == "thyristor" else {}
    m = hb.Model("clipper", domain="electrical")
    m.add(V=hb.Se(f"{way}10*sin(300*time)"), i=hb.One(law=law, **gate), r=hb.R("2 ohm"))
    m.add(z=hb.Zero(), c=hb.C("1 mF"), g=hb.G("0.05 S"))
    m.bond("V -> i" if bond == "with" else "i -> V", "i -> r", "i -> z -> c", "z -> g")
    return m


@pytest.mark.sampled(1)
@pytest.mark.parametrize("bond", ["with", "against"])
@pytest.mark.parametrize("law", ["diode", "thyristor"])
def test_diodes_and_thyristors_in_both_directions(bond, law, monkeypatch):
    a, _ = assert_the_same(clipper(bond, law), monkeypatch, until=0.1)
    assert len(a.events) > 4


@pytest.mark.sampled(1)
@pytest.mark.parametrize("limit", ["3 N", "2 [N] + 0.3*abs(spring.e)"])
def test_friction_whose_limit_follows_a_force(limit, monkeypatch):
    m = hb.Model("oscillator", domain="translational")
    m.add(mass=hb.I("1 kg", f="5 m/s"), spring=hb.C("0.02 m/N"))
    m.add(v=hb.One(law="coulomb", limit=limit))
    m.bond("v -> mass", "v -> spring")
    assert_the_same(m, monkeypatch, until=5)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("push", [(0.5, 0.0), (2.0, 1.5), (3.0, 2.5)])
def test_a_block_in_the_plane_slips_stops_and_holds(push, monkeypatch):
    """Friction of 2.5 N: a block that is pushed too weakly, just so, and enough to slip on."""
    m = hb.Model("block", domain="translational")
    for axis, start, force in zip("xy", (3.0, 4.0), push, strict=True):
        m.add(**{f"m{axis}": hb.I("1 kg", f=start), f"push_{axis}": hb.Se(force)})
    m.add(x=hb.One(law="coulomb", limit=2.5, breakaway=3), y=hb.One(law="coulomb", pair="x"))
    m.bond("x -> mx", "y -> my", "push_x -> x", "push_y -> y")
    assert_the_same(m, monkeypatch, until=4)


@pytest.mark.slow
def test_a_contact_on_a_moving_table_with_nonlinear_storage(monkeypatch):
    """The response of a nonlinear graph is made of differences."""
    m = hb.Model("hammer", domain="translational")
    m.add(head=hb.I("0.5 kg"), weight=hb.Se("-4.9 N"), v=hb.One())
    m.add(pad=hb.C({"e": "2e3*q + 4e5*q^3"}), w=hb.One(), plate=hb.I("2 kg"), damp=hb.R("3 N*s/m"))
    m.add(touch=hb.Zero(law="unilateral", gap="above - below", restitution=0.4))
    m.bond("weight -> v -> head", "touch -> v", "w -> touch", "w -> plate", "w -> pad", "w -> damp")
    m.signal(above=hb.Integral("v.f", start="0.2 m"), below=hb.Integral("w.f", start=0))
    a, _ = assert_the_same(m, monkeypatch, until=0.6)
    assert len(a.events) > 2


def test_a_limit_that_would_push_is_refused_as_by_the_reference(monkeypatch):
    m = hb.Model("block", domain="translational")
    m.add(
        mass=hb.I("1 kg"), push=hb.Se("5 N"), v=hb.One(law="coulomb", limit="2 [N] - 2*time*1[N/s]")
    )
    m.bond("push -> v -> mass")
    _, b = assert_the_same(m, monkeypatch, until=2)
    assert b.code == "HB-N407"


def test_a_guard_that_holds_at_zero_beside_a_diode(monkeypatch):
    """A GTO that is switched off as its current ceases, while a diode at its node goes on."""
    m = hb.Model("gto", domain="electrical")
    m.add(source=hb.Se("311 [V]*cos(300 [1/s]*time)"), coil=hb.I("7 mH"), a=hb.One())
    m.add(n=hb.Zero(), gto=hb.One(), diode=hb.One(law="diode"), leak=hb.R("120 ohm"))
    m.add(load=hb.R("4 ohm"), other=hb.R("6 ohm"))
    m.bond("source -> a -> coil", "a -> n -> leak", "n -> gto -> load", "n -> diode -> other")
    rules = ["on -> off when coil.f <= 0", "off -> on when coil.f > 1 [A]"]
    m.machine("gate", states={"on": ["gto"], "off": []}, start="off", rules=rules)
    a, _ = assert_the_same(m, monkeypatch, until=0.05)
    assert len(a.events) > 6
