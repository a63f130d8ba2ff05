"""What columns, atoms and Boolean products are called in text, LaTeX and SymPy."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any

from hybond.equations.booleans import Cube, Naming
from hybond.equations.symbolic.rational import Rational
from hybond.equations.symbolic.show import to_latex, to_sympy, to_text
from hybond.model.expressions import Expr, Name, substitute
from hybond.model.expressions import names as names_of
from hybond.model.expressions import to_latex as expr_latex
from hybond.model.expressions import to_text as expr_text
from hybond.model.graph import FlatGraph

KAPPA = "κ"
PLACE = "zqz"
"""A name that no model has, to hold the place of what is already LaTeX."""
MOST_TERMS = 6
"""Terms of a numerator up to which a coefficient is written as a sum of simple fractions."""


class Display:
    """Names for one graph.

    Parameters
    ----------
    naming : Naming
        Its Boolean variables.
    meaning : dict
        Formulas of atoms that are not names (`Atoms.meaning`).
    """

    def __init__(self, graph: FlatGraph, naming: Naming, meaning: dict[str, Expr]) -> None:
        self.graph = graph
        self.naming = naming
        self.meaning = meaning
        order = [f"p:{path}" for path in graph.parameters]
        self._rank = {atom: k for k, atom in enumerate(order)}
        own = {name for n in graph.nodes for name in (n.path,)} | set(graph.parameters)
        self._kappa = next(k for k in (KAPPA, "λ", "on") if not any(o.startswith(k) for o in own))

    # -- names

    def name(self, atom: str) -> str:
        """Return a canonical name as the model writes it."""
        kind, _, rest = atom.partition(":")
        graph = self.graph
        if not rest:
            return atom
        match kind:
            case "p":
                return rest
            case "x":
                return graph.storages[int(rest)].path
            case "s":
                return graph.integrals[int(rest)].path
            case "u":
                return graph.inputs[int(rest)].path
            case "e" | "f" if rest.isdigit():
                return self.bond_variable(kind, int(rest))
            case "on":
                return f"{graph.nodes[int(rest)].path}.on"
            case "in":
                m, _, k = rest.partition(":")
                about = graph.machines[int(m)]
                return f"({about.path}.state == {about.states[int(k)]})"
            case "at":
                return expr_text(graph.watches[int(rest)].compare)
            case _:
                return atom

    def bond_variable(self, kind: str, bond: int) -> str:
        """Return a bond's effort or flow as the model writes it."""
        about = self.graph.bonds[bond]
        for at in (about.tail, about.head):
            node = self.graph.nodes[at]
            if not node.is_junction and len(node.ends) == 1:
                return f"{node.path}.{kind}"
        for at in (about.tail, about.head):
            node = self.graph.nodes[at]
            if node.is_junction and kind == ("e" if node.kind == "0" else "f"):
                return f"{node.path}.{kind}"
        return f'"{about.name}".{kind}'

    def order(self, atom: str) -> Any:
        """Return the sorting key of an atom: parameters as declared, then the rest by name."""
        return (self._rank.get(atom, len(self._rank)), self.name(atom))

    def expression(self, e: Expr) -> Expr:
        """Return an expression with names as the model writes them."""
        return substitute(e, {n: Name(self.name(n)) for n in names_of(e)})

    def rational(self, r: Rational) -> str:
        """Return a coefficient as text."""
        return to_text(r, name=self.name, meaning=self.meaning, order=self.order)

    # -- Boolean products

    def kappa(self, position: int) -> str:
        """Return the text of a Boolean variable."""
        name = self.naming.booleans[position].name
        if " = " in name:
            return f"[{name}]"
        symbol = self._kappa
        return symbol if len(self.naming.booleans) == 1 else f"{symbol}_{_identifier(name)}"

    def cube(self, cube: Cube) -> str:
        """Return a product as text, empty for the product of nothing."""
        parts = [self.kappa(v) if value else f"(1 - {self.kappa(v)})" for v, value in cube]
        return "*".join(parts)

    def cube_latex(self, cube: Cube) -> str:
        """Return a product for LaTeX: a bar stands for ``1 - κ``."""
        parts = []
        for v, value in cube:
            name = self.naming.booleans[v].name.replace("_", r"\_")
            if " = " in name:
                machine, _, state = name.partition(" = ")
                body = rf"[\mathrm{{{machine}}} = \mathrm{{{state}}}]"
                parts.append(body if value else rf"(1 - {body})")
                continue
            letter = {KAPPA: r"\kappa", "λ": r"\lambda"}.get(self._kappa, r"\mathrm{on}")
            body = letter if value else rf"\bar{{{letter}}}"
            if len(self.naming.booleans) > 1:
                body += rf"_{{\mathrm{{{name}}}}}"
            parts.append(body)
        return r" \, ".join(parts)

    # -- coefficients of either kind

    def term(self, c: Any, *factors: str) -> str:
        """Return a coefficient times factors given as text, its sign in front."""
        if not isinstance(c, Rational):
            parts = [*(f for f in factors if f)]
            size = "*".join(parts if parts and abs(c) == 1.0 else [f"{abs(c):.6g}", *parts])
            return f"-{size}" if c < 0 else size
        named = {f"\0{k}": text for k, text in enumerate(factors) if text}
        for atom in named:
            c = c * Rational.atom(atom)
        last = len(factors) - 1
        return to_text(
            c,
            name=lambda a: named.get(a) or self.name(a),
            meaning=self.meaning,
            # Booleans first, then the coefficient, then the variable
            order=lambda a: (
                (0 if int(a[1:]) < last or last == 0 else 2, a)
                if a in named
                else (1, self.order(a))
            ),
        )

    def entry(self, terms: Iterable[tuple[Cube, Any]]) -> str:
        """Return a matrix entry: a sum of products times coefficients; ``0`` for none."""
        parts = [
            self.term(piece, self.cube(product), "") if product else self.term(piece)
            for product, c in terms
            for piece in split(c)
        ]
        return joined(parts) if parts else "0"

    def entry_latex(self, terms: Iterable[tuple[Cube, Any]]) -> str:
        """Return a matrix entry for LaTeX."""
        parts = []
        for product, c in terms:
            for piece in split(c):
                body = self.latex(piece)
                if product:
                    negative, size = signed(body)
                    factor = self.cube_latex(product)
                    body = factor if size == "1" else rf"{factor} \, {size}"
                    body = f"-{body}" if negative else body
                parts.append(body)
        return joined(parts) if parts else "0"

    def latex(self, c: Any) -> str:
        """Return a coefficient for LaTeX."""
        if isinstance(c, Rational):
            return to_latex(c, name=self.name, meaning=self.meaning, order=self.order)
        return latex_number(c)

    def latex_times(self, c: Any, variable: str) -> str:
        """Return a coefficient times what is already LaTeX, within its fraction."""
        if not isinstance(c, Rational):
            text = self.latex(c)
            negative, size = signed(text)
            size = variable if size == "1" else rf"{size} \, {variable}"
            return f"-{size}" if negative else size
        text = to_latex(
            c * Rational.atom(PLACE),
            name=lambda a: PLACE if a == PLACE else self.name(a),
            meaning=self.meaning,
            order=lambda a: (1, a) if a == PLACE else (0, self.order(a)),
        )
        return text.replace(expr_latex(Name(PLACE)), variable)

    def latex_name(self, text: str) -> str:
        """Return a signal's name for LaTeX."""
        return expr_latex(Name(text))

    def sympy(self, c: Any) -> Any:
        """Return a coefficient as a SymPy object; needs the extra ``symbolic``."""
        if isinstance(c, Rational):
            return to_sympy(c, name=self.name, meaning=self.meaning)
        import sympy

        return sympy.Float(c)


