"""The job in other simulators that install from PyPI; each is left out where it is missing."""

from __future__ import annotations

import importlib.util
import time
import warnings
from collections.abc import Callable
from typing import Any

from measuring.problem import Outcome


def in_rumoca(
    text: str,
    name: str,
    until: float,
    count: int,
    read: Callable[[Any], tuple[float, ...]],
    *,
    rtol: float,
    solver: str = "rk-like",
) -> Outcome | None:
    """Compile Modelica and simulate it; `read` gets the result and is not timed."""
    if importlib.util.find_spec("rumoca") is None:
        return None
    import rumoca

    start = time.perf_counter()
    model = rumoca.Session().loads(text, model=name)
    config = rumoca.SimConfig(solver=solver, rtol=rtol, atol=1e-2 * rtol, dt=until / (count - 1))
    run = model.simulate(t=(0.0, until), config=config)
    return Outcome(time.perf_counter() - start, read(run))


def in_pulsim(
    build: Callable[[Any], Any],
    until: float,
    read: Callable[[Any], tuple[float, ...]],
    **options: Any,
) -> Outcome | None:
    """Build a circuit and simulate it with the engine that locates diodes.

    Its diodes are 1 µohm and 1 Gohm, and it keeps every step rather than output points.
    """
    if importlib.util.find_spec("pulsim") is None:
        return None
    import pulsim

    start = time.perf_counter()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        more = {k: make(pulsim) for k, make in options.pop("made", {}).items()}
        run = pulsim.simulate(
            build(pulsim.CircuitBuilder()), t_end=until, engine="trbdf2", **options, **more
        )
    return Outcome(time.perf_counter() - start, read(run))
