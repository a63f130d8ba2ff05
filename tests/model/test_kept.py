"""The graph of a model that is run again, and what is written into it."""

from __future__ import annotations

import copy
import gc
import weakref
from collections.abc import Callable

import numpy as np
import pytest

import hybond as hb
from hybond.engine.outcome import engines
from hybond.model.kept import kept_graph


def model() -> hb.Model:
    inner = hb.Model("load", domain="electrical", parameters={"R": "2 ohm"})
    inner.add(r=hb.R("R"), node=hb.Zero())
    inner.bond("node -> r")
    inner.port(plus="node")
    m = hb.Model("rc", domain="electrical", parameters={"C": "1 F", "k": 1.0, "table": 3.0})
    m.models["load"] = inner
    m.add(c=hb.C("C", e="2 V"), n=hb.Zero(), load=hb.Submodel("load"), s=hb.Sf("i"))
    m.bond("n -> c", "n -> load.plus", "s -> n")
    m.input(i=hb.Input(table=[[0, 0.0], [1, 0.0]]))
    m.signal(v="k*c.e")
    m.experiment["until"] = 1.0
    return m


def final(m: hb.Model, **options: object) -> float:
    return hb.simulate(m, **options).final["v"]  # type: ignore[arg-type]


CHANGES: dict[str, Callable[[hb.Model], object]] = {
    "a parameter": lambda m: m.parameter(C="3 F"),
    "a parameter, in place": lambda m: m.parameters.update(k=2.0),
    "an element": lambda m: m.elements.update(c=hb.C("C", e="5 V")),
    "an option of an element": lambda m: m.elements["c"].options.update(e="7 V"),  # type: ignore[union-attr]
    "a signal": lambda m: m.signals.update(v="3*c.e"),
    "an input": lambda m: m.inputs["i"].table.__setitem__(1, [0.5, 4.0]),  # type: ignore[union-attr, index]
    "a submodel": lambda m: m.models["load"].parameters.update(R="9 ohm"),
    "an element of a submodel": lambda m: m.models["load"].elements.update(r=hb.R("3*R")),
    "the experiment": lambda m: m.experiment.update(until=2.0),
    "a bond": lambda m: m.bonds.remove("n -> load.plus"),
}


@pytest.mark.parametrize("what", CHANGES)
def test_a_model_that_was_changed_is_made_again(what: str) -> None:
    """Whatever was changed, and however: as if it had never been run."""
    changed, fresh = model(), model()
    before = final(changed), final(changed, parameters={"C": 2.0})
    CHANGES[what](changed)
    CHANGES[what](fresh)
    after = final(changed), final(changed, parameters={"C": 2.0})
    assert after == (final(fresh), final(fresh, parameters={"C": 2.0}))
    assert after[0] != before[0]


def test_tables_are_made_once(monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[object] = []
    tables_of = engines.tables_of
    monkeypatch.setattr(engines, "tables_of", lambda *a, **k: made.append(1) or tables_of(*a, **k))
    m = model()
    assert final(m) == final(m)
    assert len(made) == 1
    values = [final(m, parameters={"C": c, "load.R": 3.0}) for c in (1.0, 2.0, 4.0)]
    assert len(made) == 2 and len(set(values)) == 3
    assert values == [final(model(), parameters={"C": c, "load.R": 3.0}) for c in (1.0, 2.0, 4.0)]


def test_a_copy_is_a_model_of_its_own() -> None:
    m = model()
    final(m)
    other = copy.deepcopy(m)
    other.parameter(C="2 F")
    assert final(other) != final(m)
    run = hb.simulate(m)
    assert copy.deepcopy(run).final == run.final


def test_numbers_of_a_graph_are_those_that_were_written() -> None:
    m = model()
    m.add(p=hb.R("1 ohm"))
    m.bond("n -> p")
    for value in (1.0, 4.0):
        graph = kept_graph(m, {"load.R": value, "k": 2.0 * value})
        assert graph.parameters["load.R"] == value
        assert graph.read is not None and graph.parametric is not None
        law = graph.nodes[graph.by_path["load.r"]].law
        assert law is not None and law.matrix == ((value,),)
        assert np.linalg.det(np.array(law.matrix)) == pytest.approx(value)
        assert str(graph.signals["v"]) == str(graph.read("v"))
        assert str(graph.signals["v"]).startswith(f"{2.0 * value:g}*e:")
        assert graph.nodes[graph.by_path["load.r"]].said == f"{value:g} ohm"
        run = hb.simulate(graph)
        assert run.final == hb.simulate(model_with(m, value)).final


def model_with(m: hb.Model, value: float) -> hb.FlatGraph:
    return m.flatten(parameters={"load.R": value, "k": 2.0 * value})


@pytest.mark.parametrize(
    ("parameters", "code"),
    [
        ({"C": 0.0}, "HB-M163"),
        ({"C": -1.0}, "HB-M163"),
        ({"C": "1 V"}, "HB-U103"),
        ({"C": float("nan")}, "HB-M110"),
        ({"Q": 1.0}, "HB-M107"),
        ({"C": "k/0"}, "HB-M110"),
        ({"C": True}, "HB-M110"),
    ],
)
def test_wrong_values_are_refused_after_right_ones(parameters: object, code: str) -> None:
    m = model()
    final(m, parameters={"C": 1.5})
    with pytest.raises(hb.HybondError) as caught:
        final(m, parameters=parameters)
    assert caught.value.code == code


def test_a_root_that_has_no_value_is_refused() -> None:
    m = model()
    m.elements["c"] = hb.C("1 F*sqrt(k - 0.5)", e="2 V")
    assert final(m, parameters={"k": 1.0}) != final(m, parameters={"k": 2.0})
    with pytest.raises(hb.ModelError):
        final(m, parameters={"k": 0.25})


def test_a_model_that_has_been_run_is_given_back() -> None:
    """Its graph refers to it: what keeps graphs must not keep them for ever."""
    m = hb.Model("rc", parameters={"R": 2.0})
    m.add(c=hb.C(1.0, q=1.0), r=hb.R("R"), node=hb.Zero())
    m.bond("node -> c", "node -> r")
    hb.simulate(m, until=1.0)
    hb.simulate(m, until=1.0, parameters={"R": 3.0})
    ref = weakref.ref(m)
    del m
    gc.collect()
    assert ref() is None
