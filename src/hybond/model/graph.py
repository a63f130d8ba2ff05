"""The flat graph: what a model means once submodels, parameters and names are resolved.

Everything to the right of `model` (causality, equations, modes, drawing) reads these frozen
records and integer indices; nothing to the right looks names up by text again.

Canonical names. Expressions inside a `FlatGraph` use only these names, so that each law exists
once and every mode evaluates the same tree:

========= =============================================================
``time``  time, s
``u:k``   input k, before or after a jump as the side asks
``s:k``   integrated signal k
``x:k``   stored quantity of storage port k (displacement or momentum)
``e:b``   effort of bond b, along its arrow
``f:b``   flow of bond b, along its arrow
``on:n``  1 if the controlled junction or switched element n is ON
``in:m:k`` 1 if machine m is in its state k
``at:k``  1 if the comparison k of time alone holds (constant between two timed events)
``law:n`` local variables of a law, ``law:q`` ... (never seen outside `laws`)
========= =============================================================
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import field
from numbers import Integral as Whole
from typing import TYPE_CHECKING, Any, Literal

from hybond.errors import HybondError, ModelError
from hybond.model.expressions import Compare, Expr
from hybond.model.inputs import Input
from hybond.model.kinds import KINDS, Kind
from hybond.model.laws import JunctionLaw, Law
from hybond.model.parts import BlockPart
from hybond.names import did_you_mean, plural
from hybond.records import dataclass
from hybond.units import Dimension, Domain, format_quantity

if TYPE_CHECKING:
    from hybond.model.parametric import Parametric
    from hybond.model.written import Written


@dataclass(frozen=True, slots=True)
class End:
    """One end of a bond at a node.

    `inward` is True if the half arrow points at the node; `port` counts a node's ports from 0.
    """

    bond: int
    inward: bool
    port: int

    @property
    def sign(self) -> int:
        """+1 if the bond's power flows into the node, else -1."""
        return 1 if self.inward else -1


@dataclass(frozen=True, slots=True)
class Node:
    """An element or junction. `ends` are in port order."""

    index: int
    path: str
    kind: str
    ends: tuple[End, ...]
    domain: Domain
    law: Law | None = None
    controlled: bool = False
    machine: int | None = None
    impulsive: bool = False
    finite: bool = False
    """True for a source of which the model says that it carries no impulse."""
    label: str = ""
    """The parameter as written, for drawings: ``m``, ``1 mm/N``."""
    shown: tuple[float, Dimension] | None = None
    """What a drawing says instead of the label, if anything: the value of a part's parameter."""
    hidden: bool = False
    """True for the junction that stands for the switch of a switched element."""
    implied: bool = False
    """True for the source that the law of a junction brought in."""

    @property
    def said(self) -> str:
        """What a drawing says of it."""
        return self.label if self.shown is None else format_quantity(*self.shown)

    @property
    def about(self) -> Kind:
        """The record of this node's kind."""
        return KINDS[self.kind]

    @property
    def is_junction(self) -> bool:
        """Whether the node is a 0- or a 1-junction."""
        return self.kind in ("0", "1")


@dataclass(frozen=True, slots=True)
class Bond:
    """A bond ``tail -> head``; its power is positive from tail to head."""

    index: int
    tail: int
    head: int
    name: str
    """As written: ``contact -> v`` or ``b3: contact -> v``."""
    domain: Domain
    where: str = ""
    """Where it is written: ``graph.bonds[2]``; empty if it is none that was written."""
    arrow: int = 0
    """Which arrow of its chain there it is, or is one of the bonds of."""


@dataclass(frozen=True, slots=True)
class Storage:
    """One storage port: `node`'s port number `port`, on `bond`, which points at it if sign = 1."""

    index: int
    node: int
    port: int
    bond: int
    sign: int
    kind: Literal["C", "I"]
    path: str
    """``ball.p``, ``pad.q``, or ``field.1.q`` for a port of a field."""
    start: float
    start_is: Literal["stored", "co-energy"] = "stored"


@dataclass(frozen=True, slots=True)
class Rule:
    """A transition of a machine: ``source -> target when guard``."""

    source: int
    target: int
    guard: Expr
    text: str
    """The guard as written."""
    reads: tuple[tuple[str, Expr], ...] = ()
    """What the guard reads, by full paths and in canonical names."""
    told: str = ""
    """The guard with full paths, where it was written within a part; empty where they are those."""

    @property
    def said(self) -> str:
        """The guard as it is told of: names of a part with the path of the part."""
        return self.told or self.text


