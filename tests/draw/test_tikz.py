"""TikZ: what a paper gets. Read back by a small parser, and by LaTeX where it is installed."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hybond.draw import draw, draw_hybrid, draw_modes
from hybond.draw.tex import escape

NUMBER = r"(-?\d+(?:\.\d+)?)"
POINT = rf"\({NUMBER},{NUMBER}\)"
DRAW = re.compile(rf"\\draw\[(hb [\w ]+)(?:, [^\]]*)?\] {POINT}((?: -- {POINT})+);")
FRAME = re.compile(rf"\\draw\[(hb [\w ]+)(?:, [^\]]*)?\] {POINT} rectangle {POINT};")
NODE = re.compile(rf"\\node\[(hb [\w ]+), hb (start|middle|end)\] at {POINT} \{{(.*)\}};")
BOX = re.compile(rf"\\useasboundingbox \(0,0\) rectangle {POINT};")


def balanced(text: str) -> bool:
    """Whether the braces that are not escaped match."""
    depth = 0
    for brace in re.findall(r"\\.|[{}]", text, re.S):
        depth += {"{": 1, "}": -1}.get(brace, 0)
        if depth < 0:
            return False
    return depth == 0


def read(tikz: str) -> dict[str, Any]:
    """Read a picture as this writer makes them; anything else is an error."""
    head, _, body = tikz.partition("hb end/.style={anchor=base east}]\n")
    styles = re.findall(r"^  (hb [\w ]+)/\.style=(?!\{anchor)", head, re.M)
    lines = [line for line in body.splitlines() if not line.startswith("%")]
    assert lines[-1] == r"\end{tikzpicture}"
    box = BOX.fullmatch(lines[0])
    assert box is not None
    found: dict[str, Any] = {
        "styles": styles,
        "size": tuple(map(float, box.groups())),
        "lines": [],
        "frames": [],
        "texts": [],
    }
    for line in lines[1:-1]:
        if match := DRAW.fullmatch(line):
            points = [(float(x), float(y)) for x, y in re.findall(POINT, line.partition("] ")[2])]
            found["lines"].append((match[1], points))
        elif match := FRAME.fullmatch(line):
            corners = [(float(match[2]), float(match[3])), (float(match[4]), float(match[5]))]
            found["frames"].append((match[1], corners))
        else:
            match = NODE.fullmatch(line)
            assert match is not None, line
            found["texts"].append((match[1], [(float(match[3]), float(match[4]))], match[5]))
    return found


def pictures(graph: Any, strokes: Any) -> list[Any]:
    mixed = strokes(graph, strokes=tuple(k % 2 for k in range(len(graph.bonds))))
    mark = {graph.nodes[0].path: "uncontrollable"}
    return [
        draw(graph, marks=mark),
        draw(graph, causality=mixed, dynamic_bonds=range(0, len(graph.bonds), 2), numbers=True),
    ]


@pytest.mark.sampled(2)
def test_the_picture_can_be_read_back(example: Any, strokes: Any) -> None:
    for drawing in pictures(example, strokes):
        tikz = drawing.tikz()
        assert tikz.isascii() and balanced(tikz)
        found = read(tikz)
        wide, high = found["size"]
        assert (wide, high) == pytest.approx((drawing.scene.width, drawing.scene.height), abs=0.01)
        used = [style for style, *_ in found["lines"] + found["frames"] + found["texts"]]
        assert set(used) == set(found["styles"])
        assert len(found["styles"]) == len(set(found["styles"]))
        for _, points, *_ in found["lines"] + found["frames"] + found["texts"]:
            for x, y in points:
                assert 0 <= x <= wide and 0 <= y <= high


@pytest.mark.sampled(3)
def test_it_has_the_same_marks_as_the_svg(example: Any, strokes: Any) -> None:
    for drawing in pictures(example, strokes):
        found = read(drawing.tikz())
        root = ElementTree.fromstring(drawing.svg())
        svg: dict[str, list[str]] = {"path": [], "rect": [], "text": []}
        for element in root.iter():
            kind = element.tag.rpartition("}")[2]
            if kind in svg and element.get("class") != "paper":
                svg[kind].append(str(element.get("class")))
        for kind, mine in (("path", "lines"), ("rect", "frames"), ("text", "texts")):
            roles = [style[3:].removesuffix(" frame") for style, *_ in found[mine]]
            assert roles == svg[kind]
        assert sum("stroke" in role.split() for role in svg["path"]) >= len(
            [g for g in drawing.scene.groups if any("stroke" in m.role for m in g.marks)]
        )


def test_ends_of_bonds_are_those_of_the_scene(examples: Any) -> None:
    drawing = draw(examples["motor"]())
    mine = [p for style, p in read(drawing.tikz())["lines"] if style == "hb bond"]
    scene = [m.points for g in drawing.scene.groups for m in g.marks if m.role == "bond"]
    assert len(mine) == len(scene)
    for one, two in zip(mine, scene):
        for (ax, ay), (bx, by) in zip(one, two):
            assert (ax, ay) == pytest.approx((bx, by), abs=0.0051)


VISIBLE = {
    "textasciicircum": "^",
    "textasciitilde": "~",
    "textasciigrave": "`",
}


def printed(tex: str) -> str:
    """Return the ASCII letters that LaTeX prints for a text: a reader of the commands used."""
    tex = re.sub(r"\\ensuremath\{\\?([-<>|{}])\}", r"\1", tex)
    tex = tex.replace(r"\ensuremath{\backslash}", "\0")
    tex = tex.replace("{''}", '"').replace("{'}", "'").replace("{-}", "-")
    return re.sub(
        r"\\(?:([a-z]+)\{\}|([#$%&_]))", lambda m: m[2] or VISIBLE.get(m[1], m[0]), tex
    ).replace("\0", "\\")


@given(st.text(st.characters(min_codepoint=32, max_codepoint=126)))
def test_ascii_is_printed_as_it_is(text: str) -> None:
    assert printed(escape(text)) == text


@given(st.text())
def test_any_text_is_safe(text: str) -> None:
    tex = escape(text)
    assert tex.isascii() and balanced(tex)
    assert not re.search(r"(?<!\\)[#$%&_~^](?!\{)", re.sub(r"\\[\\#$%&_{}^~]", "", tex))
    assert not re.search(r"[\x00-\x1f]", tex)


@pytest.mark.parametrize(
    ("text", "tex"),
    [
        ("10 m/(N·s²)", r"10 m/(N\ensuremath{\cdot}s\textsuperscript{2})"),
        ("kg·m⁻¹", r"kg\ensuremath{\cdot}m\textsuperscript{\ensuremath{-}1}"),
        ("ω_max", r"\ensuremath{\omega}\_max"),
        ("5 µF", r"5 \ensuremath{\mu}F"),
        ("3 \u2126", r"3 \ensuremath{\Omega}"),
        ("3 \u03a9", r"3 \ensuremath{\Omega}"),
        ("η = 50%", r"\ensuremath{\eta} = 50\%"),
        ("Müller & Söhne", r"M\"{u}ller \& S\"{o}hne"),
        ("čerpadlo", r"\v {c}erpadlo"),
        ("水", "[U+6C34]"),
        ("-m·g", r"\ensuremath{-}m\ensuremath{\cdot}g"),
        ("on-off", "on{-}off"),
    ],
)
def test_what_names_and_units_become(text: str, tex: str) -> None:
    assert escape(text) == tex


def test_a_name_cannot_leave_its_comment(build: Any) -> None:
    graph = build({"a\n\\input{evil}": "Se", "j": "1"}, ["a\n\\input{evil} -> j"])
    body = [line for line in draw(graph).tikz().splitlines() if not line.startswith("%")]
    assert not any("\\input" in line for line in body)


def test_save_writes_it(examples: Any, tmp_path: Path) -> None:
    drawing = draw(examples["ball"]())
    assert drawing.save(tmp_path / "ball.tex").read_text(encoding="utf-8") == drawing.tikz()


@pytest.mark.latex
def test_latex_compiles_it_without_a_word(build: Any, strokes: Any, tmp_path: Path) -> None:
    letters = "".join(map(chr, [*range(0x391, 0x3A2), *range(0x3A3, 0x3CA)]))
    names = {
        "a_b&c%d#e$f": ("Se", "10 m/(N*s^2)"),
        "\\evil{~^": ("I", "-½·µ⁻¹ «é» 水"),
        "j": "1",
        letters[:24]: ("R", letters[24:]),
        "'\"`<>|--,,": ("C", "x ≤ 3 → ∞"),
    }
    first, second, _, third, fourth = names
    graph = build(
        names, [f"{first} -> j -> {second}", f"j -> {third}", f"j -> {fourth}"], title="α & β"
    )
    given = strokes(graph, derivative=(0,))
    drawing = draw(graph, causality=given, dynamic_bonds=(1, 2), marks={"j": "loop_1"})
    (tmp_path / "one.tex").write_text(drawing.tikz(document=True), encoding="ascii")
    done = subprocess.run(
        ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "one.tex"],
        cwd=tmp_path,
        capture_output=True,
        timeout=120,
    )
    log = (tmp_path / "one.log").read_text(encoding="latin-1")
    assert done.returncode == 0, log[-3000:]
    assert "Overfull" not in log and "Missing character" not in log and "Font Warning" not in log
    assert "Output written on one.pdf (1 page" in log


def test_panels_and_the_overview_are_written_too() -> None:
    import hybond as hb

    m = hb.Model("chopper", domain="electrical")
    m.add(V=hb.Se("10 V"), sw=hb.One(), j=hb.Zero(), r=hb.R("1 ohm"), c=hb.C("1 mF"))
    m.bond("V -> sw -> j -> c", "sw -> r")
    m.machine("S", states={"closed": ["sw"], "open": []}, start="closed")
    graph = m.flatten()
    overview, panels = read(draw_hybrid(graph).tikz()), read(draw_modes(graph).tikz())
    assert sum(style == "hb stroke dynamic" for style, _ in overview["lines"]) == 2
    assert sum(style == "hb panel frame" for style, _ in panels["frames"]) == 2
