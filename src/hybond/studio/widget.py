"""The studio in a notebook: the same page as a widget, which edits a model in place."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from hybond.errors import UsageError
from hybond.files.load import loads
from hybond.files.save import dumps
from hybond.model.builder import Model
from hybond.studio.server import PAGE
from hybond.studio.session import Session

if TYPE_CHECKING:
    from hybond.result import Result
    from hybond.sweep.table import SweepTable


class Studio:
    """A model under edit in a notebook.

    Attributes
    ----------
    model : Model
        What is edited: the object that was given, changed in place whenever the text is a model.
    run : Result or None
        The last run made on the page.
    table : SweepTable or None
        What is done of the last sweep of a plan that was made on the page.
    widget : anywidget.AnyWidget
        What the notebook shows.
    """

    def __init__(self, model: Model | str | Path | None = None, *, height: int = 640) -> None:
        self.model = model if isinstance(model, Model) else Model("untitled", domain="electrical")
        file = Path(model) if isinstance(model, str | Path) else None
        text = dumps(self.model)
        self.session = Session(file, text=text, journal=file is not None, on_change=self._taken)
        if file is not None:
            self._taken(self.session.document.text)
        self.widget = _widget(self.session, height)

    @property
    def run(self) -> Result | None:
        """The last finished run."""
        kept = [r.result for r in self.session.runs.kept.values() if r.result is not None]
        return kept[-1] if kept else None

    @property
    def table(self) -> SweepTable | None:
        """The table of the last sweep, as far as it is."""
        planned = self.session.plans.current
        return None if planned is None else planned.table()

    def _taken(self, text: str) -> None:
        """Make the model what the text says; one that says none leaves it as it was."""
        from hybond.errors import HybondError

        try:
            found = loads(text, base=self.session.root)
        except HybondError:
            return
        origin = self.model.name
        self.model.__dict__.update(found.__dict__)
        self.model.name = found.name if found.name != "model" else origin

    def _repr_mimebundle_(self, **options: Any) -> Any:
        return self.widget._repr_mimebundle_(**options)


def studio(model: Model | str | Path | None = None, *, height: int = 640) -> Studio:
    """Open the studio in a notebook (Jupyter, VS Code, marimo).

    Parameters
    ----------
    model : Model, str or Path
        What is edited: a model, in place and back, or a model file. Without it an empty model.
    height : int
        Pixels.

    Returns
    -------
    Studio
        With the model as it is now, and the last run as a `Result`.

    Raises
    ------
    UsageError
        HB-W108 if anywidget is not installed.
    """
    return Studio(model, height=height)


def _widget(session: Session, height: int) -> Any:
    try:
        import anywidget
        import traitlets
    except ImportError:
        raise UsageError(
            "the studio in a notebook needs anywidget",
            code="HB-W108",
            where="hb.studio",
            hint="pip install 'hybond[studio]'",
        ) from None

    class Page(anywidget.AnyWidget):  # type: ignore[misc,unused-ignore]
        _esm = PAGE / "widget.js"
        _css = PAGE / "studio.css"
        height = traitlets.Int(640).tag(sync=True)

    page = Page(height=height)

    def received(_: Any, message: Any, __: Any) -> None:
        if isinstance(message, dict):
            page.send(session.handle(message))
            session.settle()

    page.on_msg(received)
    session.listen(page.send)
    return page
