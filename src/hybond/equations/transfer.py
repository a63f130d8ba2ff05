"""Transfer functions of one mode: ``C (sE - A)^-1 B + D``, in symbols or exact numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from hybond.equations.display import Display, joined
from hybond.equations.peeling import Peeling
from hybond.equations.ring import Row, Symbols
from hybond.equations.state_form import StateEquations
from hybond.equations.symbolic.polynomial import Polynomial
from hybond.equations.symbolic.rational import Rational
from hybond.equations.symbolic.show import to_latex, to_sympy, to_text
from hybond.errors import EquationError
from hybond.model.graph import Mode

S = "s"


@dataclass(frozen=True)
class TransferFunctions:
    """Transfer functions from every input to every output of one mode.

    Parameters
    ----------
    outputs, inputs : tuple of str
    entries : mapping of (str, str) to Rational
        Output and input to a rational function of ``s`` (in 1/s, the complex frequency) and of
        parameters. A pair without influence has none.
    display : Display
    """

    outputs: tuple[str, ...]
    inputs: tuple[str, ...]
    entries: Mapping[tuple[str, str], Rational]
    display: Display

    def __getitem__(self, key: tuple[str, str]) -> str:
        return self._text(self.entries[key]) if key in self.entries else "0"

    def response(
        self, output: str, source: str, s: complex, values: Mapping[str, float]
    ) -> complex:
        """Return the value at the complex frequency `s`, parameters as given."""
        r = self.entries.get((output, source))
        if r is None:
            return 0j
        top, bottom = 0j, 1 + 0j
        for monomial, c in r.numerator.terms.items():
            top += float(c) * _power(monomial, s, values)
        for factor, power in r.denominator.items():
            total = sum(float(c) * _power(m, s, values) for m, c in factor.terms.items())
            bottom *= total**power
        return top / bottom

    def text(self) -> str:
        """Return one line per pair with influence."""
        return "\n".join(
            f"{output} / {source} = {self._text(r)}" for (output, source), r in self.entries.items()
        )

    def latex(self) -> str:
        """Return one LaTeX line per pair with influence."""
        show = self.display
        lines = []
        for (output, source), r in self.entries.items():
            left = rf"\frac{{{show.latex_name(output)}}}{{{show.latex_name(source)}}}"
            right = to_latex(r, name=show.name, meaning=show.meaning, order=self._order)
            lines.append(f"{left} &= {right}")
        return "\\begin{align*}\n" + " \\\\\n".join(lines) + "\n\\end{align*}"

    def sympy(self, output: str, source: str) -> Any:
        """Return one transfer function as a SymPy expression."""
        show = self.display
        return to_sympy(self.entries[output, source], name=show.name, meaning=show.meaning)

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

    def _collected(self, p: Polynomial) -> str:
        powers: dict[int, Rational] = {}
        for monomial, c in p.terms.items():
            term, power = Rational.of(c), 0
            for atom, k in monomial:
                if atom == S:
                    power = k
                else:
                    term = term * Rational.atom(atom) ** k
            powers[power] = powers[power] + term if power in powers else term
        show = self.display
        parts = []
        for power in sorted(powers, reverse=True):
            text = to_text(powers[power], name=show.name, meaning=show.meaning, order=show.order)
            if power:
                s = S if power == 1 else f"{S}^{power}"
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


def _power(monomial: Any, s: complex, values: Mapping[str, float]) -> complex:
    product = 1 + 0j
    for atom, k in monomial:
        product *= (s if atom == S else values[atom]) ** k
    return product


def transfer_functions(eq: StateEquations[Any], mode: Mode) -> TransferFunctions:
    """Return the transfer functions of one mode.

    Parameters
    ----------
    eq : StateEquations
        With outputs. Numbers are taken as exact decimals.
    mode : tuple of int

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
    if solution.free():
        raise EquationError(
            "the equations of this mode do not determine all states",
            code="HB-Q105",
            where=eq.graph.mode_text(mode),
            hint="hybond analyse tells what is undetermined",
        )
    entries = {}
    for name, mixed in zip(eq.output_names, eq.outputs, strict=True):
        row = solution.reduce(_in_s(eq, mixed.at(mode, eq.ring), n, s, exact))
        for k, c in sorted(row.items()):
            entries[name, eq.inputs[k - n]] = c
    return TransferFunctions(eq.output_names, eq.inputs, entries, eq.display)


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
