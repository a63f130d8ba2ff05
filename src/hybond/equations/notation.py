"""How terms of equations are written: as text, in LaTeX."""

from __future__ import annotations

from typing import Any

from hybond.equations.booleans import Cube
from hybond.equations.display import Display, joined, signed
from hybond.model.expressions import Expr
from hybond.model.expressions import to_latex as expr_latex
from hybond.model.expressions import to_text as expr_text

_DOTS = {1: r"\dot", 2: r"\ddot", 3: r"\dddot"}


class Notation:
    """As text, in the language of expressions."""

    times = "*"

    def __init__(self, show: Display) -> None:
        self.show = show

    def variable(self, name: str) -> str:
        """Return the name."""
        return name

    def rate(self, name: str, order: int = 1) -> str:
        """Return the name with a prime per derivative."""
        return name + "'" * order

    def term(self, c: Any, variable: str, cube: Cube = ()) -> str:
        """Return ``-κ*c*x``."""
        return self.show.term(c, self.show.cube(cube), variable)

    def product(self, cube: Cube) -> str:
        """Return ``κ_1*(1 - κ_2)``."""
        return self.show.cube(cube)

    def brackets(self, inner: str) -> str:
        """Return ``(inner)``."""
        return f"({inner})"

    def formula(self, e: Expr) -> str:
        """Return the expression as text."""
        return expr_text(self.show.expression(e))

    def equals(self, left: str, right: str) -> str:
        """Return ``left = right``."""
        return f"{left} = {right}"

    def every(self, time: str) -> str:
        """Return ``every 1 ms``."""
        return f"  every {time}"

    def grouped(self, cube: Cube, parts: list[str]) -> str:
        """Return Booleans times a sum of terms in brackets."""
        negative = all(p.startswith("-") for p in parts)
        inner = joined(leading([p[1:] if negative else p for p in parts]))
        return f"{'-' if negative else ''}{self.product(cube)}{self.times}{self.brackets(inner)}"


class LatexNotation(Notation):
    """For LaTeX's math mode; equations are aligned."""

    times = r" \, "

    def variable(self, name: str) -> str:
        """Return the name with its index low."""
        return self.show.latex_name(name)

    def rate(self, name: str, order: int = 1) -> str:
        """Return the name with a dot per derivative."""
        if not order:
            return self.variable(name)
        head, mark, tail = self.show.latex_name(name).partition("_")
        if order not in _DOTS:
            return rf"{head}^{{({order})}}{mark}{tail}"
        return rf"{_DOTS[order]}{{{head}}}{mark}{tail}"

    def term(self, c: Any, variable: str, cube: Cube = ()) -> str:
        """Return the term, the variable within the coefficient's fraction."""
        negative, size = signed(
            self.show.latex_times(c, variable) if variable else self.show.latex(c)
        )
        if cube:
            size = self.times.join([self.product(cube), size])
        return f"-{size}" if negative else size

    def product(self, cube: Cube) -> str:
        """Return the product; a bar stands for ``1 - κ``."""
        return self.show.cube_latex(cube)

    def brackets(self, inner: str) -> str:
        r"""Return ``\left(inner\right)``."""
        return rf"\left({inner}\right)"

    def formula(self, e: Expr) -> str:
        """Return the expression for LaTeX."""
        return expr_latex(self.show.expression(e))

    def equals(self, left: str, right: str) -> str:
        """Return ``left &= right``."""
        return f"{left} &= {right}"

    def every(self, time: str) -> str:
        r"""Return ``\text{every 1 ms}``."""
        return rf" \quad\text{{every {time}}}"


def leading(parts: list[str]) -> list[str]:
    """Return terms with one that has no minus in front, if there is one."""
    first = next((k for k, p in enumerate(parts) if not p.startswith("-")), 0)
    return [parts[first], *parts[:first], *parts[first + 1 :]]


def in_markdown(rows: list[str]) -> str:
    """Return LaTeX equations as one aligned formula of Markdown."""
    body = " \\\\\n".join(rows)
    return f"$$\n\\begin{{aligned}}\n{body}\n\\end{{aligned}}\n$$"


def in_latex(rows: list[str], notes: list[str]) -> str:
    """Return equations as ``align*``; what is to be said besides as comments."""
    comments = "".join(f"\n% {note}" for note in notes)
    return "\\begin{align*}\n" + " \\\\\n".join(rows) + "\n\\end{align*}" + comments
