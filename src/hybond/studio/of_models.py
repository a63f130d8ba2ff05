"""What a page asks about the model: the palette, equations, structure, the printed picture."""

from __future__ import annotations

import base64
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hybond._version import __version__
from hybond.studio.formulas import equations, structure
from hybond.studio.stock import stock

if TYPE_CHECKING:
    from hybond.studio.session import Session

Message = dict[str, Any]


def offers(session: Session, message: Mapping[str, Any]) -> Message:
    """Return what the palette offers, and what can be opened."""
    return {
        **stock(),
        "version": __version__,
        "files": session.files(),
        "examples": session.examples(),
    }


def written(session: Session, message: Mapping[str, Any]) -> Message:
    """Return the equations of all modes, or of the one that is shown."""
    graph = session.whole("equations")
    return equations(graph, session.shown(message) if message.get("one") else None)


def structured(session: Session, message: Mapping[str, Any]) -> Message:
    """Return the structure of the modes as text."""
    return {"text": structure(session.whole("structure"))}


def picture(session: Session, message: Mapping[str, Any]) -> Message:
    """Return the printed drawing in the mode that is shown: svg, pdf, png or tex."""
    from hybond.draw import draw_mode

    form = str(message.get("form", "svg"))
    drawing = draw_mode(session.whole("picture"), session.shown(message))
    with tempfile.TemporaryDirectory() as folder:
        file = drawing.save(Path(folder, f"drawing.{form}"))
        content = base64.b64encode(file.read_bytes()).decode()
    return {"content": content, "name": f"{Path(session.document.name).stem}.{form}"}
