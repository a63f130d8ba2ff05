"""Bodies in a row on a table that jumps to a speed: they go with it, and none rebounds.

A source that jumps is the limit of fast ones. On a ramp contacts that are closed stay closed, so
that all bodies have the speed of the table when it ends, whatever their masses and restitutions;
the impulse of the source is the momentum of all, and the energy lost half of its work.
"""

from __future__ import annotations

import pytest

import hybond as hb

MASSES = (1.0, 2.0, 3.0)
RESTITUTIONS = (0.5, 0.25, 0.9)


def row(many: int, speed: str, *, gap: bool = True, turned: bool = False) -> hb.Model:
    """Return so many bodies, one behind the other, all touching."""
    m = hb.Model("row", domain="translational")
    m.add(table=hb.Sf(speed), s=hb.One())
    m.bond("table -> s")
    before = "s"
    for i in range(many):
        options = {"gap": f"g{i}"} if gap else {}
        contact = hb.Zero(law="unilateral", restitution=RESTITUTIONS[i], **options)
        m.add(**{f"c{i}": contact, f"v{i}": hb.One(), f"b{i}": hb.I(f"{MASSES[i]} kg")})
        m.bond(f"{before} -> c{i} -> v{i}", f"b{i} -> v{i}" if turned else f"v{i} -> b{i}")
        if gap:
            m.signal(**{f"g{i}": hb.Integral(f"v{i}.f - {before}.f", start="0 m")})
        before = f"v{i}"
    return m


@pytest.mark.sampled(3)
@pytest.mark.parametrize("options", [{}, {"impact": "newton_simultaneous"}, {"solver": "rk45"}])
@pytest.mark.parametrize("gap", [True, False])
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("many", [3, 2, 1])
def test_all_bodies_of_a_row_go_with_a_table_that_jumps(
    many: int, turned: bool, gap: bool, options: dict[str, str]
) -> None:
    speed = "if time < 1 [s] then 0 [m/s] else 2 [m/s]"
    run = hb.simulate(row(many, speed, gap=gap, turned=turned), "1.2 s", **options)
    assert run.status == "ok" and not run.warnings and run.audit().holds()
    for i in range(many):
        assert run[f"v{i}.f"].at(1.2) == pytest.approx(2.0, abs=1e-12)
    step = run.events[-1].steps[0]
    assert step.impulses["table.e"] == pytest.approx(2.0 * sum(MASSES[:many]), rel=1e-12)
    assert step.energy is not None
    assert step.energy.lost == pytest.approx(2.0 * sum(MASSES[:many]), rel=1e-12)


@pytest.mark.parametrize("many", [1, 3])
def test_so_they_do_in_steps_of_fixed_length(many: int) -> None:
    speed = "if time < 1 [s] then 0 [m/s] else 2 [m/s]"
    run = hb.simulate(row(many, speed), "1.2 s", solver="moreau-jean", step="10 ms")
    for i in range(many):
        assert run[f"v{i}.f"].at(1.2) == pytest.approx(2.0, abs=1e-12)


@pytest.mark.parametrize("many", [1, 3])
def test_a_speed_that_another_motion_makes_jump_is_one_as_well(many: int) -> None:
    m = row(many, "if slow.f > 0.5 [m/s] then 2 [m/s] else 0 [m/s]")
    m.add(push=hb.Se("1 N"), slow=hb.I("1 kg"), u=hb.One())
    m.bond("push -> u -> slow")
    # what lies there is pressed: where nothing is, a touch says nothing to the motion
    m.add(**{f"w{i}": hb.Se("-1 N") for i in range(many)})
    m.bond(*[f"w{i} -> v{i}" for i in range(many)])
    run = hb.simulate(m, "1 s")
    assert [e.cause for e in run.events] == ["start", "law"]
    assert run.status == "ok" and run.audit().holds()
    for i in range(many):
        assert run[f"v{i}.f"].at(1.0) == pytest.approx(2.0, abs=1e-12)


def test_what_arrives_elsewhere_at_that_instant_rebounds() -> None:
    # a ball at 1 m/s meets a wall 1 m away as the table jumps
    m = row(2, "if time < 1 [s] then 0 [m/s] else 2 [m/s]")
    m.add(wall=hb.Sf("0 m/s"), stop=hb.Zero(law="unilateral", gap="way", restitution=0.5))
    m.add(ball=hb.I("1 kg", f="-1 m/s"), w=hb.One())
    m.bond("wall -> stop -> w -> ball")
    m.signal(way=hb.Integral("w.f", start="1 m"))
    run = hb.simulate(m, "1.2 s")
    assert run["w.f"].at(1.2) == pytest.approx(0.5, abs=1e-12)
    assert [run["v0.f"].at(1.2), run["v1.f"].at(1.2)] == pytest.approx([2.0, 2.0], abs=1e-12)


def test_a_ball_that_arrives_at_a_row_is_passed_on_by_it() -> None:
    # the law contact after contact, as ever: balls that are alike, elastic, at a table that stays
    m = hb.Model("cradle", domain="translational")
    m.add(**{f"b{i}": hb.I("1 kg", f="1 m/s" if i == 0 else "0 m/s") for i in range(3)})
    m.add(**{f"v{i}": hb.One() for i in range(3)})
    for i in range(2):
        m.add(**{f"c{i}": hb.Zero(law="unilateral", gap=f"g{i}", restitution=1.0)})
        m.bond(f"v{i} -> c{i} -> v{i + 1}")
        m.signal(**{f"g{i}": hb.Integral(f"v{i + 1}.f - v{i}.f", start=f"{0.5 - 0.5 * i} m")})
    m.bond(*[f"v{i} -> b{i}" for i in range(3)])
    run = hb.simulate(m, "1 s")
    assert [run[f"v{i}.f"].at(1.0) for i in range(3)] == pytest.approx([0, 0, 1], abs=1e-12)
