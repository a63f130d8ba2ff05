"""`read_circuit`: from a SPICE netlist to a model."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from hybond.calls import called, named_file
from hybond.circuits.as_parts import as_parts
from hybond.circuits.coils import couple
from hybond.circuits.deck import Deck, read_deck
from hybond.circuits.fitting import Tangent, fits
from hybond.circuits.formulas import written
from hybond.circuits.graph_names import GraphNames
from hybond.circuits.ideal_transformers import ideal_transformers
from hybond.circuits.leaves import Leaf, leaves_of
from hybond.circuits.measured import Wanted
from hybond.circuits.notices import Line, Notice, Notices
from hybond.circuits.numerals import quantity
from hybond.circuits.opened import GROUND, Opened, Value, global_value, open_deck
from hybond.circuits.operating_point import operating_point, with_nodes
from hybond.circuits.settled_starts import settle_starts
from hybond.circuits.texts import Texts
from hybond.circuits.wanting import all_wanted, values_of
from hybond.circuits.waves import ZERO, Clock
from hybond.circuits.weaving import ends_of, weave
from hybond.circuits.wiring import Assembly
from hybond.errors import FileError, UsageError
from hybond.model.builder import Model
from hybond.model.expressions import Number
from hybond.names import did_you_mean
from hybond.simulation import simulate
from hybond.uncollected import uncollected
from hybond.units import try_quantity

ROUNDS = 4
"""Runs in which the currents of diodes are looked for, at the most."""
POINTS = 2001
"""Output points at the most, whatever the step of ``.tran``."""


@dataclass(frozen=True, slots=True)
class Conversion:
    """A model made from a file of another tool.

    Parameters
    ----------
    model : Model
    warnings : tuple of Notice
        What was idealised or left out, with the place in the file.
    origins : mapping
        Element of the model to the line that it comes from.
    """

    model: Model
    warnings: tuple[Notice, ...]
    origins: Mapping[str, str]
    measures: tuple[Wanted, ...] = ()
    """What ``.meas`` asks for: `measure(run, conversion.measures)` computes it."""
    steps: tuple[tuple[str, tuple[float, ...]], ...] = ()
    """Of ``.step``: parameters of the model and their values; all combinations are meant."""
    diodes: tuple[Tangent, ...] = ()
    """Diodes that were taken as tangents: `fits(run, conversion.diodes)` says which do not fit."""
    reader: Callable[[str], str] | None = field(default=None, repr=False, compare=False)
    """What `signal` asks; None of a file that is no netlist."""
    drawn: Callable[[], Model] | None = field(default=None, repr=False, compare=False)
    """What `as_parts` asks; likewise."""

    def as_parts(self) -> Model:
        r"""Return the netlist as parts and nodes, to be drawn as a schematic and not to be run.

        Raises
        ------
        UsageError
            HB-D110 of a file that is no netlist.

        Examples
        --------
        >>> import pathlib, tempfile
        >>> import hybond as hb
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     path = pathlib.Path(folder, "rl.cir")
        ...     _ = path.write_text("RL\nV1 in 0 10\nR1 in a 1\nL1 a 0 1m\n.tran 1u 1m uic\n")
        ...     rl = hb.read_circuit(path)
        >>> rl.as_parts().draw(schematic=True).positions["ground"][1] > 0.0
        True
        >>> sorted(rl.as_parts().elements)
        ['L1', 'R1', 'V1', 'a', 'earth', 'ground', 'in']
        """
        if self.drawn is None:
            raise UsageError(
                "there is a schematic of netlists alone",
                code="HB-D110",
                where=self.model.name,
                hint="draw the bond graph of the model",
            )
        return self.drawn()

    def signal(self, text: str) -> str:
        r"""Return what a netlist calls ``v(a)``, ``v(a,b)`` or ``i(L1)`` in words of the model.

        Parameters
        ----------
        text : str
            An expression with any of them.

        Raises
        ------
        FileError
            HB-F134 (no such node or element), HB-F144 (nothing tells it).

        Examples
        --------
        >>> import pathlib, tempfile
        >>> import hybond as hb
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     path = pathlib.Path(folder, "rl.cir")
        ...     _ = path.write_text("RL\nV1 in 0 10\nR1 in a 1\nL1 a 0 1m\n.tran 1u 1m uic\n")
        ...     rl = hb.read_circuit(path)
        >>> rl.signal("i(L1)"), rl.signal("v(in,a)*i(R1)"), rl.signal("v(a)")
        ('L1.f', '(V1.e - L1.e)*R1.f', 'L1.e')
        >>> round(hb.simulate(rl.model)[rl.signal("i(V1)")].at(1e-3), 4)
        -6.3212
        """
        if self.reader is None:
            return text
        try:
            return self.reader(text)
        except FileError as error:
            raise FileError(error.why, code=error.code, where=text, hint=error.hint) from None


@called('hb.read_circuit("buck.cir")')
def read_circuit(
    path: str | os.PathLike[str],
    *,
    diode_current: float | str | Mapping[str, float | str] = 1.0,
    strict: bool = False,
) -> Conversion:
    r"""Read a SPICE netlist as a hybrid bond graph.

    Parameters
    ----------
    path : str or path
        A netlist; files that it includes are in its folder.
    diode_current : float, str or mapping
        The current, A, at which the exponential characteristic of a diode is replaced by its
        tangent: ideal diode, drop and resistance. A mapping has one for each diode by its name in
        the netlist (`"D1"`, `"X1.D1"`, `"D1_back"` for its breakdown), 1 A for the others. With
        ``"auto"`` the circuit is run, up to four times, and each diode gets the current that it
        carries.
    strict : bool
        Refuse what would be a warning.

    Returns
    -------
    Conversion
        With `model`, `warnings` and `origins`.

    Raises
    ------
    FileError
        HB-F130 to HB-F146, with the line.
    UsageError
        HB-F140 for a current that is not positive, or of a diode that is not there.
    HybondError
        As `simulate`, with ``"auto"``.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import hybond as hb
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "rlc.cir")
    ...     _ = path.write_text(
    ...         "A series circuit\nV1 in 0 10\nR1 in a 1\nL1 a out 1m\nC1 out 0 1u\n"
    ...         ".tran 1u 1m uic\n.end\n")
    ...     rlc = hb.read_circuit(path)
    >>> rlc.model.bonds
    ['V1 -> i_L1 -> R1', 'i_L1 -> L1', 'i_L1 -> C1']
    >>> rlc.origins["R1"]
    'line 3: R1 in a 1'
    """
    path = named_file(path, 'hb.read_circuit("buck.cir")')
    if diode_current == "auto":
        diode_current = _carried(path)
    currents = _currents(diode_current)
    notices = Notices()
    made, model, lines = _made(path, notices, currents)
    _check_names(currents, made)
    if strict and notices.found:
        first = next(iter(notices.found))
        raise FileError(
            f"{first.what} ({len(notices.found)} warning{'s' * (len(notices.found) > 1)} in all)",
            code="HB-F145",
            where=first.where,
            hint="change the netlist, or convert without --strict",
        )
    origins = {name: _origin(line, str(path)) for name, line in lines.items()}
    return Conversion(
        model,
        notices.told(),
        origins,
        made.measures(),
        made.steps(),
        made.diodes(),
        made.assembly.read,
        lambda: as_parts(made.opened, made.texts, made.title),
    )


def _carried(path: str | os.PathLike[str]) -> dict[str, float]:
    """Return the current that each diode carries, of those for which 1 A does not fit."""
    found: dict[str, float] = {}
    for _ in range(ROUNDS):
        read = read_circuit(path, diode_current=found)
        if not read.diodes:
            break
        wrong = fits(simulate(read.model), read.diodes)
        if not wrong:
            break
        found |= {fit.tangent.key: float(f"{fit.carried:.3g}") for fit in wrong}
    return found


@uncollected
def _made(
    path: str | os.PathLike[str], notices: Notices, current: Mapping[str, float]
) -> tuple[_Making, Model, dict[str, Line]]:
    deck = read_deck(path, notices)
    made = _Making(Path(path), deck, open_deck(deck, notices), notices, current)
    return made, *made.run()


def _currents(given: float | str | Mapping[str, float | str]) -> dict[str, float]:
    """Return the current of each diode by its key, that of all others by an empty one."""
    if isinstance(given, Mapping):
        return {"": 1.0, **{str(key).lower(): _current(value) for key, value in given.items()}}
    return {"": _current(given)}


def _check_names(currents: Mapping[str, float], made: _Making) -> None:
    known = {leaf.branch.key: leaf.branch.name for leaf in made.leaves if leaf.emission}
    for key in currents:
        if key and key not in known:
            raise UsageError(
                f"there is no diode {key!r} that is taken as a tangent",
                code="HB-F140",
                where="diode_current",
                hint=did_you_mean(key, list(known.values())) or "use its name in the netlist",
            )


def _current(given: float | str) -> float:
    read = try_quantity(given) if isinstance(given, str) else None
    value = read.value if read is not None else given
    if isinstance(value, str | bool) or not isinstance(value, int | float) or not 0.0 < value < 1e9:
        raise UsageError(
            f"diode_current = {given!r}",
            code="HB-F140",
            where="diode_current",
            hint='a positive current, such as "10 mA"',
        )
    return float(value)


def _origin(line: Line, top: str) -> str:
    where = f"line {line.number}" if line.file == top else f"{Path(line.file).name}:{line.number}"
    return f"{where}: {line.text}"


class _Making:
    """One conversion: what its steps share."""

    def __init__(
        self,
        path: Path,
        deck: Deck,
        opened: Opened,
        notices: Notices,
        current: Mapping[str, float],
    ) -> None:
        self.path, self.deck, self.opened, self.notices = path, deck, opened, notices
        self.current = current
        names = GraphNames()
        taken = {re.sub(r"[^A-Za-z0-9_]+", "_", b.name).lower() for b in opened.branches}
        self.parameters = {
            key: names.take(f"{name}_value" if name.lower() in taken else name)
            for key, (name, _, _) in opened.parameters.items()
        }
        self.names = names
        self.texts = Texts(self.parameters)
        transient = deck.transient
        self.step = self.stop = edge = ZERO
        if transient is not None:
            self.step = global_value(transient.step, opened, transient.line)
            edge = global_value(transient.edge, opened, transient.line)
            self.stop = global_value(transient.stop, opened, transient.line)
            if not self.step.number > 0.0 or not self.stop.number > 0.0:
                raise transient.line.refuse(
                    "a time that is not positive", code="HB-F140", hint=".tran step stop"
                )
        windings = couple(opened, self.texts) | ideal_transformers(opened, self.texts)
        startup = transient is not None and transient.startup
        clock = Clock(edge, self.stop, startup)
        found = leaves_of(opened, windings, self.texts, clock, notices, current=current)
        self.leaves = self._without_loops(found)
        self.numbers = {GROUND: 0}
        for leaf in self.leaves:
            for key in (leaf.branch.a, leaf.branch.b):
                self.numbers.setdefault(key, len(self.numbers))
        self.shown = ["ground", *(opened.nodes[k] for k in self.numbers if k != GROUND)]

    def run(self) -> tuple[Model, dict[str, Line]]:
        self._check_ground()
        self.leaves = self._started()
        model = Model(
            re.sub(r"\W+", "_", self.path.stem) or "circuit",
            title=self.title,
            domain="electrical",
        )
        model.parameters.update(self._given())
        ends = ends_of(self.leaves, self.numbers)
        self.woven = woven = weave(
            self.leaves, ends, self.shown, self.names, self.texts, self.notices
        )
        if not woven.elements:
            said = "; ".join(n.what for n in self.notices.found)
            raise FileError(
                "nothing of the netlist is left" + (f": {said}" if said else ""),
                code="HB-F130",
                where=str(self.path),
                hint="look at the names of its nodes: only a loop of elements carries a current",
            )
        self.assembly = Assembly(
            model,
            woven,
            self.leaves,
            ends,
            self.numbers,
            self.texts,
            self.deck,
            self.notices,
            self.opened.values,
        )
        self.assembly.run()
        settle_starts(model)
        if self.deck.transient is not None:
            model.experiment["until"] = _plain(self.stop)
            model.experiment["points"] = max(2, min(POINTS, self._steps()))
        return model, woven.lines

    def _given(self) -> dict[str, str | float]:
        """Return the parameters as the model has them."""
        found: dict[str, str | float] = {}
        for key, (_, formula, _) in self.opened.parameters.items():
            name = self.parameters[key]
            if isinstance(formula, Number):
                whole = formula.value.is_integer() and abs(formula.value) < 1e15
                found[name] = int(formula.value) if whole else formula.value
            else:
                found[name] = written(formula, self.parameters)
        return found

    @property
    def title(self) -> str:
        """Return the first line of the netlist."""
        return _printable(self.deck.title)

    def measures(self) -> tuple[Wanted, ...]:
        """Return what is measured in terms of the model."""
        return all_wanted(self.deck, self.woven, self.opened, self.parameters)

    def steps(self) -> tuple[tuple[str, tuple[float, ...]], ...]:
        """Return the parameters that are stepped, and their values."""
        return tuple(
            (self.parameters[step.name], values_of(step, self.opened)) for step in self.deck.steps
        )

    def diodes(self) -> tuple[Tangent, ...]:
        """Return the diodes that were taken as tangents."""
        return tuple(
            Tangent(
                name,
                self.current.get(self.leaves[k].branch.key, self.current[""]),
                self.leaves[k].emission,
                self.leaves[k].branch.key,
            )
            for k, name in self.woven.junctions.items()
            if self.leaves[k].emission
        )

    def _steps(self) -> int:
        return int(min(1e9, self.stop.number / self.step.number)) + 1

    def _without_loops(self, leaves: Sequence[Leaf]) -> list[Leaf]:
        """Return the branches that lead from one node to another one."""
        found = []
        for leaf in leaves:
            branch = leaf.branch
            if branch.a != branch.b:
                found.append(leaf)
            elif leaf.role == "Se":
                raise branch.line.refuse(
                    f"{branch.name} is short-circuited", code="HB-F146", hint="check its nodes"
                )
            elif leaf.role == "winding":
                raise branch.line.refuse(
                    f"the coupled coil {branch.name} is short-circuited",
                    code="HB-F146",
                    hint="put a small resistor in series",
                )
            else:
                self.notices.add(branch.line, f"{branch.name} is left out: both ends are one node")
        return found

    def _check_ground(self) -> None:
        if not any(GROUND in (leaf.branch.a, leaf.branch.b) for leaf in self.leaves):
            raise FileError(
                "no element is connected to ground",
                code="HB-F138",
                where=str(self.path),
                hint="the node 0 (or gnd) is the reference of all voltages",
            )

    def _started(self) -> list[Leaf]:
        """Return the branches with the starts that count."""
        transient = self.deck.transient
        forced = []
        for key, formula, line in self.deck.starts:
            key = GROUND if key == "gnd" else key
            if key not in self.numbers:
                raise line.refuse(
                    f"there is no node {key!r}", code="HB-F134", hint="check the name of the node"
                )
            forced.append((key, global_value(formula, self.opened, line), line))
        flowing = {}
        for key, formula, line in self.deck.currents:
            if not any(x.branch.key == key and x.branch.kind == "l" for x in self.leaves):
                raise line.refuse(
                    f"there is no coil {key!r}", code="HB-F134", hint="i(L1)=... of an element L"
                )
            flowing[key] = global_value(formula, self.opened, line)
        if transient is not None and transient.uic:
            held = {k: v for k, v, _ in forced}
            return [with_nodes(_flowing(leaf, flowing), held) for leaf in self.leaves]
        if flowing:
            raise self.deck.currents[0][2].refuse(
                "the current of a coil is given, and the start is the operating point",
                code="HB-F143",
                hint="write uic in .tran",
            )
        for leaf in self.leaves:
            if leaf.start is not None:
                self.notices.add(
                    leaf.branch.line,
                    "IC counts only with uic in .tran: the start is the operating point",
                )
        found = operating_point(
            self.leaves,
            self.numbers,
            self.shown,
            forced,
            self.texts,
            self.deck,
            str(self.path),
            self.notices,
            parameters=self._given(),
            values=self.opened.values,
        )
        if self.deck.steps and any(leaf.start is not None for leaf in found):
            self.notices.add(
                self.deck.steps[0].line,
                "the start is the operating point with the values of .param: all runs of the steps "
                "begin there",
            )
        return found


def _flowing(leaf: Leaf, flowing: Mapping[str, Value]) -> Leaf:
    """Return a coil that starts from the current of ``.ic``, if it has no start itself."""
    start = flowing.get(leaf.branch.key)
    if start is None or leaf.start is not None or leaf.branch.kind != "l":
        return leaf
    return replace(leaf, start=start)


def _plain(value: Value) -> str | float:
    return quantity(value.number, "s")


def _printable(text: str) -> str:
    return "".join(c if c.isprintable() else " " for c in text)[:200].strip()
