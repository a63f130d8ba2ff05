"""What a run is asked for as small records, in which what does not belong together has no place.

`simulate(m, "1 s", method=hb.MoreauJean(step="1 ms", theta=1), sliding=hb.Hysteresis("1 mm"))`.
What a record leaves out is as the experiment of the model says, and else the default. Options by
themselves (``solver="radau", rtol=1e-6``) are the same in short.

To add a method: a record here with the options it has, of `hybond.options`, and its solver.
"""

from __future__ import annotations

import os
from dataclasses import fields
from typing import TYPE_CHECKING, Any, Literal

from hybond.calls import fits
from hybond.errors import UsageError
from hybond.options import OPTIONS
from hybond.records import dataclass

if TYPE_CHECKING:
    from pathlib import Path


@dataclass(frozen=True, slots=True)
class Method:
    """How motion is computed: what all methods have in common, and none by itself."""

    def __post_init__(self) -> None:
        for name, value in self.options.items():
            OPTIONS[name].read(value)

    @property
    def solver(self) -> str:
        """The name of the solver: that of the record, in small letters."""
        return type(self).__name__.lower()

    @property
    def options(self) -> dict[str, Any]:
        """What it says, by names of options."""
        own = {f.name: getattr(self, f.name) for f in fields(self) if f.name in OPTIONS}
        return {"solver": self.solver, **{k: v for k, v in own.items() if v is not None}}


@dataclass(frozen=True, slots=True, kw_only=True)
class _Adaptive(Method):
    rtol: float | None = None
    atol: float | None = None
    max_step: float | str | None = None


@fits("hb.Auto(rtol=1e-6)")
@dataclass(frozen=True, slots=True)
class Auto(_Adaptive):
    """Linear modes exactly, others by Runge-Kutta, and by Radau where they are stiff.

    Parameters
    ----------
    rtol : float
        Relative tolerance, 1e-8 by default.
    atol : float
        Absolute tolerance in SI for every state, instead of a part of what energies make of it.
    max_step : float or str
        Longest step, s.

    Raises
    ------
    UsageError
        HB-S107 or HB-S103 for a value that is none.

    Examples
    --------
    >>> Auto(rtol=1e-6)
    Auto(rtol=1e-06, atol=None, max_step=None)
    """


@fits("hb.RK45(rtol=1e-6)")
@dataclass(frozen=True, slots=True)
class RK45(_Adaptive):
    """Runge-Kutta 5(4) of Dormand and Prince, adaptive; `Auto` says what the parameters are.

    Examples
    --------
    >>> RK45(max_step="1 ms").options
    {'solver': 'rk45', 'max_step': '1 ms'}
    """


@fits("hb.Radau(rtol=1e-6)")
@dataclass(frozen=True, slots=True)
class Radau(_Adaptive):
    """Radau IIA of order 5, implicit, for stiff models; `Auto` says what the parameters are.

    Examples
    --------
    >>> Radau(rtol=2.0)
    Traceback (most recent call last):
        ...
    hybond.errors.UsageError: HB-S107 at rtol: rtol = 2.0
      try: 1e-12 to 1e-2
    """


@fits("hb.Exact(rtol=1e-6)")
@dataclass(frozen=True, slots=True)
class Exact(_Adaptive):
    """The exponential of a matrix where the mode is linear; `Auto` says what the parameters are.

    Examples
    --------
    >>> Exact().options
    {'solver': 'exact'}
    """


@dataclass(frozen=True, slots=True)
class _FixedStep(Method):
    step: float | str


@fits('hb.RK4(step="1 ms")')
@dataclass(frozen=True, slots=True)
class RK4(_FixedStep):
    """Runge-Kutta of order 4 with a fixed step.

    Parameters
    ----------
    step : float or str
        s.

    Raises
    ------
    UsageError
        HB-S102 for a step that is none.

    Examples
    --------
    >>> RK4("1 ms").options
    {'solver': 'rk4', 'step': '1 ms'}
    """


@fits('hb.Euler(step="1 ms")')
@dataclass(frozen=True, slots=True)
class Euler(_FixedStep):
    """Forward Euler with a fixed step; `RK4` says what the parameter is.

    Examples
    --------
    >>> Euler("1 ms").solver
    'euler'
    """


@dataclass(frozen=True, slots=True, kw_only=True)
class _Quantised(_Adaptive):
    order: Literal[1, 2, 3] | None = None

    @property
    def solver(self) -> str:
        """The name of the family with the order, if there is one."""
        if self.order not in (None, 1, 2, 3):
            raise UsageError(
                f"order = {self.order!r}", code="HB-S101", where="order", hint="1, 2 or 3"
            )
        return f"{type(self).__name__.lower()}{self.order or ''}"


