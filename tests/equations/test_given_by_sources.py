"""Bond variables that sources and resistors alone decide: what compares them is never slid on."""

from __future__ import annotations

import numpy as np
import pytest

import hybond as hb
from hybond.equations.given_by_sources import GivenBySources
from hybond.equations.surfaces import surfaces_of
from hybond.model.parts import Part

DIVIDER = ("u -> i -> a", "i -> b")


def divided(source: str, extra: str = "") -> hb.Model:
    """Return a source behind a divider, a machine on what is divided, and what that drives."""
    m = hb.Model("divided")
    m.add(u=hb.Se(source), i=hb.One(), a=hb.R(1.0), b=hb.R(2.0))
    m.add(s=hb.Sf('if k.state == "yes" then 1 else -1'), n=hb.Zero(), c=hb.C(1.0))
    m.bond(*DIVIDER, "s -> n -> c")
    rules = [f"no -> yes when b.e > 0{extra}", f"yes -> no when b.e < 0{extra}"]
    m.machine("k", states={"no": [], "yes": []}, start="no", rules=rules)
    return m


def test_what_is_divided_of_a_source_is_crossed() -> None:
    m = divided("sin(pi*time/(1 s) - 1)")
    run = hb.simulate(m, 4.0)
    assert (run.status, run.warnings, len(run.sliding)) == ("ok", (), 0)
    assert [e.t for e in run.events if e.t > 0] == pytest.approx(
        np.arange(4) + 1 / np.pi, abs=1e-12
    )
    assert surfaces_of(m.flatten()) == ()


@pytest.mark.parametrize(
    ("source", "extra"),
    [
        ("sin(time/(1 s)) - c.q", ""),  # follows what is stored
        ('if k.state == "yes" then -1 else 1', ""),  # is made to jump by its own machine
        ("sin(time/(1 s))", " + c.q"),  # compares more than that
    ],
)
def test_what_a_machine_has_a_say_in_keeps_its_surface(source: str, extra: str) -> None:
    assert len(surfaces_of(divided(source, extra).flatten())) == 1


def test_what_machines_do_to_each_other_keeps_its_surface() -> None:
    """One reads what the other, which reads it, makes of the source."""
    m = divided('if other.state == "yes" then 1 else -1')
    rules = ['no -> yes when k.state == "no"', 'yes -> no when k.state == "yes"']
    m.machine("other", states={"no": [], "yes": []}, start="no", rules=rules)
    assert len(surfaces_of(m.flatten())) == 1


@pytest.mark.parametrize(
    ("part", "given"),
    [
        (hb.R(1.0), ["u.e", "j.f", "r.e"]),
        (hb.R({"e": "f^3"}), ["u.e"]),
        (hb.C(1.0), ["u.e"]),
        (hb.I(1.0), ["u.e"]),
    ],
)
def test_what_hangs_on_a_source_is_given_by_its_parts(part: Part, given: list[str]) -> None:
    """Of two loads beside each other one stores: it has no say in the other, but in the sum."""
    m = hb.Model("loads")
    m.add(u=hb.Se(1.0), n=hb.Zero(), j=hb.One(), a=hb.R(1.0), c=hb.C(1.0), x=hb.R(1.0), y=hb.One())
    m.add(r=part)
    m.bond("u -> n -> j -> a", "j -> r", "n -> y -> x", "y -> c")
    g = m.flatten()
    known = GivenBySources(g).known
    assert g.read is not None
    names = ("u.e", "u.f", "j.f", "r.e", "c.e", "x.f")
    assert [name for name in names if str(g.read(name)) in known] == given


def test_what_a_switch_is_in_is_not_given() -> None:
    m = hb.Model("switched")
    m.add(u=hb.Se(1.0), j=hb.One(), a=hb.R(1.0), b=hb.R(1.0))
    m.bond("u -> j -> a", "j -> b")
    m.machine("k", states={"off": [], "on": ["j"]}, start="off", rules=["off -> on when time > 1"])
    assert set(GivenBySources(m.flatten()).known) == {"e:0"}
