"""The gallery: each example with its drawings, equations, plot, events, source and programs."""

from __future__ import annotations

import re
from pathlib import Path

from contents import leaf

import hybond as hb
from hybond.draw import draw_mode
from hybond.errors import HybondError
from hybond.files.whole import write_whole
from hybond.model.graph import FlatGraph, Mode
from hybond.model.parts import SubmodelPart

MODES = 4
"""Modes of a run that are drawn, in the order in which they are entered."""
EVENTS = 30
"""Lines of the event table that are shown."""
FORMULA = 6_000
"""Characters of LaTeX up to which equations are set as a formula; beyond, they are text."""
EQUATIONS = 4_000
"""Characters of equations that are shown as text."""


def write_gallery(files: list[Path], target: Path, *, units: bool = True) -> None:
    """Write a page for each example, and the one that lists them, into a folder.

    Parameters
    ----------
    files : list of Path
        Model files.
    target : Path
    units : bool
        Whether functional mock-up units are made, which compiles each example.
    """
    target.mkdir(parents=True, exist_ok=True)
    rows = ["# Examples", "", "Each runs as it stands: `hybond run examples/NAME.toml`.", ""]
    rows += ["| | |", "| --- | --- |"]
    for file in files:
        title, picture = _page(file, target, units=units)
        rows.append(
            f"| [![{title}]({picture}){{width=220px}}]({file.stem}.md) | "
            f"[{title}]({file.stem}.md) |"
        )
    write_whole(target / "index.md", "\n".join([*rows, ""]))


def _page(file: Path, target: Path, *, units: bool) -> tuple[str, str]:
    """Write the page of one example; return its title and the name of its picture."""
    model = hb.load(file)
    graph = model.flatten()
    run = hb.simulate(model, on_error="return")
    run.plot(path=str(target / f"{file.stem}.png"))
    title = model.title or file.stem
    lines = [f"# {title}", "", "## Bond graph", ""]
    if any(isinstance(e, SubmodelPart) for e in model.elements.values()):
        lines += _of_parts(model, file.stem, target)
    else:
        lines += _drawings(graph, _entered(run, graph), file.stem, target)
    lines += ["", "## Run", "", f"![Signals of the run]({file.stem}.png)", ""]
    if run.error is not None:
        lines += [
            "This example ends in a report, because that is what it shows:",
            "",
            "```text",
            str(run.error),
            "```",
            "",
        ]
    lines += ["## Why it switched", "", "```text", *_events(run), "```", ""]
    lines += ["## Equations of all modes", "", *_equations(graph), ""]
    source = file.read_text(encoding="utf-8")
    write_whole(target / file.name, source)
    lines += ["## Model file", "", "```toml", source.rstrip(), "```", ""]
    lines += [
        "## To take away",
        "",
        f"- {{download}}`{file.name}`",
        *_programs(model, file, target, units),
    ]
    page = leaf("\n".join([*lines, ""]), "index.md", "All examples")
    write_whole(target / f"{file.stem}.md", page)
    return title, f"{file.stem}.png"


def _entered(run: hb.Result, graph: FlatGraph) -> list[Mode]:
    """Return the modes in which time passed, in the order in which they were first entered."""
    seen: dict[Mode, None] = {}
    for segment in run.segments:
        seen.setdefault(segment.mode)
        if len(seen) > MODES:
            break
    return list(seen)[:MODES] or [graph.start_mode]


def _drawings(graph: FlatGraph, modes: list[Mode], stem: str, target: Path) -> list[str]:
    """Draw modes; return the lines that show them beside each other."""
    lines = ["```{raw} html", '<div class="modes">']
    for k, mode in enumerate(modes):
        name = f"{stem}_{k}.svg"
        draw_mode(graph, mode, title=False, legend=False).save(target / name)
        picture = re.sub(r"<\?xml.*?\?>", "", (target / name).read_text(encoding="utf-8"))
        lines += [f"<figure>{picture.strip()}</figure>"]
    return [*lines, "</div>", "```"]


def _of_parts(model: hb.Model, stem: str, target: Path) -> list[str]:
    """Draw a model of parts: with symbols, and its bond graph without what decides nothing."""
    lines = []
    for name, options in (
        ("parts", {"schematic": True}),
        ("graph", {"simplify": True, "legend": False}),
    ):
        picture = f"{stem}_{name}.svg"
        model.draw(**options).save(target / picture)
        lines += [f"![{name} of {stem}]({picture})", ""]
    return lines


def _events(run: hb.Result) -> list[str]:
    lines = str(run.events).splitlines()
    return lines if len(lines) <= EVENTS else [*lines[:EVENTS], f"... {len(lines) - EVENTS} more"]


def _equations(graph: FlatGraph) -> list[str]:
    """Return the mixed-Boolean equations as a formula where they are short, else as text."""
    try:
        found = hb.state_equations(graph)
        latex = found.latex()
    except HybondError as error:
        return ["```text", str(error), "```"]
    notes = re.findall(r"^% (.*)$", latex, re.MULTILINE)
    body = re.sub(r"^%.*$\n?", "", latex, flags=re.MULTILINE).strip()
    if len(body) <= FORMULA:
        from latex2mathml.converter import convert

        formula = convert(body, display="block")
        shown = ["```{raw} html", f'<div class="formula">{formula}</div>', "```"]
    else:
        text = str(found)
        cut = text if len(text) <= EQUATIONS else text[:EQUATIONS].rpartition("\n")[0] + "\n..."
        shown = ["```text", cut, "```"]
    return [*shown, *(["", *(f"- `{note}`" for note in notes)] if notes else [])]


def _programs(model: hb.Model, file: Path, target: Path, units: bool) -> list[str]:
    """Write the example as C and as a unit; return the lines that offer them."""
    lines = []
    for to, suffix in (("c", ".c"), ("fmu", ".fmu")):
        if to == "fmu" and not units:
            continue
        try:
            hb.export(model, to=to, path=target / f"{file.stem}{suffix}")
            lines.append(f"- {{download}}`{file.stem}{suffix}`")
        except HybondError as error:
            lines.append(f"- not as {to}: {str(error).splitlines()[0]}")
    return lines
