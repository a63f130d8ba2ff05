"""Exported programs go over to an implicit method at the same step as a run here."""

import pytest
from export.programs import ask, compile_quickly, needs_c, read_events
from stiff_models import ladder, van_der_pol

import hybond as hb


@pytest.mark.sampled(1)
@needs_c
@pytest.mark.parametrize("make", [van_der_pol, ladder])
@pytest.mark.slow
def test_an_exported_program_ends_at_the_same_state(make, tmp_path):
    until = 1.05 if make is ladder else 2000.0
    run = hb.simulate(make(), until, solver="auto")
    text = hb.export(make(), to="c", until=until)
    said = read_events(ask(compile_quickly(text, tmp_path, "stiff"), "--events"))
    stored = {path: float(run.segments[-1].y[-1][k]) for k, path in enumerate(said.states)}
    assert said.states == pytest.approx(stored, rel=1e-13)


SURGE = {
    "coil": ("electrical", hb.I("10 mH"), hb.G({"f": "(e/200)^5"}), "V -> i -> L", "i -> law"),
    "turned": (
        "electrical",
        hb.I("10 mH"),
        hb.G({"f": "(e/200)^5"}),
        "V -> i",
        "L -> i",
        "law -> i",
    ),
}
"""Laws that are steep without bound where the flow through a storage is zero."""


@needs_c
@pytest.mark.slow
@pytest.mark.parametrize("name", SURGE)
def test_a_program_goes_through_zero_where_a_law_is_steep(name, tmp_path):
    domain, storage, law, *bonds = SURGE[name]
    model = hb.Model("surge", domain=domain)
    model.add(V=hb.Se("325*sin(100*pi*time)"), i=hb.One(), L=storage, law=law)
    model.bond(*bonds)
    run = hb.simulate(model, 0.04)
    assert run.status == "ok"
    text = hb.export(model, to="c", until=0.04)
    said = read_events(ask(compile_quickly(text, tmp_path, "surge"), "--events"))
    assert said.states == pytest.approx({"L.p": float(run.final["L.p"])}, rel=1e-9)
