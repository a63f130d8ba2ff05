"""Submodels that are files of their own: ``submodel = "parts/motor.toml"``.

A reference is relative to the file that holds it and stays inside the directory of the top
file, so that a model from a stranger cannot look around on the disk. A file that is referred to
twice is read once.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path, PurePosixPath, PureWindowsPath
from typing import Any

from hybond.errors import FileError
from hybond.files import limits
from hybond.files.check import check_plain
from hybond.files.parse import format_of, parse, read_text
from hybond.files.place import Place, Source, quoted
from hybond.model.builder import Model


def is_file(reference: Any) -> bool:
    """Return whether a ``submodel`` names a file rather than a model.

    Examples
    --------
    >>> is_file("motor.toml"), is_file("parts/motor.toml"), is_file("motor")
    (True, True, False)
    """
    return isinstance(reference, str) and (
        reference.lower().endswith((".toml", ".json")) or "/" in reference or "\\" in reference
    )


class Reading:
    """One top model being read: its files, and how much has been read.

    Parameters
    ----------
    root : Path or None
        The directory that files are taken from; None if there is none.
    follow : bool
        Whether references to files are followed at all.
    """

    def __init__(self, root: Path | None, *, follow: bool = True) -> None:
        self.root = root.resolve() if root is not None else None
        self.follow = follow
        self._folder = self.root
        self._open: list[Path] = []
        self._models: dict[Path, Model] = {}
        self._elements = 0
        self._level = 0

    def top(self, path: Path) -> None:
        """Say which file is the top one."""
        self._open.append(path.resolve())

    def count_elements(self, number: int, place: Place) -> None:
        """Add up elements and refuse too many."""
        self._elements += number
        if self._elements > limits.ELEMENTS:
            why = f"more than {limits.ELEMENTS} elements"
            raise place.refuse(why, code="HB-F103", hint="take some of them out")

    @contextmanager
    def inside(self, place: Place) -> Iterator[None]:
        """Go one level deeper, and back."""
        self._level += 1
        if self._level > limits.LEVELS:
            raise place.refuse(
                f"more than {limits.LEVELS} models inside one another",
                code="HB-F103",
                hint="put models side by side",
            )
        yield
        self._level -= 1

    def file(self, reference: str, place: Place) -> Model | None:
        """Return the model of the file that `reference` names, or None if not to follow.

        Raises
        ------
        FileError
            HB-F115 (outside the tree), HB-F116 (a cycle), HB-F103, and what is wrong in it.
        """
        if not self.follow:
            return None
        path = self._resolve(reference, place)
        if path in self._open:
            cycle = [*self._open[self._open.index(path) :], path]
            raise place.refuse(
                "a model contains itself: " + " -> ".join(p.name for p in cycle),
                code="HB-F116",
                hint="take one of these submodels out",
            )
        if path not in self._models:
            if len(self._models) + len(self._open) >= limits.FILES:
                raise place.refuse(
                    f"more than {limits.FILES} files",
                    code="HB-F103",
                    hint="put models into one file",
                )
            self._models[path] = self._read(path, reference, place)
        return self._models[path]

    def unit(self, reference: str, place: Place) -> Path | None:
        """Return the path of the FMU that `reference` names, or None if not to follow.

        Raises
        ------
        FileError
            HB-F115 (outside the tree).
        """
        return self._resolve(reference, place, (".fmu",)) if self.follow else None

    def _resolve(
        self, reference: str, place: Place, kinds: tuple[str, ...] = (".toml", ".json")
    ) -> Path:
        def refuse(why: str, hint: str) -> FileError:
            return place.refuse(f"{quoted(reference)} {why}", code="HB-F115", hint=hint)

        if self.root is None or self._folder is None:
            raise refuse("names a file, but this text has no directory", "give base=")
        if "\\" in reference or "\0" in reference:
            raise refuse("is not a portable path", "separate directories by /")
        if PurePosixPath(reference).is_absolute() or PureWindowsPath(reference).drive:
            raise refuse("is an absolute path", "write it relative to this file")
        if ".." in PurePosixPath(reference).parts:
            raise refuse("goes upwards", "keep files beside the model or below it")
        if not reference.lower().endswith(kinds):
            what = "an FMU" if kinds == (".fmu",) else "a model file"
            raise refuse(f"is not {what}", f"its name ends in {' or '.join(kinds)}")
        try:
            path = (self._folder / reference).resolve()
        except (OSError, RuntimeError, ValueError):
            raise refuse("cannot be followed", "check the links in it") from None
        # A symbolic link may lead out although the text does not.
        if not path.is_relative_to(self.root):
            raise refuse(f"leads out of {self.root}", "copy the file into the directory")
        return path

    def _read(self, path: Path, reference: str, place: Place) -> Model:
        from hybond.files.decode import read_file_data  # which reads submodels: a cycle

        # Named the way the top file was named: models/top.toml, models/part.toml.
        name = str(Path(place.source.name).parent / reference)
        try:
            text = read_text(path, name)
        except FileError as error:
            if error.code == "HB-F101":
                near = f"; {error.hint}" if error.hint.startswith("did you") else ""
                hint = f"it is looked for at {path}{near}"
                raise place.refuse(error.why, code=error.code, hint=hint) from None
            raise
        source = Source(name, text, format_of(path))
        data = parse(source)
        check_plain(data, Place(source))
        folder, self._folder = self._folder, path.parent
        self._open.append(path)
        with self.inside(place):
            model = read_file_data(data, Place(source), self, path.stem)
        self._open.pop()
        self._folder = folder
        return model
