"""``hybond draw``: the bond graph of a model as a picture."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path

from hybond.cli.lists import mode_of
from hybond.cli.running import read_graph
from hybond.cli.streams import say
from hybond.cli.targets import check_target


def draw(given: Namespace) -> int:
    """Draw one mode of a model; print where the picture is."""
    name = given.out or Path(given.file).stem + ".svg"
    target = check_target(name, (".svg", ".png", ".pdf"), "--out")
    graph = read_graph(given.file, given.settings)
    mode = mode_of(graph, given.mode)

    from hybond.draw import draw_mode

    draw_mode(graph, mode, numbers=given.numbers).save(target or name)
    say(name)
    return 0