@dataclass(frozen=True, slots=True)
class Machine:
    """A state machine; `on[k]` are the nodes that its state k switches ON."""

    index: int
    path: str
    states: tuple[str, ...]
    on: tuple[frozenset[int], ...]
    start: int
    rules: tuple[Rule, ...]
    fieldless: tuple[bool, ...] = ()
    """Per state: one of the laws that it makes active reads ``pre()``."""
    law: JunctionLaw | None = None
    """The law whose branches are its states: complementarity, not its rules, decides them."""
    pieces: bool = False
    """Whether its states are pieces of a resistor's law: nothing jumps between them."""
    led_on: tuple[float, ...] = ()
    """Where such a law that bends towards a limit, and grows without bound on its other side, goes
    on in a straight line."""

    @property
    def controls(self) -> frozenset[int]:
        """All nodes that the machine switches."""
        return frozenset().union(*self.on)


@dataclass(frozen=True, slots=True)
class Integral:
    """An integrated signal: ``s' = rate``."""

    index: int
    path: str
    rate: Expr
    start: float


@dataclass(frozen=True, slots=True)
class Sample:
    """Signals that are set at the instants ``phase + n*every`` and held between.

    They are of the integrals, with the numbers `signals` and rate zero. Without a block there is
    one, and it is set to the one of `values`; a block computes them from its inputs, `values`.
    """

    signals: tuple[int, ...]
    values: tuple[Expr, ...]
    every: float
    phase: float
    path: str
    block: BlockPart | None = None
    parameters: Mapping[str, float] = field(default_factory=dict)
    """Of the block, in SI."""


@dataclass(frozen=True, slots=True)
class Watch:
    """A comparison of time alone, ``time >= t_off``: constant between two timed events."""

    index: int
    compare: Compare
    times: tuple[float, ...]
    """Instants at which its truth may change, if they can be told in advance."""


MANY = 6
"""Machines above which a mode is written with names, and only those that matter."""

Mode = tuple[int, ...]
"""The state of each machine, by index."""

AnyMode = Mode | Mapping[str, str]
"""A mode as such or as ``{machine: state}``, machines left out being in their start state."""


class Kept(dict[Any, Any]):
    """What was made of a graph, by what was asked for; the last few. A copy begins without."""

    LAST = 4

    def keep(self, asked: Any, made: Any) -> None:
        """Keep what was made."""
        for old in list(self)[: 1 - self.LAST]:
            self.pop(old, None)
        self[asked] = made

    def __deepcopy__(self, memo: object) -> Kept:
        return Kept()

    def __reduce__(self) -> tuple[type[Kept], tuple[()]]:
        return Kept, ()


