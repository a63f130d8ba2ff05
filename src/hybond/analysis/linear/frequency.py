"""`frequency_response`: a switched model asked by a small sine, frequency by frequency.

What has no matrices because it switches all the time has a frequency response all the same: a sine
is added to a source or an input, the model runs until what it does repeats, and the part of the
output at that frequency is the Fourier coefficient over whole periods of the sine and of the model.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hybond.analysis.linear.asked import input_unit
from hybond.analysis.linear.injection import injected, source_of
from hybond.analysis.linear.periods import (
    WHOLE,
    Window,
    period_of,
    repeats_from,
    time_said,
    times_of,
    window_of,
)
from hybond.analysis.linear.responses import Bode, frequencies_of
from hybond.analysis.linear.windows import coefficients, left_over
from hybond.analysis.linear.words import unit_over
from hybond.calls import called
from hybond.errors import NumericsError, UsageError
from hybond.measures.naming import read_name
from hybond.model.builder import Model
from hybond.model.expressions import Expr, Name, compile_expression, names
from hybond.model.graph import FlatGraph
from hybond.model.inputs import Waveform
from hybond.model.kept import kept_graph
from hybond.model.parts import Value
from hybond.model.unit_words import unit_of
from hybond.runs.asked import MethodOptions, opened
from hybond.simulation import simulate
from hybond.units import format_quantity, try_quantity

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FIRST = 8
"""Windows of the first run for a frequency; as long as it has not settled, twice as many."""
MOST = 2048
"""Windows after which a frequency is given up."""
SMALL = 0.01
"""The amplitude that is taken where none is given, as a part of the input's own value."""


@dataclass(frozen=True, slots=True, eq=False)
class FrequencyResponse:
    """What `frequency_response` found; rows are frequencies.

    Parameters
    ----------
    frequencies : array, shape (m,)
        Hz, as they were used.
    asked : array, shape (m,)
        As they were asked for.
    response : array of complex, shape (m,)
        Output over input, SI.
    settled : array of bool, shape (m,)
    left : array, shape (m,)
        How far the response still is from its limit, as a part of it: estimated from the last
        windows.
    windows, turns : array of int, shape (m,)
        Windows that were run, and periods of the sine in each.
    distortion : array, shape (m,)
        The output at twice the frequency, as a part of that at the frequency: how far from small
        the sine is.
    amplitude : float
    period : float or None
        Of the model itself, s.
    tolerance : float
    input, output, unit, title : str
    """

    frequencies: NDArray[np.float64]
    asked: NDArray[np.float64]
    response: NDArray[np.complex128]
    settled: NDArray[np.bool_]
    left: NDArray[np.float64]
    windows: NDArray[np.int_]
    turns: NDArray[np.int_]
    distortion: NDArray[np.float64]
    amplitude: float
    period: float | None
    tolerance: float
    input: str
    output: str
    unit: str
    title: str

    @property
    def bode(self) -> Bode:
        """The response as a linearisation has it, with magnitude and phase."""
        return Bode(self.frequencies, self.response, self.input, self.output, self.unit)

    @property
    def ok(self) -> bool:
        """Whether all frequencies have settled."""
        return bool(self.settled.all())

    def plot(self, path: str | Path | None = None, *, beside: Bode | None = None) -> Figure:
        """Plot magnitude and phase as circles, open ones where it has not settled.

        Parameters
        ----------
        path : path, optional
            Write the figure there too.
        beside : Bode, optional
            A line to compare with, such as ``lin.bode()`` of an averaged model.
        """
        from hybond.draw.linear_plots import plot_bode

        title = f"{self.title}: by injection" if self.title else "by injection"
        curves = [] if beside is None else [beside]
        return plot_bode(
            curves, dots=[(self.bode, self.output, self.settled)], title=title, path=path
        )

    def to_data(self) -> dict[str, Any]:
        """Return plain lists and texts, for JSON."""
        return {
            "title": self.title,
            "input": self.input,
            "output": self.output,
            "unit": self.unit,
            "amplitude": self.amplitude,
            "period": self.period,
            "tolerance": self.tolerance,
            "frequencies": self.frequencies.tolist(),
            "asked": self.asked.tolist(),
            "response": [[float(z.real), float(z.imag)] for z in self.response],
            "decibels": self.bode.decibels.tolist(),
            "phase": self.bode.phase.tolist(),
            "settled": self.settled.tolist(),
            "left": [x if np.isfinite(x) else None for x in self.left.tolist()],
            "windows": self.windows.tolist(),
            "turns": self.turns.tolist(),
            "distortion": self.distortion.tolist(),
        }

    def __str__(self) -> str:
        own = "" if self.period is None else f", the model repeats every {_text(self.period, 's')}"
        lines = [
            f"{self.output} / {self.input}, sine of {self.amplitude:.6g}{own}",
            f"{'frequency':>12}  {'dB':>9}  {'phase':>8}  {'periods':>12}  {'distorted':>9}",
        ]
        for k, f in enumerate(self.frequencies):
            done = f"{self.windows[k]} x {self.turns[k]}"
            row = (
                f"{_text(float(f), 'Hz'):>12}  {self.bode.decibels[k]:9.3f}  "
                f"{self.bode.phase[k]:7.2f}°  {done:>12}  {self.distortion[k]:9.1e}"
            )
            if abs(f / self.asked[k] - 1.0) > 1e-9:
                row += f"  for {_text(float(self.asked[k]), 'Hz')}"
            if not self.settled[k]:
                row += f"  NOT SETTLED, off by about {self.left[k]:.1e} of it"
            lines.append(row)
        return "\n".join(lines)

    def __repr__(self) -> str:
        done = f"{int(self.settled.sum())} of {len(self.settled)} settled"
        return f"<FrequencyResponse {self.output} / {self.input}: {done}>"


