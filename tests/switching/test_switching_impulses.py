"""The impulse bond graph of a jump: impulse times mean flow is the energy, bond by bond."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import hybond as hb

sw = hb.switching
EXAMPLES = Path(__file__).parents[2] / "examples"
SIZE = st.floats(0.2, 5.0)
RESTITUTION = st.one_of(st.sampled_from([0.0, 0.5, 1.0]), st.floats(0.0, 1.0))


def drawn(a: str, b: str, forward: bool) -> str:
    return f"{a} -> {b}" if forward else f"{b} -> {a}"


def collision(m1, m2, v1, v2, e, lever=1.0, arrows=(True, True, True)) -> hb.Model:
    """Two bodies that meet at 1 s through a lever: the first one's end moves at lever*v1.

    `arrows` are those of the bodies' bonds and of the bond to the impact law; the velocities are
    those of the 1-junctions, which a start value meets with the sign of the body's arrow.
    """
    m = hb.Model("collision", domain="translational")
    signs = [1.0 if a else -1.0 for a in arrows[:2]]
    m.add(body1=hb.I(m1, f=signs[0] * v1), body2=hb.I(m2, f=signs[1] * v2))
    m.add(s1=hb.One(), s2=hb.One(), arm=hb.TF(lever), contact=hb.Zero())
    away = "s2.f - arm.2.f"
    value = f"-{e!r}*pre(arm.2.f - s2.f)" if arrows[2] else f"{e!r}*pre(arm.2.f - s2.f)"
    m.add(rebound=hb.Sf(value))
    m.bond(drawn("s1", "body1", arrows[0]), drawn("s2", "body2", arrows[1]))
    m.bond("s1 -> arm -> contact -> s2", drawn("contact", "rebound", arrows[2]))
    m.signal(gap=hb.Integral(away, start=lever * v1 - v2))
    m.machine(
        "M",
        states={"apart": [], "collide": ["contact"]},
        start="apart",
        rules=[
            f"apart -> collide when gap <= 0 and {lever!r}*pre(s1.f) > pre(s2.f)",
            f"collide -> apart when {lever!r}*pre(s1.f) <= pre(s2.f)",
        ],
    )
    return m


@settings(max_examples=20, deadline=None)
@given(
    SIZE,
    SIZE,
    st.floats(-1.0, 1.0),
    st.floats(0.3, 2.0),
    RESTITUTION,
    st.floats(0.5, 2.0),
    st.tuples(st.booleans(), st.booleans(), st.booleans()),
)
def test_collisions_with_restitution(m1, m2, v2, closing, e, lever, arrows) -> None:
    v1 = (v2 + closing) / lever
    run = hb.simulate(collision(m1, m2, v1, v2, e, lever, arrows), until=1.5)
    (jump,) = sw.impulse_bond_graph(run, run.events[1])
    # closed form: at the contact the first body weighs m1 / lever^2
    far = m1 / lever**2
    reduced = far * m2 / (far + m2)
    impulse = (1.0 + e) * reduced * closing
    after1, after2 = v1 - lever * impulse / m1, v2 + impulse / m2
    scale = m1 * v1**2 + m2 * v2**2 + reduced * closing**2
    close = {"rel": 1e-9, "abs": 1e-11 * scale}
    assert jump["contact -> s2"].impulse == pytest.approx(impulse, rel=1e-9)
    assert jump["s1 -> arm"].impulse == pytest.approx(lever * impulse, rel=1e-9)
    assert jump["s1 -> arm"].mean_flow == pytest.approx(0.5 * (v1 + after1), rel=1e-9, abs=1e-11)
    assert jump["arm -> contact"].mean_flow == pytest.approx(
        0.5 * lever * (v1 + after1), rel=1e-9, abs=1e-11
    )
    assert jump["contact -> s2"].work == pytest.approx(impulse * 0.5 * (v2 + after2), **close)
    kinetic = [0.5 * m1 * (after1**2 - v1**2), 0.5 * m2 * (after2**2 - v2**2)]
    assert jump.stored.get("body1", 0.0) == pytest.approx(kinetic[0], **close)
    assert jump.stored.get("body2", 0.0) == pytest.approx(kinetic[1], **close)
    assert jump.energy_change == pytest.approx(sum(kinetic), **close)
    lost = 0.5 * (1.0 - e**2) * reduced * closing**2
    # a law that holds no velocity back takes nothing: then the loss is the junction's
    assert set(jump.taken) <= {"rebound" if e else "contact"}
    assert math.fsum(jump.taken.values()) == pytest.approx(lost, **close)
    energy = run.events[1].steps[0].energy
    assert energy.lost == pytest.approx(lost, **close)
    assert jump.energy_change == pytest.approx(energy.after - energy.before, **close)


@pytest.mark.parametrize(("e", "lost"), [(0.0, 0.75), (0.5, 0.5625), (1.0, 0.0)])
def test_the_numbers_of_one_collision(e: float, lost: float) -> None:
    """1.5 kg at 1 m/s on 0.5 kg at -1 m/s: reduced mass 0.375 kg, closing at 2 m/s."""
    run = hb.simulate(collision(1.5, 0.5, 1.0, -1.0, e), until=2)
    (jump,) = sw.impulse_bond_graph(run, run.events[1])
    assert jump.t == pytest.approx(1.0)
    assert jump["s1 -> body1"].impulse == pytest.approx(-0.75 * (1 + e), rel=1e-12)
    assert jump.taken.get("rebound" if e else "contact", 0.0) == pytest.approx(lost, abs=1e-12)
    assert jump.energy_change == pytest.approx(-lost, abs=1e-12)


@pytest.mark.parametrize("forward", [True, False])
def test_a_plastic_contact_keeps_the_loss_in_its_junction(forward: bool) -> None:
    m = hb.Model("stick", domain="translational")
    m.add(a=hb.I(2.0, f=3.0), b=hb.I(4.0), va=hb.One(), vb=hb.One(), grip=hb.Zero())
    m.bond("va -> a", "vb -> b")
    m.bond("va -> grip -> vb" if forward else "vb -> grip -> va")
    m.machine(
        "M", states={"no": [], "yes": ["grip"]}, start="no", rules=["no -> yes when time >= 1"]
    )
    run = hb.simulate(m, until=2)
    (jump,) = sw.impulse_bond_graph(run, run.events[1])
    # 1 m/s together: impulse 4 on b, means 2 and 0.5 m/s
    bonds = ("va -> grip", "grip -> vb") if forward else ("grip -> va", "vb -> grip")
    assert [abs(jump[b].impulse) for b in bonds] == pytest.approx([4.0, 4.0])
    assert [jump[b].mean_flow for b in bonds] == pytest.approx([2.0, 0.5])
    assert dict(jump.stored) == pytest.approx({"a": -8.0, "b": 2.0})
    assert dict(jump.taken) == pytest.approx({"grip": 6.0})


@pytest.mark.parametrize("forward", [True, False])
def test_a_coil_that_is_cut_gives_its_energy_to_the_switch(forward: bool) -> None:
    m = hb.Model("cut", domain="electrical")
    m.add(V=hb.Se("4 V"), j=hb.One(), R=hb.R("2 ohm"), L=hb.I("3 H", f="2 A"), sw=hb.One())
    m.bond("V -> j -> L", "j -> R", drawn("j", "sw", forward))
    m.machine("S", states={"c": ["sw"], "o": []}, start="c", rules=["c -> o when time >= 1"])
    run = hb.simulate(m, until=2)
    (jump,) = sw.impulse_bond_graph(run, run.events[1])
    assert jump["j -> L"].impulse == pytest.approx(-6.0)
    assert jump["j -> L"].mean_flow == pytest.approx(1.0)
    assert dict(jump.taken) == pytest.approx({"sw": 6.0})
    assert jump["V -> j"].work == jump["j -> R"].work == 0.0


def test_a_source_that_is_stepped_onto_a_capacitor_pays_twice_what_it_stores() -> None:
    """The dual: charge C*U at the mean voltage U/2 is stored, C*U*U drawn."""
    m = hb.Model("charge", domain="electrical")
    m.add(V=hb.Se("6 V"), sw=hb.One(), n=hb.Zero(), c=hb.C("0.5 F"))
    m.bond("V -> sw -> n -> c")
    m.machine("S", states={"o": [], "c": ["sw"]}, start="o", rules=["o -> c when time >= 1"])
    run = hb.simulate(m, until=2)
    (jump,) = sw.impulse_bond_graph(run, run.events[1])
    assert jump["V -> sw"].flow_impulse == pytest.approx(3.0)
    assert jump["V -> sw"].work == pytest.approx(18.0)
    assert dict(jump.stored) == pytest.approx({"c": 9.0})
    assert dict(jump.taken) == pytest.approx({"V": -18.0, "sw": 9.0})
    energy = run.events[1].steps[0].energy
    assert (energy.source, energy.lost) == pytest.approx((18.0, 9.0))


def test_through_a_gyrator_a_momentum_is_a_charge() -> None:
    m = hb.Model("gyrator")
    m.add(a=hb.I(2.0, f=3.0), va=hb.One(), g=hb.GY(0.5), sw=hb.One(), k=hb.Zero())
    m.add(c=hb.C(4.0, e=1.0))
    m.bond("va -> a", "va -> g -> sw -> k -> c")
    m.machine("S", states={"o": [], "c": ["sw"]}, start="o", rules=["o -> c when time >= 1"])
    run = hb.simulate(m, until=1.5)
    (jump,) = sw.impulse_bond_graph(run, run.events[1])
    # closed: e = v/2; the momentum 2 (3 - v) through r = 1/2 is the charge 4 (3 - v) = 4 (v/2 - 1)
    v = 8.0 / 3.0
    assert run["a.f"].at(1.0) == pytest.approx(v, rel=1e-12)
    assert jump["va -> g"].impulse == pytest.approx(2.0 * (3.0 - v), rel=1e-9)
    assert jump["g -> sw"].flow_impulse == pytest.approx(4.0 * (3.0 - v), rel=1e-9)
    # the gyrator balances impulse times mean flow against charge times mean effort
    assert jump["va -> g"].work == pytest.approx(jump["g -> sw"].work, rel=1e-9)
    assert jump["va -> g"].work == pytest.approx(9.0 - v**2, rel=1e-9)
    assert dict(jump.stored) == pytest.approx({"a": v**2 - 9.0, "c": 2.0 * (v / 2) ** 2 - 2.0})
    assert dict(jump.taken) == pytest.approx({"sw": 11.0 - 32.0 / 3.0})


def test_impulses_between_1_junctions_follow_from_the_balance() -> None:
    """Neither end names the effort of the bond between two 1-junctions."""
    m = collision(1.5, 0.5, 1.0, -1.0, 0.5)
    m.bonds[m.bonds.index("s1 -> arm -> contact -> s2")] = "s1 -> mid -> arm -> contact -> s2"
    m.add(mid=hb.One(), extra=hb.I(0.5, f=1.0))
    m.bond("mid -> extra")
    run = hb.simulate(m, until=2)
    (jump,) = sw.impulse_bond_graph(run, run.events[1])
    # 2 kg in two parts: reduced mass 0.4, closing at 2
    assert jump["contact -> s2"].impulse == pytest.approx(1.2, rel=1e-9)
    assert jump["s1 -> mid"].impulse == pytest.approx(0.75 * 1.2, rel=1e-9)
    assert jump["s1 -> mid"].mean_flow == pytest.approx(0.7, rel=1e-9)


def test_a_row_of_equal_balls_writes_one_jump_after_the_other() -> None:
    """Newton's cradle of three at one instant: two collisions, each with its own reading."""
    m = hb.Model("cradle", domain="translational")
    for k in (1, 2, 3):
        m.add(**{f"b{k}": hb.I(1.0, f=1.0 if k == 1 else 0.0), f"s{k}": hb.One()})
        m.bond(f"s{k} -> b{k}")
    for k in (1, 2):
        m.add(**{f"c{k}": hb.Zero(), f"x{k}": hb.Sf(f"-pre(s{k}.f - s{k + 1}.f)")})
        m.bond(f"s{k} -> c{k} -> s{k + 1}", f"c{k} -> x{k}")
        m.signal(**{f"gap{k}": hb.Integral(f"s{k + 1}.f - s{k}.f", start=1.0 if k == 1 else 0.0)})
        m.machine(
            f"M{k}",
            states={"apart": [], "hit": [f"c{k}"]},
            start="apart",
            rules=[
                f"apart -> hit when gap{k} <= 1e-9 and pre(b{k}.f) > pre(b{k + 1}.f)",
                f"hit -> apart when pre(b{k}.f) <= pre(b{k + 1}.f)",
            ],
        )
    run = hb.simulate(m, until=2)
    jumps = sw.impulse_bond_graph(run, run.events[1])
    assert len(jumps) == 2
    assert [dict(j.stored) for j in jumps] == [
        pytest.approx({"b1": -0.5, "b2": 0.5}),
        pytest.approx({"b2": -0.5, "b3": 0.5}),
    ]
    assert [dict(j.taken) for j in jumps] == [{}, {}]


