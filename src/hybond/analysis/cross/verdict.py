"""From differences at ever finer steps to a verdict: agree, differ legitimately, differ."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from hybond.analysis.cross.reasons import Reason
from hybond.analysis.cross.runs import Difference
from hybond.result import Result
from hybond.units import format_quantity

Verdict = Literal["agree", "differ legitimately", "undecided", "differ"]

EXACT = 1e-6
"""Mean difference that need not shrink any more."""
SHRINKS = 0.8
"""Factor by which a difference shrinks at least from level to level."""
LONGER = 1.3
"""Factor by which runs are alike for longer at the last level than at the first."""


@dataclass(frozen=True, slots=True)
class Level:
    """Two runs at one step, or one tolerance."""

    value: float
    """The step in s, or the relative tolerance."""
    mean: float
    """The mean difference of the worst quantity, as a part of the largest value it has."""
    name: str
    """That quantity."""
    order: float | None
    """Observed: of the step by which the difference has shrunk since the level before."""
    since: float | None
    """From when on the runs are further apart than the tolerance, s; away from events."""


def level_of(value: float, kept: Sequence[Difference], before: Sequence[Level]) -> Level:
    """Return how far two runs are apart by the worst quantity; `kept` has the worst first."""
    mean, name = (kept[0].mean, kept[0].quantity.name) if kept else (0.0, "")
    order = None
    if before and before[-1].mean > 0.0 and mean > 0.0 and value != before[-1].value:
        order = math.log(before[-1].mean / mean) / math.log(before[-1].value / value)
    since = min((d.since for d in kept if d.since is not None), default=None)
    return Level(value, mean, name, order, since)


def agreed(found: Sequence[Level], limit: float) -> bool:
    """Whether the difference is small, and shrinks or is next to nothing.

    Where in its step an impact falls is chance, so that a single halving need not shrink it.
    """
    last = found[-1].mean
    return last <= limit and (last <= EXACT or shrinks(found))


def shrinks(found: Sequence[Level]) -> bool:
    """Whether the mean difference shrinks from level to level, a little at least."""
    before = max(v.mean for v in found[:-1])
    return found[-1].mean <= SHRINKS ** (len(found) - 1) * before


def lasts(found: Sequence[Level]) -> bool:
    """Whether the runs are alike for longer the finer they are, as where small errors grow."""
    first, last = found[0].since, found[-1].since
    return first is not None and (last is None or last > LONGER * first)


def hopeful(found: Sequence[Level], limit: float) -> bool:
    """Whether finer runs may still agree."""
    return found[-1].mean <= limit or shrinks(found) or lasts(found)


def verdict_of(
    found: Sequence[Level],
    limit: float,
    kept: Sequence[Difference],
    known: tuple[Reason, ...],
    runs: tuple[Result, Result],
    refined: str,
) -> tuple[Verdict, str]:
    """Return the verdict on the last level, and in words.

    Parameters
    ----------
    limit : float
        Mean difference up to which runs agree.
    kept : sequence of Difference
        At the last level, the worst first.
    known : tuple of Reason
        A reason counts only if it holds where the difference begins.
    runs : tuple of Result
        At the last level.
    refined : {"step", "rtol"}
    """
    last = found[-1]
    step = last.value if refined == "step" else 0.0
    short = next((r for r in runs if r.error is not None), None)
    at = f"{refined} = {format_quantity(last.value, 's' if refined == 'step' else '')}".strip()
    if short is None and agreed(found, limit):
        text = f"{last.mean:.2g} of the largest value on average ({last.name or 'nothing'}, {at})"
        stopped = [r for r in known if r.name == "a run that stopped"]
        if stopped:
            return "differ legitimately", f"{stopped[0].text}; up to there {text}"
        return "agree", text
    if short is not None and short.error is not None:
        # only a problem without an answer, or with several, may stop one run and not the other
        stops = f"{short.solver} stops at t = {short.t_end:.9g} s: {short.error.why}"
        several = [r for r in known if r.name == "several solutions"]
        return (
            ("differ legitimately", f"{several[0].name}: {stops}") if several else ("differ", stops)
        )
    since = min((d.since for d in kept if d.since is not None), default=None)
    if since is None:
        # apart around events only, or everywhere by little: from where it is most
        since = kept[0].time if kept else 0.0
    text = (
        f"{last.mean:.2g} of the largest value of {last.name} on average, from t = {since:.6g} s on"
        f" ({at})"
    )
    valid = [r for r in known if r.since <= since + 2.0 * step]
    if valid:
        return "differ legitimately", f"{', '.join(r.name for r in valid)}: {text}"
    if shrinks(found) and last.mean > limit:
        return "undecided", f"{text}; it shrinks with the {refined}, but is not small yet"
    if lasts(found):
        first = found[0].since
        return "undecided", f"{text}; from t = {first:.6g} s on at first: small errors grow here"
    return "differ", text
