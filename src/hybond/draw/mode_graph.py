"""Modes as a state diagram: what leads from one to the next, and how that is known."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

from hybond.draw.drawing import Drawing
from hybond.draw.geometry import Box, Point
from hybond.draw.measure import shorten, width
from hybond.draw.scene import Frame, Group, Line, Mark, Scene, Text
from hybond.errors import UsageError

MOST = 24
"""Modes that one drawing shows."""
HIGH = 40.0
"""Of a mode's frame."""
MARGIN = 26.0
LINE = 17.0
WIDE = 900.0
"""Of the list below, at most."""
BEND = 26.0
"""How far an arrow leaves the straight line, so that one does not lie on its way back."""
ASIDE = 7.0
"""How far it begins and ends from the middles of the frames."""
PIECES = 24
TIP = 9.0
CHAR = 11.0

Pair = tuple[str, str]


def draw_mode_graph(found: Any) -> Drawing:
    """Return the state diagram of what `hybond.reachable` found.

    Parameters
    ----------
    found : ModeGraph

    Raises
    ------
    UsageError
        HB-A602 for more modes than one drawing can show.

    Examples
    --------
    >>> import hybond as hb
    >>> found = hb.reachable(hb.load("examples/bouncing_ball_two_junctions.toml"), until=0)
    >>> "never fires" in draw_mode_graph(found).svg()
    True
    """
    if len(found.nodes) > MOST:
        raise UsageError(
            f"{len(found.nodes)} modes are more than the {MOST} that one drawing shows",
            code="HB-A602",
            where="the state diagram",
            hint="print them as text or --json, or look at a part of the model",
        )
    boxes = _boxes(found.nodes)
    low = max(b.y1 for b in boxes.values()) + 34.0
    red = _cycles(found)
    taken = list(boxes.values())
    groups: list[Group] = []
    labels: list[Group] = []
    numbers: dict[Pair, list[int]] = {}
    for k, e in enumerate(found.edges):
        numbers.setdefault((e.source, e.target), []).append(k + 1)
    for (source, target), own in numbers.items():
        edges = [found.edges[k - 1] for k in own]
        role = _role(edges, red=(source, target) in red)
        points = _arc(boxes[source], boxes[target])
        about = "\n".join(str(f) for e in edges for f in e.fires)
        groups.append(
            Group("edge", f"{source} -> {target}", about, (Line(role, points), _tip(role, points)))
        )
        labels.append(_badge(", ".join(map(str, own)), points, role, taken))
    nodes = [_node(n, boxes[n.mode], first=n.mode == found.start) for n in found.nodes]
    texts, bottom, right = _list(found, low)
    across = max(max(b.x1 for b in boxes.values()) + MARGIN, right + MARGIN)
    title = Text("title", shorten(found.title, 13.0, across - 2 * MARGIN), MARGIN, 24.0, "start")
    return Drawing(
        Scene(
            across,
            bottom + 12.0,
            (Group("title", "", "", (title,)), *groups, *nodes, *labels, *texts),
            title=f"{found.title}: modes",
        ),
        {},
    )


def _boxes(nodes: Sequence[Any]) -> dict[str, Box]:
    """Return where modes stand: on an ellipse, the first one at its left."""
    wide = [
        max(width(n.mode, CHAR, bold=True), width(", ".join(n.kinds), 9.0)) + 22.0 for n in nodes
    ]
    many = len(nodes)
    most = max(wide)
    # neighbours need room for themselves and for the number of what joins them
    x = 0.0 if many == 1 else max(most * 0.5 + 80.0, (most + 60.0) * many / (2.0 * math.pi))
    y = 0.0 if many <= 2 else max(80.0, 28.0 * many)
    left = MARGIN + 26.0 + most / 2.0
    found = {}
    for k, n in enumerate(nodes):
        turn = math.pi - 2.0 * math.pi * k / many
        cx, cy = left + x + x * math.cos(turn), 64.0 + y - y * math.sin(turn)
        if many == 2:
            cy += 16.0
        found[n.mode] = Box(cx - wide[k] / 2, cy - HIGH / 2, cx + wide[k] / 2, cy + HIGH / 2)
    return found


