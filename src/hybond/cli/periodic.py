"""``hybond periodic``: a motion that repeats, or branches of them along a parameter."""

from __future__ import annotations

import sys
import time
from argparse import Namespace
from typing import Any

from hybond.cli.interrupt import Interruptible
from hybond.cli.lists import split
from hybond.cli.netlists import read_model
from hybond.cli.outputs import PICTURES
from hybond.cli.record import VERSION, to_json
from hybond.cli.running import tell_no_script
from hybond.cli.settings import changed_with
from hybond.cli.streams import complain, say
from hybond.cli.targets import check_target
from hybond.errors import UsageError
from hybond.progress import PATIENCE, Progress

LONG = 20.0
"""Seconds of one run, of which a search makes several, above which it is said early."""


def periodic(given: Namespace) -> int:
    """Find the orbit, or follow it; print it, or one JSON object; draw the plot asked for."""
    plot = check_target(given.plot, PICTURES, "--plot")
    model, parameters = changed_with(read_model(given.file)[0], given.settings)
    tell_no_script(model, "the model is run")
    options: dict[str, Any] = {
        "period": given.period,
        "multiple": given.multiple,
        "settle": given.settle,
        "parameters": parameters,
        "solver": given.solver,
        "rtol": given.rtol,
        "max_step": given.max_step,
    }
    signals = split(given.signals or [])
    bar = Runs()
    with Interruptible() as interruptible, bar:

        def progress(run: int, part: float, events: int) -> None:
            bar.shows(run, part, events)
            interruptible.check()

        found = _found(given, model, {**options, "progress": progress})
    if plot is not None:
        found.plot(*(signals[:1] if given.along is not None else signals), path=plot)
    if given.json:
        record: dict[str, Any] = {"hybond": VERSION, "model": model.name, "file": given.file}
        text = to_json({**record, **found.to_data()})
        given.json = False  # what fails from here on must not put a second object there
        sys.stdout.write(text)
        return 0
    say(str(found))
    if plot is not None:
        say(f"plot: {plot}")
    return 0


class Runs(Progress):
    """How far a search is: which run is under way, and how much of it is done.

    Of a run that will take long, as one of very many events does, it is said once, early.
    """

    def __init__(self, *, active: bool | None = None) -> None:
        super().__init__(1.0, active=active)
        self.run, self.told = 0, False

    def shows(self, run: int, part: float, events: int) -> None:
        """Show how far a run is."""
        now = time.monotonic()
        if run != self.run:
            self.run, self.begin = run, now
        took = now - self.begin
        if not self.told and took >= PATIENCE and 0.0 < part < 1.0 and took > part * LONG:
            self.told = True
            count = f", of {events / part:.1g} events" if events > part else ""
            complain(
                f"run {run} will take about {took / part:.0f} s{count}, and there will be several: "
                "is the period as long as that? --period says another one, --settle how long the "
                "first run is"
            )
        self(part, events)

    def words(self, t: float, events: int) -> str:
        """Return what stands behind the bar."""
        return f"run {self.run}  {events} events"


def _found(given: Namespace, model: Any, options: dict[str, Any]) -> Any:
    """Return the orbit, or the branch of them that was asked for."""
    if given.along is not None:
        return _along(given, model, options)
    for name in ("doublings", "points"):
        if getattr(given, name) is not None:
            raise _refusal(f"--{name} belongs to --along", f"--{name}")
    from hybond.analysis.periodic.periodic import periodic as orbit_of

    return orbit_of(model, wrt=split(given.wrt or []), **options)


def _along(given: Namespace, model: Any, options: dict[str, Any]) -> Any:
    from hybond.analysis.periodic.continuation import continuation

    if given.wrt:
        raise _refusal("--wrt does not go with --along", "--wrt")
    path, values = along_of(given.along)
    for name in ("doublings", "points"):
        if getattr(given, name) is not None:
            options[name] = getattr(given, name)
    return continuation(model, path, values, **options)


def _refusal(why: str, where: str, hint: str = "hybond periodic --help") -> UsageError:
    return UsageError(why, code="HB-X101", where=where, hint=hint)


def along_of(text: str) -> tuple[str, tuple[str, str]]:
    """Return the path and both ends of ``PATH=FROM..TO``; a unit may stand at one end.

    Raises
    ------
    UsageError
        HB-X101 for what is something else.

    Examples
    --------
    >>> along_of("D=0.3..0.7"), along_of("Vo = 3..7 V")
    (('D', ('0.3', '0.7')), ('Vo', ('3 V', '7 V')))
    """
    path, equals, span = (word.strip() for word in text.partition("="))
    first, dots, last = (word.strip() for word in span.partition(".."))
    if not (path and equals and first and dots and last):
        raise _refusal(f"{text!r} is no way along a parameter", "--along", "--along 'D=0.3..0.7'")
    unit = last.partition(" ")[2]
    if unit and " " not in first:
        first = f"{first} {unit}"
    return path, (first, last)
