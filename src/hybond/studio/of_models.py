"""What a page asks about the model: the palette, equations, structure, the printed picture."""

from __future__ import annotations

import base64
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hybond._version import __version__
from hybond.draw.scene import Line, Mark, Text
from hybond.errors import UsageError
from hybond.model.hierarchy import submodel_of
from hybond.model.parts import SubmodelPart
from hybond.names import steps
from hybond.studio.formulas import equations, structure
from hybond.studio.stock import stock
from hybond.studio.view import view

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


def schematic(session: Session, message: Mapping[str, Any]) -> Message:
    """Return the schematic of a level, its parts where they stand in the bond graph."""
    from hybond.draw import draw_schematic

    path = str(message.get("level") or "")
    model = session.meaning().model
    seen = view(session.document.data, path)
    if model is None or seen is None:
        error = session.meaning().error
        raise error or UsageError(
            "there is no model",
            code="HB-W103",
            where="schematic",
            hint="look at the problems, and at which level is open",
        )
    for name in steps(path) if path else ():
        part = model.elements.get(name)
        if not isinstance(part, SubmodelPart):
            raise UsageError(
                f"{path!r} is no level",
                code="HB-W103",
                where="schematic",
                hint="open a part that is made of others",
            )
        model = submodel_of(part, name, model.models)
    places = {n["name"]: (n["x"], n["y"]) for n in seen["nodes"]}
    scene = draw_schematic(model, positions=places, title=False).scene
    return {
        "width": scene.width,
        "height": scene.height,
        "groups": [
            {"name": g.name, "key": g.key, "about": g.about, "marks": [_mark(m) for m in g.marks]}
            for g in scene.groups
        ],
    }


def _mark(mark: Mark) -> dict[str, Any]:
    if isinstance(mark, Line):
        way = "L".join(f"{x:.1f},{y:.1f}" for x, y in mark.points)
        return {"role": mark.role, "d": f"M{way}"}
    assert isinstance(mark, Text)
    at = {"x": round(mark.x, 1), "y": round(mark.y, 1), "anchor": mark.anchor}
    return {"role": mark.role, "text": mark.text, **at}


def picture(session: Session, message: Mapping[str, Any]) -> Message:
    """Return the printed drawing in the mode that is shown: svg, pdf, png or tex."""
    from hybond.draw import draw_mode, draw_schematic

    form = str(message.get("form", "svg"))
    if message.get("schematic"):
        session.whole("picture")
        model = session.meaning().model
        assert model is not None
        drawing = draw_schematic(model)
    else:
        drawing = draw_mode(session.whole("picture"), session.shown(message))
    with tempfile.TemporaryDirectory() as folder:
        file = drawing.save(Path(folder, f"drawing.{form}"))
        content = base64.b64encode(file.read_bytes()).decode()
    return {"content": content, "name": f"{Path(session.document.name).stem}.{form}"}