@called(
    'hb.frequency_response(model, input="V", output="c.e", frequencies=[100, "1 kHz"])',
    options=MethodOptions,
)
def frequency_response(
    model: Model | FlatGraph,
    *,
    input: str,
    output: str,
    frequencies: ArrayLike | Sequence[float | str],
    amplitude: float | str | None = None,
    period: float | str | None = None,
    tolerance: float = 1e-3,
    windows: int = MOST,
    parameters: Mapping[str, Value] | None = None,
    **options: Unpack[MethodOptions],
) -> FrequencyResponse:
    """Return the response of a model to a small sine, by running it around what it repeats.

    ``amplitude*sin(2 pi f t)`` is added to the input, and the model runs from its start, in windows
    that hold whole periods of the sine and of the model. It has settled where the Fourier
    coefficient of the output, extrapolated from its last changes, is within `tolerance` of its
    limit; else the run is made twice as long, up to `windows`. A frequency that has no short window
    with the model's own period is moved, by less than one part in a thousand where that is enough.

    Parameters
    ----------
    model : Model or FlatGraph
    input : str
        A source (``"V"`` or ``"V.e"``), or an input of the model.
    output : str
        A signal, or an expression of them.
    frequencies : sequence of float or str
        Hz, or quantities.
    amplitude : float or str, optional
        In the unit of the input. Default: a hundredth of what it has at the start.
    period : float or str, optional
        After which all repeats that the model reads of time: s, a quantity or an expression of
        parameters; a whole number of the model's own, where that can be told. By default it is
        found: pulses and tables that repeat, ``sin``, ``cos`` and ``mod`` of time.
    tolerance : float
    windows : int
        After how many a frequency is given up; the record says so, nothing is raised.
    parameters
        As for `simulate`.
    **options
        `method`, or what is short for it, as for `simulate`.

    Raises
    ------
    UsageError
        HB-A501 for an input that there is not, HB-S109 for an output, HB-A509 for frequencies or
        an amplitude that make no sense, HB-A511 for a period that cannot be told, or is none.
    NumericsError
        HB-A512 for a run that stops before its end.
    HybondError
        What a run raises.

    Examples
    --------
    A lowpass of 1 kHz, at 1 kHz: 3 dB less, an eighth of a turn behind.

    >>> import hybond as hb
    >>> m = hb.Model("rc", domain="electrical", parameters={"R": "1 kohm"})
    >>> m.add(V=hb.Se("5 V"), j=hb.One(), r=hb.R("R"), c=hb.C("1/(2*pi*R*(1 kHz))"))
    >>> m.bond("V -> j -> r", "j -> c")
    >>> found = hb.frequency_response(m, input="V", output="c.e", frequencies=["1 kHz"])
    >>> found.ok, found.bode.decibels.round(2).tolist(), found.bode.phase.round(1).tolist()
    (True, [-3.01], [-45.0])
    """
    graph = kept_graph(model, parameters or {}) if isinstance(model, Model) else model
    read_name(graph, output)
    asked = frequencies_of(frequencies, np.zeros(0))
    size, unit = _amplitude(graph, input, amplitude)
    own = period_of(graph) if period is None else _said(graph, period)
    if not 0.0 < tolerance < 1.0 or windows < FIRST:
        raise UsageError(
            f"tolerance = {tolerance:g}, windows = {windows}",
            code="HB-A509",
            where="tolerance",
            hint=f"a tolerance between 0 and 1, and {FIRST} windows or more",
        )
    said = opened(options)
    rows = []
    for f in asked.tolist():
        window = window_of(f, own)
        rows.append((window, _one(graph, input, output, size, window, tolerance, windows, said)))
    above = unit_of(read_name(graph, output), graph)
    return FrequencyResponse(
        frequencies=np.array([w.frequency for w, _ in rows]),
        asked=asked,
        response=np.array([r[0] for _, r in rows]),
        settled=np.array([r[1] for _, r in rows]),
        left=np.array([r[2] for _, r in rows]),
        windows=np.array([r[3] for _, r in rows]),
        turns=np.array([w.turns for w, _ in rows]),
        distortion=np.array([r[4] for _, r in rows]),
        amplitude=size,
        period=own,
        tolerance=tolerance,
        input=input,
        output=output,
        unit=unit_over(above, unit),
        title=graph.title or graph.name,
    )