@pytest.mark.parametrize("arrows", [(a, b) for a in (True, False) for b in (True, False)])
def test_two_capacitors_that_are_joined(arrows: tuple[bool, bool]) -> None:
    """1 F at 10 V and 2 F at 4 V end at 6 V: 4 C at the mean voltages 8 and 5 V, 12 J lost."""
    m = hb.Model("joined", domain="electrical")
    m.add(a=hb.C("1 F", e="10 V"), b=hb.C("2 F", e="4 V"), n=hb.Zero(), k=hb.Zero(), sw=hb.One())
    m.bond(drawn("n", "a", arrows[0]), drawn("k", "b", arrows[1]), "n -> sw -> k")
    m.machine("S", states={"o": [], "c": ["sw"]}, start="o", rules=["o -> c when time >= 1"])
    run = hb.simulate(m, until=2)
    (jump,) = sw.impulse_bond_graph(run, run.events[1])
    assert [jump[b].flow_impulse for b in ("n -> sw", "sw -> k")] == pytest.approx([4.0, 4.0])
    assert [jump[b].mean_effort for b in ("n -> sw", "sw -> k")] == pytest.approx([8.0, 5.0])
    assert dict(jump.stored) == pytest.approx({"a": -32.0, "b": 20.0})
    assert dict(jump.taken) == pytest.approx({"sw": 12.0})


