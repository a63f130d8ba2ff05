"""Structural analysis of a hybrid bond graph, mode by mode.

For each mode: solvability, order, storage in derivative causality, algebraic loops,
controllability and observability, stiffness (R. Margetts, *Modelling and analysis of hybrid
dynamic systems using a bond graph approach*, thesis, University of Bath 2013, for the criteria in
hybrid graphs). What holds in each mode, or in some mode, implies nothing about the switched system.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any, Literal

from hybond.analysis.structure.controllability import Reach, controllability, observability
from hybond.analysis.structure.detectors import detected, paths_to
from hybond.analysis.structure.generic import generic
from hybond.analysis.structure.mode_matrices import ModeMatrices
from hybond.analysis.structure.paths import Paths, paths
from hybond.analysis.structure.report import StructureReport, listed
from hybond.analysis.structure.rows import ModeStructure, Property, StiffWords
from hybond.analysis.structure.stiffness import resistors_around, stiffness
from hybond.calls import called
from hybond.causality.assign import assign
from hybond.causality.dynamics import causality_of
from hybond.causality.reachable import reachable
from hybond.causality.record import Causality
from hybond.causality.reference import Reference, reference_mode
from hybond.equations.descriptor import Descriptor
from hybond.equations.pencil import Pencil, analyse
from hybond.errors import EquationError, HybondError, ModelError, NumericsError, UsageError
from hybond.model.builder import Model
from hybond.model.given import check_model
from hybond.model.graph import MANY, FlatGraph, Mode
from hybond.model.kinds import SOURCES
from hybond.model.parts import Value
from hybond.names import did_you_mean

ROWS = 64
"""Modes analysed of those that the machines can reach."""
SEEDS = (1, 2)
"""Of the random values that stand for nearly all values."""

_CANONICAL = re.compile(r"\b([sxu]):(\d+)")

Modes = Literal["reachable", "start"] | Sequence[Mode | Mapping[str, str]]


@called("hb.structure(model)")
def structure(
    model: Model | FlatGraph,
    *,
    modes: Modes = "reachable",
    inputs: Sequence[str] | None = None,
    outputs: Sequence[str] = (),
    parameters: Mapping[str, Value] | None = None,
    limit: int = ROWS,
) -> StructureReport:
    """Analyse the structure of a model in each of its modes.

    Parameters
    ----------
    model : Model or FlatGraph
    modes : {"reachable", "start"} or sequence
        Which modes: those that the machines can reach as far as their rules tell (the first
        `limit`, fewest steps first), only the first one, or a list of modes, each a tuple or
        ``{machine: state}``.
    inputs : sequence of str, optional
        The sources that count as inputs; all if not given.
    outputs : sequence of str
        Signals that are measured, for observability.
    parameters : mapping
        Values by dotted path that replace the model's own.
    limit : int

    Returns
    -------
    StructureReport
        Prints as a table.

    Raises
    ------
    ModelError
        HB-A101 if no mode asked for is linear.
    UsageError
        HB-A102 if an input is no source of the model, or `modes` is not one of these.

    Examples
    --------
    Two equal RC branches on one source: the difference of the capacitors cannot be steered, but
    only because the branches are equal.

    >>> import hybond as hb
    >>> m = hb.Model("branches")
    >>> m.add(V=hb.Se(1), n=hb.Zero(), i1=hb.One(), r1=hb.R(1), c1=hb.C(1), i2=hb.One(),
    ...       r2=hb.R(1), c2=hb.C(1))
    >>> m.bond("V -> n -> i1 -> r1", "i1 -> c1", "n -> i2 -> r2", "i2 -> c2")
    >>> report = structure(m, outputs=["c1.e"])
    >>> row = report.rows[0]
    >>> row.order, row.controllable.rank, row.controllable.lost
    (2, 1, ('finite',))
    >>> for note in row.notes:
    ...     print(note)
    loses finite controllability at these values: c1.q, c2.q at s = -1/s
    not observable: c2.q at s = -1/s
    """
    check_model(model)
    graph = model.flatten(parameters=parameters) if isinstance(model, Model) else model
    chosen, selection = _modes(graph, modes, limit)
    sources = _inputs(graph, inputs)
    forms = [ModeMatrices(graph, outputs)]
    forms += [
        ModeMatrices(generic(graph, seed), outputs, reference=forms[0].reference) for seed in SEEDS
    ]
    reference = reference_mode(graph)
    rows = []
    refusal: HybondError | None = None
    for mode in chosen:
        try:
            rows.append(_Row(graph, mode, forms, sources, reference).row())
        except HybondError as error:
            refusal = _nonlinear(graph, error)
            rows.append(ModeStructure(mode, _text(graph, mode), refused=refusal.to_dict()))
    if refusal is not None and all(r.refused is not None for r in rows):
        raise refusal
    names = tuple(graph.nodes[k].path for k in sources)
    return StructureReport(graph, tuple(rows), selection, names, tuple(outputs))


class _Row:
    """One mode while it is analysed: at the model's values, then at random ones."""

    def __init__(
        self,
        graph: FlatGraph,
        mode: Mode,
        forms: Sequence[ModeMatrices],
        sources: Sequence[int],
        reference: Reference,
    ) -> None:
        self.graph = graph
        self.mode = mode
        off = graph.off_nodes(mode)
        self.sources = [k for k in sources if k not in off]
        self.forms = forms
        self.descriptor = d = forms[0].at(mode, self.sources)
        self.pencil = analyse(d)
        # a source of value zero is no input, nor one that acts in other modes only
        self.driven = {graph.by_path[n] for n, b in zip(d.inputs, d.B.T, strict=True) if b.any()}
        self.causality: Causality = causality_of(graph, mode, reference=reference)
        # a pin may put storage in derivative causality that need not be
        self.unpinned = assign(graph, mode, pins={}) if graph.pins else self.causality

    def row(self) -> ModeStructure:
        graph, d, p = self.graph, self.descriptor, self.pencil
        strokes = paths(graph, self.mode, inputs=self.driven, causality=self.unpinned)
        steered = self._property(controllability, strokes) if p.regular and d.inputs else None
        seen = self._property(observability, self._sight(d)) if p.regular and d.outputs else None
        poles = () if p.poles is None else tuple(complex(z) for z in p.poles)
        words = self._stiffness(p)
        row = ModeStructure(
            mode=self.mode,
            text=_text(graph, self.mode),
            states=len(graph.storages),
            order=p.order,
            derivative=tuple(graph.storages[k].path for k in self.causality.derivative),
            loops=tuple(graph.bonds[b].name for b in self.causality.loops),
            conflicts=len(self.causality.conflicts),
            solvable=p.regular,
            index=p.index,
            impulse_free=p.impulse_free,
            poles=poles,
            controllable=steered,
            observable=seen,
            stiffness=words,
        )
        return replace(row, notes=tuple(self._notes(row, strokes)))

    def _sight(self, d: Descriptor) -> Paths | None:
        """Return what causal paths say about observability, if all outputs are bond variables."""
        signals = [self.graph.signal(name) for name in d.outputs]
        seen = [detected(self.graph, e) for e in signals]
        known = [v for v in seen if v is not None]
        if len(known) < len(seen):
            return None
        return paths_to(self.graph, self.mode, known, causality=self.unpinned)

    @cached_property
    def elsewhere(self) -> list[Pencil]:
        """The pencils of the mode at random values."""
        return [analyse(form.at(self.mode, self.sources)) for form in self.forms[1:]]

    def _names(self, variables: Sequence[int]) -> tuple[str, ...]:
        states = self.descriptor.states
        return tuple(states[k] for k in variables)

    def _property(self, test: Any, strokes: Paths | None) -> Property:
        here: Reach = test(self.pencil)
        actual = here.finite, here.infinite, here.impulse
        structural = actual
        # ranks are largest at nearly all values: what holds here need not be tried elsewhere
        if not all(actual):
            for p in filter(lambda p: p.regular, self.elsewhere):
                there: Reach = test(p, at_poles=False)
                found = there.finite, there.infinite, there.impulse
                structural = (
                    structural[0] or found[0],
                    structural[1] or found[1],
                    structural[2] or found[2],
                )
        storages = [s.path for s in self.graph.storages]
        return Property(
            finite=here.finite,
            infinite=here.infinite,
            impulse=here.impulse,
            structural=structural,
            by_paths=None if strokes is None else strokes.controllable,
            rank=here.rank,
            modes=tuple(complex(z) for z in here.modes),
            storages=self._names(here.variables),
            unreached=() if strokes is None else tuple(storages[k] for k in strokes.unreached),
            stuck=() if strokes is None else tuple(storages[k] for k in strokes.stuck),
            margin=here.margin,
            sure=here.sure,
        )

    def _stiffness(self, p: Pencil) -> StiffWords | None:
        found = stiffness(p)
        if found is None:
            return None
        stored = [k for k in found.fast if k < len(self.graph.storages)]
        around = resistors_around(self.graph, self.mode, self.causality, stored)
        return StiffWords(
            ratio=found.ratio,
            stiff=found.stiff,
            fastest=found.fastest,
            slowest=found.slowest,
            fast=self._names(found.fast),
            slow=self._names(found.slow),
            resistors=tuple(self.graph.nodes[k].path for k in around),
        )

    def _notes(self, row: ModeStructure, strokes: Paths) -> list[str]:
        found = []
        p = self.pencil
        if not p.regular:
            also = (
                "" if any(q.regular for q in self.elsewhere) else ", nor at nearly all other values"
            )
            found.append(f"no unique solution at these values{also}")
        elif not p.sure:
            found.append("a rank of the pencil is near its limit: the row may be wrong")
        for what, has in (("controllable", row.controllable), ("observable", row.observable)):
            if has is not None:
                found += _property_notes(what, has)
        other = strokes.order != row.order
        for has in (row.controllable, row.observable):
            if has is not None and has.by_paths is not None:
                other |= has.by_paths != has.structural[0]
        if p.regular and not strokes.conflicts and other:
            found.append(
                "causal paths tell another story than the ranks: a ring of junctions cancels what "
                "the paths carry"
            )
        words = row.stiffness
        if words is not None and words.stiff:
            by = f" with {listed(words.resistors)}" if words.resistors else ""
            found.append(
                f"stiff, {words.ratio:.2g}: {listed(words.fast)}{by} is that much faster than "
                f"{listed(words.slow)}; use an implicit solver"
            )
        if row.conflicts:
            found.append("causality has a conflict in this mode")
        return found


