"""Why the library stopped a run, as a refusal with its place and its remedy."""

from __future__ import annotations

from dataclasses import replace

from hybond.chronicle import Chronicle
from hybond.engine.compiled.refusal import Refusal
from hybond.engine.method_numbers import AUTO, MOREAU, RADAU
from hybond.engine.methods.implicit.stiffness import MOST_STATES
from hybond.engine.outcome.ever_faster import said_of_many
from hybond.engine.outcome.explain import Explaining
from hybond.engine.outcome.records import Instants
from hybond.engine.outcome.refusals import NO_VALUE, Said, said_of
from hybond.engine.outcome.starts import storage_at_start
from hybond.errors import (
    CausalityError,
    DivergenceOfTime,
    HybondError,
    ModelError,
    NumericsError,
)
from hybond.model.graph import FlatGraph, Mode, Node
from hybond.records import dataclass
from hybond.runs.trace import Event, Fired

HINTS = {
    "HB-C101": "put a resistor in series with a source of effort, beside one of flow",
    "HB-C103": "a controlled source prescribes what it also measures; add storage or resistance",
    "HB-C104": "two sources or switches leave nothing for the law to decide: look at what stands "
    "in parallel or in series with it",
    "HB-C105": "friction in two directions needs inertia at both of its junctions",
    "HB-J101": "wrap the factor in pre(...), or compare impulses directly",
    "HB-J102": 'add a resistor that decides it, or set indeterminate = "least leakage"',
    "HB-J103": "the slip would stop or turn round during the impact: add a state that sticks",
    "HB-J110": "friction of a rigid contact may leave none (Painleve): give the contact a "
    "stiffness, or a source a resistance",
    "HB-J120": "friction of a rigid contact may leave none (Painleve), and so do sources that "
    "push each other through diodes: give the contact a stiffness, a source a resistance",
    "HB-J112": "the laws are too many, or too near to singular ones, to try all their branches: "
    "give a contact a stiffness, or a source a resistance",
    "HB-J121": "the laws are too many, or too near to singular ones, to try all their branches: "
    "take another step, give a contact a stiffness, or a source a resistance",
    "HB-N310": "take a smaller step; a law with a jump of its own belongs into a machine",
    "HB-J111": "several answers may fit (Painleve), or values lie too far apart for the "
    "arithmetic: give contacts a stiffness, sources a resistance",
    "HB-J201": "choose poisson or lzb, which never do, or equal restitution",
    "HB-J202": "give them the same restitution, or choose lzb",
    "HB-J203": "give one of the bodies a finite mass, or open one of the contacts",
    "HB-J204": "use poisson, or a restitution of 0 instead of a very small one",
    "HB-J206": "an impact law takes masses as constant: give them linear laws",
    "HB-N201": "look for a state that grows without bound or a law with a jump inside; loosen the "
    "tolerances",
    "HB-N202": "look for a division by zero, a root or logarithm of a negative number, or an "
    "overflow in the laws that feed this state",
    "HB-N203": "look for what drives it there: a negative resistance (hybond check names it), a "
    "law that grows like exp() or sinh() under a flow that is given, or a state that nothing holds",
    "HB-N301": "look whether these laws can give what is asked of them; check them for jumps",
    "HB-N302": NO_VALUE,
    "HB-N303": "a controlled source opposes them, or storage is missing where one is closed",
    "HB-N304": "check the laws of storage and of sources for jumps or flat parts",
    "HB-N305": "look for a division by zero or a root of a negative number",
    "HB-N401": "make the guards of the cycle exclude each other for this state, for instance with "
    "a threshold on pre() of a stored quantity",
    "HB-N402": "an inelastic collapse: make the contact plastic below a speed; or raise "
    "max_writes, if each write moves less than the one before",
    "HB-N403": "its exit must be true for the state that the jump wrote, such as "
    "pre(a.f) <= pre(b.f) after an impact",
    "HB-N404": "look for chattering, or raise max_events",
    "HB-N405": "the surfaces touch or the switches cancel there; give the guards a hysteresis",
    "HB-N406": "what it compares is within rounding of its bound: let another guard lead on from "
    "there, or keep values that differ by many orders of magnitude apart",
    "HB-N407": "a size that is never below zero, and a breakaway of at least the limit",
    "HB-N408": "tighten rtol, or take solver = 'rk45'",
    "HB-N415": "give the comparator that switches it a band, y > 0.01 and y < -0.01, or run with "
    'sliding = "hysteresis" and its half width, hysteresis = 0.01',
    "HB-N417": 'run with sliding = "hysteresis" and its half width, hysteresis = 1e-3',
    "HB-N409": "leave out what is so fast, or raise max_steps",
}
SMALL_STEPS = ("HB-N201", "HB-N409")
KINDS: dict[str, type[HybondError]] = {
    "HB-C": CausalityError,
    "HB-J": ModelError,
    "HB-M": ModelError,
    "HB-N": NumericsError,
}
NUMERICS = (
    "HB-J110",
    "HB-J111",
    "HB-J112",
    "HB-J120",
    "HB-J121",
    "HB-J201",
    "HB-J203",
    "HB-J204",
    "HB-J206",
)


