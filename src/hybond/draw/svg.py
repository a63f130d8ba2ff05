"""Write a scene as one self-contained SVG text.

Each mark carries its role as class names (``bond``, ``barb``, ``stroke dynamic``, ``node
junction controlled off``); the style sheet inside is scoped to drawings with the same words and
follows the reader's light or dark theme. Of several drawings in one page, as in a notebook, a later
sheet would win over an earlier one: it says how a stroke looks, and not what a derivative one has.
"""

from __future__ import annotations

from collections.abc import Collection
from html import escape
from zlib import crc32

from hybond.draw.scene import Band, Frame, Line, Mark, Scene, printable
from hybond.draw.style import FONT, PAPER, STYLES, Style

KIND = "hybond-graph"
"""The class of all drawings."""


def write_svg(scene: Scene) -> str:
    """Return the SVG text of a scene.

    Examples
    --------
    >>> from hybond.draw.scene import Group, Text
    >>> text = Text("name", "a < b", 5.0, 10.0)
    >>> "a &lt; b" in write_svg(Scene(50.0, 20.0, (Group("node", "n", "", (text,)),)))
    True
    """
    words = {w for g in scene.groups for m in g.marks for w in m.role.split()}
    width, height = _number(scene.width), _number(scene.height)
    label = _text(scene.title or "bond graph")
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" class="{KIND} {scope_of(words)}" role="img" '
        f'width="{width}" height="{height}" viewBox="0 0 {width} {height}" aria-label="{label}">',
        f"<title>{label}</title>",
        f"<style>{style_sheet(words)}</style>",
        f'<rect class="paper" width="{width}" height="{height}"/>',
    ]
    for group in scene.groups:
        key = f' data-{group.name}="{_text(group.key)}"' if group.key else ""
        parts.append(f'<g class="{group.name}-group"{key}>')
        if group.about:
            parts.append(f"<title>{_text(group.about)}</title>")
        parts.extend(_mark(m) for m in group.marks)
        parts.append("</g>")
    parts.append("</svg>")
    return "\n".join(parts) + "\n"


def scope_of(words: Collection[str]) -> str:
    """Return the class of drawings that have these words, and so the same style sheet."""
    return f"hybond-{crc32(' '.join(sorted(words)).encode()):08x}"


def style_sheet(words: Collection[str]) -> str:
    """Return the CSS of some words of roles, scoped to the drawings that have just these."""
    scope = scope_of(words)
    rules = [
        # Within a medium, because simple converters take the height literally.
        f"@media screen{{.{scope}{{max-width:100%;height:auto}}}}",
        f".{scope}{{font-family:{FONT}}}",
        f".{scope} .paper{{fill:{PAPER[0]}}}",
        f".{scope} path,.{scope} rect{{fill:none}}",
        f".{scope} path{{stroke-linecap:butt}}",
        f".{scope} .bond,.{scope} .barb,.{scope} .cross,"
        f".{scope} .region,.{scope} .emphasis{{stroke-linecap:round}}",
    ]
    dark = [f".{scope} .paper{{fill:{PAPER[1]}}}"]
    for word, style in STYLES.items():
        if word not in words:
            continue
        plain = _declarations(style)
        if plain:
            rules.append(f".{scope} .{word}{{{plain}}}")
        if style.ink is None:
            continue
        # A word's colour is the stroke of its lines and the fill of its texts.
        for sheet, ink in zip((rules, dark), style.ink, strict=True):
            if style.size is None or style.width is not None:
                lines = f".{scope} path.{word},.{scope} rect.{word}"
                sheet.append(f"{lines}{{stroke:{ink}}}")
            sheet.append(f".{scope} text.{word}{{fill:{ink}}}")
        for sheet, fill in zip((rules, dark), style.fill or (), strict=False):
            shape = "path" if word == "filled" else "rect"
            sheet.append(f".{scope} {shape}.{word}{{fill:{fill}}}")
    return "\n".join(rules) + "\n@media (prefers-color-scheme:dark){\n" + "\n".join(dark) + "\n}"


def _declarations(style: Style) -> str:
    found = []
    if style.width is not None:
        found.append(f"stroke-width:{style.width}")
    if style.dash is not None:
        found.append(f"stroke-dasharray:{style.dash[0]} {style.dash[1]}")
    if style.size is not None:
        found.append(f"font-size:{style.size}px")
    if style.bold is not None:
        found.append(f"font-weight:{'bold' if style.bold else 'normal'}")
    if style.italic is not None:
        found.append(f"font-style:{'italic' if style.italic else 'normal'}")
    return ";".join(found)


def _mark(mark: Mark) -> str:
    if isinstance(mark, Line | Band):
        points = "L".join(f"{_number(x)} {_number(y)}" for x, y in mark.points)
        broad = f' stroke-width="{_number(mark.breadth)}"' if isinstance(mark, Band) else ""
        return f'<path class="{mark.role}"{broad} d="M{points}"/>'
    if isinstance(mark, Frame):
        b = mark.box
        return (
            f'<rect class="{mark.role}" x="{_number(b.x0)}" y="{_number(b.y0)}" '
            f'width="{_number(b.x1 - b.x0)}" height="{_number(b.y1 - b.y0)}" '
            f'rx="{_number(mark.radius)}"/>'
        )
    anchor = "" if mark.anchor == "start" else f' text-anchor="{mark.anchor}"'
    return (
        f'<text class="{mark.role}" x="{_number(mark.x)}" y="{_number(mark.y)}"{anchor}>'
        f"{_text(mark.text)}</text>"
    )


def _number(value: float) -> str:
    return f"{round(value, 2) + 0.0:g}" if abs(value) < 1e5 else f"{value:.0f}"


def _text(text: str) -> str:
    """Escape text from anywhere for element content and attributes."""
    return escape(printable(text), quote=True)
