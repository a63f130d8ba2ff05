"""A run, and what must be so of every run whatever the model is."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from hybond.errors import HybondError
from hybond.model.builder import Model
from hybond.result import Result
from hybond.simulation import simulate
from hybond.testing.recipe import Recipe
from hybond.testing.variants import Variant, renamed, reordered, turned

POINTS = 23
"""Times at which two runs are compared."""
NEAR = 1e-4
"""Points this close to an event, as a part of the run, are not compared: there a run differs from
one whose event is an instant later by the whole jump."""
SAME = 1e-6
"""How far two runs of the same equations may be apart."""
SOLVED = 1e-5
"""How far two methods may be apart."""
METHODS: dict[str, dict[str, Any]] = {
    "rk45": {"solver": "rk45"},
    "radau": {"solver": "radau"},
    "tight": {"rtol": 1e-11},
}
"""Other methods, and a tighter tolerance."""
WAYS = ("names", "order", "turned", *METHODS)
"""Ways to run a model of a recipe once more."""


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
    """

    kind: str
    said: str


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
        Seconds that a run may take; one that takes longer has the outcome ``"slow"``.

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
    return Check(first.word, tuple([*_by_itself(first), *_methods(model, first, until, patience)]))


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
        Seconds that a run may take.
    ways : sequence of str
        Of :data:`WAYS`, those in which it is run once more.
    """
    model = recipe.model()
    first = _outcome(model, recipe.until, patience)
    findings = _by_itself(first)
    variants: dict[str, Variant] = {
        "names": renamed(recipe),
        "order": reordered(recipe, seed),
        "turned": turned(recipe, seed),
    }
    for kind in (way for way in ways if way in variants):
        variant = variants[kind]
        other = _outcome(variant.recipe.model(), recipe.until, patience)
        findings += _differ(kind, first, other, variant.same, SAME)
    findings += _methods(model, first, recipe.until, patience, ways)
    return Check(first.word, tuple(findings))


def _outcome(model: Model, until: float, patience: float, **options: Any) -> Outcome:
    limit = time.monotonic() + patience

    def progress(_: float, __: int) -> None:
        if time.monotonic() > limit:
            raise _OutOfTime

    try:
        run = simulate(
            model, until, progress=progress, max_steps=200_000, max_events=20_000, **options
        )
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


def _by_itself(first: Outcome) -> list[Finding]:
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
    bonds = [f'"{b.name}".{letter}' for b in run.graph.bonds for letter in "ef"]
    times = np.linspace(0.0, run.t_end, POINTS).tolist()
    try:
        values = run.sample(times, [*run.names, *bonds])
    except HybondError as error:
        return [Finding("unread", f"{error}")]
    found = [
        Finding("not finite", name)
        for name, y in values.items()
        if not np.isfinite(np.asarray(y)).all()
    ]
    audit = run.audit()
    if any(" creates " in note for note in run.warnings):
        audit = replace(audit, created=0.0)  # the run says so itself, in joules
    # energies feel the error of all steps, as two methods do
    if not audit.holds(0.1 * SOLVED):
        found.append(Finding("audit", repr(audit)))
    return found


def _methods(
    model: Model, first: Outcome, until: float, patience: float, ways: Sequence[str] = WAYS
) -> list[Finding]:
    """Return what other methods, or tighter tolerances, make of it."""
    if first.word != "ok" or first.run is None:
        return []
    same = {name: (name, 1.0) for name in _stored(first.run)}
    found = []
    for kind in (way for way in ways if way in METHODS):
        other = _outcome(model, until, patience, **METHODS[kind])
        found += _differ(kind, first, other, same, SOLVED)
    return found


def _stored(run: Result) -> list[str]:
    names = [s.path for s in run.graph.storages]
    return [n for n in run.names if n in names]


def _differ(
    kind: str, one: Outcome, two: Outcome, same: Mapping[str, tuple[str, float]], most: float
) -> list[Finding]:
    """Return how two runs differ that should not."""
    if "slow" in (one.word, two.word) or not (one.unique and two.unique):
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
    times = times[near > NEAR * until]
    if not len(times):
        return []
    names = list(same)
    try:
        mine = one.run.sample(times, names)
        other = two.run.sample(times, [same[name][0] for name in names])
    except HybondError as error:
        return [Finding("unread", f"{error}")]
    for name in names:
        a = np.asarray(mine[name])
        b = same[name][1] * np.asarray(other[same[name][0]])
        held = max(_holds(one.run, name), _holds(two.run, same[name][0]))
        size = max(float(np.abs(a).max()), float(np.abs(b).max()), 0.01 * held)
        apart = np.abs(a - b)
        if float(apart.max()) > most * size:
            k = int(apart.argmax())
            text = f"{name} = {a[k]:.9g} or {b[k]:.9g} at t = {times[k]:.6g}"
            return [Finding(kind, text)]
    return []


def _holds(run: Result, name: str) -> float:
    """Return what of a stored quantity would hold about the largest energy of the run.

    At the least what it starts from: where that is lost at once, its rounding is left.
    """
    start = next(s.start for s in run.graph.storages if s.path == name)
    base, letter = name.rsplit(".", 1)
    both = run.sample(
        np.linspace(0.0, run.t_end, POINTS).tolist(),
        [name, base + (".e" if letter == "q" else ".f")],
    )
    x, z = (float(np.abs(y).max()) for y in both.values())
    most = float((2.0 * run.trace.energy * x / z) ** 0.5) if x > 0.0 and z > 0.0 else 0.0
    return max(most, abs(start))
