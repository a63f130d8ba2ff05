"""Jumps: what the mode that is tried would add to the state, and when that is written."""

from __future__ import annotations

from collections.abc import Iterator

from hybond.export.modelica.draft import Draft
from hybond.export.modelica.expressions import number
from hybond.export.modelica.identifiers import quoted
from hybond.export.modelica.start import until_of
from hybond.export.modelica.trees import unbracketed
from hybond.export.modelica.variables import Variables
from hybond.model.graph import Mode

NEAR = 1e-7
"""Part of the experiment within which impacts are close to each other."""
BURST = 40
"""Impacts close to each other that are taken for an accumulation."""
IMPULSE = 1e-7
"""Part of what a storage would hold of all energy, below which an impulse is rounding: the state
at an event is known to the tolerance of its location."""
IMPULSE_OF_DIODES = 1e-9
"""The same beside diodes, which turn on and off by what little the integration leaves."""


def jump_equations(variables: Variables) -> Iterator[str]:
    """Yield how event iterations are counted, and what is written when nothing fires any more."""
    draft = variables.draft
    if not draft.careful:
        return
    calm, changed = draft.calm, draft.ids.of("changed", "changed")
    draft.declared += [
        f"Integer {calm}(start = {draft.settled}, fixed = true) "
        '"event iterations since something changed";',
        f"Boolean {changed};",
    ]
    marks = [draft.machine(m.index) for m in draft.graph.machines]
    marks += [i.piece for i in variables.inputs.values() if i.piece]
    either = " or ".join(f"{m} <> pre({m})" for m in marks) or "false"
    yield f"{changed} = {either};"
    yield f"{calm} = if {changed} then 0 else min(pre({calm}) + 1, {draft.settled});"
    if draft.jumping:
        draft.declared.append(f'Real {draft.small} "impulses below this are rounding";')
        yield f"{draft.small} = 1e-30 + {_smallest_impulse(draft)};"
        yield from _tried(variables)
        yield from _writing(variables)


def _tried(variables: Variables) -> Iterator[str]:
    """Yield what the mode that is tried makes of what is stored."""
    draft, form = variables.draft, variables.draft.sudden
    written = _written(variables)
    for k in sorted(draft.jumping):

        def leaf(mode: Mode, k: int = k) -> str | None:
            row = form.jump(k, mode)
            return "0" if row is None else variables.row(form, row, variables.stored)

        path = draft.graph.storages[k].path
        new, jump = draft.new(k), draft.jump(k)
        text = variables.modes.text(f"the jump of {path}", form.machines, leaf)
        draft.declared += [
            f"Real {jump} {quoted(f'what the mode adds to {path} on entry')};",
            f"Real {new} {quoted(f'{path} in the mode that is tried')};",
        ]
        plain = unbracketed(text or "0")
        yield f"{jump} = {f'if {written} then 0 else {text}' if written else plain};"
        yield f"{new} = {draft.stored(k)} + {jump};"


def _writing(variables: Variables) -> Iterator[str]:
    """Yield the event that writes what jumps, and what ends runs in which impacts accumulate."""
    draft = variables.draft
    impacts = any(any(m.fieldless) for m in draft.graph.machines)
    if impacts:
        yield from _accumulation(variables)
    yield f"when {draft.calm} == {draft.settled} then"
    if impacts:
        last, burst = _last(draft), _burst(draft)
        near = f"time - pre({last}) < {_near(draft)}"
        yield f"  {burst} = if {near} then pre({burst}) + 1 else 0;"
        yield f"  {last} = time;"
    for k in sorted(draft.jumping):
        yield f"  reinit({draft.stored(k)}, {draft.new(k)});"
    for i in draft.graph.integrals:
        impulse = variables.pairs.pair(i.rate)[1]
        if impulse is not None:
            name = draft.integral(i.index)
            yield f"  reinit({name}, {name} + {impulse});"
    yield "end when;"


def _accumulation(variables: Variables) -> Iterator[str]:
    """Yield the end of runs in which impacts accumulate: Modelica has no rest after them."""
    draft = variables.draft
    last, burst = _last(draft), _burst(draft)
    draft.declared += [
        f'discrete Real {last}(start = -1, fixed = true, unit = "s") '
        '"when an impact was last written";',
        f'Integer {burst}(start = 0, fixed = true) "impacts close to each other";',
    ]
    yield f'assert({burst} < {BURST}, "impacts accumulate here, and have no end in Modelica");'
    for m in draft.graph.machines:
        for k, fieldless in enumerate(m.fieldless):
            if fieldless:
                state = variables.state(m.index, k)
                stays = f"{state} and pre({draft.calm}) == {draft.settled}"
                said = f"{m.path} stays in {m.states[k]}, which holds at an instant only"
                yield f"assert(not ({stays} and time > {last}), {quoted(said)});"


def _last(draft: Draft) -> str:
    return draft.ids.of("last", "last_write")


def _burst(draft: Draft) -> str:
    return draft.ids.of("burst", "writes_in_burst")


def _near(draft: Draft) -> str:
    """Return the time within which impacts follow each other that accumulate."""
    until = until_of(draft.graph) or 1.0
    return number(float(f"{NEAR * until:.3g}"))


def _written(variables: Variables) -> str:
    """Return the condition that what a mode sets has been written, and is not set again.

    An impact must not act twice. A constraint may: then what rules read keeps to it to the last
    digit, whatever the integration leaves. Diodes must not see that, since what they block
    would be compared with what they held.
    """
    draft = variables.draft
    if any(m.law is not None for m in draft.graph.machines):
        return f"pre({draft.calm}) == {draft.settled}"
    at_once = [
        variables.state(m.index, k)
        for m in draft.graph.machines
        for k, fieldless in enumerate(m.fieldless)
        if fieldless
    ]
    if not at_once:
        return ""
    return f"pre({draft.calm}) == {draft.settled} and ({' or '.join(at_once)})"


def _smallest_impulse(draft: Draft) -> str:
    """Return a small part of what the least storage that jumps would hold of the energy."""
    graph = draft.graph
    terms, least = [], float("inf")
    for s in graph.storages:
        law = graph.nodes[s.node].law
        if law is None or law.matrix is None:
            continue
        stiff = abs(law.matrix[s.port][s.port])
        terms.append(f"{number(float(f'{stiff:.3g}'))}*{draft.stored(s.index)}^2")
        if s.index in draft.jumping:
            least = min(least, 1.0 / stiff)
    if not terms or least == float("inf"):
        return "0"
    kinds = {m.law.kind for m in graph.machines if m.law is not None}
    part = IMPULSE_OF_DIODES if kinds & {"diode", "thyristor"} else IMPULSE
    return f"{number(float(f'{part * least**0.5:.3g}'))}*sqrt({' + '.join(terms)})"
