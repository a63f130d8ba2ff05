"""Ports of fields whose co-energy variable something holds at zero: what is left of it is rounding.

It is a difference of what the ports add to each other. Oracles: the pulse, at whose edges alone
something happens; the momentum of the other port, which a constant force gives it; what rest says.
"""

import numpy as np
import pytest

import hybond as hb

FIELD = [[0.00119, 0.00095], [0.00095, 0.00294]]
FORCE = 140.0
PERIOD, DUTY, UNTIL = 3.43e-3, 0.43, 0.02
GUARDS = ["on -> off when {} < 0", "off -> on when {} > 0"]


def held(kind: str) -> hb.Model:
    """Pulses of a source move and hold one port, and something pushes the other all the time."""
    m = hb.Model("held")
    m.input(u=hb.Input(pwm={"period": f"{PERIOD} s", "duty": DUTY}))
    charges = kind == "charges"
    drive = f"0.4795*(1 - 0.5*tanh({'x.1.q' if charges else 'x.1.p'}/2.1e-4))*u"
    m.add(x=hb.C(FIELD, q=[0, 0]) if charges else hb.I(FIELD, p=[0, 0]))
    m.add(push=hb.Sf(FORCE) if charges else hb.Se(FORCE), w=hb.One() if charges else hb.Zero())
    m.bond("push -> w -> x.2")
    if kind == "masses":
        m.add(s=hb.Sf(drive), z=hb.Zero(), j=hb.One())
        m.bond("s -> z -> j -> x.1")
    elif kind == "charges":
        m.add(s=hb.Se(drive), z=hb.One(), j=hb.Zero())
        m.bond("s -> z -> j -> x.1")
    elif kind == "behind a lever":
        m.add(s=hb.Sf(drive), z=hb.Zero(), t=hb.TF(3.0), j=hb.One())
        m.bond("s -> z -> t -> j -> x.1")
    else:
        m.add(
            s=hb.Se(f"292*{drive}"),
            z=hb.Zero(),
            g=hb.GY(292.0),
            j=hb.One(law="coulomb", limit=0.259),
        )
        m.bond("s -> z -> g -> j -> x.1")
    if kind != "friction behind a gyrator":
        rules = [rule.format("j.e" if charges else "j.f") for rule in GUARDS]
        m.machine("G", states={"on": [], "off": []}, start="on", rules=rules)
    return m


@pytest.mark.parametrize(
    "kind", ["masses", "charges", "behind a lever", "friction behind a gyrator"]
)
def test_rounding_of_what_ports_of_a_field_add_to_each_other_fires_no_guard(kind: str) -> None:
    run = hb.simulate(held(kind), UNTIL, max_events=200)
    assert run.status == "ok"
    phase = np.array([e.t for e in run.events]) / PERIOD % 1.0
    near = np.minimum(np.abs(phase - DUTY), np.minimum(phase, 1.0 - phase))
    assert near.max() < 1e-9 and len(run.events) == 1 + 2 * int(UNTIL / PERIOD) + 1
    letter = "q" if kind == "charges" else "p"
    t = PERIOD * (np.arange(5) + 0.7)  # the source holds
    values = run.sample(t, [f"x.1.{letter}", f"x.2.{letter}"])
    assert values[f"x.2.{letter}"] == pytest.approx(FORCE * t, rel=1e-9)
    rest = FIELD[0][1] / FIELD[1][1] * FORCE * t
    assert values[f"x.1.{letter}"] == pytest.approx(rest, rel=1e-9)