@pytest.mark.parametrize("forward", [True, False])
@pytest.mark.parametrize("kind", ["C", "I"])
def test_a_switched_storage_leaves_its_energy_in_its_switch(kind: str, forward: bool) -> None:
    """2 F at 3 V or 2 H at 3 A, alone with a source of zero: 9 J."""
    m = hb.Model("switched")
    m.add(z=hb.Sf(0.0) if kind == "C" else hb.Se(0.0), j=hb.Zero() if kind == "C" else hb.One())
    m.bond("z -> j")
    m.machine("S", states={"on": [], "off": []}, start="on", rules=["on -> off when time >= 1"])
    element = hb.C(2.0, e=3.0) if kind == "C" else hb.I(2.0, f=3.0)
    chain = drawn("j", "x", forward)
    sw.switched_storage(m, "x", bonds=chain, machine="S", on="on", element=element)
    run = hb.simulate(m, until=2)
    (jump,) = sw.impulse_bond_graph(run, run.events[1])
    assert dict(jump.stored) == pytest.approx({"x": -9.0})
    assert dict(jump.taken) == pytest.approx({"x.switch": 9.0})


def test_the_trial_impulses_of_mythical_modes_are_no_jump() -> None:
    run = hb.simulate(hb.load(EXAMPLES / "diode_inductor.toml"))
    trial, written = run.events[1], run.events[2]
    assert trial.steps[0].kind == "mythical" and trial.steps[0].impulses
    with pytest.raises(hb.ModelError, match="HB-M197"):
        sw.impulse_bond_graph(run, trial)
    (jump,) = sw.impulse_bond_graph(run, written)
    # 10 mA in 0.1 H are cut
    assert jump.energy_change == pytest.approx(-5e-6, rel=1e-6)
    assert math.fsum(jump.taken.values()) == pytest.approx(5e-6, rel=1e-6)


def test_what_has_no_reading_is_refused() -> None:
    run = hb.simulate(collision(1.0, 1.0, 1.0, 0.0, 0.5), until=2)
    with pytest.raises(hb.ModelError) as refusal:
        sw.impulse_bond_graph(run, run.events[0])
    assert refusal.value.code == "HB-M197"
    m = hb.Model("bent")
    m.add(n=hb.Zero(), c=hb.C({"e": "q^3"}, q=2.0), d=hb.C(1.0), k=hb.Zero(), sw=hb.One())
    m.bond("n -> c", "k -> d", "n -> sw -> k")
    m.machine("S", states={"o": [], "c": ["sw"]}, start="o", rules=["o -> c when time >= 1"])
    run = hb.simulate(m, until=2)
    with pytest.raises(hb.ModelError, match="nonlinear"):
        sw.impulse_bond_graph(run, run.events[1])
