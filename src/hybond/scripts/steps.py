"""Scripts: what a run does step after step, as on a test rig."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field
from typing import Any

from hybond.calls import fits
from hybond.errors import UsageError
from hybond.model.parts import Value
from hybond.names import did_you_mean
from hybond.options import seconds
from hybond.records import dataclass
from hybond.runs.ends import Until
from hybond.runs.times import is_condition

MOST = 10_000
"""Steps of a script, those that are repeated counted as often."""
KEYS = ("label", "set", "until", "lasts", "repeat", "steps")
"""What a step of a file says."""


@fits('hb.Step(until="1 s", set={"V": "24 V"})')
@dataclass(frozen=True, slots=True)
class Step:
    """One step of a script.

    Parameters
    ----------
    until : float, str or list
        When it ends: a time since the start of the run, a condition, or both, whatever is first.
    lasts : float or str
        How long it lasts at the most, s or a quantity.
    set : mapping
        Parameters, values of elements and inputs from its beginning on, by path.
    label : str
        What events and plots call it.
    repeat : int
        How often it is done.
    steps : sequence of Step
        In place of an end: what is done in it, one after the other, each time.

    Examples
    --------
    >>> Step(lasts="50 ms", set={"V": "24 V"}, label="on")
    Step(until=None, lasts='50 ms', set={'V': '24 V'}, label='on', repeat=1, steps=())
    """

    until: Until = None
    lasts: float | str | None = None
    set: Mapping[str, Value] = field(default_factory=dict)
    label: str = ""
    repeat: int = 1
    steps: Sequence[Step] = ()


def steps_of(listed: Any, where: str = "steps") -> tuple[Step, ...]:
    """Return the steps of a script, as `Step` or as tables of a file, looked through.

    Raises
    ------
    UsageError
        HB-S140 for what is no step.

    Examples
    --------
    >>> steps_of([{"lasts": "1 s", "set": {"V": "24 V"}}])[0].set
    {'V': '24 V'}
    """
    if not isinstance(listed, list | tuple) or not listed:
        raise _wrong(where, f"{listed!r} is no list of steps", 'hb.Step(lasts="1 s")')
    return tuple(_step(item, f"{where}[{k}]") for k, item in enumerate(listed))


def _step(item: Any, where: str) -> Step:
    if isinstance(item, Mapping):
        for key in item:
            if key not in KEYS:
                hint = did_you_mean(str(key), KEYS)
                raise _wrong(where, f"a step has no {key!r}", hint or ", ".join(KEYS))
        item = Step(**item)
    if not isinstance(item, Step):
        raise _wrong(where, f"{item!r} is no step", 'hb.Step(lasts="1 s")')
    if not isinstance(item.set, Mapping) or not isinstance(item.label, str):
        raise _wrong(where, "its set maps paths to values, its label is a text", "")
    if not isinstance(item.repeat, int) or isinstance(item.repeat, bool) or item.repeat < 1:
        raise _wrong(where, f"repeat = {item.repeat!r}", "a whole number, one or more")
    ends = item.until is not None or item.lasts is not None
    if item.steps:
        if ends:
            raise _wrong(where, "it has steps, and an end of its own", "end the steps in it")
        inner = steps_of(item.steps, f"{where}.steps")
        return Step(set=item.set, label=item.label, repeat=item.repeat, steps=inner)
    if not ends:
        raise _wrong(where, "nothing ends it", 'until="1 s", until="v.f < 0" or lasts="50 ms"')
    listed = item.until if isinstance(item.until, list | tuple) else [item.until]
    times = [u for u in listed if u is not None and not is_condition(u)]
    if len(times) > 1:
        raise _wrong(where, f"until = {listed!r} has {len(times)} times", "one, and conditions")
    for time in times:
        seconds(time, f"{where}.until")
    if item.lasts is not None and not seconds(item.lasts, f"{where}.lasts") > 0.0:
        raise _wrong(where, f"lasts = {item.lasts!r}", "a time above zero")
    return item


def _wrong(where: str, why: str, hint: str) -> UsageError:
    return UsageError(f"the script makes no sense: {why}", code="HB-S140", where=where, hint=hint)


def unrolled(steps: Sequence[Step]) -> Iterator[Step]:
    """Yield the steps in the order in which they are done; what a group sets is with its first.

    Raises
    ------
    UsageError
        HB-S140 for more than `MOST`.

    Examples
    --------
    >>> on, off = Step(lasts=1, label="on"), Step(lasts=2, label="off")
    >>> [s.label for s in unrolled([Step(repeat=2, steps=(on, off))])]
    ['on', 'off', 'on', 'off']
    """
    if _many(steps) > MOST:
        raise _wrong("steps", f"more than {MOST} steps are to be done", "repeat fewer of them")
    for step in steps:
        for _ in range(step.repeat):
            if not step.steps:
                yield step
                continue
            for k, inner in enumerate(unrolled(step.steps)):
                if k == 0 and (step.set or (step.label and not inner.label)):
                    inner = Step(
                        inner.until,
                        inner.lasts,
                        {**step.set, **inner.set},
                        inner.label or step.label,
                    )
                yield inner


def places_of(steps: Sequence[Step], where: str) -> Iterator[str]:
    """Yield where the steps stand that `unrolled` yields.

    Examples
    --------
    >>> on, off = Step(lasts=1, label="on"), Step(lasts=2, label="off")
    >>> list(places_of([Step(repeat=2, steps=(on, off)), on], "script"))[2:]
    ['script[0].steps[0]', 'script[0].steps[1]', 'script[1]']
    """
    for k, step in enumerate(steps):
        place = f"{where}[{k}]"
        for _ in range(step.repeat):
            yield from places_of(step.steps, f"{place}.steps") if step.steps else (place,)


def _many(steps: Sequence[Step]) -> int:
    return sum(s.repeat * (_many(s.steps) if s.steps else 1) for s in steps)


def conditions_of(step: Step) -> tuple[str, ...]:
    """Return the conditions that end a step."""
    listed = step.until if isinstance(step.until, list | tuple) else [step.until]
    return tuple(dict.fromkeys(u for u in listed if isinstance(u, str) and is_condition(u)))


def latest_end(step: Step, begin: float, limit: float | None) -> float | None:
    """Return when a step that begins at a time ends at the latest, s; None if nothing says so.

    Parameters
    ----------
    limit : float or None
        When the whole script ends, s.

    Raises
    ------
    UsageError
        HB-S106 for what is no time.

    Examples
    --------
    >>> latest_end(Step(until=["v.f < 0", "3 s"], lasts="1 s"), 1.0, None)
    2.0
    """
    listed = step.until if isinstance(step.until, list | tuple) else [step.until]
    ends = [seconds(u, "until") for u in listed if u is not None and not is_condition(u)]
    if step.lasts is not None:
        ends.append(begin + seconds(step.lasts, "lasts"))
    if limit is not None:
        ends.append(limit)
    return min(ends) if ends else None
