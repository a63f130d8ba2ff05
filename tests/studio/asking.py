"""A session as a page has it: questions, answers, and what is told meanwhile."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from typing import Any

from hybond.studio.server import dumped
from hybond.studio.session import Session


def asked(session: Session, ask: str, **more: Any) -> dict[str, Any]:
    answer = session.handle({"id": 1, "ask": ask, **more})
    session.settle()
    assert "error" not in answer, answer
    json.loads(dumped(answer))
    return answer


def edit(session: Session, **edit: Any) -> dict[str, Any]:
    return asked(session, "edit", edit=edit)


def finished(session: Session, **more: Any) -> dict[str, Any]:
    told: list[dict[str, Any]] = []
    stop = session.listen(told.append)
    number = asked(session, "run", **more)["run"]
    done = eventually(lambda: [m for m in told if m["tell"] == "finished" and m["run"] == number])
    stop()
    return done[0]


def eventually(what: Callable[[], Any]) -> Any:
    """Wait until something is so, and return it."""
    end = time.monotonic() + 20.0
    while time.monotonic() < end:
        found = what()
        if found:
            return found
        time.sleep(0.01)
    raise AssertionError("not so after 20 s")
