"""`Signal`: one signal of a run, its values and what is measured of it."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from hybond.measures.value import About, Measurement
from hybond.measures.window import TOLERANCE, Time, Window, frequency_of, window_of
from hybond.names import Asked
from hybond.records import dataclass

if TYPE_CHECKING:
    from hybond.measures.averages import Impulses
    from hybond.measures.crossings import Crossing, Edge
    from hybond.measures.harmonics import Spectrum
    from hybond.measures.ripple import Ripple
    from hybond.measures.stepping_up import StepInfo
    from hybond.result import Result

Vector = NDArray[np.float64]
Side = Literal["left", "right"]


@dataclass(frozen=True)
class Signal(Asked):
    """One signal of a run: pieces that are smooth, jumps between them.

    What is measured is of the motion, between its points too. It is of the whole run, of a window
    (``start="1 ms", end=0.002``), or of periods (``period="20 us", periods=5``: the last five
    before `end`). Jumps and impulses at the end of a window belong to it, those at its start do
    not, but for the start of the run. All results are SI; they count as floats and know `unit`,
    `start`, `end` and `how`.

    Parameters
    ----------
    name, unit : str

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("rc", domain="electrical")
    >>> m.add(c=hb.C("1 mF", e="10 V"), r=hb.R("1 kohm"), node=hb.Zero())
    >>> m.bond("node -> c", "node -> r")
    >>> u = hb.simulate(m, until="1 s", rtol=1e-10)["c.e"]
    >>> print(u.mean(), u.rms(start="0.5 s"), u.integral(period="0.2 s", periods=2))
    6.32121 V 4.82228 V 1.80932 V·s
    >>> u.min().t
    1.0
    """

    name: str
    unit: str
    run: Result

    @property
    def t(self) -> Vector:
        """Times of all pieces joined, s, shape (n,); at an event twice, left limit first."""
        return self._points[0]

    @property
    def y(self) -> Vector:
        """The values there, shape (n,)."""
        return self._points[1]

    @cached_property
    def _points(self) -> tuple[Vector, Vector]:
        pieces = self.run.pieces(self.name)
        if not pieces:
            return np.zeros(0), np.zeros(0)
        if self.run._jumps_at_end:
            pieces.append((np.array([self.run.t_end]), np.array([self._at_the_end])))
        return np.concatenate([t for t, _ in pieces]), np.concatenate([y for _, y in pieces])

    @property
    def _at_the_end(self) -> float:
        """The value after all that happens where the run ends."""
        return self.run._after_last_event([self.name])[0]

    def at(self, t: Time | Sequence[Time], *, side: Side = "right") -> Any:
        """Return the value at `t`, s or a quantity: a float for one, an array for a sequence.

        At an event `side` says which limit; the right one is after all that happened there.
        """
        found = self.run.sample(t, [self.name], side=side)[self.name]
        return float(found[0]) if np.ndim(t) == 0 else found

    # -- over a window

    def integral(
        self,
        *,
        start: Time | None = None,
        end: Time | None = None,
        period: Time | None = None,
        periods: int | None = None,
        tolerance: float = TOLERANCE,
    ) -> Measurement:
        """Return the integral over time, the areas of impulses included.

        `impulses` of the result is the sum of these areas, `how` says how many there are.

        Parameters
        ----------
        start, end : float or str, optional
            Times, s or quantities.
        period : float or str, optional
            A duration or a frequency.
        periods : int, optional
            The last ones before `end`, or the first after `start`.
        tolerance : float
            As a part of the integral of the magnitude, default 1e-10.

        Raises
        ------
        UsageError
            HB-R101, HB-R102: no window of the run; HB-R105: an expression whose impulse has no
            meaning.
        NumericsError
            HB-R103: no value; HB-R104: too rough for the tolerance.
        """
        from hybond.measures.averages import integral_of

        return integral_of(
            self.run, self.name, self._window(start, end, period, periods), tolerance=tolerance
        )

    def mean(
        self,
        *,
        start: Time | None = None,
        end: Time | None = None,
        period: Time | None = None,
        periods: int | None = None,
        tolerance: float = TOLERANCE,
    ) -> Measurement:
        """Return the mean, the areas of impulses included; arguments as `integral`."""
        from hybond.measures.averages import mean_of

        return mean_of(
            self.run, self.name, self._window(start, end, period, periods), tolerance=tolerance
        )

    def rms(
        self,
        *,
        start: Time | None = None,
        end: Time | None = None,
        period: Time | None = None,
        periods: int | None = None,
        impulses: Impulses = "refuse",
        tolerance: float = TOLERANCE,
    ) -> Measurement:
        """Return the root of the mean square; other arguments as `integral`.

        Parameters
        ----------
        impulses : {"refuse", "leave out"}
            The square of an impulse has no integral: refuse it with HB-R106, or measure what is
            beside it.
        """
        from hybond.measures.averages import rms_of

        window = self._window(start, end, period, periods)
        return rms_of(self.run, self.name, window, impulses=impulses, tolerance=tolerance)

    def max(
        self,
        *,
        start: Time | None = None,
        end: Time | None = None,
        period: Time | None = None,
        periods: int | None = None,
        impulses: Impulses = "refuse",
        tolerance: float = TOLERANCE,
    ) -> Measurement:
        """Return the maximum of the motion, with its time `t` and, at a jump, its `side`.

        Arguments as `rms`.
        """
        from hybond.measures.extremes import extreme_of

        window = self._window(start, end, period, periods)
        return extreme_of(self.run, self.name, window, 1.0, impulses=impulses, tolerance=tolerance)

    def min(
        self,
        *,
        start: Time | None = None,
        end: Time | None = None,
        period: Time | None = None,
        periods: int | None = None,
        impulses: Impulses = "refuse",
        tolerance: float = TOLERANCE,
    ) -> Measurement:
        """Return the minimum of the motion, as `max`."""
        from hybond.measures.extremes import extreme_of

        window = self._window(start, end, period, periods)
        return extreme_of(self.run, self.name, window, -1.0, impulses=impulses, tolerance=tolerance)

    def max_at(self, **window: Any) -> float:
        """Return when the maximum is taken first, s; arguments as `max`."""
        t = self.max(**window).t
        assert t is not None
        return t

    def min_at(self, **window: Any) -> float:
        """Return when the minimum is taken first, s; arguments as `max`."""
        t = self.min(**window).t
        assert t is not None
        return t

    def peak_to_peak(
        self,
        *,
        start: Time | None = None,
        end: Time | None = None,
        period: Time | None = None,
        periods: int | None = None,
        impulses: Impulses = "refuse",
        tolerance: float = TOLERANCE,
    ) -> Measurement:
        """Return the maximum less the minimum; arguments as `rms`."""
        from hybond.measures.extremes import range_of

        window = self._window(start, end, period, periods)
        return range_of(self.run, self.name, window, impulses=impulses, tolerance=tolerance)

    def ripple(
        self,
        *,
        start: Time | None = None,
        end: Time | None = None,
        period: Time | None = None,
        periods: int | None = None,
        tolerance: float = TOLERANCE,
    ) -> Ripple:
        """Return how much it varies, as parts of its mean; arguments as `integral`.

        Raises
        ------
        UsageError
            HB-R106 for impulses, HB-R108 for a mean of zero.
        """
        from hybond.measures.ripple import ripple_of

        window = self._window(start, end, period, periods)
        return ripple_of(self.run, self.name, window, tolerance=tolerance)

    # -- crossings

    def crossings(
        self,
        level: float | str = 0.0,
        *,
        edge: Edge = "both",
        start: Time | None = None,
        end: Time | None = None,
        period: Time | None = None,
        periods: int | None = None,
        tolerance: float = TOLERANCE,
    ) -> tuple[Crossing, ...]:
        """Return when it crosses a level; other arguments as `integral`.

        It rises when it gets from below the level to it or beyond, and falls when it gets from
        above to it or beyond.

        Parameters
        ----------
        level : float or str
            SI, or a quantity of the signal's unit.
        edge : {"both", "rise", "fall"}
        """
        from hybond.measures.crossings import crossings_of

        window = self._window(start, end, period, periods)
        at = self._level(level)
        return crossings_of(self.run, self.name, at, window, edge=edge, tolerance=tolerance)

    def period(
        self,
        level: float | str | None = None,
        *,
        edge: Edge = "rise",
        start: Time | None = None,
        end: Time | None = None,
        tolerance: float = TOLERANCE,
    ) -> Measurement:
        """Return the mean time between crossings of a level in one direction, s.

        Parameters
        ----------
        level : float or str, optional
            By default in the middle between minimum and maximum.

        Raises
        ------
        UsageError
            HB-R107 if there are less than two.
        """
        from hybond.measures.crossings import period_of

        window = self._window(start, end, None, None)
        at = self._middle(window, tolerance) if level is None else self._level(level)
        return period_of(self.run, self.name, at, window, edge=edge, tolerance=tolerance)

    def frequency(
        self,
        level: float | str | None = None,
        *,
        edge: Edge = "rise",
        start: Time | None = None,
        end: Time | None = None,
        tolerance: float = TOLERANCE,
    ) -> Measurement:
        """Return one over the `period`, Hz."""
        found = self.period(level, edge=edge, start=start, end=end, tolerance=tolerance)
        return Measurement(1.0 / found, About("Hz", found.start, found.end, how=found.how))

    def duty(
        self,
        level: float | str | None = None,
        *,
        start: Time | None = None,
        end: Time | None = None,
        period: Time | None = None,
        periods: int | None = None,
        tolerance: float = TOLERANCE,
    ) -> Measurement:
        """Return the part of the time that it is above a level, by default the middle."""
        from hybond.measures.crossings import duty_of

        window = self._window(start, end, period, periods)
        at = self._middle(window, tolerance) if level is None else self._level(level)
        return duty_of(self.run, self.name, at, window, tolerance=tolerance)

    def step_info(
        self,
        *,
        initial: float | str | None = None,
        final: float | str | None = None,
        band: float = 0.02,
        low: float = 0.1,
        high: float = 0.9,
        start: Time | None = None,
        end: Time | None = None,
        tolerance: float = TOLERANCE,
    ) -> StepInfo:
        """Return rise time, overshoot and settling time of a step.

        Parameters
        ----------
        initial, final : float or str, optional
            By default the values at the begin and at the end of the window.
        band : float
            Of settling, around the final value, as a part of the way.
        low, high : float
            Parts of the way between which the rise time is.

        Raises
        ------
        UsageError
            HB-R108 if there is no step.
        """
        from hybond.measures.stepping_up import step_of

        return step_of(
            self.run,
            self.name,
            self._window(start, end, None, None),
            initial=None if initial is None else self._level(initial),
            final=None if final is None else self._level(final),
            band=band,
            low=low,
            high=high,
            tolerance=tolerance,
        )

    # -- harmonics

    def spectrum(
        self,
        f: float | str | None = None,
        *,
        harmonics: int = 20,
        start: Time | None = None,
        end: Time | None = None,
        periods: int | None = None,
        tolerance: float = TOLERANCE,
    ) -> Spectrum:
        """Return mean and harmonics, impulses included.

        Parameters
        ----------
        f : float or str, optional
            The fundamental: Hz, a frequency or a period. By default one over the window.
        harmonics : int
            How many multiples of it.
        start, end : float or str, optional
            A window of whole periods.
        periods : int, optional
            The last ones before `end` (or the first after `start`), default 1.

        Raises
        ------
        UsageError
            HB-R109 for a window that is not whole periods.
        """
        from hybond.measures.harmonics import spectrum_of

        if f is None:
            window = self._window(start, end, None, periods)
            base = 1.0 / window.length
        else:
            base = frequency_of(f)
            window = self._whole(base, start, end, periods)
        return spectrum_of(
            self.run, self.name, window, base, harmonics=harmonics, tolerance=tolerance
        )

    def thd(
        self,
        f: float | str,
        *,
        harmonics: int | None = None,
        start: Time | None = None,
        end: Time | None = None,
        periods: int | None = None,
        tolerance: float = TOLERANCE,
    ) -> Measurement:
        """Return the total harmonic distortion, as a part of the fundamental.

        Parameters
        ----------
        f : float or str
            The fundamental.
        harmonics : int, optional
            Up to which one; by default all that is left beside mean and fundamental. Others as
            `spectrum`.

        Raises
        ------
        UsageError
            HB-R106 for impulses, HB-R109, HB-R110 if there is no fundamental.
        """
        from hybond.measures.harmonics import thd_of

        base = frequency_of(f)
        window = self._whole(base, start, end, periods)
        return thd_of(self.run, self.name, window, base, harmonics=harmonics, tolerance=tolerance)

    # -- what is asked

    def _window(
        self, start: Time | None, end: Time | None, period: Time | None, periods: int | None
    ) -> Window:
        return window_of(self.run, start=start, end=end, period=period, periods=periods)

    def _whole(self, f: float, start: Time | None, end: Time | None, periods: int | None) -> Window:
        if start is not None and end is not None and periods is None:
            return self._window(start, end, None, None)
        return self._window(start, end, 1.0 / f, periods)

    def _middle(self, window: Window, tolerance: float) -> float:
        from hybond.measures.extremes import extreme_of

        low, high = (
            extreme_of(self.run, self.name, window, sign, impulses="leave out", tolerance=tolerance)
            for sign in (-1.0, 1.0)
        )
        return 0.5 * (low + high)

    def _level(self, value: float | str) -> float:
        from hybond.measures.foreseen import level_of

        return level_of(value, self.unit, self.name)

    def __len__(self) -> int:
        return len(self.t)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Any:
        """Return the values, for NumPy and what plots with it."""
        return np.array(self.y, dtype=dtype) if copy else np.asarray(self.y, dtype=dtype)

    def __getitem__(self, k: object) -> Any:
        raise TypeError(
            f"a Signal has no [{k!r}]: a number may be a point or a time; try: signal.y[{k!r}] of "
            "the points at signal.t; signal.at(0.1) at a time"
        )

    def __repr__(self) -> str:
        return f"<Signal {self.name} [{self.unit}], {len(self.t)} points>"
