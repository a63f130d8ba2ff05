"""Pages of the reference that are made: public names, verbs of the command line, parts."""

from __future__ import annotations

import argparse
import inspect
from types import ModuleType

from contents import leaf, toctree

import hybond as hb
from hybond.cli.arguments import VERBS, parser_of_words

KINDS = {
    "A model": (
        *("Model", "Se", "Sf", "C", "I", "R", "G", "TF", "GY", "Zero", "One"),
        *("Integral", "Input", "Sampled", "Block", "FMU", "Submodel"),
    ),
    "Files and circuits": (
        *("load", "loads", "save", "dumps"),
        *("read_circuit", "Conversion", "read_bond_graph"),
    ),
    "Runs": (
        *("simulate", "Result", "Signal", "State", "load_state", "run_script", "Step"),
        *("Auto", "RK45", "Radau", "Exact", "RK4", "Euler", "QSS", "LIQSS", "MoreauJean"),
        *("Hysteresis", "Limits", "Journal"),
        *("ensemble", "Ensemble", "cross_check", "CrossCheck"),
    ),
}
"""Public names by what they are for; what is in none of these is listed by what it is."""


def names() -> dict[str, list[str]]:
    """Return all public names by heading."""
    found = {kind: [n for n in listed if n in hb.__all__] for kind, listed in KINDS.items()}
    rest = sorted({n for n in hb.__all__ if not n.startswith("_")} - set().union(*found.values()))
    is_error = {
        n for n in rest if inspect.isclass(o := getattr(hb, n)) and issubclass(o, Exception)
    }
    found["What follows from a model"] = [n for n in rest if n not in is_error]
    found["Errors"] = [n for n in rest if n in is_error]
    return found


def pages() -> dict[str, str]:
    """Return the text of every made page of the reference by its path without suffix."""
    made = {
        f"reference/{name}": leaf(public(name), "index.md", "All public names")
        for listed in names().values()
        for name in listed
    }
    made["reference/index"] = overview()
    made["reference/verbs"] = verbs()
    return made


def overview() -> str:
    """Return the page that lists all public names."""
    lines = ["# Python: public names", "", "`import hybond as hb`; names are imported when used."]
    for kind, listed in names().items():
        lines += ["", f"## {kind}", "", "| name | |", "| --- | --- |"]
        lines += [f"| [`hb.{name}`]({name}.md) | {first_line(name)} |" for name in listed]
    return "\n".join([*lines, ""])


def first_line(name: str) -> str:
    """Return what a public name is, in a line."""
    said = inspect.getdoc(getattr(hb, name)) or ""
    return " ".join(said.partition("\n\n")[0].split()).replace("|", "\\|")


def public(name: str) -> str:
    """Return the page of a public name, made from its docstrings."""
    what = getattr(hb, name)
    if isinstance(what, ModuleType):
        body = [f".. automodule:: {what.__name__}", f"   :members: {', '.join(_own(what))}"]
        body += ["   :imported-members:"]
    elif inspect.isclass(what):
        body = [f".. autoclass:: hybond.{name}", "   :members:"]
        if issubclass(what, Exception):
            body += ["   :show-inheritance:"]
        elif any(base.__module__.startswith("hybond") for base in what.__mro__[1:]):
            body += ["   :inherited-members:"]  # a class in two files is one for readers
    elif callable(what):
        body = [f".. autofunction:: hybond.{name}"]
    else:
        body = [f".. autodata:: hybond.{name}"]
    return "\n".join([f"# hb.{name}", "", "```{eval-rst}", *body, "```", ""])


def verbs() -> str:
    """Return the page of all verbs of the command line, as ``--help`` says them."""
    parser = parser_of_words()
    chosen = next(a for a in parser._actions if isinstance(a, argparse._SubParsersAction))
    lines = ["# Verbs of the command line", "", "As `hybond VERB --help` prints them."]
    for verb, said in VERBS.items():
        shown = chosen.choices[verb].format_help().rstrip()
        lines += ["", f"## hybond {verb}", "", f"{said[0].upper()}{said[1:]}.", ""]
        lines += ["```text", shown, "```"]
    return "\n".join([*lines, ""])


def library(domains: list[str]) -> str:
    """Return the page that lists the pages of parts."""
    lines = ["# All parts", "", "| domain | parts |", "| --- | --- |"]
    for domain in domains:
        mine = [n for n in hb.library.names() if n.startswith(domain + ".")]
        links = ", ".join(
            f"[{n.partition('.')[2]}]({domain}.md#{n.replace('.', '')})" for n in mine
        )
        lines.append(f"| [{domain}]({domain}.md) | {links} |")
    return "\n".join([*lines, "", toctree(domains)])


def _own(room: ModuleType) -> list[str]:
    """Return the names that a room offers and that are hybond's."""
    offered = getattr(room, "__all__", None) or [n for n in vars(room) if not n.startswith("_")]
    return [
        n for n in offered if str(getattr(getattr(room, n), "__module__", "")).startswith("hybond")
    ]
