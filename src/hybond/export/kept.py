"""The runtime as it was read, and its functions as they were printed, kept from call to call.

Reading the runtime takes seconds, and it changes with hybond only. What was read is kept beside
Python's bytecode, and so is what was printed in each language; where Python writes none, in the
folder of the user for such files. The files are of one digest of the sources; where they are not,
or cannot be written, everything is read and printed anew.
"""

from __future__ import annotations

import hashlib
import os
import sys
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from threading import get_ident
from typing import Any

from hybond.engine.compiled.sources import digest
from hybond.export.user_folder import make_own, read_own, tidy, user_folder
from hybond.translate.effects import Effects
from hybond.translate.modules import Program
from hybond.translate.reach import Uses
from hybond.translate.specialise import Made
from hybond.translate.stored import restored, stored
from hybond.translate.tree import Block, Function

MOST = 32_000_000
"""Bytes of a file of printed functions; beyond that it is taken away, and begins anew."""
OWN = ("program.py", "kept.py")
"""Files of this room that say what is read."""
UNREAD = Block(())
"""Stands for a body that is kept aside."""


class Bodies(Mapping[str, Block]):
    """The bodies of functions, each read when it is asked for."""

    def __init__(self, packed: dict[str, bytes]) -> None:
        self.packed = packed

    def __getitem__(self, name: str) -> Block:
        found: Block = restored(self.packed[name])
        return found

    def __iter__(self) -> Iterator[str]:
        return iter(self.packed)

    def __len__(self) -> int:
        return len(self.packed)


@dataclass(frozen=True, slots=True)
class Read:
    """A program, what its functions change and use, and which fields stand in conditions."""

    program: Program
    effects: Effects
    uses: dict[str, Uses]
    deciding: frozenset[tuple[str, str]]
    bodies: Mapping[str, Block] | None = None
    """None where the program has them."""


@dataclass
class Printed:
    """Functions that were made for models and printed in one language."""

    uses: dict[Made, Uses] = field(default_factory=dict)
    texts: dict[Made, str] = field(default_factory=dict)


@lru_cache(maxsize=1)
def stamp() -> bytes:
    """Return what tells the sources of the runtime, and what reads them, from others."""
    here = Path(__file__).parent
    own = b"".join((here / name).read_bytes().replace(b"\r\n", b"\n") for name in OWN)
    return hashlib.sha256(digest().encode() + own).digest()


def place_of(name: str) -> Path | None:
    """Return the file for something that is kept beside bytecode; None where there is none."""
    cached = __spec__.cached
    return Path(cached).parent / f"_runtime.{name}" if cached else None


def own_place_of(name: str) -> Path | None:
    """Return the file for something that is kept in the folder of the user; None without one.

    Several versions of hybond may be there: each has files of its own.
    """
    folder = user_folder()
    return folder / f"runtime-{stamp().hex()[:12]}.{name}" if folder is not None else None


def runtime_kept() -> Read | None:
    """Return the runtime as it was read before, None if it was not."""
    found = _read("read")
    if found is None:
        return None
    program, effects, uses, deciding, bodies = found
    return Read(program, effects, uses, deciding, Bodies(bodies))


def keep_runtime(found: Read) -> None:
    """Keep a runtime that was read."""
    modules = found.program.modules
    functions = [f for m in modules for f in m.functions.values()]
    bodies = {f.name: stored(f.body) for f in functions if f.body is not None}
    short = tuple(
        replace(m, functions={name: _without(f) for name, f in m.functions.items()})
        for m in modules
    )
    _write("read", (Program(short), found.effects, found.uses, found.deciding, bodies))


def _without(f: Function) -> Function:
    return f if f.body is None else replace(f, body=UNREAD)


def printed_kept(language: str) -> Printed:
    """Return what was printed in a language before."""
    found = _read(language)
    return Printed() if found is None else Printed(*found)


def keep_printed(language: str, printed: Printed) -> None:
    """Keep what was printed in a language."""
    _write(language, (printed.uses, printed.texts))


def _read(name: str) -> Any:
    """Return what a file holds, None if there is none of these sources, or not all of it."""
    place, own = place_of(name), own_place_of(name)
    found = None if place is None else _whole(_bytes_of(place))
    if found is None and own is not None:
        found = _whole(read_own(own))
    return None if found is None else restored(found)


def _bytes_of(place: Path) -> bytes | None:
    try:
        return place.read_bytes()
    except OSError:
        return None


def _whole(data: bytes | None) -> bytes | None:
    """Return what a file holds behind its digests, None if these are others."""
    if data is None or data[:32] != stamp():
        return None
    return data[64:] if data[32:64] == hashlib.sha256(data[64:]).digest() else None


def _write(name: str, thing: object) -> None:
    """Write beside bytecode where Python would, else into the folder of the user."""
    data = stored(thing)
    place, own = place_of(name), own_place_of(name)
    if place is not None and not sys.dont_write_bytecode and _written(place, data):
        return
    if own is not None and make_own(own.parent) and _written(own, data, 0o600):
        tidy(own.parent, "runtime-*")


def _written(place: Path, data: bytes, mode: int | None = None) -> bool:
    """Write a file whole or not at all: somebody may read the old one. Whether that is done."""
    if len(data) > MOST:
        with suppress(OSError):
            place.unlink()
        return True
    new = place.with_name(f"{place.name}.{os.getpid()}.{get_ident()}")
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        try:
            new.write_bytes(stamp() + hashlib.sha256(data).digest() + data)
            if mode is not None:
                new.chmod(mode)
            os.replace(new, place)
        finally:
            new.unlink(missing_ok=True)
    except OSError:
        return False
    return True
