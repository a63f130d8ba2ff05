"""A model as a Python script that builds it again and runs it."""

from __future__ import annotations

import keyword
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from hybond.errors import ModelError
from hybond.files.encode import to_data
from hybond.model.builder import Model
from hybond.model.parts import BlockPart, InputPart, Integral, Part, Sampled, SubmodelPart

WIDTH = 100
"""Columns of a line."""


def to_python(model: Model) -> str:
    """Return a script that builds a model with the same names and texts, and runs it.

    The function ``model()`` of the script returns the model; ``submodel_...()`` functions return
    its submodels, those from files too, so that the script stands alone. Run as a program it
    simulates the experiment and prints the events.

    Raises
    ------
    ModelError
        HB-E670 if the model holds what no text can: a Python function, an object.

    Examples
    --------
    >>> from hybond.model.constructors import C, I, One
    >>> m = Model("oscillator", domain="translational", parameters={"k": "100 N/m"})
    >>> m.add(mass=I("1 kg", f="1 m/s"), spring=C("1/k"), v=One())
    >>> m.bond("v -> mass", "v -> spring")
    >>> print(to_python(m), end="")
    import hybond as hb
    <BLANKLINE>
    <BLANKLINE>
    def model() -> hb.Model:
        m = hb.Model("oscillator", domain="translational", parameters={"k": "100 N/m"})
        m.add(
            mass=hb.I("1 kg", f="1 m/s"),
            spring=hb.C("1/k"),
            v=hb.One(),
        )
        m.bond("v -> mass", "v -> spring")
        return m
    <BLANKLINE>
    <BLANKLINE>
    if __name__ == "__main__":
        run = hb.simulate(model(), until=1.0)
        print(run.events)
    """
    _check(model)
    writer = _Writer()
    writer.function(model, "model")
    lines = ["import hybond as hb"]
    if model.title or model.about:
        lines = [*_docstring(model), "", *lines]
    for block in writer.functions:
        lines += ["", "", *block]
    until = "" if "until" in model.experiment else ", until=1.0"
    lines += ["", "", 'if __name__ == "__main__":', f"    run = hb.simulate(model(){until})"]
    lines += ["    print(run.events)"]
    return "\n".join(lines) + "\n"


def _check(model: Model) -> None:
    """Refuse what no text can carry, before a line is written."""
    try:
        to_data(model, inline=True)
    except ModelError as error:
        raise ModelError(
            error.why.replace("a model file", "a script"),
            code="HB-E670",
            where=error.where,
            hint=error.hint,
        ) from None


def _docstring(model: Model) -> list[str]:
    """Return the title and the long text as the script's docstring."""
    lines = (model.title or model.name).splitlines()
    if model.about:
        lines += ["", *model.about.strip().splitlines()]
    text = "\n".join(line.rstrip() for line in lines)
    text = text.replace("\\", "\\\\").replace('"""', '\\"\\"\\"')
    if text.endswith('"'):
        text = f'{text[:-1]}\\"'
    body = text.split("\n")
    return [f'"""{text}"""'] if len(body) == 1 else [f'"""{body[0]}', *body[1:], '"""']


