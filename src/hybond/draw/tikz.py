r"""Write a scene as TikZ, for papers: ``\usepackage{tikz}`` is all that it needs.

One unit is a pixel of the scene, 1/96 inch, with y downwards as in the scene. Each role has a
style ``hb ...`` at the top, where a paper may change it for the whole picture. The text is pure
ASCII, so that every engine of LaTeX reads it.
"""

from __future__ import annotations

from hybond.draw.scene import Band, Frame, Line, Mark, Scene, printable
from hybond.draw.style import look
from hybond.draw.tex import escape, font_size

_BP = 0.75
"""Big points (1/72 inch) per pixel."""


def write_tikz(scene: Scene, *, document: bool = False) -> str:
    r"""Return the TikZ text of a scene.

    Parameters
    ----------
    document : bool
        A whole document that LaTeX compiles, rather than a ``tikzpicture`` for ``\input``.

    Examples
    --------
    >>> from hybond.draw.scene import Group, Text
    >>> text = Text("name", "a_1", 5.0, 10.0)
    >>> tikz = write_tikz(Scene(50.0, 20.0, (Group("node", "n", "", (text,)),)))
    >>> tikz.splitlines()[-2]
    '\\node[hb name, hb middle] at (5,10) {a\\_1};'
    """
    lines = [
        r"% Drawn by hybond. In the preamble: \usepackage{tikz}. In the text: \input this file.",
        r"\begin{tikzpicture}[x=0.75bp, y=-0.75bp,",
    ]
    lines += [f"  {style}," for style in _styles(scene)]
    lines.append(
        "  hb start/.style={anchor=base west}, hb middle/.style={anchor=base}, "
        "hb end/.style={anchor=base east}]"
    )
    lines.append(f"\\useasboundingbox (0,0) rectangle ({_n(scene.width)},{_n(scene.height)});")
    for group in scene.groups:
        if group.key:
            # One line of pure ASCII: nothing in a name can end the comment.
            lines.append("% " + group.key.encode("ascii", "replace").decode().replace("\n", " "))
        lines += [_mark(mark) for mark in group.marks]
    lines.append(r"\end{tikzpicture}")
    text = "\n".join(lines) + "\n"
    if document:
        text = (
            "\\documentclass{article}\n\\usepackage{tikz}\n\\pagestyle{empty}\n"
            f"\\usepackage[paperwidth={_n(_BP * scene.width + 20)}bp,"
            f"paperheight={_n(_BP * scene.height + 20)}bp,margin=10bp]{{geometry}}\n"
            "\\setlength{\\parindent}{0pt}\\setlength{\\topskip}{0pt}\n"
            f"\\begin{{document}}%\n{text}\\end{{document}}\n"
        )
    return text


def _styles(scene: Scene) -> list[str]:
    """Return the definition of each style that the scene uses, in the order of first use."""
    found: dict[str, str] = {}
    for group in scene.groups:
        for mark in group.marks:
            name = _style_name(mark)
            if name not in found:
                found[name] = f"{name}/.style={{{_definition(mark)}}}"
    return list(found.values())


def _style_name(mark: Mark) -> str:
    kind = " frame" if isinstance(mark, Frame) else ""
    return f"hb {' '.join(mark.role.split())}{kind}"


def _definition(mark: Mark) -> str:
    style = look(mark.role)
    ink = _colour((style.ink or ("#000000", ""))[0])
    if isinstance(mark, Band):
        return f"draw={ink}, line cap=round, line join=round"
    thick = f"line width={_n(_BP * (style.width or 1.5))}bp"
    dash = ""
    if style.dash:
        on, off = (_n(_BP * d) for d in style.dash)
        dash = f", dash pattern=on {on}bp off {off}bp"
    if isinstance(mark, Frame):
        fill = f", fill={_colour(style.fill[0])}" if style.fill else ""
        return f"draw={ink}{fill}, {thick}{dash}"
    if isinstance(mark, Line):
        words = set(mark.role.split())
        cap = ", line cap=round" if {"bond", "barb", "cross"} & words else ""
        fill = f", fill={_colour(style.fill[0])}" if "filled" in words and style.fill else ""
        return f"draw={ink}{fill}, {thick}{dash}{cap}"
    shape = (r"\bfseries" if style.bold else "") + (r"\itshape" if style.italic else "")
    size, skip = font_size(_BP * (style.size or 11.0))
    font = rf"\fontsize{{{size}}}{{{skip}}}\sffamily{shape}\selectfont"
    return f"text={ink}, inner sep=0, outer sep=0, font={font}"


def _mark(mark: Mark) -> str:
    name = _style_name(mark)
    if isinstance(mark, Frame):
        b = mark.box
        return (
            f"\\draw[{name}, rounded corners={_n(_BP * mark.radius)}bp] "
            f"({_n(b.x0)},{_n(b.y0)}) rectangle ({_n(b.x1)},{_n(b.y1)});"
        )
    if isinstance(mark, Band):
        name += f", line width={_n(_BP * mark.breadth)}bp"
    if isinstance(mark, Line | Band):
        return f"\\draw[{name}] " + " -- ".join(f"({_n(x)},{_n(y)})" for x, y in mark.points) + ";"
    return (
        f"\\node[{name}, hb {mark.anchor}] at ({_n(mark.x)},{_n(mark.y)}) "
        f"{{{escape(printable(mark.text))}}};"
    )


def _colour(ink: str) -> str:
    """Return a colour as TikZ reads it without a definition: ``{rgb,255:red,1;...}``."""
    red, green, blue = (int(ink[k : k + 2], 16) for k in (1, 3, 5))
    return f"{{rgb,255:red,{red};green,{green};blue,{blue}}}"


def _n(value: float) -> str:
    """Return a number without an exponent, to a hundredth."""
    return f"{value:.2f}".rstrip("0").rstrip(".") if abs(value) >= 0.005 else "0"
