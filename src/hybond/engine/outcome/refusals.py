"""Refusals in words, by their code, made of the numbers that the library knows of them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping

from hybond.causality.record import Conflict
from hybond.engine.compiled.refusal import Refusal
from hybond.engine.outcome.closing import against_closing, against_stopping
from hybond.engine.outcome.explain import Explaining
from hybond.engine.outcome.sides import machine_instead
from hybond.equations.calculus import localised, reads_bonds
from hybond.equations.element_parts import sends_impulses
from hybond.model.expressions import Call, Expr, jumping
from hybond.model.expressions.tree import walk
from hybond.model.graph import FlatGraph, Mode
from hybond.model.inputs import Called
from hybond.model.kinds import RESISTORS, SOURCES
from hybond.records import dataclass

NO_ELEMENT, OVERFLOW = -1, -2
"""In place of an element: as in `hybond.engine.reasons.facts`."""
TIMES = 100
"""Instants in a row without any change that end a run."""
NO_VALUE = "look for a division by zero, a root of a negative number or a table that ends"
TO_SLIDE = (
    "where sign(), or if/else, should hold what it switches: a junction with "
    "law = 'coulomb' or 'relay', or a machine with a controlled junction, which slides"
)
"""What to do about a jump inside a law that would slide."""
ON_PAIRS = ("abs", "sign", "hypot", "min", "max")
"""Functions that have a meaning for impulses."""


@dataclass(frozen=True, slots=True)
class Said:
    """What a refusal says: why, where, and what to try unless that is always the same."""

    why: str
    where: str
    hint: str = ""


@dataclass(frozen=True, slots=True)
class Case:
    """A refusal, with what words are taken from; `mode` is the one that was tried."""

    refusal: Refusal
    graph: FlatGraph
    explain: Explaining
    mode: Mode

    @property
    def numbers(self) -> list[int]:
        """What is known, in whole numbers; 0 for what is none."""
        return [int(a) if math.isfinite(a) else 0 for a in self.refusal.about]

    @property
    def now(self) -> str:
        """When it was."""
        return f"at t = {self.refusal.t:.9g} s"

    @property
    def here(self) -> str:
        """The mode that was tried."""
        return self.graph.mode_text(self.mode)

    def given_mode(self) -> tuple[Mode, tuple[float, ...]]:
        """Return the mode that what is known begins with, and what follows."""
        many = len(self.graph.machines)
        return tuple(self.numbers[:many]), self.refusal.about[many:]

    def paths(self, nodes: list[int]) -> str:
        """Return the paths of elements."""
        return ", ".join(self.graph.nodes[k].path for k in nodes)

    def component(self, k: int) -> str:
        """Return the path of a state."""
        storages = self.graph.storages
        return (
            storages[k].path if k < len(storages) else self.graph.integrals[k - len(storages)].path
        )


def said_of(refusal: Refusal, graph: FlatGraph, explain: Explaining, mode: Mode) -> Said | None:
    """Return what a refusal says; None if no more is known of it than its reason and place."""
    words = WORDS.get(refusal.code)
    if words is None or (refusal.code not in NO_NUMBERS and not refusal.about):
        return None
    return words(Case(refusal, graph, explain, mode))


def _conflicts(graph: FlatGraph, mode: Mode) -> tuple[Conflict, ...]:
    from hybond.causality.assign import assign

    return assign(graph, mode).conflicts


def _in_words(graph: FlatGraph, mode: Mode, conflicts: Iterable[Conflict]) -> str:
    from hybond.causality.explain import describe_conflict

    return " ".join(describe_conflict(graph, mode, c) for c in conflicts)


def _base_mode(graph: FlatGraph, mode: Mode) -> Mode:
    from hybond.causality.orientation import base_mode

    return base_mode(graph, mode)


def _sources(c: Case) -> Said:
    from hybond.causality.explain import join, unjoined
    from hybond.engine.outcome.remedies import against_conflict, as_diodes

    mode, (difference, *pairs) = c.given_mode()
    columns = sorted(zip(pairs[::2], pairs[1::2], strict=True))
    nodes = [c.graph.nodes[int(node)] for _, node in columns]
    names = " and ".join(f"{n.kind} {n.path}" for n in nodes)
    conflicts = _conflicts(c.graph, mode)
    ends = [n for conflict in conflicts for n in unjoined(c.graph, conflict)]
    if len(nodes) == 1 and ends:
        path, passes = ends[0].path, "flow" if ends[0].kind == "0" else "effort"
        why = f"nothing is joined to {path}, so that no {passes} passes"
        why += f", but {names} gives {difference:.6g} there"
    elif len(nodes) == 1:
        why = f"{names} is shorted or cut off by what holds zero, but gives {difference:.6g} there"
    else:
        why = f"{names} prescribe the same variable and differ by {difference:.6g}"
    chains = _in_words(c.graph, mode, conflicts)
    hint = against_conflict(nodes, "; switches: " in chains)
    hint += as_diodes(c.graph, conflicts)
    hint = f"{join(ends)}; or {hint}" if ends else hint
    return Said(f"{why} {c.now}. {chains}".removesuffix(". "), c.graph.mode_text(mode), hint)


def _too_high(c: Case) -> Said:
    return Said(c.refusal.why, c.here)


def _tied(c: Case) -> Said:
    path = c.refusal.place
    why = f"the law of {path} is tied to a constraint that holds in every mode"
    return Said(why, c.graph.mode_text(_base_mode(c.graph, c.mode)))


def _slip(c: Case) -> Said:
    path = c.refusal.place
    return Said(f"the slip of {path} is not determined by what is stored", path)


def _meaningless(c: Case) -> Said:
    what = c.refusal.why.removesuffix(" at a jump").removesuffix(" has no meaning")
    why = f"{what} has no meaning at a jump"
    number = c.numbers[0]
    if number < 0:
        return Said(why, f"signals.{c.refusal.place} {c.now}")
    rule, machine = c.explain.rule(number), c.explain.machine_of(number)
    name = _function(rule.guard)
    if name:
        why = why.replace("a function of an impulse", f"{name}() of an impulse")
    return Said(f"{why} (in the guard {rule.said!r})", f"{machine.path} {c.now}")


def _function(guard: Expr) -> str:
    """Return the function that an expression calls, if it is one."""
    called = {e.function for e, _ in walk(guard) if isinstance(e, Call)} - {*ON_PAIRS}
    return called.pop() if len(called) == 1 else ""


def _open(c: Case) -> Said:
    rule, when, *free = c.numbers
    place = c.explain.machine_of(rule).path if rule >= 0 else c.refusal.place
    return Said(c.explain.guard_on_open(rule, when, free, c.mode), f"{place} {c.now}")


def _impulsive(c: Case) -> Said:
    path = c.refusal.place
    kind = next(n.kind for n in c.graph.nodes if n.path == path)
    why = f"the impulsive law of {kind} {path} multiplies an impulse by a factor that the jump"
    return Said(f"{why} {c.now} changes", path)


NOT_FOUND = "have no solution that was found, which does not say that there is none,"


def _no_branches(c: Case) -> Said:
    from hybond.engine.outcome.remedies import against_no_branches

    finite, *taking = c.numbers
    ports = [law.node for m in c.graph.machines if m.law is not None for law in m.law.junctions]
    # where none may be ON, what keeps them OFF leaves no answer
    laws = [ports[k] for k in taking] or ports
    names = c.paths(laws)
    base = _base_mode(c.graph, c.mode)
    opposed = _in_words(c.graph, base, _conflicts(c.graph, base))
    what = "finite values" if finite else "impulses"
    none = "have no solution" if c.refusal.code == "HB-J110" else NOT_FOUND
    why = f"the {what} of {names} {none} {c.now}. {opposed}".removesuffix(" ")
    hint = against_no_branches(c.graph, base, laws) if c.refusal.code == "HB-J110" else ""
    return Said(why.rstrip("."), c.here, hint)


def _no_branches_stand(c: Case) -> Said:
    tried = [f"{c.explain.machine_of(k).path}: {c.explain.rule(k).text}" for k in c.numbers]
    why = f"no branches of the junction laws stand {c.now}"
    if tried:
        return Said(f"{why}: {'; '.join(tried)}", c.here)
    paths = ", ".join(m.path for m in c.graph.machines if m.law is not None)
    return Said(f"{why}, of {paths}: what one asks of the next leads back to it", c.here)


def _no_end(c: Case) -> Said:
    ports = [law.node for m in c.graph.machines if m.law is not None for law in m.law.junctions]
    names = c.paths([ports[k] for k in c.numbers] or ports)
    none = "have no solution" if c.refusal.code == "HB-J120" else NOT_FOUND
    now = f"the step that ends at t = {c.refusal.t:.9g} s"
    return Said(f"the laws of {names} {none} in {now}", c.here)


def _too_small(c: Case) -> Said:
    h, k, *settles = c.refusal.about
    path = c.component(int(k)) if k >= 0 else ""
    blame = f"; {path} dominates the error" if path else ""
    why = f"step size underflow {c.now}: h = {h:.3g} s is still too large{blame}"
    closing = against_stopping(c.graph, path.rpartition(".")[0])
    called = [i.path for i in c.graph.inputs if isinstance(i.waveform, Called)]
    if not settles and called:
        hint = "look for a state that grows without bound or a law with a jump inside; give "
        hint += f"`breaks` to {', '.join(called)}, of which only values are known, where it jumps"
        return Said(why, path or c.here, hint)
    if not settles:
        return Said(why, path or c.here, closing)
    # a step is no shorter than ten last places of the time
    hint = (
        f"{path} settles within {settles[0]:.1g} s, but numbers of the time are {0.1 * h:.1g} s "
        "apart there: leave out what is so small, the storage, or what resists its change (without "
        "that it jumps); or let this happen sooner: nearer to t = 0 time is told apart more finely"
    )
    return Said(why, path, f"{closing}; else {hint}" if closing else hint)


def _no_rate(c: Case) -> Said:
    h, k = c.refusal.about
    path = c.component(int(k)) if k >= 0 else ""
    blame = f" of {path}" if path else ""
    size = f", h = {h:.3g} s" if h else ""
    why = f"the derivative{blame} is not finite near t = {c.refusal.t:.9g} s{size}"
    return Said(why, path or c.here)


def _no_solution(c: Case) -> Said:
    from hybond.engine.outcome.remedies import without_solution

    mode, nodes = c.given_mode()
    # a two-port has two laws, of efforts and of flows
    elements = list(dict.fromkeys(int(k) for k in nodes))
    if not elements:
        why = "what is stored and what sources give have no common solution that was found "
        hint = "look at sources that read what they prescribe, and at laws of storage that jump"
        return Said(f"{why}(t = {c.refusal.t:.9g} s)", c.graph.mode_text(mode), hint)
    why, hint = without_solution(c.graph, [c.graph.nodes[k] for k in elements], c.refusal.t)
    return Said(why, c.graph.mode_text(mode), hint)


def _guard_without_value(c: Case) -> Said:
    number = c.numbers[0]
    hint = "give it a value there ('if ... then ... else'), or ask before it: 'x > 0 and y/x > 1'"
    if number < 0:
        why = f"what the signal integrates is not a number {c.now}"
        return Said(why, f"signals.{c.refusal.place}")
    rule, machine = c.explain.rule(number), c.explain.machine_of(number)
    return Said(
        f"the guard {rule.said!r} compares what is not a number {c.now}", machine.path, hint
    )


def _no_value(c: Case) -> Said:
    if len(c.numbers) == 1:
        return _guard_without_value(c)
    mode, (element, value) = c.given_mode()
    here = c.graph.mode_text(mode)
    if element == OVERFLOW:
        return Said(
            f"the equations overflow {c.now}", here, "look at the last values of the partial result"
        )
    what = "has no finite slope" if math.isfinite(value) else f"gives {value}"
    if element == NO_ELEMENT:
        return Said(f"the law of a constraint's derivative {what} {c.now}", here)
    node = c.graph.nodes[int(element)]
    why = f"the law of {node.kind} {node.path} {what} {c.now}"
    closing = "" if math.isfinite(value) else against_closing(c.graph, [node])
    return Said(why, node.path, f"{NO_VALUE}; {closing}" if closing else "")


def _no_jump(c: Case) -> Said:
    why, where = f"{c.refusal.why} {c.now}", c.graph.mode_text(c.given_mode()[0])
    sources: list[str] = []
    bends: list[str] = []
    for n in c.graph.nodes:
        if n.law is None or n.law.matrix is not None or n.kind not in (*SOURCES, *RESISTORS):
            continue
        laws = localised(n, n.law.expressions)
        if n.kind in RESISTORS or any(reads_bonds(e) for e in laws):
            (sources if sends_impulses(n, laws) else bends).append(n.path)
    if c.refusal.code != "HB-N303" or not sources or not bends:
        return Said(why, where)
    hint = f"`impulsive = false` at {' or '.join(sources)}, if it is finite in jumps: the law of "
    hint += f"{' or '.join(bends)} takes no impulse; else storage or a linear resistance there"
    return Said(why, where, hint)


def _no_sample(c: Case) -> Said:
    k, value = c.refusal.about
    path = c.graph.integrals[int(k)].path
    return Said(f"{path} samples {value} {c.now}", f"signals.{path}")


def _nowhere(c: Case) -> Said:
    texts = ", ".join(c.explain.surfaces[k].text for k in c.numbers)
    if c.refusal.why.startswith("the state"):
        why = f"it would take a jump of what is stored to slide along {texts} {c.now}"
        hint = "what makes it jump without an event: give inputs their `breaks`; where what is "
        hint += "compared comes to zero together with its rate, run with sliding = 'hysteresis'"
        return Said(why, c.here, hint)
    why = f"no combination of the modes stays on {texts} {c.now}"
    if len(c.numbers) > 1:
        return Said(why, c.here)
    return Said(
        why,
        c.here,
        "both sides move along the surface there, as where switchings came ever faster to a point "
        "(super-twisting control): give the guards a band, such as 1e-6, or run with "
        'sliding = "hysteresis" and its half width, hysteresis = 1e-6',
    )


def _beyond(c: Case) -> Said:
    variable, level = c.refusal.about
    bonds = c.graph.bonds
    effort = variable < len(bonds)
    bond = bonds[int(variable) % len(bonds)]
    size = f"{abs(level):.6g}" if math.isfinite(level) else "no number any more"
    why = f"the {'effort' if effort else 'flow'} of bond {bond.name!r} is beyond all bounds"
    return Said(f"{why}, {size}, {c.now}", c.here)


def _in_vain(c: Case) -> Said:
    why = f"a guard holds {TIMES} times in a row {c.now}, and nothing changes"
    return Said(why, ", ".join(c.explain.rule(k).text for k in c.numbers) or c.here)


def _limits(c: Case) -> Said:
    number, limit, breakaway = c.refusal.about
    path = c.graph.machines[int(number)].path
    if c.refusal.why.startswith("friction breaks loose"):
        why = f"friction breaks loose at {breakaway:.6g} and slides with {limit:.6g} {c.now}"
        return Said(why, path, "a breakaway of at least the limit")
    why = f"the limit of the friction is {min(limit, breakaway):.6g} {c.now}: it would push"
    return Said(why, path, "a size: abs(...), or the other sign of the force that it follows")


def _restitution(c: Case) -> Said:
    number, eps = c.refusal.about
    path = c.graph.machines[int(number)].path
    told = "no number" if math.isnan(eps) else f"{eps:.6g}"
    return Said(
        f"the restitution of {path!r} is {told} in the impact {c.now}",
        f"elements.{path}.restitution",
        "0 (plastic) to 1 (elastic); min() and max() bound an expression",
    )


def _restless(c: Case) -> Said:
    machine, *surfaces = c.numbers
    path = c.graph.machines[machine].path
    texts = ", ".join(c.explain.surfaces[k].text for k in surfaces)
    why = "is in another state after each turn of that fast switching: it has no limit"
    if c.refusal.why.endswith("surface"):
        why = "moves what another machine compares: no mode of the combination says on which side"
        why += " of that the motion is"
    return Said(
        f"the motion slides along {texts} {c.now}, and {path!r}, which follows, {why}",
        f"machines.{path}",
    )


def _gap(c: Case) -> Said:
    port, opening, closing = c.refusal.about
    laws = [law for m in c.graph.machines if m.law is not None for law in m.law.junctions]
    node = c.graph.nodes[laws[int(port)].node]
    net = f"{node.path}.{'f' if node.kind == '0' else 'e'}"
    return Said(
        f"the gap of {node.path!r} is not the distance that its bonds close: where "
        f"-{net} = {-closing:.6g} the gap changes by {opening:.6g} per second",
        f"elements.{node.path}.gap",
        f"the gap must grow at the rate -{net}: look at its sign, at the arrows of the bonds, and "
        "at what else moves",
    )


def _slides_on(c: Case) -> Said:
    endless, *machines = c.numbers
    where = ", ".join(c.graph.machines[k].path for k in machines)
    if not endless:
        return Said(f"no step follows the slip {c.now}", where)
    return Said(
        f"the end of this slip is not found, from t = {c.refusal.t:.9g} s on",
        where,
        "what drives it is within a hair of the limit, or a law has no value near rest",
    )


def _rate_jumps(c: Case) -> Said:
    if not c.numbers:
        return _switches_back(c)
    (signal,) = c.numbers
    path = c.graph.integrals[signal].path
    why = f"the rate of {path!r} jumps and switches back at once, again and again {c.now}"
    return Said(
        why,
        path,
        "let the rate read the state of a machine with these conditions as its guards, which "
        'slides: if limit.state == "high" then 0 else ...; or take control.pi_clamped'
        + _here(c, path),
    )


def _here(c: Case, path: str) -> str:
    """Return the machine that would slide here, behind what is said of all."""
    found = machine_instead(c.graph, path)
    return found and f". Here {found}"


def _switches_back(c: Case) -> Said:
    """Return what a law does that jumps, or is as steep as a jump where it is read backwards."""
    path = c.refusal.place
    from hybond.engine.outcome.remedies import is_flat, of_law_that_jumps

    if hint := of_law_that_jumps(c.graph, path, c.refusal.why):
        return Said(f"{c.refusal.why} {c.now}", path, hint)
    nodes = [n for n in c.graph.nodes if n.path == path and n.law is not None]
    jumps = any(jumping(e) for n in nodes if n.law for e in n.law.expressions)
    if not nodes or (jumps and not any(is_flat(n) for n in nodes)):
        return Said(f"{c.refusal.why} {c.now}", path, TO_SLIDE + _here(c, path))
    return Said(
        f"the law of {path} is flat where what it reads is zero, so that what the rest gives it "
        f"decides along a line as steep as a jump, again and again {c.now}",
        path,
        "what it has beside it in reality: a capacitance or a resistance across a law of a flow, "
        "in series with a law of an effort; of varistors electrical.varistor",
    )


WORDS: Mapping[str, Callable[[Case], Said]] = {
    "HB-C101": _sources,
    "HB-C103": _too_high,
    "HB-C104": _tied,
    "HB-C105": _slip,
    "HB-J101": _meaningless,
    "HB-J102": _open,
    "HB-J103": _impulsive,
    "HB-J110": _no_branches,
    "HB-J111": _no_branches_stand,
    "HB-J112": _no_branches,
    "HB-J120": _no_end,
    "HB-J121": _no_end,
    "HB-N201": _too_small,
    "HB-N202": _no_rate,
    "HB-N203": _beyond,
    "HB-N301": _no_solution,
    "HB-N302": _no_value,
    "HB-N303": _no_jump,
    "HB-N304": _no_jump,
    "HB-M205": _gap,
    "HB-N305": _no_sample,
    "HB-N405": _nowhere,
    "HB-N406": _in_vain,
    "HB-N407": _limits,
    "HB-N408": _slides_on,
    "HB-N410": _rate_jumps,
    "HB-N412": _restitution,
    "HB-N415": _restless,
}
NO_NUMBERS = (
    "HB-C103",
    "HB-C104",
    "HB-C105",
    "HB-J103",
    "HB-J111",
    "HB-J120",
    "HB-J121",
    "HB-N303",
    "HB-N304",
    "HB-N406",
    "HB-N410",
)
"""What may be known of these is nothing, or their reason and place are enough."""
