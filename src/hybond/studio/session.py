"""A session: one document, its runs, and who looks at them; messages in, messages out.

A page asks (``{"id": 7, "ask": "edit", ...}``) and is answered (``{"id": 7, ...}`` or
``{"id": 7, "error": {...}}``); what happens meanwhile is told to all (``{"tell": "progress"}``).
Nothing here knows how messages travel.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from hybond.errors import FileError, HybondError, UsageError
from hybond.files.examples import examples_folder, models_in
from hybond.files.toml_text import toml_text
from hybond.files.whole import write_whole
from hybond.model.graph import FlatGraph, Mode
from hybond.names import did_you_mean
from hybond.studio import of_models, of_plans, of_runs
from hybond.studio.document import EMPTY, Document, Lock, must_be_model
from hybond.studio.edits import apply, cut_out, edit_of
from hybond.studio.levels import level_of, table
from hybond.studio.places import Shown
from hybond.studio.planned import Plans
from hybond.studio.problems import problem_of, problems
from hybond.studio.recovery import Recovery
from hybond.studio.runs import Runs
from hybond.studio.strokes import Meaning, meaning, mode_of, strokes
from hybond.studio.sweeps import Sweeps
from hybond.studio.view import view

Message = dict[str, Any]
PANELS = ("parameters", "inputs", "signals", "machines", "blocks", "experiment", "ports")


MISREAD = (TypeError, ValueError, AttributeError, LookupError, OverflowError)
"""What reading a message raises that is not as the page writes it."""
LONGEST = 200
"""Letters of the name of a file."""
PLACING = ("add", "move", "paste")
"""Edits that put something down by hand."""


class Session:
    """What a page talks to.

    Parameters
    ----------
    file : Path or None
        The model file; None for a model that is only in memory.
    text : str
        What is edited without a file, or in one that does not exist yet.
    root : Path or None
        The folder from which files are opened; that of the file by default.
    journal : bool
        Whether edits are written down in case the program ends.

    Examples
    --------
    >>> session = Session(None)
    >>> add = {"id": 1, "ask": "edit", "edit": {"do": "add", "element": {"junction": 1}}}
    >>> answer = session.handle(add)
    >>> answer["id"], [n["kind"] for n in answer["view"]["nodes"]], answer["canUndo"]
    (1, ['1'], True)
    """

    def __init__(
        self,
        file: Path | None = None,
        *,
        text: str = EMPTY,
        root: Path | None = None,
        journal: bool = True,
        on_change: Callable[[str], None] | None = None,
    ) -> None:
        self.root = (root or (file.parent if file is not None else Path.cwd())).resolve()
        self._journal = journal
        self._on_change = on_change
        self._listeners: list[Callable[[Message], None]] = []
        self._busy = threading.RLock()
        self._known: tuple[int, Meaning] | None = None
        self._shown = Shown()
        self.lock: Lock | None = None
        self.runs = Runs(self.tell)
        self.sweeps = Sweeps(self.tell)
        self.plans = Plans(self.tell)
        self.document = self._open(file, text)

    # -- who listens

    def listen(self, listener: Callable[[Message], None]) -> Callable[[], None]:
        """Tell this listener what happens; return what stops it."""
        self._listeners.append(listener)
        return lambda: self._listeners.remove(listener) if listener in self._listeners else None

    def tell(self, message: Message) -> None:
        """Tell all listeners."""
        for listener in list(self._listeners):
            listener(message)

    # -- questions

    def handle(self, message: Mapping[str, Any]) -> Message:
        """Answer one message; a refusal is an answer too."""
        number = message.get("id")
        ask = ASKS.get(str(message.get("ask")))
        try:
            if ask is None:
                raise UsageError(
                    f"there is no question {message.get('ask')!r}",
                    code="HB-W101",
                    where="ask",
                    hint=did_you_mean(str(message.get("ask")), ASKS),
                )
            with self._busy:
                answer = ask(self, message)
            return {"id": number, **answer}
        except HybondError as error:
            return {"id": number, "error": problem_of(error, self.document.data)}
        except MISREAD as error:
            said = UsageError(
                f"the message cannot be read: {type(error).__name__}: {error}",
                code="HB-W101",
                where=str(message.get("ask")),
                hint="load the page again, so that it is of the same version",
            )
            return {"id": number, "error": said.to_dict()}

    def settle(self) -> None:
        """Write what the last edit has changed; called when nobody waits for an answer."""
        with self._busy:
            unsaved = self.document.unsaved
            self.document.settle()
            if self.document.unsaved != unsaved:
                self.tell({"tell": "saved", "unsaved": self.document.unsaved})

    def close(self) -> None:
        """Write what is left, stop what runs, let another write."""
        self.runs.cancel()
        self.sweeps.cancel()
        self.plans.cancel()
        with self._busy:
            self.document.close()
            if self.lock is not None:
                self.lock.release()

    # -- answers

    def look(self, message: Mapping[str, Any]) -> Message:
        """Return all that the page shows of the level and mode that it has open."""
        if self.document.changed_outside():
            self.tell({"tell": "changed", "revision": self.document.revision, "outside": True})
        return self._seen(message)

    def _seen(self, message: Mapping[str, Any]) -> Message:
        document = self.document
        path = str(message.get("level") or "")
        seen = view(document.data, path, self._shown.of(path))
        if seen is None:
            path, seen = "", view(document.data, "", self._shown.of(""))
        assert seen is not None
        self._shown.note(path, seen)
        known = self.meaning()
        asked = message.get("mode")
        mode = mode_of(known, asked if isinstance(asked, dict) else None)
        try:
            drawn = strokes(known, mode, path)
        except HybondError as error:
            drawn = {"bonds": {}, "nodes": {}, "conflicts": [error.to_dict()]}
        found = problems(document.data, known, drawn.pop("conflicts"))
        if document.error is not None:
            found = [problem_of(document.error, document.data)]
        level = level_of(document.data, path)
        graph = known.graph
        machines = []
        if graph is not None:
            now = graph.start_mode if mode is None else mode
            machines = [
                {
                    "path": m.path,
                    "states": list(m.states),
                    "state": m.states[now[m.index]],
                    "law": "" if m.law is None else m.law.kind,
                }
                for m in graph.machines
            ]
        return {
            "revision": document.revision,
            "file": document.name,
            "title": document.data.get("title", ""),
            "inMemory": document.file is None,
            "writable": self.writable,
            "unsaved": document.unsaved,
            "canUndo": document.can_undo,
            "canRedo": document.can_redo,
            "view": seen,
            "strokes": drawn,
            "machines": machines,
            "problems": found,
            "whole": known.whole,
            "panels": {k: table({} if level is None else level.data, k) for k in PANELS},
        }

    def edit(self, message: Mapping[str, Any]) -> Message:
        """Do an edit and look at what it made."""
        self._must_write()
        edit = edit_of(message)
        if edit.get("do") in PLACING and "keep" not in edit:
            edit = {**edit, "keep": self._unplaced(str(edit.get("level") or ""))}
        revision = self.document.revision
        self.document.edit(edit)
        if self.document.revision != revision:
            self._shown.edited()
        return self._changed(message)

    def attempt(self, message: Mapping[str, Any]) -> Message:
        """Return what would be wrong after an edit, without doing it: null if nothing were."""
        edit = edit_of(message)
        document = self.document
        data = apply(document.data, edit)
        base = str(document.file.parent if document.file is not None else self.root)
        found = meaning(data, base=base, where=document.name).error
        return {"problem": None if found is None else problem_of(found, data)}

    def replace(self, message: Mapping[str, Any]) -> Message:
        """Take another text."""
        self._must_write()
        revision = self.document.revision
        self.document.replace(str(message["text"]))
        if self.document.revision != revision:
            self._shown.edited()
        return self._changed(message)

    def undo(self, message: Mapping[str, Any]) -> Message:
        """Go back by one edit."""
        self._must_write()
        if self.document.can_undo:
            self.document.undo()
            self._shown.undone()
        return self._changed(message)

    def redo(self, message: Mapping[str, Any]) -> Message:
        """Go forward again."""
        self._must_write()
        if self.document.can_redo:
            self.document.redo()
            self._shown.redone()
        return self._changed(message)

    def text(self, message: Mapping[str, Any]) -> Message:
        """Return the text of the file."""
        return {"text": self.document.text, "revision": self.document.revision}

    def copy(self, message: Mapping[str, Any]) -> Message:
        """Return elements with their bonds as the text of a model file."""
        names = {str(n) for n in message.get("names", ())}
        cut = cut_out(self.document.data, str(message.get("level") or ""), names)
        return {"text": toml_text({"hybond": 1, **cut}) if cut else ""}

    def paste(self, message: Mapping[str, Any]) -> Message:
        """Put in what a text in the clipboard says."""
        from hybond.files.parse import parse
        from hybond.files.place import Source

        data = parse(Source("clipboard", str(message.get("text", ""))))
        edit = {"do": "paste", "data": data, "by": message.get("by"), "level": message.get("level")}
        before = set(self._names(message))
        answer = self.edit({**message, "edit": edit})
        return {**answer, "pasted": [n for n in self._names(message) if n not in before]}

    def arrange(self, message: Mapping[str, Any]) -> Message:
        """Lay a level out anew, but for what is kept where it is."""
        path = str(message.get("level") or "")
        kept = {str(n) for n in message.get("keep", ())}
        level = level_of(self.document.data, path)
        if level is None or not level.editable:
            raise UsageError(
                "this level cannot be arranged",
                code="HB-W101",
                where=path or "level",
                hint="open a submodel that this file says",
            )
        shown = self._shown.of(path)
        held = {k: list(shown[k]) for k in shown if k in kept}
        loose = {**level.data, "layout": {**table(level.data, "layout"), **held}}
        loose["layout"] = {k: v for k, v in loose["layout"].items() if k in kept}
        seen = view(
            loose
            if not path
            else {
                "elements": loose.get("elements", {}),
                "graph": loose.get("graph", {}),
                "layout": loose["layout"],
                "models": self.document.data.get("models", {}),
            },
            "",
        )
        assert seen is not None
        at = {n["name"]: [n["x"], n["y"]] for n in seen["nodes"]}
        return self.edit({**message, "edit": {"do": "move", "at": at, "level": path}})

    def open(self, message: Mapping[str, Any]) -> Message:
        """Open another file of the folder, an example as a copy, or an empty model."""
        if message.get("example"):
            name = str(message["example"])
            if name not in self.examples():
                raise UsageError(
                    f"there is no example {name!r}",
                    code="HB-W104",
                    where="example",
                    hint=did_you_mean(name, self.examples()) or "there are none here",
                )
            text = (examples_folder() / f"{name}.toml").read_text(encoding="utf-8")
            self._take(self._open(None, text))
        elif message.get("file"):
            self._take(self._open(self._inside(str(message["file"])), EMPTY))
        else:
            self._take(self._open(None, EMPTY))
        self.plans.forget()
        return self._changed(message)

    def save_as(self, message: Mapping[str, Any]) -> Message:
        """Keep the model in a file of the folder from now on."""
        file = self._inside(str(message["file"]))
        if file.exists() and not message.get("replace"):
            raise UsageError(
                f"{file.name} is there already",
                code="HB-W104",
                where=file.name,
                hint="take another name, or open it",
            )
        must_be_model(file)
        text = self.document.text
        try:
            # as a whole: what is there stays if there is no room for this
            write_whole(file, text.encode())
        except OSError as error:
            raise FileError(
                f"cannot write the file: {error.strerror or error}",
                code="HB-F119",
                where=str(file),
                hint="check that the directory is there and yours",
            ) from None
        self._take(self._open(file, text))
        self.document.revision += 1
        return self._changed(message)

    # -- inside

    @property
    def writable(self) -> bool:
        """Whether this session is the one that writes the file."""
        return self.lock is None or self.lock.held

    def meaning(self) -> Meaning:
        """Return what the data mean; kept until they change."""
        document = self.document
        if self._known is None or self._known[0] != document.revision:
            base = str(document.file.parent if document.file is not None else self.root)
            self._known = (
                document.revision,
                meaning(document.data, base=base, where=document.name),
            )
        return self._known[1]

    def whole(self, what: str) -> FlatGraph:
        """Return the graph of the model; a refusal where it means nothing yet."""
        known = self.meaning()
        if known.graph is None or known.error is not None:
            hint = "put an element or a junction there"
            none = UsageError("there is no model", code="HB-W103", where=what, hint=hint)
            raise known.error or none
        return known.graph

    def shown(self, message: Mapping[str, Any]) -> Mode:
        """Return the mode that the page shows."""
        known, asked = self.meaning(), message.get("mode")
        mode = mode_of(known, asked if isinstance(asked, dict) else None)
        assert known.graph is not None
        return known.graph.start_mode if mode is None else mode

    def _changed(self, message: Mapping[str, Any]) -> Message:
        answer = self._seen(message)
        self.tell(
            {"tell": "changed", "revision": self.document.revision, "by": message.get("client")}
        )
        if self._on_change is not None:
            self._on_change(self.document.text)
        return answer

    def _names(self, message: Mapping[str, Any]) -> list[str]:
        level = level_of(self.document.data, str(message.get("level") or ""))
        return [] if level is None else list(table(level.data, "elements"))

    def _unplaced(self, path: str) -> dict[str, list[float]]:
        """Return where those elements of a level are shown that its data put nowhere."""
        level = level_of(self.document.data, path)
        given = {} if level is None else table(level.data, "layout")
        return {k: list(v) for k, v in self._shown.of(path).items() if k not in given}

    def _must_write(self) -> None:
        if not self.writable:
            raise UsageError(
                f"{self.document.name} is open in another studio, which writes it",
                code="HB-W105",
                where=self.document.name,
                hint="close that one, or keep yours under another name",
            )

    def _open(self, file: Path | None, text: str) -> Document:
        if file is not None:
            must_be_model(file)
        if self.lock is not None:
            self.lock.release()
            self.lock = None
        journal = None
        if file is not None and self._journal:
            journal = Recovery(file)
            self.lock = Lock(journal.path.with_suffix(".lock"))
            if not self.lock.held:
                journal = None
        return Document(file, text, journal)

    def _take(self, document: Document) -> None:
        revision = self.document.revision
        self.document.close()
        self.document = document
        self._shown = Shown()
        document.revision = revision + 1
        self._known = None

    def _inside(self, name: str) -> Path:
        """Return a file of the folder; HB-W104 for one that is not there."""
        file = self.root
        if "\0" not in name and name.isprintable() and len(name) <= LONGEST:
            file = (self.root / name).resolve()
        if file == self.root or not file.is_relative_to(self.root):
            raise UsageError(
                f"{name!r} is not in the folder {self.root}",
                code="HB-W104",
                where="file",
                hint="start the studio in the folder of the file",
            )
        return file

    def files(self) -> list[str]:
        """Return the names of the model files that can be opened."""
        found = sorted(p.name for p in self.root.glob("*.toml"))
        return found[:500]

    def examples(self) -> list[str]:
        """Return the names of the examples that can be opened."""
        try:
            return sorted(f.stem for f in models_in(examples_folder()) if f.suffix == ".toml")
        except HybondError:
            return []


ASKS: dict[str, Callable[[Session, Mapping[str, Any]], Message]] = {
    "look": Session.look,
    "edit": Session.edit,
    "attempt": Session.attempt,
    "replace": Session.replace,
    "undo": Session.undo,
    "redo": Session.redo,
    "text": Session.text,
    "copy": Session.copy,
    "paste": Session.paste,
    "arrange": Session.arrange,
    "open": Session.open,
    "save as": Session.save_as,
    "stock": of_models.offers,
    "equations": of_models.written,
    "structure": of_models.structured,
    "schematic": of_models.schematic,
    "picture": of_models.picture,
    "run": of_runs.begin,
    "cancel": of_runs.cancel,
    "sweep": of_runs.sweep,
    "runs": of_runs.summaries,
    "curves": of_runs.curves_of,
    "phase": of_runs.phase_of,
    "events": of_runs.events_of,
    "energies": of_runs.energies,
    "cursor": of_runs.cursor,
    "plan words": of_plans.words,
    "plan look": of_plans.look,
    "plan begin": of_plans.begin,
    "plan state": of_plans.state,
    "plan cancel": of_plans.cancel,
    "plan view": of_plans.seen,
    "plan member": of_plans.member,
    "plan open": of_plans.open_member,
    "plan csv": of_plans.csv,
}
"""What may be asked."""
