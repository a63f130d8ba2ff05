"""Calls from Python that do not fit: every public function refuses them with a code."""

from __future__ import annotations

import inspect
from typing import Any

import pytest

import hybond as hb

RECORDS = {"Conversion", "Coverage", "CrossCheck", "Ensemble", "Result", "Signal", "StateSpace"}
RECORDS |= {"Linearisation", "FrequencyResponse", "State", "SweepTable", "ModeGraph"}
RECORDS |= {"Bifurcation", "Fit", "Gradient", "Optimum", "Sensitivities"}
RECORDS |= {"PeriodicOrbit", "Continuation"}
"""What functions return; nobody makes one."""
OTHER = {"Block", "FMU"}
"""Made of any names, which are looked at when a model takes them."""


LATER = {"Integral", "Sampled", "Submodel", "Input"}
LATER |= {"C", "I", "R", "G", "Se", "Sf", "TF", "GY", "Step", "EventTime", "Final", "Total"}
"""Whose values are looked at when a model takes them, or when they are to mean something."""


WHOLE = {"Auto", "RK45", "Radau", "Exact", "QSS", "LIQSS", "Limits"}
"""Records that leave all to the experiment, if nothing is said."""


class Anything:
    def __repr__(self) -> str:
        return "Anything()"


def model() -> hb.Model:
    m = hb.Model("rc", domain="electrical")
    m.add(c=hb.C("1 mF", e="10 V"), r=hb.R("1 kohm"), node=hb.Zero())
    m.bond("node -> c", "node -> r")
    return m


def called() -> list[str]:
    names = []
    for name in hb.__all__:
        what = getattr(hb, name)
        error = inspect.isclass(what) and issubclass(what, Exception)
        if callable(what) and not error and name not in RECORDS | OTHER:
            names.append(name)
    return names


@pytest.mark.parametrize("name", called())
def test_a_call_that_does_not_fit_is_refused_with_a_code(name: str) -> None:
    given: list[tuple[tuple[Any, ...], dict[str, Any]]] = [
        ((), {"bogus": 1}),
        ((model(),), {"bogus": 1}),
        ((model(), 1, 2, 3, 4, 5, 6, 7), {}),
    ]
    if name not in ("One", "Zero", "Model", "Input", "studio"):
        given += [((Anything(),), {}), ((model(), Anything()), {})]
        given += [] if name in WHOLE else [((), {})]
    if name == "studio":
        pytest.importorskip("anywidget")
    for args, options in given:
        try:
            getattr(hb, name)(*args, **options)
        except hb.HybondError as error:
            assert error.code.startswith("HB-") and str(error)
        else:
            assert name in LATER, (name, args, options)
