"""One element card of a netlist: its words, options and values, and the parts written on it."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from hybond.circuits.behaviour import READ, Law, behaviour_of
from hybond.circuits.formulas import read_formula
from hybond.circuits.notices import Line, Notices
from hybond.circuits.numerals import LETTERED, numeral
from hybond.errors import FileError
from hybond.model.expressions import Binary, Expr, Number

_WORD = re.compile(r"\{[^{}]*\}|'[^']*'|\"[^\"]*\"|[()=]|[^\s(){}=,'\"]+|(\S)")

NODES = {"r": 2, "c": 2, "l": 2, "v": 2, "i": 2, "e": 4, "g": 4, "f": 2, "h": 2, "d": 2}
NODES |= {"s": 4, "w": 2}
"""Nodes of each kind of card; those of K and X are counted otherwise."""
WITHOUT_MEANING = {
    "q": "a bipolar transistor",
    "m": "a MOS transistor",
    "j": "a junction field effect transistor",
    "z": "a MESFET or IGBT",
    "t": "a transmission line",
    "o": "a lossy transmission line",
    "u": "a distributed RC line",
    "y": "a lossy transmission line",
    "a": "a code model",
    "n": "a device of an external library",
    "p": "coupled transmission lines",
}
_REMEDY = {
    "q": "replace it by a switch S with its control, or by a controlled source F",
    "m": "replace it by a switch S with its control, and a diode D for the body diode",
    "j": "replace it by a switch S with its control",
    "z": "replace it by a switch S with its control",
    "t": "write it as a ladder of L and C",
    "o": "write it as a ladder of R, L and C",
    "u": "write it as a ladder of R and C",
}
_ANALOG_SWITCH = re.compile(
    r"(\S+)\s+(?:%v\s*\(?\s*(\S+?)\s*\)?|(?:%vd\s*)?\(\s*(\S+)\s+(\S+)\s*\)|([^\s()%]+))\s+"
    r"(?:%gd\s*)?\(\s*(\S+)\s+(\S+)\s*\)\s+(\S+)\Z",
    re.IGNORECASE,
)
"""A code model with a control and a pair of nodes: ``A1 g (a b) model``."""
_IGNORED = frozenset({"tc", "tc1", "tc2", "temp", "dtemp", "noisy", "noise"})
PARASITICS = {"c": ("rser", "lser", "rpar", "cpar"), "l": ("rser", "rpar", "cpar")}
PARASITICS |= {"v": ("rser", "cpar")}
"""What LTspice writes on the card of a part and means as parts of their own."""
_SHAPE = ("td", "r")
_OPTIONS = {"r": {"r", "m"}, "c": {"c", "ic", "m"}, "l": {"l", "ic", "m"}, "v": {*_SHAPE}}
_OPTIONS |= {"d": {"area", "ic", "m"}, "i": {*_SHAPE}, "e": set(), "f": set(), "g": set()}
_BENT = {"c": ("a capacitance", "q"), "l": ("an inductance", "flux")}
_OPTIONS |= {"h": set(), "s": set(), "w": set()}
_SPECIAL = frozenset(
    {"poly", "value", "table", "laplace", "freq", "cur", "vol", "chebyshev", "delay"}
)
FUNCTIONS = frozenset({"pulse", "sin", "sine", "exp", "pwl", "sffm", "am", "trnoise", "trrandom"})


@dataclass(frozen=True, slots=True)
class Card:
    """An element as it is written, before subcircuits are opened."""

    name: str
    """As written, ``"Rload"``; its first letter is the kind."""
    line: Line
    nodes: tuple[str, ...]
    """As written: the two terminals, then controlling nodes."""
    value: Expr | None = None
    """Resistance, gain, coupling, DC value, area, ..."""
    start: Expr | None = None
    """``IC=``."""
    refers: tuple[str, ...] = ()
    """Model or subcircuit; of F, H and W the controlling source first; of K the coils."""
    wave: tuple[str, tuple[str, ...]] | None = None
    """The function of time of a source and its arguments."""
    state: str = ""
    """``on`` or ``off`` of a switch, if written."""
    shape: Mapping[str, Expr] = field(default_factory=dict)
    """Of a source ``td=`` and ``r=`` of PWL."""
    law: Law | None = None
    """Of a source that computes."""
    parasitics: Mapping[str, Expr] = field(default_factory=dict)
    """``Rser``, ``Lser``, ``Rpar``, ``Cpar`` of R, L, C and V."""
    given: Mapping[str, Expr] = field(default_factory=dict)
    """Parameters of an X card."""

    @property
    def kind(self) -> str:
        """Return the letter that says what the card is, in lower case."""
        return self.name[0].lower()


def words_of(text: str, line: Line) -> list[str]:
    """Return the words of a card; brackets, quotes and braces keep together what they hold.

    Examples
    --------
    >>> words_of("V1 in 0 SIN(0 {a b} 50)", Line("x", 1, ""))
    ['V1', 'in', '0', 'SIN', '(', '0', '{a b}', '50', ')']
    """
    found = []
    for match in _WORD.finditer(text.replace(",", " ")) if "{" not in text else _braced(text):
        if match[1]:
            raise line.refuse(
                f"{match[1]!r} has no partner", code="HB-F130", hint="close the brace or quote"
            )
        found.append(match.group())
    return found


def _braced(text: str) -> list[re.Match[str]]:
    # commas separate words, but not the arguments of functions in braces
    found = list(_WORD.finditer(text))
    return [m for m in found if m.group() != ","]


def options_of(words: list[str], line: Line) -> tuple[list[str], dict[str, str]]:
    """Return the words without ``name=value``, and these by name in lower case."""
    plain: list[str] = []
    options: dict[str, str] = {}
    k = 0
    while k < len(words):
        if k + 1 < len(words) and words[k + 1] == "=":
            if k + 2 >= len(words) or words[k + 2] in ("=", "(", ")"):
                raise line.refuse(
                    f"{words[k]} = has no value",
                    code="HB-F130",
                    hint="write a number, or an expression in braces",
                )
            if words[k].lower() in options:
                raise line.refuse(
                    f"{words[k]} is given twice", code="HB-F133", hint="take one of them out"
                )
            options[words[k].lower()] = words[k + 2]
            k += 3
            # tc=0.001,2e-6: the second coefficient belongs to it
            if words[k - 3].lower() == "tc" and _numeral_at(words, k):
                k += 1
        elif words[k] == "=":
            raise line.refuse("'=' without a name", code="HB-F130", hint="write name=value")
        else:
            plain.append(words[k])
            k += 1
    return plain, options


def _spelled(words: list[str]) -> list[str]:
    """Return the words of a source with ``DC 5`` for ``DC=5``."""
    return [w for k, w in enumerate(words) if w != "=" or words[k - 1].lower() not in ("dc", "ac")]


def _numeral_at(words: list[str], k: int) -> bool:
    """Whether a number stands there that is no name of an option."""
    return k < len(words) and words[k + 1 : k + 2] != ["="] and numeral(words[k]) is not None


def read_card(line: Line, notices: Notices) -> Card:
    """Return the element of a line.

    Raises
    ------
    FileError
        HB-F130 (words that do not fit the kind), HB-F131 (a value), HB-F133 (an option twice),
        HB-F136 (an element without ideal meaning).
    """
    name, kind = line.text.split(None, 1)[0], line.text[0].lower()
    if kind in "begfh" and (law := behaviour_of(line)) is not None:
        return Card(name, line, law[0], law=law[1])
    words = words_of(line.text, line)
    name = words[0]
    if kind == "a" and (code := _ANALOG_SWITCH.match(line.text)):
        control = (code[3], code[4]) if code[3] else (code[2] or code[5], "0")
        return Card(name, line, (code[6], code[7], *control), refers=(code[8],))
    if kind in WITHOUT_MEANING:
        raise line.refuse(
            f"{WITHOUT_MEANING[kind]} has no ideal meaning",
            code="HB-F136",
            hint=_REMEDY.get(kind, "leave it out, or model it with R, L, C, D, S and sources"),
        )
    if kind == "x":
        return _instance(line, words)
    if kind == "k":
        return _coupling(line, words)
    if kind not in NODES:
        raise line.refuse(
            f"{name!r} begins with no letter of an element",
            code="HB-F130",
            hint="R L C K V I E F G H D S W X; commands begin with a dot, comments with *",
        )
    if kind in "efgh" and {w.lower() for w in words} & _SPECIAL:
        raise line.refuse(
            "a controlled source that is not a gain times one voltage or current",
            code="HB-F136",
            hint="write it as VALUE={...} of voltages, currents and `time`: E and G take an "
            "expression, also table(x, x0, y0, x1, y1); LAPLACE and FREQ as R, C and gains",
        )
    if kind in "vi":
        words = _spelled(words)
    plain, options = options_of(words, line)
    _check_options(kind, options, line, notices)
    count = NODES[kind]
    if len(plain) < 1 + count or any(w in "()" for w in plain[1 : 1 + count]):
        raise line.refuse(
            f"{name} needs {count} nodes", code="HB-F130", hint="see the form of the card"
        )
    nodes, rest = tuple(plain[1 : 1 + count]), plain[1 + count :]
    start = read_formula(options["ic"], line) if "ic" in options else None
    beside = {k: read_formula(options[k], line) for k in PARASITICS.get(kind, ()) if k in options}
    if kind in "rcl":
        card = _passive(line, name, nodes, rest, options, start, notices)
        return replace(card, parasitics=beside)
    if kind in "vi":
        shape = {k: read_formula(options[k], line) for k in _SHAPE if k in options}
        card = _source(line, name, nodes, rest, notices)
        if shape and (card.wave is None or card.wave[0] != "pwl"):
            raise line.refuse("td= and r= are of PWL", code="HB-F130", hint="take them out")
        if card.wave is not None and "r" in card.given:
            shape["r"] = card.given["r"]
        return replace(card, given={}, shape=shape, parasitics=beside)
    if kind in "eg" or kind in "fh":
        return _controlled(line, name, nodes, rest)
    if kind == "d":
        return _diode(line, name, nodes, rest, options, notices)
    return _switch(line, name, nodes, rest)


def _check_options(kind: str, options: dict[str, str], line: Line, notices: Notices) -> None:
    for option in options:
        if option in _IGNORED:
            notices.add(line, f"{option} is left out: parts are ideal at every temperature")
        elif kind in _BENT and option == _BENT[kind][1]:
            raise _bent(line, line.text.split(None, 1)[0], f"the law {option}={options[option]}")
        elif option not in _OPTIONS[kind] and option not in PARASITICS.get(kind, ()):
            raise line.refuse(
                f"the option {option!r} is not understood",
                code="HB-F130",
                hint="take it out, or write what it stands for as an element of its own",
            )


def _passive(
    line: Line,
    name: str,
    nodes: tuple[str, ...],
    rest: list[str],
    options: dict[str, str],
    start: Expr | None,
    notices: Notices,
) -> Card:
    kind = name[0].lower()
    values = [*rest, *([options[kind]] if kind in options else [])]
    if len(values) != 1:
        raise line.refuse(
            f"{name} has {len(values)} values" if values else f"{name} has no value",
            code="HB-F130",
            hint=f"write {name} {nodes[0]} {nodes[1]} value; models of {kind.upper()} "
            "are not known",
        )
    if kind == "r" and (read := READ.search(values[0])):
        law = values[0].strip("{}'\"")
        raise line.refuse(
            f"a resistance that reads {read[0]}",
            code="HB-F136",
            hint=f"write B{name} {nodes[0]} {nodes[1]} I=V({nodes[0]},{nodes[1]})/({law})",
        )
    if kind != "r" and (read := READ.search(values[0])):
        raise _bent(line, name, f"{_BENT[kind][0]} that reads {read[0]}")
    value = read_formula(values[0], line)
    if "m" in options:
        value = _several(kind, value, options, line)
    if LETTERED.fullmatch(values[0]) and isinstance(value, Number):
        notices.add(line, f"{values[0]} is {value.value:g}: the letter stands for the point")
    return Card(name, line, nodes, value, start)


def _bent(line: Line, name: str, what: str) -> FileError:
    """Return the refusal of storage whose value depends on its state; the model has laws for it."""
    kind, own = (("C", "e of its charge q"), ("I", "f of its flux p"))[name[0] in "lL"]
    law = f"{kind} = {{ {own[0]} = '...' }}"
    return line.refuse(
        what,
        code="HB-F136",
        hint=f"write a number here, convert, and give {name} a law in the model: {law}, {own}",
    )


def _several(kind: str, value: Expr, options: Mapping[str, str], line: Line) -> Expr:
    """Return the value of so many parts beside each other as ``m=`` says."""
    own = {*PARASITICS.get(kind, ()), *(("ic",) if kind == "l" else ())}
    if own & set(options):
        raise line.refuse(
            "m= of a part that has a current at the start, or resistances of its own",
            code="HB-F130",
            hint="write the parts one by one, or one that stands for all",
        )
    return Binary("*" if kind in "cd" else "/", value, read_formula(options["m"], line))


def _source(
    line: Line, name: str, nodes: tuple[str, ...], rest: list[str], notices: Notices
) -> Card:
    value: Expr | None = None
    wave: tuple[str, tuple[str, ...]] | None = None
    given: dict[str, Expr] = {}
    k = 0
    while k < len(rest):
        word = rest[k].lower()
        if word == "dc" and k + 1 < len(rest):
            value = read_formula(rest[k + 1], line)
            k += 2
        elif word == "ac":
            notices.add(line, "the AC value is left out")
            k += 1
            while k < len(rest) and rest[k].lower() not in FUNCTIONS | {"dc"}:
                k += 1
        elif word in FUNCTIONS:
            if wave is not None:
                raise line.refuse(
                    "two functions of time", code="HB-F130", hint="use two sources in series"
                )
            end, arguments = _arguments(rest, k + 1, line)
            wave = ("sin" if word == "sine" else word, arguments)
            k = end
        elif word == "repeat" and wave == ("pwl", ()):
            k, points = _repeat(rest, k, line)
            wave, given = ("pwl", points), {"r": Number(0.0)}
        elif word in "()":
            raise line.refuse(f"{rest[k]!r} is out of place", code="HB-F130", hint="take it out")
        elif value is None and k == 0:
            value = read_formula(rest[k], line)
            k += 1
        else:
            raise line.refuse(
                f"{rest[k]!r} is not understood",
                code="HB-F130",
                hint="DC value, PULSE, SIN, EXP, PWL, SFFM or AM",
            )
    if wave is not None and wave[0] == "pwl":
        wave = ("pwl", _absolute(wave[1]))
    return Card(name, line, nodes, value, wave=wave, given=given)


def _repeat(rest: list[str], k: int, line: Line) -> tuple[int, tuple[str, ...]]:
    """Return where ``REPEAT FOREVER (...) ENDREPEAT`` ends, and what is in its brackets."""
    words = [w.lower() for w in rest[k:]]
    if words[1:3] != ["forever", "("] or words[-1] != "endrepeat":
        raise line.refuse(
            "a repetition that is not understood",
            code="HB-F130",
            hint="PWL REPEAT FOREVER (0 0 1m 1) ENDREPEAT, or PWL(0 0 1m 1) r=0",
        )
    end, points = _arguments(rest, k + 2, line)
    return end + 1, points


def _absolute(points: tuple[str, ...]) -> tuple[str, ...]:
    """Return the points of PWL with times like ``+1m``, since the last point, added up."""
    words = list(points)
    for j in range(0, len(words) - 1, 2):
        if j and words[j].startswith("+"):
            words[j] = "{(" + words[j - 2].strip("{}") + ")+(" + words[j][1:].strip("{}") + ")}"
    return tuple(words)


def _arguments(rest: list[str], k: int, line: Line) -> tuple[int, tuple[str, ...]]:
    """Return where the arguments of a function of time end, and the arguments."""
    if k < len(rest) and rest[k] == "(":
        end = next((j for j in range(k, len(rest)) if rest[j] == ")"), None)
        if end is None:
            raise line.refuse("a bracket is not closed", code="HB-F130", hint="close it")
        return end + 1, tuple(rest[k + 1 : end])
    ends = ("ac", "dc", "repeat")
    end = next((j for j in range(k, len(rest)) if rest[j].lower() in ends), len(rest))
    return end, tuple(rest[k:end])


def _controlled(line: Line, name: str, nodes: tuple[str, ...], rest: list[str]) -> Card:
    kind = name[0].lower()
    if kind in "eg":
        if len(rest) != 1:
            raise line.refuse(
                f"{name} needs four nodes and a gain", code="HB-F130", hint=f"{name} n+ n- c+ c- 10"
            )
        return Card(name, line, nodes, read_formula(rest[0], line))
    if len(rest) != 2:
        raise line.refuse(
            f"{name} needs two nodes, a voltage source and a gain",
            code="HB-F130",
            hint=f"{name} n+ n- Vmeter 10",
        )
    return Card(name, line, nodes, read_formula(rest[1], line), refers=(rest[0],))


def _diode(
    line: Line,
    name: str,
    nodes: tuple[str, ...],
    rest: list[str],
    options: dict[str, str],
    notices: Notices,
) -> Card:
    words = [w for w in rest if w.lower() != "off"]
    if len(words) < len(rest) or "ic" in options:
        notices.add(line, "OFF and IC of a diode are left out: its state follows from the circuit")
    if not words or len(words) > 2:
        raise line.refuse(f"{name} needs a model", code="HB-F130", hint=f"{name} anode cathode DX")
    area = words[1] if len(words) == 2 else options.get("area")
    value = read_formula(area, line) if area is not None else None
    if "m" in options:
        value = _several("d", value or Number(1.0), options, line)
    return Card(name, line, nodes, value, refers=(words[0],))


def _switch(line: Line, name: str, nodes: tuple[str, ...], rest: list[str]) -> Card:
    kind = name[0].lower()
    words = list(rest)
    state = words.pop().lower() if words and words[-1].lower() in ("on", "off") else ""
    wanted = 1 if kind == "s" else 2
    if len(words) != wanted:
        form = "n+ n- c+ c- model" if kind == "s" else "n+ n- Vmeter model"
        raise line.refuse(
            f"{name} has {len(words)} words where {wanted} are needed",
            code="HB-F130",
            hint=f"{name} {form} [ON|OFF]",
        )
    return Card(name, line, nodes, refers=tuple(words), state=state)


def _coupling(line: Line, words: list[str]) -> Card:
    if len(words) < 4 or "=" in words:
        raise line.refuse(
            f"{words[0]} needs two coils and a coupling", code="HB-F130", hint="K1 L1 L2 0.98"
        )
    value = read_formula(words[-1], line)
    return Card(words[0], line, (), value, refers=tuple(words[1:-1]))


def _instance(line: Line, words: list[str]) -> Card:
    plain, options = options_of([w for w in words if w.lower() not in ("params:", "param:")], line)
    if len(plain) < 2 or any(w in "()" for w in plain):
        raise line.refuse(
            f"{words[0]} needs nodes and a subcircuit",
            code="HB-F130",
            hint=f"{words[0]} in out filter R=10",
        )
    given = {key: read_formula(value, line) for key, value in options.items()}
    return Card(words[0], line, tuple(plain[1:-1]), refers=(plain[-1],), given=given)


def with_parasitics(card: Card) -> list[Card]:
    """Return a card, and as cards of their own what LTspice lets it carry.

    ``Rser`` and ``Lser`` are in series with the part, ``Rpar`` and ``Cpar`` across all of it. A
    value of zero is none.

    Examples
    --------
    >>> from hybond.circuits.notices import Line
    >>> line = Line("x.net", 2, "L1 a b 1m Rser=2 Cpar=1p")
    >>> beside = {"rser": Number(2.0), "cpar": Number(1e-12)}
    >>> coil = Card("L1", line, ("a", "b"), Number(1e-3), parasitics=beside)
    >>> [(c.name, c.nodes) for c in with_parasitics(coil)]
    [('L1', ('a', 'L1#1')), ('R_L1_Rser', ('L1#1', 'b')), ('C_L1_Cpar', ('a', 'b'))]
    """
    given = {k: v for k, v in card.parasitics.items() if v != Number(0.0)}
    if not given:
        return [replace(card, parasitics={})]
    first, last = card.nodes[0], card.nodes[1]

    def part(letter: str, word: str, a: str, b: str, value: Expr) -> Card:
        return Card(f"{letter}_{card.name}_{word}", card.line, (a, b), value)

    series = [(k.upper()[0], k.capitalize(), given[k]) for k in ("rser", "lser") if k in given]
    inside = [f"{card.name}#{k + 1}" for k in range(len(series))]
    at = [first, *inside, last]
    found = [replace(card, nodes=(at[0], at[1], *card.nodes[2:]), parasitics={})]
    found += [part(*series[k][:2], at[k + 1], at[k + 2], series[k][2]) for k in range(len(series))]
    across = [(k.upper()[0], k.capitalize(), given[k]) for k in ("rpar", "cpar") if k in given]
    return found + [part(letter, word, first, last, v) for letter, word, v in across]
