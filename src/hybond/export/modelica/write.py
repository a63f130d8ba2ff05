"""One flat model: its states, their rates, its outputs and events, in the order of the text."""

from __future__ import annotations

from collections.abc import Iterator

from hybond.errors import ModelError
from hybond.export.modelica.draft import Draft
from hybond.export.modelica.expressions import modelica, number
from hybond.export.modelica.identifiers import in_unit, quoted, unit_text
from hybond.export.modelica.jumps import jump_equations
from hybond.export.modelica.levels import machine_equations
from hybond.export.modelica.parameters import parameters
from hybond.export.modelica.refusals import no_words
from hybond.export.modelica.start import until_of
from hybond.export.modelica.trees import unbracketed
from hybond.export.modelica.variables import Variables
from hybond.model.builder import Model
from hybond.model.expressions import And, Bool, Compare, Name, Not, Or
from hybond.model.graph import Mode

TOLERANCE = 1e-10
"""The tolerance that the text asks of a tool."""


def to_modelica(model: Model) -> str:
    """Return a model as the text of one flat hybrid Modelica model.

    Stored quantities and integrated signals are its states, machines its Integers. Rules are
    equations of levels, settled by event iteration as hybond settles them; what a mode does to
    the state on entry is a formula, and `reinit` writes it when nothing fires any more. Nothing is
    needed beyond the language, 3.2 or later.

    Raises
    ------
    ModelError
        HB-E680 for what Modelica has no words for, HB-E681 for what it would get wrong,
        HB-E683 for operations on impulses without meaning, HB-E684 for too many combinations.
    EquationError
        HB-E682 for a mode that fixes what is stored by a nonlinear law.

    Examples
    --------
    >>> from hybond.model.constructors import C, I, One
    >>> m = Model("oscillator", domain="translational", parameters={"k": "100 N/m"})
    >>> m.add(mass=I("1 kg", f="1 m/s"), spring=C("1/k"), v=One())
    >>> m.bond("v -> mass", "v -> spring")
    >>> print(to_modelica(m), end="")
    model oscillator
      parameter Real k(unit = "N/m") = 100;
      parameter Real mass_I(unit = "kg") = 1;
      Real mass_p(start = 1, fixed = true, unit = "N.s") "mass.p";
      Real spring_q(start = 0, fixed = true, unit = "m") "spring.q";
    equation
      der(mass_p) = -k*spring_q;
      der(spring_q) = mass_p/mass_I;
    end oscillator;
    """
    draft = Draft(model)
    variables = Variables(draft)
    states = list(_states(draft))
    rates = [*_rates(variables), *_integrals(variables)]
    _outputs(variables)
    machines = list(machine_equations(variables))
    jumps = list(jump_equations(variables))
    gaps = list(_gaps(variables))
    # what has been read by now is all that there is to declare
    declared = [*parameters(draft), *states, *draft.declared]
    said = [*rates, *draft.equations, *machines, *jumps, *gaps]
    title = f" {quoted(model.title)}" if model.title else ""
    lines = [f"model {draft.name}{title}"]
    lines += [f"  {line}" for line in declared]
    lines.append("equation")
    lines += [f"  {line}" for line in said]
    until = until_of(draft.graph)
    if until:
        about = f"StopTime = {number(until)}, Tolerance = {number(TOLERANCE)}"
        lines.append(f"  annotation(experiment({about}));")
    lines.append(f"end {draft.name};")
    return "\n".join(lines) + "\n"


def _states(draft: Draft) -> Iterator[str]:
    """Yield the declarations of what is stored and integrated, and of machines."""
    graph, start = draft.graph, draft.start
    for s in graph.storages:
        domain = graph.bonds[s.bond].domain
        per = domain.flow_unit if s.kind == "C" else domain.effort_unit
        given = unit_text(graph.dimensions.get(f"x:{s.index}"))
        unit = f', unit = "{given}"' if given and per else ""
        value = number(start.values[s.index])
        yield f"Real {draft.stored(s.index)}(start = {value}, fixed = true{unit}) {quoted(s.path)};"
    for i in graph.integrals:
        name = draft.integral(i.index)
        given = unit_text(graph.dimensions.get(f"s:{i.index}"))
        unit = f', unit = "{given}"' if given else ""
        value = number(start.values[len(graph.storages) + i.index])
        yield f"Real {name}(start = {value}, fixed = true{unit}) {quoted(i.path)};"
    for m in graph.machines:
        known = ", ".join(f"{k + 1} {state}" for k, state in enumerate(m.states))
        state = start.mode[m.index] + 1
        yield f"Integer {draft.machine(m.index)}(start = {state}, fixed = true) {quoted(known)};"


def _rates(variables: Variables) -> Iterator[str]:
    """Yield the rates of what is stored."""
    draft, form = variables.draft, variables.draft.form
    for s in draft.graph.storages:

        def leaf(mode: Mode, k: int = s.index) -> str | None:
            row = form.rate(k, mode)
            return None if row is None else variables.row(form, row, variables.after)

        own = form.eq.rows[s.index]
        machines = form.machines if not form.eq.explicit else sorted(form.row_machines(own))
        text = variables.modes.text(f"the rate of {s.path}", machines, leaf)
        if text is None:
            raise no_words(f"the rate of {s.path}, which no mode determines", s.path, "")
        yield f"der({draft.stored(s.index)}) = {unbracketed(text)};"


def _integrals(variables: Variables) -> Iterator[str]:
    """Yield the rates of integrated signals."""
    draft = variables.draft
    for i in draft.graph.integrals:
        rate = modelica(draft.live.signal(i.path, i.rate), variables.after)
        yield f"der({draft.integral(i.index)}) = {rate};"


def _outputs(variables: Variables) -> None:
    """Declare the named signals, and those that the experiment plots."""
    draft, graph = variables.draft, variables.graph
    wanted = dict(graph.signals)
    for name in (*graph.experiment.get("plot", ()), *graph.experiment.get("outputs", ())):
        if name not in wanted and graph.read is not None:
            e = graph.read(name)
            if isinstance(e, Name):
                variables.after(e.path, False)
            else:
                wanted[name] = e
    for path, e in wanted.items():
        if isinstance(e, Name) and e.path.startswith("s:"):
            continue
        name = draft.ids.of(f"signal:{path}", path)
        text = modelica(draft.live.signal(path, e), variables.after)
        logical = isinstance(e, Compare | And | Or | Not | Bool)
        unit = "" if logical else in_unit(graph.dimensions.get(path))
        draft.declared.append(f"{'Boolean' if logical else 'Real'} {name}{unit} {quoted(path)};")
        draft.equations.append(f"{name} = {text};")


def _gaps(variables: Variables) -> Iterator[str]:
    """Yield assertions for modes without equations."""
    draft, machines = variables.draft, variables.graph.machines
    for path, name in sorted(variables.modes.gaps.items()):
        said = ", ".join(f"{machines[m].path} = {machines[m].states[k]}" for m, k in path)
        if all(draft.start.mode[m] == k for m, k in path):
            raise ModelError(
                f"{name} has no one value in the mode of the start",
                code="HB-E681",
                where=said or draft.graph.name,
                hint="something floats there, and Modelica would have to guess: a small "
                "resistance in series with the switches, or a large one beside them",
            )
        condition = " and ".join(variables.state(m, k) for m, k in path)
        yield f"assert(not ({condition}), {quoted(f'{name} is not determined: {said}')});"
