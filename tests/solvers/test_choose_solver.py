"""Solvers by name, and what is refused."""

import math
import subprocess
import sys

import numpy as np
import pytest

from hybond.errors import UsageError
from hybond.solvers import SOLVERS, make_solver
from hybond.solvers.choose import QUANTISED


def scale(y0, y1):
    return 1e-6 + 0.0 * np.abs(y1)


@pytest.mark.parametrize("name", [n for n in SOLVERS if n not in QUANTISED])
def test_every_name_makes_the_solver_of_that_name(name):
    fixed = name in ("euler", "rk4")
    solver = make_solver(name, scale=scale, rtol=1e-6, step=0.1 if fixed else None)
    assert solver.name == name
    assert solver.adaptive is not fixed
    assert solver.order >= 1
    assert "\n" not in SOLVERS[name]


@pytest.mark.parametrize(
    ("options", "code", "hint"),
    [
        ({"name": "rk54"}, "HB-S101", "rk45"),
        ({"name": "rk4"}, "HB-S102", "step="),
        ({"name": "euler", "step": 0.0}, "HB-S102", "step="),
        ({"name": "euler", "step": math.nan}, "HB-S102", "step="),
        ({"name": "rk4", "step": math.inf}, "HB-S102", "step="),
        ({"name": "rk45", "max_step": 0.0}, "HB-S103", "leave it out"),
        ({"name": "radau", "max_step": math.nan}, "HB-S103", "leave it out"),
        ({"name": "rk45", "step": 0.1}, "HB-S104", "max_step"),
    ],
)
def test_refusals_have_a_code_and_a_remedy(options, code, hint):
    name = options.pop("name")
    with pytest.raises(UsageError) as caught:
        make_solver(name, scale=scale, rtol=1e-6, **options)
    assert caught.value.code == code
    assert hint in caught.value.hint
    assert caught.value.exit_code == 1


@pytest.mark.parametrize("name", ["rk45", "radau"])
def test_importing_and_running_an_adaptive_solver_does_not_import_scipy(name):
    program = (
        "import sys, numpy as np\n"
        "from hybond.solvers import make_solver\n"
        f"s = make_solver('{name}', scale=lambda a, b: 1e-6 + abs(b), rtol=1e-6)\n"
        "s.start(lambda t, y: -y, 0.0, np.ones(1), t_bound=1.0, jumped=True)\n"
        "s.step(1.0)\n"
        "assert not any(m.split('.')[0] == 'scipy' for m in sys.modules)\n"
    )
    subprocess.run([sys.executable, "-c", program], check=True, env={"PYTHONPATH": "src"})
