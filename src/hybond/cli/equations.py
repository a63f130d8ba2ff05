"""``hybond equations``: the mixed-Boolean equations of a model, or its complementarity system."""

from __future__ import annotations

from argparse import Namespace
from typing import Any

from hybond.analysis.complementarity.form import complementarity
from hybond.cli.lists import mode_of, split
from hybond.cli.record import to_json
from hybond.cli.running import read_graph
from hybond.cli.streams import say
from hybond.equations.derive import state_equations
from hybond.equations.junction_matrix import JunctionMatrix, junction_matrix
from hybond.equations.matrix import BooleanMatrix
from hybond.equations.state_form import StateEquations
from hybond.equations.transfer import transfer_functions
from hybond.errors import EquationError, HybondError, UsageError
from hybond.model.graph import FlatGraph, Mode

VERSION = 1
"""Version of the object of ``--json``."""


def show_equations(given: Namespace) -> int:
    """Print equations; nothing is simulated."""
    for form in ("markdown", "latex"):
        unused = [o for o in ("matrices", "junctions", "transfer") if getattr(given, o)]
        allowed = () if form == "markdown" else ("junctions", "transfer")
        refused = [o for o in unused if o not in allowed]
        if getattr(given, form) and refused:
            raise UsageError(
                f"--{form} writes no {refused[0]}",
                code="HB-X101",
                where="hybond equations",
                hint=f"leave out --{refused[0]} or --{form}",
            )
    if given.complementarity:
        return _complementarity(given)
    graph = read_graph(given.file, given.settings)
    mode = None if given.mode is None else mode_of(graph, given.mode)
    eq = state_equations(
        graph,
        outputs=split([given.outputs or ""]) or _plotted(graph, given),
        symbolic=not given.numbers,
    )
    jsm = junction_matrix(graph, symbolic=not given.numbers) if given.junctions else None
    if given.json:
        say(to_json(_record(given, graph, eq, jsm, mode)).rstrip("\n"))
    elif given.latex:
        say(eq.latex(mode))
        if jsm is not None:
            say(rf"\[ S = {jsm.S.latex()} \]")
        if given.transfer:
            say(transfer_functions(eq, _chosen(graph, mode)).latex())
    elif given.markdown:
        say(eq.markdown(mode).rstrip("\n"))
    else:
        _say(given, graph, eq, jsm, mode)
    return 0


def _complementarity(given: Namespace) -> int:
    """Print the complementarity system of a model."""
    for option in ("outputs", "junctions", "transfer"):
        if getattr(given, option):
            raise UsageError(
                f"--complementarity has no {option}",
                code="HB-X101",
                where="hybond equations",
                hint=f"leave out --{option} or --complementarity",
            )
    graph = read_graph(given.file, given.settings)
    mode = None if given.mode is None else mode_of(graph, given.mode)
    form = complementarity(graph, mode, symbolic=not given.numbers)
    if given.json:
        record = {"hybond": VERSION, "file": given.file, **form.to_data()}
        say(to_json({**record, "equations": form.text().splitlines()}).rstrip("\n"))
    elif given.latex:
        say(form.latex())
    elif given.markdown:
        say(form.markdown().rstrip("\n"))
    else:
        say(f"{graph.title or graph.name}\n")
        say(form.text())
        for name in "ABECDF" if given.matrices else "":
            matrix: BooleanMatrix = getattr(form, name)
            if matrix.entries:
                say(f"\n{name}")
                say(matrix.text())
    return 0


def _plotted(graph: FlatGraph, given: Namespace) -> list[str]:
    """Return outputs for transfer functions if none are named: what the experiment plots."""
    if not given.transfer:
        return []
    found = []
    for name in graph.experiment.get("plot", ()):
        try:
            state_equations(graph, reference=graph.start_mode, outputs=[name], symbolic=False)
        except EquationError:
            continue  # not linear in efforts and flows
        found.append(name)
    return found


def _chosen(graph: FlatGraph, mode: Mode | None) -> Mode:
    return graph.start_mode if mode is None else mode


def _say(
    given: Namespace,
    graph: FlatGraph,
    eq: StateEquations[Any],
    jsm: JunctionMatrix | None,
    mode: Mode | None,
) -> None:
    say(graph.title or graph.name)
    if graph.machines:
        say(f"reference mode: {graph.mode_text(eq.reference)}")
    say()
    say(eq.text(mode))
    if given.matrices:
        for name in "EABCDN":
            matrix: BooleanMatrix = getattr(eq, name)
            if mode is not None:
                matrix = matrix.in_mode(mode)
            if matrix.entries:
                say(f"\n{name}")
                say(matrix.text())
    if jsm is not None:
        say("\njunction structure")
        say(jsm.text(mode))
    if given.transfer:
        chosen = _chosen(graph, mode)
        say(f"\ntransfer functions, mode {graph.mode_text(chosen)}")
        if not eq.outputs:
            say("no outputs: name signals with --outputs")
        else:
            say(transfer_functions(eq, chosen).text() or "no output reacts to a source")
        say(_poles(eq, chosen))


def _poles(eq: StateEquations[Any], mode: Mode) -> str:
    try:
        poles = eq.at(mode).poles()
    except HybondError as error:
        return f"poles: {error.why}"
    return "poles " + (", ".join(f"{p:.6g}" for p in poles) or "none") + " 1/s"


def _record(
    given: Namespace,
    graph: FlatGraph,
    eq: StateEquations[Any],
    jsm: JunctionMatrix | None,
    mode: Mode | None,
) -> dict[str, Any]:
    record: dict[str, Any] = {
        "hybond": VERSION,
        "file": given.file,
        "reference": graph.mode_names(eq.reference),
        "booleans": {
            eq.display.kappa(k): {
                "machine": graph.machines[b.machine].path,
                "states": [graph.machines[b.machine].states[s] for s in sorted(b.states)],
            }
            for k, b in enumerate(eq.naming.booleans)
        },
        "states": list(eq.states),
        "inputs": list(eq.inputs),
        "outputs": list(eq.output_names),
        "equations": eq.text(mode).splitlines(),
        **{name: _entries(getattr(eq, name)) for name in "EABCDN"},
    }
    if jsm is not None:
        record["junctions"] = {
            "receives": list(jsm.outputs),
            "gives": list(jsm.inputs),
            "S": _entries(jsm.S),
            "Q": _entries(jsm.Q),
        }
    if mode is not None and not eq.laws:
        numbers = eq.at(mode)
        record["mode"] = graph.mode_names(mode)
        record["numbers"] = {name: getattr(numbers, name).tolist() for name in "EABCDF"}
    if given.transfer:
        found = transfer_functions(eq, _chosen(graph, mode))
        record["transfer"] = [
            {"output": output, "input": source, "value": found[output, source]}
            for output, source in found.entries
        ]
    return record


def _entries(matrix: BooleanMatrix) -> list[list[Any]]:
    """Return entries as ``[row, column, text]``, indices from 0."""
    return [[i, j, matrix.text_of(i, j)] for i, j in sorted(matrix.entries)]