def _property_notes(what: str, has: Property) -> list[str]:
    found = []
    noun = {"controllable": "controllability", "observable": "observability"}[what]
    if has.lost:
        found.append(f"loses {' and '.join(has.lost)} {noun} at these values{_where(has)}")
    elif not has.finite:
        found.append(f"not {what}{_where(has)}")
    if not has.sure:
        found.append(f"{noun} is near its limit (margin {has.margin:.1e})")
    return found


def _where(has: Property) -> str:
    if has.finite:
        return ""
    poles = tuple(dict.fromkeys(pole_text(z) for z in has.modes))
    return f": {listed(has.storages)} at s = {listed(poles)}/s"


def pole_text(z: complex) -> str:
    """Return a pole with four digits: ``-1``, ``-0.5±3j``."""
    digits = 4
    real = f"{z.real:.{digits}g}"
    return f"{real}±{abs(z.imag):.{digits}g}j" if z.imag else real


def _modes(graph: FlatGraph, modes: Modes, limit: int) -> tuple[list[Mode], str]:
    """Return the modes to analyse, and in words what they are."""
    if isinstance(modes, str):
        if modes == "start":
            return [graph.start_mode], "the start mode"
        if modes != "reachable":
            raise UsageError(
                f"modes = {modes!r}",
                code="HB-A102",
                where="modes",
                hint='"reachable", "start" or a list of modes',
            )
        found = reachable(graph, limit=max(limit, 1))
        if not graph.machines:
            return [graph.start_mode], "its only mode"
        if found.complete:
            return list(found.modes), (
                f"all {len(found.modes)} modes that the machines can reach"
                if len(found.modes) > 1
                else "the only mode" + (" that the machines can reach" if graph.machines else "")
            )
        total = 1
        for m in graph.machines:
            total *= len(m.states)
        return list(found.modes), (
            f"a selection: the {len(found.modes)} modes nearest to the start mode, of at most "
            f"{total:.3g}"
        )
    chosen = [graph.mode_of(m) for m in modes]
    return chosen, f"{len(chosen)} modes asked for" if len(chosen) > 1 else "the mode asked for"


