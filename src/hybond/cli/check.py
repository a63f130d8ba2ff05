"""``hybond check``: what is wrong with a model, and what is worth knowing about it.

With ``--cross`` the same answer twice; with ``--modes`` which modes can follow each other, and
whether time always goes on.
"""

from __future__ import annotations

import itertools
import math
from argparse import Namespace
from collections import Counter
from typing import Any

from hybond.causality.dynamics import causality_of
from hybond.causality.explain import conflict_error
from hybond.causality.record import Causality
from hybond.causality.reference import Reference, reference_mode
from hybond.causality.report import ahead_lines
from hybond.causality.report import causality as modes_report
from hybond.cli.interrupt import Interruptible
from hybond.cli.lists import check_experiment
from hybond.cli.netlists import read_model
from hybond.cli.record import to_json
from hybond.cli.refusal import placed
from hybond.cli.running import read_graph
from hybond.cli.settings import changed_with
from hybond.cli.streams import complain, say
from hybond.cli.targets import check_target
from hybond.engine.outcome.apart import Apart
from hybond.errors import CausalityError, HybondError, NumericsError, UsageError
from hybond.hints.look import hints_of
from hybond.measures.asked import asked_of_experiment
from hybond.model.builder import Model
from hybond.model.checked import Checked, Hint
from hybond.model.graph import FlatGraph, Mode
from hybond.model.planar_friction import kept_paths
from hybond.names import plural
from hybond.one_run import check_run
from hybond.options import seconds_of
from hybond.runs.times import time_in
from hybond.scripts.run import check_script

BONDS = 5000
"""Conflicts ahead are looked for in models of up to this many bonds: in a second or so."""

MODES = 64
"""Other modes are looked at if there are not more than this."""

SHOWN = 4
"""Modes named of those of which the same is to be said."""
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
ENDINGS = (".svg", ".png", ".pdf", ".tex")


def check(given: Namespace) -> int:
    """Load, flatten, assign causality in the start mode, and report; or run it twice."""
    check_options(given)
    if given.cross:
        return cross(given)
    if given.modes:
        return modes(given)
    model = read_model(given.file)[0]
    if given.json:
        return _as_data(given, model)
    graph = _sound(given, model)
    say(graph.title or graph.name)
    _counts(graph)
    _machines(graph)
    start = graph.start_mode
    reference = reference_mode(graph)
    causality = causality_of(graph, start, reference=reference)
    say(f"start mode {_text(graph, start)}")
    for line in _findings(graph, causality) or ["integral causality throughout"]:
        say(f"  {line}")
    _other_modes(graph, reference)
    ahead: list[str] = []
    conflicts = causality.conflicts
    if _has_laws(graph):
        # the laws of junctions choose branches that have a causality; others are never entered
        conflicts = ()
        _enter_start(graph)
    elif graph.machines and len(graph.bonds) <= BONDS:
        ahead = list(ahead_lines(modes_report(graph).ahead))
    for line in ahead:
        say(f"warning: {line}" if not line.startswith(" ") else line)
    noted = list(graph.warnings)
    if not graph.nodes:
        noted.append("the model has no elements")
    warnings = sum(not line.startswith(" ") for line in ahead) + len(noted)
    for warning in noted:
        say(f"warning: {warning}")
    hints = hints_of(model, graph)
    for hint in hints:
        say(str(hint))
    for conflict in conflicts:
        complain(str(placed(conflict_error(graph, start, conflict), given)))
    if not conflicts:
        counts = [(warnings, "warning"), (len(hints), "hint")]
        words = [f"{n} {word}{'s' * (n > 1)}" for n, word in counts if n]
        say(f"fine, with {' and '.join(words)}" if words else "fine")
    return 2 if conflicts else 0


def _sound(given: Namespace, model: Model) -> FlatGraph:
    """Return the flat graph; refuse what a run, a script or a measurement of it would refuse."""
    changed, parameters = changed_with(model, given.settings)
    graph = changed.flatten(parameters=parameters)
    check_experiment(graph)
    check_run(graph)
    latest = check_script(changed, graph, parameters)
    until = seconds_of(time_in(graph.experiment.get("until")), "until")
    asked_of_experiment(graph, until if latest is None else latest)
    return graph


def _as_data(given: Namespace, model: Model) -> int:
    """Print a check as one JSON object, for editors: refusals and hints with their places."""
    found: HybondError | None = None
    hints: tuple[Hint, ...] = ()
    warnings: list[str] = []
    try:
        graph = _sound(given, model)
        hints = hints_of(model, graph)
        warnings = list(graph.warnings)
        conflicts = () if _has_laws(graph) else _conflicts(graph)
        found = next(iter(conflicts), None)
        found = found and placed(found, given)
    except HybondError as error:
        found = placed(error, given)
    said = Checked(model.title or model.name, found, hints).to_data()
    say(to_json({"hybond": VERSION, "file": given.file, **said, "warnings": warnings}).rstrip("\n"))
    return 0 if found is None else found.exit_code


