"""Radau's method in the exported runtime: the steps of the reference.

Its Jacobian is one of differences, which magnify rounding: steps agree to about 1e-7 of their size,
and states as far as steps do.
"""

from pathlib import Path

import pytest
from portable_runs import assert_the_same

import hybond as hb
from hybond.engine.run import motion

EXAMPLES = Path(__file__).parents[3] / "examples"


def counted(model, monkeypatch, rel=1e-9, **options):
    """Hold both runs against each other; return how many steps each of them made."""
    made = []
    step = motion.step

    def count(e, end):
        made.append(end)
        return step(e, end)

    monkeypatch.setattr(motion, "step", count)
    a, b = assert_the_same(model, monkeypatch, rel=rel, solver="radau", **options)
    return a.stats["steps"], len(made), b


@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    ("name", "rel"), [("bouncing_ball", 1e-9), ("coulomb_friction", 1e-6), ("rlcd", 1e-9)]
)
def test_examples_take_the_steps_of_the_reference(name, rel, monkeypatch):
    expected, made, _ = counted(hb.load(EXAMPLES / f"{name}.toml"), monkeypatch, rel=rel)
    assert made == expected


def stiff():
    """A capacitor behind a conductance that grows by a million, with a coil that rings slowly."""
    m = hb.Model("stiff", domain="electrical")
    m.add(V=hb.Se("5*sin(40*time)"), i=hb.One(), L=hb.I("10 mH"), r=hb.R("2 ohm"), z=hb.Zero())
    m.add(C=hb.C("1 uF"), g=hb.R({"f": "1e-3*e + 0.2*e^3 + 1e-4*(exp(3*e) - 1)"}))
    m.bond("V -> i -> L", "i -> r", "i -> z -> C", "z -> g")
    return m


@pytest.mark.sampled(1)
@pytest.mark.parametrize("rtol", [1e-4, 1e-7])
def test_a_stiff_law_takes_the_steps_of_the_reference(rtol, monkeypatch):
    expected, made, b = counted(stiff(), monkeypatch, rel=1e-8, until=0.2, rtol=rtol)
    assert made == expected
    assert b.engine.radau.made < made  # Jacobians are kept


@pytest.mark.slow
def test_a_guard_inside_a_step_is_landed_on(monkeypatch):
    m = stiff()
    m.add(s=hb.One(), load=hb.R("1 ohm"))
    m.bond("z -> s -> load")
    m.machine(
        "S",
        states={"open": [], "closed": ["s"]},
        start="open",
        rules=["open -> closed when z.e > 1", "closed -> open when L.f < -0.5"],
    )
    expected, made, b = counted(m, monkeypatch, rel=1e-6, until=0.1)
    assert made == pytest.approx(expected, rel=0.01)
    assert len(b.events) == 3
