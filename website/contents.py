"""The order of the pages: what a reader begins with, and what stands where."""

from __future__ import annotations

GROUPS: dict[str, tuple[str, ...]] = {
    "Start": ("tutorial", "studio"),
    "Coming from": (
        "coming_from/20_sim",
        "coming_from/bond_graph_tools",
        "coming_from/modelica",
        "coming_from/simscape",
        "coming_from/plecs_and_spice",
        "coming_from/hybrsim",
    ),
    "How to": (
        "library",
        "drives",
        "systems",
        "circuits",
        "drawing",
        "runs",
        "results",
        "measurements",
        "linear",
        "sensitivity",
        "periodic",
        "ensembles",
        "sweeps",
        "bifurcation",
        "blocks",
        "export",
        "testing",
    ),
    "Explained": (
        "semantics",
        "causality",
        "equations",
        "structure",
        "complementarity",
        "time_stepping",
        "sliding",
        "verification",
        "restitution",
        "residuals",
        "switching",
        "speed",
    ),
    "Reference": (
        "elements",
        "model_files",
        "solvers",
        "cli",
        "reference/verbs",
        "reference/index",
        "library/index",
        "errors/index",
    ),
    "Examples": ("gallery/index",),
    "The house": ("architecture", "rooms", "contributing", "versions", "changelog"),
}
"""Pages by the heading under which the site lists them."""


def toctree(pages: tuple[str, ...] | list[str], *, caption: str = "", depth: int = 1) -> str:
    """Return a hidden table of contents in MyST."""
    head = f":caption: {caption}\n" if caption else ""
    listed = "\n".join(pages)
    return f"```{{toctree}}\n:hidden:\n:maxdepth: {depth}\n{head}\n{listed}\n```\n"


def leaf(text: str, back: str, called: str) -> str:
    """Return a page that only the list above it leads to, with a way back to that list.

    Hundreds of such pages in the table of contents beside every page would be found by nobody, and
    make each page slow.
    """
    return f"---\norphan: true\n---\n\n[{called}]({back})\n\n{text}"


def contents() -> str:
    """Return the tables of contents of all groups."""
    return "\n".join(toctree(pages, caption=name) for name, pages in GROUPS.items())
