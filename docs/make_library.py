"""Write the pages of the library and its drawings from the files of the parts.

Run `python docs/make_library.py` after a change of a part; a test says when it was forgotten.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path

import hybond as hb
from hybond.draw import draw
from hybond.library import Line, Port, Sheet
from hybond.units import DOMAINS

DOCS = Path(__file__).parent


def pages(
    sheet_of: Callable[[str], Sheet] = hb.library.sheet,
) -> dict[Path, Callable[[], str]]:
    """Return what makes the text of every page and drawing, by its path below docs."""
    found: dict[Path, Callable[[], str]] = {}
    sheets = [sheet_of(name) for name in hb.library.names()]
    for domain in sorted({domain_of(sheet) for sheet in sheets}):
        mine = [sheet for sheet in sheets if domain_of(sheet) == domain]
        found[Path("library", f"{domain}.md")] = partial(text_of, domain, mine)
        found |= {drawing_of(s): partial(drawing, s) for s in mine if has_graph(s)}
    return found


def domain_of(sheet: Sheet) -> str:
    return sheet.name.partition(".")[0]


def has_graph(sheet: Sheet) -> bool:
    """Return whether there is a bond graph to draw: most of control is signals alone."""
    model = hb.library.part(sheet.name)
    return bool(model.elements) and bool(model.flatten().nodes)


def drawing_of(sheet: Sheet) -> Path:
    return Path("img", "library", f"{sheet.name.replace('.', '_')}.svg")


def drawing(sheet: Sheet) -> str:
    """Return the bond graph of a part as SVG, without strokes: they depend on the model around."""
    model = hb.library.part(sheet.name)
    marks = {target: ("port", "blue") for target in model.ports.values()}
    return draw(model, marks=marks, title=False, legend=False).svg()


def text_of(domain: str, sheets: Sequence[Sheet]) -> str:
    return "\n".join(page(domain, sheets)) + "\n"


def page(domain: str, sheets: Sequence[Sheet]) -> Iterator[str]:
    yield f"# Parts: {domain}"
    yield ""
    yield "<!-- docs/make_library.py writes this page from the files of the parts -->"
    yield ""
    yield "[Ready parts](../library.md) says how they are joined and what parameters, inputs and"
    yield "signals are."
    yield ""
    yield "| part | |"
    yield "| --- | --- |"
    for sheet in sheets:
        yield f"| [`{sheet.name}`](#{anchor(sheet.name)}) | {sheet.title} |"
    for sheet in sheets:
        yield from section(sheet)


def anchor(name: str) -> str:
    """Return what a heading is called in a link: without its dot."""
    return name.replace(".", "")


def section(sheet: Sheet) -> Iterator[str]:
    yield ""
    yield f"## {sheet.name}"
    yield ""
    yield f"**{sheet.title}.** {sheet.about}"
    if has_graph(sheet):
        yield ""
        yield f"![Bond graph of {sheet.name}](../{drawing_of(sheet).as_posix()})"
    yield from table("port", "what is joined there shares", [port_row(p) for p in sheet.ports])
    yield from table("parameter", "value", [row(line) for line in sheet.parameters])
    yield from table("input", "unless given", [row(line) for line in sheet.inputs])
    yield from table("signal", "unit", [signal_row(line) for line in sheet.signals])


def table(first: str, second: str, rows: Sequence[Sequence[str]]) -> Iterator[str]:
    if not rows:
        return
    yield ""
    yield f"| {first} | {second} | |"
    yield "| --- | --- | --- |"
    for cells in rows:
        yield "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def port_row(port: Port) -> tuple[str, str, str]:
    domain = DOMAINS[port.domain]
    unit = domain.effort_unit if port.shares == "effort" else domain.flow_unit
    return f"`{port.name}`", f"{port.shares}, {unit}", port.domain


def row(line: Line) -> tuple[str, str, str]:
    unit = f" {line.unit}" if line.unit and line.unit not in line.value else ""
    return f"`{line.name}`", f"`{line.value}`{unit}", line.about


def signal_row(line: Line) -> tuple[str, str, str]:
    return f"`{line.name}`", line.unit, line.about or f"`{line.value}`"


def write() -> None:
    """Write what is not there already, and take away what belongs to no part."""
    made = pages()
    for folder in ("library", "img/library"):
        (DOCS / folder).mkdir(parents=True, exist_ok=True)
        for path in (DOCS / folder).iterdir():
            if path.relative_to(DOCS) not in made:
                path.unlink()
    for path, make in made.items():
        target, text = DOCS / path, make()
        if not target.exists() or target.read_text(encoding="utf-8") != text:
            target.write_text(text, encoding="utf-8")
            print(target.relative_to(DOCS.parent))


if __name__ == "__main__":
    write()
