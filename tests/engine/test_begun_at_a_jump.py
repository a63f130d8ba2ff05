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


@pytest.mark.parametrize("solver", ["auto", "rk45", "radau"])
@pytest.mark.parametrize("dual", [False, True])
@pytest.mark.parametrize("pace", [-0.7, -30.0, -1e-3])
@pytest.mark.parametrize("law", ["if x >= 1 then 2 else 1", "floor(x) + 1", "1 + max(x, floor(x))"])
def test_a_run_that_leaves_its_jump_at_once_keeps_its_books(
    law: str, pace: float, dual: bool, solver: str
) -> None:
    """`x` begins where the source jumps, and falls: two storages share 2, and a moment later 1."""
    m = hb.Model("left at once")
    if dual:
        m.add(V=hb.Sf(law), i=hb.Zero(), A=hb.I(1.0, f=1), n=hb.One(), B=hb.I(3.0), R=hb.R(2.0))
    else:
        m.add(V=hb.Se(law), i=hb.One(), A=hb.C(1.0, e=1), n=hb.Zero(), B=hb.C(3.0), R=hb.G(2.0))
    m.bond("V -> i -> n -> B", "i -> A", "n -> R")
    m.signal(x=hb.Integral(f"{pace!r}", start=1))
    run = hb.simulate(m, until=0.3 / abs(pace), solver=solver)
    assert run.audit().holds()
    (started,) = [s for s in run.events[0].steps if s.kind == "continuous"]
    assert started.energy is not None
    if not law.startswith("1 + max"):
        # 1 of 1 F and 3 F in a row: 0.75 of each volt moves, and goes back
        assert started.energy.lost == pytest.approx(0.375, rel=1e-12)
        assert len(run.events) == 2
        left = run.events[1].steps[-1].energy
        assert left is not None
        assert left.lost == pytest.approx(0.375, rel=1e-9)
