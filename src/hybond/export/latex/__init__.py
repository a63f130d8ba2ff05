"""A model as a report for LaTeX: drawing, causality, equations, rules, results."""

from hybond.export.latex.report import to_latex

__all__ = ["to_latex"]
