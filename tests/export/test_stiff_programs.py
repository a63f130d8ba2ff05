"""Exported programs go over to an implicit method at the same step as a run here."""

import pytest
from export.programs import ask, compile_quickly, needs_c, read_events
from stiff_models import ladder, van_der_pol

import hybond as hb


@needs_c
@pytest.mark.parametrize("make", [van_der_pol, ladder])
def test_an_exported_program_ends_at_the_same_state(make, tmp_path):
    until = 1.05 if make is ladder else 2000.0
    run = hb.simulate(make(), until, solver="auto")
    text = hb.export(make(), to="c", until=until)
    said = read_events(ask(compile_quickly(text, tmp_path, "stiff"), "--events"))
    stored = {path: float(run.segments[-1].y[-1][k]) for k, path in enumerate(said.states)}
    assert said.states == pytest.approx(stored, rel=1e-13)
