"""Exports that cannot repeat a table refuse it, rather than run it once."""

import pytest

import hybond as hb


@pytest.mark.parametrize("target", ["c", "java", "fmu", "modelica"])
def test_a_table_that_repeats_is_refused(target: str) -> None:
    m = hb.Model("pulses", domain="electrical")
    m.add(V=hb.Se("u"), R=hb.R("1 ohm"), L=hb.I("1 mH"), i=hb.One())
    m.bond("V -> i -> R", "i -> L")
    m.input(u=hb.Input(table=[(0, 0), (1, 1), (2, 0)], linear=True, period=2))
    m.experiment["until"] = 5.0
    with pytest.raises(hb.ModelError) as caught:
        hb.export(m, to=target)
    assert caught.value.code == ("HB-E680" if target == "modelica" else "HB-E630")
