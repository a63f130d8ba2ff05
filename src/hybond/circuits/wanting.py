"""What ``.meas`` and ``.step`` ask for in terms of the model: signals, times, values."""

from __future__ import annotations

import math
from collections.abc import Mapping

from hybond.circuits.deck import Deck
from hybond.circuits.measured import Moment, Time, Wanted
from hybond.circuits.measures import Crossing, Measure
from hybond.circuits.opened import Opened, global_value
from hybond.circuits.transient import NONE, StepLine
from hybond.circuits.woven import Woven
from hybond.model.expressions import Expr

MEMBERS = 100_000
"""Values of one ``.step``."""


def all_wanted(
    deck: Deck, woven: Woven, opened: Opened, names: Mapping[str, str]
) -> tuple[Wanted, ...]:
    """Return all measurements that there are in terms of the model."""
    kept = NONE if deck.transient is None else deck.transient.start
    found = (_wanted(one, woven, opened, names, kept) for one in deck.measures)
    return tuple(one for one in found if one is not None)


def _wanted(
    one: Measure, woven: Woven, opened: Opened, names: Mapping[str, str], kept: Expr
) -> Wanted | None:
    """Return a measurement in terms of the model; None if what it reads is not there.

    `kept` is from when on simulators keep what they compute: nothing before it is measured unless
    a time is written.

    Raises
    ------
    FileError
        HB-F131, HB-F134 (times that do not exist).
    """
    crossings = [c for c in (one.when, one.until) if c is not None]
    laws = [law for law in (one.law, *(c.law for c in crossings)) if law is not None]
    if any(law not in woven.laws for law in laws):
        return None

    def time(formula: Expr | None, default: float) -> Time:
        if formula is None:
            return default
        value = global_value(formula, opened, one.line)
        return value.formula if value.parametric else float(value.number)

    since = time(kept, -math.inf)

    def instant(crossing: Crossing | None) -> Moment | None:
        if crossing is None:
            return None
        signal = "" if crossing.law is None else woven.laws[crossing.law]
        after = time(crossing.after, 0.0)
        at = time(crossing.at, 0.0)
        return Moment(signal, crossing.edge, crossing.count, after, at, since)

    return Wanted(
        one.name,
        one.kind,
        "" if one.law is None else woven.laws[one.law],
        time(one.begin, -math.inf) if one.begin is not None else since,
        time(one.end, math.inf),
        instant(one.when),
        instant(one.until),
        one.formula,
        tuple((key, names.get(key, ""), value) for key, value in opened.values.items()),
    )


def values_of(step: StepLine, opened: Opened) -> tuple[float, ...]:
    """Return the values of a ``.step``.

    Raises
    ------
    FileError
        HB-F131, HB-F134, HB-F140 (a range that has no values).
    """
    numbers = [global_value(v, opened, step.line).number for v in step.values]
    if step.form == "list":
        return tuple(numbers)
    first, last, third = numbers
    if step.form == "lin":
        count = (last - first) / third if third else -1.0
        if not 0.0 <= count <= MEMBERS:
            raise _none(step)
        # the last one counts although its distance is rounded
        return tuple(first + k * third for k in range(math.floor(count * (1 + 1e-12) + 1e-9) + 1))
    base = 10.0 if step.form == "dec" else 2.0
    if not 0.0 < first <= last or not 1.0 <= third <= MEMBERS:
        raise _none(step)
    count = math.log(last / first, base) * third
    if count > MEMBERS:
        raise _none(step)
    return tuple(first * base ** (k / third) for k in range(math.floor(count + 1e-9) + 1))


def _none(step: StepLine) -> Exception:
    return step.line.refuse(
        "a range without values, or with too many", code="HB-F140", hint="first, last, distance"
    )
