"""What a solver that propagates linear modes is told of them."""

from __future__ import annotations

from collections import OrderedDict

from hybond.equations.mode import ModeEquations
from hybond.model.interval import Interval
from hybond.programs.linear import KEPT, LinearForm, LinearForms
from hybond.solvers.exact import Linear
from hybond.solvers.propagation import Propagator


class Flows:
    """The flows of a program's linear modes; a mode's is made once.

    Parameters
    ----------
    forms : LinearForms
    """

    def __init__(self, forms: LinearForms) -> None:
        self._forms = forms
        self._made: OrderedDict[int, tuple[LinearForm, Propagator]] = OrderedDict()

    def of(self, equations: ModeEquations, interval: Interval) -> Linear | None:
        """Return what the field of a mode is in an interval, None where it is not linear."""
        form = self._forms.of(equations, interval)
        if isinstance(form, str):
            return None
        made = self._made.get(id(form))
        if made is None or made[0] is not form:
            made = self._made[id(form)] = form, Propagator(form.matrix)
            if len(self._made) > KEPT:
                self._made.popitem(last=False)
        generated = self._forms.generated(form, interval)
        return Linear(made[1], form.states, generated, form.watched)
