"""Fixed steps beside bent laws end where laws of junctions hold to rounding, not to a part of it.

Slopes of an earlier step bring the end nearer by a part at each iteration; what is left of a law
when they end is a part of the last one.
"""

import pytest

import hybond as hb


def rectifier(law: dict[str, str], theta: float) -> hb.Result:
    """A swinging source, a coil, and a diode in series with a bent resistor beside a capacitor."""
    m = hb.Model("bent", domain="electrical")
    m.add(V=hb.Se("5*sin(4*s)"), L=hb.I(0.1), i=hb.One(), n=hb.Zero(), C=hb.C(0.05))
    m.add(d=hb.One(law="diode"), R=hb.R(law))
    m.signal(s="time/(1 [s])")
    m.bond("V -> i -> L", "i -> n -> C", "n -> d -> R")
    return hb.simulate(m, until=1.0, solver="moreau-jean", step="2 ms", theta=theta)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("theta", [0.5, 1.0])
@pytest.mark.parametrize("law", [{"e": "1*f + 0.5*f^3"}, {"f": "0.3*e + 0.01*e^3"}])
def test_a_diode_that_conducts_has_no_voltage(law: dict[str, str], theta: float) -> None:
    run = rectifier(law, theta)
    steps = [0.002 * k for k in range(1, 501)]
    across = [abs(run["n.e"].at(t) - run["R.e"].at(t)) for t in steps if run["d.f"].at(t) > 1e-6]
    assert len(across) > 200
    assert max(across) < 1e-11
    assert run.audit().power < 1e-12
    assert run.audit().holds()
