"""Transfer functions of one mode: ``C (sE - A)^-1 B + D``, in symbols or exact numbers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hybond.equations.display import Display, joined
from hybond.equations.peeling import Peeling
from hybond.equations.ring import Row, Symbols
from hybond.equations.state_form import StateEquations
from hybond.equations.symbolic.polynomial import Polynomial
from hybond.equations.symbolic.rational import Rational
from hybond.equations.symbolic.show import to_latex, to_sympy, to_text
from hybond.errors import EquationError
from hybond.model.expressions import names as names_of
from hybond.model.expressions import to_text as to_text_of
from hybond.model.graph import Mode

S = "\0s"
"""The complex frequency: an atom that no parameter can be mistaken for."""


Vector = NDArray[np.float64]


@dataclass(frozen=True)
class TransferFunctions:
    """Transfer functions from every input to every output of one mode."""

    outputs: tuple[str, ...]
    inputs: tuple[str, ...]
    entries: Mapping[tuple[str, str], Rational]
    """Output and input to a rational function of ``s`` (in 1/s, the complex frequency) and of
    parameters. A pair without influence has none."""
    display: Display
    values: Mapping[str, float]
    """The model's values of the names in `entries`."""
    notes: tuple[str, ...] = ()
    """What the functions leave out."""

    def __getitem__(self, key: tuple[str, str]) -> str:
        return self._text(self.entries[key]) if key in self.entries else "0"

    def polynomials(self, output: str, source: str) -> tuple[Vector, Vector]:
        """Return numerator and denominator in numbers, highest power of s first.

        Raises
        ------
        EquationError
            HB-Q101 if a coefficient reads the state.
        """
        r = self.entries.get((output, source))
        if r is None:
            return np.zeros(1), np.ones(1)
        bottom = Rational.of(1)
        for factor, power in r.denominator.items():
            bottom = bottom * Rational.from_polynomial(factor) ** power
        return self._numbers(r.numerator), self._numbers(bottom.numerator)

    def _numbers(self, p: Polynomial) -> Vector:
        powers = self._by_power(p)
        found = np.zeros(max(powers, default=0) + 1)
        for power, c in powers.items():
            try:
                found[len(found) - 1 - power] = c.evaluate(self.values)
            except KeyError as missing:
                raise EquationError(
                    f"a coefficient reads {self.display.name(missing.args[0])}, which has no value",
                    code="HB-Q101",
                    where="the transfer function",
                    hint="a transfer function belongs to a mode with constant coefficients",
                ) from None
        return found

    def response(self, output: str, source: str, s: Any) -> Any:
        """Return the values at complex frequencies, 1/s: a number or an array, as `s` is.

        Examples
        --------
        A Bode plot has ``s = 2j*pi*f``:

        >>> import hybond as hb
        >>> import numpy as np
        >>> m = hb.Model("rc")
        >>> m.add(V=hb.Se(1), j=hb.One(), r=hb.R(2), c=hb.C(1))
        >>> m.bond("V -> j -> r", "j -> c")
        >>> t = hb.state_equations(m, outputs=["c.e"]).transfer()
        >>> np.abs(t.response("c.e", "V", 1j * np.array([0.0, 0.5]))).round(4).tolist()
        [1.0, 0.7071]
        """
        top, bottom = self.polynomials(output, source)
        return np.polyval(top, s) / np.polyval(bottom, s)

    def text(self) -> str:
        """Return one line per pair with influence."""
        lines = [
            f"{output} / {source} = {self._text(r)}" for (output, source), r in self.entries.items()
        ]
        lines = lines or ["no output reacts to a source"]
        return "\n".join([*lines, *(f"# {note}" for note in self.notes)])

    def latex(self) -> str:
        """Return one LaTeX line per pair with influence."""
        show = self.display
        lines = []
        for (output, source), r in self.entries.items():
            left = rf"\frac{{{show.latex_name(output)}}}{{{show.latex_name(source)}}}"
            right = to_latex(r, name=self._name, meaning=show.meaning, order=self._order)
            lines.append(f"{left} &= {right}")
        if not lines:
            return "% no output reacts to a source"
        return "\\begin{align*}\n" + " \\\\\n".join(lines) + "\n\\end{align*}"

    def sympy(self, output: str, source: str) -> Any:
        """Return one transfer function as a SymPy expression."""
        show = self.display
        return to_sympy(self.entries[output, source], name=self._name, meaning=show.meaning)

    @property
    def symbol(self) -> str:
        """How the complex frequency is written: ``s``, unless a parameter has that name."""
        taken = {self.display.name(a) for r in self.entries.values() for a in r.atoms() if a != S}
        return next(name for name in ("s", "p", "s_", "p_") if name not in taken)

    def _name(self, atom: str) -> str:
        return self.symbol if atom == S else self.display.name(atom)

    def _text(self, r: Rational) -> str:
        """Return a ratio of polynomials in s, collected by powers of s."""
        bottom = Rational.of(1)
        for factor, power in r.denominator.items():
            bottom = bottom * Rational.from_polynomial(factor) ** power
        above, below = self._collected(r.numerator), self._collected(bottom.numerator)
        if below == "1":
            return above
        if not _single(above):
            above = f"({above})"
        return f"{above}/{below}" if _single(below, "*") else f"{above}/({below})"

    @staticmethod
    def _by_power(p: Polynomial) -> dict[int, Rational]:
        powers: dict[int, Rational] = {}
        for monomial, c in p.terms.items():
            term, power = Rational.of(c), 0
            for atom, k in monomial:
                if atom == S:
                    power = k
                else:
                    term = term * Rational.atom(atom) ** k
            powers[power] = powers[power] + term if power in powers else term
        return powers

    def _collected(self, p: Polynomial) -> str:
        powers = self._by_power(p)
        show, symbol = self.display, self.symbol
        parts = []
        for power in sorted(powers, reverse=True):
            text = to_text(powers[power], name=show.name, meaning=show.meaning, order=show.order)
            if power:
                s = symbol if power == 1 else f"{symbol}^{power}"
                negative = _single(text) and text.startswith("-")
                size = text[1:] if negative else text
                size = s if size == "1" else f"{size}*{s}" if _single(size) else f"({size})*{s}"
                text = f"-{size}" if negative else size
            parts.append(text)
        return joined(parts) if parts else "0"

    def _order(self, atom: str) -> Any:
        return (1, atom) if atom == S else (0, self.display.order(atom))

    def __str__(self) -> str:
        return self.text()


