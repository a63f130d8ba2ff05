"""What is measured of the run of a script has in each step the parameters of that step."""

from __future__ import annotations

import numpy as np
import pytest

import hybond as hb
from hybond.studio.curves import at_cursor

STEPS = [
    hb.Step(lasts="1 s"),
    hb.Step(lasts="1 s", set={"r0": "7 ohm"}),
    hb.Step(lasts="1 s", set={"U": "20 V"}),
]
CURRENTS = [10 / 5, 10 / 10, 20 / 10]
RESISTANCES = [2, 7, 7]


def divider() -> hb.Model:
    m = hb.Model("divider", domain="electrical", parameters={"U": "10 V", "r0": "2 ohm"})
    m.add(source=hb.Se("U"), r=hb.R("r0"), load=hb.R("3 ohm"), i=hb.One())
    m.bond("source -> i -> r", "i -> load")
    return m


def test_losses_are_those_of_each_step() -> None:
    run = hb.run_script(divider(), STEPS)
    whole = run.losses()
    lost = [i * i * r for i, r in zip(CURRENTS, RESISTANCES, strict=True)]
    load = [3 * i * i for i in CURRENTS]
    assert whole["r"].dissipated == pytest.approx(sum(lost), rel=1e-12)
    assert whole["load"].dissipated == pytest.approx(sum(load), rel=1e-12)
    assert whole["source"].supplied == pytest.approx(sum(lost) + sum(load), rel=1e-12)
    for k in range(3):
        part = run.losses(start=float(k), end=float(k + 1))
        assert part["r"].dissipated == pytest.approx(lost[k], rel=1e-12)
        assert part.efficiency("load") == pytest.approx(load[k] / (load[k] + lost[k]), rel=1e-12)


def test_means_and_extremes_are_those_of_each_step() -> None:
    run = hb.run_script(divider(), STEPS)
    assert run["i.f"].mean() == pytest.approx(np.mean(CURRENTS), rel=1e-12)
    assert run["i.f"].min() == pytest.approx(1.0)
    # an expression reads the parameters of its step, too
    powers = [i * i * r for i, r in zip(CURRENTS, RESISTANCES, strict=True)]
    assert run["r0*i.f*i.f"].integral() == pytest.approx(sum(powers), rel=1e-12)
    assert run["r0*i.f*i.f"].max() == pytest.approx(28.0)


def test_impulses_have_the_factor_of_their_step() -> None:
    m = hb.Model("struck", domain="translational", parameters={"v0": "0 m/s", "k": 1.0})
    m.add(ball=hb.I("2 kg", f="3 m/s"), v=hb.One(), stop=hb.Sf("v0"))
    m.bond("v -> ball", "stop -> v")
    run = hb.run_script(
        m, [hb.Step(lasts="1 s"), hb.Step(lasts="1 s", set={"v0": "4 m/s", "k": 5.0})]
    )
    # momentum: 6 -> 0 at the start, 0 -> 8 at the change
    assert run["k*ball.e"].integral() == pytest.approx(-6.0 + 5.0 * 8.0, rel=1e-12)
    assert run.losses(start="0.5 s")["stop"].supplied == pytest.approx(8.0 * 4.0, rel=1e-12)


def test_a_run_is_linearised_with_the_parameters_of_the_step() -> None:
    m = hb.Model("rc", domain="electrical", parameters={"r0": "2 ohm"})
    m.add(source=hb.Se("10 V"), r=hb.R("r0"), c=hb.C("1 F"), i=hb.One())
    m.bond("source -> i -> r", "i -> c")
    run = hb.run_script(m, [hb.Step(lasts="1 s"), hb.Step(lasts="1 s", set={"r0": "8 ohm"})])
    found = hb.linearise(run, inputs=["source"], outputs=["c.e"], at=[0.5, 1.0, 1.5, 2.0])
    assert isinstance(found, tuple)
    poles = [float(lin.poles()[0].real) for lin in found]
    assert poles == pytest.approx([-1 / 2, -1 / 8, -1 / 8, -1 / 8], rel=1e-12)


def test_the_studio_shows_the_bonds_of_the_step() -> None:
    run = hb.run_script(divider(), STEPS)
    bond = next(b.index for b in run.graph.bonds if b.name == "i -> r")
    for t, i, r in zip((0.5, 1.5, 2.5), CURRENTS, RESISTANCES, strict=True):
        effort, flow = at_cursor(run, t, "right", [bond])["values"][str(bond)]
        assert (effort, flow) == (pytest.approx(i * r), pytest.approx(i))