class _Writer:
    """The functions of a script, submodels before what contains them."""

    def __init__(self) -> None:
        self.functions: list[list[str]] = []
        self.made: dict[int, str] = {}
        self.taken: set[str] = {"model"}

    def function(self, model: Model, name: str) -> None:
        """Write the function that returns a model."""
        body = [*self.body(model)]
        self.functions.append([f"def {name}() -> hb.Model:", *(f"    {line}" for line in body)])

    def submodel(self, model: Model, key: str) -> str:
        """Return the name of the function that makes a submodel; write it once."""
        if id(model) not in self.made:
            stem = key.rpartition("/")[2].partition(".")[0]
            stem = "".join(c if c.isascii() and c.isalnum() else "_" for c in stem)
            name, number = f"submodel_{stem}", 1
            while name in self.taken:
                number += 1
                name = f"submodel_{stem}_{number}"
            self.taken.add(name)
            self.made[id(model)] = name
            self.function(model, name)
        return self.made[id(model)]

    def body(self, model: Model) -> Iterator[str]:
        given: dict[str, str] = {}
        if model.title:
            given["title"] = literal(model.title)
        if model.domain != "generic":
            given["domain"] = literal(model.domain)
        if model.parameters:
            given["parameters"] = literal(model.parameters)
        yield from call("m = hb.Model", [literal(model.name)], given)
        if model.about:
            yield from assigned("m.about", model.about)
        if model.indeterminate != "error":
            yield from assigned("m.indeterminate", model.indeterminate)
        for key, inner in model.models.items():
            yield f"m.models[{literal(key)}] = {self.submodel(inner, key)}()"
        shared: dict[int, str] = {}
        for name, part in model.elements.items():
            if isinstance(part, SubmodelPart) and isinstance(part.model, Model):
                known = next((k for k, m in model.models.items() if m is part.model), None)
                if known is None and id(part.model) not in shared:
                    shared[id(part.model)] = f"shared_{len(shared) + 1}"
                    made = self.submodel(part.model, part.model.name or name)
                    yield f"{shared[id(part.model)]} = {made}()"
                elif known is not None:
                    shared[id(part.model)] = f"m.models[{literal(known)}]"
        if model.elements:
            elements = {k: _element(p, shared) for k, p in model.elements.items()}
            yield from call(_adder("m.add", "m.elements", elements), [], elements, tall=True)
        if model.bonds:
            yield from call("m.bond", [literal(b) for b in model.bonds], {})
        if model.signals:
            signals = {k: _signal(s) for k, s in model.signals.items()}
            yield from call(_adder("m.signal", "m.signals", signals), [], signals)
        if model.inputs:
            inputs = {k: _input(i) for k, i in model.inputs.items()}
            yield from call(_adder("m.input", "m.inputs", inputs), [], inputs)
        if model.blocks:
            blocks = {k: _block(b) for k, b in model.blocks.items()}
            yield from call(_adder("m.block", "m.blocks", blocks), [], blocks)
        for name, machine in model.machines.items():
            yield from call(
                "m.machine",
                [literal(name)],
                {
                    "states": literal({k: list(v) for k, v in machine.states.items()}),
                    "start": literal(machine.start),
                    **({"rules": literal(list(machine.rules))} if machine.rules else {}),
                },
            )
        if model.ports:
            ports = {k: literal(v) for k, v in model.ports.items()}
            yield from call(_adder("m.port", "m.ports", ports), [], ports)
        for bond, node in model.pins.items():
            yield from call("m.pin", [literal(bond)], {"at": literal(node)})
        if model.reference_states:
            states = {k: literal(v) for k, v in model.reference_states.items()}
            yield from call(_adder("m.reference", "m.reference_states", states), [], states)
        if model.experiment:
            yield from assigned("m.experiment", model.experiment)
        if model.layout:
            yield from assigned("m.layout", model.layout)
        yield "return m"


def _adder(method: str, mapping: str, names: Mapping[str, str]) -> str:
    """Return what adds these names: the method, unless a name is that of its first parameter."""
    return f"{mapping}.update" if "self" in names else method


def _element(part: Part | SubmodelPart, shared: Mapping[int, str]) -> str:
    if isinstance(part, SubmodelPart):
        which = literal(part.model) if isinstance(part.model, str) else shared[id(part.model)]
        if "inputs" in part.parameters:
            raise ModelError(
                "a parameter of a submodel is called 'inputs', as the inputs themselves are",
                code="HB-E670",
                where="parameters.inputs",
                hint="rename the parameter",
            )
        given = {k: literal(v) for k, v in part.parameters.items()}
        if part.inputs:
            given = {"inputs": literal(part.inputs), **given}
        return flat("hb.Submodel", [which], given)
    options = {k: literal(v) for k, v in part.options.items()}
    if part.kind in ("0", "1"):
        return flat("hb.One" if part.kind == "1" else "hb.Zero", [], options)
    return flat(f"hb.{part.kind}", [literal(part.value)], options)


def _signal(signal: str | float | Integral | Sampled) -> str:
    if not isinstance(signal, Integral | Sampled):
        return literal(signal)
    start = {} if repr(signal.start) == "0.0" else {"start": literal(signal.start)}
    if isinstance(signal, Integral):
        return flat("hb.Integral", [literal(signal.rate)], start)
    phase = {} if repr(signal.phase) == "0.0" else {"phase": literal(signal.phase)}
    given = {"every": literal(signal.every), **start, **phase}
    return flat("hb.Sampled", [literal(signal.value)], given)


def _block(block: BlockPart) -> str:
    given = {
        "every": block.every,
        "inputs": block.inputs or None,
        "outputs": list(block.outputs),
        "parameters": block.parameters or None,
        "phase": None if repr(block.phase) == "0.0" else block.phase,
    }
    options = {k: literal(v) for k, v in given.items() if v is not None}
    return flat("hb.FMU", [literal(block.fmu)], options)