def _single(text: str, also: str = "") -> bool:
    """Whether a text needs no brackets beside a product (or, below a fraction, `also`)."""
    return " + " not in text and " - " not in text and not (also and also in text)


def transfer_functions(eq: StateEquations[Any], mode: Mode) -> TransferFunctions:
    """Return the transfer functions of one mode.

    Parameters
    ----------
    eq : StateEquations
        With outputs. Numbers are taken as exact decimals.

    Raises
    ------
    EquationError
        HB-Q103 for a nonlinear law, HB-Q105 if the mode's equations are singular.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("rc", parameters={"R": "2 ohm", "C": "1 F"})
    >>> m.add(V=hb.Se(1), j=hb.One(), r=hb.R("R"), c=hb.C("C"))
    >>> m.bond("V -> j -> r", "j -> c")
    >>> eq = hb.state_equations(m, outputs=["c.e"])
    >>> print(transfer_functions(eq, ()))
    c.e / V = 1/(R*C*s + 1)
    """
    ring = eq.ring if isinstance(eq.form.ring, Symbols) else Symbols({})
    exact = (lambda c: c) if eq.symbolic else Rational.of
    s = Rational.atom(S)
    n = len(eq.states)
    rows: list[Row[Rational]] = []
    for mixed in eq.rows:
        rows.append(_in_s(eq, mixed.at(mode, eq.ring), n, s, exact))
    solution = Peeling(ring, rows, n)
    stored = len(eq.graph.storages)
    if any(k < stored for k in solution.free()) or solution.constraints:
        raise EquationError(
            "the equations of this mode do not determine all states, or contradict each other",
            code="HB-Q105",
            where=eq.graph.mode_text(mode),
            hint="hybond analyse tells what is undetermined",
        )
    entries = {}
    for name, mixed in zip(eq.output_names, eq.outputs, strict=True):
        row = solution.reduce(_in_s(eq, mixed.at(mode, eq.ring), n, s, exact))
        if any(k < n for k in row):
            raise EquationError(
                f"this mode leaves the output {name} undetermined",
                code="HB-Q105",
                where=eq.graph.mode_text(mode),
                hint="a floating node, a ring of ideal switches: choose another output",
            )
        for k, c in sorted(row.items()):
            entries[name, eq.inputs[k - n]] = c
    return TransferFunctions(
        eq.output_names, eq.inputs, entries, eq.display, eq.values, tuple(_left_out(eq, entries))
    )


def _left_out(
    eq: StateEquations[Any], entries: Mapping[tuple[str, str], Rational]
) -> Iterator[str]:
    """Say what of the model the functions do not have: integrated signals, moduli that move."""
    driving = {source for _, source in entries}
    for k in eq.sources:
        name, e = eq.source_name(k), eq.column(k).formula
        if name not in driving or e is None:
            continue
        read = sorted(n for n in names_of(e) if n.startswith(("s:", "x:", "e:", "f:")))
        if read:
            moving = ", ".join(eq.display.name(n) for n in read)
            yield (
                f"{name} stands for {to_text_of(eq.display.expression(e))}: that it reads {moving} "
                "is not in the loop"
            )
    atoms = {a for r in entries.values() for a in r.atoms() if a != S and not a.startswith("p:")}
    if atoms:
        frozen = ", ".join(sorted(eq.display.name(a) for a in atoms))
        yield f"{frozen} held constant"


def _in_s(eq: StateEquations[Any], row: Row[Any], n: int, s: Rational, exact: Any) -> Row[Rational]:
    """Return a row with states as unknowns 0..n-1, rates as s times them, inputs from n on."""
    found: Row[Rational] = {}
    for k, c in row.items():
        kind, j = eq.place[k]
        if kind == "law":
            eq.refuse(k)
        column = n + j if kind == "input" else j
        value = exact(c) * s if kind == "rate" else exact(c)
        found[column] = found[column] + value if column in found else value
    return {k: c for k, c in found.items() if not c.is_zero}
