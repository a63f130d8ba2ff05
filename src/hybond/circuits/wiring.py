"""The model of a woven circuit: bonds as chains, sources that follow, switches, outputs."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property

from hybond.circuits.behaviour import Law, Read, plainly
from hybond.circuits.computing import Computing
from hybond.circuits.deck import Deck
from hybond.circuits.feedback import Feedback
from hybond.circuits.given import Given
from hybond.circuits.ideal import IdealSwitch
from hybond.circuits.leaves import Leaf
from hybond.circuits.notices import Line, Notices
from hybond.circuits.opened import GROUND
from hybond.circuits.sensing import Sensing
from hybond.circuits.texts import Texts, minus
from hybond.circuits.thresholds import (
    FALLEN,
    RISEN,
    Rest,
    machine_of,
    opens_again,
    rest_of,
    started,
)
from hybond.circuits.woven import Terms, Woven, written
from hybond.errors import FileError
from hybond.model.builder import Model
from hybond.model.expressions import Compare
from hybond.model.expressions.tree import walk
from hybond.model.parts import Part

_OUTPUT = re.compile(r"([vi])\(([^(),]+)(?:,([^(),]+))?\)\Z", re.IGNORECASE)
_READ = re.compile(r"(?<![\w.])([vi])\(\s*([^\s(),]+)\s*(?:,\s*([^\s(),]+)\s*)?\)", re.IGNORECASE)
_CARRY_A_CURRENT = "veh"
"""Kinds whose current is an unknown of SPICE, so that F, H and W may follow it."""
_GAINS = {"e": "", "g": "A/V", "f": "", "h": "V/A"}


class Assembly:
    """Puts a woven circuit into a model.

    Parameters
    ----------
    values : mapping
        Parameters, by their keys.

    Raises
    ------
    FileError
        HB-F134, HB-F144 (something sensed that is not there or not determined).
    """

    def __init__(
        self,
        model: Model,
        woven: Woven,
        leaves: Sequence[Leaf],
        ends: Sequence[tuple[int, int]],
        numbers: Mapping[str, int],
        texts: Texts,
        deck: Deck,
        notices: Notices,
        values: Mapping[str, float],
    ) -> None:
        self.model, self.woven, self.leaves, self.texts = model, woven, leaves, texts
        self.deck, self.notices, self.values = deck, notices, values
        self.sensing = Sensing(woven, leaves, ends, numbers, self.idle)
        self.idle_names: dict[int, Terms] = {}
        self.computing = Computing(model, woven.names, self.sensing, texts)

    def run(self) -> None:
        """Fill the model."""
        model, woven = self.model, self.woven
        model.elements.update(woven.elements)
        model.signals.update(woven.signals)
        for k, name in woven.inputs.items():
            drive = self.leaves[k].drive
            assert drive is not None and drive.input is not None
            model.inputs[name] = drive.input
        for name, k, sign in woven.pending:
            text = self.controlled(k)
            value = minus(text) if sign < 0 else text
            model.elements[name] = Part(woven.elements[name].kind, value)
        for k, junction in woven.junctions.items():
            if self.leaves[k].switch is not None:
                self.switch(k, junction)
        model.bonds = chains(woven.bonds, woven.elements)
        self.outputs()
        self.measures()
        self.looked_at()

    def looked_at(self) -> None:
        """Make signals of sources that compute and drive nothing: they are there to be looked at.

        After a run it would be too late to ask for them.
        """
        for k in self.woven.idle:
            leaf = self.leaves[k]
            if leaf.role == "Se" and leaf.drive is None:
                try:
                    self.idle(k)
                except FileError as error:
                    self.notices.add(
                        leaf.branch.line, f"{leaf.branch.name} is left out: {error.why}"
                    )

    def controlled(self, k: int) -> str:
        """Return gain times what a controlled source follows."""
        branch = self.leaves[k].branch
        if branch.law is not None:
            unit = "V" if branch.law.imposes == "v" else "A"
            compares = any(isinstance(e, Compare) for e, _ in walk(branch.law.formula))
            on_itself = compares and self.feedback.on_itself(k)
            own = self.woven.own[k]
            text = self.computing.text(branch.law, branch.line, own, on_itself=on_itself)
            return f"1 {unit}*({text})"
        assert branch.value is not None
        sensed = self.sensed(k)
        gain = self.texts.factor(branch.value, _GAINS[branch.kind])
        if branch.value.parametric and branch.kind in "gh":
            gain += "/(1 ohm)" if branch.kind == "g" else "*(1 ohm)"
        if sensed == "0":
            return "0 V" if branch.kind in "eh" else "0 A"
        if not branch.value.parametric and branch.value.number == 1.0 and branch.kind in "ef":
            return sensed
        single = re.fullmatch(r"[\w.]+", sensed)
        return f"{gain}*{sensed if single else f'({sensed})'}"

    def sensed(self, k: int) -> str:
        """Return what a controlled source follows, as an expression."""
        branch = self.leaves[k].branch
        if branch.kind in "egsa":
            plus, minus_ = branch.senses
            return written(self.sensing.voltage(plus, minus_, branch.line))
        source = self.sensing.by_key.get(branch.senses[0])
        if source is None or self.leaves[source].branch.kind not in _CARRY_A_CURRENT:
            raise branch.line.refuse(
                f"{branch.senses[0]!r} is no voltage source",
                code="HB-F134",
                hint="the current of a source V is followed; 0 V makes an ammeter",
            )
        return written(self.sensing.current(branch.senses[0], branch.line))

    def switch(self, k: int, junction: str) -> None:
        """Add the machine of a switch."""
        branch, ideal = self.leaves[k].branch, self.leaves[k].switch
        assert ideal is not None
        unit = "A" if branch.kind == "w" else "V"
        sensed = self.sensed(k)
        on: str | float
        off: str | float
        if not ideal.window:
            assert ideal.other is not None
            on, off = self.texts.value(ideal.threshold, unit), self.texts.value(ideal.other, unit)
        elif ideal.other is None or not (ideal.other.number or ideal.other.parametric):
            on = off = self.texts.value(ideal.threshold, unit)
        else:
            centre = self.texts.factor(ideal.threshold, unit)
            half = self.texts.factor(ideal.other, unit)
            on, off = f"{centre} + {half}", f"{centre} - {half}"
            if not ideal.threshold.parametric and not ideal.other.parametric:
                on, off = f"{ideal.on!r} {unit}", f"{ideal.off!r} {unit}"
        rest = Rest()
        if ideal.on == ideal.off:
            rest = rest_of(branch, ideal, self.given)
            if not rest.told and self.feedback.on_itself(k):
                rest = Rest(">", "<")
            if rest.told or rest.remembers:
                side = f"taken as {_side(ideal, above=rest.up == '>=')}"
                if rest.remembers:
                    side = f"on the other side than where it came from (states {RISEN}, {FALLEN})"
                rests = "rests" if rest.told else "may rest"
                self.notices.add(
                    branch.line,
                    f"{branch.name}: what it follows {rests} at its threshold of {ideal.on:g} "
                    f"{unit}, where it is {side}",
                )
        if set(branch.senses) == {branch.a, branch.b} and self.feedback.on_itself(k):
            opening = opens_again(ideal, branch.name)
            if opening:
                self.notices.add(branch.line, opening)
        machine = machine_of(sensed, on, off, junction, ideal, rest)
        name = self.woven.names.take(f"{junction}_state")
        self.model.machines[name] = replace(machine, start=started(machine, ideal, branch.state))

    @cached_property
    def given(self) -> Given:
        """Return what sources and resistors alone decide."""
        return Given(self.leaves, self.sensing.ends, self.sensing.numbers, self.values)

    @cached_property
    def feedback(self) -> Feedback:
        """Return what has an effect at once on what it reads."""
        return Feedback(self.leaves, self.sensing.ends, self.sensing.numbers, self.values)

    def idle(self, k: int) -> Terms | None:
        """Return the voltage of a source or capacitor that carries no current."""
        if k in self.idle_names:
            return self.idle_names[k]
        leaf = self.leaves[k]
        if leaf.role == "C":
            if leaf.start is None or not leaf.start.number:
                terms: Terms = ()
            else:
                terms = ((1, f"({self.texts.value(leaf.start, 'V')})"),)
        elif leaf.drive is not None and leaf.drive.constant:
            text = str(leaf.drive.text)
            terms = () if leaf.drive.zero else ((1, f"({text})" if "-" in text else text),)
        else:
            name = self.woven.own[k]
            terms = ((1, name),)
            self.idle_names[k] = terms
            if leaf.drive is None:
                self.model.signals[name] = self.controlled(k)
            elif leaf.drive.input is not None and leaf.drive.ramp:
                whole = self.woven.names.take(f"u_{name}")
                self.model.inputs[whole] = leaf.drive.input
                self.model.signals[name] = f"{whole}*{leaf.drive.ramp}"
            elif leaf.drive.input is not None:
                self.model.inputs[name] = leaf.drive.input
            else:
                self.model.signals[name] = str(leaf.text)
        self.idle_names[k] = terms
        return terms

    def outputs(self) -> None:
        """Turn ``.print`` and the like into what a run keeps and plots."""
        plot: list[str] = []
        for text, line in self.deck.outputs:
            match = _OUTPUT.match(text)
            if match is None:
                self.notices.add(line, f"the output {text} is left out: v(a), v(a,b), i(V1)")
                continue
            name = self.output(match[1].lower(), match[2], match[3], line)
            if name is not None and name not in plot:
                plot.append(name)
        if plot:
            self.model.experiment["plot"] = plot

    def read(self, text: str) -> str:
        """Return a text with what it says in words of SPICE, ``v(a)``, in those of the model.

        Raises
        ------
        FileError
            HB-F134 (no such node or element), HB-F144 (nothing tells it).
        """
        text = plainly(text)
        whole = _READ.fullmatch(text.strip())

        def one(match: re.Match[str]) -> str:
            line = Line("", 0, match[0])
            if match[1].lower() == "v":
                terms = self.sensing.voltage(_node(match[2]), _node(match[3] or GROUND), line)
            else:
                terms = self.sensing.current(match[2].lower(), line)
            found = written(terms)
            plain = whole is not None or re.fullmatch(r"[A-Za-z_][\w.]*", found)
            return found if plain else f"({found})"

        return _READ.sub(one, text)

    def measures(self) -> None:
        """Make signals of what is measured."""
        for one in self.deck.measures:
            try:
                for law in (one.law, *(c.law for c in (one.when, one.until) if c is not None)):
                    if law is not None:
                        self.signal_of(law, one.name, one.line)
            except FileError as error:
                remedy = f"; {error.hint}" if error.hint else ""
                self.notices.add(one.line, f"the measurement is left out: {error.why}{remedy}")

    def signal_of(self, law: Law, owner: str, line: Line) -> None:
        """Make a signal of a law, once."""
        text = self.computing.text(_lowered(law), line, owner)
        if text not in self.woven.measured:
            name = self.woven.names.take(f"meas_{owner}")
            self.model.signals[name] = text
            self.woven.measured[text] = name
        self.woven.laws[law] = self.woven.measured[text]

    def output(self, what: str, first: str, second: str | None, line: Line) -> str | None:
        """Return a voltage or current that a card names, as an expression; None if it is zero."""
        if what == "v":
            terms = self.sensing.voltage(_node(first), _node(second or GROUND), line)
        else:
            terms = self.sensing.current(first.lower(), line)
        text = written(terms)
        if text == "0":
            self.notices.add(line, f"the output {what}({first}) is left out: it is zero")
            return None
        if re.fullmatch(r"[A-Za-z_][\w.]*", text):
            return text
        stem = f"{what}_{first}" + (f"_{second}" if second else "")
        stem = re.sub(r"\W+", "_", stem)
        if self.model.signals.get(stem) == text:
            return stem
        name = self.woven.names.take(stem)
        self.model.signals[name] = text
        return name


def _lowered(law: Law) -> Law:
    """Return a law that is written at the top of a netlist, with keys of nodes and elements."""
    reads = tuple(
        Read(r.kind, _node(r.first) if r.kind == "v" else r.first.lower(), _node(r.second))
        for r in law.reads
    )
    return Law(law.imposes, law.formula, reads)


def _side(ideal: IdealSwitch, *, above: bool) -> str:
    return "closed" if above != ideal.inverted else "open"


def _node(text: str) -> str:
    key = text.strip().lower()
    return GROUND if key == "gnd" else key


def chains(bonds: Sequence[tuple[str, str]], elements: Mapping[str, Part]) -> list[str]:
    """Return bonds as text, two in a row where the first ends at the junction of the second.

    Examples
    --------
    >>> j = {"i": Part("1"), "V": Part("Se", 1), "R": Part("R", 1)}
    >>> chains([("V", "i"), ("i", "R"), ("i", "C")], j)
    ['V -> i -> R', 'i -> C']
    """
    found: list[list[str]] = []
    for tail, head in bonds:
        last = found[-1] if found else None
        part = elements.get(tail)
        if last is not None and last[-1] == tail and part is not None and part.kind in ("0", "1"):
            last.append(head)
        else:
            found.append([tail, head])
    return [" -> ".join(names) for names in found]
