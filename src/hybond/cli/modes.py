"""``hybond check --modes``: which modes can follow each other, and whether time always goes on."""

from __future__ import annotations

from argparse import Namespace
from typing import Any

from hybond.cli.record import to_json
from hybond.cli.running import read_graph
from hybond.cli.streams import complain, say
from hybond.cli.targets import check_target

VERSION = 1
"""Version of the object of ``--json``."""
ENDINGS = (".svg", ".png", ".pdf", ".tex")


def modes(given: Namespace) -> int:
    """Print the modes that can follow each other; draw them. 3 if time stops from some states."""
    from hybond.analysis.modes.reachable import MODES, reachable

    target = check_target(given.out, ENDINGS, "--out") if given.out else None
    graph = read_graph(given.file, given.settings)
    limit = MODES if given.limit is None else given.limit
    found = reachable(graph, where=given.where, until=given.until, limit=limit)
    if given.json:
        record: dict[str, Any] = {"hybond": VERSION, "file": given.file, **found.to_data()}
        say(to_json(record).rstrip("\n"))
    else:
        say(found.title)
        say(str(found))
    if target is not None:
        found.draw(target)
        complain(given.out) if given.json else say(given.out)
    return 3 if found.time == "possible" else 0
