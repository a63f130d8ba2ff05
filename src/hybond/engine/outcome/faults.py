"""Why the library stopped a run, as a refusal with its place and its remedy."""

from __future__ import annotations

from dataclasses import dataclass

from hybond.causality.assign import assign
from hybond.causality.explain import describe_conflict
from hybond.engine.outcome.explain import Explaining
from hybond.engine.outcome.records import Instants
from hybond.errors import (
    CausalityError,
    DivergenceOfTime,
    HybondError,
    ModelError,
    NumericsError,
)
from hybond.model.graph import FlatGraph, Mode
from hybond.trace import Fired

HINTS = {
    "HB-C101": "put a resistor between them, or change the rule that switches them together",
    "HB-C104": "two sources or switches leave nothing for the law to decide: look at what stands "
    "in parallel or in series with it",
    "HB-C105": "friction in two directions needs inertia at both of its junctions",
    "HB-J101": "wrap the factor in pre(...), or compare impulses directly",
    "HB-J102": 'add a resistor that decides it, or set indeterminate = "least leakage"',
    "HB-J103": "the slip would stop or turn round during the impact: add a state that sticks",
    "HB-J110": "friction of a rigid contact may leave none (Painleve): give the contact a "
    "stiffness, or a source a resistance",
    "HB-J111": "several answers may fit (Painleve), or values lie too far apart for the "
    "arithmetic: give contacts a stiffness, sources a resistance",
    "HB-J201": "choose poisson or lzb, which never do, or equal restitution",
    "HB-J202": "give them the same restitution, or choose lzb",
    "HB-J203": "give one of the bodies a finite mass, or open one of the contacts",
    "HB-J204": "use poisson, or a restitution of 0 instead of a very small one",
    "HB-J206": "an impact law takes masses as constant: give them linear laws",
    "HB-N201": "look for a state that grows without bound or a law with a jump inside; loosen the "
    "tolerances, or use solver 'radau' if the model is stiff",
    "HB-N202": "look for a division by zero, a root or logarithm of a negative number, or an "
    "overflow in the laws that feed this state",
    "HB-N301": "check these laws for jumps or missing slopes; start closer to a solution",
    "HB-N302": "look for a division by zero, a root of a negative number or a table that ends",
    "HB-N303": "a controlled source opposes them, or storage is missing where one is closed",
    "HB-N304": "check the laws of storage and of sources for jumps or flat parts",
    "HB-N305": "look for a division by zero or a root of a negative number",
    "HB-N401": "make the guards of the cycle exclude each other for this state, for instance with "
    "a threshold on pre() of a stored quantity",
    "HB-N402": "an inelastic collapse: make the contact plastic below a speed",
    "HB-N403": "its exit must be true for the state that the jump wrote, such as "
    "pre(a.f) <= pre(b.f) after an impact",
    "HB-N404": "look for chattering, or raise max_events",
    "HB-N405": "the surfaces touch or the switches cancel there; give the guards a hysteresis",
    "HB-N406": "what it compares is within rounding of its bound: let another guard lead on from "
    "there, or keep values that differ by many orders of magnitude apart",
    "HB-N407": "a size that is never below zero, and a breakaway of at least the limit",
    "HB-N408": "tighten rtol, or take solver = 'rk45'",
    "HB-N409": "a model as stiff as that wants solver = 'auto' or 'radau'; else raise max_steps",
}
OPPOSED = "give the flow of a source another way, or the source a resistance"
KINDS: dict[str, type[HybondError]] = {
    "HB-C": CausalityError,
    "HB-J": ModelError,
    "HB-M": ModelError,
    "HB-N": NumericsError,
}
NUMERICS = ("HB-J110", "HB-J111", "HB-J201", "HB-J203", "HB-J204", "HB-J206")


@dataclass(frozen=True, slots=True)
class Fault:
    """What the library says of the end of a run.

    Parameters
    ----------
    code, why, place : str
    t : float
        s.
    mode : Mode
        That was tried, or in which time passed.
    limits : dict
        Numbers of the run that it may have come up against, by the name of their option.
    """

    code: str
    why: str
    place: str
    t: float
    mode: Mode
    limits: dict[str, float]