def _said(graph: FlatGraph, period: float | str) -> float:
    """Return a period that is given, if the model may repeat with it."""
    said = time_said(graph, period)
    if not 0.0 < said < np.inf:
        raise UsageError(
            f"period = {said:g} s", code="HB-A511", where="period", hint="a positive time"
        )
    try:
        own = period_of(graph)
    except UsageError:
        return said  # that is why it is given
    if own is not None and not times_of(said, own):
        raise UsageError(
            f"the model repeats every {own:.9g} s, and {said:.9g} s is no whole number of that",
            code="HB-A511",
            where="period",
            hint=f'period="{own:.9g} s", or leave it out',
        )
    return said


def _one(
    graph: FlatGraph,
    name: str,
    output: str,
    amplitude: float,
    window: Window,
    tolerance: float,
    most: int,
    options: Mapping[str, Any],
) -> tuple[complex, bool, float, int, float]:
    """Return response, whether it settled, what is left, windows and distortion of a frequency."""
    made = injected(graph, name, amplitude, window.frequency)
    many = FIRST
    # windows in which an input has not yet begun to repeat say nothing
    quiet = math.ceil(repeats_from(graph) / window.length - WHOLE)
    while True:
        end = (quiet + many) * window.length
        run = simulate(made, end, **options)
        if run.status == "interrupted":
            raise KeyboardInterrupt
        if run.t_end < end * (1.0 - 1e-12):
            raise NumericsError(
                f"the run with the sine stopped at {run.t_end:.6g} s of {end:.6g} s",
                code="HB-A512",
                where=f"{window.frequency:g} Hz",
                hint="run the model itself that long, and see what stops it",
            )
        found = coefficients(run, output, window, (1, 2))[quiet:]
        left = left_over(found[:, 0])
        settled = left <= tolerance
        if settled or many >= most:
            break
        many = min(2 * many, most)
    last, twice = found[-1]
    # y = Im(a G exp(iwt)), so that its coefficient is -i a G
    response = complex(1j * last / amplitude)
    distortion = float(abs(twice) / abs(last)) if last else 0.0
    return response, bool(settled), left, many, distortion


def _amplitude(graph: FlatGraph, name: str, given: float | str | None) -> tuple[float, str]:
    """Return the amplitude of the sine, SI, and the unit of the input."""
    inputs = {i.path: i for i in graph.inputs}
    if name in inputs:
        unit = input_unit(graph, inputs[name].index)
        value = _input_at_start(inputs[name].waveform)
    else:
        node = graph.nodes[source_of(graph, name)]
        assert node.law is not None
        unit = unit_of(Name(f"{'e' if node.kind == 'Se' else 'f'}:{node.ends[0].bond}"), graph)
        value = _at_start(graph, node.law.expressions[0])
    if given is not None:
        quantity = try_quantity(given) if isinstance(given, str) else None
        number = given if not isinstance(given, str) else quantity.value if quantity else np.nan
        if isinstance(number, bool) or not 0.0 < number < np.inf:
            raise UsageError(
                f"amplitude = {given!r}",
                code="HB-A509",
                where="amplitude",
                hint=f"a positive number or quantity in {unit or 'the unit of the input'}",
            )
        return float(number), unit
    if not value:
        raise UsageError(
            f"{name} is zero at the start, or reads other signals: a hundredth of it is no "
            "amplitude",
            code="HB-A509",
            where="amplitude",
            hint=f"give one: amplitude={'1 ' + unit if unit else 0.01!r}",
        )
    return SMALL * abs(value), unit


def _input_at_start(wave: Waveform) -> float:
    return wave.value(0.0, wave.piece(0.0))


def _at_start(graph: FlatGraph, law: Expr) -> float:
    """Return what a source has at the start; zero if that takes more than time and inputs."""
    known = {f"u:{i.index}": _input_at_start(i.waveform) for i in graph.inputs} | {"time": 0.0}
    if not names(law) <= known.keys():
        return 0.0
    slots = {name: k for k, name in enumerate(known)}
    return float(compile_expression(law, slots, pre_offset=0)(list(known.values())))


def _text(value: float, unit: str) -> str:
    return format_quantity(value, unit, 5)
