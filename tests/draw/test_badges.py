"""Badges: what an analysis found, on the elements of a drawing."""

from __future__ import annotations

import itertools
from typing import Any

import pytest

from hybond.draw import Badge, draw
from hybond.draw.scene import Frame, Line, Text
from hybond.draw.words import extent_of
from hybond.errors import UsageError


def badge_of(drawing: Any, path: str) -> tuple[Frame, Text]:
    group = next(g for g in drawing.scene.groups if g.name == "node" and g.key == path)
    frame, text = [m for m in group.marks if m.role.startswith("badge")]
    assert isinstance(frame, Frame) and isinstance(text, Text)
    return frame, text


def test_a_known_word_has_its_colour_and_any_pair_its_own(examples: Any) -> None:
    marks = {"pad": "derivative", "ball": ("12 kHz", "purple"), "v": "odd", "damper": Badge("x")}
    drawing = draw(examples["ball"](), marks=marks)
    assert badge_of(drawing, "pad")[1].role == "badge orange"
    assert badge_of(drawing, "ball")[1].role == "badge purple"
    assert badge_of(drawing, "ball")[1].text == "12 kHz"
    assert badge_of(drawing, "v")[1].role == badge_of(drawing, "damper")[1].role == "badge grey"
    about = {g.key: g.about for g in drawing.scene.groups}
    assert about["pad"].endswith("; derivative")


@pytest.mark.sampled(2)
def test_badges_lie_in_their_frames_and_touch_nothing(example: Any) -> None:
    marks = {n.path: "uncontrollable" for n in example.nodes if not n.hidden}
    drawing = draw(example, marks=marks)
    everything = [m for g in drawing.scene.groups for m in g.marks]
    lines = [m for m in everything if isinstance(m, Line)]
    texts = [extent_of(m) for m in everything if isinstance(m, Text) and "badge" not in m.role]
    frames = []
    for path in marks:
        frame, text = badge_of(drawing, path)
        inner = extent_of(text)
        assert frame.box.x0 <= inner.x0 and inner.x1 <= frame.box.x1
        assert frame.box.y0 <= inner.y0 and inner.y1 <= frame.box.y1
        frames.append(frame.box)
    for one, two in itertools.combinations(frames, 2):
        assert not one.overlaps(two)
    for box in frames:
        assert not any(box.overlaps(other) for other in texts)
        assert not any(box.cut((m.points[0], m.points[1])) for m in lines)


def test_a_mark_on_a_hidden_switch_is_on_its_element(build: Any) -> None:
    graph = build(
        {"S": "Se", "j": "1", "valve": "R", "valve.switch": "0"},
        ["S -> j -> valve.switch -> valve"],
        machines={"tap": {"shut": [], "open": ["valve.switch"]}},
        hidden=["valve.switch"],
    )
    assert badge_of(draw(graph, marks={"valve.switch": "loop"}), "valve")[1].text == "loop"


def test_unknown_elements_and_tones_are_refused(examples: Any) -> None:
    with pytest.raises(UsageError, match=r"HB-D106 at paad.*\n.*'pad'"):
        draw(examples["ball"](), marks={"paad": "stiff"})
    with pytest.raises(UsageError, match=r"HB-D107 at pad.*\n.*'orange'"):
        draw(examples["ball"](), marks={"pad": ("stiff", "ornge")})
