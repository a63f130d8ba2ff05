"""What leans on a stop with dry friction, in fixed steps: it leaves at its breakaway."""

from __future__ import annotations

import pytest

import hybond as hb


def pressed(start: tuple[float, float], *, turned: bool) -> hb.Model:
    """1 kg pressed by 5 N against a stop, until the force falls from 1 s on, 4 N a second.

    At -2 N, after 2.75 s, friction lets go and goes on with 1 N: ``v' = -(2 + 4 s - 1)``.
    """
    m = hb.Model("pressed", domain="translational")
    speed, gap = start
    m.add(F=hb.Se("if time < 1 [s] then 5 [N] else 5 [N] - 4 [N/s]*(time - 1 [s])"))
    m.add(mass=hb.I(1.0, f=-speed if turned else speed), wall=hb.Sf(0.0))
    m.add(v=hb.One(law="coulomb", limit="1 N", breakaway="2 N"))
    m.add(stop=hb.Zero(law="unilateral", gap=f"{gap} - x", restitution=0.2))
    m.bond("F -> v", "mass -> v" if turned else "v -> mass", "v -> stop -> wall")
    m.signal(x=hb.Integral("v.f"))
    return m


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("start", [(0.02, 0.001), (0.1, 0.01), (0.4, 0.003)])
@pytest.mark.parametrize("theta", [0.5, 1.0])
def test_friction_that_leans_on_a_stop_holds_up_to_its_breakaway(
    start: tuple[float, float], theta: float, turned: bool
) -> None:
    model = pressed(start, turned=turned)
    run = hb.simulate(model, "3.2 s", solver="moreau-jean", step="1 ms", theta=theta)
    located = hb.simulate(model, "3.2 s")
    s = 3.2 - 2.75
    for found, within in ((run, 3e-3), (located, 1e-9)):
        last = found.events[-1]
        assert "backward" in [f.target for v in last.steps for f in v.fired]
        assert last.t == pytest.approx(2.75, abs=1.1e-3 if found is run else 1e-9)
        x = start[1] - s**2 / 2 - 4 * s**3 / 6
        assert found.final["x"] == pytest.approx(x, abs=within)
    # at rest both carry the push of 3 N, half each: no more than friction holds
    assert run["v.e"].at(1.5) == pytest.approx(1.5, abs=2e-3)
    assert run["stop.e"].at(1.5) == pytest.approx(1.5, abs=2e-3)
    assert run.mode["v"] == "backward"


@pytest.mark.sampled(3)
@pytest.mark.parametrize("bounces", [0.0, 0.2])
@pytest.mark.parametrize(("falls", "step"), [(12.0, 1e-3), (12.0, 7e-4), (10.0, 2e-3)])
@pytest.mark.parametrize(("rubs", "holds"), [(0.3, 1.4), (0.2, 1.4), (0.3, 1.0)])
@pytest.mark.parametrize("theta", [0.5, 1.0])
def test_a_push_against_a_stop_passes_through_zero(
    theta: float, rubs: float, holds: float, falls: float, step: float, bounces: float
) -> None:
    """2 kg on a floor that carries 20 N leave the stop when they are pulled by what friction holds.

    Where the push is zero both friction and stop carry rounding of what friction could hold.
    """
    m = hb.Model("pressed")
    m.add(F=hb.Se(f"if time < 1 then 15 else 15 - {falls}*(time - 1)"), mx=hb.I(2.0, f=0.2))
    m.add(vx=hb.One(law="coulomb", limit=f"{rubs}*fl.e", breakaway=f"{rubs * holds}*fl.e"))
    m.add(st=hb.Zero(law="unilateral", gap="0.02 - x", restitution=bounces), wl=hb.Sf(0.0))
    m.add(W=hb.Se(-20.0), vy=hb.One(), my=hb.I(2.0), fl=hb.Zero(law="unilateral", gap="y"))
    m.bond("W -> vy -> my", "fl -> vy", "F -> vx -> mx", "vx -> st -> wl")
    m.signal(x=hb.Integral("vx.f"), y=hb.Integral("vy.f"))
    leaves = 1.0 + (15.0 + 20.0 * rubs * holds) / falls
    until = leaves + 0.3
    run = hb.simulate(m, until, solver="moreau-jean", step=step, theta=theta)
    net = 20.0 * rubs * (holds - 1.0)
    speed = -(net * 0.3 + falls * 0.3**2 / 2.0) / 2.0
    assert run.final["mx.f"] == pytest.approx(speed, abs=10.0 * step)
    assert run.final["x"] < 0.02


def block(push: str, speed: float, way: float, turned: bool) -> hb.Model:
    """0.4 kg on a table that holds 6 N and drags with 2 N; a swing that touches nothing beside."""
    m = hb.Model("block", domain="translational")
    own = -way * speed if turned else way * speed
    m.add(F=hb.Se(f"{way}*({push})"), mass=hb.I(0.4, f=own))
    m.add(v=hb.One(law="coulomb", limit="2 N", breakaway="6 N"))
    m.bond("F -> v", "mass -> v" if turned else "v -> mass")
    m.add(swing=hb.One(), other=hb.I(1.0, f=3.0), spring=hb.C(0.1))
    m.bond("swing -> other", "swing -> spring")
    m.signal(x=hb.Integral("v.f"))
    return m


@pytest.mark.sampled(3)
@pytest.mark.parametrize(("way", "turned"), [(1.0, False), (-1.0, False), (1.0, True)])
@pytest.mark.parametrize("theta", [0.5, 1.0])
@pytest.mark.parametrize("step", [4e-3, 2e-3, 1.7e-3, 1e-3, 1e-4])
def test_what_comes_to_rest_within_a_step_is_held(
    step: float, theta: float, way: float, turned: bool
) -> None:
    """Braked by 4 N and 2 N, the 4 N move it no more; 7 N do, with 5 N."""
    held = hb.simulate(
        block("4", -0.301, way, turned), 0.5, solver="moreau-jean", step=step, theta=theta
    ).final
    assert way * held["x"] == pytest.approx(-(0.301**2) / 30.0, abs=0.4 * step)
    assert held["mass.f"] == pytest.approx(0.0, abs=1e-12)
    pushed = hb.simulate(
        block("7", -0.301, way, turned), 0.2, solver="moreau-jean", step=step, theta=theta
    )
    left = 0.2 - 0.301 / 22.5
    away = -(0.301**2) / 45.0 + 12.5 * left**2 / 2
    assert way * pushed.final["x"] == pytest.approx(away, abs=4.0 * step)


@pytest.mark.sampled(3)
@pytest.mark.parametrize(("way", "turned"), [(1.0, False), (-1.0, False), (1.0, True)])
@pytest.mark.parametrize("theta", [0.5, 1.0])
@pytest.mark.parametrize("later", ["3 + 0.001*(time - 1)", "4", "2.9", "-3"])
def test_what_sticks_does_so_beyond_a_timed_event(
    later: str, theta: float, way: float, turned: bool
) -> None:
    model = block(f"if time < 1 then 3 else {later}", 0.0, way, turned)
    run = hb.simulate(model, 2.0, solver="moreau-jean", step=1e-3, theta=theta)
    assert run.final["x"] == pytest.approx(0.0, abs=1e-15)
    assert run.mode == {"v": "sticks"}
