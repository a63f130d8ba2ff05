"""A netlist as it is written: cards, subcircuits, models, parameters, commands."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass, field

from hybond.circuits.behaviour import plainly
from hybond.circuits.cards import (
    WITHOUT_MEANING,
    Card,
    options_of,
    read_card,
    with_parasitics,
    words_of,
)
from hybond.circuits.formulas import read_formula
from hybond.circuits.measures import Measure, read_measure
from hybond.circuits.notices import Line, Notices
from hybond.circuits.reading import read_lines
from hybond.circuits.transient import StepLine, Transient, read_step, read_transient
from hybond.errors import FileError
from hybond.model.expressions import Expr
from hybond.names import did_you_mean

_ASSIGNED = re.compile(r"([A-Za-z_][A-Za-z0-9_.]*)\s*=(?!=)")
_SETS = re.compile(
    r"([vi])\s*\(\s*([^()\s,]+)\s*\)\s*=\s*(\{[^}]*\}|'[^']*'|[^\s=]+)", re.IGNORECASE
)
_LEFT_OUT = {
    "options": "options of another simulator are left out",
    "option": "options of another simulator are left out",
    "opt": "options of another simulator are left out",
    "temp": "the temperature is left out: parts are ideal at every temperature",
    "four": "the Fourier analysis is left out: hybond measure FILE 'thd(v(a), 1 kHz)' has it",
    "width": "the width of what is printed is left out",
    "backanno": "",
    "op": "the operating point is left out",
    "nodeset": ".nodeset is left out: the start follows from the circuit",
    "ac": "the AC analysis is left out",
    "dc": "the DC sweep is left out",
    "noise": "the noise analysis is left out",
    "tf": "the transfer function is left out (hybond equations --transfer)",
    "pz": "the poles are left out (hybond analyse)",
    "sens": "the sensitivity analysis is left out",
    "disto": "the distortion analysis is left out",
    "sp": "the analysis is left out",
    "title": "",
}
"""Commands that are left out, and what is said of that: nothing of what means nothing here."""
_COMMANDS = (
    *(".param", ".model", ".subckt", ".include", ".lib", ".tran", ".ic", ".global"),
    *(".print", ".meas", ".step", ".func", ".end", ".ends"),
)
_CONTROL = frozenset({"tran", "meas", "measure"})
"""Commands that mean the same in a control section as behind a dot."""
_FUNCTION = re.compile(
    r"\.(?:func|function)\s+([A-Za-z_]\w*)\s*\(([\w\s,]*)\)\s*=?\s*(.+)\Z", re.IGNORECASE
)
_ANALYSES = frozenset({"ac", "dc", "noise", "pz", "sens", "disto", "tf", "sp", "op"})


@dataclass(frozen=True, slots=True)
class ModelCard:
    """A ``.model`` line: its type in lower case and its parameters."""

    name: str
    type: str
    line: Line
    parameters: dict[str, Expr]


@dataclass(eq=False)
class Scope:
    """The top of a netlist, or the inside of a subcircuit."""

    name: str
    """Of the subcircuit, empty at the top."""
    line: Line
    parent: Scope | None = None
    nodes: tuple[str, ...] = ()
    """Its terminals, in lower case."""
    defaults: dict[str, Expr] = field(default_factory=dict)
    """Parameters of the ``.subckt`` line."""
    cards: list[Card] = field(default_factory=list)
    parameters: dict[str, tuple[Expr, Line, str]] = field(default_factory=dict)
    models: dict[str, ModelCard] = field(default_factory=dict)
    subcircuits: dict[str, Scope] = field(default_factory=dict)

    def find_model(self, name: str) -> ModelCard | None:
        """Return the model that a name means here."""
        scope: Scope | None = self
        while scope is not None:
            if name in scope.models:
                return scope.models[name]
            scope = scope.parent
        return None

    def find_subcircuit(self, name: str) -> Scope | None:
        """Return the subcircuit that a name means here."""
        scope: Scope | None = self
        while scope is not None:
            if name in scope.subcircuits:
                return scope.subcircuits[name]
            scope = scope.parent
        return None


@dataclass
class Deck:
    """A whole netlist."""

    title: str
    top: Scope
    shared: set[str] = field(default_factory=set)
    """Nodes of ``.global``, in lower case."""
    transient: Transient | None = None
    starts: list[tuple[str, Expr, Line]] = field(default_factory=list)
    """Of ``.ic``: node, voltage."""
    currents: list[tuple[str, Expr, Line]] = field(default_factory=list)
    """Of ``.ic``: coil, current."""
    measures: list[Measure] = field(default_factory=list)
    steps: list[StepLine] = field(default_factory=list)
    outputs: list[tuple[str, Line]] = field(default_factory=list)
    """Of ``.print`` and the like: one expression each, as written."""


def read_deck(path: str | os.PathLike[str], notices: Notices) -> Deck:
    """Return what a netlist says.

    Raises
    ------
    FileError
        HB-F130 to HB-F137, HB-F142, with the line.
    """
    title, lines = read_lines(path, notices)
    return _Reader(title, str(path), notices).run(lines)


class _Reader:
    def __init__(self, title: str, name: str, notices: Notices) -> None:
        self.notices = notices
        self.name = name
        self.top = Scope("", Line(name, 1, title))
        self.scope = self.top
        self.deck = Deck(title, self.top)
        self.analyses: list[Line] = []
        self.unsaid: dict[str, tuple[Expr, Line, str]] = {}
        self.seen: dict[int, set[str]] = {id(self.top): set()}

    def run(self, lines: list[Line]) -> Deck:
        lines = self.functions(lines)
        control = False
        for line in lines:
            word = line.text.split(None, 1)[0].lower()
            if control:
                control = word != ".endc"
                if word in _CONTROL and not self.inside_set(word, lines):
                    self.command(word, line)
            elif word == ".control":
                self.notices.add(line, "of the control section, tran and meas are taken")
                control = True
            elif word.startswith("."):
                self.command(word[1:], line)
            else:
                for card in with_parasitics(self.read(line, lines)):
                    self.card(card)
        self.top.parameters = {**self.unsaid, **self.top.parameters}
        if self.scope is not self.top:
            raise self.scope.line.refuse(
                f"the subcircuit {self.scope.name!r} has no end", code="HB-F130", hint="add .ends"
            )
        if self.deck.transient is None and self.analyses:
            raise self.analyses[0].refuse(
                "the netlist has no transient analysis, only others",
                code="HB-F137",
                hint="add .tran; hybond analyse and hybond equations know poles and transfer "
                "functions of the model",
            )
        if not self.top.cards:
            raise FileError(
                "the netlist has no elements",
                code="HB-F130",
                where=self.name,
                hint="its first line is the title, elements come after it",
            )
        return self.deck

    def functions(self, lines: list[Line]) -> list[Line]:
        """Take the functions of a netlist, which may be used before they are defined."""
        found = [
            (line, match) for line in lines if (match := _FUNCTION.match(line.text)) is not None
        ]
        known = {match[1].lower(): (line, match) for line, match in found}
        for line, match in found:
            if known[match[1].lower()][0] is not line:
                raise line.refuse(
                    f"the function {match[1]!r} is there twice", code="HB-F133", hint="rename one"
                )
        for name in _in_order({k: m[3] for k, (_, m) in known.items()}, known):
            line, match = known[name]
            names = tuple(w.lower() for w in re.split(r"[\s,]+", match[2].strip()) if w)
            line.functions[name] = (names, read_formula(match[3].strip(" ="), line))
        taken = {id(line) for line, _ in found}
        return [line for line in lines if id(line) not in taken]

    def inside_set(self, word: str, lines: list[Line]) -> bool:
        """Whether a control section repeats an analysis that the netlist has, too."""
        return word == "tran" and any(x.text.lower().startswith(".tran") for x in lines)

    def card(self, card: Card) -> None:
        seen = self.seen[id(self.scope)]
        key = card.name.lower()
        if key in seen:
            raise card.line.refuse(
                f"the name {card.name!r} is used twice", code="HB-F133", hint="rename one"
            )
        seen.add(key)
        self.scope.cards.append(card)

    def command(self, word: str, line: Line) -> None:
        rest = line.text.split(None, 1)[1] if len(line.text.split(None, 1)) > 1 else ""
        match word:
            case "param" | "params" | "parameters":
                self.parameters(rest, line)
            case "model":
                self.model(rest, line)
            case "subckt":
                self.subcircuit(rest, line)
            case "ends":
                self.ends(rest, line)
            case "tran":
                self.transient(rest, line)
            case "ic":
                self.starts(rest, line)
            case "meas" | "measure":
                self.measure(rest, line)
            case "step":
                self.step(rest, line)
            case "global":
                self.deck.shared |= {w.lower() for w in rest.split()}
            case "print" | "plot" | "probe" | "save":
                self.deck.outputs += [(text, line) for text in _outputs(rest)]
            case _ if word in _LEFT_OUT:
                if word in _ANALYSES:
                    self.analyses.append(line)
                if _LEFT_OUT[word]:
                    self.notices.add(line, _LEFT_OUT[word])
            case "if" | "elseif" | "elif" | "else" | "endif":
                raise line.refuse(
                    f"rows that .{word} chooses are not read",
                    code="HB-F137",
                    hint="write out the rows of the branch that is taken, without .if; a value "
                    "may choose by itself: R1 a b {sel == 1 ? 1k : 2k}",
                )
            case _:
                near = did_you_mean(f".{word}", _COMMANDS)
                raise line.refuse(
                    f"the command .{word} has no meaning here",
                    code="HB-F137",
                    hint=near
                    if near.startswith("did")
                    else f"take it out; known are {', '.join(_COMMANDS)}",
                )

    def read(self, line: Line, lines: list[Line]) -> Card:
        """Return the element of a line; a refusal of its kind names all of such kinds."""
        try:
            return read_card(line, self.notices)
        except FileError as error:
            names = [other.text.split(None, 1)[0] for other in lines]
            names = [n for n in names if n[0].lower() in WITHOUT_MEANING]
            if error.code == "HB-F136" and len(names) > 1:
                shown = ", ".join(names[:12]) + (", ..." if len(names) > 12 else "")
                error.why += f"; {len(names)} cards are of such kinds: {shown}"
            raise

    def parameters(self, rest: str, line: Line) -> None:
        for name, text in assignments(rest, line):
            key = name.lower()
            if key in self.scope.parameters:
                raise line.refuse(
                    f"the parameter {name!r} is given twice",
                    code="HB-F133",
                    hint=f"it is given in line {self.scope.parameters[key][1].number} too",
                )
            self.scope.parameters[key] = (read_formula(text, line), line, name)

    def model(self, rest: str, line: Line) -> None:
        words = words_of(rest, line)
        if len(words) < 2:
            raise line.refuse(
                "a model has a name and a type", code="HB-F130", hint=".model DX D(N=1)"
            )
        name, kind = words[0].lower(), words[1].lower()
        plain, options = options_of([w for w in words[2:] if w not in ("(", ")")], line)
        if plain:
            raise line.refuse(
                f"{plain[0]!r} has no value", code="HB-F130", hint=".model DX D(IS=1e-14 RS=0.1)"
            )
        if name in self.scope.models:
            raise line.refuse(
                f"the model {words[0]!r} is there twice",
                code="HB-F133",
                hint=f"line {self.scope.models[name].line.number} has it too; rename one",
            )
        read = {key: read_formula(v, line) for key, v in options.items() if not _worded(key)}
        self.scope.models[name] = ModelCard(words[0], kind, line, read)

    def subcircuit(self, rest: str, line: Line) -> None:
        words = [w for w in words_of(rest, line) if w.lower() not in ("params:", "param:")]
        plain, options = options_of([w for w in words if w not in ("(", ")")], line)
        if len(plain) < 2:
            raise line.refuse(
                "a subcircuit has a name and nodes", code="HB-F130", hint=".subckt filter in out"
            )
        name = plain[0].lower()
        known = self.scope.subcircuits.get(name)
        if known is not None:
            raise line.refuse(
                f"the subcircuit {plain[0]!r} is there twice",
                code="HB-F133",
                hint=f"line {known.line.number} has it too; rename one",
            )
        nodes = tuple(w.lower() for w in plain[1:])
        if len(set(nodes)) < len(nodes):
            raise line.refuse("a node is there twice", code="HB-F133", hint="rename one")
        inner = Scope(name, line, self.scope, nodes)
        inner.defaults.update({k: read_formula(v, line) for k, v in options.items()})
        self.scope.subcircuits[name] = inner
        self.seen[id(inner)] = set()
        self.scope = inner

    def ends(self, rest: str, line: Line) -> None:
        if self.scope.parent is None:
            raise line.refuse(
                ".ends without .subckt", code="HB-F130", hint="take it out, or write .end"
            )
        if rest and rest.split()[0].lower() != self.scope.name:
            raise line.refuse(
                f"it ends {rest.split()[0]!r}, but {self.scope.name!r} is open",
                code="HB-F130",
                hint="subcircuits are closed in the reverse order",
            )
        self.scope = self.scope.parent

    def transient(self, rest: str, line: Line) -> None:
        if self.deck.transient is not None:
            raise line.refuse(
                "a second transient analysis", code="HB-F133", hint="take one of them out"
            )
        self.deck.transient = read_transient(rest, line, self.notices)

    def measure(self, rest: str, line: Line) -> None:
        found = read_measure(rest, line)
        if found is None:
            self.notices.add(line, "the measurement is left out: its form is not understood")
        elif any(m.name == found.name for m in self.deck.measures):
            raise line.refuse(
                f"{found.name!r} is measured twice", code="HB-F133", hint="rename one of them"
            )
        else:
            self.deck.measures.append(found)

    def step(self, rest: str, line: Line) -> None:
        found = read_step(rest, line)
        if any(s.name == found.name for s in self.deck.steps):
            raise line.refuse(
                f"{found.name!r} is stepped twice", code="HB-F133", hint="keep one .step of it"
            )
        self.deck.steps.append(found)
        # a single run takes the first value of a parameter that nothing else defines
        self.unsaid.setdefault(found.name, (found.values[0], line, found.written))

    def starts(self, rest: str, line: Line) -> None:
        found = list(_SETS.finditer(rest))
        if not found or _SETS.sub("", rest).strip(" ,"):
            raise line.refuse(
                "not a list of node voltages", code="HB-F130", hint=".ic V(out)=5 V(in)=0"
            )
        for match in found:
            node = match[2].lower()
            known = self.deck.starts if match[1].lower() == "v" else self.deck.currents
            if any(other == node for other, _, _ in known):
                raise line.refuse(
                    f"{match[1]}({match[2]}) is given twice",
                    code="HB-F133",
                    hint="take one of them out",
                )
            known.append((node, read_formula(match[3], line), line))


def _in_order(bodies: dict[str, str], known: dict[str, tuple[Line, re.Match[str]]]) -> list[str]:
    """Return functions so that each comes after those that it calls."""
    needs = {
        name: [
            w for w in dict.fromkeys(re.findall(r"[a-z_]\w*(?=\s*\()", body.lower())) if w in bodies
        ]
        for name, body in bodies.items()
    }
    done: dict[str, None] = {}
    while len(done) < len(bodies):
        ready = [n for n in bodies if n not in done and all(w in done for w in needs[n])]
        if not ready:
            name = next(n for n in bodies if n not in done)
            raise known[name][0].refuse(
                f"the function {name!r} is defined by itself",
                code="HB-F135",
                hint="write it without itself",
            )
        done.update(dict.fromkeys(ready))
    return list(done)


def assignments(text: str, line: Line) -> list[tuple[str, str]]:
    """Return the pairs of ``a=1 b={a*2} c = a + 1``.

    Examples
    --------
    >>> assignments("a=1 b={a == 2} c = a + 1", Line("x", 1, ""))
    [('a', '1'), ('b', '{a == 2}'), ('c', 'a + 1')]
    """
    masked = re.sub(r"\{[^{}]*\}|'[^']*'|\"[^\"]*\"", lambda m: "#" * len(m[0]), text)
    found = [m for m in _ASSIGNED.finditer(masked) if not _compared(masked, m)]
    if not found or masked[: found[0].start()].strip(" ,"):
        raise line.refuse("no name=value", code="HB-F130", hint=".param f=50 w={2*pi*f}")
    ends = [m.start() for m in found[1:]] + [len(text)]
    return [(m[1], text[m.end() : end].strip(" ,")) for m, end in zip(found, ends, strict=True)]


def _compared(text: str, match: re.Match[str]) -> bool:
    return text[match.start() - 1 : match.start()] in ("<", ">", "!", "=") and bool(match.start())


def _worded(key: str) -> bool:
    """Whether a parameter of a model is a word: who makes the part, what it is called."""
    return key in ("mfg", "type", "icrating", "pn", "log")


def _outputs(text: str) -> list[str]:
    words = re.findall(r"[A-Za-z]+\s*\([^()]*\)|\S+", plainly(text))
    return [w.replace(" ", "") for w in words if w.lower() not in ("tran", "all", "alli", "allv")]