def _middle(box: Box) -> Point:
    return ((box.x0 + box.x1) / 2.0, (box.y0 + box.y1) / 2.0)


def _arc(source: Box, target: Box) -> tuple[Point, ...]:
    """Return a bent line between two frames, from edge to edge."""
    (ax, ay), (bx, by) = _middle(source), _middle(target)
    if source is target:
        return _loop(source)
    long = math.hypot(bx - ax, by - ay)
    nx, ny = -(by - ay) / long, (bx - ax) / long
    # where one arrow leaves a frame none arrives
    ax, ay, bx, by = ax + ASIDE * nx, ay + ASIDE * ny, bx + ASIDE * nx, by + ASIDE * ny
    cx, cy = (ax + bx) / 2.0 + 2.0 * BEND * nx, (ay + by) / 2.0 + 2.0 * BEND * ny
    points = []
    for k in range(PIECES + 1):
        t = k / PIECES
        a, b, c = (1.0 - t) ** 2, 2.0 * t * (1.0 - t), t * t
        points.append((a * ax + b * cx + c * bx, a * ay + b * cy + c * by))
    begin = max(k for k in range(PIECES) if _within(source, points[k]))
    end = min(k for k in range(1, PIECES + 1) if _within(target, points[k]))
    first = _edge(source, points[begin], points[begin + 1])
    last = _edge(target, points[end], points[end - 1])
    return (first, *points[begin + 1 : end], last)


def _within(box: Box, p: Point) -> bool:
    return box.x0 <= p[0] <= box.x1 and box.y0 <= p[1] <= box.y1


def _edge(box: Box, inside: Point, outside: Point) -> Point:
    """Return where a line leaves a frame."""
    low, high = 0.0, 1.0
    for _ in range(30):
        t = (low + high) / 2.0
        p = (
            inside[0] + t * (outside[0] - inside[0]),
            inside[1] + t * (outside[1] - inside[1]),
        )
        low, high = (t, high) if _within(box, p) else (low, t)
    return (
        inside[0] + high * (outside[0] - inside[0]),
        inside[1] + high * (outside[1] - inside[1]),
    )


def _loop(box: Box) -> tuple[Point, ...]:
    x, y = (box.x0 + box.x1) / 2.0, box.y0
    turns = [math.pi * (1.15 - 1.3 * k / PIECES) for k in range(PIECES + 1)]
    return tuple((x + 14.0 * math.cos(a), y - 8.0 - 14.0 * math.sin(a)) for a in turns)


def _tip(role: str, points: Sequence[Point]) -> Line:
    (ax, ay), (bx, by) = points[-2], points[-1]
    long = math.hypot(bx - ax, by - ay) or 1.0
    dx, dy = (bx - ax) / long, (by - ay) / long
    foot = (bx - TIP * dx, by - TIP * dy)
    side = 0.42 * TIP
    one = (foot[0] - side * dy, foot[1] + side * dx)
    two = (foot[0] + side * dy, foot[1] - side * dx)
    solid = " ".join(w for w in role.split() if w != "switch") or "wire"
    return Line(solid, (one, (bx, by), two))


def _role(edges: Sequence[Any], *, red: bool) -> str:
    if red:
        return "conflict"
    known = {e.known for e in edges}
    if "seen" in known:
        return "stroke"
    return "barb" if "possible" in known else "switch"


def _badge(text: str, points: Sequence[Point], role: str, taken: list[Box]) -> Group:
    """Return the number of an arrow, on it where nothing else stands."""
    wide = width(text, 9.0) + 10.0
    middle = (len(points) - 1) / 2.0
    places = sorted(range(2, len(points) - 3), key=lambda k: abs(k - middle)) or [int(middle)]
    boxes = [
        Box(x - wide / 2, y - 8.0, x + wide / 2, y + 8.0) for x, y in (points[k] for k in places)
    ]
    box = next((b for b in boxes if not any(b.overlaps(t) for t in taken)), boxes[0])
    taken.append(box)
    x, y = _middle(box)
    word = "badge red" if role == "conflict" else "badge"
    return Group("number", text, "", (Frame(word, box, 8.0), Text(word, text, x, y + 3.2)))


