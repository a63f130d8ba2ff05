"""Messages of a page to the studio, as no page sends them."""

from __future__ import annotations

import json
import random
import threading
import time
import traceback
from pathlib import Path
from typing import Any

from fuzzing import corpus
from fuzzing.judging import WrongError
from fuzzing.mutations import NAMES, VALUES, changed_text, changed_tree
from hybond.errors import HybondError
from hybond.studio.problems import problem_of
from hybond.studio.server import dumped, read
from hybond.studio.session import ASKS, MISREAD, Session

Message = dict[str, Any]
EDITS: tuple[Message, ...] = (
    {"do": "add", "element": {"I": "1 kg"}, "at": [1, 0], "name": "m"},
    {"do": "add", "element": {"junction": 1}, "at": [3, 4]},
    {"do": "remove", "names": ["ball"]},
    {"do": "move", "at": {"ball": [1, 2], "v": [0, 0]}},
    {"do": "bond", "tail": "weight", "head": "v"},
    {"do": "reverse", "bond": "weight -> v"},
    {"do": "write bond", "index": 0, "text": "weight -> v -> ball"},
    {"do": "rename", "old": "ball", "new": "b"},
    {"do": "rename state", "machine": "impact", "old": "away", "new": "gone"},
    {"do": "set", "path": ["elements", "ball", "I"], "value": "2 kg"},
    {"do": "set", "path": ["parameters", "e"], "value": 0.7},
    {"do": "set", "path": ["signals", "half"], "value": None},
    {
        "do": "paste",
        "data": {"elements": {"r": {"R": 1}}, "graph": {"bonds": ["v -> r"]}},
        "by": [1, 1],
    },
)
PLAN: Message = {
    "factors": [["e", "0.1..0.9:3"], ["ball.I", "1 kg, 2 kg"]],
    "way": "grid",
    "count": "4",
    "seed": "0",
    "until": "0.5 s",
    "collect": "final(height)",
}
MESSAGES: tuple[Message, ...] = (
    {"ask": "look", "level": "", "mode": {"impact": "hits"}},
    {"ask": "replace", "text": corpus.SMALL},
    {"ask": "undo"},
    {"ask": "redo"},
    {"ask": "text"},
    {"ask": "copy", "names": ["ball", "v"]},
    {"ask": "paste", "text": "hybond = 1\n[elements]\nr = { R = 1 }\n", "by": [1, 2]},
    {"ask": "arrange", "keep": ["ball"]},
    {"ask": "open", "file": "m.toml"},
    {"ask": "open", "example": "bouncing_ball"},
    {"ask": "save as", "file": "n.toml", "replace": True},
    {"ask": "stock"},
    {"ask": "equations"},
    {"ask": "structure"},
    {"ask": "schematic"},
    {"ask": "picture", "format": "svg"},
    {"ask": "run", "until": "1.2 s", "names": ["height"], "width": 300, "options": {"rtol": 1e-6}},
    {"ask": "cancel"},
    {"ask": "sweep", "path": "e", "values": "0.1..0.5:2", "until": "0.5 s"},
    {"ask": "sweep", "parameter": "e", "from": "0.1", "to": "0.5", "count": 2, "until": "0.5 s"},
    {"ask": "runs"},
    {"ask": "curves", "run": 1, "names": ["height", "v.f"], "t0": 0, "t1": 1, "strip": True},
    {"ask": "phase", "run": 1, "names": ["height", "v.f"], "t0": 0.0, "t1": 1.0},
    {"ask": "events", "run": 1, "first": 0, "count": 10},
    {"ask": "energies", "run": 1, "t": 0.5},
    {"ask": "cursor", "run": 1, "t": 0.5, "side": "left", "names": ["height"], "level": ""},
    {"ask": "plan words"},
    {"ask": "plan look", **PLAN},
    {"ask": "plan begin", **PLAN},
    {"ask": "plan state"},
    {"ask": "plan cancel"},
    {"ask": "plan view", "plan": 1, "view": "table", "first": 0},
    {"ask": "plan view", "plan": 1, "view": "map", "x": "e", "y": "ball.I",
     "value": "final(height)", "at": {}},
    {"ask": "plan view", "plan": 1, "view": "tornado", "value": "final(height)"},
    {"ask": "plan view", "plan": 1, "view": "family", "curve": "curve(height, 10)"},
    {"ask": "plan view", "plan": 1, "view": "sobol", "value": "final(height)"},
    {"ask": "plan member", "plan": 1, "member": 0, "names": ["height"], "width": 100},
    {"ask": "plan open", "plan": 1, "member": 1},
    {"ask": "plan csv", "plan": 1},
)  # fmt: skip


