"""Holds a run of the package against one of the dense oracle, event by event."""

from __future__ import annotations

import numpy as np
from dense_events import Run
from event_nets import model
from hybrid_models import Hybrid, Outcome

import hybond as hb

CODES = {
    "cycle": {"HB-N401"},
    "sources": {"HB-C101"},
    "undetermined": {"HB-J102"},
    "none": {"HB-J110", "HB-J111", "HB-C101"},
}
"""What the package says where the model has no run."""
TOL = 1e-8


def library(h: Hybrid, until: float, solver: str = "rk45") -> hb.Result:
    """Return the package's run by its compiled library; with an error, what there is of it."""
    return hb.simulate(
        model(h), until=until, solver=solver, rtol=1e-11, engine="library", on_error="return"
    )


def differences(h: Hybrid, until: float = 2.0, solver: str = "rk45") -> tuple[list[str], Outcome]:
    """Return how the package's run differs from the oracle's, in words, and the oracle's."""
    want = Run(h, until).run()
    run = library(h, until, solver)
    return list(_differences(h, want, run)), want


def _differences(h: Hybrid, want: Outcome, run: hb.Result):
    net = h.net
    index = {s.path: s.index for s in run.graph.storages}
    order = [index[n + (".q" if net.nodes[n][0] == "C" else ".p")] for n in net.of("C", "I")]
    integrals = len(order)
    states = [m.states for m in run.graph.machines]
    place = {m.path: m.index for m in run.graph.machines}
    machines = [place[m.name] for m in h.machines]
    laws = [place[name] for name in h.laws]
    code = getattr(run.error, "code", None)
    if want.stop in CODES:
        if code not in CODES[want.stop]:
            yield f"stops: {want.stop} at {want.t}, found {code or run.status} at {run.t_end}"
        elif abs(run.t_end - want.t) > TOL:
            yield f"stops: {want.stop} at {want.t}, found at {run.t_end}"
    elif want.stop == "end" and (code or run.status != "ok"):
        yield f"ends: {code or run.status} at {run.t_end}: {run.error}"
    events = _settled(h, list(run.trace.events), run.t_end)
    if want.stop != "end":
        events = events[: len(want.events)]
    for k, (a, b) in enumerate(zip(want.events, events, strict=False)):
        here = f"event {k} at {a.t:.9g}: "
        if abs(a.t - b.t) > TOL:
            yield here + f"time {b.t!r}"
            return
        size = 1.0 + np.abs(a.before).max(initial=0.0) + np.abs(a.after).max(initial=0.0)
        for word, mine, its in (("before", a.before, b.before), ("after", a.after, b.after)):
            got = np.concatenate([its[order], its[integrals:]])
            if np.abs(mine - got).max(initial=0.0) > TOL * size:
                yield here + f"{word} {mine} found {got}"
                return
        mine = [(v.mode, v.kind) for v in a.visits]
        its = [(tuple(states[m][s.mode[m]] for m in machines), s.kind) for s in b.steps]
        if h.laws:
            # within one mode of the machines the package may show branches of the jump on its own
            mine = [
                m for k, m in enumerate(mine) if m[0] not in [n for n, _ in mine[k + 1 : k + 2]]
            ]
            its = [m for k, m in enumerate(its) if m[0] not in [n for n, _ in its[k + 1 : k + 2]]]
        if mine != its:
            yield here + f"modes {mine} found {its}"
            return
        if len(a.visits) != len(b.steps):
            continue
        for v, s in zip(a.visits, b.steps, strict=True):
            found = {(f.machine, f.source, f.target) for f in s.fired if f.machine not in h.laws}
            if set(v.fired) != found:
                yield here + f"fired {v.fired} found {found}"
            if v.branches and v.kind != "mythical" and not v.several:
                got = tuple(states[m][s.mode[m]] for m in laws)
                if got != v.branches:
                    yield here + f"branches {v.branches} found {got}"
            yield from (here + d for d in _impulses(h, v, s, size))
            if s.energy is not None and v.kind != "mythical":
                e = s.energy
                big = 1.0 + abs(v.before) + abs(v.after) + abs(v.supplied)
                for word, x, y in (
                    ("before", v.before, e.before),
                    ("after", v.after, e.after),
                    ("supplied", v.supplied, e.source),
                    ("lost", v.lost, e.lost),
                ):
                    if abs(x - y) > TOL * big:
                        yield here + f"energy {word} {x} found {y}"
    if len(want.events) != len(events):
        late = (events[len(want.events) :] or want.events[len(events) :])[0]
        yield f"{len(want.events)} events, found {len(events)}; the first extra at {late.t}"
    elif want.end is not None and run.status == "ok":
        last = run.trace.segments[-1].y[-1]
        got = np.concatenate([last[order], last[integrals : integrals + len(h.integrals)]])
        if np.abs(want.end - got).max(initial=0.0) > TOL * (1.0 + np.abs(want.end).max(initial=0)):
            yield f"end {want.end} found {got}"


def _settled(h: Hybrid, events: list, end: float) -> list:
    """Leave out events in which branches that carry nothing change their names.

    They stand within the tolerance of location after another event, where a rate of higher order
    than the first decides, and at the end of a run.
    """
    kept: list = []
    for e in events:
        by_law = all(f.machine in h.laws for s in e.steps for f in s.fired)
        moved = np.abs(e.after - e.before).max(initial=0.0) > TOL
        near = bool(kept) and (e.t - kept[-1].t < 1e-10 or e.t == end)
        if not (by_law and near and not moved):
            kept.append(e)
    return kept


def _impulses(h: Hybrid, v, s, size: float):
    """Compare impulses of one-ports and junctions' common variables, by name."""
    net = h.net
    nb = len(net.bonds)
    if not v.jump.any() and not s.impulses:
        return
    for name, (kind, _) in net.nodes.items():
        ends = net.ends(name)
        if kind in ("TF", "GY") or not ends:
            continue
        for quantity, shift in (("e", 0), ("f", nb)):
            key = f"{name}.{quantity}"
            if kind in ("0", "1"):
                if (quantity == "e") == (kind == "0"):
                    mine = v.impulses[ends[0][0] + shift]
                elif name in net.controlled:
                    mine = sum(sign * v.impulses[b + shift] for b, sign, _ in ends)
                else:
                    continue
            else:
                mine = v.impulses[ends[0][0] + shift]
            its = s.impulses.get(key, 0.0)
            if abs(mine - its) > TOL * size:
                yield f"impulse of {key}: {mine} found {its}"