def _node(n: Any, box: Box, *, first: bool) -> Group:
    kinds = set(n.kinds)
    marks: list[Mark] = []
    if "continuous" in kinds or not kinds & {"mythical", "pinnacle"}:
        marks.append(Frame("badge blue", box, 9.0))
    elif "pinnacle" in kinds:
        marks.append(Frame("badge orange", box, 9.0))
    else:
        marks.append(Frame("badge switch", box, 9.0))
    if "pinnacle" in kinds:
        # two lines round it: a mode of one instant that writes
        marks.append(Frame("badge orange", box.grown(-3.0), 7.0))
    if "mythical" in kinds and len(kinds - {"start"}) > 1:
        # a dotted line round it: at some instants it is tried only
        marks.append(Frame("switch", box.grown(4.0), 12.0))
    x, y = _middle(box)
    marks.append(Text("sample", n.mode, x, y - 2.0))
    told = ", ".join(k for k in n.kinds if k != "start") or "not entered"
    marks.append(Text("number", told, x, y + 12.0))
    if first:
        line = ((box.x0 - 24.0, y), (box.x0, y))
        marks += [Line("stroke", line), _tip("stroke", line)]
        marks.append(Text("number", "start", box.x0 - 30.0, y - 7.0, "start"))
    return Group("mode", n.mode, ", ".join(n.kinds), tuple(marks))


def _cycles(found: Any) -> set[Pair]:
    """Return the edges that follow each other for ever from some state."""
    pairs: set[Pair] = set()
    for gap in found.gaps:
        if not gap.cycle or len(gap.modes) < 2 or gap.modes[-1] not in gap.modes[:-1]:
            continue
        own = gap.modes[gap.modes.index(gap.modes[-1]) :]
        pairs |= set(pairwise(own))
    return pairs


def _list(found: Any, top: float) -> tuple[list[Group], float, float]:
    """Return what stands below: the numbered transitions, what never fires, the verdict."""
    rows: list[tuple[str, str, str]] = []
    for k, e in enumerate(found.edges):
        for j, f in enumerate(e.fires):
            rows.append((str(k + 1) if j == 0 else "", str(f), e.known if j == 0 else ""))
        if not e.fires:
            rows.append((str(k + 1), "by the laws of junctions", e.known))
    said = [("caption", f"never fires: {t}") for t in found.never]
    said += [("caption", f"no run reaches {state}") for state in found.unreachable]
    for gap in found.gaps[:6]:
        said.append(("word red", f"no mode holds from ({gap.begin}) where {gap}"))
    if len(found.gaps) > 6:
        said.append(("word red", f"and {len(found.gaps) - 6} more sets of states"))
    words = {"proved": "green", "possible": "red", "not decided": "orange"}
    verdict = {
        "proved": "proved: time always goes on",
        "possible": "possible: time stops",
        "not decided": "not decided whether time always goes on",
    }[found.time]
    said.append((f"word {words[found.time]}", verdict))
    groups = []
    y, right = top, 0.0
    for number, text, known in rows:
        full = f"{text}   ({known})" if known else text
        short = shorten(full, 11.0, WIDE)
        marks = [Text("word", short, MARGIN + 26.0, y, "start")]
        if number:
            marks.append(Text("number", number, MARGIN + 18.0, y, "end"))
        groups.append(Group("transition", number, full, tuple(marks)))
        right = max(right, MARGIN + 26.0 + width(short, 11.0))
        y += LINE
    y += 6.0
    for role, text in said:
        short = shorten(text, 11.5, WIDE)
        groups.append(Group("said", "", text, (Text(role, short, MARGIN, y, "start"),)))
        right = max(right, MARGIN + width(short, 11.5))
        y += LINE
    return groups, y, right
