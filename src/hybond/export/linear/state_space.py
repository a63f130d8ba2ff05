"""A linear mode as ``x' = A x + B u, y = C x + D u``, for SciPy and python-control.

`extended` has its rows, whose coefficients depend on no point, and its inputs.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hybond.calls import called
from hybond.equations.linear_rows import LinearRows, linear_rows
from hybond.errors import EquationError, UsageError
from hybond.export.linear.proper import Proper, proper
from hybond.model.builder import Model, graph_of
from hybond.model.expressions import Expr, Number, names
from hybond.model.graph import AnyMode, FlatGraph, Mode, Node
from hybond.model.kinds import SOURCES
from hybond.names import did_you_mean

Matrix = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Extended:
    """The rows of a mode and what drives them."""

    rows: LinearRows
    inputs: tuple[str, ...]
    """Every input of the model and every source."""
    default: tuple[int, ...]
    """Those that come from outside."""


def extended(graph: FlatGraph, mode: Mode, outputs: tuple[str, ...]) -> Extended:
    """Return all equations of a mode.

    Raises
    ------
    EquationError
        HB-E671 for what is not linear, HB-Q103 for a nonlinear law, HB-Q105 if the mode leaves a
        variable open.
    """
    sources = [n for n in graph.nodes if n.kind in SOURCES and _value(n) != Number(0.0)]
    inputs = [f"u:{i.index}" for i in graph.inputs] + [f"source:{n.index}" for n in sources]
    rows = linear_rows(
        graph, mode, None, inputs=inputs, outputs={text: graph.signal(text) for text in outputs}
    )
    many = len(graph.inputs)
    default = [k for k in range(many) if rows.B[:, k].any()]
    default += [many + j for j, n in enumerate(sources) if _is_free(_value(n))]
    paths = (*(i.path for i in graph.inputs), *(n.path for n in sources))
    return Extended(rows, paths, tuple(default))


def _value(node: Node) -> Expr:
    assert node.law is not None
    return node.law.expressions[0]


def _is_free(value: Expr) -> bool:
    """Whether a source reads nothing but the time."""
    return all(name == "time" or name.startswith("at:") for name in names(value))


@dataclass(frozen=True, slots=True)
class StateSpace:
    """A linear mode; made by `state_space`.

    Parameters
    ----------
    A, B, C, D : array
        Shapes (n, n), (n, p), (q, n), (q, p); SI units.
    states : tuple of str
        Stored quantities and integrated signals that are independent in this mode.
    inputs, outputs : tuple of str
    mode : mapping of machine to state
    shifts : array, shape (n, p)
        A stored quantity is ``x + shifts @ u``. Zero unless an input sets part of it at once, as a
        source across a chain of capacitors does.
    """

    A: Matrix
    B: Matrix
    C: Matrix
    D: Matrix
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    mode: dict[str, str]
    shifts: Matrix

    def scipy(self) -> Any:
        """Return a `scipy.signal.StateSpace`."""
        from scipy.signal import StateSpace as Continuous

        return Continuous(self.A, self.B, self.C, self.D)

    def control(self) -> Any:
        """Return a `control.StateSpace` with the names of states, inputs and outputs.

        python-control does not allow dots in names; they become underscores.

        Raises
        ------
        UsageError
            HB-E674 without python-control, the extra ``control``.
        """
        try:
            from control import StateSpace as Continuous
        except ImportError:
            raise UsageError(
                "python-control is not installed",
                code="HB-E674",
                where="python-control",
                hint="pip install 'hybond[control]'; scipy() needs nothing more",
            ) from None
        return Continuous(
            self.A,
            self.B,
            self.C,
            self.D,
            states=[_plain(n) for n in self.states],
            inputs=[_plain(n) for n in self.inputs],
            outputs=[_plain(n) for n in self.outputs],
        )


@called('hb.state_space(model, outputs=["c.e"])')
def state_space(
    model: Model | FlatGraph,
    outputs: Sequence[str] = (),
    *,
    inputs: Sequence[str] | None = None,
    mode: AnyMode | None = None,
) -> StateSpace:
    """Return a linear mode of a model as state space.

    Storage in derivative causality is not among the states: what it holds follows from the others
    and the inputs. Sources that are not asked for are held constant: states and outputs then are
    what the asked ones add.

    Parameters
    ----------
    model : Model or FlatGraph
    outputs : sequence of str
        Signals as the model names them; default: the states.
    inputs : sequence of str, optional
        Names of sources, or of inputs that sources and signals read. A source that reads signals
        is driven by what is added to its value. Default: all inputs that are read, and the sources
        that read neither inputs nor states.
    mode : tuple of int or mapping, optional
        The state of each machine; those left out, and by default all, are in their start states.

    Raises
    ------
    EquationError
        HB-E671 for what is not linear in this mode, HB-Q103 for a nonlinear law, HB-E672 for an
        output that needs the derivative of an input, HB-Q105 for a mode that leaves states open.
    UsageError
        HB-E673 for an input that the model does not have.

    Examples
    --------
    >>> import hybond as hb
    >>> m = hb.Model("rlc", domain="electrical", parameters={"R": "2 ohm"})
    >>> m.add(V=hb.Se("1 V"), i=hb.One(), r=hb.R("R"), l=hb.I("0.5 H"), c=hb.C("0.1 F"))
    >>> m.bond("V -> i -> r", "i -> l", "i -> c")
    >>> found = state_space(m, ["c.e"])
    >>> found.states, found.inputs
    (('l.p', 'c.q'), ('V',))
    >>> found.A.tolist(), found.B.tolist(), found.C.tolist(), found.D.tolist()
    ([[-4.0, -10.0], [2.0, 0.0]], [[1.0], [0.0]], [[0.0, 10.0]], [[0.0]])
    >>> found.scipy().A.shape
    (2, 2)
    """
    graph = graph_of(model)
    if isinstance(outputs, str) or not isinstance(outputs, Iterable):
        raise UsageError(
            f"outputs = {outputs!r} is no list of names",
            code="HB-S130",
            where="outputs",
            hint='outputs=["c.e"]',
        )
    wanted = graph.mode_of({} if mode is None else mode)
    system = extended(graph, wanted, tuple(outputs))
    chosen = _chosen(system, inputs)
    rows = system.rows
    found = proper(rows.E, rows.A, rows.B[:, chosen], rows.stored)
    names = tuple(system.inputs[k] for k in chosen)
    states = tuple(rows.variables[k] for k in found.kept)
    if outputs:
        C, D = found.basis[rows.outputs], found.direct[0][rows.outputs]
        check_proper(found, rows.outputs, tuple(outputs), names, graph.mode_text(wanted))
    else:
        # without what the inputs add at once: that is what `shifts` tells
        C, D = np.eye(len(states)), np.zeros((len(states), len(names)))
    shifts = found.direct[0][list(found.kept)]
    return StateSpace(
        found.A,
        found.B,
        C,
        D,
        states,
        names,
        tuple(outputs) or states,
        graph.mode_names(wanted),
        shifts,
    )


def _chosen(system: Extended, inputs: Sequence[str] | None) -> list[int]:
    if inputs is None:
        return list(system.default)
    unknown = [name for name in inputs if name not in system.inputs]
    if unknown:
        raise UsageError(
            f"no source or input {unknown[0]!r}",
            code="HB-E673",
            where="inputs",
            hint=did_you_mean(unknown[0], system.inputs),
        )
    return [system.inputs.index(name) for name in inputs]


def check_proper(
    found: Proper, rows: list[int], outputs: tuple[str, ...], inputs: tuple[str, ...], mode: str
) -> None:
    """Refuse outputs, at these `rows`, that need the derivative of an input.

    Raises
    ------
    EquationError
        HB-E672.
    """
    for derivative in found.direct[1:]:
        for i, j in np.argwhere(derivative[rows]):
            raise EquationError(
                f"{outputs[i]} needs the derivative of {inputs[j]}",
                code="HB-E672",
                where=mode,
                hint="a source meets storage with nothing in between: put a resistor there, or "
                "choose another output or input",
            )


def _plain(name: str) -> str:
    return "".join(c if c.isalnum() or c == "_" else "_" for c in name).strip("_")
