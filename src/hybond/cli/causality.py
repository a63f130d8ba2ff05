"""``hybond causality``: strokes, and which of them depend on the mode."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Sequence
from typing import Any

from hybond.causality.advice import advise
from hybond.causality.advice_record import Advice
from hybond.causality.diagnostic import Diagnostic, diagnostic_causality
from hybond.causality.report import CausalityReport, causality
from hybond.cli.lists import mode_of, split
from hybond.cli.record import to_json
from hybond.cli.running import read_graph
from hybond.cli.streams import say
from hybond.errors import ModelError, UsageError
from hybond.model.graph import FlatGraph
from hybond.names import did_you_mean

VERSION = 1
"""Version of the object of ``--json``."""


def show_causality(given: Namespace) -> int:
    """Report the causality of one mode; the exit code is 2 if it has none."""
    graph = read_graph(given.file, given.settings)
    report = causality(graph, None if given.mode is None else mode_of(graph, given.mode))
    why = _chains(report, given.why)
    diagnostic = advice = None
    if given.diagnostic:
        diagnostic = _diagnostic(graph, split([given.sensors or ""]))
    if given.advice:
        advice = advise(graph, report.dynamics)
    if given.json:
        record: dict[str, Any] = {"hybond": VERSION, "file": given.file, **report.to_data()}
        if diagnostic is not None:
            record["diagnostic"] = _diagnostic_record(graph, diagnostic)
        if advice is not None:
            record["advice"] = [_advice_record(a) for a in advice]
        say(to_json(record).rstrip("\n"))
        return 2 if report.conflicts else 0
    say(graph.title or graph.name)
    if given.why:
        for line in why:
            say(line)
        return 2 if report.conflicts else 0
    for line in report.lines(every=True if given.all else None):
        say(f"  {line}" if line else "")
    if diagnostic is not None:
        _say_diagnostic(graph, diagnostic)
    if advice is not None:
        _say_advice(advice)
    return 2 if report.conflicts else 0


def _chains(report: CausalityReport, bonds: Sequence[str]) -> list[str]:
    """Return why bonds have their strokes, one line per bond of each chain."""
    lines = []
    for name in bonds:
        try:
            lines += report.why(name)
        except KeyError:
            raise UsageError(
                f"there is no bond {name!r}",
                code="HB-X108",
                where="--why",
                hint=did_you_mean(name, [b.name for b in report.graph.bonds]),
            ) from None
    return lines


def _diagnostic(graph: FlatGraph, sensors: list[str]) -> Diagnostic:
    try:
        return diagnostic_causality(graph, sensors=sensors)
    except ModelError as error:  # a name on the command line, not one in the model
        raise UsageError(error.why, code="HB-X108", where="--sensors", hint=error.hint) from None


def _say_diagnostic(graph: FlatGraph, found: Diagnostic) -> None:
    say()
    say(f"diagnostic causality: {'one for all modes' if found.exists else 'none'}")
    for node, absorber in found.absorbers.items():
        name = _path(graph, node)
        if absorber.bond < 0:
            say(f"  {name}: turns no stroke ({absorber.kind})")
        else:
            note = f" ({absorber.note})" if absorber.note else ""
            say(f"  {name}: absorbed by {_path(graph, absorber.node)}{note}")
    for node, reason in found.missing.items():
        say(f"  {_path(graph, node)}: not absorbed: {reason}")
    for storage, reason in found.storages.items():
        say(f"  {graph.storages[storage].path}: not in derivative causality: {reason}")
    for text in found.conflicts:
        say(f"  conflict: {text}")


def _say_advice(advice: Sequence[Advice]) -> None:
    say()
    if not advice:
        say("advice: no change of strokes reaches storage or another switch")
    for one in advice:
        first, *rest = one.text.splitlines()
        say(f"advice: {first}")
        for line in rest:
            say(f"  {line}")


def _diagnostic_record(graph: FlatGraph, found: Diagnostic) -> dict[str, Any]:
    return {
        "exists": found.exists,
        "strokes": {
            bond.name: graph.nodes[bond.head if stroke else bond.tail].path
            for bond, stroke in zip(graph.bonds, found.strokes, strict=True)
        },
        "absorbers": {
            _path(graph, node): {
                "by": _path(graph, a.node),
                "bond": graph.bonds[a.bond].name if a.bond >= 0 else None,
                "kind": a.kind,
                "note": a.note,
            }
            for node, a in found.absorbers.items()
        },
        "missing": {_path(graph, node): reason for node, reason in found.missing.items()},
        "storages": {graph.storages[k].path: reason for k, reason in found.storages.items()},
        "conflicts": list(found.conflicts),
    }


def _advice_record(advice: Advice) -> dict[str, Any]:
    return {
        "switches": list(advice.switches),
        "bonds": list(advice.bonds),
        "storages": list(advice.storages),
        "fastest": advice.fastest,
        "slowest": advice.slowest,
        "resistors": [
            {
                "name": r.name,
                "junction": r.junction,
                "kind": r.kind,
                "splits": r.splits or None,
                "bonds": list(r.bonds()),
                "value": r.value,
                "time_constant": r.time_constant,
                "gain": r.gain,
            }
            for r in advice.resistors
        ],
        "pins": dict(advice.pins),
        "text": advice.text,
    }


def _path(graph: FlatGraph, node: int) -> str:
    return graph.nodes[node].path.removesuffix(".switch")
