"""`sensitivities`: the derivatives of a run, by forward variations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Unpack

import numpy as np

from hybond.analysis.sensitivity.along import chain_of
from hybond.analysis.sensitivity.chain import Chain
from hybond.analysis.sensitivity.collocation import Jump
from hybond.analysis.sensitivity.fields import Fields
from hybond.analysis.sensitivity.landing import Landing
from hybond.analysis.sensitivity.opened import opened_model
from hybond.analysis.sensitivity.record import EventDerivative, Sensitivities
from hybond.analysis.sensitivity.values import Values
from hybond.analysis.sensitivity.wanted import Wanted, slotted, start_slopes
from hybond.calls import called
from hybond.errors import EquationError, NumericsError
from hybond.measures.naming import read_name
from hybond.model.builder import Model
from hybond.model.expressions import Expr
from hybond.model.graph import FlatGraph
from hybond.model.parts import Value
from hybond.model.unit_words import unit_of
from hybond.options import seconds
from hybond.result import Result
from hybond.runs.asked import MethodOptions
from hybond.simulation import simulate


@called(
    'hb.sensitivities(model, "1 s", wrt=["m", "pad.C", "ball.p"], of=["v.f"])',
    options=MethodOptions,
)
def sensitivities(
    model: Model,
    until: float | str | None = None,
    *,
    wrt: Sequence[str] | str,
    of: Sequence[str] | str | None = None,
    times: Sequence[float | str] = (),
    parameters: Mapping[str, Value] | None = None,
    **options: Unpack[MethodOptions],
) -> Sensitivities:
    """Return the derivatives of a run by parameters and start values, through all its switches.

    The equations of variation go beside the run, and across each switch with its saltation matrix:
    through jumps that conserve, restitution, branches of junction laws, sliding. Laws are
    differentiated as they are written; no run is compared with another.

    Parameters
    ----------
    model : Model
    until : float or str
        End time, s or a quantity; by default that of the experiment.
    wrt : sequence of str
        Parameters (``"m"``, ``"motor.k"``), values of elements (``"pad.C"``), starts (``"ball.p"``
        or ``"ball.p0"``, ``"c.e"``, ``"height.start"``).
    of : sequence of str, optional
        Signals, or expressions of them; by default the stored quantities and integrated signals.
    times : sequence of float or str
        Times at which the derivatives are wanted too, beside the accepted points of the run.
    parameters : mapping
        Values by dotted path that replace the model's own.
    **options
        `method`, or what is short for it, as for `simulate`. The derivatives are those of the exact
        motion, at the states of the run: a tighter `rtol` gives both more digits.

    Returns
    -------
    Sensitivities
        Where the derivatives end before the run does (an event that only touches, two at one
        instant, impacts that come to rest), it says where and why.

    Raises
    ------
    UsageError
        HB-A520 for a path that cannot be set, HB-S109 for a signal that there is not.
    EquationError
        HB-A521 for what is no number, or goes into something that is no law; HB-A522 for a model
        with blocks or friction in the plane.
    HybondError
        As `simulate`.

    Examples
    --------
    How the first impact of a ball, at ``sqrt(2 h/g)``, depends on its height:

    >>> import hybond as hb
    >>> m = hb.Model("ball", parameters={"g": "10 m/s^2"}, domain="translational")
    >>> m.add(weight=hb.Se("-g*(1 kg)"), ball=hb.I("1 kg"), v=hb.One())
    >>> m.add(floor=hb.Zero(law="unilateral", gap="h", restitution=0.8))
    >>> m.bond("weight -> v -> ball", "floor -> v")
    >>> m.signal(h=hb.Integral("v.f", start="5 m"))
    >>> s = hb.sensitivities(m, "1.5 s", wrt=["h.start", "g"], of=["v.f"])
    >>> round(s.of_event(1, "h.start"), 9), round(s.final("v.f", "g"), 9)
    (0.1, -0.6)
    """
    opened = opened_model(model, wrt, parameters or {})
    found = slotted(opened, {})
    check_followed(found.graph)
    run = simulate(found.plain, until, **options)
    names = _outputs(run.graph, of)
    asked = [seconds(t, "times") for t in times]
    varied = Varied.of(run, found, list(names.values()), asked)
    return varied.record(tuple(names), run.graph)


def _outputs(graph: FlatGraph, of: Sequence[str] | str | None) -> dict[str, str]:
    if isinstance(of, str):
        of = [of]
    if of is None:
        of = [s.path for s in graph.storages] + [i.path for i in graph.integrals]
    for name in of:
        _ = graph.signals.get(name) or read_name(graph, name)
    return {name: name for name in of}


@dataclass(frozen=True, slots=True)
class Varied:
    """A run with the chain of its variations.

    Parameters
    ----------
    run : Result
    found : Wanted
    chain : Chain
    fields : Fields
    """

    run: Result
    found: Wanted
    chain: Chain
    fields: Fields

    @staticmethod
    def of(
        run: Result,
        found: Wanted,
        outputs: Sequence[str],
        times: Sequence[float],
        integrands: Sequence[str] = (),
    ) -> Varied:
        """Return a run with its variations.

        Raises
        ------
        EquationError
            HB-A522 for what is not followed.
        """
        check_followed(found.graph)
        fields = Fields(Values(run, found), [signal_of(found.graph, e) for e in integrands])
        before = np.asarray(run.trace.events[0].before)
        expressions = [signal_of(found.graph, name) for name in outputs]
        chain = chain_of(run, fields, start_slopes(found, before), expressions, times)
        return Varied(run, found, chain, fields)

    def record(self, names: tuple[str, ...], graph: FlatGraph) -> Sensitivities:
        """Return what the variations say, as a record."""
        chain, follows = self.chain, self.found.follows
        d = chain.forward()
        readings = chain.readings
        shape = (len(readings), len(names))
        derivatives = np.zeros((*shape, len(self.found.names)))
        for k, reading in enumerate(readings):
            derivatives[k] = (reading.by @ d[reading.place] + reading.direct) @ follows
        events = []
        for instant in chain.instants:
            if instant.event is None:
                continue
            by = None
            if instant.place is not None:
                link = chain.links[instant.place]
                assert isinstance(link, Jump | Landing)  # these are what instants are
                own = link.moved(d) if isinstance(link, Landing) else link.moved(d[instant.place])
                by = own @ follows
            events.append(EventDerivative(instant.t, instant.event, instant.text, by))
        return Sensitivities(
            self.run,
            self.found.names,
            self.found.values,
            self.found.units,
            names,
            tuple(unit_of(graph.signals.get(n) or read_name(graph, n), graph) for n in names),
            np.array([r.t for r in readings]),
            np.array([r.values for r in readings]).reshape(shape),
            derivatives,
            tuple(events),
            chain.ends,
            chain.why,
            chain.notes(),
        )


def signal_of(graph: FlatGraph, name: str) -> Expr:
    """Return a signal or an expression of signals in canonical names."""
    return graph.signals.get(name) or read_name(graph, name)


def check_followed(graph: FlatGraph) -> None:
    """Refuse models with parts whose changes are not followed.

    Raises
    ------
    EquationError
        HB-A522.
    """
    for sample in graph.samples:
        if sample.block is None:
            continue
        raise EquationError(
            f"{sample.path} is a block: nobody knows what its outputs are made of",
            code="HB-A522",
            where=sample.path,
            hint="write it as sampled signals: hb.Sampled(...)",
        )
    for machine in graph.machines:
        if machine.law is not None and machine.law.planar:
            raise EquationError(
                f"{machine.path} is friction in the plane: its direction is kept apart from states",
                code="HB-A522",
                where=machine.path,
                hint="compare two runs",
            )


__all__ = ["NumericsError", "Varied", "check_followed", "sensitivities", "signal_of"]
