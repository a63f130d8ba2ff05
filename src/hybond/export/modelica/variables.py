"""The names of expressions as variables of Modelica, declared when they are first read."""

from __future__ import annotations

from typing import Any

from hybond.errors import ModelError
from hybond.export.modelica.draft import Draft
from hybond.export.modelica.expressions import Resolve, inner, modelica
from hybond.export.modelica.identifiers import in_unit, quoted
from hybond.export.modelica.inputs import InputText, input_text
from hybond.export.modelica.pairs import Pairs
from hybond.export.modelica.solve import ONE, Form
from hybond.export.modelica.terms import term, total
from hybond.export.modelica.trees import Trees, unbracketed
from hybond.model.expressions import Expr, Name, Number, substitute, uses_pre
from hybond.model.graph import Mode


class Variables:
    """What canonical names are in the text of a draft, which grows as they are asked for.

    Attributes
    ----------
    modes : Trees
        Choices by the mode that is tried.
    pairs : Pairs
        Guards, impulses first.
    inputs : dict of int to InputText
        Those that have been read.
    """

    def __init__(self, draft: Draft) -> None:
        self.draft = draft
        self.graph = draft.graph
        self.modes = Trees(self.graph, self.state)
        self._modes_before = Trees(self.graph, self._was)
        self.pairs = Pairs(self.after, self.impulse, draft.small)
        self.inputs: dict[int, InputText] = {}

    # -- what a name is

    def after(self, path: str, prior: bool) -> str:
        """Return what a name is at an instant; ``pre()`` of it if `prior`."""
        return self._resolve(path, prior)

    def before(self, path: str, prior: bool) -> str:
        """Return what a name was before what the instant writes."""
        return self._resolve(path, True)

    def stored(self, path: str, prior: bool) -> str:
        """Return what a name is, of what is stored the value before a jump."""
        return self._resolve(path, prior, stored=True)

    def _jumps(self, path: str, prior: bool) -> str:
        if path.startswith("jump:"):
            return self.draft.jump(int(path[5:]))
        return self.stored(path, prior)

    def _resolve(self, path: str, prior: bool, *, stored: bool = False) -> str:
        kind, _, index = path.partition(":")
        draft, graph = self.draft, self.graph
        match kind:
            case "time":
                return "time"
            case "pi":
                return "3.141592653589793"
            case "p":
                draft.used.setdefault(path)
                return draft.ids.of(path, index)
            case "x":
                k = int(index)
                plain = prior or stored or k not in draft.jumping
                return draft.stored(k) if plain else draft.new(k)
            case "s":
                return draft.integral(int(index))
            case "u":
                if prior and self._input(int(index)).piece:
                    raise ModelError(
                        f"pre() of the input {graph.inputs[int(index)].path}, which jumps",
                        code="HB-E681",
                        where="the Modelica text",
                        hint="Modelica has no left limit of an input that is settled this way",
                    )
                self._input(int(index))
                return draft.ids.of(path, "")
            case "du":
                self._input(int(index))
                return draft.ids.of(path, f"{graph.inputs[int(index)].path}_slope")
            case "in":
                m, _, state = index.partition(":")
                found = (self._was if prior else self.state)(int(m), int(state))
                return f"({found})" if " " in found else found
            case "on":
                return self._on(int(index), prior)
            case "at":
                return f"({modelica(graph.watches[int(index)].compare, self.after)})"
            case "e" | "f":
                return self._signal(path, prior)
        return path

    # -- modes

    def state(self, m: int, k: int) -> str:
        """Return the condition that a machine is in a state, in the mode that is tried."""
        draft, key = self.draft, f"in:{m}:{k}"
        name = draft.ids.of(key, "")
        if key not in draft.made:
            draft.made[key] = name
            draft.declared.append(f"Boolean {name};")
            draft.equations.append(f"{name} = pre({draft.machine(m)}) == {k + 1};")
        return name

    def _was(self, m: int, k: int) -> str:
        """Return the condition that a machine was in a state when the state was last written."""
        draft, key = self.draft, f"was:{m}"
        machine = self.graph.machines[m]
        name = draft.ids.of(key, f"{machine.path}_was")
        if key not in draft.made:
            draft.made[key] = name
            draft.declared.append(
                f"Integer {name}(start = {draft.start.mode[m] + 1}, fixed = true) "
                f"{quoted(f'{machine.path} when the state was last written')};"
            )
            draft.equations.append(
                f"{name} = if {draft.calm} == {draft.settled} then {draft.machine(m)} "
                f"else pre({name});"
            )
        return f"pre({name}) == {k + 1}"

    def _on(self, node: int, prior: bool) -> str:
        state = self._was if prior else self.state
        conditions = [
            state(m.index, k)
            for m in self.graph.machines
            for k in range(len(m.states))
            if node in m.on[k]
        ]
        return f"({' or '.join(conditions) or 'false'})"

    # -- inputs and laws

    def _input(self, k: int) -> InputText:
        if k not in self.inputs:
            draft, given = self.draft, self.graph.inputs[k]
            name = draft.ids.of(f"u:{k}", "")
            slope = draft.ids.of(f"du:{k}", f"{given.path}_slope")
            self.inputs[k] = found = input_text(given, name, slope)
            unit = in_unit(given.dimension)
            draft.declared.append(f"Real {name}{unit} {quoted(f'input {given.path}')};")
            draft.declared += [f"Real {slope};", *found.declarations]
            draft.equations += found.equations
        return self.inputs[k]

    def _law(self, form: Form, k: int, kind: str) -> Expr:
        """Return a source or law as an expression; a long one gets a variable."""
        draft, eq = self.draft, form.eq
        own = eq.column(k)
        formula = eq.storage_law(own.index) if own.kind == "storage" else own.formula
        assert formula is not None
        if kind == "input":
            if isinstance(formula, Number | Name) or uses_pre(formula):
                return formula
            name = eq.source_name(k)
        else:
            name = eq.law_name(k)
        key = f"{kind}:{k}:{id(form)}" if form is not draft.form else f"{kind}:{k}"
        ident = draft.ids.of(key, name if kind == "law" else f"{name}_source")
        if key not in draft.made:
            draft.made[key] = ident
            draft.declared.append(f"Real {ident} {quoted(name)};")
            draft.equations.append(f"{ident} = {modelica(formula, self.after)};")
        return Name(f"={ident}")

    # -- rows

    def row(self, form: Form, row: dict[int, Any], resolve: Resolve) -> str:
        """Return a solved row as text."""
        return modelica(self._expression(form, row), _plainly(resolve))

    def _expression(self, form: Form, row: dict[int, Any]) -> Expr:
        """Return a solved row as an expression in canonical names, those of laws put in."""
        terms = []
        laws: dict[str, Expr] = {}
        for k, c in row.items():
            name = ""
            if k != ONE:
                kind, j = form.eq.place[k]
                name = f"x:{j}" if kind == "state" else f"{kind}:{k}"
                if kind != "state":
                    laws[name] = self._law(form, k, kind)
            terms.append(substitute(term(form, c, name), laws))
        return total(terms)

    # -- efforts and flows

    def _signal(self, path: str, prior: bool) -> str:
        draft, form = self.draft, self.draft.form
        key = f"before:{path}" if prior else path
        wish = form.eq.display.name(path)
        name = draft.ids.of(key, f"{wish}_before" if prior else wish)
        if key not in draft.made:
            draft.made[key] = name
            modes = self._modes_before if prior else self.modes
            resolve = self.before if prior else self.after

            def leaf(mode: Mode) -> str | None:
                row = form.signal(path, mode)
                return None if row is None else self.row(form, row, resolve)

            text = modes.text(wish, sorted(form.row_machines(form.eq.bond_row(path))), leaf)
            if text is None:
                raise ModelError(
                    f"{wish} is open in every mode",
                    code="HB-E681",
                    where=self.graph.name,
                    hint="a node floats: connect it to something",
                )
            unit = in_unit(self.graph.dimensions.get(path))
            remark = f"{wish}, a priori" if prior else wish
            draft.declared.append(f"Real {name}{unit} {quoted(remark)};")
            draft.equations.append(f"{name} = {unbracketed(text)};")
        return name

    def impulse(self, path: str) -> str | None:
        """Return the impulse of an effort or flow; None if it never has one."""
        draft, form = self.draft, self.draft.sudden
        if not path.startswith(("e:", "f:")) or not draft.jumping:
            return None
        key = f"impulse:{path}"
        if key not in draft.made:
            wish = draft.form.eq.display.name(path)

            def leaf(mode: Mode) -> str | None:
                row = form.impulse(path, mode)
                if row is None:
                    return "0"
                terms = [term(form, c, f"jump:{k}") for k, c in row.items() if k in draft.jumping]
                return modelica(total(terms), self._jumps)

            machines = sorted(form.row_machines(form.eq.bond_row(path)))
            text = self.modes.text(wish, machines, leaf)
            if text in (None, "0"):
                draft.made[key] = ""
            else:
                name = draft.made[key] = draft.ids.of(key, f"{wish}_impulse")
                draft.declared.append(f"Real {name} {quoted(f'impulse of {wish} at a jump')};")
                draft.equations.append(f"{name} = {unbracketed(text or '0')};")
        return draft.made[key] or None

    def size(self, path: str) -> str:
        """Return how large the terms are that an effort or flow is the sum of."""
        draft, form = self.draft, self.draft.form
        key = f"size:{path}"
        wish = form.eq.display.name(path)
        name = draft.ids.of(key, f"{wish}_size")
        if key not in draft.made:
            draft.made[key] = name

            def leaf(mode: Mode) -> str | None:
                row = form.signal(path, mode)
                if row is None:
                    return None
                terms = [
                    inner(self._expression(form, {k: c}), _plainly(self.after))
                    for k, c in row.items()
                ]
                return f"sqrt({' + '.join(f'{x}^2' for x in terms)})" if terms else "0"

            machines = sorted(form.row_machines(form.eq.bond_row(path)))
            text = self.modes.text(wish, machines, leaf)
            draft.declared.append(f"Real {name} {quoted(f'size of the terms of {wish}')};")
            draft.equations.append(f"{name} = {unbracketed(text or '0')};")
        return name


def _plainly(resolve: Resolve) -> Resolve:
    """Let names that are Modelica already pass."""
    return lambda path, prior: path[1:] if path.startswith("=") else resolve(path, prior)