def _conflicts(graph: FlatGraph) -> tuple[HybondError, ...]:
    start = graph.start_mode
    causality = causality_of(graph, start, reference=reference_mode(graph))
    return tuple(conflict_error(graph, start, c) for c in causality.conflicts)


def _has_laws(graph: FlatGraph) -> bool:
    return any(m.law is not None for m in graph.machines)


def _enter_start(graph: FlatGraph) -> None:
    """Raise what leaves the laws of junctions nothing to decide at the start."""
    apart = Apart(graph)
    try:
        apart.leaving(apart.start, graph.start_mode, graph.start_mode)
    except CausalityError:
        raise
    except HybondError:
        # of values, not of structure: a run says so
        return


def _counts(graph: FlatGraph) -> None:
    """Say how much was written: not what laws and switches add to it, each with a bond."""
    shown = [n for n in graph.nodes if not n.hidden and not n.implied]
    bonds = len(graph.bonds) - (len(graph.nodes) - len(shown))
    junctions = sum(n.is_junction for n in shown)
    kinds = Counter(n.kind for n in shown if not n.is_junction)
    by_kind = ", ".join(f"{count} {kind}" for kind, count in sorted(kinds.items()))
    elements = len(shown) - junctions
    say(f"  {elements} {plural('element', elements)} ({by_kind or 'none'})")
    controlled = sum(n.is_junction and n.controlled for n in shown)
    of_them = f"{controlled} of them controlled" if junctions != 1 else "controlled"
    told = f", {of_them}" if junctions != 1 or controlled else ""
    say(f"  {junctions} {plural('junction', junctions)}{told}; {bonds} {plural('bond', bonds)}")
    kept = kept_paths(graph)
    integrated = sum(i.path not in kept for i in graph.integrals)
    integrals = f" and {integrated} integral{'s' * (integrated > 1)}" if integrated else ""
    stored = len(graph.storages)
    say(f"  {stored} stored quantit{'y' if stored == 1 else 'ies'}{integrals}")


def _machines(graph: FlatGraph) -> None:
    for machine in graph.machines:
        states = [
            ("*" if k == machine.start else "") + state + (" (fieldless)" if fieldless else "")
            for k, (state, fieldless) in enumerate(
                itertools.zip_longest(machine.states, machine.fieldless, fillvalue=False)
            )
            if isinstance(state, str)
        ]
        rules = f"{len(machine.rules)} rule" + ("" if len(machine.rules) == 1 else "s")
        say(f"  machine {machine.path}: {', '.join(states)}; {rules}")
    if graph.machines:
        modes = math.prod(len(m.states) for m in graph.machines)
        short = any(f for m in graph.machines for f in m.fieldless)
        more = "; a fieldless state lasts an instant only" if short else ""
        say(f"  {modes} {plural('mode', modes)} (* start{more})")


def _findings(graph: FlatGraph, causality: Causality) -> list[str]:
    """Return what an engineer wants to know of the causality of a mode."""
    lines: list[str] = []
    if causality.conflicts and _has_laws(graph):
        # no run is ever in this combination: what it would depend on says nothing
        return ["no run is in it: the laws of junctions take other branches"]
    if causality.derivative:
        paths = ", ".join(graph.storages[k].path for k in causality.derivative)
        lines.append(f"derivative causality: {paths} (dependent on other storages or sources)")
    if causality.loops:
        names = ", ".join(repr(graph.bonds[b].name) for b in causality.loops)
        lines.append(f"algebraic loop through {names} (solved at each evaluation)")
    if causality.conflicts:
        count = len(causality.conflicts)
        lines.append(f"{count} causal conflict{'s' if count > 1 else ''}")
    return lines


def _other_modes(graph: FlatGraph, reference: Reference) -> None:
    """Report on other modes; not all of them need be reachable, so they are no errors."""
    if math.prod(len(m.states) for m in graph.machines) > MODES:
        say(f"other modes: more than {MODES}, not looked at")
        return
    alike: dict[tuple[str, ...], list[str]] = {}
    never = 0
    for mode in itertools.product(*(range(len(m.states)) for m in graph.machines)):
        if mode == graph.start_mode:
            continue
        causality = causality_of(graph, mode, reference=reference)
        if causality.conflicts and _has_laws(graph):
            never += 1
            continue
        lines = tuple(_findings(graph, causality))
        if lines:
            alike.setdefault(lines, []).append(_text(graph, mode))
    for lines, modes in alike.items():
        more = len(modes) - SHOWN
        shown = modes if more < 2 else [*modes[:SHOWN], f"{more} more"]
        say(f"{plural('mode', len(modes))} {', '.join(shown)}")
        for line in lines:
            say(f"  {line}")
    if never:
        say(
            f"{never} {plural('combination', never)} of branches that no run enters: the laws of "
            "junctions take others"
        )


def _text(graph: FlatGraph, mode: Mode) -> str:
    return "(" + (", ".join(graph.mode_names(mode).values()) or "the only mode") + ")"


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


"""Version of the object of ``--json``."""


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
