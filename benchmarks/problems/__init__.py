"""The problems of the speed table, one a file: the model, the job in other tools, what is true."""

from __future__ import annotations

from collections.abc import Callable

from measuring.problem import Problem

from problems import (
    ball,
    buck,
    cells,
    cold,
    contacts,
    cradle,
    ensemble,
    friction,
    ladder,
    netlist,
    rectifier,
    stiff,
    stop,
)

DIODES, MORE_DIODES = (4, 20, 50, 200), (4, 20, 50, 100, 200)

PROBLEMS: dict[str, Callable[[bool], list[Problem]]] = {
    "P1": lambda full: [ball.problem(full)],
    "P2": lambda full: [rectifier.problem(full)],
    "P3": lambda full: [buck.problem(full)],
    "P4": lambda full: [stop.problem(full)],
    "P5": lambda full: [ladder.problem(n, full) for n in (MORE_DIODES if full else DIODES)],
    "P6": lambda full: [stiff.problem(full)],
    "P7": lambda full: [ensemble.problem(full)],
    "P8": lambda full: [cold.problem(full)],
    "P9": lambda full: [contacts.problem(n, full) for n in (100, 1000)],
    "P10": lambda full: [friction.located(full)],
    "P11": lambda full: [friction.stepped(full)],
    "P12": lambda full: [cradle.problem(full)],
    "P13": netlist.problems,
    "P14": lambda full: [cells.problem(full)],
}
"""By key; some come in several sizes."""
ASKED: dict[str, Callable[[bool], list[Problem]]] = {
    "P9-10000": lambda full: [contacts.problem(10_000, full)],
}
"""Done only where they are named."""
