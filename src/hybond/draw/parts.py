"""A sketch with parts as frames: closed ones are one symbol, opened ones have a frame around."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

from hybond.draw.sketch import Frame, Sketch, Symbol
from hybond.errors import UsageError
from hybond.names import did_you_mean


def parts_of(paths: Collection[str]) -> list[str]:
    """Return the paths of the parts, and of parts in parts, in which nodes lie.

    Examples
    --------
    >>> parts_of(["V", "leg.upper.i", "leg.out"])
    ['leg', 'leg.upper']
    """
    found: dict[str, None] = {}
    for path in paths:
        words = path.split(".")
        for k in range(1, len(words)):
            found[".".join(words[:k])] = None
    return list(found)


def in_frames(sketch: Sketch, opened: Collection[str]) -> Sketch:
    """Return a sketch in which each part is one symbol, but for those that are `opened`.

    Parameters
    ----------
    opened : collection of str
        Paths of parts; one inside another is seen only if that is open, too.

    Raises
    ------
    UsageError
        HB-D111 for a path that is no part.
    """
    known = parts_of([s.path for s in sketch.symbols])
    for path in opened:
        if path not in known:
            raise UsageError(
                f"there is no part {path!r} to open",
                code="HB-D111",
                where="open",
                hint=did_you_mean(path, known)
                or (f"parts are {', '.join(known[:6])}" if known else "the model has no parts"),
            )
    closed_in = [_closed(s.path, opened) for s in sketch.symbols]
    symbols: list[Symbol] = []
    place: list[int] = []
    where: dict[str, int] = {}
    pins: dict[int, tuple[float, float]] = {}
    for k, (s, part) in enumerate(zip(sketch.symbols, closed_in, strict=True)):
        if part is None:
            place.append(len(symbols))
            symbols.append(s)
        elif part not in where:
            inside = [o for o, p in zip(sketch.symbols, closed_in, strict=True) if p == part]
            where[part] = len(symbols)
            place.append(len(symbols))
            symbols.append(_box(part, inside))
        else:
            place.append(where[part])
        if k in sketch.pins:
            pins.setdefault(place[k], sketch.pins[k])
    arrows = [
        replace(a, tail=place[a.tail], head=place[a.head])
        for a in sketch.arrows
        if place[a.tail] != place[a.head]
    ]
    frames = tuple(
        Frame(part, tuple(k for k, s in enumerate(symbols) if s.path.startswith(f"{part}.")))
        for part in known
        if part in opened and _closed(f"{part}.x", opened) is None
    )
    return replace(sketch, symbols=tuple(symbols), arrows=tuple(arrows), pins=pins, frames=frames)


def _closed(path: str, opened: Collection[str]) -> str | None:
    """Return the outermost closed part in which a node lies, None if all around it are open."""
    words = path.split(".")
    for k in range(1, len(words)):
        part = ".".join(words[:k])
        if part not in opened:
            return part
    return None


def _box(part: str, inside: Sequence[Symbol]) -> Symbol:
    machines = list(dict.fromkeys(s.machine for s in inside if s.machine))
    return Symbol(
        path=part,
        kind="part",
        letters=part.rpartition(".")[2],
        about=f"{part}: {len(inside)} nodes",
        machine=", ".join(machines),
        off=all(s.off for s in inside),
        derivative=any(s.derivative for s in inside),
    )