def page(draw: random.Random, folder: Path) -> None:
    """A session, a few messages, each changed or not, and whether it still answers then."""
    (folder / "m.toml").write_text(corpus.SMALL)
    died: list[str] = []
    before, threading.excepthook = (
        threading.excepthook,
        lambda told: died.append(
            "".join(traceback.format_exception(told.exc_type, told.exc_value, told.exc_traceback))
        ),
    )
    session = Session(folder / "m.toml")
    try:
        if draw.random() < 0.3:
            other = draw.choice(list(corpus.models().values()))
            _ask(session, {"ask": "replace", "text": changed_text(draw, other)})
        refusals = [_ask(session, _message(draw)) for _ in range(draw.choice((1, 2, 4, 8)))]
        _wait(session)
        answer = session.handle({"id": 1, "ask": "look"})
        if "error" in answer:
            raise WrongError(f"no answer: {answer['error']}")
        if died:
            raise WrongError(died[0])
    finally:
        session.close()
        threading.excepthook = before
    for refusal in refusals:
        if refusal is not None:
            raise refusal


def _message(draw: random.Random) -> Message:
    kind = draw.random()
    if kind < 0.35:
        message: Message = {
            "ask": draw.choice(("edit", "edit", "attempt")),
            "edit": draw.choice(EDITS),
        }
    else:
        message = dict(draw.choice(MESSAGES))
    if draw.random() < 0.3:
        return message
    if draw.random() < 0.1:
        return read(changed_text(draw, json.dumps(message)))
    ask = message["ask"]
    changed = changed_tree(draw, message, MESSAGES)
    if draw.random() < 0.9:
        changed["ask"] = ask
    if draw.random() < 0.1:
        changed[draw.choice(("level", "mode", "run", "t0", "width"))] = draw.choice(
            (*VALUES, *NAMES)
        )
    # as it comes over the wire
    return read(json.dumps(changed))


def _ask(session: Session, message: Message) -> HybondError | None:
    """Ask as `Session.handle` does, and say what it would call a message that cannot be read."""
    ask = ASKS.get(str(message.get("ask")))
    refusal = None
    if ask is not None:
        try:
            with session._busy:
                dumped(ask(session, message))
        except HybondError as error:
            dumped({"error": problem_of(error, session.document.data)})
            refusal = error
        except MISREAD as error:
            # right where the message is read; wrong where something is computed with it
            last = traceback.extract_tb(error.__traceback__)[-1]
            if "/studio/" not in last.filename:
                raise
    session.settle()
    return refusal


def _wait(session: Session) -> None:
    """Give runs a while, as a page does that is closed then."""
    end = time.monotonic() + 3.0
    while time.monotonic() < end and any(t.name != "MainThread" for t in threading.enumerate()):
        time.sleep(0.005)


def journal(draw: random.Random, folder: Path) -> None:
    """A journal of edits that was changed: what is opened with it is a session that answers."""
    (folder / "m.toml").write_text(corpus.SMALL)
    session = Session(folder / "m.toml")
    session.handle({"id": 1, "ask": "edit", "edit": draw.choice(EDITS)})
    session.settle()
    session.handle({"id": 2, "ask": "edit", "edit": draw.choice(EDITS)})
    session.close()
    found = [p for p in (folder / "state").rglob("*.jsonl")]
    text = (
        found[0].read_text() + json.dumps({"edit": changed_tree(draw, draw.choice(EDITS))}) + "\n"
    )
    text = changed_text(draw, text) if draw.random() < 0.7 else text
    found[0].write_bytes(text.encode("utf-8", "surrogatepass"))
    session = Session(folder / "m.toml")
    try:
        answer = session.handle({"id": 1, "ask": "look"})
        if "error" in answer:
            raise WrongError(f"no answer: {answer['error']}")
    finally:
        session.close()
