"""Bridges behind coils whose rail has a leak to earth: the leak alone tells their diodes apart.

With all four conducting, two coils give all currents but one around the bridge, which the leak and
the drops of the diodes decide: feedthroughs that are 1e7 times less than the others.
"""

import pytest

import hybond as hb

OHMS = {"10 kohm": 1e4, "100 kohm": 1e5, "1 Mohm": 1e6, "10 Mohm": 1e7, "100 Mohm": 1e8}


def bridge(leak: str, rail: str, drop: str, turned: bool) -> hb.Model:
    """Return a bridge of diodes between two coils, driven by a square wave."""
    m = hb.Model("bridge", domain="electrical")
    m.add(V=hb.Se("if mod(time, 40 [us]) < 20 [us] then 100 [V] else -100 [V]"), i=hb.One())
    m.add(a=hb.Zero(), p=hb.Zero(), q=hb.Zero(), j=hb.One())
    m.add(La=hb.I("1 mH"), Ld=hb.I("20 mH"), R=hb.R("15 ohm"))
    for k in "1234":
        m.add(**{f"D{k}": hb.One(law="diode"), f"r{k}": hb.R("1 mohm"), f"E{k}": hb.Se(drop)})
        m.bond(f"D{k} -> r{k}", f"D{k} -> E{k}")
    m.bond("V -> i -> a", "a -> D1 -> p", "D2 -> p", "q -> D3 -> a", "q -> D4", "p -> j -> q")
    m.bond(*(["La -> i", "Ld -> j", "R -> j"] if turned else ["i -> La", "j -> Ld", "j -> R"]))
    if leak:
        m.add(leak=hb.R(leak))
        m.bond(f"leak -> {rail}" if turned else f"{rail} -> leak")
    return m


@pytest.mark.parametrize(
    ("leak", "rail", "drop", "turned"),
    [
        ("10 kohm", "q", "14 mV", False),
        ("100 kohm", "q", "14 mV", True),
        ("1 Mohm", "q", "14 mV", False),
        ("1 Mohm", "q", "0.7 V", True),
        # feedthroughs 1e10 times less, and times in which storage makes no more than their rounding
        ("1 Mohm", "p", "14 mV", True),
        ("10 Mohm", "q", "14 mV", False),
        ("100 Mohm", "p", "14 mV", False),
    ],
)
def test_a_leak_beside_a_bridge_changes_next_to_nothing(
    leak: str, rail: str, drop: str, turned: bool
) -> None:
    run = hb.simulate(bridge(leak, rail, drop, turned), until=4e-4)
    alone = hb.simulate(bridge("", rail, drop, turned), until=4e-4)
    assert run.audit().holds()
    for t in (1.1e-5, 1.03e-4, 2.51e-4, 3.99e-4):
        # of the 100 V at the rail in every other half period, through the leak
        taken = 100 / OHMS[leak]
        assert float(run["Ld.f"].at(t)) == pytest.approx(float(alone["Ld.f"].at(t)), abs=taken)
