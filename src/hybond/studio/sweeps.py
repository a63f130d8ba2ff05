"""Sweeps of the page: one parameter over a range, its curves as a family, modes as a map."""

from __future__ import annotations

import re
import threading
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from hybond.errors import HybondError, UnitError, UsageError
from hybond.model.builder import Model
from hybond.result import Result
from hybond.simulation import simulate
from hybond.studio.curves import MOST_PLOTTED, curve
from hybond.studio.runs import defect
from hybond.units import parse_quantity

MOST = 200
"""Members of a sweep."""
WIDE = 500
"""Pixels of a curve of a family: of each the least and the greatest value are told."""
ROWS = 240
"""Times at which the map tells the mode of a member."""


@dataclass(slots=True)
class Sweep:
    """A sweep that goes on, or has ended."""

    number: int
    path: str
    values: list[str]
    names: list[str]
    until: float | str | None
    cancelled: threading.Event = field(default_factory=threading.Event)
    modes: dict[str, int] = field(default_factory=dict)
    """Modes that were met, in the order in which they were."""


def values_between(low: object, high: object, count: object, *, log: bool = False) -> list[str]:
    """Return values of a parameter, evenly spaced or by ratios, in the unit of the first.

    Raises
    ------
    UsageError
        HB-W103 for a range that is none.
    UnitError
        HB-U101 to HB-U105 for an end that is no quantity.

    Examples
    --------
    >>> values_between("1 mH", "2 mH", 3)
    ['1 mH', '1.5 mH', '2 mH']
    >>> values_between(1, 100, 3, log=True)
    ['1', '10', '100']
    """
    try:
        first, last = parse_quantity(str(low)), parse_quantity(str(high))
    except UnitError as error:
        error.where = "sweep"
        raise
    try:
        many = int(count) if isinstance(count, int | str) else 0
    except ValueError:
        many = 0
    if not 2 <= many <= MOST:
        raise UsageError(
            f"a sweep of {count!r} runs",
            code="HB-W103",
            where="sweep",
            hint=f"2 to {MOST}",
        )
    if first.dimension != last.dimension:
        raise UsageError(
            f"{low!r} and {high!r} are not of one kind",
            code="HB-W103",
            where="sweep",
            hint="give both ends in one unit",
        )
    if log and not first.value * last.value > 0.0:
        raise UsageError(
            f"no ratios lead from {low!r} to {high!r}",
            code="HB-W103",
            where="sweep",
            hint="both ends above zero, or evenly spaced",
        )
    unit = _unit(str(low))
    one = parse_quantity(f"1 {unit}").value if unit else 1.0
    ends = first.value / one, last.value / one
    found = np.geomspace(*ends, many) if log else np.linspace(*ends, many)
    return [f"{float(v):.12g} {unit}".strip() for v in found]


def _unit(text: str) -> str:
    """Return what stands behind the number."""
    return re.sub(r"^\s*[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", "", text).strip()


class Sweeps:
    """The sweeps of a session, one at a time.

    Parameters
    ----------
    tell : callable
        Called from the thread of a sweep with messages for the page.
    """

    def __init__(self, tell: Callable[[dict[str, Any]], None]) -> None:
        self._tell = tell
        self._count = 0
        self.current: Sweep | None = None

    def start(self, model: Model, message: Mapping[str, Any]) -> Sweep:
        """Begin a sweep; one that goes on is cancelled.

        Raises
        ------
        UsageError
            HB-W103 for a range that is none.
        """
        values = values_between(
            message.get("from"),
            message.get("to"),
            message.get("count"),
            log=bool(message.get("log")),
        )
        self.cancel()
        self._count += 1
        names = [str(n) for n in message.get("names") or ()][:MOST_PLOTTED]
        until = message.get("until") or None
        sweep = Sweep(self._count, str(message.get("path")), values, names, until)
        self.current = sweep
        thread = threading.Thread(
            target=self._run, args=(sweep, model), name="hybond-sweep", daemon=True
        )
        thread.start()
        return sweep

    def cancel(self) -> None:
        """Stop after the step that goes on."""
        if self.current is not None:
            self.current.cancelled.set()

    def _run(self, sweep: Sweep, model: Model) -> None:
        def watch(_: Result) -> None:
            if sweep.cancelled.is_set():
                raise KeyboardInterrupt

        begun = {"sweep": sweep.number, "path": sweep.path, "values": sweep.values}
        self._tell({"tell": "sweeping", **begun})
        for k, value in enumerate(sweep.values):
            if sweep.cancelled.is_set():
                break
            told: dict[str, Any] = {"tell": "member", "sweep": sweep.number, "member": k}
            try:
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore")
                    run = simulate(
                        model,
                        sweep.until,
                        parameters={sweep.path: value},
                        watch=watch,
                        on_error="return",
                    )
                told |= member(run, sweep)
            except HybondError as error:
                told |= {"status": "error", "error": error.to_dict()}
            except KeyboardInterrupt:
                break
            except Exception as error:  # a defect of ours: told as such, the sweep goes on
                told |= {"status": "error", "error": defect(error, "sweep").to_dict()}
            if sweep.cancelled.is_set():
                break  # what was cut off in the middle is no member
            self._tell({**told, "value": value})
        cut = sweep.cancelled.is_set()
        self._tell({"tell": "swept", "sweep": sweep.number, "cancelled": cut})


def member(run: Result, sweep: Sweep) -> dict[str, Any]:
    """Return what the page shows of one run of a sweep: its curves, and its mode over time."""
    curves = []
    for name in sweep.names or run.names[:2]:
        try:
            curves.append(curve(run, name, run.t_begin, run.t_end, WIDE))
        except HybondError as error:
            curves.append({"name": name, "error": error.to_dict()})
    begins = np.array([s.t[0] for s in run.segments])
    told: dict[str, Any] = {
        "status": run.status,
        "events": len(run.events),
        "curves": curves,
        "tEnd": run.t_end,
        "until": run.until,
        "modes": [],
    }
    if run.error is not None:
        told["error"] = run.error.to_dict()
    if len(begins) and run.graph.machines:
        end = float(run.until)
        times = (np.arange(ROWS) + 0.5) * end / ROWS
        within = times[times <= run.t_end]
        which = np.maximum(np.searchsorted(begins, within, side="right") - 1, 0)
        names = [_mode_name(run, run.segments[int(k)].mode) for k in which.tolist()]
        told["modes"] = [sweep.modes.setdefault(n, len(sweep.modes)) for n in names]
        told["named"] = list(sweep.modes)
    return told


def _mode_name(run: Result, mode: tuple[int, ...]) -> str:
    return ", ".join(run.graph.mode_names(mode).values())
