"""Exported programs whose sources give energy in an instant: that is no energy from nowhere."""

import pytest
from export.programs import ask, check, compile_quickly, expected, needs_c, read_events

import hybond as hb


def joined() -> hb.Model:
    """Sources that are joined to storages at 1 s, by bonds in both directions."""
    m = hb.Model("joined")
    # a capacitor put on a voltage, and the same with its bonds turned
    m.add(V=hb.Se(2), s=hb.One(), C=hb.C(1), W=hb.Se(-3), r=hb.One(), D=hb.C(2))
    m.bond("V -> s -> C", "D -> r -> W")
    # a coil put into a current, a mass taken along by a belt
    m.add(F=hb.Sf(3), z=hb.Zero(), L=hb.I(1), G=hb.Sf(4), y=hb.Zero(), M=hb.I(2))
    m.bond("F -> z -> L", "M -> y -> G")
    # a source that steps onto what is stored
    m.add(U=hb.Se("u"), n=hb.Zero(), K=hb.C(5))
    m.bond("U -> n -> K")
    m.input(u=hb.Input(table=[[0, 0], [1, 5]]))
    m.machine(
        "all",
        states={"off": [], "on": ["s", "r", "z", "y"]},
        start="off",
        rules=["off -> on when time >= 1"],
    )
    return m


def struck() -> hb.Model:
    """A body that a table which moves towards it strikes and throws back faster."""
    m = hb.Model("struck", domain="translational")
    m.add(table=hb.Sf("2 m/s"), t=hb.One(), v=hb.One(), body=hb.I("3 kg"))
    m.add(hit=hb.Zero(law="unilateral", gap="gap", restitution=0.5))
    m.bond("table -> t -> hit -> v -> body")
    m.signal(gap=hb.Integral("v.f - t.f", start="1 m"))
    return m


@pytest.mark.slow
@needs_c
def test_a_program_counts_what_sources_give_at_a_jump(tmp_path):
    for model, stored in (
        (joined(), {"C.q": 2.0, "D.q": -6.0, "L.p": 3.0, "M.p": -8.0, "K.q": 25.0}),
        (struck(), {"body.p": 9.0}),
    ):
        program = compile_quickly(hb.export(model, to="c", until=2), tmp_path, model.name)
        said = read_events(ask(program, "--events"))
        run = hb.simulate(model, until=2)
        check(model.name, said, expected(run))
        assert said.stopped == ""
        assert {k: said.states[k] for k in stored} == stored
