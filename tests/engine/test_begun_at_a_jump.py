"""A motion that begins where a source jumps with time does not look back behind the jump.

Its first steps may be shorter than what tells both sides of a jump apart.
"""

import pytest

import hybond as hb

LAWS = {
    "a limited sawtooth": ("min(mod(u, 0.5)*2, 0.95)", lambda t: min(t % 0.5 * 2, 0.95)),
    "a limit that is not met": ("min(mod(u, 0.45), 5)", lambda t: t % 0.45),
    "a stair and a ramp": ("min(floor(u) + u, 5)", lambda t: t),
    "a sawtooth that is behind another": ("min(mod(u, 0.5), 2*u)", lambda t: t % 0.5),
}


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize(("dual", "solver"), [(False, "auto"), (True, "auto"), (False, "radau")])
def test_a_source_that_begins_at_its_jump(law: str, dual: bool, solver: str) -> None:
    text, value = LAWS[law]
    text = text.replace("u", "(w*time)")
    m = hb.Model("begun", parameters={"w": 1.0})
    if dual:
        m.add(n=hb.One(), S=hb.I(1e-3), R=hb.R(1e-2), V=hb.Sf(text), d=hb.Zero(law="diode"))
    else:
        m.add(n=hb.Zero(), S=hb.C(1e-3), R=hb.R(100.0), V=hb.Se(text), d=hb.One(law="diode"))
    m.bond("V -> d -> n", "n -> S", "n -> R")
    run = hb.simulate(m, 0.44, solver=solver)
    assert [e.cause for e in run.events] == ["start"]
    for t in (1e-12, 1e-6, 0.2, 0.4):
        of = "S.p" if dual else "S.q"
        assert run[of].at(t) == pytest.approx(1e-3 * value(t), rel=1e-9, abs=1e-17)
    assert run.audit().holds()