@dataclass(frozen=True, slots=True)
class Fault:
    """What the library says of the end of a run.

    Parameters
    ----------
    refusal : Refusal
    mode : Mode
        That was tried, or in which time passed.
    limits : dict
        Numbers of the run that it may have come up against, by the name of their option; when it
        was to end.
    method : int
        Of the run, as `hybond.engine.tables.options.METHODS` has it.
    """

    refusal: Refusal
    mode: Mode
    limits: dict[str, float]
    method: int


def error_of(
    fault: Fault,
    graph: FlatGraph,
    explain: Explaining,
    broken: tuple[Instants, int] | None,
    events: Chronicle[Event],
) -> HybondError:
    """Return a fault as a refusal; `broken` is the instant that could not be settled."""
    refusal = fault.refusal
    code = refusal.code
    kind = NumericsError if code in NUMERICS else KINDS.get(code[:4], NumericsError)
    here = graph.mode_text(fault.mode)
    now = f"at t = {refusal.t:.9g} s"
    said = Said(f"{refusal.why} {now}", refusal.place or here)
    match code:
        case "HB-J201" | "HB-J202" | "HB-J203":
            said = replace(said, where=_struck(graph, fault.mode) or said.where)
        case "HB-N401":
            cycle = _cycle(explain, broken)
            asked = _asked_for_more(graph, cycle, explain, broken)
            if asked:
                from hybond.engine.outcome.remedies import without_solution

                code = "HB-N301"
                why, hint = without_solution(graph, asked, refusal.t)
                said = Said(why, asked[0].path, hint)
            else:
                kind = DivergenceOfTime
                said = _cycle_said(fault, graph, cycle)
        case "HB-N302":
            at_rest = storage_at_start(graph) if refusal.t == 0.0 else None
            said = at_rest or said_of(refusal, graph, explain, fault.mode) or said
        case "HB-N303" if not graph.storages:
            said = Said(
                f"the sources and laws of this mode contradict each other {now}: no values meet "
                "them, and nothing is stored",
                refusal.place or here,
                "a controlled source that gives back all that it reads, as V = i*(1 [ohm]) beside "
                "1 ohm does, leaves nothing for the rest: change its gain, or add what is stored",
            )
        case "HB-N310":
            said = Said(f"the step that ends at t = {refusal.t:.9g} s does not converge", here)
        case "HB-N402":
            most = int(fault.limits["max_writes"])
            said = Said(f"{most} state writes {now} and still no mode to stay in", here)
        case "HB-N403":
            said = Said(
                f"the mode ({here}) holds at an instant only (one of its laws reads pre()) but no "
                f"guard leaves it {now}",
                here,
            )
        case "HB-N404":
            most = int(fault.limits["max_events"])
            why = f"more than {most} events by t = {refusal.t:.9g} s"
            if refusal.about:
                so_far, more = refusal.about
                why = f"{so_far:.0f} events by t = {refusal.t:.9g} s, and {more:.0e} to come"
            said = said_of_many(events, why, here, fault.limits["until"])
        case "HB-N409":
            most = int(fault.limits["max_steps"])
            mean = f", of {refusal.about[0]:.3g} s in the mean" if refusal.about else ""
            why = f"{most} steps without an event by t = {refusal.t:.9g} s{mean}"
            if len(refusal.about) > 1:
                many = int(refusal.about[1])
                why = f"steps lead nowhere from t = {refusal.t:.9g} s on: {many} of them{mean}"
            said = Said(why, here)
        case "HB-N417":
            port, *surfaces = [int(a) for a in refusal.about]
            laws = [w.node for m in graph.machines if m.law is not None for w in m.law.junctions]
            path = graph.nodes[laws[port]].path
            texts = ", ".join(explain.surfaces[k].text for k in surfaces)
            why = (
                f"to slide along {texts} {now} the law of {path!r} would have to carry, on the mean"
            )
            said = Said(
                f"{why} of fast switching, what it cannot, and no other way on was found", path
            )
        case _:
            said = said_of(refusal, graph, explain, fault.mode) or said
    hint = said.hint or HINTS.get(code, "")
    if code in SMALL_STEPS:
        hint += _for_stiff(fault.method, len(graph.storages) + len(graph.integrals))
        from hybond.engine.outcome.remedies import beside_flat_laws, beside_folds

        hint += beside_flat_laws(graph) + beside_folds(graph)
    elif code == "HB-N304":
        from hybond.engine.outcome.remedies import beside_folds

        hint += beside_folds(graph)
    elif code in ("HB-N404", "HB-N406") and fault.method not in (AUTO, RADAU, MOREAU):
        # at the edge of stability an explicit step leads to and fro across a guard
        hint += "; solver = 'auto' if the model is stiff"
    return kind(said.why, code=code, where=said.where, hint=hint)


