"""Expressions of a netlist as expressions of the model: what they read, what they compare."""

from __future__ import annotations

from hybond.circuits.behaviour import PLACE, Law
from hybond.circuits.formulas import names_in, written
from hybond.circuits.graph_names import GraphNames
from hybond.circuits.notices import Line
from hybond.circuits.sensing import Sensing
from hybond.circuits.texts import Texts
from hybond.circuits.woven import written as sum_of
from hybond.model.builder import Model
from hybond.model.expressions import Compare, Expr, Name, Number, parse, substitute, transform
from hybond.model.expressions.tree import walk
from hybond.model.parts import MachinePart
from hybond.names import did_you_mean

_STRICT = {">": ">", ">=": ">", "<": "<", "<=": "<"}
_OTHER = {">": "<", ">=": "<", "<": ">", "<=": ">"}
_NOT = {">": "<=", ">=": "<", "<": ">=", "<=": ">"}


class Computing:
    """Writes laws of sources into a model.

    Numbers of a netlist have no units: a voltage stands for its volts, a time for its seconds. A
    comparison of something that changes becomes a machine of two states, so that its instants are
    located; what is computed reads the state by a signal. Where both sides rest on each other it is
    as it is written.
    """

    def __init__(self, model: Model, names: GraphNames, sensing: Sensing, texts: Texts) -> None:
        self.model, self.names, self.sensing, self.texts = model, names, sensing, texts
        self._known: dict[tuple[str, str, str, bool], str] = {}

    def text(self, law: Law, line: Line, owner: str, *, on_itself: bool = False) -> str:
        """Return a law as an expression without a unit.

        Parameters
        ----------
        on_itself : bool
            Whether what it gives makes jump what it compares: then it stays as it was where both
            sides are equal, for it may be equal by its own doing.

        Raises
        ------
        FileError
            HB-F134, HB-F144 (something read that is not there or not determined).
        """
        known = {**self.texts.names, **_themselves(law)}
        strange = [name for name in names_in(law.formula) if name not in known]
        if strange:
            raise line.refuse(
                f"there is no parameter {strange[0]!r}",
                code="HB-F134",
                hint=did_you_mean(strange[0], self.texts.names) or "write v(node) or i(part)",
            )
        named = parse(written(law.formula, known))
        means: dict[str, Expr] = {"time": parse("time/(1 s)")}
        for k, read in enumerate(law.reads):
            if read.kind == "v":
                terms, unit = self.sensing.voltage(read.first, read.second, line), "V"
            else:
                terms, unit = self.sensing.current(read.first, line), "A"
            text = sum_of(terms)
            means[_place(k)] = Number(0.0) if text == "0" else parse(f"({text})/(1 {unit})")
        whole = substitute(named, means)

        def compared(e: Expr) -> Expr:
            if not isinstance(e, Compare) or not _changes(e, self.texts):
                return e
            return Compare(">", Name(self._machine(e, owner, on_itself)), Number(0.5))

        return str(transform(whole, compared))

    def _machine(self, comparison: Compare, owner: str, on_itself: bool) -> str:
        """Return the signal that is 1 while a comparison holds."""
        left, right, op = str(comparison.left), str(comparison.right), comparison.op
        key = (left, op, right, on_itself)
        if key not in self._known:
            name = self.names.take(f"{owner}_holds")
            machine = self.names.take(f"{owner}_comparison")
            there, back = (_STRICT[op], _OTHER[op]) if on_itself else (op, _NOT[op])
            self.model.machines[machine] = MachinePart(
                {"no": (), "yes": ()},
                "yes" if "=" in op else "no",  # as it starts if both sides are equal
                (
                    f"no -> yes when {Compare(there, comparison.left, comparison.right)}",
                    f"yes -> no when {Compare(back, comparison.left, comparison.right)}",
                ),
            )
            self.model.signals[name] = f'if {machine}.state == "yes" then 1 else 0'
            self._known[key] = name
        return self._known[key]


def _place(k: int) -> str:
    return f"read_{k}_here"


def _themselves(law: Law) -> dict[str, str]:
    """Return names that the language of models has for what a law reads."""
    return {f"{PLACE}{k}": _place(k) for k in range(len(law.reads))} | {"time": "time"}


def _changes(e: Expr, texts: Texts) -> bool:
    fixed = set(texts.names.values())
    return any(isinstance(x, Name) and x.path not in fixed for x, _ in walk(e))
