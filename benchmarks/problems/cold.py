"""P8: from nothing to the first result, in a new process."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from functools import cache

from measuring.problem import Outcome, Problem

HYBOND = """
import hybond as hb
m = hb.Model("rc", domain="electrical")
m.add(c=hb.C("1 mF", e="10 V"), r=hb.R("1 kohm"), node=hb.Zero())
m.bond("node -> c", "node -> r")
print(hb.simulate(m, until="1 s")["c.e"].at(1.0))
"""
SCIPY = """
from scipy.integrate import solve_ivp
print(solve_ivp(lambda t, y: -y, (0, 1), [10.0], rtol=1e-8, atol=1e-10).y[0, -1])
"""
CASADI = """
import casadi as ca
x = ca.MX.sym("x")
f = ca.integrator("f", "cvodes", {"x": x, "ode": -x}, 0, 1, {"reltol": 1e-8, "abstol": 1e-10})
print(float(f(x0=10)["xf"]))
"""
PYTHON = "empty Python"
EMPTY = "print(10 * 2.718281828459045 ** -1)"
TRUE = 3.678794411714423


@cache
def kept_bytecode() -> tuple[tempfile.TemporaryDirectory[str], dict[str, str]]:
    """Return a folder for bytecode and the environment that has it kept there, also where the
    installation cannot be written or the caller's environment forbids it."""
    folder = tempfile.TemporaryDirectory()
    writes = {
        name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"
    }
    return folder, writes | {"PYTHONPYCACHEPREFIX": folder.name}


def started(text: str, needs: str) -> Callable[[float], Outcome | None]:
    """Return a tool that runs a script so many times, each in its own process."""

    def tool(times: float) -> Outcome | None:
        if importlib.util.find_spec(needs) is None:
            return None
        run, (_, env) = [sys.executable, "-c", text], kept_bytecode()
        out = ""
        start = time.perf_counter()
        for _ in range(int(times)):
            out = subprocess.run(run, check=True, capture_output=True, text=True, env=env).stdout
        return Outcome(time.perf_counter() - start, (float(out or TRUE),))

    return tool


def problem(full: bool) -> Problem:
    """Return the problem; what it is compared with is Python itself."""
    return Problem(
        "P8",
        "cold start to the first result",
        "process",
        (0.0, 1.0),
        (0.0, 3.0),
        {
            PYTHON: started(EMPTY, "sys"),
            "hybond": started(HYBOND, "hybond"),
            "SciPy": started(SCIPY, "scipy"),
            "CasADi": started(CASADI, "casadi"),
        },
        lambda times: (TRUE,),
        "ratios are to an empty Python; bytecode is cached.",
        base=PYTHON,
    )