def split(c: Any) -> list[Any]:
    """Return a coefficient as the sum of simple fractions that it is read as.

    ``(R1 + R2)/(R1*R2*C)`` is ``1/(R2*C) + 1/(R1*C)``: one term per branch of the network.
    """
    if not isinstance(c, Rational) or not 1 < len(c.numerator.terms) <= MOST_TERMS:
        return [c]
    whole, rest = Rational.of(1), []
    for factor, power in c.denominator.items():
        if len(factor.terms) > 1:
            return [c]
        whole = whole * Rational.from_polynomial(factor) ** power
    for monomial, k in c.numerator.terms.items():
        term = Rational.of(k)
        for atom, power in monomial:
            term = term * Rational.atom(atom) ** power
        rest.append(term / whole)
    return rest


def joined(parts: list[str]) -> str:
    """Return terms, each with its sign in front, as a sum."""
    text = parts[0]
    for part in parts[1:]:
        text += f" - {part[1:].lstrip()}" if part.startswith("-") else f" + {part}"
    return text


def signed(text: str) -> tuple[bool, str]:
    """Split a leading sign off a term, if it belongs to the whole of it."""
    if text.startswith("-") and not re.search(r" [+-] ", _outer(text)):
        return True, text[1:].lstrip()
    return False, text


def _outer(text: str) -> str:
    """Return `text` without what stands in brackets."""
    depth, kept = 0, []
    for c in text:
        if c in "([{":
            depth += 1
        if depth == 0:
            kept.append(c)
        if c in ")]}":
            depth -= 1
    return "".join(kept)


def _identifier(text: str) -> str:
    return re.sub(r"[^0-9A-Za-z_.=]", "_", text)


def latex_number(value: float) -> str:
    r"""Return a number for LaTeX, with six digits.

    Examples
    --------
    >>> print(latex_number(0.25), latex_number(1.5e-7))
    0.25 1.5 \cdot 10^{-7}
    """
    text = f"{value:.6g}"
    mantissa, e, power = text.partition("e")
    return rf"{mantissa} \cdot 10^{{{int(power)}}}" if e else text
