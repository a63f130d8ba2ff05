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
    assert hb.export(model, to="c")
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


def test_runs_of_one_graph_share_tables():
    model = hb.load(EXAMPLES / "boost.toml")
    graph = model.flatten()
    made = SETTINGS.tables(graph)
    assert SETTINGS.tables(graph) is made
    # an equal graph may hold other functions of Python
    other = SETTINGS.tables(model.flatten())
    assert other is not made and other.ints == made.ints
