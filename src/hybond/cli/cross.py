"""``hybond check --cross``: the same answer twice."""

from __future__ import annotations

from argparse import Namespace
from typing import Any

from hybond.cli.interrupt import Interruptible
from hybond.cli.record import to_json
from hybond.cli.running import read_graph
from hybond.cli.streams import complain, say
from hybond.errors import NumericsError, UsageError

VERSION = 1
"""Version of the object of ``--json``."""

OWNERS = {
    "until": ("cross", "modes"),
    "step": ("cross",),
    "engines": ("cross",),
    "out": ("modes",),
    "where": ("modes",),
    "limit": ("modes",),
}
"""The options of a check that belong to one kind of it."""


def check_options(given: Namespace) -> None:
    """Refuse options of a cross-check or of modes without one, and both at once.

    Raises
    ------
    UsageError
        HB-X101.
    """
    if given.cross and given.modes:
        raise UsageError(
            "--modes does not go with --cross",
            code="HB-X101",
            where="hybond check",
            hint="one after the other",
        )
    for option, owners in OWNERS.items():
        if getattr(given, option) and not any(getattr(given, owner) for owner in owners):
            raise UsageError(
                f"--{option} belongs to --{' and --'.join(owners)}",
                code="HB-X101",
                where="hybond check",
                hint=f"hybond check --{owners[0]} --{option} ... {given.file}",
            )


def cross(given: Namespace) -> int:
    """Run a model with two engines and compare; 3 if they differ and should not."""
    from hybond.analysis.cross.check import cross_check

    graph = read_graph(given.file, given.settings)
    with Interruptible() as interruptible:

        def progress(_: float, __: int) -> None:
            interruptible.check()

        found = cross_check(
            graph,
            given.until,
            engines=None if given.engines is None else _names(given.engines),
            step=given.step,
            progress=progress,
        )
    failure = None
    if not found.agrees:
        failure = NumericsError(
            f"{' and '.join(found.engines)} do not agree: {found.why}",
            code="HB-A402",
            where=graph.name,
            hint="a shorter --step; another pair of --engines shows which of the two is off",
        )
    if given.json:
        record: dict[str, Any] = {"hybond": VERSION, "file": given.file, **found.to_data()}
        if failure is not None:
            record["error"] = failure.to_dict()
        say(to_json(record).rstrip("\n"))
    else:
        say(graph.title or graph.name)
        say(found.text())
    if failure is None:
        return 0
    complain(str(failure))
    return failure.exit_code


def _names(text: str) -> list[str]:
    return [n.strip() for n in text.split(",") if n.strip()]
