"""What a law that hardens may hold is by that law, however large an energy is beside it.

Its slope at rest would let a mass hold millions of what the law lets it hold: a jump that was small
beside that counted as rounding, and the mass no longer followed the source that moves it.
"""

import math

import pytest
from scipy.optimize import brentq

import hybond as hb

ENERGIES = [1e3, 1e15, 1e40]
STEPPED = "0.3 + (if time >= 0.5 then 0.2 else 0)"
LAWS = {  # of x, and what holds y
    "sinh": ("1.47*sinh(x/0.89)", lambda y: 0.89 * math.asinh(y / 1.47)),
    "cubic": ("x + 1e4*x^3", lambda y: brentq(lambda x: x + 1e4 * x**3 - y, 0.0, 1.0, xtol=1e-16)),
}


def beside(energy: float) -> hb.Model:
    """A model in which a capacitor holds that energy, and nothing moves it."""
    m = hb.Model("beside")
    m.add(large=hb.C(1.0, q=math.sqrt(2.0 * energy)), alone=hb.One(), stays=hb.Sf(0.0))
    m.bond("stays -> alone -> large")
    return m


@pytest.mark.parametrize("energy", ENERGIES)
@pytest.mark.parametrize("law", LAWS)
def test_a_mass_follows_the_speed_of_a_source(law: str, energy: float) -> None:
    text, held = LAWS[law]
    m = beside(energy)
    m.add(s=hb.Sf(STEPPED), j=hb.One(), i=hb.I({"f": text.replace("x", "p")}, p=held(0.3)))
    m.bond("s -> j -> i")
    run = hb.simulate(m, 1.0)
    assert run["i.p"].at(0.25) == pytest.approx(held(0.3), rel=1e-12)
    assert run["i.p"].at(0.75) == pytest.approx(held(0.5), rel=1e-12)
    assert run.audit().holds()
    if law == "sinh" or energy < 1e20:  # else less than a part of 1e-10 of what it could hold
        [hit] = [s for e in run.events for s in e.steps if s.impulses]
        assert hit.impulses["i.e"] == pytest.approx(held(0.5) - held(0.3), rel=1e-12)


@pytest.mark.parametrize("energy", ENERGIES)
@pytest.mark.parametrize("law", LAWS)
def test_two_that_a_switch_joins_keep_what_they_hold(law: str, energy: float) -> None:
    text, held = LAWS[law]
    of = text.replace("x", "q")
    m = beside(energy)
    m.add(a=hb.C({"e": of}, q=held(0.5)), b=hb.C({"e": of}, q=0.0), m=hb.Zero(), n=hb.Zero())
    m.add(i=hb.One())
    m.bond("a -> m -> i -> n -> b")
    m.machine(
        "S",
        states={"open": [], "closed": ["i"]},
        start="open",
        rules=["open -> closed when time >= 0.5"],
    )
    run = hb.simulate(m, 1.0)
    assert run["a.q"].at(0.25) == pytest.approx(held(0.5), rel=1e-12)
    for name in ("a.q", "b.q"):  # by symmetry each has half of it
        assert run[name].at(0.75) == pytest.approx(0.5 * held(0.5), rel=1e-12)


@pytest.mark.parametrize("energy", ENERGIES)
def test_what_drifts_is_held_by_each_sample(energy: float) -> None:
    """A source follows samples of a clock: each jump is a part of what is there."""
    m = beside(energy)
    m.signal(step=hb.Sampled("sin(1*time)", every=0.1))
    m.add(s=hb.Se("step"), j=hb.Zero(), c=hb.C({"e": "2*sinh(q/0.01)"}))
    m.bond("s -> j -> c")
    run = hb.simulate(m, 1.0)
    for k in range(10):
        held = 0.01 * math.asinh(math.sin(0.1 * k) / 2.0)
        assert run["c.q"].at(0.1 * k + 0.05) == pytest.approx(held, rel=1e-12), k
