"""Laws declared impulsive: Coulomb friction during an impact."""

import pytest

import hybond as hb


def sliding_impact(slip: float) -> hb.Model:
    """A body hits the floor at 100 m/s while it slides: friction takes 0.2 of the impulse."""
    m = hb.Model()
    m.add(my=hb.I(1, f=-100), mx=hb.I(1, f=slip), vx=hb.One(), vy=hb.One(), c=hb.Zero())
    m.add(reb=hb.Sf(0), fr=hb.R({"e": "0.2*c.e*sign(f)"}, impulsive=True))
    m.bond("vy -> my", "c -> vy", "reb -> c", "vx -> mx", "vx -> fr")
    rules = ["air -> hit when time >= 1"]
    m.machine("F", states={"air": [], "hit": ["c"]}, start="air", rules=rules)
    return m


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_friction_takes_its_part_of_the_impulse(way: float) -> None:
    run = hb.simulate(sliding_impact(50.0 * way), 2.0)
    assert run["mx.f"].at(1.5) == pytest.approx(30.0 * way)  # 50 - 0.2 * 100
    assert run["my.f"].at(1.5) == pytest.approx(0.0, abs=1e-9)
    energy = run.events[1].steps[-1].energy
    assert energy is not None
    assert energy.lost == pytest.approx(0.5 * (100.0**2 + 50.0**2 - 30.0**2))
    assert any("fr" in w for w in run.warnings)


def test_friction_that_would_reverse_the_slip_is_refused() -> None:
    with pytest.raises(hb.ModelError) as caught:
        hb.simulate(sliding_impact(0.001), 2.0)
    assert caught.value.code == "HB-J103"


def test_switched_transformer_logs_what_it_takes() -> None:
    m = hb.Model()
    m.add(V=hb.Se(1), L=hb.I(1), t=hb.TF(2), R=hb.R(1), r=hb.R(1), i=hb.One(), v=hb.One())
    m.bond("V -> i -> t -> v -> L", "v -> R", "i -> r")
    rules = ["on -> off when time >= 1"]
    m.machine("k", states={"on": ["t"], "off": []}, start="on", rules=rules)
    step = hb.simulate(m, 2.0).events[1].steps[-1]
    assert step.energy is not None
    assert step.energy.lost == pytest.approx(step.energy.before)
    assert list(step.exchanged) == ['"t -> v".e']


def test_pseudo_storage_has_no_energy() -> None:
    m = hb.Model(domain="thermal_pseudo")
    m.add(wall=hb.C("50 J/K", e="290 K"), n=hb.Zero(), loss=hb.R("1 K/W"))
    m.bond("n -> wall", "n -> loss")
    energy = hb.simulate(m, 1.0).events[0].steps[-1].energy
    assert energy is not None
    assert energy.before == 0.0
