"""A schematic of LTspice (``.asc``) as the cards of a netlist.

Wires join points; a pin belongs to the wires that pass through its point, a flag names them. Where
pins are is known of the symbols that come with LTspice and stand for cards that are read here;
other symbols are refused by name.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from hybond.circuits.notices import Line

Point = tuple[int, int]
_PAIR = ((16, 16), (16, 96))
_SOURCE = ((0, 16), (0, 96))
_CONTROL = ((0, 16), (0, 96), (-48, 32), (-48, 80))
SYMBOLS: dict[str, tuple[str, tuple[Point, ...]]] = {
    "res": ("R", _PAIR),
    "res2": ("R", _PAIR),
    "ind": ("L", _PAIR),
    "ind2": ("L", _PAIR),
    "cap": ("C", ((16, 0), (16, 64))),
    "polcap": ("C", ((16, 0), (16, 64))),
    "diode": ("D", ((16, 0), (16, 64))),
    "schottky": ("D", ((16, 0), (16, 64))),
    "voltage": ("V", _SOURCE),
    "bv": ("B", _SOURCE),
    "bi": ("B", ((0, 0), (0, 80))),
    "bi2": ("B", ((0, 0), (0, 80))),
    "current": ("I", ((0, 0), (0, 80))),
    "e": ("E", _CONTROL),
    "e2": ("E", ((0, 16), (0, 96), (-48, 80), (-48, 32))),
    "g": ("G", _CONTROL),
    "g2": ("G", ((0, 16), (0, 96), (-48, 80), (-48, 32))),
    "f": ("F", _SOURCE),
    "h": ("H", _SOURCE),
    "sw": ("S", ((0, 16), (0, 96), (-48, 80), (-48, 32))),
    "csw": ("W", _SOURCE),
}
"""Of each symbol the letter of its card, and its pins in the order of the card."""
_ATTRIBUTES = ("Value", "Value2", "SpiceLine", "SpiceLine2")


@dataclass
class _Symbol:
    line: Line
    pins: tuple[Point, ...]
    letter: str
    words: dict[str, str] = field(default_factory=dict)


def cards_of(rows: list[str], name: str) -> list[str]:
    r"""Return the rows of a netlist that say what a schematic shows.

    Parameters
    ----------
    rows : list of str
        The lines of the file.
    name : str
        What messages call the file.

    Raises
    ------
    FileError
        HB-F130 (a line that cannot be read), HB-F136 (a symbol that is not known).

    Examples
    --------
    >>> rows = ["Version 4", "SHEET 1 0 0", "WIRE 16 16 0 16", "FLAG 0 16 in", "FLAG 16 96 0",
    ...     "SYMBOL res 0 0 R0", "SYMATTR InstName R1", "SYMATTR Value 1k",
    ...     r"TEXT 0 0 Left 2 !.tran 1m\n.ic V(in)=1"]
    >>> cards_of(rows, "x.asc")
    ['* x', 'R1 in 0 1k', '.tran 1m', '.ic V(in)=1']
    """
    wires: list[tuple[Point, Point]] = []
    flags: dict[Point, str] = {}
    symbols: list[_Symbol] = []
    commands: list[str] = []
    for number, row in enumerate(rows, start=1):
        line = Line(name, number, row.strip())
        words = line.text.split()
        match words[:1]:
            case ["WIRE"]:
                a, b, c, d = _numbers(words[1:5], 4, line)
                wires.append(((a, b), (c, d)))
            case ["FLAG"] if len(words) >= 4:
                x, y = _numbers(words[1:3], 2, line)
                flags[x, y] = words[3]
            case ["SYMBOL"]:
                symbols.append(_symbol(words, line))
            case ["SYMATTR"] if symbols and len(words) >= 3:
                symbols[-1].words[words[1]] = line.text.split(None, 2)[2]
            case ["TEXT"]:
                commands += _commands(line)
    names = _Nodes(wires, flags, [p for s in symbols for p in s.pins])
    found = [f"* {Path(name).stem}"]
    for symbol in symbols:
        own = symbol.words.get("InstName", "")
        if not own:
            raise symbol.line.refuse(
                "a symbol without a name", code="HB-F130", hint="give it one in the schematic"
            )
        if own[0].upper() != symbol.letter:
            own = f"{symbol.letter}_{own}"
        nodes = [names.name(p) for p in symbol.pins]
        law = symbol.words.get("Value", "")
        if symbol.letter in "EG" and law.lower().startswith("value"):
            nodes = nodes[:2]
        said = [symbol.words[k] for k in _ATTRIBUTES if k in symbol.words]
        found.append(" ".join([own, *nodes, *said]))
    return found + commands


def _numbers(words: list[str], count: int, line: Line) -> list[int]:
    try:
        found = [int(w) for w in words]
    except ValueError:
        found = []
    if len(found) != count:
        raise line.refuse(
            "coordinates are missing", code="HB-F130", hint="save the schematic again"
        )
    return found


def _symbol(words: list[str], line: Line) -> _Symbol:
    if len(words) < 5:
        raise line.refuse("a symbol without a place", code="HB-F130", hint="save it again")
    kind = words[1].replace("\\", "/").rsplit("/", 1)[-1].lower()
    if kind not in SYMBOLS:
        raise line.refuse(
            f"the symbol {words[1]!r} stands for a part without ideal meaning, or is not known",
            code="HB-F136",
            hint=f"known are {', '.join(SYMBOLS)}; or convert its netlist (View, SPICE Netlist)",
        )
    x, y = _numbers(words[2:4], 2, line)
    letter, pins = SYMBOLS[kind]
    return _Symbol(line, tuple(_placed(p, words[4], x, y, line) for p in pins), letter)


def _placed(pin: Point, turn: str, x: int, y: int, line: Line) -> Point:
    """Return where a pin is: mirrored at its y axis with M, then turned clockwise."""
    a, b = pin
    if turn[:1] == "M":
        a = -a
    match turn[1:]:
        case "0":
            pass
        case "90":
            a, b = -b, a
        case "180":
            a, b = -a, -b
        case "270":
            a, b = b, -a
        case _:
            raise line.refuse(f"a symbol turned by {turn}", code="HB-F130", hint="R0, R90, M0, ...")
    return x + a, y + b


def _commands(line: Line) -> list[str]:
    """Return the commands of a text, one a row; a comment has none."""
    words = line.text.split(None, 5)
    if len(words) < 6 or not words[5].startswith("!"):
        return []
    return [row for row in words[5][1:].split("\\n") if row.strip()]


class _Nodes:
    """Which points are one node, and its name."""

    def __init__(
        self, wires: list[tuple[Point, Point]], flags: dict[Point, str], pins: list[Point]
    ) -> None:
        self._up: dict[Point, Point] = {}
        rows: dict[int, list[Point]] = {}
        columns: dict[int, list[Point]] = {}
        for p in {*pins, *flags, *(p for wire in wires for p in wire)}:
            columns.setdefault(p[0], []).append(p)
            rows.setdefault(p[1], []).append(p)
        for a, b in wires:
            along = columns[a[0]] if a[0] == b[0] else rows[a[1]] if a[1] == b[1] else [b]
            low, high = min(a, b), max(a, b)
            for p in along:
                if low <= p <= high:
                    self._join(a, p)
        by_name: dict[str, Point] = {}
        self._names: dict[Point, str] = {}
        for p, name in flags.items():
            self._join(by_name.setdefault(name.lower(), p), p)
        for p, name in flags.items():
            root = self._root(p)
            # ground is ground, whatever else it is called
            if self._names.get(root) != "0":
                self._names[root] = name
        self._count = 0
        self._taken = {name.lower() for name in flags.values()}

    def _root(self, p: Point) -> Point:
        while (up := self._up.get(p, p)) != p:
            self._up[p] = self._up.get(up, up)
            p = up
        return p

    def _join(self, a: Point, b: Point) -> None:
        first, second = self._root(a), self._root(b)
        if first != second:
            self._up[second] = first

    def name(self, p: Point) -> str:
        """Return the name of the node at a point, ``N001`` and so on where no flag gives one."""
        root = self._root(p)
        while root not in self._names:
            self._count += 1
            text = f"N{self._count:03}"
            if text.lower() not in self._taken:
                self._names[root] = text
        return self._names[root]
