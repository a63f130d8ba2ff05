"""The typed tree of portable modules: what the reader makes and the printers print."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, TypeAlias

Basic: TypeAlias = Literal["int", "float", "bool", "Text", "Floats", "Ints", "none", "void"]


@dataclass(frozen=True, slots=True)
class Type:
    """A type: a basic one, a record (`record` is its name) or an array of records.

    Examples
    --------
    >>> str(Type("Records", "Mode")), str(Type("record", "Mode")), str(Type("float"))
    ('Records[Mode]', 'Mode', 'float')
    """

    kind: Basic | Literal["record", "Records"]
    record: str = ""

    def __str__(self) -> str:
        match self.kind:
            case "record":
                return self.record
            case "Records":
                return f"Records[{self.record}]"
            case "none":
                return "None"
            case "void":
                return "None"
        return self.kind

    @property
    def is_array(self) -> bool:
        """Whether elements can be asked for."""
        return self.kind in ("Floats", "Ints", "Records")

    @property
    def is_reference(self) -> bool:
        """Whether two variables may mean the same thing."""
        return self.is_array or self.kind == "record"

    @property
    def element(self) -> Type:
        """The type of an element."""
        if self.kind == "Records":
            return Type("record", self.record)
        return FLOAT if self.kind == "Floats" else INT


INT, FLOAT, BOOL, TEXT = Type("int"), Type("float"), Type("bool"), Type("Text")
FLOATS, INTS, NONE, VOID = Type("Floats"), Type("Ints"), Type("none"), Type("void")


@dataclass(frozen=True, slots=True)
class Value:
    """A literal; None is that of references."""

    value: int | float | bool | str | None
    type: Type


@dataclass(frozen=True, slots=True)
class Local:
    """A parameter or local variable."""

    name: str
    type: Type


@dataclass(frozen=True, slots=True)
class Global:
    """A constant of a module, or one of `math`."""

    name: str
    type: Type


@dataclass(frozen=True, slots=True)
class Field:
    """``base.name``."""

    base: Expr
    name: str
    type: Type


@dataclass(frozen=True, slots=True)
class Element:
    """``base[index]``."""

    base: Expr
    index: Expr
    type: Type


@dataclass(frozen=True, slots=True)
class Unary:
    """``-arg``, ``not arg`` or ``~arg``."""

    op: str
    arg: Expr
    type: Type


@dataclass(frozen=True, slots=True)
class Binary:
    """Arithmetic, comparisons (``is None`` too, as ``==``), ``and`` and ``or``."""

    op: str
    left: Expr
    right: Expr
    type: Type


@dataclass(frozen=True, slots=True)
class Choice:
    """``then if cond else orelse``."""

    cond: Expr
    then: Expr
    orelse: Expr
    type: Type


@dataclass(frozen=True, slots=True)
class Call:
    """A call of a function of a portable module."""

    function: str
    args: tuple[Expr, ...]
    type: Type


@dataclass(frozen=True, slots=True)
class Word:
    """A call of what every language has: a word, a function of `math`, a conversion."""

    word: str
    args: tuple[Expr, ...]
    type: Type


Expr: TypeAlias = Value | Local | Global | Field | Element | Unary | Binary | Choice | Call | Word


@dataclass(frozen=True, slots=True)
class Notes:
    """The line of a statement, and the comments that belong to it."""

    line: int
    above: tuple[str, ...] = ()
    behind: str = ""
    gap: bool = False
    """Whether an empty line comes before."""


@dataclass(frozen=True, slots=True)
class Assign:
    """``target = value``."""

    target: Local | Field | Element
    value: Expr
    notes: Notes


@dataclass(frozen=True, slots=True)
class Augment:
    """``target op= value``."""

    op: str
    target: Local | Field | Element
    value: Expr
    notes: Notes


@dataclass(frozen=True, slots=True)
class If:
    """``if``, any number of ``elif``, and ``else`` (None if there is none)."""

    branches: tuple[tuple[Expr, Block], ...]
    orelse: Block | None
    notes: Notes
    branch_notes: tuple[Notes, ...] = ()
    """Notes of each ``elif``, then of ``else``."""


@dataclass(frozen=True, slots=True)
class While:
    """``while cond``."""

    cond: Expr
    body: Block
    notes: Notes


@dataclass(frozen=True, slots=True)
class For:
    """``for name in range(start, stop, step)``."""

    name: str
    start: Expr
    stop: Expr
    step: int
    body: Block
    notes: Notes


@dataclass(frozen=True, slots=True)
class Jump:
    """``break``, ``continue`` or ``pass``."""

    word: Literal["break", "continue", "pass"]
    notes: Notes


@dataclass(frozen=True, slots=True)
class Return:
    """``return value``."""

    value: Expr | None
    notes: Notes


@dataclass(frozen=True, slots=True)
class Do:
    """A call as a statement."""

    call: Call | Word
    notes: Notes


Statement: TypeAlias = Assign | Augment | If | While | For | Jump | Return | Do


@dataclass(frozen=True, slots=True)
class Block:
    """Statements, and the comments after the last one."""

    statements: tuple[Statement, ...]
    below: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Member:
    """A field of a record."""

    name: str
    type: Type
    note: str = ""
    above: tuple[str, ...] = ()
    """Comments that begin a group of fields."""


@dataclass(frozen=True, slots=True)
class Record:
    """A record; `given` if the model brings it."""

    name: str
    members: tuple[Member, ...]
    doc: str
    place: str
    given: bool = False

    def member(self, name: str) -> Member | None:
        """Return the field of this name, or None."""
        return next((m for m in self.members if m.name == name), None)


@dataclass(frozen=True, slots=True)
class Constant:
    """A constant: one value, or the values of a table."""

    name: str
    type: Type
    value: int | float | bool | str | tuple[int, ...] | tuple[float, ...]
    above: tuple[str, ...]
    behind: str
    place: str


@dataclass(frozen=True, slots=True)
class Signature:
    """What a call of a function must know."""

    name: str
    parameters: tuple[tuple[str, Type], ...]
    result: Type


@dataclass(frozen=True, slots=True)
class Function:
    """A function; `body` is None if it is given."""

    signature: Signature
    doc: str
    body: Block | None
    place: str
    above: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """The name of the function."""
        return self.signature.name


@dataclass(frozen=True, slots=True)
class Module:
    """A portable module; `order` names all that it declares, as it stands there."""

    name: str
    doc: str
    imports: tuple[str, ...]
    constants: dict[str, Constant] = field(default_factory=dict)
    records: dict[str, Record] = field(default_factory=dict)
    functions: dict[str, Function] = field(default_factory=dict)
    order: tuple[str, ...] = ()