def _for_stiff(method: int, states: int) -> str:
    """Return what else to try against small steps, if another solver may help."""
    if method == AUTO and states > MOST_STATES:
        return f"; solver = 'radau' if the model is stiff: 'auto' leaves {states} states to rk45"
    if method in (AUTO, RADAU):
        return ""
    if method == MOREAU:
        return "; a longer step takes fewer"
    return "; solver = 'auto' if the model is stiff"


def _struck(graph: FlatGraph, mode: Mode) -> str:
    """Return the contacts that an impact is about: those that are closed in the mode tried."""
    pairs = zip(graph.machines, mode, strict=True)
    return ", ".join(m.path for m, k in pairs if m.law is not None and not m.law.two_sided and k)


Cycle = list[tuple[Mode, tuple[Fired, ...]]]
"""Modes that follow each other, each with what led to it."""


def _cycle(explain: Explaining, broken: tuple[Instants, int] | None) -> Cycle:
    """Return the modes of an instant without end from one to the same again; none if unknown."""
    if broken is None:
        return []
    found, k = broken
    mode = found.before(k)
    visited: Cycle = [(mode, ())]
    for v in range(int(found.visit[k]), int(found.visit[k + 1])):
        mode = explain.entered(found, v, mode)
        visited.append((mode, explain.fired(found, v)))
    modes = [m for m, _ in visited]
    period = _period(modes)
    # the library finds a cycle some rounds after it has begun
    begin = len(modes) - 1 - period
    while begin > 0 and modes[begin - 1] == modes[begin - 1 + period]:
        begin -= 1
    visited = visited[begin : begin + period + 1]
    visited[0] = (visited[0][0], ())
    return visited


def _asked_for_more(
    graph: FlatGraph, cycle: Cycle, explain: Explaining, broken: tuple[Instants, int] | None
) -> list[Node]:
    """Return the resistors whose pieces alone follow each other, where an end leaves them open.

    What a source and such an end both give has no solution. Where nothing is left open there is
    one, and it is the steps that do not tell the end from the law before it.
    """
    fired = {f.machine for _, all_fired in cycle for f in all_fired}
    if broken is None or not all(m.pieces for m in graph.machines if m.path in fired):
        return []
    found, k = broken
    visits = range(int(found.visit[k]), int(found.visit[k + 1]))
    free = {n for v in visits for n in explain.nodes_open(found, v)}
    return [n for n in graph.nodes if n.path in fired and n.index in free]


def _cycle_said(fault: Fault, graph: FlatGraph, cycle: Cycle) -> Said:
    """Tell the modes that follow each other, each with what led to it."""
    all_fired = [f for _, fired in cycle for f in fired]
    focus = {f.machine for f in all_fired}
    lines = []
    for mode, fired in cycle:
        why = "; ".join(_fired_text(f) for f in fired)
        lines.append(f"({graph.mode_text(mode, focus)})" + (f" by {why}" if why else ""))
    why = (
        f"time cannot advance at t = {fault.refusal.t:.9g} s: the modes "
        + " -> ".join(lines)
        + " follow each other without end"
    )
    last = cycle[-1][0] if cycle else fault.mode
    return Said(why, graph.mode_text(last, focus), _levels(all_fired) if cycle else "")


def _levels(fired: list[Fired]) -> str:
    """Return what helps where guards follow each other that hold at once, for the same values."""
    values: dict[str, float] = {}
    for f in fired:
        if f.impulses or any(values.setdefault(k, a) != a for k, a in f.values.items()):
            return ""
    if not values or len(fired) != 2 or fired[0].machine != fired[1].machine:
        return ""
    back, again = fired[0].guard, fired[1].guard
    if back == again:
        return (
            "guards are levels, and one holds both ways at once: let it lead to states of their "
            f"own, left when not ({again})"
        )
    again = f"({again})" if " or " in again else again
    return (
        "guards are levels, and these hold at once: write "
        f"{again} and not ({back}), or lead on to a state of its own"
    )


def _period(modes: list[Mode]) -> int:
    """Return how many modes before the last it was there before."""
    for period in range(1, len(modes)):
        if modes[-1] == modes[-1 - period]:
            return period
    return len(modes) - 1


def _fired_text(fired: Fired) -> str:
    values = ", ".join(
        f"{k} = {fired.impulses[k]:.6g} δ" if k in fired.impulses else f"{k} = {a:.6g}"
        for k, a in fired.values.items()
    )
    return f"{fired.machine}: {fired.guard}" + (f" [{values}]" if values else "")