@dataclass(frozen=True, slots=True, repr=False)
class FlatGraph:
    """A model flattened, checked and resolved: plain data, never changed."""

    name: str
    title: str
    nodes: tuple[Node, ...]
    bonds: tuple[Bond, ...]
    storages: tuple[Storage, ...]
    machines: tuple[Machine, ...]
    integrals: tuple[Integral, ...]
    inputs: tuple[Input, ...]
    watches: tuple[Watch, ...]
    signals: Mapping[str, Expr]
    """Named signals by path, in canonical names, fully substituted."""
    parameters: Mapping[str, Any]
    """Values in SI by dotted path."""
    dimensions: Mapping[str, Dimension | None]
    """Dimension of each canonical name and of each signal path."""
    samples: tuple[Sample, ...] = ()
    experiment: Mapping[str, Any] = field(default_factory=dict)
    layout: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    by_path: Mapping[str, int] = field(default_factory=dict)
    """Node index by dotted path."""
    indeterminate: str = "error"
    """What a guard on an undetermined signal means: ``"error"`` or ``"least leakage"``."""
    pins: Mapping[int, int] = field(default_factory=dict)
    """Strokes that the modeller fixed: bond index to 0 (stroke at its tail) or 1 (its head)."""
    reference: Mode | None = None
    """The reference mode of causality, if the modeller gave one."""
    ends: int = -1
    """The machine that was put in to end runs, the last one, or -1: see `runs.ends`."""
    condition: Callable[[str], tuple[Rule, tuple[Watch, ...]]] | None = field(
        default=None, compare=False, repr=False
    )
    """Text of a guard to a rule from state 0 to 1, and the comparisons of time there are then."""
    read: Callable[[str], Expr] | None = field(default=None, compare=False, repr=False)
    """Text of an expression in the model's own names to canonical names."""
    parametric: Callable[[int], Parametric] | None = field(default=None, compare=False, repr=False)
    """The law of the element with this index, in names of parameters."""
    locate: Callable[[HybondError], HybondError] | None = field(
        default=None, compare=False, repr=False
    )
    """Notes in a refusal which line of a file says what is refused."""
    written: Written | None = field(default=None, compare=False, repr=False)
    """If it is a graph with slots into which numbers were written: that, and the numbers."""
    kept: Kept = field(default_factory=lambda: Kept(), init=False, compare=False, repr=False)
    """What was made of it for runs."""

    def __repr__(self) -> str:
        counts = ((self.nodes, "node"), (self.bonds, "bond"), (self.machines, "machine"))
        words = ", ".join(f"{len(group)} {plural(word, len(group))}" for group, word in counts)
        return f"<FlatGraph {self.name!r}: {words}>"

    @property
    def start_mode(self) -> Mode:
        """The start state of each machine."""
        return tuple(m.start for m in self.machines)

    def signal(self, text: str) -> Expr:
        """Return a signal, by its name or as an expression, in canonical names."""
        if text in self.signals:
            return self.signals[text]
        assert self.read is not None
        return self.read(text)

    def on_nodes(self, mode: Mode) -> frozenset[int]:
        """Return the controlled junctions and switched elements that are ON in `mode`."""
        return frozenset().union(
            *(m.on[k] for m, k in zip(self.machines, mode, strict=True)), frozenset()
        )

    def off_nodes(self, mode: Mode) -> frozenset[int]:
        """Return the controlled junctions and switched elements that are OFF in `mode`."""
        on = self.on_nodes(mode)
        return frozenset(n.index for n in self.nodes if n.controlled and n.index not in on)

    def mode_of(self, states: AnyMode) -> Mode:
        """Return the mode with these states; other machines are in their start state.

        Raises
        ------
        ModelError
            HB-M144 for a machine or state that does not exist, or a tuple that is no mode.
        """
        if not isinstance(states, Mapping):
            mode = tuple(states) if isinstance(states, Sequence) else (states,)
            sizes = [len(m.states) for m in self.machines]
            numbers = all(isinstance(k, Whole) for k in mode)
            if (
                len(mode) != len(sizes)
                or not numbers
                or any(not 0 <= k < n for k, n in zip(mode, sizes))
            ):
                raise ModelError(
                    f"{mode} is no mode of {len(sizes)} machines with {sizes} states",
                    code="HB-M144",
                    where=self.name,
                    hint='one state per machine, by number; or a mapping, {"machine": "state"}',
                )
            return mode
        by_path = {m.path: m for m in self.machines}
        found = list(self.start_mode)
        for path, state in states.items():
            machine = by_path.get(path)
            if machine is None or state not in machine.states:
                known = machine.states if machine is not None else tuple(by_path)
                raise ModelError(
                    f"{path!r} has no state {state!r}" if machine else f"no machine {path!r}",
                    code="HB-M144",
                    where=path,
                    hint=did_you_mean(state if machine is not None else path, known)
                    or "the model has no machines: it has one mode, which is the one without any",
                )
            found[machine.index] = machine.states.index(state)
        return tuple(found)

    def mode_text(self, mode: Mode, focus: Collection[str] = ()) -> str:
        """Return a mode for people: all states; of many machines those that say most.

        These are the machines in `focus` and those that are not in their start state, as far as
        they are few.
        """
        if not self.machines:
            return "the only mode"
        if len(self.machines) <= MANY:
            return ", ".join(self.mode_names(mode).values())
        pairs = zip(self.machines, mode, strict=True)
        away = [m.path for m, k in pairs if k != m.start and m.index != self.ends]
        named = {*focus, *(away if len(away) <= MANY else away[: MANY - 1])}
        shown = [f"{m} = {k}" for m, k in self.mode_names(mode).items() if m in named]
        rest = len(self.machines) - len(shown)
        if rest:
            others = "others" if shown else "machines"
            start = all(path in named for path in away)
            shown.append(f"{rest} {others} in their start state" if start else f"{rest} others")
        return ", ".join(shown)

    def mode_names(self, mode: Mode) -> dict[str, str]:
        """Return `mode` as ``{machine: state}``."""
        pairs = zip(self.machines, mode, strict=True)
        return {m.path: m.states[k] for m, k in pairs if m.index != self.ends}