def _input(given: InputPart) -> str:
    options = {
        "constant": given.constant,
        "table": given.table,
        "linear": given.linear or None,
        "period": given.period,
        "pwm": given.pwm,
    }
    return flat("hb.Input", [], {k: literal(v) for k, v in options.items() if v is not None})


def arguments(values: Sequence[str], named: Mapping[str, str]) -> list[str]:
    """Return the arguments of a call; a name that is a word of Python goes through a mapping."""
    found = list(values)
    for name, value in named.items():
        plain = name.isidentifier() and not keyword.iskeyword(name)
        found.append(f"{name}={value}" if plain else f"**{{{literal(name)}: {value}}}")
    return found


def flat(function: str, values: Sequence[str], named: Mapping[str, str]) -> str:
    """Return a call on one line."""
    return f"{function}({', '.join(arguments(values, named))})"


def call(
    function: str, values: Sequence[str], named: Mapping[str, str], *, tall: bool = False
) -> Iterator[str]:
    """Yield the lines of a call: one, or with one argument a line if that is too long."""
    given = arguments(values, named)
    line = f"{function}({', '.join(given)})"
    if len(line) <= WIDTH - 4 and not (tall and len(given) > 1):
        yield line
        return
    yield f"{function}("
    for text in given:
        yield from _broken(text, "    ")
    yield ")"


def assigned(target: str, value: Any) -> Iterator[str]:
    """Yield an assignment, a long mapping one entry a line."""
    line = f"{target} = {literal(value)}"
    if len(line) <= WIDTH - 4 or not isinstance(value, Mapping):
        yield line
        return
    yield f"{target} = {{"
    for k, v in value.items():
        yield from _broken(f"{literal(k)}: {literal(v)}", "    ")
    yield "}"


def _broken(text: str, indent: str) -> Iterator[str]:
    """Yield one argument, its brackets opened over several lines where it is too long."""
    if len(indent) + len(text) + 5 <= WIDTH:
        yield f"{indent}{text},"
        return
    opening, items, closing = _opened(text)
    if not items:
        yield f"{indent}{text},"
        return
    yield f"{indent}{opening}"
    for item in items:
        yield from _broken(item, f"{indent}    ")
    yield f"{indent}{closing},"


def _opened(text: str) -> tuple[str, list[str], str]:
    """Split a text at its outermost brackets: what opens, the items in between, what closes."""
    if not text or text[-1] not in ")]}":
        return text, [], ""
    depth, quote, first, items, start = 0, "", -1, [], 0
    k = 0
    while k < len(text):
        c = text[k]
        if quote:
            if c == "\\":
                k += 1
            elif c == quote:
                quote = ""
        elif c in "'\"":
            quote = c
        elif c in "([{":
            depth += 1
            if depth == 1:
                if first >= 0:
                    return text, [], ""
                first, start = k, k + 1
        elif c in ")]}":
            depth -= 1
            if depth == 0 and k < len(text) - 1:
                return text, [], ""
        elif c == "," and depth == 1:
            items.append(text[start:k].strip())
            start = k + 1
        k += 1
    last = text[start:-1].strip()
    return text[: first + 1], [*items, *([last] if last else [])], text[-1]


def literal(value: Any) -> str:
    """Return a value as Python text, with double quotes where nothing speaks against them.

    Examples
    --------
    >>> print(literal({"when": "it's", "list": ["a", 1.5]}))
    {"when": "it's", "list": ["a", 1.5]}
    """
    if isinstance(value, str):
        text = repr(value)
        if text[0] == "'" and '"' not in value:
            return f'"{text[1:-1]}"'
        return text
    if isinstance(value, bool | int) or value is None:
        return repr(value)
    if isinstance(value, float):
        return repr(float(value))
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{literal(k)}: {literal(v)}" for k, v in value.items()) + "}"
    if isinstance(value, tuple):
        inner = ", ".join(literal(v) for v in value)
        return f"({inner},)" if len(value) == 1 else f"({inner})"
    if isinstance(value, list):
        return "[" + ", ".join(literal(v) for v in value) + "]"
    if hasattr(value, "tolist"):  # NumPy's arrays and numbers
        return literal(value.tolist())
    raise ModelError(
        f"{value!r} cannot be written to a script",
        code="HB-E670",
        where="the script",
        hint="write it as a number or a text",
    )
