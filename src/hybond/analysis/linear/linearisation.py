"""`Linearisation`: how a model moves near a point, as matrices and what one reads from them."""

from __future__ import annotations

import html
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hybond.analysis.linear.damping import Damping, damping_of
from hybond.analysis.linear.margins import Margins, margins_of
from hybond.analysis.linear.responses import Bode, StepResponse, frequencies_of, span_of
from hybond.analysis.linear.words import table_of, unit_over
from hybond.equations.descriptor import Descriptor
from hybond.equations.pencil import analyse
from hybond.errors import EquationError, UsageError
from hybond.export.linear.state_space import StateSpace
from hybond.names import did_you_mean
from hybond.options import seconds
from hybond.units import format_quantity

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Matrix = NDArray[np.float64]


_CURVES = 6
"""Pairs in one Bode plot."""


@dataclass(frozen=True, slots=True, eq=False)
class Linearisation:
    """``x' = A x + B u``, ``y = C x + D u`` near a point; made by `linearise`.

    All of `x`, `u` and `y` are what is added to the operating point.

    Parameters
    ----------
    A, B, C, D : array
        Shapes (n, n), (n, p), (q, n), (q, p); SI units.
    states, inputs, outputs : tuple of str
        States are the stored quantities and integrated signals that are independent here.
    state_units, input_units, output_units : tuple of str
        SI, empty where there is none.
    mode : mapping of machine to state
    point : str
        Where that is, in words.
    t : float
        The time at which inputs and sources are held, s.
    operating : mapping
        What states, inputs and outputs have there, SI. A source has the value of its bond.
    exact : bool
        Whether the model is linear in this mode, so that no matrix depends on the point.
    kinks : tuple of str
        Laws that have a kink or a jump at the point; the matrices are those of one of its sides.
    steady : bool
        Whether the point is an equilibrium that was looked for.
    notes : tuple of str
        What else is to be known.
    shifts : array, shape (n, p)
        A stored quantity is ``x + shifts @ u``: see `StateSpace`.
    """

    A: Matrix
    B: Matrix
    C: Matrix
    D: Matrix
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    state_units: tuple[str, ...]
    input_units: tuple[str, ...]
    output_units: tuple[str, ...]
    mode: Mapping[str, str]
    point: str
    t: float
    operating: Mapping[str, float]
    exact: bool
    kinks: tuple[str, ...]
    steady: bool
    notes: tuple[str, ...]
    shifts: Matrix
    title: str = ""

    # -- what one reads from it

    def poles(self) -> NDArray[Any]:
        """Return the eigenvalues of A, sorted by real part, 1/s; those at the origin are exact."""
        n = len(self.A)
        names = tuple(str(k) for k in range(n))
        # scaled first: what counts as zero is then no matter of units
        pencil = Descriptor.of(np.eye(n), self.A, np.zeros((n, 0)), states=names, inputs=())
        return pencil.poles()

    def zeros(self, *, input: str | None = None, output: str | None = None) -> NDArray[Any]:
        """Return the frequencies at which an output stays zero for an input that is not, 1/s.

        Parameters
        ----------
        input, output : str, optional
            One pair. By default all inputs and outputs together, which must be as many.

        Raises
        ------
        EquationError
            HB-A508 where inputs and outputs are not as many, or the output does not see the input.
        """
        columns = list(range(len(self.inputs))) if input is None else [self._input(input)]
        rows = list(range(len(self.outputs))) if output is None else [self._output(output)]
        n, p = len(self.A), len(columns)
        if len(rows) != p:
            raise EquationError(
                f"{p} inputs and {len(rows)} outputs have no zeros in common",
                code="HB-A508",
                where="zeros",
                hint="name one pair: lin.zeros(input=..., output=...)",
            )
        E = np.zeros((n + p, n + p))
        E[:n, :n] = np.eye(n)
        A = np.block([[self.A, self.B[:, columns]], [self.C[rows], self.D[np.ix_(rows, columns)]]])
        names = tuple(str(k) for k in range(n + p))
        found = analyse(Descriptor.of(E, A, np.zeros((n + p, 0)), states=names, inputs=())).poles
        if found is None:
            raise EquationError(
                "the output does not see the input at any frequency, or not all of them",
                code="HB-A508",
                where="zeros",
                hint="choose another pair of input and output",
            )
        return found

    def damping(self) -> tuple[Damping, ...]:
        """Return natural frequency, damping ratio and time constant of each pole or pair."""
        return damping_of(self.poles())

    @property
    def stable(self) -> bool:
        """Whether all poles have a negative real part."""
        return bool((self.poles().real < 0.0).all())

    def transfer(self, s: ArrayLike) -> NDArray[np.complex128]:
        """Return the transfer matrix at complex frequencies.

        Parameters
        ----------
        s : complex or array of complex, shape (m,)
            1/s.

        Returns
        -------
        array, shape (q, p) or (m, q, p)
            At a pole infinite or nan.
        """
        at = np.asarray(s, dtype=complex)
        one = np.eye(len(self.A))
        found = np.empty((at.size, len(self.outputs), len(self.inputs)), dtype=complex)
        for k, z in enumerate(at.ravel()):
            try:
                inner = np.linalg.solve(z * one - self.A, self.B.astype(complex))
                found[k] = self.C @ inner + self.D
            except np.linalg.LinAlgError:
                found[k] = np.nan
        return found.reshape((*at.shape, len(self.outputs), len(self.inputs)))

    def gain(self) -> Matrix:
        """Return the gain at rest, ``D - C A^-1 B``, shape (q, p); infinite with a pole at 0."""
        with np.errstate(all="ignore"):
            if len(self.A) and not self.poles().all():
                return np.full(self.D.shape, np.inf)
            return np.asarray(self.transfer(0.0).real)

    def bode(
        self,
        frequencies: ArrayLike | None = None,
        *,
        input: str | None = None,
        output: str | None = None,
    ) -> Bode:
        """Return the response to sines.

        Parameters
        ----------
        frequencies : array, shape (m,), optional
            Hz. By default a hundred a decade, from a decade below the slowest pole or zero to one
            above the fastest.
        input, output : str, optional
            A pair, by default the first of each.

        Raises
        ------
        UsageError
            HB-A501 for a name that is not there, HB-A509 for frequencies that are none.
        """
        j, i = self._input(input), self._output(output)
        f = frequencies_of(frequencies, self._rates(i, j))
        return Bode(
            f,
            self.transfer(2j * np.pi * f)[:, i, j],
            self.inputs[j],
            self.outputs[i],
            unit_over(self.output_units[i], self.input_units[j]),
        )

    def margins(self, *, input: str | None = None, output: str | None = None) -> Margins:
        """Return gain and phase margin of one pair, taken as the loop of a negative feedback."""
        j, i = self._input(input), self._output(output)
        return margins_of(
            lambda f: self.transfer(2j * np.pi * np.asarray(f))[..., i, j],
            frequencies_of(None, self._rates(i, j), decades=3.0),
        )

    def step(self, until: float | str | None = None, *, points: int = 501) -> StepResponse:
        """Return the response to a unit step of each input, from the operating point.

        It is propagated exactly, by the exponential of a matrix, from point to point.

        Parameters
        ----------
        until : float or str, optional
            End time, s. By default seven of the slowest time constant, or ten periods of what does
            not settle.
        points : int
            How many, evenly spaced, from 0 on.
        """
        from scipy.linalg import expm

        end = span_of(self.poles()) if until is None else seconds(until, "until")
        n, p = self.B.shape
        if not 0.0 < end < np.inf or points < 2:
            raise UsageError(
                f"a step response of {points} points until {end:g} s",
                code="HB-A509",
                where="until",
                hint="a positive time, and two points or more",
            )
        t = np.linspace(0.0, end, points)
        whole = np.zeros((n + p, n + p))
        whole[:n, :n], whole[:n, n:] = self.A, self.B
        ahead = expm(whole * t[1])[:n]
        x = np.zeros((points, n, p))
        for k in range(1, points):
            x[k] = ahead[:, :n] @ x[k - 1] + ahead[:, n:]
        y = np.einsum("qn,mnp->mqp", self.C, x) + self.D
        return StepResponse(t, y, self.inputs, self.outputs, self.input_units, self.output_units)

    # -- other forms

    @property
    def state_space(self) -> StateSpace:
        """The same matrices as `hb.state_space` has them."""
        return StateSpace(
            self.A, self.B, self.C, self.D, self.states, self.inputs, self.outputs,
            dict(self.mode), self.shifts,
        )  # fmt: skip

    def to_scipy(self) -> Any:
        """Return a `scipy.signal.StateSpace`."""
        return self.state_space.scipy()

    def to_control(self) -> Any:
        """Return a `control.StateSpace`; HB-E674 without python-control."""
        return self.state_space.control()

    def to_data(self) -> dict[str, Any]:
        """Return plain lists and texts, for JSON; complex numbers as pairs."""
        return {
            "title": self.title,
            "point": self.point,
            "t": self.t,
            "mode": dict(self.mode),
            "exact": self.exact,
            "kinks": list(self.kinks),
            "steady": self.steady,
            "notes": list(self.notes),
            "states": list(self.states),
            "inputs": list(self.inputs),
            "outputs": list(self.outputs),
            "state_units": list(self.state_units),
            "input_units": list(self.input_units),
            "output_units": list(self.output_units),
            "operating": dict(self.operating),
            "A": self.A.tolist(),
            "B": self.B.tolist(),
            "C": self.C.tolist(),
            "D": self.D.tolist(),
            "poles": [[float(p.real), float(p.imag)] for p in self.poles()],
            "stable": self.stable,
        }

    # -- plots

    def plot_bode(
        self,
        path: str | Path | None = None,
        *,
        frequencies: ArrayLike | None = None,
        input: str | None = None,
        output: str | None = None,
    ) -> Figure:
        """Plot magnitude and phase of pairs: of all that respond, if neither is named.

        Six at most, and then the title says of how many; one alone has its margins.
        """
        from hybond.draw.linear_plots import plot_bode

        outputs = self.outputs if output is None else [self.outputs[self._output(output)]]
        inputs = self.inputs if input is None else [self.inputs[self._input(input)]]
        pairs = [(o, i) for o in outputs for i in inputs]
        if frequencies is None and len(pairs) > 1:
            rates = [self._rates(self._output(o), self._input(i)) for o, i in pairs]
            frequencies = frequencies_of(None, np.concatenate(rates))
        whole = [self.bode(frequencies, input=i, output=o) for o, i in pairs]
        found = [b for b in whole if np.any(b.response != 0.0)][:_CURVES] or whole[:1]
        if not found:
            found = [self.bode(frequencies, input=input, output=output)]
        margins = None
        if len(found) == 1:
            margins = self.margins(input=found[0].input, output=found[0].output)
        title = self._heading()
        if not any(np.any(b.response != 0.0) for b in found):
            title = f"no response in this mode: {title}"
        if 1 < len(found) < len(whole):
            title = f"{len(found)} of {len(whole)} pairs of {title}"
        return plot_bode(found, margins=margins, title=title, path=path)

    def plot_nyquist(
        self,
        path: str | Path | None = None,
        *,
        frequencies: ArrayLike | None = None,
        input: str | None = None,
        output: str | None = None,
    ) -> Figure:
        """Plot one pair in the complex plane, with the critical point and the margins."""
        from hybond.draw.linear_plots import plot_nyquist

        if frequencies is None:
            rates = self._rates(self._output(output), self._input(input))
            frequencies = frequencies_of(None, rates, decades=2.0, points=2000)
        found = self.bode(frequencies, input=input, output=output)
        margins = self.margins(input=input, output=output)
        return plot_nyquist(found, margins=margins, title=self._heading(), path=path)

    def plot_step(
        self, path: str | Path | None = None, *, until: float | str | None = None
    ) -> Figure:
        """Plot the step responses: axes for each output, a line for each input."""
        from hybond.draw.linear_plots import plot_step

        return plot_step(self.step(until), title=self._heading(), path=path)

    def plot_poles(
        self,
        path: str | Path | None = None,
        *,
        input: str | None = None,
        output: str | None = None,
    ) -> Figure:
        """Plot poles, and the zeros of one pair, in the plane of s."""
        from hybond.draw.linear_plots import plot_poles

        zeros: NDArray[Any] = np.zeros(0)
        if self.inputs and self.outputs:
            try:
                zeros = self.zeros(
                    input=self.inputs[self._input(input)], output=self.outputs[self._output(output)]
                )
            except EquationError:
                zeros = np.zeros(0)
        return plot_poles(self.poles(), zeros, title=self._heading(), path=path)

    # -- text

    def __str__(self) -> str:
        lines = [f"{self.title or 'the model'} at {self.point}"]
        if self.mode:
            lines.append("mode " + ", ".join(f"{m} = {s}" for m, s in self.mode.items()))
        lines.append(
            "linear in this mode: the matrices do not depend on the point"
            if self.exact
            else "laws are bent: the matrices are those of this point"
        )
        for title, names in (("states", self.states), ("inputs", self.inputs)):
            lines.append(f"{title} " + (", ".join(map(self._valued, names)) or "none"))
        lines.append("outputs " + (", ".join(map(self._valued, self.outputs)) or "none"))
        lines += [f"kink at the point: {k}" for k in self.kinks]
        lines += [f"note: {n}" for n in self.notes]
        lines += [f"pole {d}" for d in self.damping()]
        return "\n".join(lines)

    def __repr__(self) -> str:
        sizes = f"{len(self.states)} states, {len(self.inputs)} inputs, {len(self.outputs)} outputs"
        return f"<Linearisation {self.title!r} at {self.point}: {sizes}>"

    def _repr_html_(self) -> str:
        head = "".join(f"<p>{html.escape(line)}</p>" for line in str(self).splitlines())
        tables = [
            table_of("A", self.A, self.states, self.states),
            table_of("B", self.B, self.states, self.inputs),
            table_of("C", self.C, self.outputs, self.states),
            table_of("D", self.D, self.outputs, self.inputs),
        ]
        return head + "".join(tables)

    # -- names

    def _valued(self, name: str) -> str:
        for names, units in (
            (self.states, self.state_units),
            (self.inputs, self.input_units),
            (self.outputs, self.output_units),
        ):
            if name in names:
                unit = units[names.index(name)]
                return f"{name} ({format_quantity(self.operating[name], unit or '1')})"
        return name

    def _input(self, name: str | None) -> int:
        return _chosen(name, self.inputs, "input")

    def _output(self, name: str | None) -> int:
        return _chosen(name, self.outputs, "output")

    def _rates(self, i: int, j: int) -> NDArray[Any]:
        """Return the poles and the zeros of a pair."""
        try:
            zeros = self.zeros(input=self.inputs[j], output=self.outputs[i])
        except EquationError:
            zeros = np.zeros(0)
        return np.concatenate([self.poles(), zeros])

    def _heading(self) -> str:
        return f"{self.title}: {self.point}" if self.title else self.point


def _chosen(name: str | None, known: Sequence[str], what: str) -> int:
    if name is None and known:
        return 0
    if name is None or name not in known:
        raise UsageError(
            f"no {what} {name!r}" if name else f"the linearisation has no {what}s",
            code="HB-A501",
            where=what,
            hint=did_you_mean(name or "", known) if known else f"name {what}s for hb.linearise",
        )
    return known.index(name)
