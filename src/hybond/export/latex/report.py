"""The report itself: its sections, in the order in which a model is understood."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import Any

from hybond.causality.report import causality
from hybond.draw.drawing import draw
from hybond.draw.tex import escape
from hybond.equations.derive import state_equations
from hybond.errors import HybondError
from hybond.export.latex.formulas import FITTED, formulas
from hybond.export.latex.plots import colours, plots
from hybond.model.builder import Model
from hybond.model.graph import FlatGraph
from hybond.model.parts import InputPart, Integral, Part, Sampled, SubmodelPart
from hybond.report import fired_text, joule
from hybond.result import Result
from hybond.runs.trace import Event
from hybond.simulation import simulate
from hybond.units import try_quantity

EVENTS = 60
"""Events listed; the rest is counted."""
FORMULAS = 60_000
"""Characters of equations above which they fill pages that nobody reads."""

_HEAD = r"""\documentclass[11pt,a4paper]{article}
\usepackage[T1]{fontenc}
\usepackage{amsmath}
\usepackage{graphicx}
\usepackage{array}
\usepackage{longtable}
\usepackage{tikz}
\usepackage[margin=22mm]{geometry}
\setlength{\parindent}{0pt}
\setlength{\parskip}{4pt plus 1pt}
\setlength{\emergencystretch}{3em}
\newcommand{\room}{\par\penalty-100\vskip0pt plus 8\baselineskip\penalty-250
  \vskip0pt plus -8\baselineskip}"""

Row = Sequence[str]


def to_latex(model: Model, *, run: Result | None = None) -> str:
    r"""Return a report of a model as one LaTeX document.

    It has the drawing with causal strokes, the reference causality and what of it depends on the
    mode, parameters, elements, the mixed-Boolean state equations, machines and laws, and the
    results of the experiment. All is in the text itself, plots too: ``pdflatex report.tex`` needs
    no other file, and no package beyond amsmath, graphicx, longtable, geometry and TikZ.

    Parameters
    ----------
    run : Result, optional
        The results shown. Default: those of the model's experiment; without an ``until`` there,
        none.

    Raises
    ------
    ModelError
        For what is wrong with the model. A run that stops is in the report, with the reason, and
        so is the reason why a model has no equations in closed form.

    Examples
    --------
    >>> from hybond.model.constructors import C, I, One
    >>> m = Model("oscillator", domain="translational", title="A mass & a spring")
    >>> m.add(mass=I("1 kg", f="1 m/s"), spring=C("10 mm/N"), v=One())
    >>> m.bond("v -> mass", "v -> spring")
    >>> text = to_latex(m)
    >>> text.splitlines()[0], r"\title{A mass \& a spring}" in text
    ('\\documentclass[11pt,a4paper]{article}', True)
    """
    graph = model.flatten()
    error = ""
    if run is None and "until" in model.experiment:
        run = simulate(model, on_error="return")
    if run is not None and run.error is not None:
        error = str(run.error)
    lines = [_HEAD, FITTED, colours(), rf"\title{{{escape(model.title or model.name)}}}"]
    lines += [r"\author{}", r"\date{}", r"\begin{document}", r"\maketitle"]
    if model.about:
        lines += [escape(part.strip()) + r"\par" for part in model.about.split("\n\n")]
    for title, body in (
        ("Bond graph", _drawing(graph)),
        ("Causality", _causality(graph)),
        ("Parameters", _parameters(model, graph)),
        ("Elements", _elements(model)),
        ("State equations", _equations(graph)),
        ("Machines", _machines(graph)),
        ("Signals and inputs", _signals(model)),
        ("Results", _results(run, error)),
    ):
        found = list(body)
        if found:
            lines += [rf"\room\section{{{title}}}", *found]
    return "\n".join([*lines, r"\end{document}"]) + "\n"


def _drawing(graph: FlatGraph) -> Iterator[str]:
    report = causality(graph)
    drawing = draw(
        graph,
        mode=report.mode,
        causality=report.causality,
        dynamic_bonds=report.dynamics.dynamic,
        title=False,
    )
    picture = "\n".join(
        line for line in drawing.tikz().splitlines() if not line.startswith("%")
    ).strip()
    yield rf"\begin{{center}}\fitted{{%{chr(10)}{picture}%{chr(10)}}}\end{{center}}"
    if graph.machines:
        yield (
            f"Shown in the mode {escape(_quiet(graph.mode_text(report.mode)))}. "
            "A dashed stroke stands where the mode decides."
        )


def _causality(graph: FlatGraph) -> Iterator[str]:
    report = causality(graph)
    reference = report.dynamics.reference
    if graph.machines:
        yield escape(
            f"Reference mode: {_quiet(graph.mode_text(reference.mode))}, {reference.how}; "
            f"{reference.integral} of {reference.storages} stored quantities in integral causality."
        )
    yield escape(report.counts() + ".")
    yield from _table(
        "p{0.28}p{0.14}p{0.24}p{0.26}",
        ("bond", "stroke at", "in other modes", "reason"),
        [(b.name, b.at, _kind(b, graph), b.why) for b in report.bonds],
    )
    if report.derivative:
        yield escape(f"In derivative causality: {', '.join(report.derivative)}.") + r"\par"
    if report.dynamics.storages:
        paths = ", ".join(graph.storages[k].path for k in report.dynamics.storages)
        yield escape(f"Integral or derivative, by the mode: {paths}.") + r"\par"
    if report.loops:
        yield escape(f"Algebraic loops through {', '.join(report.loops)}.") + r"\par"
    for text in report.conflicts:
        yield escape(f"Conflict: {text}") + r"\par"
    for cause in report.ahead.found:
        yield escape(f"Modes without causality can be reached: {cause.text}") + r"\par"


def _kind(bond: Any, graph: FlatGraph) -> str:
    if not graph.machines:
        return "the only mode"
    if bond.kind == "dynamic":
        return f"changes with {', '.join(bond.through)}" if bond.through else "changes"
    return "the same" if bond.kind == "invariant" else "the same where examined"


def _parameters(model: Model, graph: FlatGraph) -> Iterator[str]:
    rows = []
    for path, value in graph.parameters.items():
        written = model.parameters.get(path, "") if "." not in path else ""
        quantity = try_quantity(written) if isinstance(written, str) else None
        unit = str(quantity.dimension) if quantity is not None else ""
        unit = "" if unit == "1" else unit
        rows.append((path, str(written), f"{value:.9g}" if isinstance(value, float) else "", unit))
    if rows:
        heads = ("name", "as written", "in SI", "unit")
        yield from _table("p{0.28}p{0.34}p{0.16}p{0.14}", heads, rows)


def _elements(model: Model) -> Iterator[str]:
    rows = list(_element_rows(model, "", []))
    heads = ("name", "kind", "value or law", "start and options")
    yield from _table("p{0.20}p{0.13}p{0.33}p{0.26}", heads, rows)


def _element_rows(model: Model, prefix: str, inside: list[Model]) -> Iterator[Row]:
    for name, part in model.elements.items():
        path = f"{prefix}{name}"
        if isinstance(part, SubmodelPart):
            which = part.model.name if isinstance(part.model, Model) else str(part.model)
            given = {**part.parameters, **part.inputs}
            yield path, "submodel", which, _pairs(given)
            inner = part.model if isinstance(part.model, Model) else model.models.get(part.model)
            if inner is not None and not any(inner is m for m in inside):
                yield from _element_rows(inner, f"{path}.", [*inside, inner])
        elif isinstance(part, Part):
            kind = f"{part.kind}-junction" if part.kind in ("0", "1") else part.kind
            yield path, kind, _value(part.value), _pairs(part.options)


def _value(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, dict):
        return "; ".join(f"{k} = {_value(v)}" for k, v in value.items())
    return str(value)


def _pairs(given: Any) -> str:
    return ", ".join(f"{k} = {_value(v)}" for k, v in given.items())


def _equations(graph: FlatGraph) -> Iterator[str]:
    if not graph.storages:
        yield "Nothing is stored: there are no state equations."
        return
    try:
        lines, notes = formulas(state_equations(graph).latex())
    except HybondError as error:
        yield escape(f"There are no mixed-Boolean equations in closed form: {error.why}.") + r"\par"
        if error.hint:
            yield escape(f"({error.code}; try: {error.hint})") + r"\par"
        return
    if sum(map(len, lines)) > FORMULAS:
        yield (
            f"The equations in symbols have {sum(map(len, lines))} characters and are left out; "
            r"\texttt{hybond equations} prints them."
        )
        return
    yield r"\begingroup\small\setlength{\parskip}{8pt}"
    yield from lines
    yield r"\endgroup"
    if notes:
        yield from _items(notes)


def _machines(graph: FlatGraph) -> Iterator[str]:
    for machine in graph.machines:
        if machine.law is not None:
            law = machine.law
            named = graph.nodes[law.node]
            states = ", ".join(machine.states)
            yield (
                escape(
                    f"{named.path} is a {named.kind}-junction with the law {law.kind}, decided by "
                    f"complementarity; its states are {states}."
                )
                + r"\par"
            )
            continue
        yield rf"\room\subsection*{{{escape(machine.path)}}}"
        rows = []
        for k, state in enumerate(machine.states):
            on = ", ".join(
                graph.nodes[n].path.removesuffix(".switch") for n in sorted(machine.on[k])
            )
            remarks = ["start"] if k == machine.start else []
            if machine.fieldless and machine.fieldless[k]:
                remarks.append("holds at an instant only")
            rows.append((state, on or "none", ", ".join(remarks)))
        yield from _table("p{0.25}p{0.45}p{0.22}", ("state", "switches ON", ""), rows)
        if machine.rules:
            names = machine.states
            yield from _table(
                "p{0.18}p{0.18}p{0.56}",
                ("from", "to", "when"),
                [(names[r.source], names[r.target], r.said) for r in machine.rules],
            )


def _signals(model: Model) -> Iterator[str]:
    rows: list[Row] = []
    for name, signal in model.signals.items():
        if isinstance(signal, Integral):
            rows.append((name, "integral", f"{signal.rate}, from {signal.start}"))
        elif isinstance(signal, Sampled):
            rows.append((name, "sampled", f"{signal.value}, every {signal.every}"))
        else:
            rows.append((name, "signal", str(signal)))
    rows += [(name, "input", _input(given)) for name, given in model.inputs.items()]
    if rows:
        yield from _table("p{0.2}p{0.12}p{0.6}", ("name", "", "is"), rows)


def _input(given: InputPart) -> str:
    if given.function is not None:
        return "a Python function"
    if given.pwm is not None:
        return f"pwm: {_pairs(given.pwm)}"
    if given.table is not None:
        rows = [f"({t}, {v})" for t, v in list(given.table)[:8]]
        more = ", ..." if len(given.table) > len(rows) else ""
        return f"table{' joined by lines' if given.linear else ''}: {', '.join(rows)}{more}"
    return str(given.constant)


def _results(run: Result | None, error: str) -> Iterator[str]:
    if run is None:
        return
    until = f"From 0 to {run.t_end:.9g} s, solver {run.solver}, status {run.status}."
    yield escape(until) + r"\par"
    if error:
        yield escape(f"The run stopped: {error}") + r"\par"
    if not len(run.events) and not run.names:
        return
    names = run.graph.experiment.get("plot") or [s.path for s in run.graph.storages][:6]
    if run.t_end > run.t_begin:
        for picture in plots(run, names):
            yield rf"\begin{{center}}\fitted{{%{chr(10)}{picture}%{chr(10)}}}\end{{center}}"
    yield from _events(run)
    yield from _impulses(run)
    yield from _energy(run)
    final = [(name, f"{value:.9g}", run.unit(name)) for name, value in run.final.items()]
    if final:
        yield rf"\room\subsection*{{At {escape(f'{run.t_end:.9g} s')}}}"
        yield from _table("p{0.35}p{0.3}p{0.25}", ("signal", "value", "unit"), final)


def _events(run: Result) -> Iterator[str]:
    events = [run.events[k] for k in range(min(len(run.events), EVENTS))]
    yield r"\room\subsection*{Events}"
    rows: list[Row] = []
    for event in events:
        time, cause = f"{event.t:.9g}", str(event.cause)
        for k, step in enumerate(event.steps):
            fired = "; ".join(f"{f.machine}: {f.source} -> {f.target}" for f in step.fired)
            why = "; ".join(fired_text(f) for f in step.fired)
            kind = "landed" if event.landed and k + 1 == len(event.steps) else step.kind
            rows.append((time, cause, fired, kind, why))
            time, cause = "", ""
    heads = ("time, s", "cause", "transitions", "mode is", "because")
    yield from _table("p{0.14}p{0.09}p{0.24}p{0.12}p{0.33}", heads, rows)
    rest = len(run.events) - len(events)
    if rest:
        yield f"{rest} more events are not listed.\\par"


def _impulses(run: Result) -> Iterator[str]:
    rows: list[Row] = []
    for event in _writing(run):
        for step in event.steps:
            if step.kind == "mythical":
                continue
            for name, area in sorted(step.impulses.items()):
                unit = run.unit(name)
                rows.append((f"{event.t:.9g}", name, f"{area:.6g}", f"{unit}·s" if unit else "s"))
    if rows:
        yield r"\room\subsection*{Impulses}"
        heads = ("time, s", "of", "area", "unit")
        yield from _table("p{0.2}p{0.35}p{0.2}p{0.15}", heads, rows[: 2 * EVENTS])
        if len(rows) > 2 * EVENTS:
            yield f"{len(rows) - 2 * EVENTS} more impulses are not listed.\\par"


def _energy(run: Result) -> Iterator[str]:
    rows: list[Row] = []
    for event in _writing(run):
        for step in event.steps:
            energy = step.energy
            if energy is None or step.kind == "mythical" or energy.after == energy.before:
                continue
            values = (energy.before, energy.after, energy.source, energy.lost)
            rows.append((f"{event.t:.9g}", *(joule(v) for v in values)))
    if rows:
        yield r"\room\subsection*{Energy at jumps}"
        heads = ("time, s", "before", "after", "supplied", "lost")
        yield from _table("p{0.2}p{0.17}p{0.17}p{0.17}p{0.17}", heads, rows[:EVENTS])


def _writing(run: Result) -> Iterator[Event]:
    for k in range(min(len(run.events), 10 * EVENTS)):
        yield run.events[k]


# -- pieces of LaTeX


def _table(columns: str, heads: Row, rows: Sequence[Row]) -> Iterator[str]:
    r"""Yield a table that may go over pages; widths are parts of the line."""
    spec = columns.replace("p{", r">{\raggedright\arraybackslash}p{").replace("}p", "}p")
    spec = spec.replace("}>", r"\linewidth}>")
    spec = spec.removesuffix("}") + r"\linewidth}"
    yield r"\begingroup\footnotesize\setlength{\tabcolsep}{3pt}"
    yield rf"\begin{{longtable}}[l]{{{spec}}}"
    yield " & ".join(rf"\textbf{{{escape(h)}}}" for h in heads) + r" \\ \hline \endhead"
    for row in rows:
        yield " & ".join(_cell(text) for text in row) + r" \\"
    yield r"\end{longtable}\endgroup"


def _cell(text: str) -> str:
    """Return a cell, with places where a long name may be broken."""
    found = escape(_quiet(text)).replace(r"\_", r"\_\allowbreak{}")
    return re.sub(r"\.(?=[A-Za-z])|(?<=\S)[*/](?=\S)", r"\g<0>\\allowbreak{}", found)


def _items(lines: Sequence[str]) -> Iterator[str]:
    yield r"\begin{itemize}\setlength{\itemsep}{0pt}"
    yield from (rf"\item{{}} {escape(line)}" for line in lines)
    yield r"\end{itemize}"


def _quiet(text: str) -> str:
    """Return a text as one line."""
    return " ".join(text.split())
