"""A run, and what must be so of every run whatever the model is."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from hybond.engine.outcome.audit import Audit
from hybond.equations.storage import stiffness_along
from hybond.errors import HybondError
from hybond.model.builder import Model
from hybond.result import Result
from hybond.simulation import simulate
from hybond.testing.recipe import Recipe
from hybond.testing.variants import Variant, nudged, renamed, reordered, turned

POINTS = 23
"""Times at which two runs are compared."""
NEAR = 1e-4
"""Points this close to an event, as a part of the run, are not compared: there a run differs from
one whose event is an instant later by the whole jump."""
SAME = 1e-6
"""How far two runs of the same equations may be apart."""
SOLVED = 1e-5
"""How far two methods may be apart."""
MOVED = 1e-7
"""How far numbers of a model may be off: ten times the tolerance of a run."""
METHODS: dict[str, dict[str, Any]] = {
    "rk45": {"solver": "rk45"},
    "radau": {"solver": "radau"},
    "tight": {"rtol": 1e-11},
}
"""Other methods, and a tighter tolerance."""
BY_TOLERANCE = 1e-2
"""How far apart two runs may be by errors that fall with the tolerance: thousands of steps along
the hard spring of a light mass add up."""
FALLS = 3.0
"""How much less of such an error a tenth of the tolerance leaves, at the least."""
UNFINISHED = ("slow", "HB-N409")
"""Outcomes that only say that a run took more time, or more steps, than it is given here."""
WAYS = ("names", "order", "turned", *METHODS)
"""Ways to run a model of a recipe once more."""
FURTHER_METHODS: dict[str, dict[str, Any]] = {"exact": {"solver": "exact"}, "last": {"keep": 3}}
FURTHER_WAYS = (*FURTHER_METHODS, "halves")
"""More of them: linear modes propagated, the last segments kept, interrupted and gone on with."""
INTERRUPTED = 0.41
"""The part of a run after which it is interrupted."""


class _OutOfTime(Exception):
    """A run takes longer than it may."""


@dataclass(frozen=True)
class Outcome:
    """How a run ended.

    Parameters
    ----------
    word : str
        ``"ok"``, another status, the code of a refusal, ``"slow"`` or the name of an exception.
    run : Result or None
        What was computed.
    said : str
        The message of what ended it, if anything did.
    unique : bool
        Whether the run says of no instant that it had several answers.
    """

    word: str
    run: Result | None = None
    said: str = ""
    unique: bool = True


@dataclass(frozen=True)
class Finding:
    """Something that must not be.

    Parameters
    ----------
    kind : str
        ``"traceback"``, ``"refusal"`` (one without place or remedy), ``"unsound"``,
        ``"not finite"``, ``"audit"``, ``"unread"`` (values of a run that is there are refused),
        or the variant that differs: ``"names"``, ``"order"``, ``"turned"``, ``"rk45"``,
        ``"radau"``, ``"tight"``.
    said : str
        What was seen.
    apart : float
        How far what is stored is apart in two runs, as a part of its size.
    """

    kind: str
    said: str
    apart: float = 0.0


@dataclass(frozen=True)
class Check:
    """What was found of one model: how its run ended, and what must not be."""

    outcome: str
    findings: tuple[Finding, ...]

    @property
    def holds(self) -> bool:
        """Whether nothing was found."""
        return not self.findings


def check_model(model: Model, until: float, *, patience: float = 5.0) -> Check:
    """Run a model, and look at what must be so of any.

    The run ends, or is refused with a code, a reason and a remedy; its values are finite, laws
    put back into themselves hold, power and energy balance, and other methods and a tighter
    tolerance move what is stored as it does.

    Parameters
    ----------
    model : Model
        Any model.
    until : float
        How long the run is, s.
    patience : float
        Seconds of processor time that a run may take; one that takes longer has the outcome
        ``"slow"``.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("rc")
    >>> m.add(c=hb.C(1.0, q=1.0), r=hb.R(2.0), node=hb.Zero())
    >>> m.bond("node -> c", "node -> r")
    >>> check_model(m, 1.0)
    Check(outcome='ok', findings=())
    """
    first = _outcome(model, until, patience)
    found = [*_by_itself(first, model, until, patience), *_methods(model, first, until, patience)]
    return Check(first.word, tuple(found))


def check_recipe(
    recipe: Recipe, *, seed: int = 0, patience: float = 5.0, ways: Sequence[str] = WAYS
) -> Check:
    """Check the model of a recipe, and that names, order and arrows of bonds do not matter.

    Parameters
    ----------
    recipe : Recipe
        A graph as plain data.
    seed : int
        Which order, and which bonds are turned.
    patience : float
        Seconds of processor time that a run may take.
    ways : sequence of str
        Of :data:`WAYS` and :data:`FURTHER_WAYS`, those in which it is run once more.
    """
    model = recipe.model()
    first = _outcome(model, recipe.until, patience)
    findings = _by_itself(first, model, recipe.until, patience)
    if first.word in UNFINISHED:  # nothing is held against it
        return Check(first.word, tuple(findings))
    variants: dict[str, Variant] = {
        "names": renamed(recipe),
        "order": reordered(recipe, seed),
        "turned": turned(recipe, seed),
    }
    found = []
    for kind in (way for way in ways if way in variants):
        variant = variants[kind]
        other = _outcome(variant.recipe.model(), recipe.until, patience)
        found += _differ(kind, first, other, variant.same, SAME)
    found += _methods(model, first, recipe.until, patience, ways)
    if any(finding.apart for finding in found):
        moves = _moves(recipe, seed, patience)
        found = [f for f in found if not 0.0 < f.apart <= moves]
        found = [f for f in found if not _by_tolerance(f, model, recipe.until, patience)]
    return Check(first.word, (*findings, *found))


def _moves(recipe: Recipe, seed: int, patience: float) -> float:
    """Return how far all numbers of a model, moved by `MOVED`, move what is stored.

    Found at the tighter tolerance, so that it is the model that moves it and not the method. A
    mass that a source throws against a hard spring again and again forgets where it came from: of
    that no two runs agree, and none is wrong.
    """
    other = nudged(recipe, seed, MOVED)
    tight = {**METHODS["tight"], "max_steps": 2_000_000}
    one, two = (_outcome(r.model(), r.until, 4.0 * patience, **tight) for r in (recipe, other))
    same = {name: (name, 1.0) for name in recipe.stored}
    return max((f.apart for f in _differ("tight", one, two, same, 0.0)), default=0.0)


def _by_tolerance(finding: Finding, model: Model, until: float, patience: float) -> bool:
    """Whether two runs are apart by errors of their methods that fall with the tolerance.

    Both are held against the tighter run, and so are the same two at a tenth of their tolerance.
    An event that one of them misses does not fall: it is there or it is not.
    """
    if not 0.0 < finding.apart <= BY_TOLERANCE:
        return False
    more = {"max_steps": 2_000_000}
    tight = _outcome(model, until, 8.0 * patience, **METHODS["tight"], **more)
    if tight.run is None:
        return False
    same = {name: (name, 1.0) for name in _stored(tight.run)}
    other = METHODS.get(finding.kind, {})
    for settings in ({}, other if "rtol" not in other else {}):
        errors = []
        for rtol in (1e-8, 1e-9):
            run = _outcome(model, until, 4.0 * patience, **settings, rtol=rtol, **more)
            if run.word != "ok":
                return False
            parts = _differ("tight", run, tight, same, 0.0)
            errors.append(max((f.apart for f in parts), default=0.0))
        # of the two, one may have erred by next to nothing from the beginning
        if errors[0] > SOLVED and errors[1] > max(errors[0], finding.apart) / FALLS:
            return False
    return True


def _outcome(model: Model, until: float, patience: float, **options: Any) -> Outcome:
    limit = time.process_time() + patience

    def progress(_: float, __: int) -> None:
        if time.process_time() > limit:
            raise _OutOfTime

    try:
        limits = {"max_steps": 200_000, "max_events": 20_000}
        run = simulate(model, until, progress=progress, **(limits | options))
    except _OutOfTime:
        return Outcome("slow")
    except HybondError as error:
        partial = error.partial
        told = f"{error}" if error.why and error.hint and error.code else f"bare: {error}"
        return Outcome(error.code, partial, told, _unique(partial))
    except Exception as error:  # whatever it is: that it came is what is told
        return Outcome(type(error).__name__, None, repr(error)[:300])
    return Outcome(run.status, run, "", _unique(run))


def _unique(run: Result | None) -> bool:
    return run is None or not any(
        " answers: " in note or "is not unique: " in note for note in run.warnings
    )


def _by_itself(first: Outcome, model: Model, until: float, patience: float) -> list[Finding]:
    """Return what is wrong with a run without looking at others."""
    if first.word == "HB-N411":
        return [Finding("unsound", first.said)]
    if first.word == "HB-X001" or (first.run is None and first.said and first.word[:3] != "HB-"):
        return [Finding("traceback", first.said)]
    if first.said.startswith("bare"):
        return [Finding("refusal", first.said)]
    if first.run is None or first.word != "ok":
        return []
    run = first.run
    # the switch of a controlled junction or element is not in the text: its bond has no name there
    unnamed = {end.bond for node in run.graph.nodes if node.hidden for end in node.ends}
    named = [b.name for b in run.graph.bonds if b.index not in unnamed]
    bonds = [f'"{name}".{letter}' for name in named for letter in "ef"]
    times = np.linspace(0.0, run.t_end, POINTS).tolist()
    try:
        values = run.sample(times, [*run.names, *bonds])
        audit = run.audit()  # it integrates powers over the steps
    except HybondError as error:
        return [Finding("unread", f"{error}")]
    found = [
        Finding("not finite", name)
        for name, y in values.items()
        if not np.isfinite(np.asarray(y)).all()
    ]
    if any(" creates " in note for note in run.warnings):
        audit = replace(audit, created=0.0)  # the run says so itself, in joules
    # energies feel the error of all steps, as two methods do
    if not audit.holds(0.1 * SOLVED) and not _energy_by_tolerance(audit, model, until, patience):
        found.append(Finding("audit", repr(audit)))
    return found


def _energy_by_tolerance(audit: Audit, model: Model, until: float, patience: float) -> bool:
    """Whether nothing but the energy does not balance, by an error that falls with the tolerance.

    A tolerance counts for what is stored by the size that it lately had. What follows a source with
    a thousandth of that, and lets much pass by small differences, has a thousandth of its digits. A
    law that is lost on the way is lost at any tolerance.
    """
    rest = replace(audit, energy=0.0)
    if not rest.holds(0.1 * SOLVED) or not audit.energy <= BY_TOLERANCE:
        return False
    before = audit.energy
    for rtol in (1e-9, 1e-10):
        closer = _outcome(model, until, 4.0 * patience, max_steps=2_000_000, rtol=rtol)
        if closer.word != "ok" or closer.run is None:
            return False
        try:
            energy = closer.run.audit().energy
        except HybondError:
            return False
        if energy > max(before / FALLS, SOLVED):
            return False  # what is no more than that is not looked at in any run
        before = energy
    return True


def _methods(
    model: Model, first: Outcome, until: float, patience: float, ways: Sequence[str] = WAYS
) -> list[Finding]:
    """Return what other methods, or tighter tolerances, make of it."""
    if first.word != "ok" or first.run is None:
        return []
    same = {name: (name, 1.0) for name in _stored(first.run)}
    found = []
    methods = METHODS | FURTHER_METHODS
    for kind in (way for way in ways if way in methods):
        other = _outcome(model, until, patience, **methods[kind])
        if other.word == "HB-N404" and "solver = 'auto'" in other.said:
            continue  # what is stiff led it to and fro across a guard: it says who follows that
        found += _differ(kind, first, other, same, SOLVED)
    if "halves" in ways:
        half = _outcome(model, INTERRUPTED * until, patience)
        if half.word not in ("ok", *UNFINISHED):
            found += _differ("halves", first, half, same, SOLVED)
        elif half.word == "ok":
            other = _outcome(model, until, patience, start=half.run)
            found += _differ("halves", first, other, same, SOLVED)
    return found


def _begin(run: Result) -> float:
    """Return the first time of which there are values."""
    return float(run.segments[0].t[0]) if run.segments else run.t_begin


def _stored(run: Result) -> list[str]:
    names = [s.path for s in run.graph.storages]
    return [n for n in run.names if n in names]


def _differ(
    kind: str, one: Outcome, two: Outcome, same: Mapping[str, tuple[str, float]], most: float
) -> list[Finding]:
    """Return how two runs differ that should not, by the stored quantity that does so most."""
    if not {one.word, two.word}.isdisjoint(UNFINISHED) or not (one.unique and two.unique):
        return []
    if one.word != two.word:
        return [Finding(kind, f"{one.word} or {two.word}: {two.said or one.said}")]
    if one.run is None or two.run is None or one.word != "ok" or not same:
        return []
    until = one.run.t_end
    events = np.array([e.t for run in (one.run, two.run) for e in run.trace.events])
    # irrational parts of the run, so that no point is an instant that a model is likely to name
    times = np.sort(np.mod(np.arange(1, POINTS + 1) * 0.6180339887498949, 1.0)) * until
    near = np.abs(times[:, None] - events[None, :]).min(axis=1, initial=np.inf)
    begin = max(_begin(one.run), _begin(two.run))
    near = near[times > begin]
    times = times[times > begin]
    held = near > NEAR * until
    if not held.any():
        return []
    names = list(same)
    others = [same[name][0] for name in names]
    try:
        mine = one.run.sample(times.tolist(), names)
        other = two.run.sample(times.tolist(), others)
        sizes = dict(zip(names, _sizes(one.run, names), strict=True))
        other_sizes = _sizes(two.run, others)
    except HybondError as error:
        return [Finding("unread", f"{error}")]
    found: list[Finding] = []
    for name, own in zip(names, other_sizes, strict=True):
        a = np.asarray(mine[name])
        b = same[name][1] * np.asarray(other[same[name][0]])
        # what friction has nearly brought to rest has been larger between its events
        size = max(float(np.abs(a).max()), float(np.abs(b).max()), 0.01 * max(own, sizes[name]))
        apart = np.where(held, np.abs(a - b), 0.0)
        if float(apart.max()) > most * size:
            k = int(apart.argmax())
            text = f"{name} = {a[k]:.9g} or {b[k]:.9g} at t = {times[k]:.6g}"
            found.append(Finding(kind, text, float(apart[k]) / size))
    return [max(found, key=lambda finding: finding.apart)] if found else []


def _sizes(run: Result, names: Sequence[str]) -> list[float]:
    """Return of each stored quantity what would hold about the largest energy of the run.

    By the slope of its law where the run goes, not by its values, which may be rounding; at the
    least what it starts from: where that is lost at once, its rounding is left.
    """
    storages = run.graph.storages
    times = np.linspace(_begin(run), run.t_end, POINTS).tolist()
    values = run.sample(times, [s.path for s in storages])
    x = np.array([values[s.path] for s in storages])
    steepest = stiffness_along(run.graph, x.T).diagonal(axis1=1, axis2=2).max(axis=0)
    # of a motion from rest no instant has seen the energy
    moving = (float(np.abs(run.signals.stored(s.y)).max()) for s in run.segments if len(s.y))
    energy = max(run.trace.energy, *moving)
    sizes = {}
    for s, slope in zip(storages, steepest.tolist(), strict=True):
        most = (2.0 * energy / slope) ** 0.5 if slope > 0.0 else 0.0
        sizes[s.path] = max(most, abs(s.start))
    return [sizes[name] for name in names]