def error_of(
    fault: Fault, graph: FlatGraph, explain: Explaining, broken: tuple[Instants, int] | None
) -> HybondError:
    """Return a fault as a refusal; `broken` is the instant that could not be settled."""
    kind = NumericsError if fault.code in NUMERICS else KINDS.get(fault.code[:4], NumericsError)
    here = graph.mode_text(fault.mode)
    now = f"at t = {fault.t:.9g} s"
    why, where = f"{fault.why} {now}", fault.place or here
    hint = HINTS.get(fault.code, "")
    match fault.code:
        case "HB-C101":
            # the value that differs is found again by the chains of causality
            why = " ".join([f"{fault.why} {now}.", *_conflicts(graph, fault.mode)])
            where = here
        case "HB-J101":
            why = fault.why
            where = f"{_owner(graph, fault.place)} {now}"
        case "HB-J102":
            why = f"{_guard(explain, fault)} in mode ({here})"
            where = f"{_owner(graph, fault.place)} {now}"
        case "HB-J110":
            opposed = _conflicts(graph, fault.mode)
            why = " ".join([f"the laws of {fault.place} have no solution {now}.", *opposed])
            why, where = why.rstrip("."), here
            hint = OPPOSED if opposed else hint
        case "HB-J201" | "HB-J202" | "HB-J203":
            where = _struck(graph, fault.mode) or where
        case "HB-N201":
            blame = f"; {fault.place} dominates the error" if fault.place else ""
            why = f"step size underflow {now}: no step is small enough{blame}"
        case "HB-N202":
            blame = f" of {fault.place}" if fault.place else ""
            why = f"the derivative{blame} is not finite near t = {fault.t:.9g} s"
        case "HB-N301":
            why = f"the laws of {fault.place} have no solution near the last one {now}"
            where = here
        case "HB-N401":
            kind = DivergenceOfTime
            why, where = _cycle(fault, graph, explain, broken), here
        case "HB-N402":
            most = int(fault.limits["max_writes"])
            why = f"{most} state writes {now} and still no mode to stay in"
        case "HB-N403":
            why = (
                f"the mode ({here}) holds at an instant only (one of its laws reads pre()) but no "
                f"guard leaves it {now}"
            )
        case "HB-N404":
            why = f"more than {int(fault.limits['max_events'])} events by t = {fault.t:.9g} s"
        case "HB-N409":
            most = int(fault.limits["max_steps"])
            why = f"{most} steps without an event by t = {fault.t:.9g} s"
    return kind(why, code=fault.code, where=where, hint=hint)


def _conflicts(graph: FlatGraph, mode: Mode) -> list[str]:
    base = tuple(0 if m.law is not None else k for m, k in zip(graph.machines, mode, strict=True))
    return [describe_conflict(graph, base, c) for c in assign(graph, base).conflicts]


def _struck(graph: FlatGraph, mode: Mode) -> str:
    """Return the contacts that an impact is about: those that are closed in the mode tried."""
    pairs = zip(graph.machines, mode, strict=True)
    return ", ".join(m.path for m, k in pairs if m.law is not None and not m.law.two_sided and k)


def _owner(graph: FlatGraph, text: str) -> str:
    """Return the machine that has a rule of this text; the text itself if none has."""
    return next((m.path for m in graph.machines for r in m.rules if r.text == text), text)


def _guard(explain: Explaining, fault: Fault) -> str:
    read = explain.open_reads(fault.place)
    return f"the guard {fault.place!r} reads {read}, which the equations leave open"


def _cycle(
    fault: Fault,
    graph: FlatGraph,
    explain: Explaining,
    broken: tuple[Instants, int] | None,
) -> str:
    """Return the modes that follow each other, each with what led to it."""
    lines: list[str] = []
    if broken is not None:
        found, k = broken
        mode = found.before(k)
        visited: list[tuple[Mode, tuple[Fired, ...]]] = [(mode, ())]
        for v in range(int(found.visit[k]), int(found.visit[k + 1])):
            mode = explain.entered(found, v, mode)
            visited.append((mode, explain.fired(found, v)))
        visited = visited[-_period([m for m, _ in visited]) - 1 :]
        visited[0] = (visited[0][0], ())
        focus = {f.machine for _, fired in visited for f in fired}
        for mode, fired in visited:
            why = "; ".join(_fired_text(f) for f in fired)
            lines.append(f"({graph.mode_text(mode, focus)})" + (f" by {why}" if why else ""))
    return (
        f"time cannot advance at t = {fault.t:.9g} s: the modes "
        + " -> ".join(lines)
        + " follow each other without end"
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
