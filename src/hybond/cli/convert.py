"""``hybond convert``: a model file in the other format, or one from the file of another tool."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path

from hybond.cli.netlists import currents_of
from hybond.cli.streams import complain, say
from hybond.cli.targets import check_new, check_target
from hybond.errors import UsageError
from hybond.files import load, save
from hybond.files.parse import BOND_GRAPHS, CIRCUITS
from hybond.files.whole import write_whole


def convert(given: Namespace) -> int:
    """Read one file and write a model file; nothing but a model is ever replaced."""
    target = check_target(given.target, (".toml", ".json"), "OUT")
    assert target is not None
    check_new(target, force=given.force)
    source = Path(given.source)
    suffix = source.suffix.lower()
    if suffix not in CIRCUITS + BOND_GRAPHS:
        for option, value in (("--diode-current", given.diode_current), ("--strict", given.strict)):
            if value:
                raise UsageError(
                    f"{option} is for files of other tools",
                    code="HB-X101",
                    where=str(source),
                    hint="leave it out",
                )
        save(load(source), target)
        say(given.target)
        return 0
    from hybond.circuits.commented import commented_text

    if suffix in CIRCUITS:
        from hybond.circuits.circuit import read_circuit

        current = currents_of(given.diode_current)
        conversion = read_circuit(source, diode_current=current, strict=given.strict)
    else:
        from hybond.circuits.bond_graph_tools import read_bond_graph

        conversion = read_bond_graph(source, strict=given.strict)
    for warning in conversion.warnings:
        complain(f"warning: {warning}")
    if target.suffix.lower() == ".toml" and not target.exists():
        text = commented_text(conversion)
        write_whole(target, text)
    else:
        save(conversion.model, target)
    say(given.target)
    return 0