def _inputs(graph: FlatGraph, inputs: Sequence[str] | None) -> list[int]:
    sources = {n.path: n.index for n in graph.nodes if n.kind in SOURCES}
    for name in inputs or ():
        if name not in sources:
            raise UsageError(
                f"{name!r} is no source",
                code="HB-A102",
                where="inputs",
                hint=did_you_mean(name, tuple(sources)),
            )
    return [k for path, k in sources.items() if inputs is None or path in inputs]


def _nonlinear(graph: FlatGraph, error: HybondError) -> HybondError:
    """Return the refusal of a mode that has no constant matrices; any other as it is."""
    if not isinstance(error, EquationError | NumericsError):
        return error
    paths_of = {
        "s": [i.path for i in graph.integrals],
        "x": [s.path for s in graph.storages],
        "u": [i.path for i in graph.inputs],
    }
    why = _CANONICAL.sub(lambda m: paths_of[m[1]][int(m[2])], error.why)
    return ModelError(
        f"structure is analysed only where the mode is linear: {why}",
        code="HB-A101",
        where=error.where or graph.name,
        hint="give the element a constant, or ask for modes in which it is off",
    )


def _text(graph: FlatGraph, mode: Mode) -> str:
    """Return a mode in words; of many machines only those that are not as at the start."""
    if len(graph.machines) <= MANY:
        return graph.mode_text(mode)
    moved = [
        f"{m.path} = {m.states[k]}"
        for m, k, k0 in zip(graph.machines, mode, graph.start_mode, strict=True)
        if k != k0
    ]
    return ", ".join([*moved, "others as at the start"]) if moved else "as at the start"
