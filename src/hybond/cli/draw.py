"""``hybond draw``: the bond graph of a model as a picture."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path
from typing import TYPE_CHECKING

from hybond.cli.lists import check_experiment, mode_of
from hybond.cli.netlists import read_model
from hybond.cli.running import read_graph
from hybond.cli.settings import changed_with, flatten_with
from hybond.cli.streams import say
from hybond.cli.targets import check_target
from hybond.errors import UsageError

if TYPE_CHECKING:
    from hybond.draw import Drawing
    from hybond.model.graph import FlatGraph

ENDINGS = (".svg", ".png", ".pdf", ".tex")


def draw(given: Namespace) -> int:
    """Draw a model; print where the picture is.

    Raises
    ------
    UsageError
        HB-X101 for options that do not go together.
    """
    name = given.out or Path(given.file).stem + ".svg"
    target = check_target(name, ENDINGS, "--out")
    if given.schematic:
        drawing = _schematic(given)
    else:
        drawing = _picture(read_graph(given.file, given.settings), given)
    drawing.save(target or name)
    say(name)
    return 0


def _schematic(given: Namespace) -> Drawing:
    """Return the schematic of a model made of parts."""
    from hybond.draw import draw_schematic

    for option in ("mode", "columns", "numbers", "simplify", "full", "closed", "open"):
        if getattr(given, option):
            raise UsageError(
                f"a schematic has no {option}",
                code="HB-X101",
                where=f"--{option}",
                hint=f"leave out --{option} or --schematic",
            )
    model, conversion = read_model(given.file)
    check_experiment(flatten_with(model, given.settings))
    drawn = conversion.as_parts() if conversion is not None else model
    return draw_schematic(changed_with(drawn, given.settings)[0])


def _picture(graph: FlatGraph, given: Namespace) -> Drawing:
    """Return the drawing asked for: one mode, the hybrid overview, or panels."""
    from hybond.draw import draw_hybrid, draw_mode, draw_modes

    modes = [mode_of(graph, text) for text in given.mode]
    simplify = True if given.simplify else False if given.full else None
    opened = given.open if given.open or given.closed else None
    signs = {
        "numbers": given.numbers,
        "simplify": simplify,
        "open": opened,
        "legend": given.legend,
    }
    if given.panels or (len(modes) > 1 and not given.hybrid):
        return draw_modes(
            graph,
            modes or None,
            columns=given.columns,
            **signs,
        )
    if given.columns is not None:
        raise UsageError(
            "there are columns only with --panels",
            code="HB-X101",
            where="--columns",
            hint="add --panels",
        )
    if len(modes) > 1:
        raise UsageError(
            "the overview has one reference mode",
            code="HB-X101",
            where="--hybrid",
            hint="give --mode once, or --panels for several modes",
        )
    if given.hybrid or (graph.machines and not modes):
        reference = modes[0] if modes else None
        return draw_hybrid(graph, reference, **signs)
    return draw_mode(graph, modes[0] if modes else None, **signs)
