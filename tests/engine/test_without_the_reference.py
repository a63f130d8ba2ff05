"""Runs by the library, what is read of them and exports need no room of the reference."""

import math
import subprocess
import sys
from pathlib import Path

import pytest

import hybond as hb
from hybond.engine.outcome.engine_run import Settings

EXAMPLES = Path(__file__).parents[2] / "examples"
ALONE = """
import sys
for room in ("modes", "programs", "solvers", "kernel"):
    sys.modules[f"hybond.{room}"] = None  # who imports it fails
import hybond as hb
for solver in ("rk45", "auto"):
    model = hb.load(sys.argv[1])
    model.experiment["solver"] = solver
    run = hb.simulate(model, engine="library")
    assert run.status == "ok", run.error
    run.table(), run.explain(), run.energies(run.segments[0]), run.final
    assert run.audit().holds()
    assert hb.export(model, to="c")
"""
ANALYSIS = """
import sys
for room in ("modes", "programs", "solvers", "kernel"):
    sys.modules[f"hybond.{room}"] = None
from pathlib import Path
import hybond as hb
from hybond.cli.check import _enter_start
load = lambda name: hb.load(Path(sys.argv[1]) / f"{name}.toml")
ball = load("bouncing_ball_no_mode")
found = hb.coverage(ball, "ball.p", -1.2, 0.0, at={"height": 0.0}, points=9)
assert found.uncovered and found.uncovered[0].tried
drop = hb.Model("drop", domain="translational", parameters={"m": "1 kg"})
drop.add(ball=hb.I("m", f="-1 m/s"), v=hb.One(), contact=hb.Zero(), squeeze=hb.One(),
         pad=hb.C("1 mm/N"), damper=hb.G("10 m/(N*s)"))
drop.bond("contact -> v -> ball", "contact -> squeeze -> pad", "squeeze -> damper")
drop.machine("floor", states={"away": [], "touching": ["contact"]}, start="away",
             rules=["away -> touching when v.f < 0", "touching -> away when contact.e < 0"])
assert hb.restitution(drop, "contact").rebounds
rc = hb.Model("rc", domain="electrical")
rc.add(V=hb.Se("sin(time*1 [1/s])*1 [V]"), i=hb.One(), r=hb.R(1), c=hb.C(1))
rc.bond("V -> i -> r", "i -> c")
values = hb.residuals(rc, sensors=["c.e", "r.f"]).evaluate(hb.simulate(rc, 1.0))
assert max(values.worst().values()) < 1e-6
assert hb.cross_check(rc, 1.0, engines=("rk45", "radau")).agrees
_enter_start(load("newtons_cradle").flatten())
"""
SETTINGS = Settings(1.0, "rk45", None, 1e-8, None, math.inf, 1e-12, True, ("newton", 1.0), 9, 9, 9)


@pytest.mark.parametrize(
    "name", ["boost", "bouncing_rod", "relay_feedback", "planar_puck", "newtons_cradle"]
)
def test_no_room_of_the_reference_is_asked(name):
    done = subprocess.run(
        [sys.executable, "-c", ALONE, str(EXAMPLES / f"{name}.toml")],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr


def test_analysis_asks_no_room_of_the_reference():
    done = subprocess.run(
        [sys.executable, "-c", ANALYSIS, str(EXAMPLES)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


def test_runs_of_one_graph_share_tables():
    model = hb.load(EXAMPLES / "boost.toml")
    graph = model.flatten()
    made = SETTINGS.tables(graph)
    assert SETTINGS.tables(graph) is made
    # an equal graph may hold other functions of Python
    other = SETTINGS.tables(model.flatten())
    assert other is not made and other.ints == made.ints
