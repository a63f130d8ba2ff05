"""Voltages, pressures and velocities: what a user calls an effort or a flow is told its name."""

import pytest

import hybond as hb


def loop(domain: str, bonds: str = "u -> j -> r") -> hb.Model:
    m = hb.Model("loop", domain=domain)
    m.add(u=hb.Se(1.0), r=hb.R(1.0), c=hb.C(1.0), l=hb.I(1.0), j=hb.One(), n=hb.Zero())
    m.bond(bonds, "j -> l", "j -> n -> c")
    return m


@pytest.mark.sampled(3)
@pytest.mark.parametrize("bonds", ["u -> j -> r", "r -> j -> u"])
@pytest.mark.parametrize(
    "domain, said, meant",
    [
        ("electrical", "c.voltage", "c.e"),
        ("electrical", "c.v", "c.e"),
        ("electrical", "r.current", "r.f"),
        ("electrical", "j.i", "j.f"),
        ("electrical", "n.v", "n.e"),
        ("electrical", "c.charge", "c.q"),
        ("electrical", "l.flux", "l.p"),
        ("hydraulic", "c.pressure", "c.e"),
        ("hydraulic", "r.flow", "r.f"),
        ("hydraulic", "u.p", "u.e"),
        ("hydraulic", "r.Q", "r.f"),
        ("translational", "c.F", "c.e"),
        ("translational", "l.velocity", "l.f"),
        ("translational", "l.v", "l.f"),
        ("translational", "c.force", "c.e"),
        ("translational", "c.x", "c.q"),
        ("rotational", "j.omega", "j.f"),
        ("rotational", "r.torque", "r.e"),
        ("thermal_pseudo", "c.temperature", "c.e"),
        ("thermal_pseudo", "r.heat_flow", "r.f"),
        ("electrical", "c.pressure", "c.e"),
        ("electrical", "r.power", "r.e*r.f"),
        ("electrical", "V(c)", "c.e"),
        ("electrical", "I(l)", "l.f"),
    ],
)
def test_a_quantity_in_words_of_a_trade_is_told_by_its_name(
    domain: str, said: str, meant: str, bonds: str
) -> None:
    """They were told a list of all names, or the charge for a current."""
    m = loop(domain, bonds)
    run = hb.simulate(m, "10 ms")
    with pytest.raises(hb.UsageError, match="HB-S109") as refused:
        run[said]
    told = refused.value.hint.replace(",", " ").split()
    assert meant in told
    assert run[meant].unit is not None  # the remedy works
    m.signal(mine=f"2*{said}")
    with pytest.raises(hb.HybondError) as refused_too:
        m.flatten()
    assert meant in refused_too.value.hint.replace(",", " ").split()


def test_a_junction_has_one_of_both() -> None:
    run = hb.simulate(loop("electrical"), "10 ms")
    for said, own in (("j.voltage", "j.f"), ("n.current", "n.e")):
        with pytest.raises(hb.UsageError) as refused:
            run[said]
        assert f"junction has one {'flow' if own == 'j.f' else 'effort'}, {own}" in str(
            refused.value
        )


def test_what_says_no_quantity_is_told_names_that_are_near() -> None:
    run = hb.simulate(loop("electrical"), "10 ms")
    with pytest.raises(hb.UsageError) as refused:
        run["c.g"]
    assert "did you mean" in refused.value.hint
