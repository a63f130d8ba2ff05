"""Goals: one number of a run that can be differentiated, and made small."""

from __future__ import annotations

from dataclasses import dataclass

from hybond.calls import fits


@fits('hb.Final("c.e")')
@dataclass(frozen=True, slots=True)
class Final:
    """The value of a signal at the end of the run.

    Parameters
    ----------
    signal : str
        A signal, or an expression of signals.

    Examples
    --------
    >>> str(Final("ball.p"))
    'ball.p at the end'
    """

    signal: str

    def __str__(self) -> str:
        return f"{self.signal} at the end"


@fits('hb.Total("r.e*r.f")')
@dataclass(frozen=True, slots=True)
class Total:
    """The integral of a signal over the run.

    Parameters
    ----------
    signal : str
        A signal, or an expression of signals: ``"(c.e - 5 [V])^2"``.

    Examples
    --------
    >>> str(Total("r.e*r.f"))
    'the integral of r.e*r.f'
    """

    signal: str

    def __str__(self) -> str:
        return f"the integral of {self.signal}"


@fits("hb.EventTime(1)")
@dataclass(frozen=True, slots=True)
class EventTime:
    """The instant of an event.

    Parameters
    ----------
    number : int
        Its number in the table of the run; 0 is the start.
    machine : str
        Count only events at which this machine or junction switches, from 1.

    Examples
    --------
    >>> str(EventTime(2)), str(EventTime(1, "d"))
    ('the instant of event 2', 'the instant of event 1 of d')
    """

    number: int
    machine: str = ""

    def __str__(self) -> str:
        of = f" of {self.machine}" if self.machine else ""
        return f"the instant of event {self.number}{of}"


Goal = Final | Total | EventTime
