"""Modes that follow each other where laws are bent: those of runs, and of samples of states."""

import json
from pathlib import Path

import numpy as np
import pytest

import hybond as hb
from hybond.engine.outcome.apart import Apart

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture(scope="module")
def rod():
    return hb.reachable(hb.load(EXAMPLES / "falling_rod.toml"), samples=2)


def test_the_impact_of_the_rod_passes_its_two_mythical_modes(rod):
    """Mosterman & Biswas 2002, figure 8: free, stuck, onset of the slide, sliding."""
    seen = [(e.source, e.target) for e in rod.edges if e.known == "seen"]
    assert seen[:3] == [("free", "stuck"), ("stuck", "onset"), ("onset", "left")]
    kinds = {n.mode: n.kinds for n in rod.nodes}
    assert "mythical" in kinds["stuck"] and "mythical" in kinds["onset"]
    assert kinds["free"][:2] == ("start", "continuous")


def test_what_samples_do_not_show_is_not_excluded(rod):
    assert not rod.exact and rod.time == "not decided" and "arm_x" in rod.why
    assert not rod.never
    known = {(t.source, t.target): t.known for t in rod.transitions}
    assert len(known) == 11 and set(known.values()) <= {"seen", "possible", "not excluded"}
    assert known["free", "stuck"] == "seen"


def test_the_rod_with_the_published_threshold_has_states_without_a_mode():
    found = hb.reachable(hb.load(EXAMPLES / "falling_rod_threshold.toml"), samples=2)
    assert found.time == "possible" and not found.exact
    gaps = [g for g in found.gaps if g.confirmed]
    # in the slide the tip is below v_th and the stick force outside of the cone
    assert any(g.begin == "slide" for g in gaps)
    gap = next(g for g in gaps if g.begin == "slide")
    assert set(gap.witness) == {"mx.p", "my.p", "rotor.p", "theta", "y"}


def test_a_state_that_structure_excludes_is_told_for_bent_laws_too():
    m = hb.Model("bent")
    m.add(c=hb.C(1), n=hb.Zero(), f=hb.Sf(0), s=hb.One(), r=hb.R({"e": "f^3 + f"}))
    m.bond("f -> n -> c", "n -> s -> r")
    m.machine(
        "m",
        states={"off": [], "on": ["s"], "broken": []},
        start="off",
        rules=["off -> on when c.e > 1", "on -> broken when false", "broken -> off when true"],
    )
    found = hb.reachable(m, until=0, samples=10)
    assert found.unreachable == ("m.broken",) and not found.exact


def test_laws_of_junctions_are_sampled():
    found = hb.reachable(hb.load(EXAMPLES / "diode_inductor_law.toml"), samples=10)
    assert not found.exact and "complementarity" in found.why
    # the run opens the switch, and the diode takes the current at that instant
    assert any(e.known == "seen" and "open" in e.target for e in found.edges)


def test_the_record_is_plain_data(rod):
    data = json.loads(json.dumps(rod.to_data()))
    assert data["time"] == "not decided" and data["edges"][0]["fires"][0]["machine"] == "tip"


def test_a_run_that_slides_adds_no_mode_that_is_left_at_once():
    """Two weirs that slide: complementary guards, nothing jumps, so no mode is a pinnacle."""
    found = hb.reachable(hb.load(EXAMPLES / "weirs.toml"))
    assert found.exact and found.time == "proved"
    assert {k for n in found.nodes for k in n.kinds} == {"start", "continuous"}
    assert all(e.fires for e in found.edges)


@pytest.mark.parametrize("turned", [False, True])
def test_a_state_is_put_where_charge_is_shared(turned):
    m = hb.Model("joined")
    m.add(a=hb.C(1.0), b=hb.C(3.0), n=hb.Zero(), s=hb.One(), k=hb.Zero())
    m.bond("n -> a", "n -> s -> k", "b -> k" if turned else "k -> b")
    m.machine("S", states={"open": [], "closed": ["s"]}, start="open", rules=[])
    at = Apart(m.flatten())
    assert at.after(np.array([4.0, 0.0]), (1,)) == pytest.approx([1.0, 3.0], rel=1e-12)
    assert at.after(np.array([4.0, 0.0]), (0,)) == pytest.approx([4.0, 0.0], abs=0.0)
