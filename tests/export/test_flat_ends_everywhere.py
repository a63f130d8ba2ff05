"""Laws with flat ends are the same in runs, in members of sweeps, in programs and in slopes.

Oracle: a mass that a force draws until the law of its resistor gives no more, in closed form.
"""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from export.programs import ask, compile_quickly, needs_c

import hybond as hb

LAWS = {
    "min and max": "max(-lim, min(lim, e/R))",
    "if": "if e > lim*R then lim else if e < -lim*R then -lim else e/R",
    "signs": "(abs(e/R + lim) - abs(e/R - lim))/2",
}
SET = {"lim": [2.0, 1.25, 4.0, 0.5], "R": [1.0, 2.0, 1.5, 0.25]}
FORCE, MASS, END = 5.0, 1.0, 3.0


def drawn(law: str, force: str = "F", *, way: bool = True) -> hb.Model:
    m = hb.Model("drawn", parameters={"F": FORCE, "m": MASS, "lim": 2.0, "R": 1.0})
    m.add(u=hb.Se(force), s=hb.I("m"), v=hb.One(), d=hb.R({"f": law}))
    m.bond("u -> v -> s", "v -> d")
    m.experiment["until"] = END
    if way:
        m.signal(x=hb.Integral("v.f"))
    return m


def way(lim: float, R: float) -> float:
    """How far it has come: ``m v' = F - R v`` up to `lim`, which it keeps."""
    rate, most = R / MASS, FORCE / R
    held = math.inf if lim >= most else -math.log1p(-lim / most) / rate
    t = min(held, END)
    return most * (t + math.expm1(-rate * t) / rate) + lim * (END - t)


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_members_of_a_sweep_end_where_runs_do(law: str) -> None:
    expected = [way(lim, R) for lim, R in zip(*SET.values(), strict=True)]
    many = hb.ensemble(drawn(law), END, sets=SET, outputs=["x"])
    assert many.final["x"] == pytest.approx(expected, rel=1e-7)
    for lim, R, x in zip(*SET.values(), expected, strict=True):
        run = hb.simulate(drawn(law), END, parameters={"lim": lim, "R": R})
        assert run.final["x"] == pytest.approx(x, rel=1e-7)
        assert run.mode["d"] == ("high" if lim < FORCE / R * -math.expm1(-R * END) else "follows")


@needs_c
@pytest.mark.slow
def test_a_program_ends_where_runs_do(tmp_path: Path) -> None:
    program = compile_quickly(str(hb.export(drawn(LAWS["min and max"]), to="c")), tmp_path, "drawn")
    for lim, R in zip(*SET.values(), strict=True):
        said = ask(program, "--set", f"lim={lim}", "--set", f"R={R}", "--events")
        (x,) = (line.split()[-1] for line in said.splitlines() if line.startswith("state x "))
        assert float(x) == pytest.approx(way(lim, R), rel=1e-7)


def test_slopes_of_a_run_that_is_held() -> None:
    """Where it is held nothing but the limit counts: slopes of the closed form."""
    for lim, R in ((2.0, 1.0), (4.0, 1.5)):
        s = hb.sensitivities(
            drawn(LAWS["min and max"]),
            END,
            wrt=["lim", "R"],
            of=["x"],
            parameters={"lim": lim, "R": R},
        )
        for name, a, b in (("lim", 1e-6, 0.0), ("R", 0.0, 1e-6)):
            slope = (way(lim + a, R + b) - way(lim - a, R - b)) / 2e-6
            assert s["x", name][-1] == pytest.approx(slope, rel=1e-6, abs=1e-9)


def test_a_motion_that_is_held_forgets_where_it_came_from() -> None:
    """The orbit is found at once, and its multiplier of the velocity is zero."""
    m = drawn(LAWS["min and max"], "F*cos(time/1 [s])", way=False)
    orbit = hb.periodic(m, period=2.0 * math.pi)
    assert max(abs(z.value) for z in orbit.multipliers) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("law", ["lim*tanh(e/(R*1))", "lim*(1 - exp(-e/R))"])
def test_limits_that_laws_bend_towards_follow_parameters(law: str) -> None:
    """Under a force far beyond it all is pressed against the limit, whichever it is."""
    m = drawn(law, "50")
    sets = {"lim": [2.0, 0.5], "R": [1.0, 0.2]}
    many = hb.ensemble(m, END, sets=sets, outputs=["v.f", "d.e"])
    assert many.final["v.f"] == pytest.approx(sets["lim"], rel=1e-12)
    assert many.final["d.e"] == pytest.approx([50.0, 50.0], rel=1e-12)
    assert m.flatten().warnings == ()


def test_laws_that_read_what_is_given_have_no_machine() -> None:
    """Beside a capacitor the flow follows: what the law ends with is no constraint."""
    m = hb.Model("given")
    m.add(
        u=hb.Se(5.0), r=hb.R(2.0), s=hb.C(1.0), n=hb.Zero(), j=hb.One(), d=hb.R({"f": "min(2, e)"})
    )
    m.bond("u -> j -> r", "j -> n -> s", "n -> d")
    assert m.flatten().machines == ()
    m.add(coil=hb.I(1.0), k=hb.One(), d2=hb.R({"f": "min(2, e)"}))
    m.bond("n -> k -> coil", "k -> d2")
    assert [machine.path for machine in m.flatten().machines] == ["d2"]
