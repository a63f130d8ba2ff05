"""Published cases: the shipped models, run as a user runs them."""

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from engines import assert_same_events, assert_same_states

import hybond as hb

EXAMPLES = Path(__file__).parents[2] / "examples"


def simulate_example(name: str, **options) -> hb.Result:
    """Simulate ``examples/<name>.toml``."""
    return hb.simulate(hb.load(EXAMPLES / f"{name}.toml"), **options)


def visited(run: hb.Result, event) -> list[tuple[tuple[str, ...], str]]:
    """The modes of an event in order: states of the machines, and kind."""
    return [(tuple(run.graph.mode_names(s.mode).values()), s.kind) for s in event.steps]


MOST = 4000
"""Steps, and a hundred for each event, that the reference makes in a second or two."""


@pytest.fixture(autouse=True)
def both_engines(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every run of a case is made by the reference as well: same events, same states.

    Not where the kernel did nothing, nor where the reference would take minutes. Of tests marked
    `rounding` only the states are compared: which of two idle diodes is called conducting changes
    nothing else.
    """
    original = hb.simulate
    apart = request.node.get_closest_marker("rounding") is not None

    def simulate(*args: object, **options: object) -> hb.Result:
        run = original(*args, **options)
        cost = run.stats.get("steps", 0) + 100 * run.stats.get("events", 0)
        done = run.stats.get("marched", 0) + run.stats.get("crossed", 0)
        alone = options.get("kernel", True) is False or options.get("journal") is not None
        if alone or not done or cost > MOST:
            return run
        options = {**options, "kernel": False, "progress": None}
        other = original(*args, **options)
        assert other.status == run.status
        if not apart:
            assert_same_events(other, run)
        # differences make the Jacobian of radau, and magnify rounding; instants magnify it, too
        close = run.solver == "rk45" and not apart
        assert_same_states(other, run, 1e-8 if close else 1e-7)
        return run

    monkeypatch.setattr(hb, "simulate", simulate)


@pytest.fixture(scope="session")
def simulate() -> Callable[..., hb.Result]:
    return simulate_example


@pytest.fixture(scope="session")
def modes_of() -> Callable[..., list[tuple[tuple[str, ...], str]]]:
    return visited


@pytest.fixture(params=["rk45", "radau"])
def solver(request: pytest.FixtureRequest) -> Iterator[str]:
    """The adaptive solvers."""
    return request.param
