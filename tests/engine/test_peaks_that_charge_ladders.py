"""Diodes that begin to conduct just before the peak of a source, by next to nothing.

An unloaded voltage multiplier is charged ever less with each period. What a diode compares is then
rounding of tens of volts for many last places of the time, before it holds.
"""

import pytest

import hybond as hb


def multiplier(stages: int, resistance: float) -> hb.Model:
    """Return a ladder of Cockcroft and Walton behind 10 V at 1 kHz, with nothing to feed."""
    m = hb.Model("multiplier", domain="electrical", parameters={"n": stages})
    m.add(V=hb.Se("10*sin(2*pi*1000*time)"), R=hb.R(resistance), ground=hb.Se(0))
    m.add(ac=hb.Zero(), source=hb.One())
    m.add(
        {
            "a[1..n]": hb.Zero(),
            "b[0..n]": hb.Zero(),
            "ca[1..n]": hb.C("1 uF"),
            "cb[1..n]": hb.C("1 uF"),
            "ia[1..n]": hb.One(),
            "ib[1..n]": hb.One(),
            "up[1..n]": hb.One(law="diode"),
            "on[1..n]": hb.One(law="diode"),
        }
    )
    m.bond("V -> source -> ac", "source -> R", "ground -> b[0]", "a[1] -> ia[1] -> ac")
    m.bond("ia[1..n] -> ca[1..n]", "a[2..n] -> ia[2..n] -> a[1..n-1]", "ib[1..n] -> cb[1..n]")
    m.bond("b[1..n] -> ib[1..n] -> b[0..n-1]")
    m.bond("b[0..n-1] -> up[1..n] -> a[1..n]", "a[1..n] -> on[1..n] -> b[1..n]")
    return m


@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    ("stages", "resistance", "until"),
    [(2, 1.0, 0.1), (2, 0.3, 0.2), (2, 3.0, 0.25), (3, 1.0, 0.2), (3, 3.0, 0.2)],
)
def test_steps_lead_somewhere_where_diodes_compare_rounding(
    stages: int, resistance: float, until: float
) -> None:
    """It comes to twice the amplitude for each stage, and never beyond; each period counts."""
    run = hb.simulate(multiplier(stages, resistance), until, max_steps=20_000)
    top = f"b[{stages}].e"
    reached = run[top].at([until / 2, until])
    assert 20.0 * stages - 0.1 < reached[0] < reached[1] < 20.0 * stages * (1.0 + 1e-9)
    assert len(run.events) > 2000 * until
    assert run.audit().holds()
