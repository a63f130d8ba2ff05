"""The start of a circuit without uic: at rest with the sources as they are at t = 0.

At rest no current flows through a capacitor and no voltage drops across a coil. So a current source
of zero stands for each C, a voltage source of zero for each L, and what remains is a circuit
without storage, whose diodes and switches are settled as any others. Sources that compute do so
of what is there at rest, at t = 0. Where its solution is not the only one, the start is not a
matter of the circuit, and the netlist has to say it, unless the resistances of its open switches
do: a capacitor behind a switch that samples holds what leaks to it. An oscillator of comparators
has none: each makes the other false. It starts as with ``uic``, and a warning says so.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

from hybond.circuits.behaviour import PLACE
from hybond.circuits.deck import Deck
from hybond.circuits.formulas import evaluate
from hybond.circuits.graph_names import GraphNames
from hybond.circuits.leaves import Leaf
from hybond.circuits.notices import Line, Notices
from hybond.circuits.numerals import quantity
from hybond.circuits.opened import GROUND, Branch, Value
from hybond.circuits.settled_starts import settle_starts
from hybond.circuits.texts import Texts
from hybond.circuits.waves import Drive
from hybond.circuits.weaving import ends_of, weave
from hybond.circuits.wiring import Assembly
from hybond.circuits.woven import written
from hybond.errors import FileError, HybondError
from hybond.files.place import shortened
from hybond.model.builder import Model
from hybond.model.expressions import Number, substitute

LARGEST = 1000
"""Elements of a circuit whose rest is computed: all at once, with dense matrices."""
FEW = 4
"""Elements that a remedy names."""
NEVER_SETTLES = "HB-N401"
"""What a run ends with whose comparisons follow each other at one instant without end."""
NO_REST = (
    "no rest of the circuit was found, so the start is that of uic, from zero or from the voltages "
    "of .ic"
)
Forced = Sequence[tuple[str, Value, Line]]


def operating_point(
    leaves: Sequence[Leaf],
    numbers: Mapping[str, int],
    shown: Sequence[str],
    forced: Forced,
    texts: Texts,
    deck: Deck,
    place: str,
    notices: Notices,
    *,
    parameters: Mapping[str, str | float],
    values: Mapping[str, float],
) -> list[Leaf]:
    """Return the branches, C and L with their starts at rest.

    Parameters
    ----------
    numbers, shown : nodes by key, and their names
    forced : sequence of (node, voltage, line)
        What ``.ic`` holds until t = 0.
    parameters, values : mapping
        Those of the model, which values of elements are written with, and what they are.

    Raises
    ------
    FileError
        HB-F143 if the circuit has no rest, or not one alone.
    """
    cleared = [replace(leaf, start=None) for leaf in leaves]
    stores = [k for k, leaf in enumerate(leaves) if leaf.role == "C" or _is_coil(leaf)]
    driven = any(_drives(leaf) for leaf in leaves)
    if not stores or (not driven and not forced):
        return cleared  # nothing drives it: it is at rest with nothing stored
    if len(leaves) > LARGEST:
        why = f"the rest of more than {LARGEST} elements is not computed"
        raise _none(place, why, _remedy(deck, leaves, stores))
    still = [_at_rest(leaf) for leaf in cleared]
    still += [_holding(key, value, line) for key, value, line in forced if key != GROUND]
    asked = (still, stores, numbers, shown, texts, deck)
    try:
        try:
            at_rest, above = _solve(*asked, parameters, values)
        except FileError as error:
            still += (leaks := [leak for leaf in still for leak in _leak(leaf)])
            if not leaks or error.code != "HB-F143":
                raise
            try:
                at_rest, above = _solve(*asked, parameters, values)
            except HybondError as left:
                raise (left if left.code == error.code else error) from None
            _tell_leaks(error, leaks, deck, notices)
    except FileError:
        raise
    except HybondError as error:
        if error.code == NEVER_SETTLES and deck.transient is not None:
            # an oscillator: SPICE gives what its search for a rest has come to when it gives up
            notices.add(deck.transient.line, f"{NO_REST}: {error.why}")
            held = {key: value for key, value, _ in forced}
            return [with_nodes(leaf, held) for leaf in cleared]
        why = f"with coils as wires and capacitors open the circuit has no rest: {error.why}"
        raise _none(place, why, _remedy(deck, leaves, stores)) from None
    found = list(cleared)
    for k, value in at_rest.items():
        if value:
            found[k] = replace(found[k], start=Value(Number(value), value))
    for k, is_above in above.items():
        branch = replace(found[k].branch, state="on" if is_above else "off")
        found[k] = replace(found[k], branch=branch)
    return found


def with_nodes(leaf: Leaf, forced: Mapping[str, Value]) -> Leaf:
    """Return a capacitor that starts from the voltages of ``.ic``, if it has no start itself."""
    if leaf.role != "C" or leaf.start is not None:
        return leaf
    a, b = forced.get(leaf.branch.a), forced.get(leaf.branch.b)
    if a is None and b is None:
        return leaf
    if b is None:
        return replace(leaf, start=a)
    number = (0.0 if a is None else a.number) - b.number
    return replace(leaf, start=Value(Number(number), number))


def _none(place: str, why: str, hint: str) -> FileError:
    return FileError(why, code="HB-F143", where=place, hint=hint)


def _remedy(deck: Deck, leaves: Sequence[Leaf], stores: Sequence[int]) -> str:
    """Return what to write: the line of the analysis as it is to be, and where starts may stand."""
    line = ".tran ... uic"
    if deck.transient is not None:
        asked = deck.transient.line
        line = f"{shortened(asked.text)} uic in line {asked.number}"
    names = [leaves[k].branch.name for k in stores[:FEW]]
    named = ", ".join(names) + (", ..." if len(stores) > FEW else "")
    return f"write {line}, and IC= behind those of {named} that do not start from zero"


def _is_coil(leaf: Leaf) -> bool:
    """Whether a branch stores flux; an ideal transformer stores nothing."""
    winding = leaf.winding
    return leaf.role == "I" or (winding is not None and winding.core.inductance is not None)


def _drives(leaf: Leaf) -> bool:
    """Whether a branch gives anything at t = 0 where nothing else does."""
    if leaf.drive is not None:
        return leaf.drive.initial != 0.0
    law = leaf.branch.law
    if law is None or leaf.role == "R":
        return False
    nothing = {"time": 0.0} | {f"{PLACE}{k}": 0.0 for k in range(len(law.reads))}
    try:
        return evaluate(law.formula, nothing) != 0.0
    except (KeyError, ArithmeticError, ValueError):
        return True  # a parameter, or no value at zero: the circuit tells


def _at_rest(leaf: Leaf) -> Leaf:
    """Return what stands for a branch at rest at t = 0."""
    law = leaf.branch.law
    if law is not None:
        law = replace(law, formula=substitute(law.formula, {"time": Number(0.0)}))
        return replace(leaf, branch=replace(leaf.branch, law=law))
    if leaf.role == "C":
        return replace(leaf, role="Sf", text="0 A", drive=Drive("0 A", None, 0.0, True))
    if _is_coil(leaf):
        return replace(
            leaf, role="Se", text="0 V", drive=Drive("0 V", None, 0.0, True), winding=None
        )
    if leaf.drive is not None:
        value = leaf.drive.initial
        return replace(leaf, text=value, drive=Drive(value, None, value, True))
    return leaf


def _leak(leaf: Leaf) -> list[Leaf]:
    """Return what a switch lets through that is taken as open, as a resistor beside it."""
    ideal = leaf.switch
    if ideal is None or math.isfinite(ideal.beside) or not math.isfinite(ideal.leak):
        return []
    branch = leaf.branch
    part = Branch(f"{branch.name}_leak", "r", branch.line, branch.a, branch.b)
    return [Leaf(part, "R", quantity(ideal.leak, "ohm"), beside=branch.key)]


def _tell_leaks(error: FileError, leaks: Sequence[Leaf], deck: Deck, notices: Notices) -> None:
    """Say that the start is that of resistances which are taken as none from there on."""
    line = leaks[0].branch.line if deck.transient is None else deck.transient.line
    what = error.why.partition(":")[0]
    notices.add(line, f"{what} but for ROFF of the switches that are open: it starts from that")


def _holding(key: str, value: Value, line: Line) -> Leaf:
    branch = Branch(f"hold_{key}", "v", line, key, GROUND)
    return Leaf(branch, "Se", value.number, Drive(value.number, None, value.number, True))


def _solve(
    still: list[Leaf],
    stores: Sequence[int],
    numbers: Mapping[str, int],
    shown: Sequence[str],
    texts: Texts,
    deck: Deck,
    parameters: Mapping[str, str | float],
    values: Mapping[str, float],
) -> tuple[dict[int, float], dict[int, bool]]:
    """Return what each C and L holds at rest, and on which side switches with two thresholds are.

    Those are above them, or below; one that lies between keeps its side.
    """
    from hybond.simulation import simulate

    names = GraphNames()
    notices = Notices()
    ends = ends_of(still, numbers)
    # a capacitor that blocks a current source off from its way back is seen by weave
    woven = weave(still, ends, shown, names, texts, notices)
    model = Model("rest", domain="electrical", parameters=dict(parameters))
    only = replace(deck, outputs=[], measures=[])
    Assembly(model, woven, still, ends, numbers, texts, only, notices, values).run()
    wanted: dict[int, str] = {}
    for k in stores:
        terms = woven.drops.get(k) if still[k].role == "Sf" else woven.currents.get(k)
        text = written(terms or ())
        if text != "0":
            name = names.take(f"rest_{k}")
            model.signals[name] = text
            wanted[k] = name
    if not model.bonds or not wanted:
        return {}, {}
    settle_starts(model)
    run = simulate(model, until=1.0, solver="rk45")
    undetermined = {
        (end, name.rpartition(".")[2])
        for event in run.events[:1]
        for name in event.steps[-1].undetermined
        for end in re.findall(r"[\w.]+", name.rpartition(".")[0])
    }
    for k, name in wanted.items():
        if undetermined & _read(str(model.signals[name])):
            raise still[k].branch.line.refuse(
                f"at rest, {still[k].branch.name} may hold anything: the circuit does not say what "
                "it starts from",
                code="HB-F143",
                hint=_remedy(deck, still, stores),
            )
    closed = {
        node
        for machine, state in zip(run.graph.machines, run.events[0].steps[-1].mode, strict=True)
        for node in (run.graph.nodes[n].path for n in machine.on[state])
    }
    above = {
        k: (junction in closed) != switch.inverted
        for k, junction in woven.junctions.items()
        if (switch := still[k].switch) is not None and switch.on != switch.off
    }
    return {k: _clean(float(run[name].at(0.0))) for k, name in wanted.items()}, above


def _read(text: str) -> set[tuple[str, str]]:
    """Return the elements and variables in a sum."""
    return {(name, variable) for name, variable in re.findall(r"(\w[\w.]*)\.([ef])\b", text)}


def _clean(value: float) -> float:
    return float(f"{value:.15g}")