@fits("hb.QSS(order=3, rtol=1e-6)")
@dataclass(frozen=True, slots=True)
class QSS(_Quantised):
    """Quantised states of order 1, 2 or 3, by default 3.

    Parameters
    ----------
    rtol, atol : float
        The quantum of a state is its tolerance.
    max_step : float or str
        Longest step, s.
    order : {1, 2, 3}

    Raises
    ------
    UsageError
        HB-S101 for an order that there is not, others as `Auto`.

    Examples
    --------
    >>> QSS(order=2, rtol=1e-5).solver
    'qss2'
    """


@fits("hb.LIQSS(order=2, rtol=1e-6)")
@dataclass(frozen=True, slots=True)
class LIQSS(_Quantised):
    """Linearly implicit quantised states, by default of order 2; parameters as of `QSS`.

    Examples
    --------
    >>> LIQSS().solver
    'liqss'
    """


@fits('hb.MoreauJean(step="1 ms")')
@dataclass(frozen=True, slots=True)
class MoreauJean(_FixedStep):
    """Time-stepping of Moreau and Jean: contacts, diodes and friction as laws of each step.

    Its impacts are Newton's for all contacts at once.

    Parameters
    ----------
    step : float or str
        s.
    theta : float
        1/2 (default) to 1: how much the end of a step weighs in its smooth part.

    Raises
    ------
    UsageError
        HB-S102 for a step, HB-S112 for a theta that is none.

    Examples
    --------
    >>> MoreauJean("1 ms", theta=1).options
    {'solver': 'moreau-jean', 'step': '1 ms', 'theta': 1}
    """

    theta: float | None = None

    @property
    def solver(self) -> str:
        """The name of the solver."""
        return "moreau-jean"


@fits('hb.Hysteresis("1 mm")')
@dataclass(frozen=True, slots=True)
class Hysteresis:
    """Where both sides push into a switching surface: a band around it, across which rules switch.

    Parameters
    ----------
    band : float or str
        Half its width, in the unit of the switching functions or in SI.

    Raises
    ------
    UsageError
        HB-S111 for a band that is none.

    Examples
    --------
    >>> Hysteresis("1 mm").options
    {'sliding': 'hysteresis', 'hysteresis': '1 mm'}
    """

    band: float | str

    def __post_init__(self) -> None:
        OPTIONS["hysteresis"].read(self.band)

    @property
    def options(self) -> dict[str, Any]:
        """What it says, by names of options."""
        return {"sliding": "hysteresis", "hysteresis": self.band}


@fits("hb.Limits(events=1000)")
@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """After how much a run that gets nowhere stops.

    Parameters
    ----------
    events : int
        HB-N404 stops it there; by default 1,000,000.
    steps : int
        Steps between two events, then HB-N409; by default 4,000,000.

    Raises
    ------
    UsageError
        HB-S120 for a number that is none.

    Examples
    --------
    >>> Limits(events=10**6).options
    {'max_events': 1000000}
    """

    events: int | None = None
    steps: int | None = None

    def __post_init__(self) -> None:
        for name, value in self.options.items():
            OPTIONS[name].read(value)

    @property
    def options(self) -> dict[str, Any]:
        """What it says, by names of options."""
        given = {"max_events": self.events, "max_steps": self.steps}
        return {k: v for k, v in given.items() if v is not None}


@fits('hb.Journal("events.csv")')
@dataclass(frozen=True, slots=True)
class Journal:
    """Events written to a file as they happen.

    Parameters
    ----------
    path : str or Path
        A CSV file: time, cause, the states of the machines, stored quantities and signals after it.
    last : int
        Segments and events that the result keeps beside it, the last ones; all by default.

    Raises
    ------
    UsageError
        HB-S113 for what is no CSV file, or keeps nothing.

    Examples
    --------
    >>> Journal("events.csv", last=1000)
    Journal(path='events.csv', last=1000)
    """

    path: str | Path
    last: int | None = None

    def __post_init__(self) -> None:
        named = isinstance(self.path, str | os.PathLike)
        if not named or os.path.splitext(self.path)[1].lower() != ".csv":
            # a file that is there is replaced: let it not be a model
            raise UsageError(
                f"the journal cannot be {str(self.path)!r}",
                code="HB-S113",
                where="journal",
                hint='name a CSV file, such as journal="events.csv"',
            )
        if self.last is not None and not is_many(self.last):
            raise nothing_kept(self.last)


def is_many(keep: object) -> bool:
    """Whether a number of segments and events can be kept."""
    return isinstance(keep, int) and not isinstance(keep, bool) and keep >= 1


def nothing_kept(keep: object) -> UsageError:
    """Return the refusal of what is no number of segments and events."""
    return UsageError(
        f"keep = {keep!r}",
        code="HB-S113",
        where="keep",
        hint='one or more, or hb.Journal("events.csv"); with a solver that locates events',
    )
