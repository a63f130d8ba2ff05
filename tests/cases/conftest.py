"""Published cases: the shipped models, run as a user runs them."""

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

import hybond as hb

EXAMPLES = Path(__file__).parents[2] / "examples"


def simulate_example(name: str, **options) -> hb.Result:
    """Simulate ``examples/<name>.toml``."""
    return hb.simulate(hb.load(EXAMPLES / f"{name}.toml"), **options)


def visited(run: hb.Result, event) -> list[tuple[tuple[str, ...], str]]:
    """The modes of an event in order: states of the machines, and kind."""
    return [(tuple(run.graph.mode_names(s.mode).values()), s.kind) for s in event.steps]


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
