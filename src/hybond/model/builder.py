"""`Model`: what a modeller builds, the one mutable thing in hybond."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from numbers import Real
from typing import TYPE_CHECKING, Any, TypeVar

from hybond.calls import called, fits
from hybond.errors import HybondError, ModelError
from hybond.model.domains import no_such_domain
from hybond.model.kinds import KINDS
from hybond.model.origin import Origin
from hybond.model.parts import (
    BlockPart,
    InputPart,
    Integral,
    MachinePart,
    Part,
    Sampled,
    SubmodelPart,
    Value,
)
from hybond.model.symbol import Symbol
from hybond.names import Asked, plural
from hybond.units import DOMAINS

if TYPE_CHECKING:
    from hybond.model.checked import Checked
    from hybond.model.graph import FlatGraph

T = TypeVar("T")

_NAME = re.compile(r"([A-Za-z_][A-Za-z0-9_]*)(\[[^\[\]]+\])?\Z")
_END = re.compile(r"\s*[\w.\[\]]+\s*")
"""A node or a port, where a bond should be."""
RESERVED = frozenset(
    {"time", "pi", "pre", "and", "or", "not", "if", "then", "else", "true", "false"}
)


@fits('hb.Model("oscillator", domain="translational")')
class Model(Asked):
    """A hybrid bond graph under construction.

    Parameters
    ----------
    name : str
        A short name; `title` is for people.
    domain : str
        The physical domain of bonds that do not say otherwise: ``"electrical"``,
        ``"translational"``, ``"rotational"``, ``"hydraulic"``, ``"thermal"``,
        ``"thermal_pseudo"``, ``"magnetic"``, ``"generic"`` or ``"generic_pseudo"`` (no units).
    parameters : mapping
        Names to numbers, quantities (``"10 mA"``) or expressions of earlier parameters.

    Examples
    --------
    A mass on a spring:

    >>> import hybond as hb
    >>> m = hb.Model("oscillator", domain="translational", parameters={"k": "100 N/m"})
    >>> m.add(mass=hb.I("1 kg", f="1 m/s"), spring=hb.C("1/k"), v=hb.One())
    >>> m.bond("v -> mass", "v -> spring")
    >>> graph = m.flatten()
    >>> [s.path for s in graph.storages]
    ['mass.p', 'spring.q']
    """

    def __init__(
        self,
        name: str = "model",
        *,
        title: str = "",
        domain: str = "generic",
        parameters: Mapping[str, Value] | None = None,
    ) -> None:
        _check(name, domain, parameters)
        self.name = name
        self.title = title
        self.about = ""
        """What the model is, in several lines; Markdown."""
        self.domain = domain
        self.parameters: dict[str, Value] = dict(parameters or {})
        self.elements: dict[str, Part | SubmodelPart] = {}
        self.bonds: list[str] = []
        self.signals: dict[str, str | float | Integral | Sampled] = {}
        self.inputs: dict[str, InputPart] = {}
        self.machines: dict[str, MachinePart] = {}
        self.blocks: dict[str, BlockPart] = {}
        self.ports: dict[str, str] = {}
        self.models: dict[str, Model] = {}
        self.experiment: dict[str, Any] = {}
        self.layout: dict[str, tuple[float, float]] = {}
        self.symbol: Symbol | None = None
        self.pins: dict[str, str] = {}
        """Bond to the node at its stroke; see `pin`."""
        self.only_drawn = False
        """Whether parts have words for their values, as of a netlist, and mean nothing else."""
        self.reference_states: dict[str, str] = {}
        """Machine to state; see `reference`."""
        self.origin: Origin | None = None
        """Where it was read from, if it was."""
        self.indeterminate = "error"
        """``"error"`` or ``"least leakage"``: what a guard on an undetermined signal means."""

    @called('m.add(c=hb.C("1 mF"), n=hb.Zero())')
    def add(
        self,
        arrays: Mapping[str, Part | SubmodelPart] | None = None,
        /,
        **elements: Part | SubmodelPart,
    ) -> None:
        """Add elements, junctions and submodels by name, arrays of them in a mapping.

        Parameters
        ----------
        arrays : mapping
            Names that Python has no words for to what they are.
        **elements
            Names to what they are.

        Examples
        --------
        A chain of three masses, the first of which is pushed:

        >>> import hybond as hb
        >>> m = hb.Model("chain", domain="translational", parameters={"n": 3})
        >>> m.add({"m[1..n]": hb.I("i*1 [kg]"), "v[1..n]": hb.One(), "s[1..n-1]": hb.C("1 mm/N"),
        ...        "pull[1..n-1]": hb.Zero()}, push=hb.Se("1 N"))
        >>> m.bond("v[1..n] -> m[1..n]", "push -> v[1]",
        ...        "v[1..n-1] -> pull[1..n-1] -> v[2..n]", "pull[1..n-1] -> s[1..n-1]")
        >>> [s.path for s in m.flatten().storages]
        ['m[1].p', 'm[2].p', 'm[3].p', 's[1].q', 's[2].q']
        """
        for name, part in _named(arrays, elements, "elements", 'm.add(c=hb.C("1 mF"))'):
            self._new_name(name, array=True)
            if not isinstance(part, Part | SubmodelPart):
                raise _no_element(part, name)
            self.elements[name] = part

    def bond(self, *chains: str) -> None:
        """Add bonds as they are drawn: ``"a -> b -> c"`` is two bonds."""
        for k, chain in enumerate(chains, len(self.bonds)):
            if not isinstance(chain, str):
                raise ModelError(
                    f"{chain!r} is not a bond",
                    code="HB-M109",
                    where=f"graph.bonds[{k}]",
                    hint='m.bond("a -> b", "b -> c -> d")',
                )
            if _END.fullmatch(chain):
                both = " -> ".join(map(str, chains if len(chains) > 1 else (chain, "b")))
                raise ModelError(
                    f"{chain!r} is not a bond: it has one end",
                    code="HB-M109",
                    where=f"graph.bonds[{k}]",
                    hint=f'm.bond("{both}")',
                )
        self.bonds.extend(chains)

    @called('m.parameter(R="10 ohm")')
    def parameter(self, **parameters: Value) -> None:
        """Add or change parameters."""
        self.parameters.update(parameters)

    @called('m.signal(power="v.f*F.e")')
    def signal(
        self,
        arrays: Mapping[str, str | float | Integral | Sampled] | None = None,
        /,
        **signals: str | float | Integral | Sampled,
    ) -> None:
        """Add signals: an expression, an `Integral`, or what is `Sampled`; arrays in a mapping."""
        for name, signal in _named(arrays, signals, "signals", 'm.signal(power="v.f*F.e")'):
            self._new_name(name, array=True)
            number = isinstance(signal, Real) and not isinstance(signal, bool)
            if not number and not isinstance(signal, str | Integral | Sampled):
                raise ModelError(
                    f"{signal!r} is not a signal",
                    code="HB-M110",
                    where=f"signals.{name}",
                    hint='write "v.f*F.e", hb.Integral("v.f") or hb.Sampled("v.f", every="1 ms")',
                )
            self.signals[name] = signal

    @called('m.input(u="5 V")')
    def input(
        self, arrays: Mapping[str, InputPart | Value] | None = None, /, **inputs: InputPart | Value
    ) -> None:
        """Add inputs; a plain number, quantity or callable is allowed; arrays in a mapping."""
        pwm = 'm.input(gate=hb.Input(pwm={"period": "10 us", "duty": 0.4}))'
        for name, given in _named(arrays, inputs, "inputs", pwm):
            self._new_name(name, array=True)
            if isinstance(given, InputPart):
                self.inputs[name] = given
            elif callable(given):
                self.inputs[name] = InputPart(function=given)
            else:
                self.inputs[name] = InputPart(constant=given)

    def block(self, **blocks: BlockPart) -> None:
        """Add blocks of signals: `hybond.Block`, `hybond.FMU`."""
        for name, block in blocks.items():
            self._new_name(name)
            self.blocks[name] = block

    @called('m.machine("switch", states={"open": [], "closed": ["s"]}, start="open", rules=[...])')
    def machine(
        self,
        name: str,
        *,
        states: Mapping[str, Sequence[str]],
        start: str,
        rules: Sequence[str] = (),
    ) -> None:
        """Add a state machine: the controlled junctions each state switches ON, and its rules."""
        self._new_name(name, array=True)
        where = f"machines.{name}"
        for state, listed in states.items() if isinstance(states, Mapping) else ():
            if isinstance(listed, str) or not isinstance(listed, Iterable):
                what = "a text" if isinstance(listed, str) else "no list of junctions"
                raise ModelError(
                    f"the state {state!r} lists {listed!r}, which is {what}",
                    code="HB-M140",
                    where=f"{where}.states.{state}",
                    hint=f"write [{listed!r}]" if isinstance(listed, str) else 'write ["contact"]',
                )
        if not isinstance(states, Mapping):
            raise ModelError(
                f"states = {states!r} does not say what each state switches ON",
                code="HB-M140",
                where=f"{where}.states",
                hint='states={"open": [], "closed": ["contact"]}',
            )
        if isinstance(rules, str):
            raise ModelError(
                "the rules are one text",
                code="HB-M145",
                where=f"{where}.rules",
                hint=f"write a list of them: rules=[{rules!r}]",
            )
        self.machines[name] = MachinePart(
            {k: tuple(v) for k, v in states.items()}, start, tuple(rules)
        )

    def port(self, arrays: Mapping[str, str] | None = None, /, **ports: str) -> None:
        """Expose nodes of a submodel: ``port(shaft="inertia_junction")``; arrays in a mapping."""
        self.ports.update({**(arrays or {}), **ports})

    @called('m.pin("a -> b", at="b")')
    def pin(self, bond: str, *, at: str) -> None:
        """Fix the causal stroke of a bond.

        Parameters
        ----------
        bond : str
            The bond as written, ``"contact -> v"``, or its label.
        at : str
            The node at the stroke: the end of the bond that receives the effort.

        Examples
        --------
        Two resistors in series; which of them gives the flow is free, unless it is pinned.

        >>> import hybond as hb
        >>> m = hb.Model("divider")
        >>> m.add(V=hb.Se(12), r=hb.R(1), s=hb.R(2), node=hb.One())
        >>> m.bond("V -> node -> r", "node -> s")
        >>> m.pin("node -> r", at="r")
        >>> dict(m.flatten().pins)
        {1: 1}
        """
        self.pins[bond] = at

    def reference(self, **states: str) -> None:
        """Give the reference mode of causality: the mode that others are compared with.

        Machines that are left out are in their start state. Without this a mode with as much
        integral causality as possible is looked for.
        """
        self.reference_states.update(states)

    def flatten(self, *, parameters: Mapping[str, Value] | None = None) -> FlatGraph:
        """Return the frozen flat graph: submodels resolved, names and units checked.

        Parameters
        ----------
        parameters : mapping
            Values by dotted path that replace the model's own, as ``--set`` does.

        Raises
        ------
        ModelError
            With the place and a remedy.
        """
        from hybond.model.flatten import flatten

        return flatten(self, parameters or {})

    def check(self) -> Checked:
        """Return what a check of the model says: a refusal if it has no meaning, and hints.

        Hints are no errors: a storage whose arrow points away, a parameter that nothing uses, a
        state without a way out. Each has a code with a page, a place and a remedy.

        Examples
        --------
        >>> import hybond as hb
        >>> m = hb.Model("rc", domain="electrical")
        >>> m.add(c=hb.C("1 mF", e="10 V"), r=hb.R("1 kohm"), node=hb.Zero())
        >>> m.bond("node -> c", "r -> node")
        >>> [hint.code for hint in m.check()]
        ['HB-H101']
        """
        from hybond.hints.look import checked

        return checked(self)

    @called('m.draw(mode={"switch": "open"}).save("model.png")')
    def draw(
        self,
        *,
        mode: Mapping[str, str] | None = None,
        numbers: bool = False,
        simplify: bool | None = None,
        open: Sequence[str] | None = None,
        legend: bool = True,
        schematic: bool = False,
    ) -> Any:
        """Return the bond graph as a `Drawing`, with the causal strokes of one mode.

        Parameters
        ----------
        mode : mapping of machine to state
            Machines that are left out are in their start state. Without it: the mode in which a
            run goes on after its start.
        numbers : bool
            Number the bonds.
        simplify : bool, optional
            Leave out junctions between two bonds, grounds, and losses of zero. Without it that is
            done where a model is made of parts.
        open : sequence of str, optional
            Draw each part as one box, but for those named here, which have a frame around what is
            in them: ``open=()`` closes all.
        legend : bool
            Explain the signs that occur.
        schematic : bool
            Draw parts as symbols and bonds as wires instead; see `hybond.draw.draw_schematic`.

        Raises
        ------
        ModelError
            HB-M144 for a machine or state that does not exist.
        UsageError
            HB-D110 for a schematic of a model without parts, HB-D111 for a part to open that does
            not exist.
        """
        from hybond.draw import draw_mode, draw_schematic

        if schematic and self.only_drawn:
            return draw_schematic(self)
        graph = self.flatten()  # what has no meaning is not drawn as if it had one
        if schematic:
            return draw_schematic(self)
        chosen = None if mode is None else graph.mode_of(mode)
        return draw_mode(
            graph, chosen, numbers=numbers, simplify=simplify, open=open, legend=legend
        )

    def _new_name(self, name: str, *, array: bool = False) -> None:
        match = _NAME.match(name) if isinstance(name, str) else None
        if match is None or match[1] in RESERVED or (match[2] and not array):
            word = match is not None and match[1] in RESERVED
            why = ": it is a word of the expression language" if word else ""
            raise ModelError(
                f"{name!r} cannot be a name{why}",
                code="HB-M103",
                where=name,
                hint=f"another one, such as {name}_1"
                if word
                else "letters, digits and _; not a word of the expression language"
                + (f"; such as {plain}" if (plain := _plainly(name)) else "")
                + ("; an array is written cell[1..10]" if array and "[" in str(name) else ""),
            )
        taken: dict[str, Mapping[str, object]] = {
            "an element": self.elements,
            "a signal": self.signals,
            "an input": self.inputs,
            "a machine": self.machines,
            "a block": self.blocks,
            "a parameter": self.parameters,
        }
        for what, group in taken.items():
            if name in group or (match[2] and match[1] in group):
                raise ModelError(
                    f"the name {name!r} is used twice: {what} has it already",
                    code="HB-M104",
                    where=name,
                    hint="rename one; elements, parameters, signals, inputs and machines share "
                    "their names",
                )

    def __repr__(self) -> str:
        counts = [
            (len(self.elements), "element"),
            (len(self.bonds), "chain of bonds"),
            (len(self.machines), "machine"),
        ]
        words = [f"{n} {plural(word, n)}" for n, word in counts if n]
        return f"<Model {self.name!r}: {', '.join(words) or 'empty'}>"

    def _repr_html_(self) -> str:
        import html

        try:
            picture = str(self.draw().svg())
        except HybondError as error:
            picture = f"<pre>{html.escape(str(error))}</pre>"
        title = html.escape(self.title or self.name)
        return f"<figure><figcaption>{title}</figcaption>{picture}</figure>"


def _plainly(name: Any) -> str:
    """Return a name made of one with dashes, dots or spaces in it, empty where none is found."""
    tried = re.sub(r"[-. ]+", "_", name.strip()) if isinstance(name, str) else ""
    return tried if tried != name and _NAME.match(tried) and tried not in RESERVED else ""


def _named(
    arrays: Mapping[str, T] | None, named: Mapping[str, T], where: str, example: str
) -> Iterable[tuple[str, T]]:
    """Return names and what they are of both; what stands alone has none."""
    if not isinstance(arrays, Mapping | None):
        raise ModelError(
            f"{arrays!r} has no name",
            code="HB-M102",
            where=where,
            hint=f"write the name before it: {example}",
        )
    return {**(arrays or {}), **named}.items()


def _no_element(part: Any, name: str) -> ModelError:
    maker = getattr(part, "__name__", "") if callable(part) else ""
    hint = 'use hb.Se, Sf, C, I, R, G, TF, GY, Zero, One or Submodel: hb.C("1 mF")'
    if maker in KINDS or maker in ("One", "Zero", "Submodel"):
        hint = f"call it: hb.{maker}(...)"
    return ModelError(
        f"{f'the function {maker}' if maker else repr(part)} is not an element",
        code="HB-M102",
        where=f"elements.{name}",
        hint=hint,
    )


def _check(name: Any, domain: Any, parameters: Any) -> None:
    """Refuse what no model begins with."""
    if not isinstance(name, str):
        raise ModelError(
            f"{name!r} is not a name",
            code="HB-M103",
            where="name",
            hint='hb.Model("oscillator", domain="translational")',
        )
    if domain not in DOMAINS:
        raise no_such_domain(domain, "domain")
    if not isinstance(parameters, Mapping | None):
        raise ModelError(
            f"parameters = {parameters!r} does not map names to values",
            code="HB-M107",
            where="parameters",
            hint='parameters={"m": "1 kg"}',
        )


def graph_of(model: Model | FlatGraph) -> FlatGraph:
    """Return the flat graph of a model, or a flat graph as it is; HB-S130 for what is neither."""
    from hybond.model.given import check_model

    check_model(model)
    return model.flatten() if isinstance(model, Model) else model
