"""Guards that hold for next to no time before what they compare jumps: the teeth of a ratchet.

The distance to the tooth below, ``q - p*floor(q/p)``, jumps by a whole tooth where that is reached.
"""

import math

import pytest

import hybond as hb

SOLVERS = ("auto", "radau", "rk45")
WIDTHS = (0.0, 1e-9, 1e-6, 1e-5, 1e-3)
"""Part of a tooth for which the distance is below zero before it jumps."""


def thrown(pitch: float, gap: str, turned: bool, law: bool) -> hb.Model:
    """Return what is thrown upwards beside a rack, and falls onto the highest tooth passed."""
    way = -1.0 if turned else 1.0
    speed = way * math.sqrt(2.0 * 10.0 * 1.79 * pitch)
    m = hb.Model("thrown", domain="translational")
    if not law:
        m.machine(
            "pawl",
            states={"off": [], "on": ["tooth"]},
            start="off",
            rules=["off -> on when gap <= 0 and v.f < 0"],
        )
    m.add(weight=hb.Se(-10.0), v=hb.One(), mass=hb.I(1.0, f=speed))
    m.add(rack=hb.Sf(0.0), tooth=hb.Zero(**({"law": "unilateral", "gap": "gap"} if law else {})))
    m.bond("mass -> v" if turned else "v -> mass", "weight -> v", "rack -> tooth -> v")
    m.signal(way=hb.Integral("v.f", start=0.01 * pitch), gap=gap)
    return m


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("law", [True, False])
@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize(("pitch", "turned"), [(1.0, False), (1e-6, True), (1e4, True)])
def test_a_tooth_that_is_passed_upwards_holds_what_falls_back(solver, law, width, pitch, turned):
    """It rises by 1.79 teeth from 0.01, and comes back to the first of them."""
    m = thrown(pitch, f"way - {pitch!r}*floor(way/{pitch!r} + {width!r})", turned, law)
    rise = math.sqrt(2.0 * 1.79 * pitch / 10.0)
    run = hb.simulate(m, until=3.0 * rise, solver=solver)
    assert run["way"].at(3.0 * rise) == pytest.approx(pitch, rel=1e-8)
    met = rise + math.sqrt(2.0 * 0.8 * pitch / 10.0)
    assert run.events[-1].t == pytest.approx(met, rel=1e-8)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("text", ["mod(way, 1)", "way - ceil(way - 1)", "way - floor(way)"])
def test_a_tooth_is_met_however_its_distance_is_written(solver, text):
    """A pawl that reads the remainder is the same as one that reads whole teeth."""
    narrow = text.replace("way", "(way + 1e-7)") + " - 1e-7"
    run = hb.simulate(thrown(1.0, narrow, False, False), until=2.0, solver=solver)
    assert run["way"].at(2.0) == pytest.approx(1.0, rel=1e-8)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("size", [1.0, 1e-5, 1e6])
def test_a_window_before_a_sign_turns_is_seen(solver, turned, size):
    """A level is compared which is below zero for a millionth before ``sign`` lifts it."""
    level = f"({size!r} - way)/{size!r} - 1e-6 + 2*(sign(way - {size!r}) + 1)"
    m = hb.Model("window", domain="translational")
    m.add(push=hb.Se(2.0 * size), v=hb.One(), mass=hb.I(1.0), seen=hb.One(), drag=hb.R(1.0))
    m.bond("mass -> v" if turned else "v -> mass", "push -> v -> seen -> drag")
    m.signal(way=hb.Integral("v.f", start=0.0), level=level)
    m.machine(
        "see",
        states={"no": ["seen"], "yes": ["seen"]},
        start="no",
        rules=["no -> yes when level < 0"],
    )
    run = hb.simulate(m, until=3.0, solver=solver)
    assert len(run.events) == 2
    t = run.events[-1].t
    # mass 1, drag 1: way = 2*size*(t - 1 + exp(-t))
    assert 2.0 * (t - 1.0 + math.exp(-t)) == pytest.approx(1.0 - 1e-6, rel=1e-8)
