"""Puts a Modelica model together from the equations of a graph."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import product
from typing import Any

from hybond.equations.parameters import parameter_values
from hybond.equations.symbolic.rational import Rational
from hybond.equations.symbolic.show import to_expr
from hybond.errors import HybondError, ModelError
from hybond.export.modelica.expressions import Pairs, inner, modelica, number
from hybond.export.modelica.identifiers import Identifiers, quoted, unit_text
from hybond.export.modelica.inputs import InputText, input_text
from hybond.export.modelica.live import Live
from hybond.export.modelica.rules import Transition, transitions
from hybond.export.modelica.solve import ONE, Form, without_impulses
from hybond.export.modelica.trees import Trees, check_count, unbracketed
from hybond.model.builder import Model
from hybond.model.expressions import (
    And,
    Binary,
    Bool,
    Compare,
    Expr,
    Name,
    Neg,
    Not,
    Number,
    Or,
    compile_expression,
    names,
    parse,
    simplify,
    substitute,
    transform,
    uses_pre,
)
from hybond.model.graph import FlatGraph, Mode
from hybond.simulation import simulate
from hybond.units import try_quantity

PATIENCE = 2
"""Event iterations in which laws, and after them rules, have their say before what follows: one
would do, but for tools that compare with the values of the iteration before."""
SLACK = 1e-8
"""Part of the terms of a value below which a law takes it for zero. A mode that ties stored
quantities together does so to the tolerance of the integration."""
TOLERANCE = 1e-10
NEAR = 1e-7
"""Part of the experiment within which impacts are close to each other."""
BURST = 40
"""Impacts close to each other that are taken for an accumulation."""
IMPULSE = 1e-7
"""Part of what a storage would hold of all energy, below which an impulse is rounding: the state
at an event is known to the tolerance of its location."""
IMPULSE_OF_DIODES = 1e-9
"""The same beside diodes, which turn on and off by what little the integration leaves."""
START = 1e-9
"""Part of the experiment that is run to see how the start settles."""


class ModelText:
    """One model on its way to text; declarations and equations come up as they are read."""

    def __init__(self, model: Model) -> None:
        self.model = model
        self.graph: FlatGraph = model.flatten()
        _refuse(self.graph)
        self.ids = Identifiers()
        self.form = Form(self.graph)
        seen = without_impulses(self.graph)
        self.sudden = self.form if seen is self.graph else Form(seen, self.form.eq.reference)
        self.values = parameter_values(self.graph)
        self.used: dict[str, None] = {f"p:{p}": None for p in self.graph.parameters}
        self.declared: list[str] = []
        self.equations: list[str] = []
        self.made: dict[str, str] = {}
        self._reserve()
        self.after = Trees(self.graph, self._state)
        self.before = Trees(self.graph, self._was)
        self.live = Live(model, self.graph)
        self.rules = [transitions(self.graph, m, self.live) for m in self.graph.machines]
        self.jumping = self._jumping()
        laws = any(m.law is not None for m in self.graph.machines)
        self.careful = bool(self.jumping) or laws or self._reads_pre()
        self.quiet = 1 + (PATIENCE if laws else 0)
        self.settled = self.quiet + PATIENCE
        self.pairs = Pairs(self._after, self._impulse, self.ids.of("small", "impulse_small"))
        self.inputs: dict[int, InputText] = {}

    # -- names

    def _reserve(self) -> None:
        """Give the names that people wrote to what they wrote them for."""
        graph = self.graph
        self.name = self.ids.of("model", graph.name)
        for path in graph.parameters:
            self.ids.of(f"p:{path}", path)
        for i in graph.inputs:
            self.ids.of(f"u:{i.index}", i.path)
        for s in graph.integrals:
            self.ids.of(f"s:{s.index}", s.path)
        for m in graph.machines:
            self.ids.of(f"m:{m.index}", m.path)
        for storage in graph.storages:
            self.ids.of(f"x:{storage.index}", storage.path)
        for path in graph.signals:
            self.ids.of(f"signal:{path}", path)
        for m in graph.machines:
            for k, state in enumerate(m.states):
                self.ids.of(f"in:{m.index}:{k}", f"{m.path}_{state}")

    def _machine(self, m: int) -> str:
        return self.ids.of(f"m:{m}", "")

    def _state(self, m: int, k: int) -> str:
        """Return the condition that a machine is in a state, in the mode that is tried."""
        key = f"in:{m}:{k}"
        name = self.ids.of(key, "")
        if key not in self.made:
            self.made[key] = name
            self.declared.append(f"Boolean {name};")
            self.equations.append(f"{name} = pre({self._machine(m)}) == {k + 1};")
        return name

    def _was(self, m: int, k: int) -> str:
        """Return the condition that a machine was in a state when the state was last written."""
        machine = self.graph.machines[m]
        name = self.ids.of(f"was:{m}", f"{machine.path}_was")
        if f"was:{m}" not in self.made:
            self.made[f"was:{m}"] = name
            start = self.start_mode[m] + 1
            self.declared.append(
                f"Integer {name}(start = {start}, fixed = true) "
                f"{quoted(f'{machine.path} when the state was last written')};"
            )
            calm = self._calm()
            self.equations.append(
                f"{name} = if {calm} == {self.settled} then {self._machine(m)} else pre({name});"
            )
        return f"pre({name}) == {k + 1}"

    def _calm(self) -> str:
        return self.ids.of("calm", "calm")

    def _resolve(self, path: str, prior: bool, *, old: bool = False) -> str:
        """Return the text of a canonical name; `old`: of what was stored before a jump."""
        kind, _, index = path.partition(":")
        graph = self.graph
        match kind:
            case "time":
                return "time"
            case "pi":
                return "3.141592653589793"
            case "p":
                self.used.setdefault(path)
                return self.ids.of(path, index)
            case "x":
                name = self.ids.of(path, "")
                return name if prior or old or int(index) not in self.jumping else self._new(path)
            case "s":
                return self.ids.of(path, "")
            case "u":
                if prior and self._input(int(index)).piece:
                    raise ModelError(
                        f"pre() of the input {graph.inputs[int(index)].path}, which jumps",
                        code="HB-E681",
                        hint="Modelica has no left limit of an input that is settled this way",
                    )
                self._input(int(index))
                return self.ids.of(path, "")
            case "du":
                self._input(int(index))
                return self.ids.of(path, f"{graph.inputs[int(index)].path}_slope")
            case "in":
                m, _, k = index.partition(":")
                found = self._was(int(m), int(k)) if prior else self._state(int(m), int(k))
                return f"({found})" if " " in found else found
            case "on":
                return self._on(int(index), prior)
            case "at":
                return f"({modelica(graph.watches[int(index)].compare, self._after)})"
            case "e" | "f":
                return self._signal(path, prior)
        return path

    def _on(self, node: int, prior: bool) -> str:
        state = self._was if prior else self._state
        conditions = [
            state(m.index, k)
            for m in self.graph.machines
            for k in range(len(m.states))
            if node in m.on[k]
        ]
        return f"({' or '.join(conditions) or 'false'})"

    def _after(self, path: str, prior: bool) -> str:
        return self._resolve(path, prior)

    def _before(self, path: str, prior: bool) -> str:
        return self._resolve(path, True)

    def _old(self, path: str, prior: bool) -> str:
        return self._resolve(path, prior, old=True)

    def _new(self, path: str) -> str:
        return self.ids.of(f"new:{path}", f"{self.ids.of(path, '')}_new")

    def _input(self, k: int) -> InputText:
        if k not in self.inputs:
            given = self.graph.inputs[k]
            name = self.ids.of(f"u:{k}", "")
            slope = self.ids.of(f"du:{k}", f"{given.path}_slope")
            self.inputs[k] = found = input_text(given, name, slope)
            unit = self._unit(given.dimension)
            self.declared.append(f"Real {name}{unit} {quoted(f'input {given.path}')};")
            self.declared += [f"Real {slope};", *found.declarations]
            self.equations += found.equations
        return self.inputs[k]

    def _unit(self, unit: Any) -> str:
        text = unit_text(unit)
        return f'(unit = "{text}")' if text else ""

    # -- rows

    def _expr(self, form: Form, row: dict[int, Any]) -> Expr:
        """Return a solved row as an expression in canonical names."""
        eq, terms = form.eq, []
        laws: dict[str, Expr] = {}
        for k, c in row.items():
            factor = c
            if k != ONE:
                kind, j = eq.place[k]
                atom = f"x:{j}" if kind == "state" else f"{kind}:{k}"
                factor = c * _atom(atom)
                if kind != "state":
                    laws[atom] = self._law(form, k, kind)
            term = to_expr(factor, meaning=form.ring.meaning, order=_order)
            term = substitute(term, laws)
            terms.append(term)
        return _total(terms)

    def _law(self, form: Form, k: int, kind: str) -> Expr:
        """Return a source or law as an expression; a long one gets a variable."""
        eq = form.eq
        own = eq.column(k)
        formula = eq.storage_law(own.index) if own.kind == "storage" else own.formula
        assert formula is not None
        if kind == "input":
            if isinstance(formula, Number | Name) or uses_pre(formula):
                return formula
            name = eq.source_name(k)
        else:
            name = eq.law_name(k)
        key = f"{kind}:{k}:{id(form)}" if form is not self.form else f"{kind}:{k}"
        ident = self.ids.of(key, name if kind == "law" else f"{name}_source")
        if key not in self.made:
            self.made[key] = ident
            self.declared.append(f"Real {ident} {quoted(name)};")
            self.equations.append(f"{ident} = {modelica(formula, self._after)};")
        return Name(f"={ident}")

    # -- signals

    def _signal(self, path: str, prior: bool) -> str:
        key = f"before:{path}" if prior else path
        wish = self.form.eq.display.name(path)
        name = self.ids.of(key, f"{wish}_before" if prior else wish)
        if key not in self.made:
            self.made[key] = name
            form, trees = self.form, self.before if prior else self.after
            resolve = _plainly(self._before if prior else self._after)

            def leaf(mode: Mode) -> str | None:
                row = form.signal(path, mode)
                return None if row is None else modelica(self._expr(form, row), resolve)

            row = form.eq.bond_row(path)
            text = trees.text(wish, sorted(form.row_machines(row)), leaf)
            if text is None:
                raise ModelError(
                    f"{wish} is open in every mode",
                    code="HB-E681",
                    where=self.graph.name,
                    hint="a node floats: connect it to something",
                )
            unit = self._unit(self.graph.dimensions.get(path))
            remark = f"{wish}, a priori" if prior else wish
            self.declared.append(f"Real {name}{unit} {quoted(remark)};")
            self.equations.append(f"{name} = {unbracketed(text)};")
        return name

    def _impulse(self, path: str) -> str | None:
        """Return the impulse of an effort or flow; None if it never has one."""
        if not path.startswith(("e:", "f:")) or not self.jumping:
            return None
        key = f"impulse:{path}"
        if key not in self.made:
            wish = self.form.eq.display.name(path)
            form = self.sudden

            def leaf(mode: Mode) -> str | None:
                row = form.impulse(path, mode)
                if row is None:
                    return "0"
                total = {k: c for k, c in row.items() if k in self.jumping}
                e = _total(
                    [
                        to_expr(c * _atom(f"jump:{k}"), meaning=form.ring.meaning, order=_order)
                        for k, c in total.items()
                    ]
                )
                return modelica(e, self._jump_names)

            machines = sorted(form.row_machines(form.eq.bond_row(path)))
            text = self.after.text(wish, machines, leaf)
            if text in (None, "0"):
                self.made[key] = ""
            else:
                name = self.made[key] = self.ids.of(key, f"{wish}_impulse")
                self.declared.append(f"Real {name} {quoted(f'impulse of {wish} at a jump')};")
                self.equations.append(f"{name} = {unbracketed(text or '0')};")
        return self.made[key] or None

    def _jump_names(self, path: str, prior: bool) -> str:
        if path.startswith("jump:"):
            x = f"x:{path[5:]}"
            return self.ids.of(path, f"{self.ids.of(x, '')}_jump")
        return self._old(path, prior)

    # -- what jumps

    def _jumping(self) -> frozenset[int]:
        """Return the stored quantities that some mode may set."""
        form = self.sudden
        if not any(form.constraint(row.at(mode, form.ring)) for row, mode in self._pieces()):
            return frozenset()
        check_count(self.graph, form.machines, "the state on entry of a mode")
        found: set[int] = set()
        for mode in self._modes(form.machines):
            solution = form.jumps(mode)
            if solution is not None:
                found |= {k for k in range(form.n) if solution.value(k)}
        for storage in sorted(found):
            path = f"x:{storage}"
            self._new(path)
        return frozenset(found)

    def _pieces(self) -> Iterator[tuple[Any, Mode]]:
        for row in self.sudden.eq.rows:
            machines = sorted({m for p in row.parts for m in p.space.machines})
            check_count(self.graph, machines, "the rate of a stored quantity")
            for mode in self._modes(machines):
                if not self.sudden.void(mode):
                    yield row, mode

    def _modes(self, machines: Any) -> Iterator[Mode]:
        start = list(self.graph.start_mode)
        for states in product(*(range(len(self.graph.machines[m].states)) for m in machines)):
            for m, k in zip(machines, states, strict=True):
                start[m] = k
            yield tuple(start)

    def _reads_pre(self) -> bool:
        graph = self.graph
        expressions = [t.guard for rules in self.rules for t in rules]
        expressions += [i.rate for i in graph.integrals] + list(graph.signals.values())
        expressions += [e for n in graph.nodes if n.law for e in n.law.expressions]
        return any(uses_pre(e) for e in expressions)

    # -- the text

    @property
    def start_mode(self) -> Mode:
        """The mode in which the start settles."""
        return self._start()[0]

    def _start(self) -> tuple[Mode, list[float]]:
        if not hasattr(self, "_settled_start"):
            until = _seconds(self.graph.experiment.get("until")) or 1.0
            run = simulate(self.graph, until=START * until, on_error="return")
            if not len(run.events):
                raise run.error or ModelError("the start does not settle", code="HB-E681")
            event = run.events[0]
            self._settled_start = (event.steps[-1].mode, [float(v) for v in event.after])
        return self._settled_start

    def text(self) -> str:
        """Return the model."""
        states = list(self._states())
        rates = [*self._rates(), *self._integrals()]
        self._outputs()
        machines = list(self._machines())
        jumps = list(self._jumps())
        parameters = list(self._parameters())
        title = f" {quoted(self.model.title)}" if self.model.title else ""
        lines = [f"model {self.name}{title}"]
        lines += [f"  {line}" for line in (*parameters, *states, *self.declared)]
        lines.append("equation")
        lines += [f"  {line}" for line in (*rates, *self.equations, *machines, *jumps)]
        lines += [f"  {line}" for line in self._gaps()]
        until = _seconds(self.graph.experiment.get("until"))
        if until:
            about = f"StopTime = {number(until)}, Tolerance = {number(TOLERANCE)}"
            lines.append(f"  annotation(experiment({about}));")
        lines.append(f"end {self.name};")
        return "\n".join(lines) + "\n"

    def _parameters(self) -> Iterator[str]:
        known = {**self.values, **{f"p:{p}": v for p, v in self.graph.parameters.items()}}
        for path in self.used:
            name, own = self.ids.of(path, path[2:]), path[2:]
            value = float(known[path])
            written = self.model.parameters.get(own, "")
            text, unit, remark = number(value), "", ""
            if isinstance(written, str) and written:
                quantity = try_quantity(written)
                if quantity is not None:
                    unit = self._unit(quantity.dimension)
                else:
                    text = self._formula(written, value) or text
                    remark = f" {quoted(written)}" if text == number(value) else ""
            elif own not in self.model.parameters:
                unit = self._unit(self._own_unit(own))
            kind = "parameter"
            if own in self.live.fixed:
                # its value has gone into numbers: a tool must not offer to change it
                kind, text = "constant", number(value)
                remark = remark or (f" {quoted(str(written))}" if unit == "" and written else "")
            yield f"{kind} Real {name}{unit} = {text}{remark};"
        if any(key.startswith("size:") for key in self.made):
            yield (
                f"parameter Real {self.ids.of('slack', 'law_slack')} = {number(SLACK)} "
                '"laws: this part of its terms counts as zero";'
            )

    def _own_unit(self, path: str) -> Any:
        """Return the unit of a number that an element has as its value."""
        element, _, _ = path.rpartition(".")
        part = self.model.elements.get(element)
        value = getattr(part, "value", None)
        quantity = try_quantity(value) if isinstance(value, str) else None
        return None if quantity is None else quantity.dimension

    def _formula(self, written: str, value: float) -> str | None:
        """Return a parameter as the formula of others that it is written as."""
        try:
            e = parse(written)
        except HybondError:
            return None
        read = names(e)
        if not read or any(n not in self.graph.parameters for n in read):
            return None
        index = {n: k for k, n in enumerate(sorted(read))}
        at = [float(self.graph.parameters[n]) for n in sorted(read)]
        if float(compile_expression(e, index, pre_offset=0)(at)) != value:
            return None
        return modelica(e, lambda n, prior: self.ids.of(f"p:{n}", n))

    def _states(self) -> Iterator[str]:
        mode, values = self._start()
        graph = self.graph
        for s in graph.storages:
            name = self.ids.of(f"x:{s.index}", "")
            domain = graph.nodes[s.node].domain
            per = domain.flow_unit if s.kind == "C" else domain.effort_unit
            unit = graph.dimensions.get(f"x:{s.index}")
            given = unit_text(unit)
            units = f', unit = "{given}"' if given and per else ""
            yield (
                f"Real {name}(start = {number(values[s.index])}, fixed = true{units}) "
                f"{quoted(s.path)};"
            )
        for i in graph.integrals:
            name = self.ids.of(f"s:{i.index}", "")
            given = unit_text(graph.dimensions.get(f"s:{i.index}"))
            units = f', unit = "{given}"' if given else ""
            start = number(values[len(graph.storages) + i.index])
            yield f"Real {name}(start = {start}, fixed = true{units}) {quoted(i.path)};"
        for m in graph.machines:
            known = ", ".join(f"{k + 1} {state}" for k, state in enumerate(m.states))
            start = str(mode[m.index] + 1)
            name = self._machine(m.index)
            yield f"Integer {name}(start = {start}, fixed = true) {quoted(known)};"

    def _rates(self) -> Iterator[str]:
        form = self.form
        for s in self.graph.storages:

            def leaf(mode: Mode, k: int = s.index) -> str | None:
                row = form.rate(k, mode)
                if row is None:
                    return None
                return modelica(self._expr(form, row), _plainly(self._after))

            own = form.eq.rows[s.index]
            machines = form.machines if not form.eq.explicit else sorted(form.row_machines(own))
            text = self.after.text(f"the rate of {s.path}", machines, leaf)
            if text is None:
                raise _cannot(f"the rate of {s.path}, which no mode determines", s.path, "")
            yield f"der({self.ids.of(f'x:{s.index}', '')}) = {unbracketed(text)};"

    def _integrals(self) -> Iterator[str]:
        for i in self.graph.integrals:
            rate = modelica(self.live.signal(i.path, i.rate), self._after)
            yield f"der({self.ids.of(f's:{i.index}', '')}) = {rate};"

    def _outputs(self) -> None:
        """Declare the named signals, and those that the experiment plots."""
        graph = self.graph
        wanted = dict(graph.signals)
        for name in (*graph.experiment.get("plot", ()), *graph.experiment.get("outputs", ())):
            if name not in wanted and graph.read is not None:
                e = graph.read(name)
                if isinstance(e, Name):
                    self._after(e.path, False)
                else:
                    wanted[name] = e
        for path, e in wanted.items():
            if isinstance(e, Name) and e.path.startswith("s:"):
                continue
            name = self.ids.of(f"signal:{path}", path)
            text = modelica(self.live.signal(path, e), self._after)
            logical = isinstance(e, Compare | And | Or | Not | Bool)
            unit = "" if logical else self._unit(graph.dimensions.get(path))
            self.declared.append(f"{'Boolean' if logical else 'Real'} {name}{unit} {quoted(path)};")
            self.equations.append(f"{name} = {text};")

    # -- events

    def _machines(self) -> Iterator[str]:
        """Yield one equation per machine: levels, of which the first in the list counts."""
        turning: list[str] = []
        calm = self._calm()
        for machine in self.graph.machines:
            name, rules = self._machine(machine.index), self.rules[machine.index]
            if not rules:
                yield f"{name} = pre({name});"
                continue
            fires = [(self._fires(t), t) for t in rules]
            parts = []
            if machine.law is not None:
                turns = self.ids.of(f"turns:{machine.index}", f"{machine.path}_turns")
                either = " or ".join(f"({condition})" for condition, _ in fires)
                earlier = f" and not ({' or '.join(turning)})" if turning else ""
                self.declared.append(f"Boolean {turns};")
                yield f"{turns} = pre({calm}) >= 1{earlier} and ({either});"
                turning.append(turns)
                parts.append(f"if not {turns} then pre({name})")
            elif self.careful:
                parts.append(f"if pre({calm}) < {self.quiet} then pre({name})")
            for condition, t in fires:
                parts.append(f"if {condition} then {t.target + 1}")
            yield f"{name} = {' else'.join(parts)} else pre({name});"

    def _fires(self, t: Transition) -> str:
        state = self._state(t.machine, t.source)
        if simplify(t.guard) == Bool(True):
            return state
        law = self.graph.machines[t.machine].law
        slack = None if law is None else self._slack
        return f"{state} and ({self.pairs.condition(t.guard, slack)})"

    def _slack(self, e: Expr) -> str:
        """Return what a value of a law must pass to be told from zero."""
        read = sorted(n for n in names(e) if n.startswith(("e:", "f:")))
        if not read:
            return ""
        return f"{self.ids.of('slack', 'law_slack')}*({' + '.join(map(self._size, read))})"

    def _size(self, path: str) -> str:
        """Return how large the terms are that an effort or flow is the sum of."""
        key = f"size:{path}"
        wish = self.form.eq.display.name(path)
        name = self.ids.of(key, f"{wish}_size")
        if key not in self.made:
            self.made[key] = name
            form = self.form

            def leaf(mode: Mode) -> str | None:
                row = form.signal(path, mode)
                if row is None:
                    return None
                terms = [
                    inner(self._expr(form, {k: c}), _plainly(self._after)) for k, c in row.items()
                ]
                return f"sqrt({' + '.join(f'{x}^2' for x in terms)})" if terms else "0"

            text = self.after.text(wish, sorted(form.row_machines(form.eq.bond_row(path))), leaf)
            self.declared.append(f"Real {name} {quoted(f'size of the terms of {wish}')};")
            self.equations.append(f"{name} = {unbracketed(text or '0')};")
        return name

    def _jumps(self) -> Iterator[str]:
        if not self.careful:
            return
        calm, changed = self._calm(), self.ids.of("changed", "changed")
        self.declared += [
            f"Integer {calm}(start = {self.settled}, fixed = true) "
            '"event iterations since something changed";',
            f"Boolean {changed};",
        ]
        marks = [self._machine(m.index) for m in self.graph.machines]
        marks += [i.piece for i in self.inputs.values() if i.piece]
        either = " or ".join(f"{m} <> pre({m})" for m in marks) or "false"
        yield f"{changed} = {either};"
        yield f"{calm} = if {changed} then 0 else min(pre({calm}) + 1, {self.settled});"
        if not self.jumping:
            return
        form, small = self.sudden, self.ids.of("small", "impulse_small")
        self.declared.append(f'Real {small} "impulses below this are rounding";')
        yield f"{small} = 1e-30 + {self._smallest_impulse()};"
        written = self._written()
        for k in sorted(self.jumping):

            def leaf(mode: Mode, k: int = k) -> str | None:
                row = form.jump(k, mode)
                if row is None:
                    return "0"
                return modelica(self._expr(form, row), _plainly(self._old))

            path = self.graph.storages[k].path
            x = self.ids.of(f"x:{k}", "")
            new, jump = self._new(f"x:{k}"), self.ids.of(f"jump:{k}", f"{x}_jump")
            text = self.after.text(f"the jump of {path}", form.machines, leaf)
            self.declared += [
                f"Real {jump} {quoted(f'what the mode adds to {path} on entry')};",
                f"Real {new} {quoted(f'{path} in the mode that is tried')};",
            ]
            plain = unbracketed(text or "0")
            yield f"{jump} = {f'if {written} then 0 else {text}' if written else plain};"
            yield f"{new} = {x} + {jump};"
        impacts = any(any(m.fieldless) for m in self.graph.machines)
        if impacts:
            yield from self._accumulation()
        yield f"when {calm} == {self.settled} then"
        if impacts:
            last, burst = self.ids.of("last", "last_write"), self.ids.of("burst", "writes_in_burst")
            near = f"time - pre({last}) < {self._near()}"
            yield f"  {burst} = if {near} then pre({burst}) + 1 else 0;"
            yield f"  {last} = time;"
        for k in sorted(self.jumping):
            yield f"  reinit({self.ids.of(f'x:{k}', '')}, {self._new(f'x:{k}')});"
        for i in self.graph.integrals:
            impulse = self.pairs.pair(i.rate)[1]
            if impulse is not None:
                name = self.ids.of(f"s:{i.index}", "")
                yield f"  reinit({name}, {name} + {impulse});"
        yield "end when;"

    def _near(self) -> str:
        """Return the time within which impacts follow each other that accumulate."""
        until = _seconds(self.graph.experiment.get("until")) or 1.0
        return number(float(f"{NEAR * until:.3g}"))

    def _accumulation(self) -> Iterator[str]:
        """Yield the end of runs in which impacts accumulate: Modelica has no rest after them."""
        last, burst = self.ids.of("last", "last_write"), self.ids.of("burst", "writes_in_burst")
        self.declared += [
            f'discrete Real {last}(start = -1, fixed = true, unit = "s") '
            '"when an impact was last written";',
            f'Integer {burst}(start = 0, fixed = true) "impacts close to each other";',
        ]
        yield f'assert({burst} < {BURST}, "impacts accumulate here, and have no end in Modelica");'
        for m in self.graph.machines:
            for k, fieldless in enumerate(m.fieldless):
                if fieldless:
                    stays = f"{self._state(m.index, k)} and pre({self._calm()}) == {self.settled}"
                    said = f"{m.path} stays in {m.states[k]}, which holds at an instant only"
                    yield f"assert(not ({stays} and time > {last}), {quoted(said)});"

    def _written(self) -> str:
        """Return the condition that what a mode sets has been written, and is not set again.

        An impact must not act twice. A constraint may: then what rules read keeps to it to the last
        digit, whatever the integration leaves. Diodes must not see that, since what they block
        would be compared with what they held.
        """
        if any(m.law is not None for m in self.graph.machines):
            return f"pre({self._calm()}) == {self.settled}"
        at_once = [
            self._state(m.index, k)
            for m in self.graph.machines
            for k, fieldless in enumerate(m.fieldless)
            if fieldless
        ]
        if not at_once:
            return ""
        return f"pre({self._calm()}) == {self.settled} and ({' or '.join(at_once)})"

    def _smallest_impulse(self) -> str:
        """Return a small part of what the least storage that jumps would hold of the energy."""
        terms, least = [], float("inf")
        for s in self.graph.storages:
            law = self.graph.nodes[s.node].law
            if law is None or law.matrix is None:
                continue
            stiff = abs(law.matrix[s.port][s.port])
            terms.append(f"{number(float(f'{stiff:.3g}'))}*{self.ids.of(f'x:{s.index}', '')}^2")
            if s.index in self.jumping:
                least = min(least, 1.0 / stiff)
        if not terms or least == float("inf"):
            return "0"
        kinds = {m.law.kind for m in self.graph.machines if m.law is not None}
        part = IMPULSE_OF_DIODES if kinds & {"diode", "thyristor"} else IMPULSE
        return f"{number(float(f'{part * least**0.5:.3g}'))}*sqrt({' + '.join(terms)})"

    def _gaps(self) -> Iterator[str]:
        """Yield assertions for modes without equations."""
        for path, name in sorted(self.after.gaps.items()):
            states = [self.graph.machines[m].states[k] for m, k in path]
            said = ", ".join(
                f"{self.graph.machines[m].path} = {s}" for (m, _), s in zip(path, states)
            )
            if all(self.start_mode[m] == k for m, k in path):
                raise ModelError(
                    f"{name} has no one value in the mode of the start",
                    code="HB-E681",
                    where=said or self.graph.name,
                    hint="something floats there, and Modelica would have to guess: a small "
                    "resistance in series with the switches, or a large one beside them",
                )
            condition = " and ".join(self._state(m, k) for m, k in path)
            yield f"assert(not ({condition}), {quoted(f'{name} is not determined: {said}')});"


def _cannot(what: str, where: str, hint: str) -> ModelError:
    return ModelError(f"Modelica has no words for {what}", code="HB-E680", where=where, hint=hint)


def _refuse(graph: FlatGraph) -> None:
    """Refuse what Modelica has no words for, before anything is derived."""
    for s in graph.samples:
        raise _cannot(
            "what is sampled at instants, here" if s.block is None else "code from elsewhere",
            s.path,
            "a sampled signal reads values before the instant; export C, Java or an FMU",
        )
    laws = [m for m in graph.machines if m.law is not None]
    hint = "export C or an FMU"
    for machine in laws:
        law = machine.law
        assert law is not None
        if law.planar or law.second is not None:
            raise _cannot("friction in two directions", machine.path, hint)
        if law.impulsive:
            raise _cannot("friction that carries impulses", machine.path, hint)
    for node in graph.nodes:
        if node.impulsive and graph.machines:
            raise _cannot("a resistor that carries impulses", node.path, hint)


def _plainly(resolve: Callable[[str, bool], str]) -> Callable[[str, bool], str]:
    """Let names that are Modelica already pass."""
    return lambda path, prior: path[1:] if path.startswith("=") else resolve(path, prior)


def _atom(name: str) -> Any:
    return Rational.atom(name)


def _order(atom: str) -> tuple[int, str]:
    return (0 if atom.startswith("p:") else 1, atom)


def _total(terms: list[Expr]) -> Expr:
    total: Expr | None = None
    for given in terms:
        term = transform(given, _sign_first)
        if term == Number(0.0):
            continue
        if total is None:
            total = term
        elif isinstance(term, Neg):
            total = Binary("-", total, term.arg)
        else:
            total = Binary("+", total, term)
    return Number(0.0) if total is None else total


def _sign_first(e: Expr) -> Expr:
    """Return a product with its sign in front: ``-(a*b)`` rather than ``(-a)*b``."""
    match e:
        case Number(value=value) if value < 0.0:
            return Neg(Number(-value, e.dimension))
        case Binary(op=("*" | "/") as op, left=Neg(arg=left), right=Neg(arg=right)):
            return Binary(op, left, right)
        case Binary(op=("*" | "/") as op, left=Neg(arg=left)):
            return Neg(Binary(op, left, e.right))
        case Binary(op=("*" | "/") as op, right=Neg(arg=right)):
            return Neg(Binary(op, e.left, right))
        case Binary(op="+", right=Neg(arg=right)):
            return Binary("-", e.left, right)
        case Binary(op="-", right=Neg(arg=right)):
            return Binary("+", e.left, right)
        case Neg(arg=Neg(arg=inside)):
            return inside
    return e


def _seconds(value: Any) -> float | None:
    if isinstance(value, str):
        quantity = try_quantity(value)
        return None if quantity is None else float(quantity.value)
    return float(value) if isinstance(value, int | float) else None
