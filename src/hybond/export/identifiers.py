"""Identifiers of C and Java for what a model's expressions read."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable

from hybond.model.graph import FlatGraph
from hybond.translate.reserved import GLOBALS

_LETTERS = """
    α alpha β beta γ gamma δ delta ε epsilon ζ zeta η eta θ theta ι iota κ kappa λ lambda μ mu ν nu
    ξ xi ο omicron π pi ρ rho σ sigma τ tau υ upsilon φ phi χ chi ψ psi ω omega Γ Gamma Δ Delta
    Θ Theta Λ Lambda Ξ Xi Π Pi Σ Sigma Φ Phi Ψ Psi Ω Omega µ mu
"""
_HEADERS = """
    EOF NULL BUFSIZ FOPEN_MAX FILENAME_MAX TMP_MAX RAND_MAX EXIT_FAILURE EXIT_SUCCESS MB_CUR_MAX
    SEEK_SET SEEK_CUR SEEK_END NAN INFINITY HUGE_VAL HUGE_VALF HUGE_VALL L_tmpnam OVERFLOW UNDERFLOW
    DOMAIN SING PLOSS TLOSS
"""
"""Macros of the headers, as far as a name in capitals could meet one."""


def _greek() -> dict[str, str]:
    words = _LETTERS.split()
    return dict(zip(words[::2], words[1::2]))


def identifier(text: str) -> str:
    """Return a name in letters, digits and underscores.

    Examples
    --------
    >>> identifier("lever.1.e"), identifier("contact -> v"), identifier("1st"), identifier("κ")
    ('lever_1_e', 'contact_to_v', 'x1st', 'kappa')
    """
    letters = _greek()
    said = "".join(letters.get(c, c) for c in text.replace(" -> ", "_to_").replace("->", "_to_"))
    said = re.sub(r"[^A-Za-z0-9]+", "_", said).strip("_") or "x"
    return f"x{said}" if said[0].isdigit() else said


def slot_name(said: str) -> str:
    """Return the identifier of a value that a person calls so.

    Examples
    --------
    >>> slot_name("ball.p"), slot_name('"contact -> v".e'), slot_name("time")
    ('BALL_P', 'CONTACT_TO_V_E', 'NOW')
    """
    return "NOW" if said == "time" else identifier(said).upper()


def distinct(wanted: Iterable[str], taken: Collection[str]) -> list[str]:
    """Return names that differ from each other and from those that are taken.

    Examples
    --------
    >>> distinct(["A", "A", "EOF"], ["B"])
    ['A', 'A_2', 'EOF_2']
    """
    seen = {*taken, *GLOBALS, *_HEADERS.split()}
    found = []
    for name in wanted:
        shown, k = name, 2
        while shown in seen:
            shown, k = f"{name}_{k}", k + 1
        seen.add(shown)
        found.append(shown)
    return found


def spoken(graph: FlatGraph, name: str) -> str:
    """Return what a person calls a canonical name: ``ball.p``, ``contact.on``, ``v.f``."""
    kind, _, rest = name.partition(":")
    match kind:
        case "x":
            return graph.storages[int(rest)].path
        case "s":
            return graph.integrals[int(rest)].path
        case "u":
            return graph.inputs[int(rest)].path
        case "du":
            return f"{graph.inputs[int(rest)].path}.rate"
        case "on":
            return f"{graph.nodes[int(rest)].path}.on"
        case "in":
            m, _, k = rest.partition(":")
            return f"{graph.machines[int(m)].path}.is.{graph.machines[int(m)].states[int(k)]}"
        case "at":
            return f"watch.{rest}"
        case "e" | "f":
            return _bond_variable(graph, kind, int(rest))
    return name


def _bond_variable(graph: FlatGraph, kind: str, bond: int) -> str:
    about = graph.bonds[bond]
    for at in (about.tail, about.head):
        node = graph.nodes[at]
        if not node.is_junction and len(node.ends) == 1 and not node.implied:
            return f"{node.path}.{kind}"
    label, _, written = about.name.partition(": ")
    return f'"{label if written else about.name}".{kind}'
