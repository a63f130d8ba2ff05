"""The legend of a drawing: only what occurs in it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from hybond.draw.geometry import STROKE_LENGTH, Box
from hybond.draw.measure import width
from hybond.draw.scene import Band, Frame, Line, Mark, Text
from hybond.draw.sketch import Arrow, Sketch, Symbol
from hybond.draw.style import look

ROW = 21.0
"""Height of a row of entries."""
_SAMPLE = 24.0
"""Width of a sample; the words begin a little right of it."""
_GAP = 18.0


@dataclass(frozen=True, slots=True)
class Entry:
    """A sample, drawn around y = 0 from x = 0 on, and what it means."""

    meaning: str
    sample: tuple[Mark, ...]

    @property
    def width(self) -> float:
        """Room for sample and words."""
        return _SAMPLE + 7.0 + width(self.meaning, look("legend").size or 10.0)


def entries(sketches: Sequence[Sketch]) -> list[Entry]:
    """Return an entry for each sign that needs one and occurs in one of the pictures.

    Examples
    --------
    >>> off = Arrow(0, 1, "a -> b", strokes=(0,), off=True)
    >>> [entry.meaning for entry in entries([Sketch((), (off,))])]
    ['OFF']
    """
    arrows = [a for s in sketches for a in s.arrows]
    symbols = [n for s in sketches for n in s.symbols]
    several = any(a.dashed or a.emphasis for a in arrows)
    # what is OFF is grey, its strokes as well
    derivative = any(_solid_late(a) and not a.off for a in arrows)
    derivative |= any(n.derivative and not n.off for n in symbols)
    derivative_elsewhere = any(end in a.late for a in arrows for end in a.dashed)
    causal = any(a.strokes for a in arrows)
    found = []
    if any(a.dashed and a.strokes for a in arrows):
        found.append(Entry("reference mode", _bond("stroke")))
    if any(end not in a.late for a in arrows for end in a.dashed):
        found.append(Entry("other modes", _bond("stroke dynamic")))
    if (derivative or derivative_elsewhere or several) and any(a.integral for a in arrows):
        found.append(Entry("integral causality", _storage("stroke", integral=True)))
    if derivative:
        found.append(Entry("derivative causality", _storage("stroke derivative")))
    if derivative_elsewhere:
        found.append(
            Entry("derivative in other modes", _storage("stroke dynamic derivative", black=True))
        )
    if any(a.region for a in arrows):
        band = Band("region", ((7.0, 0.0), (_SAMPLE - 7.0, 0.0)), 14.0)
        found.append(Entry("dynamic causality", (band,)))
    if any(a.emphasis for a in arrows):
        band = Band("emphasis", ((7.0, 0.0), (_SAMPLE - 7.0, 0.0)), 14.0)
        found.append(Entry("differs from the reference", (band, *_bond("stroke"))))
    if any(a.conflict for a in arrows):
        found.append(Entry("causal conflict", _conflict()))
    if any(a.off for a in arrows) or any(n.off for n in symbols):
        found.append(Entry("OFF", (Line("bond off", ((1.0, 0.0), (_SAMPLE - 1.0, 0.0))),)))
    if (causal or several) and any(n.controlled and not n.law for n in symbols):
        found.append(Entry("controlled by [machine]", _controlled()))
    if any(n.law for n in symbols):
        found.append(Entry(f"law of a junction: {_laws(symbols)}", _law()))
    if left_out := max((s.left_out for s in sketches), default=0):
        nodes = "node that decides" if left_out == 1 else "nodes that decide"
        what = f"without {left_out} {nodes} nothing"
        found.append(Entry(what, (Text("sample junction", "…", _SAMPLE / 2 + 1.0, 2.0),)))
    return found


def width_of(found: Sequence[Entry]) -> float:
    """Return the width that a legend needs: one column, or two if it is long."""
    count = 2 if len(found) > 3 else 1
    columns = [max(e.width for e in found[k::count]) for k in range(min(count, len(found)))]
    return sum(columns) + _GAP * max(len(columns) - 1, 0)


def rows(found: Sequence[Entry], room: float) -> tuple[list[Mark], float]:
    """Return the marks of a legend, from (0, 0) down and to the right, and its height.

    Entries stand in columns, as many as `room` has place for.
    """
    if not found:
        return [], 0.0
    best = [max(e.width for e in found)]
    for count in range(2, len(found) + 1):
        columns = [max(e.width for e in found[k::count]) for k in range(count)]
        if sum(columns) + _GAP * (count - 1) > room:
            break
        best = columns
    marks: list[Mark] = []
    size = look("legend").size or 10.0
    for k, entry in enumerate(found):
        row, column = divmod(k, len(best))
        x, y = sum(best[:column]) + _GAP * column, ROW * (row + 0.5)
        marks += [moved(m, x, y) for m in entry.sample]
        marks.append(Text("legend", entry.meaning, x + _SAMPLE + 7.0, y + 0.36 * size, "start"))
    return marks, ROW * -(-len(found) // len(best))


def moved(mark: Mark, dx: float, dy: float) -> Mark:
    """Return a mark moved to the right and down."""
    if isinstance(mark, Line):
        return Line(mark.role, tuple((x + dx, y + dy) for x, y in mark.points))
    if isinstance(mark, Band):
        return Band(mark.role, tuple((x + dx, y + dy) for x, y in mark.points), mark.breadth)
    if isinstance(mark, Frame):
        b = mark.box
        box = Box(b.x0 + dx, b.y0 + dy, b.x1 + dx, b.y1 + dy)
        return Frame(mark.role, box, mark.radius)
    return Text(mark.role, mark.text, mark.x + dx, mark.y + dy, mark.anchor)


_MEANING = {
    "diode": "conducts one way",
    "thyristor": "diode with a gate",
    "unilateral": "contact",
    "coulomb": "dry friction",
    "relay": "switches with the sign",
}


def _laws(symbols: Sequence[Symbol]) -> str:
    """Return what the laws that occur are, in words."""
    found = dict.fromkeys(n.law for n in symbols if n.law)
    return ", ".join(f"{law} = {_MEANING[law]}" if law in _MEANING else law for law in found)


def _solid_late(arrow: Arrow) -> bool:
    return any(end in arrow.late for end in arrow.strokes)


def _bond(role: str) -> tuple[Mark, ...]:
    """Return a short half arrow with a stroke at its head."""
    half = STROKE_LENGTH / 2 - 1.5
    return (
        Line("bond", ((1.0, 0.0), (_SAMPLE - 3.0, 0.0))),
        Line("barb", ((_SAMPLE - 3.0, 0.0), (_SAMPLE - 10.0, 5.0))),
        Line(role, ((_SAMPLE - 3.0, half), (_SAMPLE - 3.0, -half))),
    )


def _storage(role: str, *, integral: bool = False, black: bool = False) -> tuple[Mark, ...]:
    """Return the letter I with a bond whose stroke is near it (integral) or far from it."""
    half = STROKE_LENGTH / 2 - 1.5
    late = "" if integral or black else " derivative"
    x = 16.0 if integral else 2.0
    return (
        Line("bond", ((2.0, 0.0), (16.0, 0.0))),
        Line(role, ((x, half), (x, -half))),
        Text(f"sample{late}", "I", 21.5, 4.8),
    )


def _conflict() -> tuple[Mark, ...]:
    c, x = 4.0, _SAMPLE / 2
    return (
        Line("bond conflict", ((1.0, 0.0), (_SAMPLE - 1.0, 0.0))),
        Line("cross conflict", ((x - c, -c), (x + c, c))),
        Line("cross conflict", ((x - c, c), (x + c, -c))),
    )


def _controlled() -> tuple[Mark, ...]:
    return (
        Frame("switch", Box(2.0, -8.5, _SAMPLE - 1.0, 8.5), 5.0),
        Text("sample junction", "0", 10.5, 4.3),
        Text("subscript", "c", 15.0, 7.0, "start"),
    )


def _law() -> tuple[Mark, ...]:
    """Return the frame in which the name of a law stands."""
    return (
        Frame("badge grey", Box(1.0, -7.0, _SAMPLE + 1.0, 7.0), 4.0),
        Text("badge grey", "law", _SAMPLE / 2 + 1.0, 3.1),
    )
